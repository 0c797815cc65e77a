//! Poses as devices send them, good and bad.

use super::*;
use crate::feed::intake::clock::Exchange;
use crate::feed::wire::HandsSaid;

const NOW: Time = Time(1_800_000_000_000_000);

/// A device with a clock that reads 1000 ms at `NOW`.
fn intake(frame: PoseFrame) -> PoseIntake {
    let mut intake = PoseIntake::new(WorkerId(3), frame);
    let (asked, heard) = (NOW - Span::from_millis(4), NOW);
    let e = Exchange { asked, got_ms: 998.0, answered_ms: 998.0, heard };
    intake.clock.take(e);
    intake
}

fn pose(seq: u64) -> PoseSaid {
    PoseSaid {
        epoch: 1,
        seq,
        t: 1000.0,
        pos: Some([2.0, 1.6, -3.0]),
        quat: Some([0.0, 0.0, 0.0, 1.0]),
        at: None,
        heading: None,
        accuracy: Some(0.03),
        quality: QualitySaid::Tracked,
        gaze: None,
        hands: None,
        battery: None,
    }
}

#[test]
fn poses_stay_in_order_where_the_clock_is_corrected_in_between() {
    let mut intake = intake(PoseFrame::Map);
    let at = |seq: u64, t: f64| PoseSaid { t, ..pose(seq) };
    let first = intake.take(&at(1, 1000.0), NOW).unwrap().sighting.seen;
    // The ping was delayed on its way to the device, its answer was not: the offset was too large by 15 ms.
    intake.reset();
    let asked = NOW + Span::from_millis(5);
    intake.clock.take(Exchange { asked, got_ms: 1020.0, answered_ms: 1020.0, heard: asked });
    let epoch = |p: PoseSaid| PoseSaid { epoch: 2, ..p };
    let second = intake.take(&epoch(at(2, 1003.0)), asked).unwrap().sighting.seen;
    let third = intake.take(&epoch(at(3, 1016.0)), asked).unwrap().sighting.seen;
    assert!(first < second && second < third, "{first:?} {second:?} {third:?}");
    let fourth = intake.take(&epoch(at(4, 1050.0)), asked + Span::from_millis(30)).unwrap().sighting.seen;
    assert_eq!(fourth - asked, Span::from_millis(30), "soon it is the corrected clock that counts");
    let old = intake.take(&epoch(at(5, 1001.0)), asked).unwrap().sighting.seen;
    assert!(old < second, "what was seen before stays before");
}

#[test]
fn a_pose_becomes_a_sighting_on_the_map() {
    let mut intake = intake(PoseFrame::Device);
    assert_eq!(intake.take(&pose(1), NOW), Err(PoseFault::NotAligned));
    let quarter = std::f64::consts::FRAC_PI_2;
    let mark = PointPair {
        device: Vector::zeros(),
        map: Point::new(10.0, 5.0),
        weight: 1.0,
        turn: Some(quarter),
        height_m: 0.0,
        heading: Some(quarter),
    };
    intake.align(&[mark], true).unwrap();
    assert_eq!(intake.take(&pose(1), NOW), Err(PoseFault::OldEpoch));
    let taken = intake.take(&PoseSaid { epoch: 2, ..pose(1) }, NOW).unwrap();
    let s = taken.sighting;
    assert!((s.at - Point::new(7.0, 7.0)).norm() < 1e-9, "{s:?}");
    assert!((s.heading.unwrap().abs() - std::f64::consts::PI).abs() < 1e-9, "{s:?}");
    assert_eq!((s.worker, s.epoch, s.seq), (WorkerId(3), 2, 1));
    assert!(s.at_marks, "they were touched for this epoch");
    assert!((s.seen - NOW).0.abs() <= 2000, "{:?}", s.seen - NOW);
    assert!(s.accuracy_m > 0.12 && s.accuracy_m < 0.15, "3.6 m off a mark whose turn is known to 2 degrees");
    assert_eq!(intake.take(&PoseSaid { epoch: 3, ..pose(2) }, NOW), Err(PoseFault::UnknownEpoch));
}

#[test]
fn late_and_repeated_poses_go_on_and_are_told() {
    let mut intake = intake(PoseFrame::Map);
    let fault = |intake: &mut PoseIntake, seq| intake.take(&pose(seq), NOW).unwrap().fault;
    assert_eq!(fault(&mut intake, 5), None);
    assert_eq!(fault(&mut intake, 5), Some(PoseFault::Repeated));
    assert_eq!(fault(&mut intake, 4), Some(PoseFault::Reordered));
    assert_eq!(fault(&mut intake, 9), None, "gaps are no fault");
}

