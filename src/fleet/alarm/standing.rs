//! Parts of the floor that stand still, and the whole of it.
//!
//! Main functions: [`standstills`], [`whole_floor`]. Refuses: to report a standstill if a robot with a cause of its own
//! stands at the end of the chain, or a person who stopped robots: those are causes.

use super::condition::{AlarmCondition, AlarmSubject, SubjectKind, some_of};
use super::kind::{AlarmKind, AlarmSeverity};
use super::people::called;
use super::robots::RobotWatch;
use super::roots::Roots;
use crate::{ChainEnd, Doing, Edge, Fleet, JobState, JobWhy, Party, Standstill, Task, View, Why};
use giveway_floor::id::{Dense, RobotId};
use giveway_floor::text::sentence::alarms;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// If the fleet has not ended a standstill within this, there is an alarm.
const LASTS: Span = Span::from_secs(60);
/// If nothing has moved on the floor for this long, there is an alarm.
const FLOOR_STANDS: Span = Span::from_secs(60);
/// How many jobs are asked why they wait.
const JOBS: usize = 50;

/// Whether a person wants everything to stand.
pub(super) fn is_stopped(view: &View) -> bool {
    view.stopped.is_some() || view.evacuation.is_some()
}

/// Parts of the floor that stand still.
pub(super) fn standstills(
    fleet: &Fleet,
    view: &View,
    robots: &BTreeMap<RobotId, AlarmCondition>,
) -> Vec<AlarmCondition> {
    let has_cause =
        |s: &Standstill| s.root.iter().any(|p| matches!(p, Party::Robot(r) if robots.contains_key(r)));
    let lasts = |s: &Standstill| view.now - s.since > LASTS;
    let found = fleet.standstills().into_iter().filter(|s| lasts(s) && !has_cause(s));
    found.filter_map(|s| standstill(fleet, view, &s)).collect()
}

fn standstill(fleet: &Fleet, view: &View, found: &Standstill) -> Option<AlarmCondition> {
    let root = *found.root.first()?;
    let name = |party: &Party| match party {
        Party::Robot(r) => SentenceArg::from(&fleet.ledger().robots[*r].name),
        Party::Worker(w) => called(fleet, *w),
    };
    let (subject, at) = match root {
        Party::Robot(r) => {
            let subject = AlarmSubject::new(SubjectKind::Robot, fleet.ledger().robots[r].name.clone());
            (subject, view.robots.get(r.ix()).map(|r| r.pose.at))
        }
        Party::Worker(w) => {
            let at = view.workers.get(w.ix()).and_then(|w| w.pose).map(|pose| pose.at);
            (AlarmSubject::new(SubjectKind::Worker, format!("w{}", w.0 + 1)), at)
        }
    };
    let one = AlarmCondition::new(AlarmKind::Standstill, subject, in_words(found, name));
    let waiting = found.root.iter().chain(&found.behind).filter(|p| **p != root).count();
    Some(AlarmCondition { at: at.map(Into::into), waiting, since: Some(found.since), ..one })
}

/// What stands still, with names.
pub(super) fn in_words(found: &Standstill, name: impl Fn(&Party) -> SentenceArg) -> Sentence {
    let mut roots: Vec<SentenceArg> = found.root.iter().map(&name).collect();
    let last = roots.pop();
    let root = match last {
        Some(last) if !roots.is_empty() => alarms::and(roots, last).into(),
        last => SentenceArg::from(last),
    };
    let behind = match &found.behind[..] {
        [] => None,
        [one] => Some(alarms::one_waits_behind(name(one))),
        [first, others @ ..] => Some(alarms::more_wait_behind(name(first), others.len())),
    };
    match found.root.first() {
        Some(_) if matches!(found.end, ChainEnd::Cycle(_)) => alarms::wait_for_one_another(root, behind),
        Some(Party::Worker(_)) => alarms::stands_in_the_way(root, behind),
        _ => alarms::no_way_to_go(root, behind),
    }
}

/// Reports that nothing moves although there is work. If one cause that was found explains it, that cause becomes
/// critical instead.
pub(super) fn whole_floor(
    fleet: &Fleet,
    view: &View,
    (watch, roots): (&RobotWatch, &Roots),
    (robots, found): (&mut BTreeMap<RobotId, AlarmCondition>, &mut [AlarmCondition]),
) -> Option<AlarmCondition> {
    let ledger = fleet.ledger();
    let is_tasked = |r: &RobotId| ledger.robots[*r].task != Task::Idle;
    let tasked: Vec<RobotId> = ledger.present().filter(is_tasked).collect();
    let stood = tasked.iter().map(|r| watch.without_progress(*r, view.now)).min()?;
    if stood <= FLOOR_STANDS {
        return None;
    }
    let root = |r: &RobotId| if robots.contains_key(r) { Party::Robot(*r) } else { roots.root(*r) };
    let is_explained = |r: &&RobotId| {
        let root = root(r);
        let by_cause = matches!(root, Party::Robot(r) if robots.contains_key(&r));
        by_cause || found.iter().any(|c| is_about(fleet, c, root)) || is_wanted(fleet, root)
    };
    let unexplained = tasked.iter().filter(|r| !is_explained(r));
    let unexplained: Vec<String> = unexplained.map(|r| ledger.robots[*r].name.clone()).collect();
    if !unexplained.is_empty() {
        let said = alarms::floor_stands(some_of(&unexplained));
        let one = AlarmCondition::new(AlarmKind::FloorStandstill, AlarmSubject::floor(), said);
        return Some(AlarmCondition { waiting: unexplained.len(), since: Some(view.now - stood), ..one });
    }
    let all: BTreeSet<Party> = tasked.iter().map(root).collect();
    if let [only] = all.into_iter().collect::<Vec<_>>()[..]
        && tasked.len() > 1
    {
        let of_robot = if let Party::Robot(r) = only { robots.get_mut(&r) } else { None };
        if let Some(one) = of_robot.or_else(|| found.iter_mut().find(|c| is_about(fleet, c, only))) {
            one.severity = AlarmSeverity::Critical;
            one.text = alarms::nothing_else_moves(one.text.clone());
        }
    }
    None
}

