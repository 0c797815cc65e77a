//! Figures over time, from made-up views.

use super::*;
use crate::WorkerView;
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::id::Dense;

const SECOND: Span = Span::from_secs(1);

fn start() -> Time {
    // A whole number of days, so that all buckets begin here.
    Time(20_000 * 86_400 * 1_000_000)
}

fn robot(at: usize, why: Option<Why>) -> RobotView {
    RobotView {
        link: "sim".into(),
        link_state: None,
        kind: "robot".into(),
        critical: 0.15,
        maintenance: false,
        leaving: false,
        fault: None,
        name: "r".into(),
        pose: Pose { at: Point::new(0.0, 0.0), heading: 0.0 },
        seen: None,
        speed_mps: 0.0,
        battery: 1.0,
        state: crate::RobotState::Busy,
        task: crate::Task::Idle,
        rack: None,
        doing: crate::Doing::Carrying,
        activity: crate::Activity::Driving,
        since: Time::ZERO,
        driven_m: 0.0,
        heard: None,
        job: None,
        granted: vec![NodeId::at(at)],
        held: vec![],
        why,
        passes: None,
        replanned: None,
    }
}

fn worker(presence: Presence) -> WorkerView {
    WorkerView {
        name: "anna".into(),
        mover: Default::default(),
        presence,
        pose: None,
        seen: None,
        speed_mps: 0.0,
        accuracy_m: 0.1,
        area: vec![],
        regions_m: [1.0, 2.0, 3.0],
        guidance: Default::default(),
        goals: vec![],
        undecided: 1.0,
        elsewhere: 0.0,
        episodes: Vec::new(),
        feed: Default::default(),
    }
}

/// A fleet that delivers once a second, at second `s`, with a robot that waits and one worker on the floor.
fn picture(s: i64) -> View {
    let counts = Counts { robot_deliveries: s.unsigned_abs(), encounters: 2, ..Counts::default() };
    let robots = vec![robot(3, Some(Why::NoRoute)), robot(4, None), robot(5, Some(Why::Failed))];
    let workers = vec![worker(Presence::Tracked), worker(Presence::Absent)];
    View { now: start() + SECOND * s, counts, robots, workers, ..View::default() }
}

fn after(seconds: std::ops::RangeInclusive<i64>) -> History {
    let mut history = History::default();
    let times = LoopTimes { searches_us: vec![100, 200], step_us: 900 };
    seconds.for_each(|s| history.note(&picture(s), &times));
    history
}

#[test]
fn a_bucket_holds_what_happened_in_it_and_only_that() {
    let history = after(0..=60);
    let buckets = history.read(start(), start() + SECOND * 60, Span::from_secs(10));
    assert_eq!(buckets.len(), 6);
    let second = &buckets[1];
    assert_eq!((second.start, second.robot_deliveries), (start() + SECOND * 10, 10));
    assert_eq!(
        (second.covered, second.encounters),
        (SECOND * 10, 0),
        "those before the first picture do not count"
    );
    assert_eq!(second.worker_time, SECOND * 10, "whoever is absent is not on the floor");
    assert_eq!(second.waiting_time, SECOND * 10, "a broken robot does not wait");
    assert_eq!((second.searches.count(), second.searches.max_us(), second.step_max_us), (20, 200, 900));
    assert_eq!(history.heat().read(start(), start() + SECOND * 60), [(NodeId::at(3), SECOND * 60)].into());
}

#[test]
fn coarser_steps_hold_the_same_sums() {
    let history = after(0..=1200);
    for step in [10, 20, 60, 300, 600] {
        let buckets = history.read(start(), start() + SECOND * 1200, Span::from_secs(step));
        assert_eq!(buckets.len(), 1200 / step as usize);
        assert_eq!(buckets.iter().map(|b| b.robot_deliveries).sum::<u64>(), 1199, "by {step} s");
    }
}

#[test]
fn memory_is_bounded_and_old_hours_are_in_minutes() {
    let mut history = History::default();
    // A view every ten seconds: two days, with gaps all over.
    for s in (0..2 * 86_400).step_by(10) {
        history.note(&picture(s), &LoopTimes::default());
    }
    let lengths: Vec<usize> = history.tiers.iter().map(VecDeque::len).collect();
    assert_eq!(lengths, [360, 1440, 288]);
    assert_eq!(history.heat.since(Time::ZERO).len(), DAY);
    let now = start() + Span::from_secs(2 * 86_400);
    assert_eq!(history.tier(now - Span::from_secs(900), Span::from_secs(10)), 0);
    assert_eq!(history.tier(now - Span::from_secs(7200), Span::from_secs(60)), 1);
    assert_eq!(
        history.tier(now - Span::from_secs(7200), Span::from_secs(30)),
        0,
        "only the finest fits 30 s"
    );
    assert_eq!(history.tier(now - Span::from_secs(3 * 86_400), Span::from_secs(600)), 2);
}

