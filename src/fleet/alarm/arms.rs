//! Robot arms that get no trajectory because they are silent, late, or report the impossible; and arms that do not come
//! out of the opening.
//!
//! Main function: [`conditions`]. Refuses: to report an arm that was never heard of, which is off, and an arm that its
//! own protective stop holds for a moment, which ends by itself.

use super::condition::{AlarmCondition, AlarmSubject, SubjectKind};
use super::kind::AlarmKind;
use crate::{Fleet, View};
use giveway_cell::arm::{ArmActivity, ArmTrouble};
use giveway_floor::id::{Dense, StationId};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::alarms;

/// Arms that are in trouble now.
pub(super) fn conditions(fleet: &Fleet, view: &View) -> Vec<AlarmCondition> {
    let map = fleet.warehouse();
    let condition = |(i, station): (usize, &crate::StationView)| {
        let arm = station.arm.as_ref()?;
        let place = &map.stations[StationId::at(i)];
        let text = match wrong_with(arm.activity, &place.name) {
            Some(said) => said,
            None if arm.is_stuck_inside => alarms::arm_stuck(&place.name),
            None => return None,
        };
        let subject = AlarmSubject::new(SubjectKind::Station, place.name.clone());
        let one = AlarmCondition::new(AlarmKind::ArmTrouble, subject, text);
        Some(one.at(map.nodes[place.node].at))
    };
    view.stations.iter().enumerate().filter_map(condition).collect()
}

/// Why an arm gets no trajectory, in words; nothing if the arm's own stop holds it.
fn wrong_with(activity: ArmActivity, station: &str) -> Option<Sentence> {
    let why = match activity {
        ArmActivity::Trouble(why) => why,
        ArmActivity::Off | ArmActivity::Idle | ArmActivity::Moving => return None,
    };
    match why {
        ArmTrouble::Stopped => None,
        ArmTrouble::Silent => Some(alarms::arm_silent(station)),
        ArmTrouble::Late => Some(alarms::arm_late(station)),
        ArmTrouble::Joints => Some(alarms::arm_joints(station)),
        ArmTrouble::Jump => Some(alarms::arm_jump(station)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ArmView, Settings};
    use giveway_floor::time::Time;
    use giveway_floor::warehouse::stations;
    use std::sync::Arc;

    /// The text about the arm at the first station.
    fn said(activity: ArmActivity, is_stuck_inside: bool) -> Option<String> {
        let fleet = Fleet::new(Arc::new(stations()), Settings::default());
        let mut view = fleet.view(Time::ZERO);
        view.stations[0].arm = Some(ArmView { activity, line: None, is_stuck_inside });
        let found = conditions(&fleet, &view);
        assert!(found.iter().all(|c| c.kind == AlarmKind::ArmTrouble));
        found.into_iter().next().map(|c| c.text.to_string())
    }

    #[test]
    fn an_arm_in_trouble_or_stuck_in_the_opening_is_an_alarm_and_one_that_waits_or_was_never_heard_of_is_not()
    {
        let well = [
            ArmActivity::Off,
            ArmActivity::Idle,
            ArmActivity::Moving,
            ArmActivity::Trouble(ArmTrouble::Stopped),
        ];
        for activity in well {
            assert_eq!(said(activity, false), None, "{activity:?}");
        }
        for why in [ArmTrouble::Silent, ArmTrouble::Late, ArmTrouble::Joints, ArmTrouble::Jump] {
            assert!(
                said(ArmActivity::Trouble(why), false).unwrap().contains("it gets no trajectory"),
                "{why}"
            );
        }
        for activity in [ArmActivity::Moving, ArmActivity::Trouble(ArmTrouble::Stopped)] {
            assert!(said(activity, true).unwrap().contains("has not moved in the opening"), "{activity:?}");
        }
    }
}
