//! The driver by itself: robots that stand where they joined, and a journal of numbers.

use super::*;
use giveway_fleet::{Answer, Asker, FloorAction, JobAction, LinkState, RobotAction, Settings, Telemetry};
use giveway_floor::geometry::Pose;
use giveway_floor::id::{JobId, NodeId};
use giveway_floor::text::Sentence;
use giveway_floor::time::Span;
use giveway_floor::warehouse::{NodeKind, lab};
use std::sync::Arc;

/// A driver with a clock and a journal that takes everything at once, unless a test says otherwise.
struct TestLoop {
    drive: Drive,
    now: Time,
    places: Vec<NodeId>,
    /// Facts of the steps that were written.
    steps: Vec<Vec<Fact>>,
    state: JournalState,
    limits: Vec<Option<f64>>,
    alarms: Vec<DriveAlarm>,
    next: u64,
}

impl TestLoop {
    /// A loop with two robots that have joined.
    fn new() -> TestLoop {
        let fleet = Fleet::new(Arc::new(lab()), Settings::default());
        let map = fleet.warehouse().clone();
        let chargers = map.nodes.pairs().filter(|(_, node)| node.kind == NodeKind::Charger);
        let places: Vec<NodeId> = chargers.map(|(id, _)| id).take(2).collect();
        let mut test = TestLoop {
            drive: Drive::new(fleet),
            now: Time::ZERO,
            places,
            steps: Vec::new(),
            state: JournalState::Writes,
            limits: vec![None; 2],
            alarms: Vec::new(),
            next: 0,
        };
        let name = |i: usize| format!("robot-{i}");
        let kind = || test.drive.fleet().ledger().kinds()[0].name.clone();
        let join = |(i, node)| {
            Input::ask(
                Token { asker: Asker(2), number: 0 },
                RobotAction::Register { name: name(i), kind: kind(), node, link: None },
            )
        };
        let joins = test.places.clone().into_iter().enumerate().map(join).collect();
        test.turn(vec![], joins);
        assert_eq!(test.drive.fleet().ledger().robots.len(), 2);
        test
    }

    fn journal(&self) -> JournalReport {
        JournalReport { durable: self.steps.len() as u64, state: self.state }
    }

    fn reports(&self) -> Vec<Input> {
        let map = self.drive.fleet().warehouse();
        let report = |(i, node): (usize, &NodeId)| {
            Input::Telemetry(Telemetry {
                robot: RobotId(i as u32),
                seq: self.now.0.unsigned_abs(),
                seen: self.now,
                pose: Pose { at: map.nodes[*node].at, heading: 0.0 },
                speed_mps: 0.0,
                reached: 0,
                known: 0,
                acted: None,
                rack: None,
                battery: 1.0,
                fault: None,
                limit_mps: self.limits[i],
                recalls: 0,
            })
        };
        self.places.iter().enumerate().map(report).collect()
    }

    /// Makes one turn and takes what it releases; robots obey limits at once.
    fn turn(&mut self, requests: Vec<Request>, more: Vec<Input>) -> (Sent, Released) {
        self.now += Span::from_millis(100);
        let requests = requests.into_iter().map(|request| {
            self.next += 1;
            (Token::from(self.next), request)
        });
        let requests = requests.collect();
        let mut inputs = self.reports();
        inputs.extend(more);
        let sent = self.drive.turn(self.now, Heard { journal: self.journal(), requests, inputs });
        for (robot, order) in &sent.limits {
            if let Command::Limit(limit) = order {
                self.limits[robot.0 as usize] = *limit;
            }
        }
        self.alarms.extend(sent.alarms.iter().cloned());
        if let Some(written) = sent.written.clone().filter(|_| self.state == JournalState::Writes) {
            self.steps.push(written.facts);
        }
        (sent, self.drive.release(self.journal()))
    }

    /// Rebuilds the fleet if that is needed.
    fn mend(&mut self) {
        assert!(self.drive.wants_fold());
        let facts = self.steps.concat();
        self.drive.restore(self.now, Ok((self.drive.empty_ledger(), facts)));
    }

    fn raised(&self, kind: AlarmKind) -> bool {
        let mut last = false;
        for alarm in &self.alarms {
            match alarm {
                DriveAlarm::Raise(of, _) if *of == kind => last = true,
                DriveAlarm::Clear(of) if *of == kind => last = false,
                _ => {}
            }
        }
        last
    }

