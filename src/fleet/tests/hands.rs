//! Hands at work cells: they confirm lines, let the rack go at the last grasp, and keep it while they are inside.

use super::*;
use giveway_cell::{
    FacePlace, Flow, HandPoints, HandsSeen, LineChange, LineOutcome, LineState, OrderLine, PickFace, PickedBy,
};
use giveway_fleet::internals::Visits;
use giveway_floor::warehouse::{SlotName, stations};

/// A floor with a rack at station S1 whose lines are picked by hand.
struct CellFloor {
    floor: TestFloor,
    face: PickFace,
    job: JobId,
    at: FacePlace,
    warnings: Vec<WrongReach>,
}

const S1: StationId = StationId(0);

fn slot(name: &str) -> SlotName {
    name.parse().expect("a slot")
}

impl CellFloor {
    fn new(flow: Flow, lines: &[(&str, u32, &str)]) -> CellFloor {
        let line = |(slot_name, quantity, tote): &(&str, u32, &str)| OrderLine {
            slot: slot(slot_name),
            quantity: *quantity,
            tote: (*tote).into(),
            item: None,
            by: PickedBy::Either,
        };
        let mut floor = TestFloor::new(stations(), &scenario(2));
        floor.fleet.internals_mut().writer.settings.flow = flow;
        floor.fleet.internals_mut().writer.visits = Visits::new(flow.counts_lines());
        let kind = JobKind::Deliver { rack: RackId(3), station: S1, pick: Some(Span::from_secs(900)) };
        let lines = vec![lines.iter().map(line).collect()];
        let job = floor.submit(JobRequest { lines, ..request(kind) });
        floor.until(300, "the rack is picked from", |f| f.is(job, "picking"));
        let w = floor.fleet.warehouse().clone();
        let (station, rack) = (&w.stations[S1], w.rack_types.iter().next().unwrap());
        let face = PickFace::new(station.cell.as_ref().unwrap(), w.nodes[station.node].at, rack);
        let at = FacePlace::new(0.22, 0.95, 0.95);
        CellFloor { floor, face, job, at, warnings: Vec::new() }
    }

    /// Moves the right hand to a place; it is seen 60 times a second.
    fn moves(&mut self, to: FacePlace, seconds: f64) {
        let (from, steps) = (self.at, (seconds * 10.0).round() as usize);
        for step in 0..steps {
            let inputs = (1..=6)
                .map(|i| {
                    let t = (step as f64 + f64::from(i) / 6.0) / steps as f64;
                    self.at = from + (to - from) * (t * t * (3.0 - 2.0 * t));
                    let back = Span::from_millis(100 - i64::from(i) * 16);
                    Input::Hands(self.seen(self.floor.now - back))
                })
                .collect();
            let step = self.floor.step(inputs);
            self.warnings.extend(step.warnings.iter().map(|w| w.wrong));
        }
    }

    fn seen(&self, seen: Time) -> HandsSeen {
        let place = |back: f64| self.face.on_map(self.at + FacePlace::new(0.0, back, 0.0));
        let hand = HandPoints { wrist: place(0.17), palm: place(0.09), tips: [place(0.0); 2] };
        let head = self.face.on_map(FacePlace::new(0.0, 1.05, 1.6));
        HandsSeen { station: S1, person: 0, seen, head, facing: None, eyes: None, hands: [None, Some(hand)] }
    }

    fn front(&self, name: &str) -> FacePlace {
        self.face.slot(slot(name)) + FacePlace::new(0.0, 0.35, 0.0)
    }

    fn enters(&mut self, name: &str) {
        self.moves(self.front(name), 0.6);
        self.moves(self.face.slot(slot(name)) - FacePlace::new(0.0, 0.12, 0.0), 0.4);
        self.moves(self.at, 0.4);
    }

    fn grasps(&mut self, name: &str) {
        self.enters(name);
        self.moves(self.front(name), 0.4);
    }

    fn puts(&mut self, tote: usize) {
        self.moves(self.face.tote(tote).unwrap(), 0.8);
        self.moves(self.at, 0.3);
    }

    fn lines(&self) -> Vec<(LineState, u32)> {
        let lines = self.floor.fleet.ledger().jobs[&self.job].lines_now().expect("it has lines");
        lines.all().iter().map(|p| (p.state, p.pieces)).collect()
    }

    fn say(&mut self, order: StationOrder) -> Answered {
        self.floor.answer_to(5, vec![Input::ask(5, Request::Station(S1, order))])
    }

