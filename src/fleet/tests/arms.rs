//! A robot arm at a work cell: it picks its lines, the visit waits for them, and in trouble it gives them back.

use super::*;
use giveway_cell::arm::{ArmActivity, ArmReport, ArmSaid, ArmTrouble, Gripped, Joints, rest};
use giveway_cell::{FacePlace, HandPoints, HandsSeen, LineChange, LineState, OrderLine, PickFace, PickedBy};
use giveway_floor::warehouse::stations;

const S1: StationId = StationId(0);

/// An arm that does what it is told at once.
struct ArmFloor {
    floor: TestFloor,
    face: PickFace,
    job: JobId,
    joints: Joints,
    gripped: Option<(u64, Gripped)>,
    /// How many trajectories the arm got.
    got: usize,
}

impl ArmFloor {
    fn new(lines: &[(&str, u32, &str, PickedBy)]) -> ArmFloor {
        let line = |(slot, quantity, tote, by): &(&str, u32, &str, PickedBy)| OrderLine {
            slot: slot.parse().expect("a slot"),
            quantity: *quantity,
            tote: (*tote).into(),
            item: None,
            by: *by,
        };
        let floor = TestFloor::new(stations(), &scenario(2));
        let kind = JobKind::Deliver { rack: RackId(3), station: S1, pick: Some(Span::from_secs(900)) };
        let lines = vec![lines.iter().map(line).collect()];
        let w = floor.fleet.warehouse().clone();
        let (station, rack) = (&w.stations[S1], w.rack_types.iter().next().unwrap());
        let face = PickFace::new(station.cell.as_ref().unwrap(), w.nodes[station.node].at, rack);
        let mut cell = ArmFloor { floor, face, job: JobId(0), joints: rest(), gripped: None, got: 0 };
        cell.job = cell.floor.submit(JobRequest { lines, ..request(kind) });
        for _ in 0..3000 {
            if cell.floor.is(cell.job, "picking") {
                return cell;
            }
            cell.step();
        }
        panic!("no rack came");
    }

    fn report(&self) -> ArmReport {
        ArmReport { joints: self.joints, seen: self.floor.now, is_stopped: false }
    }

    fn step(&mut self) {
        self.say(Some(self.report()));
    }

    fn say(&mut self, report: Option<ArmReport>) {
        let said = report.map(|report| Input::Arm(ArmSaid { station: S1, report, gripped: self.gripped }));
        let step = self.floor.step(said.into_iter().chain([Input::Hands(self.resting())]).collect());
        for order in step.arms {
            self.got += 1;
            assert!(order.trajectory.steps.len() <= 10 && order.station == S1);
            self.joints = order.trajectory.steps[0];
            self.gripped = order.grip.map(|grip| (grip.number, Gripped::Done)).or(self.gripped);
        }
    }

    /// A picker who stands a little aside, and whose hands rest.
    fn resting(&self) -> HandsSeen {
        let hand = |x: f64| {
            let place = |back: f64| self.face.on_map(FacePlace::new(x, 0.95 + back, 0.95));
            Some(HandPoints { wrist: place(0.17), palm: place(0.09), tips: [place(0.0); 2] })
        };
        let (seen, head) = (self.floor.now, self.face.on_map(FacePlace::new(-0.3, 1.05, 1.6)));
        HandsSeen {
            station: S1,
            person: 0,
            seen,
            head,
            facing: None,
            eyes: None,
            hands: [hand(-0.5), hand(-0.2)],
        }
    }

    fn lines(&self) -> Vec<(LineState, u32)> {
        let lines = self.floor.fleet.ledger().jobs[&self.job].lines_now().expect("it has lines");
        lines.all().iter().map(|p| (p.state, p.pieces)).collect()
    }

    fn until(&mut self, what: &str, steps: usize, is: impl Fn(&ArmFloor) -> bool) {
        for _ in 0..steps {
            if is(self) {
                return;
            }
            self.step();
        }
        panic!("not within {steps} steps: {what}; {:?}", self.arm());
    }

    fn arm(&self) -> ArmView {
        self.floor.fleet.arm(S1, self.floor.now).expect("the map has an arm")
    }