/// Remembers from look to look since when jobs have waited while no robot has anything to do.
#[derive(Clone, Debug, Default)]
pub(super) struct IdleFloor {
    since: Option<Time>,
}

impl IdleFloor {
    /// The condition, once it has lasted.
    pub fn look(&mut self, fleet: &Fleet, view: &View) -> Option<AlarmCondition> {
        let ledger = fleet.ledger();
        let idle = ledger.present().all(|r| ledger.robots[r].task == Task::Idle);
        let why = (idle && view.counts.waiting > 0).then(|| unwanted_reason(fleet, view)).flatten();
        let Some((job, why)) = why else {
            self.since = None;
            return None;
        };
        let since = *self.since.get_or_insert(view.now);
        let n = view.counts.waiting;
        let said = alarms::robots_idle(n, &job, why);
        let subject = AlarmSubject::new(SubjectKind::Job, job);
        let one = AlarmCondition::new(AlarmKind::FloorStandstill, subject, said);
        (view.now - since > FLOOR_STANDS).then_some(AlarmCondition { since: Some(since), ..one })
    }
}

/// The first waiting job whose reason no person wanted and no charging robot will end; with the reason in words.
fn unwanted_reason(fleet: &Fleet, view: &View) -> Option<(String, Sentence)> {
    let map = fleet.warehouse();
    let charges = view.robots.iter().any(|r| r.doing == Doing::Charging);
    let waiting = fleet.ledger().jobs.iter().filter(|(_, j)| j.state == JobState::Waiting).take(JOBS);
    let unwanted = waiting.filter_map(|(id, job)| {
        let said = match view.why_job(map, *id, job) {
            // The robots in these reasons have causes of their own.
            Some(
                JobWhy::After(_)
                | JobWhy::StationPaused(_)
                | JobWhy::Robot(..)
                | JobWhy::RobotBusy(..)
                | JobWhy::StationBlocked(..)
                | JobWhy::RackBlocked(..)
                | JobWhy::NodeTaken(..)
                | JobWhy::WayBlocked(_)
                | JobWhy::WayClosed(_)
                | JobWhy::RobotLow(_)
                | JobWhy::NoKind,
            ) => return None,
            Some(JobWhy::NoRobot | JobWhy::Outranked(_)) if charges => return None,
            Some(JobWhy::NoRobot | JobWhy::Outranked(_)) => alarms::no_robot_can_take_it(),
            Some(JobWhy::ClosedOff) => alarms::destination_closed_off(),
            Some(JobWhy::NoPlace(_)) => alarms::no_place_free(),
            Some(JobWhy::StationFull(s) | JobWhy::RacksWait(s, _)) => {
                alarms::enough_racks_wait(&map.stations[s].name)
            }
            Some(JobWhy::RackBusy(rack, ..)) => alarms::its_rack_is_on_a_robot(&map.racks[rack].name),
            None => alarms::nothing_known(),
        };
        Some((format!("j{}", id.0), said))
    });
    unwanted.into_iter().next()
}

/// Whether a condition is about a party.
pub(super) fn is_about(fleet: &Fleet, condition: &AlarmCondition, party: Party) -> bool {
    let (kind, id) = match party {
        Party::Robot(r) => (SubjectKind::Robot, fleet.ledger().robots[r].name.clone()),
        Party::Worker(w) => (SubjectKind::Worker, format!("w{}", w.0 + 1)),
    };
    condition.subject == AlarmSubject::new(kind, id)
}

/// Whether a chain ends in something that a person asked for: a robot that is paused, an area that is closed, a station
/// that is paused.
fn is_wanted(fleet: &Fleet, root: Party) -> bool {
    let Party::Robot(robot) = root else { return false };
    let waits = fleet.wait(root);
    let asked = |why| {
        matches!(why, Why::Paused | Why::Manual | Why::Maintenance | Why::Closed(_) | Why::StationPaused(_))
    };
    waits.edge == Edge::Operator && fleet.why(robot).is_some_and(asked)
}
