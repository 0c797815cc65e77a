//! The laws of the simulation that make sense live, cheap and sampled: a broken one is an alarm.
//!
//! Main types: [`Watchdog`] (robots, people and jobs), [`Auditor`] (reservations, and jobs against the robots that
//! serve them). Refuses: to mend anything, and to look at everything in one turn of the loop.

mod auditor;
mod found;
mod jobs;

pub use auditor::Auditor;

use crate::api::port::Alarms;
use crate::api::text::job_name;
use crate::fleet::{Fleet, Task, View};
use crate::id::RobotId;
use crate::sim::laws::{DELIVERS, KEPT, STUCK};
use crate::time::{Span, Time};
use found::{
    beyond_grant, displaced, faults, in_closed_areas, kept_workers, lost_workers, standstills, waits_in_vain,
};
use jobs::JobWatch;
use std::collections::BTreeMap;

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
/// The alarm while the fleet keeps a person in one spot.
const KEPT_LONG: &str = "kept";
/// The alarm while a worker is in an area that is closed to people.
const TRESPASSES: &str = "closed_areas";
/// The alarm while robots wait for what does not keep them.
const IN_VAIN: &str = "waits";
/// The alarm while nothing is delivered.
const UNDELIVERED: &str = "deliveries";
/// The alarm while jobs wait without a reason.
const WITHOUT_REASON: &str = "jobs";
/// Robots are looked at this often.
const LOOKS: Span = Span::from_secs(5);

/// What a robot had last done, and since when it has done nothing more.
type Progress = (u64, Option<u64>, Time);

/// Looks at robots now and then.
#[derive(Debug, Default)]
pub struct Watchdog {
    looked: Option<Time>,
    progress: BTreeMap<RobotId, Progress>,
    /// Robots that waited in vain at the last look.
    in_vain: Vec<String>,
    jobs: JobWatch,
}

impl Watchdog {
    /// Raises and ends alarms about robots, people and jobs; every few seconds, however often it is called.
    pub fn look(&mut self, fleet: &Fleet, view: &View, alarms: &Alarms) {
        let now = view.now;
        if self.looked.is_some_and(|at| now - at < LOOKS) {
            return;
        }
        self.looked = Some(now);
        self.look_at_robots(fleet, now, alarms);
        self.look_at_people(fleet, now, alarms);
        self.look_at_jobs(fleet, view, alarms);
    }

    fn look_at_robots(&mut self, fleet: &Fleet, now: Time, alarms: &Alarms) {
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
        let displaced = displaced(fleet);
        set(alarms, DISPLACED, now, &displaced, str::to_owned);
        let faults = faults(fleet, now);
        set(alarms, FAULTS, now, &faults, |names| format!("a person is needed: {names}."));
        let beyond = beyond_grant(fleet);
        set(alarms, BEYOND, now, &beyond, |names| {
            format!("robots report more than they were granted: {names}. Stop them and check where they are.")
        });
        // What ended in this very step is forgiven.
        let before = std::mem::replace(&mut self.in_vain, waits_in_vain(fleet));
        let both: Vec<String> = self.in_vain.iter().filter(|r| before.contains(r)).cloned().collect();
        set(alarms, IN_VAIN, now, &both, |names| {
            format!(
                "robots wait for what does not keep them: {names}. Pause and resume them, and report this."
            )
        });
    }

    fn look_at_people(&self, fleet: &Fleet, now: Time, alarms: &Alarms) {
        let lost = lost_workers(fleet, now);
        set(alarms, LOST, now, &lost, |found| {
            format!(
                "nobody knows where a worker is: {found}. Look there, and POST /v1/workers/ID/clear if the worker has \
                 left."
            )
        });
        let inside = in_closed_areas(fleet, now);
        set(alarms, TRESPASSES, now, &inside, |found| {
            format!("people are in areas that are closed to them: {found}. Call them out, or open the area.")
        });
        let kept = kept_workers(fleet);
        set(alarms, KEPT_LONG, now, &kept, |found| {
            let seconds = KEPT.0 / 1_000_000;
            format!(
                "robots have kept people in one spot for more than {seconds} s: {found}. Tell them to walk on."
            )
        });
    }