    fn done(&mut self, n: usize) {
        let order = StationOrder::Line(n, LineChange::Done(1));
        self.floor.step(vec![Input::ask(5, Request::Station(S1, order))]);
    }

    fn is_over(&self) -> bool {
        self.floor.story(self.job).last() == Some(&"done")
    }
}

use LineState::{Arm, Done, Lit, Open};
use PickedBy::{Either, Hand};

#[test]
fn an_arm_picks_its_line_piece_by_piece_beside_the_hand_and_the_visit_waits_for_it() {
    let mut cell = ArmFloor::new(&[("D3", 2, "C", PickedBy::Arm), ("A1", 1, "A", Hand)]);
    assert_eq!(cell.lines(), [(Arm, 0), (Lit, 0)]);
    cell.until("the first piece", 300, |c| c.lines()[0] == (Arm, 1));
    cell.done(1);
    assert!(!cell.is_over(), "the arm's line is left");
    cell.until("the second piece", 300, |c| c.is_over());
    cell.until("the arm rests", 200, |c| c.arm().activity == ArmActivity::Idle);
    let got = cell.got;
    (0..20).for_each(|_| cell.step());
    assert_eq!(cell.got, got, "an arm that rests gets nothing to follow");
}

#[test]
fn an_arm_takes_lines_that_the_hand_will_not_need_and_never_the_lit_one() {
    let mut cell = ArmFloor::new(&[("C3", 3, "C", Either), ("A1", 3, "A", Either), ("D2", 1, "C", Either)]);
    cell.until("the arm has a line", 20, |c| c.lines()[2].0 == Arm);
    assert_eq!(cell.lines(), [(Lit, 0), (Open, 0), (Arm, 0)]);
    assert_eq!(cell.arm().line, Some((cell.job, 2)));
    let mut alone = ArmFloor::new(&[("D2", 1, "C", Either)]);
    (0..20).for_each(|_| alone.step());
    assert_eq!(alone.lines(), [(Lit, 0)]);
}

#[test]
fn an_arm_that_its_own_stop_holds_again_and_again_stands_long_enough_for_the_person_to_get_on() {
    let mut cell = ArmFloor::new(&[("D3", 1, "C", PickedBy::Arm), ("A1", 1, "A", Hand)]);
    let (mut moved, mut stood, mut longest, mut held) = (0, 0, 0, 0);
    for _ in 0..600 {
        let before = cell.joints;
        cell.say(Some(ArmReport { is_stopped: held > 0, ..cell.report() }));
        // Whenever the arm has moved for half a second, its stop holds it for as long.
        moved = if cell.joints == before { 0 } else { moved + 1 };
        stood = if cell.joints == before { stood + 1 } else { 0 };
        longest = longest.max(stood);
        held = if held > 0 {
            held - 1
        } else if moved >= 5 {
            5
        } else {
            0
        };
    }
    assert!(longest > 40, "it stood for {} s at most", f64::from(longest) / 10.0);
    cell.until("it rests in the end", 2000, |c| c.arm().activity == ArmActivity::Idle);
}

#[test]
fn the_lines_of_an_arm_in_trouble_go_to_the_hand_and_it_gets_no_trajectory() {
    let mut far = rest();
    far[2] = 4.0;
    let mut jumped = rest();
    jumped[0] += 1.0;
    let nan = [f64::NAN; 6];
    let wrong = |joints: Joints, ago: i64| {
        move |now: Time| Some(ArmReport { joints, seen: now - Span::from_millis(ago), is_stopped: false })
    };
    type Says = Box<dyn Fn(Time) -> Option<ArmReport>>;
    let cases: [(ArmTrouble, Says); 5] = [
        (ArmTrouble::Silent, Box::new(|_| None)),
        (ArmTrouble::Late, Box::new(wrong(rest(), 300))),
        (ArmTrouble::Joints, Box::new(wrong(far, 0))),
        (ArmTrouble::Joints, Box::new(wrong(nan, 0))),
        (ArmTrouble::Jump, Box::new(wrong(jumped, 0))),
    ];
    for (why, says) in cases {
        let mut cell = ArmFloor::new(&[("A1", 1, "A", Hand), ("D3", 1, "C", PickedBy::Arm)]);
        assert_eq!(cell.lines(), [(Lit, 0), (Arm, 0)]);
        let got = cell.got;
        cell.step();
        (0..5).for_each(|_| cell.say(says(cell.floor.now)));
        assert_eq!(cell.lines(), [(Lit, 0), (Open, 0)], "{why}");
        assert_eq!((cell.arm().activity, cell.arm().line), (ArmActivity::Trouble(why), None));
        assert!(cell.got <= got + 3, "{why}: no further trajectory");
        let got = cell.got;
        (0..8).for_each(|_| cell.say(says(cell.floor.now)));
        assert_eq!(cell.got, got, "{why}");
        cell.done(0);
        assert_eq!(cell.lines()[1].0, Lit);
        cell.done(1);
        assert!(cell.is_over(), "{why}: the visit ends");
    }
}

