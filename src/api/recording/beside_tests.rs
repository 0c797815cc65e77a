//! What a recording contains besides frames, as readers see it: sums, waiting jobs, details of encounters.

use super::tests::{TestFolder, cut};
use super::*;
use crate::port::moment::Moment;
use giveway_fleet::{
    Activity, Backlog, Counts, Doing, Encounter, EncounterFact, Fact, FloorNote, JobKind, Pending, Reaction,
    ReplanCause, RobotState, RobotView, Task, View, Why,
};
use giveway_floor::geometry::{Point, Pose, Spot};
use giveway_floor::id::{ClosureId, Dense, JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::warehouse::lab;
use serde_json::{Value, json};

/// A robot that stands although it should drive, and a job that waits for another; one delivery per second.
fn frame(zero: Time, at_s: f64) -> Arc<Frame> {
    let map = Arc::new(lab());
    let now = zero + Span::from_secs_f64(at_s);
    let robot = RobotView {
        kind: "robot".into(),
        link: "sim".into(),
        link_state: None,
        critical: 0.15,
        maintenance: false,
        leaving: false,
        fault: None,
        name: "robot-1".into(),
        pose: Pose { at: Point::new(1.0, 2.0), heading: 0.0 },
        seen: Some(now),
        speed_mps: 0.0,
        battery: 1.0,
        state: RobotState::Busy,
        task: Task::Idle,
        rack: None,
        doing: Doing::Idle,
        activity: Activity::Driving,
        since: Time::ZERO,
        driven_m: 0.0,
        heard: None,
        job: None,
        granted: vec![],
        held: vec![],
        why: Some(Why::NoRoute),
        passes: None,
        replanned: None,
    };
    let job = |job: u64, kind, after| Pending {
        job: JobId(job),
        kind,
        priority: 3,
        accepted: zero + Span::from_secs(-5),
        after,
    };
    let jobs = vec![
        job(7, JobKind::Deliver { rack: RackId(0), station: StationId(0), pick: None }, None),
        job(8, JobKind::Go { robot: RobotId::at(0), node: NodeId::at(1) }, Some(JobId(7))),
    ];
    let counts = Counts { robot_deliveries: at_s as u64, waiting: 2, ..Counts::default() };
    let moment = Moment {
        view: View { now, robots: vec![robot], counts, ..View::default() },
        time_s: at_s,
        backlog: Arc::new(Backlog { at: now - Span::from_millis(500), jobs }),
        ..Moment::default()
    };
    Arc::new(Frame::of(&map, &moment, &[], 0.0))
}

/// Records a frame a second.
fn record(folder: &Arc<Folder>, from_s: u32, to_s: u32) -> Rotation {
    let mut rotation = Rotation::new(folder.clone(), Limits { age_s: f64::INFINITY, bytes: u64::MAX });
    let zero = folder.start.unwrap_or(Time::ZERO);
    (from_s..=to_s).for_each(|s| rotation.take(&frame(zero, f64::from(s))).unwrap());
    rotation
}

fn of<'a>(lines: &'a [Value], kind: &str) -> Vec<&'a Value> {
    lines.iter().filter(|l| l.get(kind).is_some()).collect()
}

#[test]
fn each_whole_picture_comes_with_sums_and_with_the_jobs_that_waited() {
    let place = TestFolder::new("beside");
    let folder = place.folder(1000);
    record(&folder, 0, 100).finish().unwrap();
    let lines = cut(&folder, 35.0, 52.0);
    let times = |kind| of(&lines, kind).iter().map(|l| l["at"].as_f64().unwrap()).collect::<Vec<_>>();
    assert_eq!(times("sum"), [30.0, 40.0, 50.0]);
    assert_eq!(times("waiting"), [29.5, 39.5, 49.5]);
    let sum = &of(&lines, "sum")[1]["sum"];
    let figures =
        ["covered_s", "robot_deliveries", "waiting_s", "worker_s"].map(|name| sum[name].as_f64().unwrap());
    assert_eq!(figures, [40.0, 40.0, 40.0, 0.0], "{sum}");
    let map = lab();
    let expected = json!([
        {"id": "j7", "kind": "deliver", "what": [map.racks[RackId(0)].name, map.stations[StationId(0)].name],
         "priority": 3, "submitted_s": -5.0},
        {"id": "j8", "kind": "go", "what": ["robot-1", map.nodes[NodeId::at(1)].name], "priority": 3,
         "submitted_s": -5.0, "after": "j7"},
    ]);
    assert_eq!(of(&lines, "waiting")[0]["waiting"], expected);
}

#[test]
fn sums_are_there_after_a_restart_and_what_an_older_version_indexed_opens_without() {
    let place = TestFolder::new("sums");
    record(&place.folder(1000), 0, 30).finish().unwrap();
    // As if killed: without an index.
    std::mem::forget(record(&place.folder(1040), 0, 30));
    let later = place.folder(1100);
    let times = |from, to| later.sums(from, to).iter().map(|s| s.at_s).collect::<Vec<_>>();
    assert_eq!(times(-200.0, 0.0), [-100.0, -90.0, -80.0, -70.0, -60.0, -50.0, -40.0, -30.0]);
    assert_eq!(times(-85.0, -55.0), [-90.0, -80.0, -70.0, -60.0, -50.0], "one beyond each end");
    assert_eq!(times(5.0, 9.0), [-30.0]);
    let began = later.sums(-60.0, -60.0)[1];
    assert_eq!((began.at_s, began.tally.covered_s), (-60.0, 0.0), "seconds begin anew");
    for recording in place.recordings() {
        let index = recording.with_extension("json");
        let mut old: Value = serde_json::from_str(&std::fs::read_to_string(&index).unwrap()).unwrap();
        old.as_object_mut().unwrap().remove("sums").expect("there were some");
        std::fs::write(&index, old.to_string()).unwrap();
    }
    let old = place.folder(1100);
    assert_eq!(old.sums(-200.0, 0.0), []);
    assert_eq!(old.past(0.0, 0.0).spans.len(), 2);
}

