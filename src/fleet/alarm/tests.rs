//! Each kind of alarm: raised by its cause, cleared when the cause is gone, and nothing beside it.

use super::*;
use crate::{
    Answer, Binds, Closure, Fault, Fleet, FloorAction, Input, JobAction, JobKind, JobRequest, Made, Reply,
    RobotAction, Settings, Telemetry, WorkerAction,
};
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::id::{JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::{NodeKind, thesis};
use giveway_people::human::{Quality, Sighting, SourceId};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Robots that report once a second that they stand where they are booked, whatever they are told.
struct StandingFloor {
    fleet: Fleet,
    watch: FloorWatch,
    register: AlarmRegister,
    health: LoopHealth,
    now: Time,
    faults: BTreeMap<RobotId, Fault>,
    silent: BTreeSet<RobotId>,
    battery: f64,
    worker: Option<Point>,
}

impl StandingFloor {
    /// A floor with this many robots at the parking places and chargers of the hall of the thesis.
    fn new(robots: usize) -> StandingFloor {
        let map = Arc::new(thesis());
        let fleet = Fleet::new(map.clone(), Settings::default());
        let mut floor = StandingFloor {
            fleet,
            watch: FloorWatch::default(),
            register: AlarmRegister::default(),
            health: LoopHealth::default(),
            now: Time::ZERO,
            faults: BTreeMap::new(),
            silent: BTreeSet::new(),
            battery: 1.0,
            worker: None,
        };
        let places = map.nodes_where(|kind| matches!(kind, NodeKind::Parking | NodeKind::Charger));
        let joins = |(i, node): (usize, &NodeId)| {
            Input::ask(
                i as u64,
                RobotAction::Register {
                    name: format!("robot-{}", i + 1),
                    kind: crate::USUAL_KIND.into(),
                    node: *node,
                    link: None,
                },
            )
        };
        floor.step(places.iter().take(robots).enumerate().map(joins).collect());
        assert_eq!(floor.fleet.ledger().robots.len(), robots);
        floor
    }

    fn step(&mut self, mut inputs: Vec<Input>) -> Vec<Reply> {
        self.now += Span::from_secs(1);
        for robot in self.fleet.ledger().present().filter(|r| !self.silent.contains(r)) {
            inputs.push(Input::Telemetry(self.report(robot)));
        }
        inputs.extend(self.worker.map(|at| Input::Sighted(self.sighting(at))));
        let replies = self.fleet.step(self.now, inputs).replies;
        let view = self.fleet.view(self.now);
        self.register.observe(AlarmScope::Operator, operator_conditions(&view), self.now);
        let found = self.watch.look(&self.fleet, &view, &self.health);
        self.register.observe(AlarmScope::Watch, found, self.now);
        replies
    }

    fn report(&self, robot: RobotId) -> Telemetry {
        let at = self.fleet.warehouse().nodes[self.fleet.ledger().node_of(robot)].at;
        Telemetry {
            robot,
            seq: self.now.0.unsigned_abs(),
            seen: self.now,
            pose: Pose { at, heading: 0.0 },
            speed_mps: 0.0,
            reached: 0,
            known: 0,
            acted: None,
            rack: None,
            battery: self.battery,
            fault: self.faults.get(&robot).copied(),
            limit_mps: None,
            recalls: 0,
        }
    }

    fn sighting(&self, at: Point) -> Sighting {
        Sighting {
            mirror: None,
            worker: WorkerId(0),
            source: SourceId::Tag,
            seen: self.now,
            epoch: 0,
            at_marks: false,
            seq: self.now.0.unsigned_abs(),
            at,
            heading: None,
            accuracy_m: 0.2,
            quality: Quality::Tracked,
        }
    }

    fn run(&mut self, seconds: i64) -> Vec<(&'static str, String)> {
        (0..seconds).for_each(|_| _ = self.step(vec![]));
        self.active()
    }

    /// The active alarms: kinds and texts.
    fn active(&self) -> Vec<(&'static str, String)> {
        self.register.active().into_iter().map(|a| (a.kind.word(), a.text.to_string())).collect()
    }

    fn kinds(&self) -> Vec<&'static str> {
        self.register.active().iter().map(|a| a.kind.word()).collect()
    }

    fn submit(&mut self, kind: JobKind, deadline: Option<Time>) -> JobId {
        let request = JobRequest { deadline, ..JobRequest::new(kind) };
        match self.step(vec![Input::ask(7, JobAction::Submit(request))]).pop() {
            Some(Reply { answer: Ok(Answer::Job(Made { id: job, .. })), .. }) => job,
            other => panic!("not accepted: {other:?}"),
        }
    }

    /// Runs for this long with a fault of the first robot; then without, for long enough to end its alarm.
    fn with_fault(&mut self, fault: Fault, seconds: i64) -> Vec<(&'static str, String)> {
        self.faults.insert(RobotId(0), fault);
        let found = self.run(seconds);
        self.faults.clear();
        assert_eq!(self.run(40), [], "{fault:?} is over");
        found
    }
}

