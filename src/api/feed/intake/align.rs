//! Frame alignment: where a device's own frame lies on the map, from points that both know.
//!
//! Main types: [`Alignment`], [`PointPair`], [`Misfit`]. A rotation about the vertical and a shift, no scale: the
//! least-squares fit of Arun, Huang and Blostein 1987 ("Least-squares fitting of two 3-D point sets") in the plane,
//! where the singular value decomposition is one arc tangent. Marks that lie on one line also fit a mirrored frame, one
//! with an exchanged axis: such an alignment is provisional and knows the line about which the other position lies
//! ([`Alignment::mirrored`]). Pure. Refuses: pairs that no rigid movement brings together, marks of one floor at
//! different heights, and to guess which of two possible alignments is true.

use giveway_floor::geometry::{FARTHEST_M, Point, Vector, wrap_angle};
use giveway_floor::text::sentence::{feed, remedies};
use giveway_floor::text::{Sentence, SentenceArg};
use nalgebra::Rotation2;

/// One standard deviation of touching a mark, metres. Fits that look better than this are not believed.
const TOUCH_M: f64 = 0.03;

/// The share by which lengths in device and map may differ.
const SCALE_TOLERANCE: f64 = 0.03;

/// A fit whose marks are further off than this, root of the mean square, is refused; metres.
pub const RMS_MAX_M: f64 = 0.15;

/// The least distance between marks, metres.
pub const BASELINE_MIN_M: f64 = 1.0;

/// All marks lie on one floor: their heights may differ by this, metres. Devices drift, and rings are laid by hand.
const FLOOR_M: f64 = 0.25;

/// How far a mark's direction may differ from the direction that the marks' positions give, radians: 20 degrees.
const DIRECTION_MAX: f64 = 0.35;

/// A mirrored frame is ruled out if the marks' error in it exceeds this, metres: twice the error allowed for the right
/// frame.
const MIRRORED_MIN_M: f64 = 2.0 * RMS_MAX_M;

/// The error of a single mark's direction, radians: two degrees.
const YAW_ERROR: f64 = 0.035;

/// How far devices drift, as a share of the distance walked since the marks were seen. Headsets with inside-out
/// tracking usually stay within 0.5 to 1 %.
const DRIFT: f64 = 0.0075;

/// The most pairs that are accepted.
pub const MOST_PAIRS: usize = 32;

/// A point of the floor that device and map both know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointPair {
    /// Position in the device's floor plan, metres.
    pub device: Vector,
    /// Height in the device's frame, metres.
    pub height_m: f64,
    /// Position on the map, metres.
    pub map: Point,
    /// Weight of the pair in the fit; 1 is usual.
    pub weight: f64,
    /// How far the device's frame is turned according to this mark alone: the mark's direction on the map minus its
    /// direction in the device's frame, radians.
    pub turn: Option<f64>,
    /// The mark's direction on the map, radians, if both sides know it.
    pub heading: Option<f64>,
}

/// Where a device's frame lies on the map: `p = R(theta) a + shift`.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// How far the device's frame is turned, radians.
    pub theta: f64,
    /// The position of the frame's origin on the map.
    pub shift: Vector,
    /// Root mean square of the marks' errors, metres.
    pub rms_m: f64,
    /// One standard deviation of `theta`, radians: √2 σ / baseline for two marks.
    pub heading_error: f64,
    /// Pairs that were left out, by position in the list.
    pub dropped: Vec<usize>,
    /// Height of the floor in the device's frame, metres.
    pub floor_m: f64,
    /// The direction on the map, radians, of the line on which all marks lie; nothing if the marks rule out that the
    /// device's frame is mirrored.
    line: Option<f64>,
    /// The centre of the marks, and one standard deviation of it, metres.
    centre: Point,
    centre_sigma_m: f64,
}