#[test]
fn a_gap_stays_a_gap() {
    let mut history = after(0..=20);
    (100..=120).for_each(|s| history.note(&picture(s), &LoopTimes::default()));
    let buckets = history.read(start(), start() + SECOND * 200, Span::from_secs(10));
    let starts: Vec<i64> = buckets.iter().map(|b| (b.start - start()).0 / 1_000_000).collect();
    assert_eq!(starts, [0, 10, 20, 100, 110, 120]);
    assert_eq!(
        buckets.iter().map(|b| b.robot_deliveries).sum::<u64>(),
        40,
        "what nobody saw is in no bucket"
    );
}

#[test]
fn what_was_written_down_goes_on_after_a_restart() {
    let whole = after(0..=700);
    let mut first = after(0..=333);
    let heat = first.heat().since(Time(i64::MIN / 2));
    let mut second = History::restore(first.since(Time(i64::MIN / 2)), heat);
    first.note(&picture(334), &LoopTimes::default());
    (333..=700)
        .for_each(|s| second.note(&picture(s), &LoopTimes { searches_us: vec![100, 200], step_us: 900 }));
    for step in [10, 60, 600] {
        let read = |h: &History| h.read(start(), start() + SECOND * 700, Span::from_secs(step));
        assert_eq!(read(&second), read(&whole), "by {step} s");
    }
    assert_eq!(
        second.heat().read(start(), start() + SECOND * 700),
        whole.heat().read(start(), start() + SECOND * 700)
    );
    let changed = second.since(start() + SECOND * 695);
    assert_eq!(changed.len(), 2 + 1 + 1, "two of ten seconds, one of a minute, one of ten minutes");
}

#[test]
fn a_recording_that_is_wound_back_takes_away_what_comes_later() {
    let mut history = after(0..=300);
    history.note(&picture(100), &LoopTimes::default());
    (101..=120).for_each(|s| history.note(&picture(s), &LoopTimes::default()));
    let buckets = history.read(start(), start() + SECOND * 400, Span::from_secs(10));
    assert_eq!(buckets.last().map(|b| b.start), Some(start() + SECOND * 120));
    assert!(buckets.windows(2).all(|w| w[0].start < w[1].start));
}

#[test]
fn of_very_many_places_those_with_the_most_waiting_are_kept() {
    let mut heat = Heat::default();
    let all: Vec<NodeId> = (0..5000).map(NodeId::at).collect();
    heat.note(start(), SECOND, &all);
    heat.note(start() + SECOND, SECOND, &all[4000..]);
    heat.note(start() + HEAT_STEP, SECOND, &[]);
    let kept = heat.read(start(), start() + SECOND);
    assert!(kept.len() <= 2000, "{}", kept.len());
}

fn doing(activity: crate::Activity, why: Option<Why>) -> RobotView {
    RobotView { activity, ..robot(0, why) }
}

#[test]
fn a_robot_that_waits_for_a_robot_that_waits_waits_for_what_that_one_waits_for() {
    use crate::Activity::{Charging, Driving, Failed, Paused, Picking, Waiting};
    use giveway_floor::id::{ResourceId, RobotId, WorkerId};
    let on = |robot: usize| Some(Why::WaitsFor(ResourceId::at(0), RobotId::at(robot)));
    let robots = vec![
        doing(Waiting, on(1)),
        doing(Waiting, on(2)),
        doing(Waiting, Some(Why::GivesWay(WorkerId::at(0)))),
        doing(Waiting, on(4)),
        doing(Failed, Some(Why::Failed)),
        doing(Waiting, on(6)),
        doing(Driving, None),
        // A cycle of two robots.
        doing(Waiting, on(8)),
        doing(Waiting, on(7)),
        doing(Waiting, on(10)),
        doing(Paused, Some(Why::Paused)),
        doing(Waiting, on(12)),
        doing(Picking, None),
        doing(Charging, None),
    ];
    let view = View { robots, ..View::default() };
    let times = RobotTimes::of(&view, SECOND);
    let waited = |cause: WaitCause| times.waiting[cause as usize].0 / SECOND.0;
    assert_eq!(waited(WaitCause::Person), 3);
    assert_eq!(waited(WaitCause::RobotOut), 1);
    assert_eq!(waited(WaitCause::Traffic), 3);
    assert_eq!(waited(WaitCause::ByHand), 1);
    assert_eq!(waited(WaitCause::Station), 1);
    assert_eq!(times.activities[Waiting as usize], SECOND * 9);
    assert_eq!(RobotTimes::parse(&times.text()), times);
    assert_eq!(RobotTimes::parse("juggling:5 driving:x picking:7").activities[Picking as usize], Span(7));
}