fn deliver() -> JobKind {
    JobKind::Deliver { rack: RackId(0), station: StationId(0), pick: None }
}

#[test]
fn a_floor_on_which_nothing_is_wrong_has_no_alarm() {
    assert_eq!(StandingFloor::new(8).run(1300), []);
}

#[test]
fn each_fault_of_a_robot_is_one_alarm_until_it_is_over() {
    let mut floor = StandingFloor::new(3);
    assert_eq!(floor.run(5), []);
    let name = "robot-1";
    for (fault, kind) in [
        (Fault::Broken, "robot_failed"),
        (Fault::EmergencyStop, "emergency_stop"),
        (Fault::Unplugged, "robot_unplugged"),
    ] {
        let found = floor.with_fault(fault, 30);
        assert!(found.len() == 1 && found[0].0 == kind && found[0].1.contains(name), "{fault:?}: {found:?}");
    }
    assert_eq!(floor.with_fault(Fault::Manual, 30), [], "a person is with it");
}

#[test]
fn a_robot_that_is_not_heard_of_is_an_alarm_and_many_of_them_are_one() {
    let mut floor = StandingFloor::new(8);
    floor.run(5);
    floor.silent.insert(RobotId(2));
    let found = floor.run(12);
    assert_eq!(found, [("robot_silent", "robot-3 sends no reports.".to_owned())]);
    floor.silent.extend((0..8).map(RobotId));
    let found = floor.run(20);
    assert_eq!(found.len(), 1, "one cause: {found:?}");
    assert_eq!(found[0].1, "8 of 8 robots send no reports: robot-1, robot-2, robot-3 and 5 more.");
    assert_eq!(floor.register.active()[0].severity, AlarmSeverity::Critical);
    floor.silent.clear();
    assert_eq!(floor.run(10), []);
}

#[test]
fn a_robot_that_ignores_its_orders_is_stuck_and_not_the_whole_floor() {
    let mut floor = StandingFloor::new(3);
    floor.run(5);
    let job = floor.submit(deliver(), None);
    assert_eq!(floor.run(50), [], "it may be slow");
    floor.run(100);
    let found = floor.active();
    let stuck: Vec<_> = found.iter().filter(|(kind, _)| *kind == "robot_stuck").collect();
    assert_eq!(stuck.len(), 1, "{found:?}");
    assert!(found.len() <= 2, "{found:?}");
    floor.step(vec![Input::ask(1, JobAction::Cancel(job))]);
    floor.run(30);
    assert!(!floor.kinds().contains(&"floor_standstill"), "nothing is wanted: {:?}", floor.active());
}

#[test]
fn while_an_operator_stops_the_fleet_there_is_a_notice_and_nothing_else() {
    let mut floor = StandingFloor::new(6);
    floor.run(5);
    floor.submit(deliver(), None);
    floor.step(vec![Input::ask(1, FloorAction::Halt(None))]);
    let found = floor.run(1300);
    assert_eq!(found, [("stopped", "all robots are stopped by hand.".to_owned())]);
    assert_eq!(floor.register.active()[0].severity, AlarmSeverity::Notice);
    floor.step(vec![Input::ask(1, FloorAction::Release(None))]);
    assert_eq!(floor.run(5), []);
    floor.step(vec![Input::ask(1, FloorAction::Halt(Some(RobotId(4))))]);
    assert_eq!(floor.run(5), [("paused", "paused by hand: robot-5.".to_owned())]);
}

#[test]
fn robots_that_are_low_with_no_charger_free_are_an_alarm() {
    let mut floor = StandingFloor::new(4);
    floor.run(5);
    let chargers = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Charger);
    let at_charger = |r: RobotId| chargers.contains(&floor.fleet.ledger().node_of(r));
    let away = floor.fleet.ledger().present().filter(|r| !at_charger(*r)).count();
    floor.battery = 0.01;
    floor.run(90);
    let of_kind = floor.kinds().iter().filter(|k| **k == "robot_low").count();
    assert!(of_kind <= away, "{:?}", floor.active());
    floor.battery = 1.0;
    floor.run(40);
    assert!(!floor.kinds().contains(&"robot_low"), "{:?}", floor.active());
}

