//! The messages of VDA 5050, versions 2.0, 2.1 and 3.0 (with the corrections of 3.0.1), behind one model.
//!
//! A message is read into the model whatever its version and however it is spelled, and written as the official schema
//! of a version wants it. Masters and robots use the same types. Source: VDA 5050, sections 6 and 7 of each version.
//! Main types: [`Version`], [`Address`], [`Message`] and what it has; main functions: [`read()`], [`write()`]. Refuses:
//! to know what a message means for anybody, and to know MQTT.

pub mod model;
pub mod read;
pub mod robot;
mod stamp;
#[cfg(test)]
mod tests;
pub mod topic;
pub mod version;
mod vocabulary;
pub mod write;

pub use model::action::{Action, ActionState, ActionStatus, BlockingType, Parameter};
pub use model::answer::{Grant, Response};
pub use model::error::{ErrorLevel, ErrorReference, RobotError};
pub use model::factsheet::{ActionScope, Factsheet, OfferedAction};
pub use model::order::{Corridor, Edge, Node, NodePosition, Order};
pub use model::state::{
    ConnectionState, EStop, Load, NodeLeft, OperatingMode, Position, Power, Request, RequestStatus,
    RequestSubject, State, Velocity, Visualization,
};
pub use model::zone::{StoredZoneSet, Zone, ZoneKind, ZoneSet};
pub use model::{Header, Message};
pub use read::{Oddity, Read, Unreadable, read};
pub use robot::{EmbodiedRobot, RobotMessage, RobotQuirks, RobotSetup, RobotStep, VirtualRobot};
pub use topic::{Address, AddressError, TopicKind};
pub use version::Version;
pub use write::write;
