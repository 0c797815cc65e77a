//! Closures that recur: announced ahead, one by one, over restarts; cancelled once or for good.

use super::*;
use giveway_floor::geometry::Spot;
use giveway_floor::id::{ClosureId, SeriesId};
use giveway_floor::time::Window;

const HOUR: i64 = 3600;

fn at(s: i64) -> Time {
    Time::ZERO + Span::from_secs(s)
}

/// Ten minutes of every hour, from the second hour on.
fn hourly(until: Time) -> RecurringClosure {
    let corner = |x, y| Spot { x_mm: x, y_mm: y };
    let outline = vec![corner(5800, 800), corner(6200, 800), corner(6200, 6200)];
    let window = Window::new(at(HOUR), at(HOUR + 600));
    let area = Closure {
        outline,
        nodes: vec![],
        window,
        reason: "mopping".into(),
        binds: Binds::Both,
        series: None,
    };
    let (every, weekdays) = (Span::from_secs(HOUR), Weekdays::ALL);
    RecurringClosure::new(area, Recurrence { every, weekdays, clock: LocalClock::default(), until })
}

fn fleet() -> (Fleet, Vec<Fact>) {
    (Fleet::new(thesis().into(), scenario(0).site.settings()), Vec::new())
}

fn step((fleet, facts): &mut (Fleet, Vec<Fact>), now: Time, inputs: Vec<Input>) -> Vec<Reply> {
    let step = fleet.step(now, inputs);
    facts.extend(step.facts);
    step.replies
}

fn recur(floor: &mut (Fleet, Vec<Fact>), closure: RecurringClosure) -> SeriesId {
    match step(floor, at(1), vec![Input::ask(1, FloorAction::Recur(closure))])[..] {
        [Reply { answer: Ok(Answer::Series(series)), .. }] => series,
        ref other => panic!("it does not recur: {other:?}"),
    }
}

/// When the occurrences begin that are announced or in force.
fn open((fleet, _): &(Fleet, Vec<Fact>), now: Time) -> Vec<(ClosureId, i64)> {
    let open = fleet.ledger().closures.iter().filter(|(_, c)| now < c.window.end());
    open.map(|(id, c)| (*id, c.window.start().0 / 1_000_000)).collect()
}

#[test]
fn the_next_occurrence_is_always_announced_and_those_that_are_over_are_forgotten() {
    let mut floor = fleet();
    recur(&mut floor, hourly(Time::MAX));
    assert_eq!(open(&floor, at(1)), [(ClosureId(1), HOUR)], "as soon as it is marked");
    for minute in 1..24 * 60 {
        step(&mut floor, at(60 * minute), vec![]);
        let ahead = open(&floor, at(60 * minute)).iter().filter(|(_, begins)| *begins > 60 * minute).count();
        assert!((1..=2).contains(&ahead), "{ahead} are announced after {minute} minutes");
    }
    let kept = floor.0.ledger().closures.len();
    assert!(kept <= 4, "{kept} of 24 are kept");
}

#[test]
fn a_restart_announces_no_occurrence_twice_and_passes_over_those_that_it_missed() {
    let mut floor = fleet();
    recur(&mut floor, hourly(Time::MAX));
    step(&mut floor, at(HOUR + 60), vec![]);
    let before = open(&floor, at(HOUR + 60));
    let again = Fleet::restore(thesis().into(), scenario(0).site.settings(), floor.1.clone());
    assert_eq!(again.ledger(), floor.0.ledger());
    floor.0 = again;
    step(&mut floor, at(HOUR + 61), vec![]);
    assert_eq!(open(&floor, at(HOUR + 61)), before);
    // The fleet did not run for five hours, and the sixth occurrence is in force.
    floor.0 = Fleet::restore(thesis().into(), scenario(0).site.settings(), floor.1.clone());
    step(&mut floor, at(6 * HOUR + 60), vec![]);
    let begins: Vec<i64> = open(&floor, at(6 * HOUR + 60)).iter().map(|(_, begins)| *begins).collect();
    assert_eq!(begins, [6 * HOUR, 7 * HOUR]);
}

#[test]
fn one_occurrence_is_cancelled_or_all_of_them() {
    let mut floor = fleet();
    let series = recur(&mut floor, hourly(Time::MAX));
    let closure = open(&floor, at(2))[0].0;
    step(&mut floor, at(2), vec![Input::ask(2, FloorAction::Reopen(closure))]);
    assert_eq!(open(&floor, at(2)).iter().map(|c| c.1).collect::<Vec<_>>(), [2 * HOUR], "the next one is");
    step(&mut floor, at(2 * HOUR + 60), vec![]);
    assert_eq!(open(&floor, at(2 * HOUR + 60)).len(), 2, "one in force, one announced");
    step(&mut floor, at(2 * HOUR + 61), vec![Input::ask(3, FloorAction::EndSeries(series))]);
    assert_eq!(open(&floor, at(2 * HOUR + 61)), []);
    step(&mut floor, at(3 * HOUR), vec![]);
    assert_eq!((open(&floor, at(3 * HOUR)), floor.0.ledger().recurring.len()), (vec![], 0));
    let refused = step(&mut floor, at(3 * HOUR), vec![Input::ask(4, FloorAction::EndSeries(series))]);
    assert_eq!(
        refused,
        [Reply { token: 4.into(), answer: Err(Refusal::Area(AreaRefusal::UnknownSeries(series))) }]
    );
}

#[test]
fn it_ends_after_its_last_occurrence_and_what_cannot_recur_is_refused() {
    let mut floor = fleet();
    recur(&mut floor, hourly(at(3 * HOUR)));
    step(&mut floor, at(2 * HOUR + 300), vec![]);
    assert_eq!(floor.0.ledger().recurring.len(), 1, "the last one is in force");
    step(&mut floor, at(2 * HOUR + 601), vec![]);
    assert_eq!((open(&floor, at(2 * HOUR + 601)), floor.0.ledger().recurring.len()), (vec![], 0));
    let too_long = RecurringClosure {
        recurrence: Recurrence { every: Span::from_secs(500), ..hourly(Time::MAX).recurrence },
        ..hourly(Time::MAX)
    };
    let refused = step(&mut floor, at(3 * HOUR), vec![Input::ask(5, FloorAction::Recur(too_long))]);
    assert_eq!(refused, [Reply { token: 5.into(), answer: Err(Refusal::Area(AreaRefusal::Recurrence)) }]);
}

#[test]
fn one_series_too_many_is_refused_until_another_is_ended() {
    let settings = Settings {
        limits: FloorLimits { recurring_closures: 2, ..FloorLimits::default() },
        ..Settings::default()
    };
    let mut fleet = Fleet::new(Arc::new(lab()), settings);
    let recur = || Input::ask(1, FloorAction::Recur(hourly(Time::MAX)));
    let mut said = |inputs: Vec<Input>| -> Vec<bool> {
        let replies = fleet.step(at(1), inputs).replies;
        replies.iter().map(|reply| matches!(reply, Reply { answer: Err(_), .. })).collect()
    };
    assert_eq!(said(vec![recur(), recur(), recur()]), [false, false, true]);
    let end = Input::ask(1, FloorAction::EndSeries(SeriesId(1)));
    assert_eq!(said(vec![end, recur(), recur()]), [false, false, true]);
}