#[test]
fn a_lost_worker_is_one_alarm_with_who_waits_until_seen_again() {
    let mut floor = StandingFloor::new(2);
    floor.step(vec![Input::ask(0, WorkerAction::Register("ana".into()))]);
    let at = floor.fleet.warehouse().nodes[NodeId(0)].at;
    floor.worker = Some(at);
    assert_eq!(floor.run(10), []);
    floor.worker = None;
    assert_eq!(floor.run(25), [], "it may only be a radio");
    let found = floor.run(10);
    assert_eq!(found, [("worker_lost", "ana (w1) is lost: no robot waits.".to_owned())]);
    let alarm = floor.register.active().remove(0);
    assert!(alarm.at.is_some() && floor.now - alarm.since > Span::from_secs(30), "{alarm:?}");
    floor.worker = Some(at);
    assert_eq!(floor.run(5), []);
}

#[test]
fn a_worker_in_an_area_that_is_closed_to_people_is_an_alarm_until_out_of_it() {
    let mut floor = StandingFloor::new(1);
    floor.step(vec![Input::ask(0, WorkerAction::Register("ana".into()))]);
    let at = floor.fleet.warehouse().nodes[NodeId(0)].at;
    floor.worker = Some(at);
    let corner = |dx: f64, dy: f64| Point::new(at.x + dx, at.y + dy).into();
    let area = Closure {
        outline: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        nodes: vec![],
        window: Window::new(floor.now, floor.now + Span::from_secs(600)),
        reason: "oil".into(),
        binds: Binds::Both,
        series: None,
    };
    floor.step(vec![Input::ask(1, FloorAction::Close(area))]);
    floor.run(60);
    let found = floor.active();
    assert!(found.iter().any(|(k, t)| *k == "closed_areas" && t.contains("ana (w1) is in c1")), "{found:?}");
    floor.worker = Some(Point::new(at.x + 4.0, at.y));
    floor.run(20);
    assert!(!floor.kinds().contains(&"closed_areas"), "{:?}", floor.active());
}

#[test]
fn a_deadline_is_at_risk_then_missed_then_nothing_when_the_job_is_over() {
    let mut floor = StandingFloor::new(0);
    let due = floor.now + Span::from_secs(300);
    let job = floor.submit(deliver(), Some(due));
    floor.run(60);
    assert!(!floor.kinds().contains(&"deadline_at_risk"), "there is time: {:?}", floor.active());
    floor.run(200);
    let found = floor.active();
    assert!(found.iter().any(|(k, t)| *k == "deadline_at_risk" && t.contains("j1")), "{found:?}");
    floor.run(80);
    assert!(floor.kinds().contains(&"deadline_missed"), "{:?}", floor.active());
    assert!(!floor.kinds().contains(&"deadline_at_risk"), "one of both: {:?}", floor.active());
    floor.step(vec![Input::ask(1, JobAction::Cancel(job))]);
    assert_eq!(floor.run(20), []);
}

#[test]
fn a_floor_without_a_robot_for_its_jobs_stands_and_says_why() {
    let mut floor = StandingFloor::new(0);
    floor.submit(deliver(), None);
    let found = floor.run(70);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].0, "floor_standstill");
    assert!(found[0].1.contains("j1 waits because no robot can take it"), "{found:?}");
}

#[test]
fn nothing_delivered_for_twenty_minutes_is_an_alarm() {
    let mut floor = StandingFloor::new(2);
    floor.run(5);
    floor.submit(deliver(), None);
    floor.run(1150);
    assert!(!floor.kinds().contains(&"deliveries"), "{:?}", floor.active());
    floor.run(120);
    assert!(floor.kinds().contains(&"deliveries"), "{:?}", floor.active());
}

#[test]
fn late_steps_and_a_clock_that_was_set_are_alarms_until_they_are_right_again() {
    let mut floor = StandingFloor::new(1);
    floor.health.period = Span::from_millis(50);
    floor.run(5);
    let steps = |floor: &mut StandingFloor, late: bool| {
        for _ in 0..30 {
            (0..20).for_each(|_| floor.health.steps.note(floor.now, late));
            floor.step(vec![]);
        }
    };
    steps(&mut floor, true);
    assert_eq!(floor.kinds(), ["steps_late"]);
    steps(&mut floor, false);
    steps(&mut floor, false);
    assert_eq!(floor.active(), []);
    floor.health.clock_ahead = Span::from_secs(-86_400);
    let found = floor.run(3);
    assert!(found.len() == 1 && found[0].1.contains("86400 s behind"), "{found:?}");
    floor.health.clock_ahead = Span::from_secs(2);
    assert_eq!(floor.run(10), []);
}