    fn is_done(&self) -> bool {
        self.floor.story(self.job).last() == Some(&"done")
    }
}

#[test]
fn a_hand_confirms_a_line_by_its_slot_and_its_tote_without_a_button() {
    let mut cell = CellFloor::new(Flow::Hand, &[("C3", 2, "B"), ("A1", 1, "A")]);
    cell.grasps("C3");
    assert_eq!(cell.lines()[0], (LineState::Lit, 0), "a grasp confirms nothing");
    cell.puts(1);
    assert_eq!(cell.lines()[0], (LineState::Lit, 1));
    cell.grasps("C3");
    cell.puts(1);
    assert_eq!(cell.lines()[0], (LineState::Done, 2));
    cell.grasps("A1");
    assert!(!cell.is_done());
    cell.puts(0);
    assert!(cell.is_done(), "a visit ends with its last line");
    assert_eq!(cell.warnings, []);
    let again = cell.say(StationOrder::Line(1, LineChange::Done(1)));
    assert!(
        matches!(again, Ok(Answer::Line(LineNoted { outcome: LineOutcome::Already, line: 1, .. }))),
        "a button for what the hand has just confirmed counts nothing: {again:?}"
    );
}

#[test]
fn where_a_button_confirms_hands_confirm_nothing() {
    let mut cell = CellFloor::new(Flow::Counted, &[("C3", 1, "B")]);
    cell.grasps("C3");
    cell.puts(1);
    assert_eq!(cell.lines(), [(LineState::Lit, 0)]);
}

#[test]
fn the_rack_leaves_at_the_last_grasp_and_the_line_is_confirmed_in_the_tote() {
    let mut cell = CellFloor::new(Flow::Seen, &[("C3", 2, "B")]);
    cell.grasps("C3");
    assert!(!cell.is_done(), "another piece is wanted");
    cell.puts(1);
    cell.grasps("C3");
    assert!(cell.is_done(), "the rack is not wanted any more");
    let left = cell.floor.fleet.ledger().unconfirmed[&S1].clone();
    assert_eq!((left.job, left.lines.pieces_left()), (cell.job, 1));
    let (map, settings) = (cell.floor.fleet.warehouse().clone(), cell.floor.fleet.settings().clone());
    let restarted = Fleet::restore(map, settings, cell.floor.facts.iter().cloned());
    assert_eq!(restarted.ledger().unconfirmed[&S1], left, "a restart forgets nothing of it");
    cell.puts(1);
    assert!(cell.floor.fleet.ledger().unconfirmed.is_empty());
    let changes =
        cell.floor.facts.iter().filter(|f| matches!(f, Fact::Job(JobFact::LineChanged { .. }))).count();
    assert_eq!(changes, 2, "each piece is confirmed once");
}

#[test]
fn a_button_decides_where_the_hand_was_not_seen_on_its_way_to_the_tote() {
    let mut cell = CellFloor::new(Flow::Seen, &[("C3", 1, "B")]);
    cell.grasps("C3");
    assert!(cell.is_done());
    cell.floor.run(2);
    cell.at = cell.face.tote(1).unwrap();
    cell.moves(cell.at, 0.4);
    assert!(!cell.floor.fleet.ledger().unconfirmed.is_empty(), "nothing is confirmed by guessing");
    let view = cell.floor.fleet.view(cell.floor.now);
    assert!(view.stations[0].unconfirmed.is_some(), "the cell asks");
    let saw =
        |after_s| cell.floor.fleet.view(cell.floor.now + Span::from_secs(after_s)).stations[0].saw_hands;
    assert!(saw(1) && !saw(11), "after a while without hands it says so");
    let noted = cell.say(StationOrder::Last(LineChange::Done(1)));
    assert!(matches!(
        noted,
        Ok(Answer::Line(LineNoted { outcome: LineOutcome::Changed, line: 0, pieces: 1, .. }))
    ));
    assert!(cell.floor.fleet.ledger().unconfirmed.is_empty());
    let why = Refusal::Pick(PickRefusal::NothingThere(S1));
    let refused = cell.say(StationOrder::Last(LineChange::Done(1)));
    assert_eq!(refused, Err(why), "there is nothing left to confirm");
}

