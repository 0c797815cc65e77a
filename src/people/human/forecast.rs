//! Where a person will be at a given moment, as a probability over places.
//!
//! Main types: [`Forecast`] (the belief about one person now), [`Shapes`] (learned errors of each kind of prediction).
//! A prediction is a mixture of three kinds: going on as now, following the way to a goal, and staying. Refuses:
//! occupancies of nodes, and robots.

use super::mixture::{Mixture, Part};
use super::motion::{Ahead, Motion};
use super::passage::Hypothesis;
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};
use nalgebra::{Matrix2, Rotation2};
use serde::{Deserialize, Serialize};

/// Horizons of the learned figures: multiples of 0.4 s up to 4.8 s.
pub const HORIZONS: usize = 12;
/// The first horizon, and the interval between horizons, seconds.
pub const HORIZON_S: f64 = 0.4;
/// Number of speed classes: standing, slow, walking, brisk.
pub const CLASSES: usize = 4;
/// Boundaries between speed classes, metres per second.
const BOUNDS_MPS: [f64; 3] = [0.3, 0.8, 1.2];
/// Least speed assumed for a person who walks to a goal, metres per second.
const PACE_MPS: f64 = 0.25;

/// The class of a speed.
pub fn class_of(speed_mps: f64) -> usize {
    BOUNDS_MPS.iter().filter(|b| speed_mps >= **b).count()
}

/// Errors of one kind of prediction, along and across the way, metres. People who do roughly what is expected form a
/// tight Gaussian, the others a wide one around the same place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kernel {
    /// Share of this kind in the whole.
    pub weight: f64,
    /// Mean distance by which people are farther on than predicted, metres.
    pub shift_m: f64,
    /// Standard deviations of the tight part, along and across.
    pub tight_m: [f64; 2],
    /// Standard deviations of the wide part, along and across.
    pub wide_m: [f64; 2],
    /// Share of the wide part.
    pub wide_share: f64,
}

/// The three kinds of prediction at one horizon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HorizonShape {
    /// Going on as now.
    pub drive: Kernel,
    /// Following the way to a goal; the weight is shared among goals by their probabilities.
    pub goal: Kernel,
    /// Staying about here.
    pub stay: Kernel,
    /// Factor on all standard deviations, so that regions contain as many people as stated.
    pub scale: f64,
}

/// Figures by class of speed and horizon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shapes {
    /// Time in which people change from going on as now to following the way to their goal, seconds.
    pub blend_s: f64,
    /// One list of [`HORIZONS`] for each class of speed.
    pub classes: Vec<Vec<HorizonShape>>,
}

impl HorizonShape {
    /// Interpolates between two shapes: `share` of the second.
    fn between(&self, other: &HorizonShape, share: f64) -> HorizonShape {
        let kernel = |a: &Kernel, b: &Kernel| {
            let mix = |x: f64, y: f64| x + (y - x) * share;
            let pair = |x: [f64; 2], y: [f64; 2]| [mix(x[0], y[0]), mix(x[1], y[1])];
            Kernel {
                weight: mix(a.weight, b.weight),
                shift_m: mix(a.shift_m, b.shift_m),
                tight_m: pair(a.tight_m, b.tight_m),
                wide_m: pair(a.wide_m, b.wide_m),
                wide_share: mix(a.wide_share, b.wide_share),
            }
        };
        HorizonShape {
            drive: kernel(&self.drive, &other.drive),
            goal: kernel(&self.goal, &other.goal),
            stay: kernel(&self.stay, &other.stay),
            scale: self.scale + (other.scale - self.scale) * share,
        }
    }

    /// The shape before the first horizon, shrunk towards now: at zero time ahead there is no error.
    fn shrunk(mut self, share: f64) -> HorizonShape {
        for k in [&mut self.drive, &mut self.goal, &mut self.stay] {
            k.shift_m *= share;
            for s in k.tight_m.iter_mut().chain(&mut k.wide_m) {
                *s = (*s * share).max(0.01);
            }
        }
        self
    }

    /// The shape beyond the last horizon, grown by `metres` in all directions.
    fn grown(mut self, metres: f64) -> HorizonShape {
        for k in [&mut self.drive, &mut self.goal, &mut self.stay] {
            k.tight_m.iter_mut().chain(&mut k.wide_m).for_each(|s| *s += metres);
        }
        self
    }
}

/// Growth of standard deviations beyond the last horizon, metres per second.
const GROWTH_MPS: f64 = 0.4;

impl Shapes {
    /// The shape for a class of speed at `ahead_s` seconds ahead.
    pub fn at(&self, class: usize, ahead_s: f64) -> HorizonShape {
        let shapes = &self.classes[class];
        let position = ahead_s / HORIZON_S - 1.0;
        if position <= 0.0 {
            return shapes[0].shrunk((position + 1.0).max(0.0));
        }
        let i = position as usize;
        if i + 1 >= HORIZONS {
            let beyond = ahead_s - HORIZONS as f64 * HORIZON_S;
            return shapes[HORIZONS - 1].grown(GROWTH_MPS * beyond.max(0.0));
        }
        shapes[i].between(&shapes[i + 1], position.fract())
    }
}