#[test]
fn a_robot_that_goes_another_way_is_a_bookmark_that_says_for_whom() {
    let mut recording = Recording::new(Arc::new(lab()), "lab".into(), None);
    let (robot, at) = (RobotId::at(0), Time::from_secs_f64(0.5));
    for cause in [
        ReplanCause::Worker(WorkerId::at(0)),
        ReplanCause::Closure(ClosureId(3)),
        ReplanCause::Robot(robot),
        ReplanCause::Obstruction,
    ] {
        recording.note(&Fact::Noted(FloorNote::Replanned { robot, cause, was: vec![], now: vec![], at }));
    }
    let marks = recording.add(&frame(Time::ZERO, 1.0)).unwrap().marks;
    let said: Vec<_> = marks.iter().map(|m| (m.kind, m.words.text(), m.who.join(" "))).collect();
    let of = |words, who: &str| (MarkKind::Replan, words, who.to_owned());
    let expected = [
        of("robot-1 went another way for w1", "robot-1 w1"),
        of("robot-1 went round c3", "robot-1"),
        of("robot-1 went round robot-1", "robot-1 robot-1"),
        of("robot-1 went round an obstruction", "robot-1"),
    ];
    assert_eq!(said, expected);
    assert!(marks.iter().all(|m| m.place == Some([1.0, 2.0]) && m.at_s == 0.5), "{marks:?}");
}

#[test]
fn robots_that_go_other_ways_for_one_worker_again_and_again_are_a_bookmark_each_half_minute() {
    let mut recording = Recording::new(Arc::new(lab()), "lab".into(), None);
    let mut marks = Vec::new();
    for second in 1..=100_i64 {
        for worker in [0, 1] {
            let (robot, cause) = (RobotId::at(0), ReplanCause::Worker(WorkerId::at(worker)));
            let at = Time::ZERO + Span::from_secs(second);
            recording.note(&Fact::Noted(FloorNote::Replanned { robot, cause, was: vec![], now: vec![], at }));
        }
        marks.extend(recording.add(&frame(Time::ZERO, second as f64)).unwrap().marks);
    }
    let times: Vec<f64> = marks.iter().map(|m| m.at_s).collect();
    assert_eq!(times, [1.0, 1.0, 31.0, 31.0, 61.0, 61.0, 91.0, 91.0]);
}

#[test]
fn pictures_that_are_far_apart_have_nothing_counted_between_them() {
    let mut recording = Recording::new(Arc::new(lab()), "lab".into(), None);
    let times = [0.0, 0.2, 0.4, 20.0, 20.5];
    let sums: Vec<Sum> =
        times.iter().flat_map(|at| recording.add(&frame(Time::ZERO, *at)).unwrap().sums).collect();
    recording.header();
    let last = recording.add(&frame(Time::ZERO, 21.0)).unwrap().sums[0];
    assert_eq!(sums.iter().map(|s| s.tally.covered_s).collect::<Vec<_>>(), [0.0, 0.4]);
    assert_eq!((last.tally.covered_s, last.tally.waiting_s), (1.4, 1.4));
}

#[test]
fn the_bookmark_of_an_encounter_has_its_details_in_the_seconds_of_whoever_asks() {
    let place = TestFolder::new("met");
    let folder = place.folder(1000);
    let mut rotation = record(&folder, 0, 10);
    let at = |s: i64| Time((1000 + s) * 1_000_000);
    rotation.note(&Fact::Encounter(EncounterFact::Met(Encounter {
        worker: WorkerId::at(0),
        robot: RobotId::at(0),
        began: at(8),
        ended: at(10),
        at: Spot { x_mm: 1500, y_mm: -250 },
        radius_mm: 1400,
        closest_mm: 620,
        robot_mmps: 500,
        worker_mmps: 1200,
        reaction: Reaction::Stopped,
        delay: Span::from_millis(2500),
    })));
    rotation.take(&frame(at(0), 11.0)).unwrap();
    rotation.finish().unwrap();
    let marks = place.folder(1100).past(f64::NEG_INFINITY, f64::INFINITY).marks;
    let details = json!({"worker": "w1", "robot": "robot-1", "ended_s": -90.0, "x": 1.5, "y": -0.25, "radius": 1.4,
        "closest": 0.62, "robot_speed": 0.5, "worker_speed": 1.2, "reaction": "stopped", "delay_s": 2.5});
    assert_eq!((marks[0].at_s, json!(marks[0])["encounter"].clone()), (-92.0, details));
    let lines = cut(&place.folder(1000), 0.0, 20.0);
    assert_eq!(of(&lines, "mark")[0]["mark"]["encounter"]["ended_s"], 10.0);
    let old = r#"{"at_s": 1.0, "kind": "encounter", "words": "", "who": [], "place": null}"#;
    let old: Mark = serde_json::from_str(old).expect("older reels are read");
    assert!(!json!(old).as_object().unwrap().contains_key("encounter"));
}
