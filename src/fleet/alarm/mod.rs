//! Alarms: what is wrong on the floor or with the server, since when, what to do, and who has acknowledged it.
//!
//! Main types: [`FloorWatch`] (finds what is wrong in one look at the fleet), [`AlarmCondition`] (what it found),
//! [`AlarmRegister`] (turns conditions into alarms that are raised, acknowledged, shelved and cleared). A robot that
//! only waits behind another one raises no alarm: the root of its chain in the wait-for graph does, and counts the
//! robot. Refuses: to read a clock, to store anything, and to repair anything.

mod arms;
mod care;
mod condition;
mod deliveries;
mod displaced;
mod flow;
mod groups;
mod jobs;
mod kind;
mod people;
mod register;
mod robots;
mod roots;
mod server;
mod standing;
mod watch;

pub use care::{
    Acknowledgement, AlarmNote, CareRefusal, LONGEST_SHELVING, MOST_NOTES, MOST_SHELVED, Shelving,
};
pub use condition::{AlarmCondition, AlarmSubject, SubjectKind};
pub use deliveries::Deliveries;
pub use displaced::words as displacement_words;
pub use groups::AlarmMember;
pub use kind::{AlarmKind, AlarmScope, AlarmSeverity};
pub use register::{Alarm, AlarmQuery, AlarmRegister, MOST_ACTIVE};
pub use server::{LoopHealth, StepRecord};
pub use watch::{FloorWatch, operator_conditions};

#[cfg(test)]
mod tests;
