//! How a hand moves from place to place.
//!
//! Main type: [`HandPath`]. The path is a curve that leaves and enters slots straight; along it the hand moves by a
//! minimum jerk (Flash and Hogan 1985) warped so that its speed peaks at 37 % of the time, as recorded hands do. The
//! duration follows Fitts (1954). Refuses: straight and symmetric movements.

use super::motion::minimum_jerk;
use crate::random::Stream;
use giveway_cell::FacePlace;
use giveway_floor::time::{Span, Time};

/// Time is warped by this power: with u = t^0.775 the speed of a minimum jerk in u is greatest at t = 0.37.
const WARP: f64 = 0.775;
/// Movement time in seconds is `BASE_S + BIT_S · log2(2 D / W)` for a distance D and a target of width W, metres.
const BASE_S: f64 = 0.3;
const BIT_S: f64 = 0.145;
const WIDTH_M: f64 = 0.1;
/// Standard deviation of the logarithm of the duration.
const TIME_SPREAD: f64 = 0.14;
/// Share of movements with a short second one that corrects the end, and its share of the duration.
const MENDED: f64 = 0.3;
const MEND_SHARE: f64 = 0.22;
/// Largest error of a first movement that is corrected, either way, as a share of the distance.
const MISS: f64 = 0.06;
/// Sideways bend of a path in the mean square, as a share of its length.
const BEND: f64 = 0.09;
/// Number of steps in which a place on a path is searched.
const PARTS: i64 = 64;

/// One movement of a hand.
#[derive(Clone, Debug)]
pub struct HandPath {
    from: FacePlace,
    /// Control points of the curve, a cubic Bézier curve.
    via: [FacePlace; 2],
    to: FacePlace,
    start: Time,
    end: Time,
    /// How far the first of two movements goes, as a share of the whole; nothing if there is no correction.
    first: Option<f64>,
}

impl HandPath {
    /// A movement that begins at `start`. `leave` and `enter` are the points that it passes on its way out of one slot
    /// and into another, if any. `pace` stretches its duration.
    pub fn new(
        [from, to]: [FacePlace; 2],
        [leave, enter]: [Option<FacePlace>; 2],
        start: Time,
        pace: f64,
        random: &mut Stream,
    ) -> HandPath {
        let way = to - from;
        let length_m = way.norm();
        let mut bend = FacePlace::new(random.normal(), random.normal(), random.normal()) * (BEND * length_m);
        bend.z = bend.z.abs() + 0.03 * length_m;
        let via = [leave.unwrap_or(from + way * 0.3 + bend), enter.unwrap_or(from + way * 0.7 + bend)];
        let bits = (2.0 * length_m / WIDTH_M).log2().max(0.0);
        let seconds = (BASE_S + BIT_S * bits) * pace * (TIME_SPREAD * random.normal()).exp();
        let first = random.happens_of(MENDED).then(|| 1.0 + MISS * (random.unit() * 2.0 - 1.0));
        HandPath { from, via, to, start, end: start + Span::from_secs_f64(seconds), first }
    }

    /// A hand that stays where it is.
    pub fn rest(at: FacePlace, now: Time) -> HandPath {
        HandPath { from: at, via: [at; 2], to: at, start: now, end: now, first: None }
    }

    /// Delays the rest of the movement by `by`.
    pub fn delay(&mut self, by: Span) {
        (self.start, self.end) = (self.start + by, self.end + by);
    }

    /// When the movement ends.
    pub fn end(&self) -> Time {
        self.end
    }

    /// Where the movement ends.
    pub fn to(&self) -> FacePlace {
        self.to
    }

    /// Position of the hand at a time.
    pub fn at(&self, now: Time) -> FacePlace {
        if now >= self.end {
            return self.to;
        }
        let t = (now - self.start).as_secs_f64() / (self.end - self.start).as_secs_f64();
        let s = self.progress(t.clamp(0.0, 1.0));
        let (r, [a, b]) = (1.0 - s, self.via);
        self.from * (r * r * r) + a * (3.0 * r * r * s) + b * (3.0 * r * s * s) + self.to * (s * s * s)
    }

    /// When the hand first meets a condition, on its way or at its end.
    pub fn first(&self, is_there: impl Fn(FacePlace) -> bool) -> Option<Time> {
        let part = |i: i64| self.start + Span((self.end - self.start).0 * i / PARTS);
        let found = (0..=PARTS).find(|i| is_there(self.at(part(*i))))?;
        let (mut before, mut there) = (part((found - 1).max(0)), part(found));
        while there - before > Span(1) {
            let middle = before + Span((there - before).0 / 2);
            *(if is_there(self.at(middle)) { &mut there } else { &mut before }) = middle;
        }
        Some(if is_there(self.at(before)) { before } else { there })
    }