    fn is_fenced(&self, robot: u32) -> bool {
        self.drive.fleet().ledger().robots[RobotId(robot)].fenced.is_some()
    }
}

fn halt() -> Request {
    FloorAction::Halt(None).into()
}

fn cancel() -> Request {
    JobAction::Cancel(JobId(1)).into()
}

#[test]
fn an_answer_leaves_when_the_facts_behind_it_are_durable() {
    let mut test = TestLoop::new();
    test.state = JournalState::Slow;
    let (sent, released) = test.turn(vec![halt()], vec![]);
    let written = sent.written.expect("it is stopped");
    assert_eq!(released.replies, []);
    assert_eq!(written.caused.len(), 1, "and who asked is said");
    let (sent, _) = test.turn(vec![cancel()], vec![]);
    assert_eq!(sent.refused, [Token::from(2)], "nothing new is promised meanwhile");
    test.steps.push(written.facts);
    let released = test.drive.release(JournalReport { state: JournalState::Gone, ..test.journal() });
    assert_eq!(released.replies, [], "by the word of a journal that is gone nothing leaves");
    let released = test.drive.release(test.journal());
    assert!(matches!(&released.replies[..], [Reply { answer: Ok(Answer::Done), .. }]), "{released:?}");
}

#[test]
fn while_the_journal_is_full_all_robots_are_told_to_stand_and_what_is_done_by_hand_is_kept_in_its_order() {
    let mut test = TestLoop::new();
    test.state = JournalState::Refuses;
    test.drive.gate.record(MOST_PENDING);
    let (sent, _) = test.turn(vec![halt(), FloorAction::Release(None).into(), halt()], vec![]);
    assert_eq!((sent.limits.len(), sent.stepped, test.raised(AlarmKind::Halt)), (2, false, true));
    let (sent, _) = test.turn(vec![cancel()], vec![]);
    assert_eq!((sent.limits.len(), sent.refused.len()), (0, 1), "they stand, and say so");
    // The journal is back.
    (test.state, test.steps) = (JournalState::Writes, vec![Vec::new(); test.steps.len() + 1]);
    let (sent, released) = test.turn(vec![], vec![]);
    assert!(sent.stepped && !test.raised(AlarmKind::Halt));
    assert_eq!(released.replies.len(), 3, "{released:?}");
    assert!(test.drive.fleet().ledger().stopped.is_some(), "the last word was to stop");
}

#[test]
fn a_step_that_panics_is_undone_its_robot_is_fenced_off_and_a_stop_by_hand_outlasts_it() {
    let mut test = TestLoop::new();
    test.drive.plant(Trap { call: GuardedCall::Step, robot: Some(RobotId(0)), times: 1 });
    let (sent, _) = test.turn(vec![halt(), cancel()], vec![]);
    assert_eq!(sent.refused, [Token::from(2)], "nothing came of it, and that is said");
    let (sent, _) = test.turn(vec![], vec![]);
    assert!(!sent.stepped && sent.limits.len() == 2, "robots stand until the fleet is made anew");
    test.mend();
    let (sent, released) = test.turn(vec![], vec![]);
    assert!(sent.stepped && test.is_fenced(0) && !test.is_fenced(1));
    assert_eq!(released.replies.len(), 1);
    assert!(test.drive.fleet().ledger().stopped.is_some());
}

#[test]
fn a_question_that_panics_fences_off_its_robot_and_is_answered_the_next_time() {
    for call in [GuardedCall::View, GuardedCall::Query, GuardedCall::Pose, GuardedCall::Watch] {
        let mut test = TestLoop::new();
        test.drive.plant(Trap { call, robot: Some(RobotId(1)), times: 1 });
        let now = test.now;
        let ask = |drive: &mut Drive| drive.ask(call, now, |fleet| fleet.view(now).robots.len());
        assert_eq!(ask(&mut test.drive), None);
        assert_eq!(ask(&mut test.drive), Some(2));
        let (sent, _) = test.turn(vec![], vec![]);
        assert!(sent.stepped && test.is_fenced(1) && !test.is_fenced(0), "{call:?}");
    }
}

