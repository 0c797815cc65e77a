//! The types on the wire: robots, racks, stations, jobs, people, alarms, events, the building, and the reasons why
//! something waits or is refused.
//!
//! Main types: [`names::Names`], which makes most of them from a view; [`names::RobotDto`], [`people::WorkerDto`],
//! [`alarms::AlarmDto`], [`events::EventDto`], [`building::MapDto`], [`shift::ShiftReportDto`]. Refuses: to add
//! knowledge of its own, and to know how it is sent.

pub mod alarms;
pub mod building;
pub mod cell;
pub mod events;
pub mod guidance;
pub mod linked;
pub mod names;
pub mod people;
pub mod refusal;
pub mod replans;
pub mod shift;
pub mod vehicle;
pub mod waits;
pub mod whys;
