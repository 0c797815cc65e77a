//! Test: a headset whose client permutes or reverses its axes is refused, warned, or located correctly.
//!
//! All 48 signed permutations of axes, with two, three and four marks, on walks of five metres in three directions: the
//! messages of the wearer's device pass through the intake into a track, as in operation.

use super::align::{Alignment, Misfit, PointPair};
use super::clock::Exchange;
use super::pose::plan;
use crate::feed::intake::{PoseFault, PoseIntake};
use crate::feed::wire::{PoseFrame, PoseSaid, QualitySaid};
use giveway_floor::geometry::{Point, Vector, wrap_angle};
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use giveway_people::human::Track;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

const NOW: Time = Time(1_800_000_000_000_000);

/// Marks of a floor: the first two and the last two lie on lines along its axes.
const MARKS: [(f64, f64); 4] = [(0.0, 7.0), (12.0, 7.0), (12.0, 0.0), (0.0, 0.0)];

/// Where walks begin, and their directions in degrees: away from the line of the first two marks, along it, and
/// between.
const WALKS: [(f64, f64, f64); 4] =
    [(3.0, 8.0, 90.0), (3.0, 10.0, 0.0), (3.0, 8.0, 40.0), (6.0, 6.0, -100.0)];

/// The length of a walk, and the distance between poses, metres.
const WAY_M: f64 = 5.0;
const STEP_M: f64 = 0.05;

/// A client: how its axes map to WebXR's, and the yaw of its origin.
struct AxisClient {
    axes: Matrix3<f64>,
    yaw: f64,
    /// Whether the client sends rotations.
    turns: bool,
}

impl AxisClient {
    /// A point of the map and a height, in the axes of the client.
    fn point(&self, at: Point, height_m: f64) -> [f64; 3] {
        let turned = nalgebra::Rotation2::new(-self.yaw) * (at.coords - Vector::new(2.0, 1.0));
        (self.axes * Vector3::new(turned.x, height_m, -turned.y)).into()
    }

    /// A heading on the map as a rotation in the client's axes.
    fn rotation(&self, heading: f64) -> [f64; 4] {
        let yaw = heading - self.yaw - std::f64::consts::FRAC_PI_2;
        let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), yaw);
        let turn = Rotation3::from_matrix_unchecked(self.axes * turn.matrix() * self.axes.transpose());
        let q = UnitQuaternion::from_rotation_matrix(&turn);
        [q.i, q.j, q.k, q.w]
    }

    fn marks(&self, count: usize) -> Vec<PointPair> {
        let pair = |&(x, y): &(f64, f64)| {
            let device = self.point(Point::new(x, y), 0.0);
            let (map, weight) = (Point::new(x, y), 1.0);
            PointPair { device: plan(device), height_m: device[1], map, weight, turn: None, heading: None }
        };
        MARKS[..count].iter().map(pair).collect()
    }
}

/// The outcome of a walk.
#[derive(Debug, PartialEq)]
enum WalkOutcome {
    /// The marks were refused.
    Refused(Misfit),
    /// Poses were refused.
    PosesRefused(PoseFault),
    /// The wearer was warned, and robots avoided this many positions; `covered`: one of them was right throughout.
    Warned { places: usize, covered: bool },
    /// The position was right all the way, and so was the heading, if there was one.
    Right,
    /// Position or heading was wrong without a warning; the largest error, metres or radians.
    SilentlyWrong(f64),
}

fn walk(client: &AxisClient, count: usize, (x, y, degrees): (f64, f64, f64)) -> WalkOutcome {
    let mut intake = PoseIntake::new(WorkerId(0), PoseFrame::Device);
    intake.clock.take(Exchange { asked: NOW, got_ms: 0.0, answered_ms: 0.0, heard: NOW });
    let provisional = match intake.align(&client.marks(count), true).map(Alignment::is_provisional) {
        Err(misfit) => return WalkOutcome::Refused(misfit),
        Ok(provisional) => provisional,
    };
    let (mut track, heading) = (Track::default(), degrees.to_radians());
    let (mut warned, mut worst_m, mut covered, mut places) = (provisional, 0.0f64, true, 0);
    for i in 0..(WAY_M / STEP_M) as u32 {
        let truth = Point::new(x, y) + Vector::new(heading.cos(), heading.sin()) * (f64::from(i) * STEP_M);
        let now = NOW + Span::from_millis(50) * i64::from(i);
        let said = PoseSaid {
            epoch: intake.epoch(),
            seq: u64::from(i) + 1,
            t: 50.0 * f64::from(i),
            pos: Some(client.point(truth, 1.6)),
            quat: client.turns.then(|| client.rotation(heading)),
            at: None,
            heading: None,
            accuracy: None,
            quality: QualitySaid::Tracked,
            gaze: None,
            hands: None,
            battery: None,
        };
        let taken = match intake.take(&said, now) {
            Err(fault) => return WalkOutcome::PosesRefused(fault),
            Ok(taken) => taken,
        };
        warned |= taken.is_askew;
        track.see(&taken.sighting, now, |_| true);
        let place = track.whereabouts(now).expect("seen");
        let mut all = track.others(now);
        all.push(place);
        places = places.max(all.len());
        covered &= all.iter().any(|w| (w.at - truth).norm() < 0.3);
        let turned = taken.sighting.heading.map_or(0.0, |h| wrap_angle(h - heading).abs());
        worst_m = worst_m.max((place.at - truth).norm()).max(turned);
    }
    match worst_m < 0.3 {
        true if !warned => WalkOutcome::Right,
        _ if warned => WalkOutcome::Warned { places, covered },
        _ => WalkOutcome::SilentlyWrong(worst_m),
    }
}