    fn progress(&self, t: f64) -> f64 {
        match self.first {
            None => jerk(t),
            Some(first) => {
                let begins = 1.0 - MEND_SHARE * 1.5;
                let one = jerk((t / (1.0 - MEND_SHARE)).min(1.0));
                let other = jerk(((t - begins) / (1.0 - begins)).clamp(0.0, 1.0));
                first * one + (1.0 - first) * other
            }
        }
    }
}

/// The share of the path covered after a share of the time.
fn jerk(t: f64) -> f64 {
    minimum_jerk(t.powf(WARP))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles at 5, 50 and 95 %.
    fn quantiles(mut all: Vec<f64>) -> [f64; 3] {
        all.sort_by(f64::total_cmp);
        [0.05, 0.5, 0.95].map(|q| all[(q * (all.len() - 1) as f64) as usize])
    }

    /// Asserts that quantiles match those of recorded people within a tolerance.
    fn assert_like(what: &str, found: [f64; 3], recorded: [f64; 3], tolerance: f64) {
        for (f, r) in found.iter().zip(recorded) {
            assert!((f - r).abs() <= tolerance, "{what}: {found:?}, recorded {recorded:?}");
        }
    }

    #[test]
    fn movements_have_the_times_peaks_and_bends_of_recorded_people() {
        let mut random = Stream::new(1, 77, 0);
        let (mut times, mut peaks, mut peak_at, mut ratios) = (vec![], vec![], vec![], vec![]);
        for _ in 0..2000 {
            // Eight people: distances of 0.52 to 1.04 m, 0.80 m in the median.
            let distance = (0.8 + 0.16 * random.normal()).clamp(0.4, 1.2);
            let pace = (0.1 * random.normal()).exp();
            let [from, to] = [FacePlace::zeros(), FacePlace::new(0.0, -distance, 0.0)];
            let path = HandPath::new([from, to], [None; 2], Time::ZERO, pace, &mut random);
            let seconds = path.end().0 as f64 / 1e6;
            let n = 200;
            let at = |i: usize| path.at(Time((seconds * 1e6 * i as f64 / n as f64) as i64));
            let steps: Vec<f64> = (0..n).map(|i| (at(i + 1) - at(i)).norm()).collect();
            let (fastest, most) =
                steps.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).expect("there are steps");
            times.push(seconds);
            peaks.push(most * n as f64 / seconds);
            peak_at.push((fastest as f64 + 0.5) / n as f64);
            ratios.push(steps.iter().sum::<f64>() / distance);
        }
        assert_like("seconds", quantiles(times), [0.68, 0.88, 1.24], 0.12);
        // Simulated peaks are a little slower.
        assert_like("peak, m/s", quantiles(peaks), [1.3, 2.1, 3.0], 0.5);
        let found = quantiles(peak_at);
        assert!((found[1] - 0.37).abs() < 0.05 && found[0] > 0.2 && found[2] < 0.55, "peak at {found:?}");
        let found = quantiles(ratios);
        assert!((1.0..1.2).contains(&found[1]) && found[2] < 1.4, "way to straight line {found:?}");
    }

    #[test]
    fn a_hand_begins_and_ends_where_it_is_to_and_stands_there() {
        let mut random = Stream::new(2, 77, 0);
        for _ in 0..100 {
            let [from, to] = [FacePlace::new(0.7, 0.9, 0.8), FacePlace::new(0.1, 0.3, 1.4)];
            let path = HandPath::new([from, to], [None; 2], Time(5), 1.0, &mut random);
            assert!((path.at(Time(0)) - from).norm() < 1e-9 && (path.at(Time::MAX) - to).norm() < 1e-9);
            assert!((path.at(path.end() - Span(1)) - to).norm() < 1e-3);
        }
    }

    #[test]
    fn when_a_hand_first_is_somewhere_is_found_to_the_microsecond() {
        let mut random = Stream::new(3, 77, 0);
        for _ in 0..100 {
            let ends = [FacePlace::new(0.7, 0.9, 0.8), FacePlace::new(0.1, 0.32, 1.4)];
            let path = HandPath::new(ends, [None; 2], Time(5), 1.0, &mut random);
            let is_in = |at: FacePlace| at.y <= 0.44;
            let first = path.first(is_in).expect("it ends there");
            assert!(is_in(path.at(first)) && !is_in(path.at(first - Span(1))));
            assert!(first < path.end());
            assert_eq!(path.first(|at| at.y > 0.5), Some(Time(5)), "it starts there");
            assert_eq!(path.first(|at| at.y < 0.2), None);
        }
    }
}