#[test]
fn lines_for_an_arm_that_was_never_heard_of_or_cannot_reach_are_the_hands() {
    let mut cell = ArmFloor::new(&[("D3", 1, "A", PickedBy::Arm)]);
    (0..30).for_each(|_| cell.step());
    assert_eq!(cell.lines(), [(Lit, 0)], "the tote is on the other side of the picker");
    let mut floor = TestFloor::new(stations(), &scenario(2));
    let slot = "D3".parse().unwrap();
    let line = OrderLine { slot, quantity: 1, tote: "C".into(), item: None, by: PickedBy::Arm };
    let kind = JobKind::Deliver { rack: RackId(3), station: S1, pick: Some(Span::from_secs(900)) };
    let job = floor.submit(JobRequest { lines: vec![vec![line]], ..request(kind) });
    floor.until(300, "the rack is picked from", |f| f.is(job, "picking"));
    floor.step(vec![]);
    assert_eq!(floor.fleet.ledger().jobs[&job].lines_now().unwrap().lit(), Some(0));
    assert_eq!(floor.fleet.arm(S1, floor.now).map(|arm| arm.activity), Some(ArmActivity::Off));
}

#[test]
fn no_rack_leaves_while_an_arm_is_inside_until_it_comes_out_or_a_person_vouches_for_it() {
    for vouches in [false, true] {
        let mut cell = ArmFloor::new(&[("A1", 1, "A", Hand), ("D3", 1, "C", PickedBy::Arm)]);
        cell.until("it is inside", 200, |c| c.floor.fleet.internals().writer.arms.is_inside(S1));
        let held = cell.joints;
        (0..8).for_each(|_| cell.say(None));
        cell.done(0);
        cell.done(1);
        assert_eq!(cell.lines(), [(Done, 1), (Done, 1)]);
        (0..50).for_each(|_| cell.say(None));
        assert!(!cell.is_over(), "nobody knows that it is outside");
        if vouches {
            let order = StationOrder::Release;
            cell.floor.step(vec![Input::ask(5, Request::Station(S1, order))]);
            assert!(cell.is_over());
        } else {
            cell.joints = held;
            cell.until("it comes out", 200, |c| c.is_over());
        }
    }
}

#[test]
fn an_arm_that_does_not_move_in_the_opening_for_a_minute_is_stuck_until_it_moves() {
    let mut cell = ArmFloor::new(&[("A1", 1, "A", Hand), ("D3", 1, "C", PickedBy::Arm)]);
    cell.until("it is inside", 200, |c| c.floor.fleet.internals().writer.arms.is_inside(S1));
    let held = cell.joints;
    let stands = |cell: &mut ArmFloor, seconds: i64| {
        let until = cell.floor.now + Span::from_secs(seconds);
        while cell.floor.now < until {
            cell.joints = held;
            cell.say(Some(ArmReport { is_stopped: true, ..cell.report() }));
        }
        cell.arm().is_stuck_inside
    };
    assert!(!stands(&mut cell, 55), "it may go on soon");
    assert!(stands(&mut cell, 10));
    cell.joints = held;
    cell.until("it moves again", 100, |c| !c.arm().is_stuck_inside);
}
