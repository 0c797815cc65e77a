//! Whether the floor flows: stations get the racks that robots have for them, and robots at work make progress.
//!
//! Main type: [`FlowWatch`]. There are two thresholds each, so that the condition does not come and go: a station is
//! dry after [`DRY`] and until a rack has been picked from there for [`SERVES`]; the fleet stands once [`MOST`] of the
//! robots at work wait and until fewer than [`FEW`] do. Robots that wait for their turn at a station that picks do not
//! count: the station works as fast as it can. Refuses: to report what follows from a cause that has a condition of its
//! own.

use super::condition::{AlarmCondition, AlarmSubject, SubjectKind, some_of};
use super::kind::AlarmKind;
use super::roots::Roots;
use crate::{Activity, Fleet, Party, RobotView, StationView, Task, View, Why};
use giveway_floor::id::{Dense, RobotId, StationId};
use giveway_floor::text::sentence::alarms;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// A station is dry if nothing has been picked there for this long though a robot stands outside with a rack for it.
const DRY: Span = Span::from_secs(180);
/// A station is no longer dry once a rack has been picked from there for this long.
const SERVES: Span = Span::from_secs(3);
/// A rack that stood outside within this still does: its robot has moved up, or tries another way.
const OUTSIDE: Span = Span::from_secs(30);
/// The fleet stands if this share of the robots at work has waited for this long...
const MOST: (f64, Span) = (0.5, Span::from_secs(120));
/// ...and until the share is less than this.
const FEW: f64 = 0.4;
/// Fewer robots at work than this are no fleet: two of three may wait for one another's turn.
const FLEET: usize = 8;

/// What is remembered of stations and of the fleet from look to look.
#[derive(Clone, Debug, Default)]
pub(super) struct FlowWatch {
    stations: BTreeMap<StationId, Dry>,
    /// Since when most robots have waited.
    stands: Option<Time>,
}

/// A station at which nothing is picked though a rack stands outside.
#[derive(Clone, Copy, Debug)]
struct Dry {
    since: Time,
    /// When a rack was last seen outside.
    outside: Time,
    /// Since when a rack has been picked from again.
    serves: Option<Time>,
}

impl FlowWatch {
    /// The condition, once it has lasted. `has_cause` says whether the party in which a chain of waiting ends has a
    /// condition of its own.
    pub fn look(
        &mut self,
        fleet: &Fleet,
        view: &View,
        roots: &Roots,
        has_cause: impl Fn(Party) -> bool,
    ) -> Option<AlarmCondition> {
        let waits = |(i, robot): (usize, &RobotView)| {
            let id = RobotId::at(i);
            (robot.activity == Activity::Waiting && !has_cause(roots.root(id))).then_some(id)
        };
        let waiting: Vec<RobotId> = view.robots.iter().enumerate().filter_map(waits).collect();
        let dry = self.dry(fleet, view, &waiting);
        let standing = self.standing(view, &waiting);
        if dry.is_empty() && standing.is_none() {
            return None;
        }
        let name = |s: &StationId| fleet.warehouse().stations[*s].name.clone();
        let names: Vec<String> = dry.iter().map(|(s, _)| name(s)).collect();
        let behind = most_behind(fleet, roots, &waiting).map(alarms::most_wait_behind);
        let (stations, at_work) = ((!names.is_empty()).then(|| some_of(&names)), standing.map(|s| s.0));
        let said = in_words(stations, (waiting.len(), at_work), behind)?;
        let since = dry.iter().map(|(_, since)| *since).chain(standing.map(|(_, since)| since)).min();
        let subject = match &names[..] {
            [one] => AlarmSubject::new(SubjectKind::Station, one.clone()),
            _ => AlarmSubject::floor(),
        };
        let one = AlarmCondition::new(AlarmKind::Flow, subject, said);
        Some(AlarmCondition { waiting: waiting.len(), since, ..one })
    }