#[test]
fn a_number_that_was_far_too_large_does_not_silence_the_feed() {
    let mut intake = intake(PoseFrame::Map);
    let mut taken = |seq, t| intake.take(&PoseSaid { t, ..pose(seq) }, NOW).unwrap();
    let first = taken(1, 1000.0).sighting.seq;
    assert_eq!(taken(1 << 63, 1001.0).fault, None);
    let faults: Vec<_> = (2..8).map(|seq| taken(seq, 1000.0 + seq as f64).fault).collect();
    let late = Some(PoseFault::Reordered);
    assert_eq!(faults, [late, late, late, late, None, None]);
    let last = taken(8, 1010.0).sighting.seq;
    assert!(last > first, "the fleet drops it: {last} after {first}");
    assert_eq!(taken(u64::MAX, 1011.0).fault, None);
    assert_eq!(taken(7, 1005.0).fault, late, "what is earlier stays late");
}

#[test]
fn a_clock_that_jumps_between_two_poses_is_measured_anew_at_once() {
    for jump_ms in [-3_600_000.0, -4000.0, 4000.0, 3_600_000.0] {
        let mut intake = intake(PoseFrame::Map);
        intake.clock.pinged(NOW);
        let after = |s: i64| NOW + Span::from_secs(s);
        intake.take(&pose(1), NOW).unwrap();
        intake.take(&PoseSaid { t: 3000.0, ..pose(2) }, after(2)).unwrap();
        assert!(intake.clock.due().is_some(), "nothing has jumped");
        let _ = intake.take(&PoseSaid { t: 7000.0 + jump_ms, ..pose(3) }, after(6));
        assert_eq!(intake.clock.due(), None, "{jump_ms}");
    }
}

#[test]
fn what_cannot_be_a_place_or_a_time_stops_here() {
    let mut intake = intake(PoseFrame::Map);
    let bad = [
        (PoseSaid { pos: None, ..pose(1) }, PoseFault::NoPosition),
        (PoseSaid { pos: Some([1e9, 0.0, 0.0]), ..pose(1) }, PoseFault::Absurd),
        (PoseSaid { pos: Some([f64::NAN, 0.0, 0.0]), ..pose(1) }, PoseFault::Absurd),
        (PoseSaid { accuracy: Some(-1.0), ..pose(1) }, PoseFault::Absurd),
        (PoseSaid { accuracy: Some(f64::NAN), ..pose(1) }, PoseFault::Absurd),
        (PoseSaid { t: f64::INFINITY, ..pose(1) }, PoseFault::Absurd),
        (PoseSaid { quat: Some([0.0; 4]), ..pose(1) }, PoseFault::Quaternion),
        (PoseSaid { t: 1150.0, ..pose(1) }, PoseFault::Future),
        (PoseSaid { t: 1e300, ..pose(1) }, PoseFault::Future),
        (PoseSaid { t: -10_000.0, ..pose(1) }, PoseFault::TooOld),
    ];
    for (said, fault) in bad {
        assert_eq!(intake.take(&said, NOW), Err(fault), "{said:?}");
    }
    assert!(intake.take(&PoseSaid { t: 1050.0, ..pose(1) }, NOW).is_ok(), "headsets predict");
    let deaf = &mut PoseIntake::new(WorkerId(3), PoseFrame::Map);
    assert_eq!(deaf.take(&pose(1), NOW), Err(PoseFault::NoClock));
}

#[test]
fn a_tag_in_the_frame_of_the_map_needs_neither_quaternion_nor_marks() {
    let mut intake = intake(PoseFrame::Map);
    let tag = PoseSaid { pos: None, quat: None, at: Some([4.0, 5.0]), ..pose(1) };
    let s = intake.take(&tag, NOW).unwrap().sighting;
    assert_eq!((s.at, s.heading), (Point::new(4.0, 5.0), None));
    assert!((s.accuracy_m - 0.03).abs() < 0.001, "{s:?}");
    let facing = PoseSaid { heading: Some(1.0), seq: 2, ..tag };
    assert_eq!(intake.take(&facing, NOW).unwrap().sighting.heading, Some(1.0));
}

#[test]
fn who_is_lost_need_not_make_a_place_up() {
    let mut intake = intake(PoseFrame::Map);
    let lost =
        |seq| PoseSaid { pos: None, quat: None, quality: QualitySaid::Lost, accuracy: None, ..pose(seq) };
    assert_eq!(intake.take(&lost(1), NOW), Err(PoseFault::NoPosition), "nobody has been anywhere yet");
    let before = intake.take(&pose(2), NOW).unwrap().sighting;
    let s = intake.take(&lost(3), NOW).unwrap().sighting;
    assert_eq!((s.at, s.heading, s.quality), (before.at, before.heading, Quality::Lost));
}