/// Why pairs give no alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Misfit {
    /// There are too few marks.
    TooFew,
    /// There are more marks than a person would touch.
    TooMany(usize),
    /// A mark has impossible numbers; its index counts from 0.
    Absurd(usize),
    /// The marks are too close together to give a direction; their distance.
    TooClose(f64),
    /// The distances between marks differ between device and map; the ratio.
    Scale(f64),
    /// The floor is not level in the device's frame.
    Heights {
        /// The lowest mark, metres.
        low_m: f64,
        /// The highest mark, metres.
        high_m: f64,
        /// The mark that is off the most, counted from 0.
        worst: usize,
    },
    /// The marks fit only a mirrored frame.
    Mirrored,
    /// A mark points in another direction than the marks' positions imply.
    Direction {
        /// The mark, counted from 0.
        mark: usize,
        /// How far its direction is off, degrees.
        degrees: f64,
    },
    /// The marks do not lie as they do on the map.
    Residual {
        /// Root mean square of the marks' errors, metres.
        rms_m: f64,
        /// The mark that is off the most, counted from 0.
        worst: usize,
    },
    /// One of three marks is wrong, and it is unclear which.
    Ambiguous,
}

impl Misfit {
    /// The misfit in words.
    pub fn sentence(self) -> Sentence {
        let decimal = SentenceArg::rounded;
        match self {
            Misfit::TooFew => feed::too_few_marks(),
            Misfit::TooMany(marks) => feed::too_many_marks(marks),
            Misfit::Absurd(mark) => feed::mark_absurd(mark),
            Misfit::TooClose(m) => feed::marks_too_close(decimal(m, 2)),
            Misfit::Scale(times) => feed::marks_scaled(decimal(times, 3)),
            Misfit::Heights { low_m, high_m, worst } => {
                feed::marks_at_heights(decimal(low_m, 2), decimal(high_m, 2), worst)
            }
            Misfit::Mirrored => feed::marks_mirrored(),
            Misfit::Direction { mark, degrees } => feed::mark_turned(mark, decimal(degrees, 0)),
            Misfit::Residual { rms_m, worst } => feed::marks_off(decimal(rms_m, 2), worst),
            Misfit::Ambiguous => feed::marks_ambiguous(),
        }
    }

    /// What the wearer of the device can do.
    pub fn remedy(self) -> Sentence {
        match self {
            Misfit::TooFew => remedies::do_touch_two_marks(),
            Misfit::TooMany(_) => remedies::do_send_nearest_marks(),
            Misfit::Absurd(_) => remedies::do_touch_mark_again(),
            Misfit::TooClose(_) => remedies::do_touch_marks_apart(),
            Misfit::Scale(_) => remedies::do_check_names_and_metres(),
            Misfit::Heights { .. } => remedies::do_touch_again_or_check_axes(),
            Misfit::Mirrored => remedies::do_send_webxr_axes(),
            Misfit::Direction { .. } => remedies::do_send_rotation(),
            Misfit::Residual { .. } => remedies::do_check_name_of_mark(),
            Misfit::Ambiguous => remedies::do_touch_fourth_mark(),
        }
    }
}

/// A fit of some of the pairs, good or not.
struct Fit {
    theta: f64,
    shift: Vector,
    centre: Point,
    rms_m: f64,
    sigma_m: f64,
    /// Root of the sum of squared distances from the centre, metres.
    spread_m: f64,
    scale: f64,
    worst: usize,
}

impl Alignment {
    /// The alignment of a device that knows the map's frame itself.
    pub fn identity() -> Alignment {
        Alignment::exact(0.0, Vector::zeros())
    }

    /// The alignment of a frame whose position on the map is set by hand.
    pub fn exact(theta: f64, shift: Vector) -> Alignment {
        Alignment {
            theta,
            shift,
            rms_m: 0.0,
            heading_error: 0.0,
            dropped: Vec::new(),
            floor_m: 0.0,
            line: None,
            centre: Point::origin(),
            centre_sigma_m: 0.0,
        }
    }

    /// The rigid movement that fits device and map best. With three pairs or more, up to a third of them, the worst,
    /// are left out if necessary.
    ///
    /// # Errors
    /// If no such movement is good enough, or the marks contradict it in another way.
    pub fn fit(pairs: &[PointPair]) -> Result<Alignment, Misfit> {
        check(pairs)?;
        let floor_m = floor(pairs)?;
        let alignment = match pairs {
            [only] => single(only)?,
            _ => Alignment::of_places(pairs)?,
        };
        alignment.check_directions(pairs)?;
        Ok(Alignment { floor_m, ..alignment })
    }