    /// Stations that have been dry for long, and since when.
    fn dry(&mut self, fleet: &Fleet, view: &View, waiting: &[RobotId]) -> Vec<(StationId, Time)> {
        let now = view.now;
        for robot in waiting {
            let row = &view.robots[robot.ix()];
            let Task::Deliver { station, .. } = row.task else { continue };
            let Some(station) = fleet.warehouse().nodes[station].kind.reserved_for() else { continue };
            if row.rack.is_some() && !is_at(&view.stations[station.ix()], *robot) {
                let fresh = Dry { since: now, outside: now, serves: None };
                self.stations.entry(station).or_insert(fresh).outside = now;
            }
        }
        self.stations.retain(|station, dry| {
            let seen = &view.stations[station.ix()];
            dry.serves = seen.picking.then(|| dry.serves.unwrap_or(now));
            let is_dry = dry.serves.is_none_or(|since| now - since < SERVES);
            // A station that was not dry for long begins anew with every pick.
            let began = dry.serves.is_some() && now - dry.since <= DRY;
            is_dry && !began && seen.paused.is_none() && now - dry.outside <= OUTSIDE
        });
        let long = self.stations.iter().filter(|(_, dry)| now - dry.since > DRY);
        long.map(|(station, dry)| (*station, dry.since)).collect()
    }

    /// How many robots are at work, and since when most of them have waited, if they have for long.
    fn standing(&mut self, view: &View, waiting: &[RobotId]) -> Option<(usize, Time)> {
        let at_work = view.robots.iter().filter(|r| r.task != Task::Idle && is_free(r)).count();
        let picks = |s: StationId| view.stations.get(s.ix()).is_some_and(|s| s.picking);
        let has_its_reason = |r: &RobotId| {
            let why = view.robots[r.ix()].why;
            why.and_then(Why::station).is_some_and(picks)
        };
        let stands = waiting.iter().filter(|r| !has_its_reason(r)).count();
        let share = stands as f64 / at_work.max(FLEET) as f64;
        let least = if self.stands.is_some() { FEW } else { MOST.0 };
        self.stands = (share >= least).then(|| self.stands.unwrap_or(view.now));
        let since = self.stands.filter(|since| view.now - *since > MOST.1)?;
        Some((at_work, since))
    }
}

/// What does not flow: stations that idle, and how many of the robots at work wait.
fn in_words(
    stations: Option<SentenceArg>,
    (waiting, at_work): (usize, Option<usize>),
    behind: Option<Sentence>,
) -> Option<Sentence> {
    match (stations, at_work) {
        (Some(stations), Some(robots)) => {
            Some(alarms::stations_dry_and_robots_stand(stations, waiting, robots, behind))
        }
        (Some(stations), None) => Some(alarms::stations_dry(stations, behind)),
        (None, Some(robots)) => Some(alarms::robots_stand(waiting, robots, behind)),
        (None, None) => None,
    }
}

/// Whether no reason that is about the robot itself keeps it from driving.
fn is_free(robot: &RobotView) -> bool {
    !robot.why.is_some_and(Why::is_by_itself)
}

/// Whether a robot stands at a station or in its queue.
fn is_at(station: &StationView, robot: RobotId) -> bool {
    station.robot == Some(robot) || station.queue.contains(&robot)
}

