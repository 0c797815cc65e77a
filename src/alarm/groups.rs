//! Many robots with the same trouble: one alarm that calls, with those of the single robots as its members.
//!
//! Main types: [`Gathering`] (which kinds are gathered, with hysteresis), [`AlarmMember`]. Members keep their numbers,
//! places, notes and acknowledgements while they are in a group and after it. Refuses: to forget a member, and to
//! decide how long a cause must last.

use super::condition::{AlarmCondition, AlarmSubject, some_of};
use super::kind::{AlarmKind, AlarmSeverity};
use super::roots::robots_wait;
use crate::geometry::{Point, Spot};
use crate::time::Time;
use std::collections::{BTreeMap, BTreeSet};

/// A kind is gathered where more robots than this have it.
pub(super) const MANY: usize = 5;
/// And stays gathered until no more than this do, so that one robot that comes and goes changes nothing.
pub(super) const FEW: usize = 3;

/// One of the alarms in a group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmMember {
    /// Its number.
    pub id: u64,
    /// With what something is wrong.
    pub subject: AlarmSubject,
    /// In words.
    pub text: String,
    /// Where.
    pub at: Option<Spot>,
    /// Since when its cause has been there.
    pub since: Time,
    /// Who has taken note of it.
    pub acknowledged_by: Option<String>,
}

/// Which kinds are gathered.
#[derive(Clone, Debug, Default)]
pub(super) struct Gathering(BTreeSet<AlarmKind>);

impl Gathering {
    /// All that is wrong with robots, and beside it one condition for each kind that many of them have.
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
    let (what, wait) = (kind.of_many(), robots_wait(waiting).replace("for it", "for them"));
    let text = format!("{} of {robots} robots {what}: {}{wait}.", members.len(), some_of(&names));
    let all = AlarmCondition::new(kind, AlarmSubject::floor(), text).at_least(AlarmSeverity::Critical);
    let since = members.iter().filter_map(|c| c.since).min();
    AlarmCondition { waiting, since, at: middle(members.iter().filter_map(|c| c.at)), ..all }
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
            AlarmCondition::new(AlarmKind::RobotSilent, subject, "it sends no reports.")
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