#[test]
fn what_panics_again_and_again_ends_in_a_floor_that_stands_and_a_driver_that_answers() {
    for call in [GuardedCall::Step, GuardedCall::View] {
        let mut test = TestLoop::new();
        test.drive.plant(Trap { call, robot: Some(RobotId(0)), times: 100 });
        for _ in 0..10 {
            let now = test.now;
            test.drive.ask(GuardedCall::View, now, |fleet| fleet.view(now));
            test.turn(vec![], vec![]);
            if test.drive.wants_fold() {
                test.mend();
            }
        }
        assert!(test.drive.is_broken() && test.raised(AlarmKind::Broken), "{call:?}");
        let (sent, _) = test.turn(vec![cancel()], vec![]);
        assert_eq!((sent.refused.len(), &test.limits[..]), (1, &[Some(0.0); 2][..]));
    }
}

#[test]
fn a_panic_that_no_robot_can_be_named_for_stops_the_floor_where_it_was_a_step_and_not_where_it_was_a_question()
 {
    let mut test = TestLoop::new();
    test.drive.plant(Trap { call: GuardedCall::Query, robot: None, times: 1 });
    assert_eq!(test.drive.ask(GuardedCall::Query, test.now, |fleet| fleet.ledger().next_job), None);
    let (sent, _) = test.turn(vec![], vec![]);
    assert!(sent.stepped && !test.is_fenced(0) && !test.is_fenced(1));
    test.drive.plant(Trap { call: GuardedCall::Step, robot: None, times: 1 });
    test.turn(vec![], vec![]);
    assert!(test.drive.is_broken());
}

#[test]
fn while_no_step_is_made_stops_are_kept_up_to_a_limit_and_other_requests_are_refused_or_wait_where_they_came_in()
 {
    let mut intake = KeptRequests::default();
    let inside = |number| Token { asker: Asker(1), number };
    let order = Input::ask(inside(1), JobAction::Cancel(JobId(1)));
    assert_eq!(intake.keep(vec![order, Input::ask(inside(2), halt())]), [inside(1)]);
    assert_eq!(intake.take(vec![(Token::from(7), halt())], true), []);
    assert_eq!(intake.room(), MOST_REQUESTS - 2);
    assert_eq!(intake.with(vec![]).len(), 2);
    assert_eq!(intake.take(vec![(Token::from(8), cancel())], true), [Token::from(8)]);
    let many = (0..MOST_REQUESTS as u64).map(|n| (Token::from(n), halt())).collect();
    assert_eq!((intake.take(many, true).len(), intake.room()), (0, 0));
    assert_eq!(intake.keep(vec![Input::ask(inside(3), halt())]), [inside(3)]);
}

/// Whether a driver that first cannot make a step, and then can, knows what a link reported meanwhile.
fn knows_its_link(hinder: impl FnOnce(&mut TestLoop), help: impl FnOnce(&mut TestLoop)) -> bool {
    let mut test = TestLoop::new();
    let busy =
        LinkState { refuses: Some(Sentence::without_code("somebody works on it")), ..LinkState::default() };
    hinder(&mut test);
    test.turn(vec![], vec![Input::Link(RobotId(1), busy.clone())]);
    help(&mut test);
    test.turn(vec![], vec![]);
    test.drive.fleet().link_state(RobotId(1)) == Some(&busy)
}

#[test]
fn what_a_link_says_once_is_not_lost_where_a_step_panics_or_none_is_made() {
    let trap = Trap { call: GuardedCall::Step, robot: Some(RobotId(0)), times: 1 };
    assert!(knows_its_link(|_| {}, |_| {}));
    assert!(knows_its_link(|test| test.drive.plant(trap), TestLoop::mend), "the step panics");
    let panics = |test: &mut TestLoop| {
        test.drive.plant(trap);
        test.turn(vec![], vec![]);
    };
    assert!(knows_its_link(panics, TestLoop::mend), "the fleet is being made anew");
    let refuses = |test: &mut TestLoop| {
        test.state = JournalState::Refuses;
        test.drive.gate.record(MOST_PENDING);
    };
    let writes = |test: &mut TestLoop| {
        (test.state, test.steps) = (JournalState::Writes, vec![Vec::new(); test.steps.len() + 1]);
    };
    assert!(knows_its_link(refuses, writes), "the journal is full");
}
