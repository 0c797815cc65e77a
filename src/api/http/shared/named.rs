//! Looks up names in paths and bodies, and says what is wrong with an unknown name.
//!
//! Main functions: [`parse_robot`], [`parse_station`], [`unknown`]. Refuses: to guess.

use crate::port::moment::Moment;
use crate::state::api::Api;
use crate::wire::error::Problem;
use giveway_floor::id::{Dense, RobotId, StationId};
use giveway_floor::text::sentence::requests;
use giveway_floor::text::{NameFault, Sentence, name_fault};

/// The robot of this name, in the latest view.
pub fn parse_robot(api: &Api, name: &str) -> Result<RobotId, Problem> {
    let found = api.moment().view.robots.iter().position(|r| r.name == name);
    let unknown = || Problem::unknown("robot", requests::no_such_thing("robot", name, "/v1/robots"));
    found.map(RobotId::at).ok_or_else(unknown)
}

/// The station of this name.
pub fn parse_station(api: &Api, name: &str) -> Result<StationId, Problem> {
    let found = api.map.stations.pairs().find(|(_, s)| s.name == name).map(|(id, _)| id);
    found.ok_or_else(|| Problem::unknown("station", requests::no_such_thing("station", name, "/v1/stations")))
}

/// The robot of this name, in the given view.
pub fn robot_named(moment: &Moment, name: &str) -> Option<RobotId> {
    moment.view.robots.iter().position(|robot| robot.name == name).map(RobotId::at)
}

/// What a request is told about an unknown name. If the name has invisible characters or similar faults, the sentence
/// says so.
pub fn unknown(what: &str, name: &str) -> Sentence {
    let list = if what == "node" { "/v1/map".into() } else { format!("/v1/{what}s") };
    match name_fault(name, usize::MAX).filter(|fault| !matches!(fault, NameFault::Length(_))) {
        Some(fault) => requests::no_such_name(what, name.escape_debug().to_string(), fault.sentence()),
        None => requests::no_such_thing(what, name, list),
    }
}
