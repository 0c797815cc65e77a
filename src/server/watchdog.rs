//! The laws of the simulation that make sense live, cheap and sampled: a broken one is an alarm.
//!
//! Main types: [`Watchdog`] (progress of robots, grants), [`Auditor`] (reservations, and jobs against the robots that
//! serve them, looked at where the journal's task folds what is durable, so that the control loop pays nothing).
//! Refuses: to mend anything, and to look at everything in one turn of the loop.

use super::start::panic_text;
use crate::api::displaced::words;
use crate::api::port::Alarms;
use crate::fleet::{ChainEnd, Fault, Fleet, Ledger, LostWorker, Party, Standstill, Task};
use crate::id::RobotId;
use crate::sim::laws::STUCK;
use crate::time::{Span, Time};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The alarm while a robot makes no progress.
const STANDS: &str = "progress";
/// The alarm while robots and people wait, and nothing that goes on by itself will set them free.
const STANDSTILL: &str = "standstill";
/// The alarm when a robot says that it is beyond what it was granted.
const BEYOND: &str = "grant";
/// The alarm while a robot stands where it is not booked.
const DISPLACED: &str = "displaced";
/// The alarm while nobody knows where a worker is.
const LOST: &str = "worker";
/// The alarm while a robot says that something is wrong that only a person can put right.
const FAULTS: &str = "faults";
/// The alarm when what was promised contradicts itself.
const UNSOUND: &str = "ledger";
/// A standstill that the fleet did not end within this is an alarm.
const LASTS: Span = Span::from_secs(60);
/// A worker whom no source has known for so long has to be looked for.
const LOST_LONG: Span = Span::from_secs(30);
/// Robots are looked at this often.
const LOOKS: Span = Span::from_secs(5);
/// So many facts are taken in between two looks at everything that was promised.
const AUDIT_AFTER: usize = 20_000;

/// What a robot had last done, and since when it has done nothing more.
type Progress = (u64, Option<u64>, Time);

/// Looks at robots now and then.
#[derive(Debug, Default)]
pub struct Watchdog {
    looked: Option<Time>,
    progress: BTreeMap<RobotId, Progress>,
}

impl Watchdog {
    /// Raises and ends alarms about robots; every few seconds, whatever it is called.
    pub fn look(&mut self, fleet: &Fleet, now: Time, alarms: &Alarms) {
        if self.looked.is_some_and(|at| now - at < LOOKS) {
            return;
        }
        self.looked = Some(now);
        let stands = self.without_progress(fleet, now);
        set(alarms, STANDS, now, &stands, |names| {
            let seconds = STUCK.0 / 1_000_000;
            format!("no progress for {seconds} s: {names}. GET /v1/robots/NAME/why says what each waits for.")
        });
        let standing = standstills(fleet, now);
        set(alarms, STANDSTILL, now, &standing, |found| {
            format!(
                "nobody gets on by themselves: {found}. GET /v1/robots/NAME/why says what each waits for."
            )
        });
        let lost = lost_workers(fleet, now);
        set(alarms, LOST, now, &lost, |found| {
            format!(
                "nobody knows where a worker is: {found}. Look there, and POST /v1/workers/ID/clear if the worker has \
                 left."
            )
        });
        let displaced = displaced(fleet);
        set(alarms, DISPLACED, now, &displaced, str::to_owned);
        let faults = faults(fleet, now);
        set(alarms, FAULTS, now, &faults, |names| format!("a person is needed: {names}."));
        let beyond = beyond_grant(fleet);
        set(alarms, BEYOND, now, &beyond, |names| {
            format!("robots report more than they were granted: {names}. Stop them and check where they are.")
        });
    }

    /// Robots that have had something to do for long and did not get on.
    fn without_progress(&mut self, fleet: &Fleet, now: Time) -> Vec<String> {
        let ledger = fleet.ledger();
        let mut found = Vec::new();
        for (robot, record) in ledger.robots.pairs().filter(|(_, r)| !r.is_gone()) {
            let done = (ledger.chain(robot).first(), record.acted);
            let entry = self.progress.entry(robot).or_insert((done.0, done.1, now));
            // A robot that is failed, or told to stand, has an alarm or a state of its own; a pick takes as long as it
            // takes.
            let excused = record.task == Task::Idle
                || record.failed
                || record.fenced.is_some()
                || record.paused.is_some()
                || ledger.stopped.is_some()
                || fleet.is_picked_from(robot);
            if (entry.0, entry.1) != done || excused {
                *entry = (done.0, done.1, now);
            } else if now - entry.2 > STUCK {
                found.push(record.name.clone());
            }
        }
        found
    }
}