    fn look_at_jobs(&mut self, fleet: &Fleet, view: &View, alarms: &Alarms) {
        let undelivered = self.jobs.undelivered(fleet, view);
        let minutes = format!("{:.0} min", undelivered.as_secs_f64() / 60.0);
        let late: Vec<String> = (undelivered > DELIVERS).then_some(minutes).into_iter().collect();
        set(alarms, UNDELIVERED, view.now, &late, |minutes| {
            format!(
                "jobs wait and robots can drive, but nothing has been delivered for {minutes}. GET \
                 /v1/jobs?state=waiting lists them, GET /v1/jobs/ID/why says what each waits for."
            )
        });
        let jobs = self.jobs.without_reason(fleet, view);
        let names: Vec<String> = jobs.into_iter().map(job_name).collect();
        set(alarms, WITHOUT_REASON, view.now, &names, |names| {
            format!(
                "jobs wait for long, and nothing keeps them: {names}. Cancel and submit them again, and report this."
            )
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
                || ledger.evacuation.is_some()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::{Fact, Fault, Input, JobKind, JobRequest, Settings, Telemetry};
    use crate::id::{JobId, NodeId};
    use crate::warehouse::lab;
    use std::sync::Arc;

    pub(super) fn fleet() -> Fleet {
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
        watchdog.look(&fleet, &fleet.view(at(0)), &alarms);
        watchdog.look(&fleet, &fleet.view(at(599)), &alarms);
        assert!(alarms.list().is_empty());
        watchdog.look(&fleet, &fleet.view(at(606)), &alarms);
        let listed = alarms.list();
        assert!(listed.len() == 1 && listed[0].text.contains("robot-1"), "{listed:?}");
        // It is let off as soon as it has nothing to do.
        let idle = Fleet::new(fleet.warehouse().clone(), Settings::default());
        watchdog.look(&idle, &idle.view(at(612)), &alarms);
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
            watchdog.look(&fleet, &fleet.view(now), &alarms);
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
            watchdog.look(&fleet, &fleet.view(now), &alarms);
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
            watchdog.look(&fleet, &fleet.view(seen), &alarms);
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
    fn a_floor_that_delivers_nothing_is_an_alarm_until_nothing_is_wanted() {
        let kind =
            JobKind::Deliver { rack: crate::id::RackId(0), station: crate::id::StationId(0), pick: None };
        let request = JobRequest { kind, priority: 0, deadline: None, after: vec![], key: None };
        let mut fleet = resting([Fact::Accepted { job: JobId(1), request, at: Time(1) }]);
        let (alarms, mut watchdog) = (Alarms::default(), Watchdog::default());
        let mut told = |from: i64, to: i64, inputs: Vec<Input>| {
            let mut inputs = Some(inputs);
            for s in (from..to).step_by(5) {
                let now = Time(s * 1_000_000);
                // It says that it stands where it stood: whatever it is granted, it does not drive.
                let said = report(&fleet, now, None);
                let mut all = inputs.take().unwrap_or_default();
                all.push(Input::Telemetry(said));
                fleet.step(now, all);
                watchdog.look(&fleet, &fleet.view(now), &alarms);
            }
            alarms.list().into_iter().find(|a| a.id == UNDELIVERED).map(|a| a.text)
        };
        assert_eq!(told(5, 1200, vec![]), None);
        let text = told(1200, 1230, vec![]).expect("nothing was delivered");
        assert!(text.contains("nothing has been delivered for 20 min"), "{text}");
        assert_eq!(told(1230, 1240, vec![Input::Cancel { token: 1, job: JobId(1) }]), None);
    }
}
