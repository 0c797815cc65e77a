//! If many robots have the same trouble, one alarm calls, with the alarms of the single robots as its members.
//!
//! Main types: [`Gathering`] (which kinds are gathered, with hysteresis), [`AlarmMember`]. Members keep their numbers,
//! places, notes and acknowledgements while they are in a group and after it. Refuses: to forget a member, and to
//! decide how long a cause must last.

use super::condition::{AlarmCondition, AlarmSubject, some_of};
use super::kind::{AlarmKind, AlarmSeverity};
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::text::sentence::alarms;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::Time;
use std::collections::{BTreeMap, BTreeSet};

/// A kind is grouped if more robots than this have it.
pub(super) const MANY: usize = 5;
/// A kind stays grouped until no more robots than this have it, so that one robot that comes and goes changes nothing.
pub(super) const FEW: usize = 3;

/// One of the alarms in a group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmMember {
    /// The number of the alarm.
    pub id: u64,
    /// The subject with which something is wrong.
    pub subject: AlarmSubject,
    /// The alarm in words.
    pub text: Sentence,
    /// Where the cause is, if it is in one place.
    pub at: Option<Spot>,
    /// Since when the cause has been there.
    pub since: Time,
    /// The person who has acknowledged the alarm.
    pub acknowledged_by: Option<String>,
}

/// Which kinds are grouped.
#[derive(Clone, Debug, Default)]
pub(super) struct Gathering(BTreeSet<AlarmKind>);

impl Gathering {
    /// All that is wrong with robots, and one condition for each kind that many of them have.
    pub fn gather(&mut self, mut found: Vec<AlarmCondition>, robots: usize) -> Vec<AlarmCondition> {
        let mut by_kind: BTreeMap<AlarmKind, Vec<&AlarmCondition>> = BTreeMap::new();
        for condition in found.iter().filter(|c| c.kind.is_about_a_robot()) {
            by_kind.entry(condition.kind).or_default().push(condition);
        }
        let was = std::mem::take(&mut self.0);
        let is_gathered = |kind: &AlarmKind, n: usize| n > MANY || (n > FEW && was.contains(kind));
        by_kind.retain(|kind, members| is_gathered(kind, members.len()));
        self.0 = by_kind.keys().copied().collect();
        let groups: Vec<_> = by_kind.iter().map(|(kind, members)| group(*kind, members, robots)).collect();
        found.extend(groups);
        found
    }
}

fn group(kind: AlarmKind, members: &[&AlarmCondition], robots: usize) -> AlarmCondition {
    let names: Vec<String> = members.iter().map(|c| c.subject.id.clone()).collect();
    let waiting = members.iter().map(|c| c.waiting).sum();
    let text = of_many(kind, (members.len(), robots), some_of(&names), waiting);
    let all = AlarmCondition::new(kind, AlarmSubject::floor(), text).at_least(AlarmSeverity::Critical);
    let since = members.iter().filter_map(|c| c.since).min();
    AlarmCondition { waiting, since, at: middle(members.iter().filter_map(|c| c.at)), ..all }
}

/// The text for a kind of trouble that this many of all robots have.
fn of_many(kind: AlarmKind, (count, all): (usize, usize), names: SentenceArg, waiting: usize) -> Sentence {
    let waiting = match waiting {
        0 => None,
        1 => Some(alarms::one_robot_waits_for_them()),
        n => Some(alarms::robots_wait_for_them(n)),
    };
    use AlarmKind as K;
    match kind {
        K::RobotFailed => alarms::robots_failed(count, all, names, waiting),
        K::EmergencyStop => alarms::robots_emergency_stop(count, all, names, waiting),
        K::RobotSilent => alarms::robots_silent(count, all, names, waiting),
        K::RobotDisplaced => alarms::robots_displaced(count, all, names, waiting),
        K::RobotObstructed => alarms::robots_obstructed(count, all, names, waiting),
        K::RobotUnplugged => alarms::robots_unplugged(count, all, names, waiting),
        K::RobotLow => alarms::robots_low(count, all, names, waiting),
        K::RobotBlocked => alarms::robots_find_no_route(count, all, names, waiting),
        K::RobotStuck => alarms::robots_stuck(count, all, names, waiting),
        K::BeyondGrant => alarms::robots_beyond_grant(count, all, names, waiting),
        K::RobotReturned => alarms::robots_returned(count, all, names, waiting),
        // These are about one robot each, or about none; no group of them is made.
        K::RobotFenced
        | K::WaitsInVain
        | K::Standstill
        | K::FloorStandstill
        | K::NoDeliveries
        | K::WorkerLost
        | K::WorkerKept
        | K::WorkerInClosedArea
        | K::JobStuck
        | K::DeadlineAtRisk
        | K::DeadlineMissed
        | K::StationStarved
        | K::Flow
        | K::ArmTrouble
        | K::StepsLate
        | K::PlanBacklog
        | K::ForecastBad
        | K::ClockOff
        | K::Journal
        | K::Halt
        | K::Database
        | K::LoopStuck
        | K::Broken
        | K::LedgerUnsound
        | K::BrokerGone
        | K::RobotsTakenOver
        | K::RobotClaims
        | K::PastNotKept
        | K::WebhookFailing
        | K::SecretsGuessed
        | K::RecordingEnded
        | K::Stopped
        | K::Paused
        | K::Evacuation => alarms::robots_in_trouble(count, all, names, waiting),
    }
}

/// The place that is nearest to the mean of all: a real one, unlike the mean.
fn middle(places: impl Iterator<Item = Spot>) -> Option<Spot> {
    let all: Vec<Spot> = places.collect();
    let n = i64::try_from(all.len()).ok().filter(|n| *n > 0)?;
    let mean = |of: fn(&Spot) -> i64| all.iter().map(of).sum::<i64>() / n;
    let centre = Point::from(Spot { x_mm: mean(|s| s.x_mm), y_mm: mean(|s| s.y_mm) });
    let off = |s: &Spot| (Point::from(*s) - centre).norm();
    all.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alarm::SubjectKind;

    fn silent(robots: usize) -> Vec<AlarmCondition> {
        let one = |i: usize| {
            let subject = AlarmSubject::new(SubjectKind::Robot, format!("robot-{i}"));
            let text = alarms::robot_silent("it", SentenceArg::nothing());
            AlarmCondition::new(AlarmKind::RobotSilent, subject, text)
                .at(Spot { x_mm: i as i64 * 1000, y_mm: 0 })
        };
        (0..robots).map(one).collect()
    }

    #[test]
    fn a_kind_is_gathered_above_five_and_stays_so_until_three() {
        let mut gathering = Gathering::default();
        let counts = [5, 6, 5, 6, 4, 5, 3, 4, 5, 6];
        let is_group = counts.map(|n| gathering.gather(silent(n), 9).len() > n);
        assert_eq!(is_group, [false, true, true, true, true, true, false, false, false, true]);
    }

    #[test]
    fn a_group_stands_at_the_place_of_a_member() {
        let found = Gathering::default().gather(silent(7), 9);
        let group = found.last().expect("a group");
        assert_eq!((group.subject.kind, group.at), (SubjectKind::Floor, Some(Spot { x_mm: 3000, y_mm: 0 })));
        assert_eq!(found.len(), 8, "its members are there as well");
    }
}