#[test]
fn where_the_head_points_is_turned_like_the_frame_and_has_its_pitch() {
    let mut intake = intake(PoseFrame::Device);
    let quarter = std::f64::consts::FRAC_PI_2;
    let mark = PointPair {
        device: Vector::zeros(),
        map: Point::new(10.0, 5.0),
        weight: 1.0,
        turn: Some(quarter),
        height_m: 0.0,
        heading: Some(quarter),
    };
    intake.align(&[mark], true).unwrap();
    let mut ahead = |seq, quat| {
        let said = PoseSaid { epoch: 2, quat, ..pose(seq) };
        intake.take(&said, NOW).unwrap().senses.ahead.map(nalgebra::Vector3::from)
    };
    // Half a right angle down.
    let half = std::f64::consts::FRAC_PI_8;
    let down = ahead(1, Some([-half.sin(), 0.0, 0.0, half.cos()])).expect("it is known");
    let expected = nalgebra::Vector3::new(-0.5f64.sqrt(), 0.0, -0.5f64.sqrt());
    assert!((down - expected).norm() < 1e-9, "the map's -x, and down: {down:?}");
    assert_eq!(ahead(2, None), None);
}

#[test]
fn a_hand_that_cannot_be_read_or_has_too_many_joints_is_left_out_alone() {
    let joint = [2.2, 1.2, -3.0, 0.01];
    let good = || Some(HandSaid::Joints(vec![joint; 25]));
    let bad = [
        HandSaid::Unreadable(serde::de::IgnoredAny),
        HandSaid::Joints(vec![joint; 33]),
        HandSaid::Joints(vec![[f64::NAN, 1.2, -3.0, 0.01]; 25]),
        HandSaid::Joints(vec![[2.2, 1.2, -3.0, -0.01]; 25]),
    ];
    for hand in bad {
        for hands in
            [HandsSaid { l: Some(hand.clone()), r: good() }, HandsSaid { l: good(), r: Some(hand.clone()) }]
        {
            let is_good = [hands.l == good(), hands.r == good()];
            let said = PoseSaid { hands: Some(hands), ..pose(1) };
            let taken = intake(PoseFrame::Map).take(&said, NOW).expect("the pose counts");
            assert_eq!((taken.fault, taken.senses.hands.map(|hand| hand.is_some())), (None, is_good));
        }
    }
}

#[test]
fn looking_at_the_floor_keeps_the_heading() {
    let mut intake = intake(PoseFrame::Map);
    let before = intake.take(&pose(1), NOW).unwrap().sighting.heading;
    let down = PoseSaid { quat: Some([-(0.5f64.sqrt()), 0.0, 0.0, 0.5f64.sqrt()]), ..pose(2) };
    assert_eq!(intake.take(&down, NOW).unwrap().sighting.heading, before);
    assert!(before.is_some());
}

#[test]
fn the_uncertainty_grows_with_the_way_and_not_with_sway() {
    let mut intake = intake(PoseFrame::Device);
    let marks = [(0.0, 0.0), (10.0, 0.0)];
    let pair = |(x, y): (f64, f64)| PointPair {
        device: Vector::new(x, y),
        map: Point::new(x, y),
        weight: 1.0,
        turn: None,
        height_m: 0.0,
        heading: None,
    };
    intake.align(&marks.map(pair), true).unwrap();
    let (mut seq, mut at) = (0, 0.0);
    let mut stand = |intake: &mut PoseIntake, x: f64| {
        seq += 1;
        let said = PoseSaid { epoch: 2, pos: Some([x, 1.6, 0.0]), ..pose(seq) };
        at = intake.take(&said, NOW).unwrap().sighting.accuracy_m;
        at
    };
    let first = stand(&mut intake, 5.0);
    for i in 0..1000 {
        stand(&mut intake, 5.0 + 0.05 * f64::from(i % 2));
    }
    assert_eq!(stand(&mut intake, 5.0), first, "swaying is no walking");
    for i in 0..100 {
        stand(&mut intake, 5.0 + f64::from(i % 2));
    }
    let walked = stand(&mut intake, 5.0);
    assert!(walked > 0.7 && walked < 0.8, "100 m at 0.75 %: {walked}");
}

#[test]
fn marks_are_named_or_measured() {
    let map =
        giveway_floor::warehouse::formats::json::parse(include_str!("../../../../maps/lab.json")).unwrap();
    let (id, node) = map.nodes.pairs().next().unwrap();
    let anchor = AnchorSaid {
        device: [1.0, 0.0, -2.0],
        quat: None,
        map: None,
        mark: Some(node.name.clone()),
        heading: None,
        weight: None,
    };
    let made = pairs(std::slice::from_ref(&anchor), &map).unwrap();
    assert_eq!((made[0].map, made[0].device), (map.nodes[id].at, Vector::new(1.0, 2.0)));
    let unknown = AnchorSaid { mark: Some("nowhere".into()), ..anchor.clone() };
    assert!(pairs(&[unknown], &map).unwrap_err().text().contains("nowhere"));
    let neither = AnchorSaid { mark: None, ..anchor };
    assert!(pairs(&[neither], &map).unwrap_err().text().contains("mark"));
}