/// The belief about one person now.
#[derive(Clone, Copy, Debug)]
pub struct Forecast<'a> {
    /// The person's motion filter.
    pub motion: &'a Motion,
    /// Ways to goals from the person's position, with their probabilities. The remainder to one is the probability that
    /// the person goes to no known goal.
    pub ways: &'a [Hypothesis],
    /// Shapes for people with goals.
    pub bound: &'a Shapes,
    /// Shapes for people without a known goal.
    pub free: &'a Shapes,
}

/// One kind of prediction at one moment: the place, and the direction of the way there.
#[derive(Clone, Copy, Debug)]
pub struct Guess {
    /// Share of this guess within its kind.
    pub share: f64,
    /// Position before the learned shift.
    pub at: Point,
    /// Direction of the way, radians.
    pub along: f64,
}

/// All guesses for one moment, to which shapes are applied.
#[derive(Clone, Debug)]
pub struct Guesses {
    /// The class of speed.
    pub class: usize,
    /// Going on as now.
    pub drive: Guess,
    /// Staying.
    pub stay: Guess,
    /// Following the way to each goal.
    pub goals: Vec<Guess>,
    /// Covariance of the person's position as carried forward from what is not known now, m².
    pub doubt: Matrix2<f64>,
}

impl Forecast<'_> {
    /// The guesses for time `t`; nothing before the first sighting. `blend_s` is that of [`Shapes`].
    pub fn guesses(&self, t: Time, blend_s: f64) -> Option<Guesses> {
        let seen = self.motion.seen()?;
        let (now, then) = (self.motion.ahead(seen)?, self.motion.carried(t)?);
        let ahead_s = (t - seen).max(Span::ZERO).as_secs_f64();
        let speed = now.velocity.norm();
        let course = now.velocity.y.atan2(now.velocity.x);
        let drive = Guess { share: 1.0, at: then.at, along: course };
        let stay = Guess { share: 1.0, at: run_out(&now, ahead_s), along: course };
        let kept = (-ahead_s / blend_s).exp();
        let total: f64 = self.ways.iter().map(|w| w.probability).sum();
        let goals = self.ways.iter().map(|way| {
            let (on, along) = walked(&way.path, speed.max(PACE_MPS) * ahead_s);
            let at = Point::from(then.at.coords * kept + on.coords * (1.0 - kept));
            Guess { share: way.probability / total.max(1e-12), at, along }
        });
        Some(Guesses { class: class_of(speed), drive, stay, goals: goals.collect(), doubt: then.cov })
    }

    /// The single place with the least error: as far as goals are known, the mean over the ways to them; otherwise
    /// where the filter has the person. People without goals stop in some places and never in others; going on is the
    /// guess that works everywhere.
    pub fn point(&self, t: Time) -> Option<Point> {
        let ahead_s = (t - self.motion.seen()?).max(Span::ZERO).as_secs_f64();
        let known: f64 = self.ways.iter().map(|w| w.probability).sum::<f64>().clamp(0.0, 1.0);
        let guesses = self.guesses(t, self.bound.blend_s)?;
        let mut bound = Mixture::default();
        if known > 0.0 {
            self.bound.at(guesses.class, ahead_s).parts(&guesses, known, &mut bound.parts);
        }
        let mean = bound.mean().unwrap_or(guesses.drive.at);
        Some(guesses.drive.at + (mean - guesses.drive.at) * known)
    }

    /// The forecast for `t`; nothing before the first sighting.
    pub fn at(&self, t: Time) -> Option<Mixture> {
        let ahead_s = (t - self.motion.seen()?).max(Span::ZERO).as_secs_f64();
        let known: f64 = self.ways.iter().map(|w| w.probability).sum::<f64>().clamp(0.0, 1.0);
        let mut parts = Vec::with_capacity(8 + 2 * self.ways.len());
        let mut guesses = self.guesses(t, self.bound.blend_s)?;
        if known > 1e-6 {
            self.bound.at(guesses.class, ahead_s).parts(&guesses, known, &mut parts);
        }
        if known < 1.0 - 1e-6 {
            guesses.goals.clear();
            self.free.at(guesses.class, ahead_s).parts(&guesses, 1.0 - known, &mut parts);
        }
        Some(Mixture { parts })
    }
}

/// Where a person who stops now comes to rest: the speed fades within half a second.
fn run_out(now: &Ahead, ahead_s: f64) -> Point {
    const HALT_S: f64 = 0.5;
    now.at + now.velocity * (HALT_S * (1.0 - (-ahead_s / HALT_S).exp()))
}

/// The point after `metres` along a path, and its direction from the start; beyond the end, the end.
fn walked(path: &[Point], metres: f64) -> (Point, f64) {
    let start = path.first().copied().unwrap_or(Point::origin());
    let (mut left, mut at) = (metres, start);
    for pair in path.windows(2) {
        let leg: Vector = pair[1] - pair[0];
        let length = leg.norm();
        let share = if length > left { left / length } else { 1.0 };
        (left, at) = (left - length, pair[0] + leg * share);
        if left <= 0.0 {
            break;
        }
    }
    let off: Vector = at - start;
    (at, off.y.atan2(off.x))
}