/// Standstills that have lasted for long, each in words.
fn standstills(fleet: &Fleet, now: Time) -> Vec<String> {
    let ledger = fleet.ledger();
    let name = |party: &Party| match party {
        Party::Robot(r) => ledger.robots[*r].name.clone(),
        Party::Worker(w) => ledger.workers.get(*w).cloned().unwrap_or_else(|| format!("worker {}", w.0 + 1)),
    };
    let found = fleet.standstills().into_iter().filter(|s| now - s.since > LASTS);
    found.map(|s| in_words(&s, name)).collect()
}

/// Workers whom no source has known for long, each with how many robots wait for that.
fn lost_workers(fleet: &Fleet, now: Time) -> Vec<String> {
    let workers = &fleet.ledger().workers;
    let words = |lost: LostWorker| {
        let name =
            workers.get(lost.worker).cloned().unwrap_or_else(|| format!("worker {}", lost.worker.0 + 1));
        let robots = match lost.waiting.len() {
            0 => "no robot waits".to_owned(),
            1 => "1 robot waits".to_owned(),
            n => format!("{n} robots wait"),
        };
        let seconds = LOST_LONG.0 / 1_000_000;
        format!("{name} (w{}) for more than {seconds} s, {robots}", lost.worker.0 + 1)
    };
    fleet.lost_workers(LOST_LONG, now).into_iter().map(words).collect()
}

/// What stands still, with names.
fn in_words(found: &Standstill, name: impl Fn(&Party) -> String) -> String {
    let roots: Vec<String> = found.root.iter().map(&name).collect();
    let root = roots.join(" and ");
    let behind = match &found.behind[..] {
        [] => String::new(),
        [one] => format!("; {} waits for that", name(one)),
        [first, others @ ..] => format!("; {} and {} more wait for that", name(first), others.len()),
    };
    match found.root.first() {
        Some(_) if matches!(found.end, ChainEnd::Cycle(_)) => format!("{root} wait for one another{behind}"),
        Some(Party::Worker(_)) => format!("{root} stands in the way{behind}"),
        _ => format!("{root} has no way to go{behind}"),
    }
}

/// Robots that cannot go on from where they stand, each with why and what to do.
fn displaced(fleet: &Fleet) -> Vec<String> {
    let (ledger, map) = (fleet.ledger(), fleet.warehouse());
    let name = |r: RobotId| ledger.robots[r].name.clone();
    let found = ledger.present().filter_map(|r| Some((r, fleet.displacement(r)?)));
    found.map(|(r, why)| format!("{} {}", name(r), words(map, name, why))).collect()
}

/// Robots that a person has to look after, each with why. A robot that is broken counts as failed and is listed as
/// that; one that is driven by hand has a person with it; an obstructed one looks for another way.
fn faults(fleet: &Fleet, now: Time) -> Vec<String> {
    let words = |robot: RobotId| match fleet.telemetry(robot)?.fault? {
        Fault::EmergencyStop => Some("emergency stop pressed"),
        Fault::Unplugged => Some("no current from its charger"),
        Fault::Broken | Fault::Manual | Fault::Obstructed => None,
    };
    let robots = fleet.ledger().robots.pairs();
    robots
        .filter_map(|(r, record)| {
            Some(format!("{} ({})", record.name, back(fleet, r, now).or_else(|| words(r))?))
        })
        .collect()
}

/// A robot that has left and can be heard: other robots do not make way for it.
fn back(fleet: &Fleet, robot: RobotId, now: Time) -> Option<&'static str> {
    let heard = fleet.telemetry(robot).is_some_and(|t| now - t.seen <= LOOKS + LOOKS);
    (fleet.ledger().robots[robot].is_gone() && heard)
        .then_some("has left the floor but still reports: register it again")
}

/// Robots that say that they reached, or know of, more than they were granted.
fn beyond_grant(fleet: &Fleet) -> Vec<String> {
    let ledger = fleet.ledger();
    let beyond = |r: &RobotId| {
        let granted = ledger.chain(*r).granted();
        fleet.telemetry(*r).is_some_and(|t| t.reached.max(t.known) >= granted)
    };
    ledger.present().filter(beyond).map(|r| ledger.robots[r].name.clone()).collect()
}

fn set(alarms: &Alarms, id: &'static str, now: Time, names: &[String], text: impl Fn(&str) -> String) {
    if names.is_empty() {
        alarms.clear(id);
        return;
    }
    let more = if names.len() > 3 { format!(" and {} more", names.len() - 3) } else { String::new() };
    let text = text(&format!("{}{more}", names[..names.len().min(3)].join(", ")));
    if alarms.raise(id, text.clone(), now) {
        tracing::error!("{text}");
    }
}

