//! Order lines at a work cell: a visit ends with its last line, and nothing of it is lost or counted twice.

use super::*;
use giveway_cell::{LineChange, LineOutcome, LineProblem, LineRefusal, LineState, OrderLine, PickedBy};
use giveway_floor::warehouse::stations;

fn line(slot: &str, quantity: u32, tote: &str) -> OrderLine {
    let slot = slot.parse().expect("a slot");
    OrderLine { slot, quantity, tote: tote.into(), item: None, by: PickedBy::Either }
}

/// A delivery whose simulated picker takes very long, with these lines at stations one after the other.
fn picked(lines: &[&[OrderLine]]) -> JobRequest {
    let pick = Some(Span::from_secs(900));
    let then = (1..lines.len() as u32).map(|s| Visiting { station: StationId(s), pick }).collect();
    let kind = JobKind::Deliver { rack: RackId(3), station: StationId(0), pick };
    let lines = lines.iter().map(|l| l.to_vec()).collect();
    JobRequest { then, lines, ..request(kind) }
}

impl TestFloor {
    /// A floor with the rack of such a job at its first station.
    fn at_cell(request: JobRequest) -> (TestFloor, JobId) {
        let mut floor = TestFloor::new(stations(), &scenario(2));
        let job = floor.submit(request);
        floor.until(300, "the rack is picked from", |f| f.is(job, "picking"));
        (floor, job)
    }

    fn say(&mut self, station: u32, order: StationOrder) -> Answered {
        self.answer_to(5, vec![Input::ask(5, Request::Station(StationId(station), order))])
    }

    fn line_said(&mut self, n: usize, change: LineChange) -> Result<(LineOutcome, LineState, u32), Refusal> {
        match self.say(0, StationOrder::Line(n, change)) {
            Ok(Answer::Line(LineNoted { outcome, state, pieces, .. })) => Ok((outcome, state, pieces)),
            Err(why) => Err(why),
            other => panic!("no answer about a line: {other:?}"),
        }
    }

    fn lines(&self, job: JobId) -> Vec<(LineState, u32)> {
        let lines = self.fleet.ledger().jobs[&job].lines_now().expect("it has lines");
        lines.all().iter().map(|p| (p.state, p.pieces)).collect()
    }

    fn changes(&self) -> usize {
        self.facts.iter().filter(|f| matches!(f, Fact::Job(JobFact::LineChanged { .. }))).count()
    }
}

#[test]
fn a_visit_ends_with_its_last_line_and_the_rack_leaves_without_another_word() {
    let (mut floor, job) = TestFloor::at_cell(picked(&[&[line("C3", 2, "B"), line("A1", 1, "A")]]));
    assert_eq!(floor.lines(job), [(LineState::Lit, 0), (LineState::Open, 0)]);
    assert_eq!(floor.line_said(0, LineChange::Done(1)), Ok((LineOutcome::Changed, LineState::Lit, 1)));
    assert_eq!(floor.line_said(0, LineChange::Done(1)), Ok((LineOutcome::Changed, LineState::Done, 2)));
    assert!(floor.is(job, "picking"));
    assert_eq!(floor.line_said(1, LineChange::Done(1)), Ok((LineOutcome::Changed, LineState::Done, 1)));
    assert_eq!(floor.story(job).last(), Some(&"done"));
    let node = floor.fleet.warehouse().stations[StationId(0)].node;
    floor.until(5, "the robot has left", |f| {
        f.fleet.ledger().present().all(|r| f.fleet.ledger().node_of(r) != node)
    });
    assert_eq!(floor.fleet.ledger().counts.robot_deliveries, 1);
    let why = Refusal::Pick(PickRefusal::NothingThere(StationId(0)));
    assert_eq!(floor.line_said(1, LineChange::Undo), Err(why), "the rack is gone");
}