impl HorizonShape {
    /// Adds the parts of this shape to a mixture, with `share` of the whole.
    pub fn parts(&self, g: &Guesses, share: f64, parts: &mut Vec<Part>) {
        let goal = if g.goals.is_empty() { 0.0 } else { self.goal.weight };
        let total = self.drive.weight + self.stay.weight + goal;
        let share = share / total.max(1e-12);
        self.drive.parts(&g.drive, share, self.scale, &g.doubt, parts);
        self.stay.parts(&g.stay, share, self.scale, &g.doubt, parts);
        for goal in &g.goals {
            self.goal.parts(goal, share, self.scale, &g.doubt, parts);
        }
    }
}

impl Kernel {
    fn parts(&self, guess: &Guess, share: f64, scale: f64, doubt: &Matrix2<f64>, parts: &mut Vec<Part>) {
        let turn = Rotation2::new(guess.along);
        let mean = guess.at + turn * Vector::new(self.shift_m, 0.0);
        for (sigma, part) in [(self.tight_m, 1.0 - self.wide_share), (self.wide_m, self.wide_share)] {
            let weight = share * self.weight * guess.share * part;
            let own = Matrix2::new(sigma[0] * sigma[0], 0.0, 0.0, sigma[1] * sigma[1]);
            let cov = (turn.matrix() * own * turn.matrix().transpose() + doubt) * (scale * scale);
            parts.push(Part { weight, mean, cov });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::Model;
    use crate::human::motion::Fix;

    /// A person who walks along x at 1.2 m/s and is at the origin now; `sigma_m` is what the source states.
    fn walker(sigma_m: f64) -> (Motion, Time) {
        let mut motion = Motion::new(Model::builtin().motion);
        let mut t = Time::ZERO;
        for i in 0..=30 {
            t = Time(i * 100_000);
            motion.see(Fix { seen: t, at: Point::new(0.12 * (i as f64 - 30.0), 0.0), sigma_m });
        }
        (motion, t)
    }

    fn ahead<R>(motion: &Motion, ways: &[Hypothesis], f: impl FnOnce(&Forecast<'_>) -> R) -> R {
        let model = Model::builtin();
        f(&Forecast { motion, ways, bound: &model.bound, free: &model.free })
    }

    fn way(probability: f64, x: f64, y: f64) -> Hypothesis {
        Hypothesis { probability, path: vec![Point::origin(), Point::new(x, y)], stay: None }
    }

    #[test]
    fn weights_of_every_moment_sum_to_one() {
        let (motion, now) = walker(0.02);
        for ways in [vec![], vec![way(0.5, 9.0, 0.0), way(0.3, 0.0, 9.0)], vec![way(1.0, 9.0, 0.0)]] {
            for k in 0..80 {
                let t = now + Span::from_millis(100 * k);
                let mixture = ahead(&motion, &ways, |o| o.at(t)).unwrap();
                let sum: f64 = mixture.parts.iter().map(|p| p.weight).sum();
                assert!((sum - 1.0).abs() < 1e-9, "{sum} after {k} tenths of a second");
            }
        }
    }

    #[test]
    fn regions_grow_with_time_and_with_bad_positions() {
        let area = |sigma_m: f64, ms: i64| {
            let (motion, now) = walker(sigma_m);
            ahead(&motion, &[], |o| o.at(now + Span::from_millis(ms))).unwrap().area(0.95)
        };
        let areas = [400, 800, 1200, 2000, 3200, 4800, 8000].map(|ms| area(0.02, ms));
        assert!(areas.windows(2).all(|a| a[0] < a[1]), "{areas:?}");
        assert!(area(0.3, 800) > 1.5 * area(0.02, 800));
    }

    #[test]
    fn a_known_goal_draws_the_forecast_to_its_way() {
        let (motion, now) = walker(0.02);
        let t = now + Span::from_millis(4800);
        let free = ahead(&motion, &[], |o| o.point(t)).unwrap();
        let bound = ahead(&motion, &[way(1.0, 3.0, 8.0)], |o| o.point(t)).unwrap();
        assert!((free.x - 5.76).abs() < 0.6 && free.y.abs() < 0.3, "{free}");
        assert!(bound.y > 2.0, "{bound}");
        let there = Point::new(1.9, 5.0);
        let density = |ways: &[Hypothesis]| ahead(&motion, ways, |o| o.at(t)).unwrap().density(there);
        assert!(density(&[way(1.0, 3.0, 8.0)]) > 5.0 * density(&[]));
    }

    #[test]
    fn whoever_is_not_seen_spreads_and_does_not_freeze() {
        let (motion, now) = walker(0.02);
        // A later query about the same time after the last sighting gives a wider area, since time has passed.
        let soon = ahead(&motion, &[], |o| o.at(now + Span::from_millis(1000))).unwrap().area(0.95);
        let late = ahead(&motion, &[], |o| o.at(now + Span::from_millis(3000))).unwrap().area(0.95);
        assert!(late > 3.0 * soon, "{soon} and {late}");
    }
}
