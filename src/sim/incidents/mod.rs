//! What befalls a simulated floor besides orders: closures and evacuations that are announced, stations and chargers
//! out of order, robots that are taken off the floor or pushed elsewhere.
//!
//! Main types: `announce::Announcements`, `outages::Outages`, `leavers::Leavers`, `pushes::PushSurroundings`. Refuses:
//! to draw a random number where a scenario has no such faults.

pub(crate) mod announce;
pub(crate) mod leavers;
pub(crate) mod outages;
pub(crate) mod pushes;
