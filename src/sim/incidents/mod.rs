//! Incidents on a simulated floor besides orders: announced closures and evacuations, stations and chargers out of
//! order, robots taken off the floor or pushed elsewhere.
//!
//! Main types: `announce::Announcements`, `outages::Outages`, `leavers::Leavers`, `pushes::PushSurroundings`. Refuses:
//! to draw a random number where a scenario has no such faults.

pub(crate) mod announce;
pub(crate) mod leavers;
pub(crate) mod outages;
pub(crate) mod pushes;