#[test]
fn forecasts_that_do_not_hold_are_an_alarm_once_it_lasts() {
    let floor = StandingFloor::new(1);
    let mut view = floor.fleet.view(floor.now);
    view.forecast_coverage = vec![giveway_people::human::HorizonCoverage {
        horizon_s: 2.0,
        forecasts: 900,
        covered: 0.6,
        scale: 2.0,
        trusted: false,
    }];
    let mut watch = FloorWatch::default();
    let mut register = AlarmRegister::default();
    for s in 0..40 {
        view.now = floor.now + Span::from_secs(s);
        let found = watch.look(&floor.fleet, &view, &LoopHealth::default());
        let new = register.observe(AlarmScope::Watch, found, view.now);
        assert!(s >= 30 || new.iter().all(|a| a.kind != AlarmKind::ForecastBad), "after {s} s: {new:?}");
    }
    let alarm = register.active().into_iter().find(|a| a.kind == AlarmKind::ForecastBad);
    assert!(alarm.expect("it lasted").text.text().contains("2.0 s ahead (60 % within"));
}

#[test]
fn a_standstill_is_told_with_names() {
    use crate::{ChainEnd, Party, Standstill};
    use giveway_floor::text::SentenceArg;
    let (robot, worker) = (Party::Robot(RobotId(3)), Party::Worker(WorkerId(0)));
    let name = |p: &Party| SentenceArg::from(if *p == worker { "Ana" } else { "robot-4" });
    let told = |end, root: &[Party], behind: &[Party]| {
        let found = Standstill { end, root: root.into(), behind: behind.into(), since: Time(1) };
        standing::in_words(&found, name).to_string()
    };
    assert_eq!(told(ChainEnd::Cycle(robot), &[robot, worker], &[]), "robot-4 and Ana wait for one another.");
    assert_eq!(
        told(ChainEnd::Still(worker), &[worker], &[robot]),
        "Ana stands in the way; robot-4 waits for that."
    );
    assert_eq!(
        told(ChainEnd::Still(robot), &[robot], &[robot, robot, robot]),
        "robot-4 has no way to go; robot-4 and 2 more wait for that."
    );
}

/// An area around these nodes that robots keep out of.
fn closed(floor: &StandingFloor, nodes: Vec<NodeId>) -> Input {
    let at = floor.fleet.warehouse().nodes[nodes[0]].at;
    let corner = |dx: f64, dy: f64| Point::new(at.x + dx, at.y + dy).into();
    let area = Closure {
        outline: vec![corner(-0.2, -0.2), corner(0.2, -0.2), corner(0.2, 0.2), corner(-0.2, 0.2)],
        nodes,
        window: Window::new(floor.now, Time::MAX),
        reason: "oil".into(),
        binds: Binds::Robots,
        series: None,
    };
    Input::ask(1, FloorAction::Close(area))
}

#[test]
fn a_station_for_which_jobs_wait_in_vain_is_starved_until_they_do_not() {
    let mut floor = StandingFloor::new(2);
    floor.run(5);
    let home = floor.fleet.warehouse().racks[RackId(0)].home;
    let closing = closed(&floor, vec![home]);
    floor.step(vec![closing]);
    let job = floor.submit(deliver(), None);
    floor.run(280);
    assert!(!floor.kinds().contains(&"station_starved"), "it may not last: {:?}", floor.active());
    floor.run(40);
    let name = floor.fleet.warehouse().stations[StationId(0)].name.clone();
    let said = ("station_starved", format!("no rack is on its way to {name}, though j1 waits for it."));
    assert!(floor.active().contains(&said), "{:?}", floor.active());
    floor.step(vec![Input::ask(1, JobAction::Cancel(job))]);
    assert_eq!(floor.run(20), []);
}

#[test]
fn a_job_whose_way_a_closed_area_cuts_waits_for_it_and_no_robot_is_called_blocked() {
    let mut floor = StandingFloor::new(1);
    floor.run(5);
    let here = floor.fleet.ledger().node_of(RobotId(0));
    let around = floor.fleet.warehouse().out(here).map(|(_, arc)| arc.to).collect();
    let closing = closed(&floor, around);
    floor.step(vec![closing]);
    let job = floor.submit(deliver(), None);
    floor.run(80);
    assert!(!floor.kinds().contains(&"robot_blocked"), "the area is what keeps it: {:?}", floor.active());
    floor.step(vec![Input::ask(1, FloorAction::Reopen(giveway_floor::id::ClosureId(1)))]);
    floor.run(15);
    assert!(!floor.kinds().contains(&"robot_blocked"), "{:?}", floor.active());
    floor.step(vec![Input::ask(1, JobAction::Cancel(job))]);
}