    /// The alignment that the positions of several marks give.
    fn of_places(pairs: &[PointPair]) -> Result<Alignment, Misfit> {
        let mut kept: Vec<usize> = (0..pairs.len()).collect();
        let misfit = match fit_if_good(pairs, &kept) {
            Ok(fit) => return Ok(fit),
            Err(_) if fit_if_good(&mirrored(pairs), &kept).is_ok() => return Err(Misfit::Mirrored),
            Err(misfit) => misfit,
        };
        for _ in 0..pairs.len() / 3 {
            let fewer: Vec<Vec<usize>> = kept.iter().map(|gone| without(&kept, *gone)).collect();
            if kept.len() == 3 {
                return one_of_three(pairs, &fewer, misfit);
            }
            let off = |some: &Vec<usize>| solve(pairs, some).rms_m;
            kept = fewer.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("there are pairs");
            if let Ok(fit) = fit_if_good(pairs, &kept) {
                return Ok(fit);
            }
        }
        Err(misfit)
    }

    /// The map position of a point in the device's floor plan.
    pub fn point(&self, a: Vector) -> Point {
        Point::from(Rotation2::new(self.theta) * a + self.shift)
    }

    /// The map direction of a direction in the device's floor plan.
    pub fn heading(&self, phi: f64) -> f64 {
        wrap_angle(phi + self.theta)
    }

    /// Whether the marks leave open that the device's frame is mirrored.
    pub fn is_provisional(&self) -> bool {
        self.line.is_some()
    }

    /// Where a map position would be if the device's frame were mirrored: on the other side of the line of the marks.
    /// Nothing if the marks rule that out.
    pub fn mirrored(&self, at: Point) -> Option<Point> {
        let along = self.line.map(|angle| Vector::new(angle.cos(), angle.sin()))?;
        let from = at - self.centre;
        Some(self.centre + along * (2.0 * along.dot(&from)) - from)
    }

    /// Checks that the marks' directions agree with their positions.
    fn check_directions(&self, pairs: &[PointPair]) -> Result<(), Misfit> {
        for (mark, pair) in pairs.iter().enumerate().filter(|(i, _)| !self.dropped.contains(i)) {
            let off = pair.turn.map_or(0.0, |turn| wrap_angle(turn - self.theta).abs());
            if off > DIRECTION_MAX {
                return Err(Misfit::Direction { mark, degrees: off.to_degrees() });
            }
        }
        Ok(())
    }

    /// The alignment's share of the uncertainty of a map position, one standard deviation, metres: from the marks, the
    /// error of the turn times the distance from them, and drift over the distance walked since.
    pub fn sigma_m(&self, at: Point, walked_m: f64) -> f64 {
        let turned = self.heading_error * (at - self.centre).norm();
        let drifted = if self.heading_error == 0.0 { 0.0 } else { DRIFT * walked_m };
        (self.centre_sigma_m.powi(2) + turned.powi(2) + drifted.powi(2)).sqrt()
    }
}

fn check(pairs: &[PointPair]) -> Result<(), Misfit> {
    let sound = |p: &PointPair| {
        let numbers = [p.device.x, p.device.y, p.height_m, p.map.x, p.map.y, p.turn.unwrap_or(0.0)];
        numbers.iter().all(|n| n.abs() <= FARTHEST_M) && p.weight > 0.0 && p.weight <= 1000.0
    };
    match pairs {
        [] => Err(Misfit::TooFew),
        _ if pairs.len() > MOST_PAIRS => Err(Misfit::TooMany(pairs.len())),
        _ => pairs.iter().position(|p| !sound(p)).map_or(Ok(()), |i| Err(Misfit::Absurd(i))),
    }
}

/// The height of the floor on which all marks lie: the median of their heights.
fn floor(pairs: &[PointPair]) -> Result<f64, Misfit> {
    let mut heights: Vec<f64> = pairs.iter().map(|p| p.height_m).collect();
    heights.sort_by(f64::total_cmp);
    let (low_m, high_m, middle) = (heights[0], heights[heights.len() - 1], heights[heights.len() / 2]);
    if high_m - low_m <= FLOOR_M {
        return Ok(middle);
    }
    let off = |p: &PointPair| (p.height_m - middle).abs();
    let worst = pairs.iter().enumerate().max_by(|(_, a), (_, b)| off(a).total_cmp(&off(b)));
    Err(Misfit::Heights { low_m, high_m, worst: worst.map_or(0, |(i, _)| i) })
}