/// All signed orders of three axes.
fn conventions() -> Vec<Matrix3<f64>> {
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let signs = |bits: usize| [0, 1, 2].map(|i| if bits >> i & 1 == 0 { 1.0 } else { -1.0 });
    let matrix = |order: [usize; 3], signs: [f64; 3]| {
        Matrix3::from_fn(|row, column| if order[row] == column { signs[row] } else { 0.0 })
    };
    orders.iter().flat_map(|order| (0..8).map(move |bits| matrix(*order, signs(bits)))).collect()
}

/// Every convention, number of marks and walk, from two yaws of the origin, with and without rotations.
fn all_walks() -> Vec<(AxisClient, usize, WalkOutcome)> {
    let mut walks = Vec::new();
    for axes in conventions() {
        for (yaw, turns, count) in setups() {
            for way in WALKS {
                let client = AxisClient { axes, yaw, turns };
                let outcome = walk(&client, count, way);
                walks.push((client, count, outcome));
            }
        }
    }
    walks
}

fn setups() -> impl Iterator<Item = (f64, bool, usize)> {
    let yaws = [0.0, 0.5].into_iter();
    yaws.flat_map(|yaw| [true, false].into_iter().flat_map(move |t| (2..=4).map(move |n| (yaw, t, n))))
}

#[test]
fn no_convention_of_axes_is_silently_wrong() {
    let walks = all_walks();
    assert_eq!(walks.len(), 48 * 12 * WALKS.len());
    for (client, count, outcome) in &walks {
        let silent = matches!(outcome, WalkOutcome::SilentlyWrong(_));
        assert!(!silent, "{outcome:?}: {} marks, axes {}, yaw {}", count, client.axes, client.yaw);
    }
    let refused =
        walks.iter().filter(|(.., o)| matches!(o, WalkOutcome::Refused(_) | WalkOutcome::PosesRefused(_)));
    let warned = walks.iter().filter(|(.., o)| matches!(o, WalkOutcome::Warned { .. })).count();
    let (refused, right) = (refused.count(), walks.iter().filter(|(.., o)| *o == WalkOutcome::Right).count());
    assert!(
        right > 0 && warned > 0 && refused > right,
        "{refused} refused, {warned} warned of, {right} right"
    );
}

#[test]
fn the_right_axes_are_right_and_with_two_marks_robots_keep_away_from_the_right_place_too() {
    for (client, count, outcome) in all_walks().iter().filter(|(c, ..)| c.axes == Matrix3::identity()) {
        match count {
            2 => assert_eq!(*outcome, WalkOutcome::Warned { places: 2, covered: true }, "yaw {}", client.yaw),
            _ => assert_eq!(*outcome, WalkOutcome::Right, "yaw {}", client.yaw),
        }
    }
}

#[test]
fn a_left_handed_frame_with_y_up_is_seen_on_both_sides_with_two_marks_and_refused_with_three() {
    let walks = all_walks();
    let mirrored = |c: &&AxisClient| c.axes.determinant() < 0.0 && c.axes[(1, 1)] == 1.0;
    for (_, count, outcome) in walks.iter().filter(|(c, ..)| mirrored(&c)) {
        match count {
            2 => assert_eq!(*outcome, WalkOutcome::Warned { places: 2, covered: true }),
            _ => assert_eq!(*outcome, WalkOutcome::Refused(Misfit::Mirrored)),
        }
    }
}

#[test]
fn eyes_fourteen_metres_up_are_refused_and_the_words_say_what_to_do() {
    let client = AxisClient { axes: Matrix3::identity(), yaw: 0.0, turns: false };
    let mut intake = PoseIntake::new(WorkerId(0), PoseFrame::Device);
    intake.clock.take(Exchange { asked: NOW, got_ms: 0.0, answered_ms: 0.0, heard: NOW });
    intake.align(&client.marks(3), true).unwrap();
    let said = |height_m: f64| PoseSaid {
        epoch: 2,
        seq: 1,
        t: 0.0,
        pos: Some(client.point(Point::new(3.0, 3.0), height_m)),
        quat: None,
        at: None,
        heading: None,
        accuracy: None,
        quality: QualitySaid::Tracked,
        gaze: None,
        hands: None,
        battery: None,
    };
    for height_m in [14.0, -1.6] {
        assert_eq!(intake.take(&said(height_m), NOW), Err(PoseFault::Height));
    }
    assert!(intake.take(&said(0.3), NOW).is_ok(), "somebody lies on the floor");
    assert!(PoseFault::Height.sentence().text().contains("touch the marks again"));
}