/// Looks at everything that was promised, after so many facts.
#[derive(Debug, Default)]
pub struct Auditor {
    facts: usize,
}

impl Auditor {
    /// So many facts were taken in.
    pub fn note(&mut self, facts: usize, ledger: &Ledger, now: Time, alarms: &Alarms) {
        self.facts += facts;
        if self.facts < AUDIT_AFTER {
            return;
        }
        self.facts = 0;
        match catch_unwind(AssertUnwindSafe(|| ledger.assert_sound())) {
            Ok(()) => _ = alarms.clear(UNSOUND),
            Err(panic) => {
                let said = panic_text(&*panic);
                let text = format!(
                    "the ledger contradicts itself: {said}. Keep a copy of the database and restart Giveway."
                );
                if alarms.raise(UNSOUND, text.clone(), now) {
                    tracing::error!("{text}");
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::{Fact, Input, JobKind, JobRequest, Settings, Telemetry};
    use crate::id::{JobId, NodeId};
    use crate::warehouse::lab;
    use std::sync::Arc;

    fn fleet() -> Fleet {
        let map = Arc::new(lab());
        let node = map.node_named("R118").expect("a charger of the laboratory");
        let robot = RobotId(0);
        let kind = JobKind::Park { robot };
        let request = JobRequest { kind, priority: 0, deadline: None, after: vec![], key: None };
        let task = Task::Move {
            job: Some(JobId(1)),
            goal: NodeId(0),
            stay: NodeId(0),
            purpose: crate::fleet::Purpose::Park,
        };
        let facts = vec![
            Fact::Registered { robot, name: "robot-1".into(), kind: "robot".into(), node, at: Time(1) },
            Fact::Accepted { job: JobId(1), request, at: Time(1) },
            Fact::Progressed {
                job: JobId(1),
                state: crate::fleet::JobState::Assigned { robot },
                tasked: Some((robot, task)),
                at: Time(1),
            },
        ];
        Fleet::restore(map, Settings::default(), facts)
    }

    #[test]
    fn a_robot_that_makes_no_progress_is_an_alarm_until_it_does() {
        let (fleet, alarms, mut watchdog) = (fleet(), Alarms::default(), Watchdog::default());
        let at = |s: i64| Time(s * 1_000_000);
        watchdog.look(&fleet, at(0), &alarms);
        watchdog.look(&fleet, at(599), &alarms);
        assert!(alarms.list().is_empty());
        watchdog.look(&fleet, at(606), &alarms);
        let listed = alarms.list();
        assert!(listed.len() == 1 && listed[0].text.contains("robot-1"), "{listed:?}");
        // It is let off as soon as it has nothing to do.
        let idle = Fleet::new(fleet.warehouse().clone(), Settings::default());
        watchdog.look(&idle, at(612), &alarms);
        assert!(alarms.list().is_empty());
    }

    /// A fleet of one robot that rests at a charger, after these facts about it.
    fn resting(facts: impl IntoIterator<Item = Fact>) -> Fleet {
        let map = Arc::new(lab());
        let (name, kind) = ("robot-1".into(), "robot".into());
        let node = map.node_named("R118").expect("a charger of the laboratory");
        let joins = Fact::Registered { robot: RobotId(0), name, kind, node, at: Time(1) };
        Fleet::restore(map, Settings::default(), [joins].into_iter().chain(facts))
    }

    /// What the robot of such a fleet reports where it rests.
    fn report(fleet: &Fleet, seen: Time, fault: Option<Fault>) -> Telemetry {
        let at = fleet.warehouse().nodes[fleet.ledger().node_of(RobotId(0))].at;
        Telemetry {
            robot: RobotId(0),
            seen,
            pose: crate::geometry::Pose { at, heading: 0.0 },
            speed_mps: 0.0,
            reached: 0,
            known: 0,
            acted: None,
            rack: None,
            battery: 1.0,
            fault,
            limit_mps: None,
            recalls: 0,
        }
    }

    #[test]
    fn a_robot_that_left_is_an_alarm_while_it_reports() {
        let (robot, at) = (RobotId(0), Time(1));
        let mut fleet = resting([Fact::Retired { robot, at }, Fact::Left { robot, at }]);
        let (alarms, mut watchdog) = (Alarms::default(), Watchdog::default());
        let mut look = |s: i64, reports: bool| {
            let now = Time(s * 1_000_000);
            let said = reports.then(|| Input::Telemetry(report(&fleet, now, None)));
            fleet.step(now, said.into_iter().collect());
            watchdog.look(&fleet, now, &alarms);
            alarms.list().len()
        };
        assert_eq!((look(10, false), look(20, true), look(40, false)), (0, 1, 0));
    }

    #[test]
    fn a_worker_who_is_lost_is_one_alarm_until_seen_again() {
        let mut fleet = Fleet::new(Arc::new(lab()), Settings::default());
        let (alarms, mut watchdog) = (Alarms::default(), Watchdog::default());
        let joins = Input::RegisterWorker { token: 0, name: "ana".into() };
        fleet.step(Time(1), vec![joins]);
        let at = fleet.warehouse().nodes[fleet.warehouse().node_named("R32").unwrap()].at;
        let mut look = |s: i64, seen: bool| {
            let now = Time(s * 1_000_000);
            let sighting = crate::human::Sighting {
                worker: crate::id::WorkerId(0),
                source: crate::human::SourceId::Tag,
                seen: now,
                epoch: 0,
                at_marks: false,
                seq: s.unsigned_abs(),
                at,
                heading: None,
                accuracy_m: 0.2,
                quality: crate::human::Quality::Tracked,
            };
            fleet.step(now, seen.then_some(Input::Sighted(sighting)).into_iter().collect());
            watchdog.look(&fleet, now, &alarms);
            alarms.list().iter().map(|a| a.text.clone()).collect::<Vec<_>>()
        };
        assert_eq!((look(1, true), look(25, false)), (vec![], vec![]));
        let told = look(40, false);
        assert!(
            told.len() == 1 && told[0].contains("ana (w1) for more than 30 s, no robot waits"),
            "{told:?}"
        );
        assert_eq!(look(50, true), [""; 0]);
    }

    #[test]
    fn an_emergency_stop_is_an_alarm_until_it_is_released() {
        let mut fleet = resting([]);
        let (alarms, mut watchdog) = (Alarms::default(), Watchdog::default());
        let mut says = |s: i64, fault: Option<Fault>| {
            let seen = Time(s * 1_000_000);
            let said = report(&fleet, seen, fault);
            fleet.step(seen, vec![Input::Telemetry(said)]);
            watchdog.look(&fleet, seen, &alarms);
            alarms.list().iter().map(|a| a.text.clone()).collect::<Vec<_>>()
        };
        assert_eq!(says(1, None), [""; 0]);
        assert_eq!(
            says(10, Some(Fault::EmergencyStop)),
            ["a person is needed: robot-1 (emergency stop pressed)."]
        );
        assert_eq!(says(20, Some(Fault::Manual)), [""; 0], "a person is with it");
        assert_eq!(says(30, None), [""; 0]);
    }

    #[test]
    fn a_standstill_is_told_with_names() {
        let (robot, worker) = (Party::Robot(RobotId(3)), Party::Worker(crate::id::WorkerId(0)));
        let name = |p: &Party| if *p == worker { "Ana".to_owned() } else { "robot-4".to_owned() };
        let told = |end, root: &[Party], behind: &[Party]| {
            in_words(&Standstill { end, root: root.into(), behind: behind.into(), since: Time(1) }, name)
        };
        assert_eq!(
            told(ChainEnd::Cycle(robot), &[robot, worker], &[]),
            "robot-4 and Ana wait for one another"
        );
        assert_eq!(
            told(ChainEnd::Still(worker), &[worker], &[robot]),
            "Ana stands in the way; robot-4 waits for that"
        );
        assert_eq!(
            told(ChainEnd::Still(robot), &[robot], &[robot, robot, robot]),
            "robot-4 has no way to go; robot-4 and 2 more wait for that"
        );
    }

    #[test]
    fn promises_that_contradict_each_other_are_an_alarm() {
        let (fleet, alarms, mut auditor) = (fleet(), Alarms::default(), Auditor::default());
        auditor.note(AUDIT_AFTER, fleet.ledger(), Time(1), &alarms);
        assert!(alarms.list().is_empty());
        let mut parts = fleet.ledger().to_parts();
        parts.promises.robots[RobotId(0)].task = Task::Idle;
        let (warehouse, clearance) = (fleet.warehouse().clone(), fleet.settings().clearance());
        let broken = Ledger::from_parts(warehouse, clearance, parts).expect("it says nothing of jobs");
        auditor.note(1, &broken, Time(1), &alarms);
        assert!(alarms.list().is_empty(), "not every time");
        auditor.note(AUDIT_AFTER, &broken, Time(1), &alarms);
        assert_eq!(alarms.list()[0].id, UNSOUND);
    }
}