/// The name of the party for which more than half of these robots wait in the end, if there is one.
fn most_behind(fleet: &Fleet, roots: &Roots, waiting: &[RobotId]) -> Option<String> {
    let mut behind: BTreeMap<Party, usize> = BTreeMap::new();
    for robot in waiting {
        let root = roots.root(*robot);
        if root != Party::Robot(*robot) {
            *behind.entry(root).or_default() += 1;
        }
    }
    let (first, number) =
        behind.into_iter().max_by_key(|(party, number)| (*number, std::cmp::Reverse(*party)))?;
    let name = match first {
        Party::Robot(r) => fleet.ledger().robots[r].name.clone(),
        Party::Worker(w) => format!("w{}", w.0 + 1),
    };
    (2 * number > waiting.len()).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;
    use giveway_floor::warehouse::{NodeKind, thesis};
    use std::sync::Arc;

    /// A fleet of which `waiting` robots wait outside the first station and the others drive, looked at every second.
    struct FlowFloor {
        fleet: Fleet,
        view: View,
        watch: FlowWatch,
    }

    impl FlowFloor {
        fn new() -> FlowFloor {
            let fleet = Fleet::new(Arc::new(thesis()), Settings::default());
            let mut view = fleet.view(Time::ZERO);
            let rests = |k| matches!(k, NodeKind::Parking | NodeKind::Charger);
            let places = fleet.warehouse().nodes_where(rests);
            let registered = places.iter().take(10).enumerate().map(|(i, node)| {
                crate::Fact::Robot(crate::RobotFact::Registered {
                    robot: RobotId::at(i),
                    name: format!("robot-{}", i + 1),
                    kind: crate::USUAL_KIND.into(),
                    node: *node,
                    at: Time::ZERO,
                })
            });
            let fleet = Fleet::restore(
                fleet.warehouse().clone(),
                Settings::default(),
                registered.collect::<Vec<_>>(),
            );
            view.robots = fleet.view(Time::ZERO).robots;
            FlowFloor { fleet, view, watch: FlowWatch::default() }
        }

        /// The last text after this many seconds.
        fn look(&mut self, seconds: i64, waiting: usize, picks: bool) -> Option<String> {
            let map = self.fleet.warehouse().clone();
            let (job, rack) = (giveway_floor::id::JobId(1), giveway_floor::id::RackId(0));
            let station = map.stations[StationId(0)].node;
            let store = map.nodes_where(|k| k == NodeKind::Storage)[0];
            for (i, robot) in self.view.robots.iter_mut().enumerate() {
                robot.task = Task::Deliver { job, rack, station, store };
                robot.rack = Some(rack);
                robot.activity = if i < waiting { Activity::Waiting } else { Activity::Driving };
                robot.why = (i < waiting).then_some(Why::NotItsTurn(StationId(0), RobotId::at(9)));
            }
            self.view.stations[0].picking = picks;
            let mut said = None;
            for _ in 0..seconds {
                self.view.now += Span::from_secs(1);
                let roots = Roots::default();
                said =
                    self.watch.look(&self.fleet, &self.view, &roots, |_| false).map(|c| c.text.to_string());
            }
            said
        }
    }

    #[test]
    fn a_station_that_idles_beside_waiting_racks_is_said_to_be_dry_until_it_picks_again() {
        let mut shown = FlowFloor::new();
        let name = shown.fleet.warehouse().stations[StationId(0)].name.clone();
        assert_eq!(shown.look(180, 1, false), None, "not yet");
        let said = shown.look(5, 1, false).expect("it is dry");
        assert_eq!(said, format!("no rack is picked at {name}, though robots stand outside with racks."));
        assert!(shown.look(20, 0, false).is_some(), "the robot may just have moved up");
        assert!(shown.look(2, 1, true).is_some(), "a moment's pick is none");
        assert_eq!(shown.look(3, 1, true), None, "it picks");
        assert_eq!(shown.look(100, 1, false), None, "the time begins anew");
    }

    #[test]
    fn half_of_a_fleet_that_waits_is_said_to_until_fewer_do() {
        let mut shown = FlowFloor::new();
        assert_eq!(shown.look(120, 4, true), None);
        assert_eq!(shown.look(300, 6, true), None, "they wait for their turn at a station that picks");
        let mut shown = FlowFloor::new();
        assert_eq!(shown.look(119, 5, false), None, "not yet");
        let said = shown.look(3, 5, false).expect("half of them");
        assert_eq!(said, "5 of 10 robots at work wait.");
        assert!(shown.look(3, 4, false).is_some(), "as long as it is about half");
        assert_eq!(shown.look(1, 3, false), None);
        assert_eq!(shown.look(30, 5, false), None, "the time begins anew");
    }
}