#[test]
fn a_line_that_is_short_or_taken_back_is_picked_no_more_or_anew() {
    let (mut floor, job) = TestFloor::at_cell(picked(&[&[line("C3", 2, "B"), line("A1", 1, "A")]]));
    floor.line_said(0, LineChange::Done(2)).unwrap();
    assert_eq!(floor.line_said(0, LineChange::Undo), Ok((LineOutcome::Changed, LineState::Lit, 0)));
    floor.line_said(1, LineChange::Short).unwrap();
    assert_eq!(floor.lines(job), [(LineState::Lit, 0), (LineState::Short, 0)]);
    floor.line_said(0, LineChange::Done(2)).unwrap();
    assert_eq!(floor.story(job).last(), Some(&"done"), "what is short was picked as far as it goes");
}

#[test]
fn what_was_confirmed_is_confirmed_once_and_what_cannot_be_is_refused() {
    let (mut floor, _) = TestFloor::at_cell(picked(&[&[line("C3", 1, "B"), line("A1", 2, "A")]]));
    floor.line_said(0, LineChange::Done(1)).unwrap();
    assert_eq!(floor.line_said(0, LineChange::Done(1)), Ok((LineOutcome::Already, LineState::Done, 1)));
    let refused = |why| Err(Refusal::Pick(PickRefusal::Line(why)));
    assert_eq!(floor.line_said(2, LineChange::Short), refused(LineRefusal::NoLine(2)));
    assert_eq!(floor.line_said(1, LineChange::Done(3)), refused(LineRefusal::TooMany(2)));
    assert_eq!(floor.line_said(1, LineChange::Done(0)), refused(LineRefusal::NoPieces));
    assert_eq!(floor.changes(), 1);
}

#[test]
fn a_visit_without_lines_has_none_to_speak_of() {
    let (mut floor, _) = TestFloor::at_cell(picked(&[]));
    assert_eq!(
        floor.line_said(0, LineChange::Short),
        Err(Refusal::Pick(PickRefusal::Line(LineRefusal::NoLine(0))))
    );
}

#[test]
fn whoever_ends_the_visit_settles_all_lines_that_are_left() {
    for (order, state, pieces, story) in [
        (StationOrder::Done, LineState::Done, 2, "done"),
        (StationOrder::Release, LineState::Short, 1, "done"),
        (StationOrder::Short, LineState::Short, 1, "failed"),
    ] {
        let request = picked(&[&[line("C3", 2, "B")], &[line("A1", 1, "A")]]);
        let (mut floor, job) = TestFloor::at_cell(request);
        floor.line_said(0, LineChange::Done(1)).unwrap();
        floor.say(0, order).unwrap();
        if story == "failed" {
            assert_eq!(floor.story(job).last(), Some(&"failed"), "{order:?}");
            continue;
        }
        assert!(floor.is(job, "carrying"), "{order:?}: it goes on to its second station");
        let lines = &floor.fleet.ledger().jobs[&job].lines;
        let first = &lines[0].all()[0];
        assert_eq!((first.state, first.pieces), (state, pieces), "{order:?}");
        assert_eq!(lines[1].pieces_left(), 1);
        floor.until(300, "it is at its second station", |f| f.is(job, "picking"));
        assert_eq!(floor.lines(job), [(LineState::Lit, 0)]);
        floor.say(1, StationOrder::Line(0, LineChange::Done(1))).unwrap();
        assert_eq!(floor.story(job).last(), Some(&"done"), "{order:?}");
    }
}