/// The same marks in a mirrored frame.
fn mirrored(pairs: &[PointPair]) -> Vec<PointPair> {
    let flip = |p: &PointPair| PointPair { device: Vector::new(p.device.x, -p.device.y), ..*p };
    pairs.iter().map(flip).collect()
}

/// The map direction of the line of the marks, if a mirrored frame fits them, too. The movements of the two frames
/// differ by a reflection about this line.
fn line(pairs: &[PointPair], some: &[usize], theta: f64) -> Option<f64> {
    let other = solve(&mirrored(pairs), some);
    (other.rms_m <= MIRRORED_MIN_M).then(|| wrap_angle(theta + other.theta) / 2.0)
}

fn single(pair: &PointPair) -> Result<Alignment, Misfit> {
    let theta = wrap_angle(pair.turn.ok_or(Misfit::TooFew)?);
    Ok(Alignment {
        theta,
        shift: pair.map.coords - Rotation2::new(theta) * pair.device,
        rms_m: 0.0,
        heading_error: YAW_ERROR,
        dropped: Vec::new(),
        floor_m: pair.height_m,
        line: pair.heading,
        centre: pair.map,
        centre_sigma_m: TOUCH_M,
    })
}

fn without(kept: &[usize], gone: usize) -> Vec<usize> {
    kept.iter().copied().filter(|i| *i != gone).collect()
}

/// Any two marks with the right distance fit perfectly. So one of three is left out only if the other choices give no
/// fit, or the same one.
fn one_of_three(pairs: &[PointPair], fewer: &[Vec<usize>], misfit: Misfit) -> Result<Alignment, Misfit> {
    let mut stories = fewer.iter().filter_map(|some| fit_if_good(pairs, some).ok());
    let Some(first) = stories.next() else { return Err(misfit) };
    let same = |other: &Alignment| {
        pairs.iter().all(|p| (first.point(p.device) - other.point(p.device)).norm() < RMS_MAX_M)
    };
    if stories.all(|other| same(&other)) { Ok(first) } else { Err(Misfit::Ambiguous) }
}

/// The fit of some pairs, if it is good enough.
fn fit_if_good(pairs: &[PointPair], some: &[usize]) -> Result<Alignment, Misfit> {
    let distance = |i: usize, j: usize| (pairs[i].device - pairs[j].device).norm();
    let all = some.iter().flat_map(|i| some.iter().map(move |j| distance(*i, *j)));
    let baseline_m = all.fold(0.0, f64::max);
    if baseline_m < BASELINE_MIN_M {
        return Err(Misfit::TooClose(baseline_m));
    }
    let fit = solve(pairs, some);
    if fit.rms_m > RMS_MAX_M {
        return Err(Misfit::Residual { rms_m: fit.rms_m, worst: fit.worst });
    }
    if (fit.scale - 1.0).abs() > SCALE_TOLERANCE {
        return Err(Misfit::Scale(fit.scale));
    }
    Ok(Alignment {
        theta: fit.theta,
        shift: fit.shift,
        rms_m: fit.rms_m,
        heading_error: fit.sigma_m / fit.spread_m,
        dropped: (0..pairs.len()).filter(|i| !some.contains(i)).collect(),
        floor_m: 0.0,
        line: line(pairs, some, fit.theta),
        centre: fit.centre,
        centre_sigma_m: fit.sigma_m / (some.len() as f64).sqrt(),
    })
}

