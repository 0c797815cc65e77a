//! Robot arms that get no trajectory: silent, late, or reporting what cannot be.
//!
//! Main function: [`conditions`]. Refuses: to report an arm that was never heard of, which is off, and one whose own
//! protective stop holds it, which ends by itself.

use super::condition::{AlarmCondition, AlarmSubject, SubjectKind};
use super::kind::AlarmKind;
use crate::cell::arm::{ArmActivity, ArmTrouble};
use crate::fleet::{Fleet, View};
use crate::id::{Dense, StationId};

/// Arms that are in trouble now.
pub(super) fn conditions(fleet: &Fleet, view: &View) -> Vec<AlarmCondition> {
    let map = fleet.warehouse();
    let condition = |(i, station): (usize, &crate::fleet::StationView)| {
        let ArmActivity::Trouble(why) = station.arm?.activity else { return None };
        let place = &map.stations[StationId::at(i)];
        let said = match why {
            ArmTrouble::Stopped => return None,
            ArmTrouble::Silent => "is silent",
            ArmTrouble::Late => "sends its reports too late",
            ArmTrouble::Joints => "reports joints that it cannot have",
            ArmTrouble::Jump => "reports joints that it cannot have come to",
        };
        let text = format!(
            "the robot arm at {} {said}: it gets no trajectory, the picker has its lines.",
            place.name
        );
        let subject = AlarmSubject::new(SubjectKind::Station, place.name.clone());
        let one = AlarmCondition::new(AlarmKind::ArmTrouble, subject, text);
        Some(one.at(map.nodes[place.node].at))
    };
    view.stations.iter().enumerate().filter_map(condition).collect()
}