#[test]
fn a_rack_does_not_leave_while_a_hand_is_inside() {
    let mut cell = CellFloor::new(Flow::Hand, &[("C3", 1, "B")]);
    cell.enters("C3");
    let noted = cell.say(StationOrder::Line(0, LineChange::Done(1)));
    assert!(matches!(noted, Ok(Answer::Line(LineNoted { state: LineState::Done, .. }))), "{noted:?}");
    cell.moves(cell.at, 0.5);
    assert!(!cell.is_done(), "the hand is inside");
    cell.moves(cell.front("C3"), 0.4);
    assert!(cell.is_done());
}

#[test]
fn a_rack_that_waits_for_a_hand_stays_when_the_hand_is_lost_inside_until_it_is_seen_outside() {
    let mut cell = CellFloor::new(Flow::Hand, &[("C3", 1, "B")]);
    cell.enters("C3");
    cell.say(StationOrder::Line(0, LineChange::Done(1))).unwrap();
    assert!(!cell.is_done());
    cell.floor.run(5);
    assert!(!cell.is_done(), "nobody knows where the hand is");
    cell.at = cell.front("C3");
    cell.moves(cell.at, 0.3);
    assert!(cell.is_done());
}

#[test]
fn a_rack_that_is_kept_for_a_hand_nobody_sees_any_more_leaves_by_a_button() {
    for order in [StationOrder::Release, StationOrder::Line(0, LineChange::Done(1))] {
        let mut cell = CellFloor::new(Flow::Hand, &[("C3", 1, "B")]);
        cell.enters("C3");
        cell.say(StationOrder::Line(0, LineChange::Done(1))).unwrap();
        cell.floor.run(5);
        assert!(!cell.is_done());
        cell.say(order).unwrap();
        assert!(cell.is_done(), "{order:?}");
    }
}

#[test]
fn a_rack_that_is_let_go_by_a_button_stands_while_a_hand_is_seen_inside() {
    for order in [StationOrder::Release, StationOrder::Done] {
        let mut cell = CellFloor::new(Flow::Hand, &[("C3", 1, "B")]);
        cell.enters("C3");
        let station = cell.floor.fleet.warehouse().stations[S1].node;
        let robot =
            cell.floor.fleet.ledger().present().find(|r| cell.floor.fleet.ledger().node_of(*r) == station);
        let robot = robot.expect("it is picked from");
        cell.say(order).unwrap();
        assert!(cell.is_done(), "{order:?}");
        assert_eq!(
            cell.floor.fleet.internals().writer.visits.at_hands(robot),
            Some(S1),
            "in the same step: {order:?}"
        );
    }
}

#[test]
fn a_piece_that_hand_and_button_confirm_counts_once_whoever_is_first() {
    let again = StationOrder::Line(0, LineChange::Done(1));
    let mut cell = CellFloor::new(Flow::Hand, &[("C3", 3, "B")]);
    cell.grasps("C3");
    cell.puts(1);
    let noted = cell.say(again);
    let already = |pieces| {
        move |noted: &Answered| match noted {
            Ok(Answer::Line(LineNoted { outcome, pieces: now, .. })) => {
                *outcome == LineOutcome::Already && *now == pieces
            }
            _ => false,
        }
    };
    assert!(already(1)(&noted), "{noted:?}");
    cell.floor.run(3);
    assert!(matches!(
        cell.say(again),
        Ok(Answer::Line(LineNoted { outcome: LineOutcome::Changed, pieces: 2, .. }))
    ));
    let mut cell = CellFloor::new(Flow::Hand, &[("C3", 3, "B")]);
    cell.grasps("C3");
    let noted = cell.say(again);
    assert!(
        matches!(noted, Ok(Answer::Line(LineNoted { outcome: LineOutcome::Changed, pieces: 1, .. }))),
        "{noted:?}"
    );
    cell.puts(1);
    assert_eq!(cell.lines(), [(LineState::Lit, 1)], "that is the piece for which the button was pressed");
}

#[test]
fn in_the_usual_flow_no_pace_is_learned() {
    for (flow, learns) in [(Flow::Usual, false), (Flow::Counted, true)] {
        let mut cell = CellFloor::new(flow, &[("C3", 1, "B"), ("A1", 1, "A")]);
        let before = cell.floor.fleet.internals().writer.visits.line_s(S1, 2).0;
        cell.floor.run(30);
        cell.say(StationOrder::Line(0, LineChange::Done(1))).unwrap();
        cell.floor.run(30);
        cell.say(StationOrder::Line(1, LineChange::Done(1))).unwrap();
        cell.floor.run(1);
        let after = cell.floor.fleet.internals().writer.visits.line_s(S1, 2).0;
        assert_eq!(before != after, learns, "{flow:?}: {before} then {after}");
    }
}

