//! Where a person will be at some moment, as a probability over places.
//!
//! Main types: [`Forecast`] (what is believed of one person now), [`Shapes`] (learned figures: how far people
//! are from where each kind of prediction has them). A prediction is a mixture of three kinds: going on as
//! now, following the way to a goal, and staying. Refuses: occupancies of nodes, and robots.

use super::mixture::{Mixture, Part};
use super::motion::{Ahead, Motion};
use super::passage::Hypothesis;
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};
use nalgebra::{Matrix2, Rotation2};
use serde::{Deserialize, Serialize};

/// Horizons of the learned figures: multiples of 0.4 s up to 4.8 s.
pub const HORIZONS: usize = 12;
/// The first horizon and the distance between horizons, seconds.
pub const HORIZON_S: f64 = 0.4;
/// Classes of speed: standing, slow, walking, brisk.
pub const CLASSES: usize = 4;
/// Where classes part, metres per second.
const BOUNDS_MPS: [f64; 3] = [0.3, 0.8, 1.2];
/// Whoever walks to a goal is taken to walk at least this fast, metres per second.
const PACE_MPS: f64 = 0.25;

/// The class of a speed.
pub fn class_of(speed_mps: f64) -> usize {
    BOUNDS_MPS.iter().filter(|b| speed_mps >= **b).count()
}

/// How far people are from where one kind of prediction has them, along and across the way, metres. People
/// who do about the expected are a tight Gaussian, the others a wide one around the same place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kernel {
    /// Its share of the whole.
    pub weight: f64,
    /// How much farther on than predicted people are on average.
    pub shift_m: f64,
    /// Standard deviations along and across of the tight part.
    pub tight_m: [f64; 2],
    /// The same of the wide part.
    pub wide_m: [f64; 2],
    /// Share of the wide part.
    pub wide_share: f64,
}

/// The three kinds at one horizon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HorizonShape {
    /// Going on as now.
    pub drive: Kernel,
    /// Following the way to a goal; the weight is shared by goals as they are believed in.
    pub goal: Kernel,
    /// Staying about here.
    pub stay: Kernel,
    /// All standard deviations are multiplied by this, so that regions hold as many people as they say.
    pub scale: f64,
}

/// Figures by class of speed and horizon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shapes {
    /// In this time people change from going on as now to following the way to their goal, seconds.
    pub blend_s: f64,
    /// One list of [`HORIZONS`] for each class of speed.
    pub classes: Vec<Vec<HorizonShape>>,
}

impl HorizonShape {
    /// Between two shapes: `share` of the second.
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

    /// Of the first horizon, drawn together towards now: at no distance in time there is no error.
    fn shrunk(mut self, share: f64) -> HorizonShape {
        for k in [&mut self.drive, &mut self.goal, &mut self.stay] {
            k.shift_m *= share;
            for s in k.tight_m.iter_mut().chain(&mut k.wide_m) {
                *s = (*s * share).max(0.01);
            }
        }
        self
    }

    /// Of the last horizon, growing on by `metres` in all directions.
    fn grown(mut self, metres: f64) -> HorizonShape {
        for k in [&mut self.drive, &mut self.goal, &mut self.stay] {
            k.tight_m.iter_mut().chain(&mut k.wide_m).for_each(|s| *s += metres);
        }
        self
    }
}

/// How much standard deviations grow beyond the last horizon, metres per second.
const GROWTH_MPS: f64 = 0.4;

impl Shapes {
    /// The figures for a class of speed at `ahead_s` seconds ahead.
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

/// What is believed of one person now.
#[derive(Clone, Copy, Debug)]
pub struct Forecast<'a> {
    /// How the person moves.
    pub motion: &'a Motion,
    /// Ways to goals, from where the person is, with their probabilities. What is left to one is somebody who
    /// goes to no known goal.
    pub ways: &'a [Hypothesis],
    /// Figures for people with goals.
    pub bound: &'a Shapes,
    /// Figures for people of whom no goal is known.
    pub free: &'a Shapes,
}

/// One kind of prediction at one moment: where, and in which direction the way goes there.
#[derive(Clone, Copy, Debug)]
pub struct Guess {
    /// Share of this one among its kind.
    pub share: f64,
    /// Where, before the learned shift.
    pub at: Point,
    /// Direction of the way, radians.
    pub along: f64,
}

/// All that figures are applied to.
#[derive(Clone, Debug)]
pub struct Guesses {
    /// Class of speed.
    pub class: usize,
    /// Going on as now.
    pub drive: Guess,
    /// Staying.
    pub stay: Guess,
    /// Following the way to each goal.
    pub goals: Vec<Guess>,
    /// What is not known about where the person is and how it moves now.
    pub doubt: Matrix2<f64>,
}

impl Forecast<'_> {
    /// The guesses for a moment at `t`; nothing before anything was seen. `blend_s` is that of [`Shapes`].
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

    /// The one place that is least wrong: the mean over ways to goals, as far as goals are known, and where
    /// the filter has the person otherwise. People without goals stop in some places and never in others;
    /// going on is the guess that does everywhere.
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

    /// Where the person will be at `t`; nothing before anything was seen.
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

/// Where somebody comes to rest who stops now: speed is lost in half a second.
fn run_out(now: &Ahead, ahead_s: f64) -> Point {
    const HALT_S: f64 = 0.5;
    now.at + now.velocity * (HALT_S * (1.0 - (-ahead_s / HALT_S).exp()))
}

/// The point after `metres` of a path and the direction in which it lies; its end beyond.
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
    /// Adds the parts of a mixture with `share` of the whole.
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

    /// Somebody who walks along x at 1.2 m/s and is at the origin now; `sigma_m` is what the source says.
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
        // Asked late, about the same distance into the future of the last sighting: time has passed.
        let soon = ahead(&motion, &[], |o| o.at(now + Span::from_millis(1000))).unwrap().area(0.95);
        let late = ahead(&motion, &[], |o| o.at(now + Span::from_millis(3000))).unwrap().area(0.95);
        assert!(late > 3.0 * soon, "{soon} and {late}");
    }
}