fn solve(pairs: &[PointPair], some: &[usize]) -> Fit {
    let chosen = || some.iter().map(|i| (*i, &pairs[*i]));
    let total: f64 = chosen().map(|(_, p)| p.weight).sum();
    let mean = |of: &dyn Fn(&PointPair) -> Vector| -> Vector {
        chosen().map(|(_, p)| of(p) * p.weight).sum::<Vector>() / total
    };
    let (a_mean, b_mean) = (mean(&|p| p.device), mean(&|p| p.map.coords));
    let (mut sine, mut cosine, mut a_square, mut b_square) = (0.0, 0.0, 0.0, 0.0);
    for (_, p) in chosen() {
        let (a, b) = (p.device - a_mean, p.map.coords - b_mean);
        sine += p.weight * a.perp(&b);
        cosine += p.weight * a.dot(&b);
        a_square += p.weight * a.norm_squared();
        b_square += p.weight * b.norm_squared();
    }
    let theta = sine.atan2(cosine);
    let turn = Rotation2::new(theta);
    let shift = b_mean - turn * a_mean;
    let off = |p: &PointPair| (turn * p.device + shift - p.map.coords).norm_squared();
    let mean_square = chosen().map(|(_, p)| p.weight * off(p)).sum::<f64>() / total;
    let n = some.len() as f64;
    let worst = chosen().max_by(|(_, p), (_, q)| off(p).total_cmp(&off(q))).map_or(0, |(i, _)| i);
    Fit {
        theta,
        shift,
        centre: Point::from(b_mean),
        rms_m: mean_square.sqrt(),
        // Each mark gives two numbers; the fit uses up three.
        sigma_m: (mean_square * n / (2.0 * n - 3.0)).sqrt().max(TOUCH_M),
        spread_m: (a_square * n / total).sqrt(),
        scale: (a_square / b_square).sqrt(),
        worst,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Marks as a device with a turned and shifted frame sees them.
    fn seen(theta: f64, shift: Vector, marks: &[(f64, f64)]) -> Vec<PointPair> {
        let back = Rotation2::new(-theta);
        let pair = |m: &(f64, f64)| {
            let map = Point::new(m.0, m.1);
            let device = back * (map.coords - shift);
            PointPair { device, height_m: 0.0, map, weight: 1.0, turn: None, heading: None }
        };
        marks.iter().map(pair).collect()
    }

    const HALL: [(f64, f64); 4] = [(1.0, 1.0), (19.0, 2.0), (18.0, 14.0), (2.0, 15.0)];

    proptest! {
        #[test]
        fn any_rigid_movement_is_found_again(
            theta in -3.1f64..3.1, x in -500.0f64..500.0, y in -500.0f64..500.0,
            marks in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 2..8),
        ) {
            let pairs = seen(theta, Vector::new(x, y), &marks);
            let fit = Alignment::fit(&pairs);
            let apart = marks.iter().any(|m| (m.0 - marks[0].0).hypot(m.1 - marks[0].1) > 1.1);
            prop_assume!(apart);
            let fit = fit.unwrap();
            prop_assert!(wrap_angle(fit.theta - theta).abs() < 1e-6);
            prop_assert!((fit.shift - Vector::new(x, y)).norm() < 1e-3 && fit.dropped.is_empty());
            for p in &pairs {
                prop_assert!((fit.point(p.device) - p.map).norm() < 1e-6);
            }
        }

        #[test]
        fn noise_of_a_hand_stays_within_the_stated_error(
            theta in -3.1f64..3.1, noise in prop::collection::vec((-0.04f64..0.04, -0.04f64..0.04), 4),
        ) {
            let mut pairs = seen(theta, Vector::new(3.0, -7.0), &HALL);
            for (p, n) in pairs.iter_mut().zip(&noise) {
                p.device += Vector::new(n.0, n.1);
            }
            let fit = Alignment::fit(&pairs).unwrap();
            prop_assert!(wrap_angle(fit.theta - theta).abs() < 3.0 * fit.heading_error);
            let far = Point::new(60.0, 40.0);
            let device = Rotation2::new(-theta) * (far.coords - Vector::new(3.0, -7.0));
            prop_assert!((fit.point(device) - far).norm() < 3.0 * fit.sigma_m(far, 0.0));
        }

        #[test]
        fn one_wrong_mark_of_four_is_left_out(
            theta in -3.1f64..3.1, which in 0usize..4, x in 1.0f64..9.0, y in -9.0f64..9.0,
        ) {
            let mut pairs = seen(theta, Vector::new(3.0, -7.0), &HALL);
            pairs[which].map += Vector::new(x, y);
            let fit = Alignment::fit(&pairs).unwrap();
            prop_assert_eq!(&fit.dropped, &vec![which]);
            prop_assert!(wrap_angle(fit.theta - theta).abs() < 1e-6);
        }
    }

    #[test]
    fn two_marks_say_how_well_the_direction_is_known() {
        let near = Alignment::fit(&seen(0.3, Vector::zeros(), &[(0.0, 0.0), (2.0, 0.0)])).unwrap();
        let far = Alignment::fit(&seen(0.3, Vector::zeros(), &[(0.0, 0.0), (20.0, 0.0)])).unwrap();
        let expected = std::f64::consts::SQRT_2 * TOUCH_M / 2.0;
        assert!((near.heading_error - expected).abs() < 1e-9, "1.2 degrees");
        assert!((far.heading_error - expected / 10.0).abs() < 1e-9);
        let there = Point::new(21.0, 0.0);
        assert!(near.sigma_m(there, 0.0) > 0.4 && near.sigma_m(there, 0.0) < 0.45);
        assert!(near.sigma_m(there, 100.0) > 0.75, "it grows with the way walked");
        assert_eq!(Alignment::identity().sigma_m(there, 100.0), 0.0);
    }

    #[test]
    fn one_mark_with_its_direction_is_enough_and_one_without_is_not() {
        let mut pairs = seen(1.0, Vector::new(5.0, 6.0), &[(2.0, 3.0)]);
        assert_eq!(Alignment::fit(&pairs), Err(Misfit::TooFew));
        (pairs[0].turn, pairs[0].heading) = (Some(1.0), Some(0.5));
        let fit = Alignment::fit(&pairs).unwrap();
        assert!((fit.shift - Vector::new(5.0, 6.0)).norm() < 1e-9);
        assert!((fit.heading(0.5) - 1.5).abs() < 1e-9);
    }

    #[test]
    fn a_wrong_one_of_three_is_left_out_only_where_it_is_certain_which() {
        let marks = [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)];
        let mut pairs = seen(0.4, Vector::new(1.0, 2.0), &marks);
        pairs[2].map += Vector::new(1.0, 3.0);
        let fit = Alignment::fit(&pairs).unwrap();
        assert_eq!(fit.dropped, [2]);
        // If turned about the first mark, the third fits together with the first, with another turn.
        let mut pairs = seen(0.4, Vector::new(1.0, 2.0), &marks);
        pairs[2].map = Point::new(10.0 * 0.3f64.sin(), 10.0 * 0.3f64.cos());
        assert_eq!(Alignment::fit(&pairs), Err(Misfit::Ambiguous));
    }

    #[test]
    fn what_is_no_rigid_movement_is_refused_with_the_reason() {
        let mut feet = seen(0.0, Vector::zeros(), &HALL[..2]);
        feet.iter_mut().for_each(|p| p.device *= 1.04);
        assert!(matches!(Alignment::fit(&feet), Err(Misfit::Residual { .. } | Misfit::Scale(_))));
        let mut short = seen(0.0, Vector::zeros(), &[(0.0, 0.0), (2.0, 0.0)]);
        short[1].device *= 1.05;
        assert!(matches!(Alignment::fit(&short), Err(Misfit::Scale(s)) if (s - 1.05).abs() < 1e-9));
        let swapped = |mut pairs: Vec<PointPair>| {
            (pairs[0].map, pairs[1].map) = (pairs[1].map, pairs[0].map);
            Alignment::fit(&pairs)
        };
        assert!(matches!(swapped(seen(0.0, Vector::zeros(), &HALL)), Err(Misfit::Residual { .. })));
        let close = seen(0.0, Vector::zeros(), &[(0.0, 0.0), (0.5, 0.0)]);
        assert_eq!(Alignment::fit(&close), Err(Misfit::TooClose(0.5)));
        assert_eq!(Alignment::fit(&[]), Err(Misfit::TooFew));
        assert_eq!(Alignment::fit(&seen(0.0, Vector::zeros(), &[(0.0, 9.0); 33])), Err(Misfit::TooMany(33)));
        let grid = HALL.map(|(x, y)| (x + 10_330.6, y - 41_831.2));
        let fit = Alignment::fit(&seen(0.3, Vector::new(10_000.0, -41_000.0), &grid)).unwrap();
        assert!(
            (fit.theta - 0.3).abs() < 1e-6 && fit.dropped.is_empty(),
            "marks may be wherever a map may be"
        );
        let mut absurd = seen(0.0, Vector::zeros(), &HALL);
        absurd[3].device.x = f64::NAN;
        assert_eq!(Alignment::fit(&absurd), Err(Misfit::Absurd(3)));
    }

    #[test]
    fn marks_on_one_line_leave_open_on_which_side_of_it_a_place_lies_and_a_third_beside_it_does_not() {
        let two = Alignment::fit(&seen(0.4, Vector::new(1.0, 2.0), &[(0.0, 7.0), (12.0, 7.0)])).unwrap();
        assert!(two.is_provisional());
        let other = two.mirrored(Point::new(6.0, 12.0)).unwrap();
        assert!((other - Point::new(6.0, 2.0)).norm() < 1e-9, "{other:?}");
        let on_it = two.mirrored(Point::new(3.0, 7.0)).unwrap();
        assert!((on_it - Point::new(3.0, 7.0)).norm() < 1e-9, "on the line both are one place");
        for (aside_m, provisional) in [(0.2, true), (1.0, false), (5.0, false)] {
            let marks = [(0.0, 7.0), (12.0, 7.0), (6.0, 7.0 + aside_m)];
            let three = Alignment::fit(&seen(0.4, Vector::new(1.0, 2.0), &marks)).unwrap();
            assert_eq!(three.is_provisional(), provisional, "{aside_m} m");
        }
        let single =
            PointPair { turn: Some(0.0), heading: Some(0.0), ..seen(0.0, Vector::zeros(), &[(1.0, 1.0)])[0] };
        let other = Alignment::fit(&[single]).unwrap().mirrored(Point::new(3.0, 2.0)).unwrap();
        assert!((other - Point::new(3.0, 0.0)).norm() < 1e-9, "about the direction of the mark: {other:?}");
    }

    #[test]
    fn marks_that_fit_only_as_in_a_mirror_and_heights_and_directions_that_contradict_are_refused() {
        let mirror = mirrored(&seen(0.4, Vector::new(1.0, 2.0), &HALL));
        assert_eq!(Alignment::fit(&mirror), Err(Misfit::Mirrored));
        assert_eq!(Alignment::fit(&mirror[..3]), Err(Misfit::Mirrored));
        let mut stairs = seen(0.4, Vector::new(1.0, 2.0), &HALL[..3]);
        for (pair, height_m) in stairs.iter_mut().zip([0.0, 3.5, -2.0]) {
            pair.height_m = height_m;
        }
        let heights = Misfit::Heights { low_m: -2.0, high_m: 3.5, worst: 1 };
        assert_eq!(Alignment::fit(&stairs), Err(heights));
        assert!(heights.sentence().text().contains("from -2.00 to 3.50 m"));
        assert!(heights.remedy().text().contains("y up"));
        let mut level = seen(0.4, Vector::new(1.0, 2.0), &HALL);
        level.iter_mut().for_each(|p| p.height_m = -1.6);
        assert_eq!(Alignment::fit(&level).unwrap().floor_m, -1.6, "wherever the device has its origin");
        level[2].turn = Some(0.4 + 0.2);
        assert!(Alignment::fit(&level).is_ok(), "a direction is shown by hand");
        level[2].turn = Some(0.4 + std::f64::consts::FRAC_PI_2);
        assert!(matches!(Alignment::fit(&level), Err(Misfit::Direction { mark: 2, .. })));
    }

    #[test]
    fn heavier_marks_pull_more() {
        let mut pairs = seen(0.0, Vector::zeros(), &[(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)]);
        pairs[0].map.x += 0.1;
        let off = |pairs: &[PointPair]| {
            let fit = Alignment::fit(pairs).unwrap();
            (fit.point(pairs[0].device) - pairs[0].map).norm()
        };
        let even = off(&pairs);
        pairs[0].weight = 10.0;
        assert!(off(&pairs) < even / 2.0);
    }
}