#[test]
fn a_wrong_slot_and_a_wrong_tote_are_warned_of_and_confirm_nothing() {
    let mut cell = CellFloor::new(Flow::Hand, &[("B2", 1, "B")]);
    cell.grasps("C2");
    assert!(cell.warnings.contains(&WrongReach::Slot(slot("C2"))), "{:?}", cell.warnings);
    cell.puts(1);
    assert_eq!(cell.lines(), [(LineState::Lit, 0)], "a wrong piece in the right tote");
    cell.warnings.clear();
    cell.grasps("B2");
    cell.puts(0);
    assert_eq!(cell.warnings, [WrongReach::Tote(0)]);
    assert_eq!(cell.lines(), [(LineState::Lit, 0)], "the right piece in a wrong tote");
    assert_eq!(cell.floor.fleet.view(cell.floor.now).stations[0].warning, Some(WrongReach::Tote(0)));
    cell.puts(1);
    assert!(!cell.is_done(), "nobody has seen what was taken out of the wrong tote");
    cell.puts(0);
    cell.puts(1);
    assert!(cell.is_done(), "it is put right");
}

#[test]
fn a_visit_is_expected_to_end_sooner_with_each_phase_of_the_hand_and_its_end_is_judged() {
    let mut cell = CellFloor::new(Flow::Seen, &[("C3", 1, "B")]);
    let station = |cell: &CellFloor| cell.floor.fleet.view(cell.floor.now).stations[0].clone();
    let left = |cell: &CellFloor| station(cell).left.expect("lines are counted").mean_s;
    cell.moves(cell.at, 0.2);
    let before = left(&cell);
    cell.moves(cell.front("C3"), 0.6);
    cell.moves(cell.face.slot(slot("C3")) - FacePlace::new(0.0, 0.12, 0.0), 0.4);
    cell.moves(cell.at, 0.2);
    let inside = left(&cell);
    assert!(inside < before - 0.5, "{inside} after {before}");
    let placed = station(&cell).placed.expect("lines are counted").mean_s;
    assert!(placed > inside + 0.3, "the piece is in its tote {placed} later, the hand out {inside}");
    assert_eq!(station(&cell).ends.visits, 0);
    cell.moves(cell.front("C3"), 0.4);
    assert!(cell.is_done());
    assert_eq!(station(&cell).ends.visits, 1, "its end was expected when it began");
}

#[test]
fn hands_can_be_warned_of_before_the_step_and_only_where_it_would_warn() {
    let mut cell = CellFloor::new(Flow::Hand, &[("C3", 1, "B")]);
    let warning = |cell: &mut CellFloor, name: &str| {
        cell.moves(cell.front(name), 0.6);
        assert_eq!(
            cell.floor.fleet.warning_of(&cell.seen(cell.floor.now), cell.floor.now),
            None,
            "it is far"
        );
        cell.at = cell.face.slot(slot(name)) - FacePlace::new(0.0, 0.06, 0.0);
        let now = cell.floor.now + Span::from_millis(150);
        let warning = cell.floor.fleet.warning_of(&cell.seen(now), now);
        cell.at = cell.front(name);
        warning.map(|w| w.wrong)
    };
    assert_eq!(warning(&mut cell, "B2"), Some(WrongReach::Slot(slot("B2"))));
    assert_eq!(warning(&mut cell, "C3"), None, "that is the lit one");
    assert_eq!(cell.warnings, [], "asking changes nothing");
}

#[test]
fn a_robot_that_would_move_at_a_hand_is_stopped_at_once() {
    let mut cell = CellFloor::new(Flow::Seen, &[("C3", 1, "B")]);
    cell.grasps("C3");
    assert!(cell.is_done());
    cell.enters("C3");
    let robot = cell.floor.fleet.ledger().present().find(|r| cell.floor.fleet.ledger().rack_on(*r).is_some());
    let stopped = cell.floor.fleet.telemetry(robot.expect("the rack leaves")).expect("it says how it is");
    assert_eq!(stopped.limit_mps, Some(0.0), "a hand has come back inside");
    assert_eq!(cell.floor.fleet.why(robot.unwrap()), Some(Why::HandInOpening(S1)), "it says why");
    cell.moves(cell.front("C3"), 0.4);
    cell.floor.run(3);
    let node = cell.floor.fleet.warehouse().stations[S1].node;
    cell.floor.until(10, "the rack has left", |f| {
        f.fleet.ledger().present().all(|r| f.fleet.ledger().node_of(r) != node)
    });
}