#[test]
fn a_restart_in_mid_visit_loses_no_confirmed_line_and_confirms_none_twice() {
    let scenario = scenario(2);
    let (mut floor, job) = TestFloor::at_cell(picked(&[&[line("C3", 2, "B"), line("A1", 2, "A")]]));
    floor.line_said(0, LineChange::Done(2)).unwrap();
    floor.line_said(1, LineChange::Done(1)).unwrap();
    let before = floor.lines(job);
    floor.restart(&scenario);
    floor.assert_fold();
    assert_eq!(floor.lines(job), before);
    assert_eq!(floor.line_said(0, LineChange::Done(2)), Ok((LineOutcome::Already, LineState::Done, 2)));
    assert_eq!(floor.line_said(1, LineChange::Done(1)), Ok((LineOutcome::Changed, LineState::Done, 2)));
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn a_job_whose_lines_cannot_be_picked_is_not_taken_and_each_reason_is_named() {
    let mut floor = TestFloor::new(stations(), &scenario(2));
    let (good, by_arm) = (line("C3", 1, "B"), |l: OrderLine| OrderLine { by: PickedBy::Arm, ..l });
    let too_many = vec![good.clone(); giveway_cell::MOST_LINES + 1];
    let cases: [(&[OrderLine], usize, LineProblem); 6] = [
        (&[good.clone(), line("Z9", 1, "B")], 1, LineProblem::UnknownSlot),
        (&[line("C3", 1, "Q")], 0, LineProblem::UnknownTote),
        (&[line("C3", 0, "B")], 0, LineProblem::Quantity),
        (&[line("C3", 10_001, "B")], 0, LineProblem::Quantity),
        (&[good.clone(), line("A1", 1, "B"), good.clone()], 2, LineProblem::Twice(0)),
        (&too_many, 200, LineProblem::TooMany),
    ];
    for (lines, n, problem) in cases {
        let why = Refusal::Pick(PickRefusal::CannotPick(0, n, problem));
        assert_eq!(floor.ask(picked(&[lines])), Err(why));
    }
    let two = |lines: [Vec<OrderLine>; 2]| picked(&[&lines[0], &lines[1]]);
    let ask = |floor: &mut TestFloor, mut request: JobRequest, station: u32| {
        request.then[0].station = StationId(station);
        floor.ask(request)
    };
    let why = Refusal::Pick(PickRefusal::CannotPick(1, 0, LineProblem::NoArm));
    let refused = ask(&mut floor, two([vec![good.clone()], vec![by_arm(good.clone())]]), 3);
    assert_eq!(refused, Err(why));
    let with_arm = ask(&mut floor, two([vec![], vec![by_arm(good.clone())]]), 1);
    assert!(matches!(with_arm, Ok(Answer::Job(_))), "{with_arm:?}");
    let half = JobRequest { lines: vec![vec![good.clone()]], ..two([vec![], vec![]]) };
    assert_eq!(floor.ask(half), Err(Refusal::Pick(PickRefusal::LinesPerStation)));
    let mut plain = TestFloor::lab(1);
    let why = Refusal::Pick(PickRefusal::CannotPick(0, 0, LineProblem::NoCell));
    assert_eq!(plain.ask(picked(&[&[good]])), Err(why));
}

#[test]
fn the_planned_end_of_a_visit_follows_its_lines_in_few_changes_and_robots_behind_with_it() {
    let (mut floor, first) = TestFloor::at_cell(picked(&[&[line("C3", 1, "B"), line("A1", 1, "A")]]));
    let kind = JobKind::Deliver { rack: RackId(5), station: StationId(0), pick: None };
    floor.submit(request(kind));
    let robot = floor.state(first).and_then(|s| s.robot()).expect("it is picked from");
    let end = |f: &TestFloor| {
        let chain = f.fleet.ledger().chain(robot);
        chain.get(chain.first()).expect("it stands there").depart - f.now
    };
    let near = |span: Span, seconds: f64| (span.as_secs_f64() - seconds).abs() < 0.3 * seconds;
    floor.run(60);
    assert!(near(end(&floor), 840.0), "what the customer said: {:?}", end(&floor));
    let retimed = |f: &TestFloor| {
        let of_it = |m: &Moved| m.robot == robot;
        let facts = f.facts.iter();
        facts
            .filter(|f| matches!(f, Fact::Route(RouteFact::Retimed { moved }) if moved.iter().any(of_it)))
            .count()
    };
    let before = retimed(&floor);
    let next = floor.fleet.view(floor.now).stations[0].next.expect("another rack is on its way").1;
    floor.line_said(0, LineChange::Done(1)).unwrap();
    floor.run(2);
    assert!(near(end(&floor), 450.0), "half of the lines are left: {:?}", end(&floor));
    let sooner = floor.fleet.view(floor.now).stations[0].next.expect("it still comes").1;
    assert!(sooner <= next, "{sooner:?} and {next:?}");
    floor.line_said(0, LineChange::Undo).unwrap();
    floor.run(2);
    assert!(near(end(&floor), 900.0), "all of it again: {:?}", end(&floor));
    floor.run(120);
    let changes = retimed(&floor) - before;
    assert!((2..=8).contains(&changes), "{changes} changes in two minutes");
}

#[test]
fn lines_that_are_done_one_by_one_teach_the_pace_and_lines_confirmed_at_once_do_not() {
    let taught = |order: Option<StationOrder>| {
        let lines = [line("C3", 1, "B"), line("A1", 1, "A"), line("B2", 1, "A")];
        let (mut floor, _) = TestFloor::at_cell(picked(&[&lines]));
        let kind = JobKind::Deliver { rack: RackId(5), station: StationId(0), pick: None };
        let other = Job::new(JobRequest { lines: vec![lines.to_vec()], ..request(kind) }, floor.now);
        let stay = |f: &TestFloor| f.fleet.internals().writer.visits.stay(&other).expect("it has lines");
        let before = stay(&floor);
        match order {
            Some(order) => {
                floor.run(15);
                floor.say(0, order).unwrap();
            }
            None => (0..3).for_each(|n| {
                floor.run(15);
                floor.line_said(n, LineChange::Done(1)).unwrap();
            }),
        }
        floor.run(1);
        stay(&floor) - before
    };
    assert!(taught(None) > Span::from_secs(1), "fifteen seconds a line are slow");
    assert_eq!(taught(Some(StationOrder::Done)), Span::ZERO);
    assert_eq!(taught(Some(StationOrder::Release)), Span::ZERO);
}

/// A delivery of a rack to a station, with this many lines of three pieces.
fn lines_for(rack: u32, station: u32, count: u8) -> JobRequest {
    let line = |i: u8| line(["A1", "B1", "C1", "A2", "B2", "C2", "A3", "B3"][usize::from(i)], 3, "A");
    let kind = JobKind::Deliver { rack: RackId(rack), station: StationId(station), pick: None };
    JobRequest { lines: vec![(0..count).map(line).collect()], ..request(kind) }
}

#[test]
fn seconds_of_work_and_not_racks_decide_for_which_station_the_next_rack_is_fetched() {
    for busy in [0, 1] {
        let mut floor = TestFloor::new(stations(), &scenario(3));
        // One rack is on its way to each station: eight lines to one, one line to the other.
        let first = [0, 1].map(|s| floor.submit(lines_for(3 + s, s, if s == busy { 8 } else { 1 })));
        floor.until(60, "both have a robot", |f| first.iter().all(|job| !f.is(*job, "waiting")));
        let inputs = [0, 1].map(|s| Input::ask(20 + u64::from(s), JobAction::Submit(lines_for(5 + s, s, 1))));
        let replies = floor.step(inputs.into()).replies;
        let next: Vec<JobId> = replies.iter().filter_map(accepted).collect();
        floor.until(60, "one of them has the third robot", |f| next.iter().any(|job| !f.is(*job, "waiting")));
        let waits = next.iter().position(|job| floor.is(*job, "waiting")).expect("there are three robots");
        assert_eq!(waits as u32, busy, "that station has work for a minute");
    }
}

fn accepted(reply: &Reply) -> Option<JobId> {
    match &reply.answer {
        Ok(Answer::Job(Made { id, .. })) => Some(*id),
        _ => None,
    }
}
