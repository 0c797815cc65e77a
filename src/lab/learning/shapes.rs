//! Learns the errors of each kind of prediction by expectation and maximisation.
//!
//! Main types: [`Item`] (one prediction and the truth), main functions: [`fit`], [`calibrate`]. Dempster, Laird and
//! Rubin 1977; scales by conformal prediction with regions of highest density (Izbicki et al. 2022) on people who were
//! left out. Refuses: recordings; items are made from them elsewhere.

use giveway_floor::geometry::{Point, Vector};
use giveway_people::human::Mixture;
use giveway_people::human::forecast::{CLASSES, Guess, Guesses, HORIZONS, HorizonShape, Kernel, Shapes};
use nalgebra::Rotation2;

/// One prediction and where the person was.
#[derive(Clone, Debug)]
pub struct Item {
    /// The prediction.
    pub guesses: Guesses,
    /// The person's true position.
    pub truth: Point,
    /// Number of the horizon, from 0.
    pub horizon: usize,
    /// Number of the person; people are left out whole.
    pub person: usize,
}

/// Rounds of the algorithm.
const ROUNDS: usize = 30;
/// A class with fewer items takes the items of all classes together.
const ITEMS_MIN: usize = 80;
/// Number of items of each kind that the prior is worth.
const IMAGINED: f64 = 12.0;
/// Least standard deviation, metres.
const SIGMA_MIN_M: f64 = 0.02;
/// Probability of the regions that scales are fitted for.
const LEVEL: f64 = 0.95;
/// Range of the search for a scale.
const SCALES: (f64, f64) = (0.6, 2.5);
/// Number of items of a horizon and class for fitting a scale.
const CALIBRATED_BY: usize = 400;

/// Learns shapes from items, with known ones as prior; those of `left_out` people do not count.
pub fn fit(items: &[Item], known: &Shapes, left_out: impl Fn(usize) -> bool) -> Shapes {
    let mut sorted: Vec<Vec<Vec<&Item>>> = vec![vec![Vec::new(); HORIZONS]; CLASSES];
    for item in items.iter().filter(|i| !left_out(i.person)) {
        sorted[item.guesses.class][item.horizon].push(item);
    }
    let pooled = |h: usize| sorted.iter().flat_map(|c| c[h].iter().copied()).collect::<Vec<_>>();
    let classes = (0..CLASSES).map(|c| {
        let shapes = (0..HORIZONS).map(|h| {
            let own = &sorted[c][h];
            let first = HorizonShape { scale: 1.0, ..known.classes[c][h] };
            if own.len() >= ITEMS_MIN { fit_one(own, first) } else { fit_one(&pooled(h), first) }
        });
        smooth(&shapes.collect::<Vec<_>>())
    });
    Shapes { blend_s: known.blend_s, classes: classes.collect() }
}

/// Averages neighbouring horizons, which are similar.
fn smooth(shapes: &[HorizonShape]) -> Vec<HorizonShape> {
    let at = |i: usize| (shapes[i.saturating_sub(1)], shapes[i], shapes[(i + 1).min(shapes.len() - 1)]);
    let kernel = |a: Kernel, b: Kernel, c: Kernel| {
        // Spreads grow with time, so neighbours are averaged as ratios.
        let mean = |x: f64, y: f64, z: f64| (x + 2.0 * y + z) / 4.0;
        let ratio = |x: f64, y: f64, z: f64| (x * y * y * z).powf(0.25);
        let pair = |x: [f64; 2], y: [f64; 2], z: [f64; 2]| [ratio(x[0], y[0], z[0]), ratio(x[1], y[1], z[1])];
        Kernel {
            weight: mean(a.weight, b.weight, c.weight),
            shift_m: b.shift_m,
            tight_m: pair(a.tight_m, b.tight_m, c.tight_m),
            wide_m: pair(a.wide_m, b.wide_m, c.wide_m),
            wide_share: mean(a.wide_share, b.wide_share, c.wide_share),
        }
    };
    (0..shapes.len())
        .map(|i| {
            if i == 0 || i + 1 == shapes.len() {
                return shapes[i];
            }
            let (a, b, c) = at(i);
            HorizonShape {
                drive: kernel(a.drive, b.drive, c.drive),
                goal: kernel(a.goal, b.goal, c.goal),
                stay: kernel(a.stay, b.stay, c.stay),
                scale: 1.0,
            }
        })
        .collect()
}

/// Sums for one kernel in one round.
#[derive(Clone, Copy, Default)]
struct KernelSums {
    /// Sums of responsibilities: tight and wide.
    n: [f64; 2],
    along: f64,
    squares: [[f64; 2]; 2],
}

fn fit_one(items: &[&Item], mut shape: HorizonShape) -> HorizonShape {
    if items.is_empty() {
        return shape;
    }
    let first = shape;
    // Weights of kinds sum to one, and so do the weights of their imagined items.
    for _ in 0..ROUNDS {
        let mut sums = [KernelSums::default(); 3];
        for item in items {
            weigh(item, &shape, &mut sums);
        }
        let total: f64 = sums.iter().map(|s| s.n[0] + s.n[1] + IMAGINED).sum();
        let has_goals = items.iter().any(|i| !i.guesses.goals.is_empty());
        shape.drive = sums[0].kernel(&shape.drive, &first.drive, total);
        shape.stay = sums[2].kernel(&shape.stay, &first.stay, total);
        if has_goals {
            shape.goal = sums[1].kernel(&shape.goal, &first.goal, total);
        }
    }
    shape
}

impl KernelSums {
    fn kernel(&self, old: &Kernel, first: &Kernel, total: f64) -> Kernel {
        let n = self.n[0] + self.n[1];
        let spread = |k: usize, first: [f64; 2]| {
            std::array::from_fn(|axis| {
                let imagined = IMAGINED * first[axis] * first[axis];
                ((self.squares[k][axis] + imagined) / (self.n[k] + IMAGINED)).max(SIGMA_MIN_M.powi(2)).sqrt()
            })
        };
        Kernel {
            weight: (n + IMAGINED * 3.0 * first.weight) / total,
            shift_m: old.shift_m + (self.along + IMAGINED * (first.shift_m - old.shift_m)) / (n + IMAGINED),
            tight_m: spread(0, first.tight_m),
            wide_m: spread(1, first.wide_m),
            wide_share: (self.n[1] + IMAGINED * first.wide_share) / (n + IMAGINED),
        }
    }
}

/// Adds one item's contribution to the sums.
fn weigh(item: &Item, shape: &HorizonShape, sums: &mut [KernelSums; 3]) {
    let g = &item.guesses;
    let one = |guess: &Guess, kernel: &Kernel| residual(guess, kernel, item.truth, g);
    let mut all: Vec<(usize, f64, Residual)> = vec![
        (0, shape.drive.weight * g.drive.share, one(&g.drive, &shape.drive)),
        (2, shape.stay.weight * g.stay.share, one(&g.stay, &shape.stay)),
    ];
    all.extend(g.goals.iter().map(|goal| (1, shape.goal.weight * goal.share, one(goal, &shape.goal))));
    let mass = |w: f64, r: &Residual| [w * r.density[0], w * r.density[1]];
    let total: f64 = all.iter().map(|(_, w, r)| mass(*w, r).iter().sum::<f64>()).sum::<f64>().max(1e-300);
    for (kind, weight, r) in &all {
        let s = &mut sums[*kind];
        for (k, m) in mass(*weight, r).into_iter().enumerate() {
            let share = m / total;
            s.n[k] += share;
            s.along += share * r.off.x;
            s.squares[k][0] += share * (r.off.x * r.off.x - r.doubt[0]);
            s.squares[k][1] += share * (r.off.y * r.off.y - r.doubt[1]);
        }
    }
}

/// Deviation of the truth from one guess, in the guess's own frame, with its densities: tight and wide.
struct Residual {
    off: Vector,
    density: [f64; 2],
    doubt: [f64; 2],
}

fn residual(guess: &Guess, kernel: &Kernel, truth: Point, g: &Guesses) -> Residual {
    let back = Rotation2::new(-guess.along);
    let off = back * (truth - guess.at) - Vector::new(kernel.shift_m, 0.0);
    let turned = back.matrix() * g.doubt * back.matrix().transpose();
    let doubt = [turned[(0, 0)], turned[(1, 1)]];
    let density = |sigma: [f64; 2], share: f64| {
        let (a, b) = (sigma[0] * sigma[0] + doubt[0], sigma[1] * sigma[1] + doubt[1]);
        share * (-0.5 * (off.x * off.x / a + off.y * off.y / b)).exp() / (a * b).sqrt()
    };
    let density =
        [density(kernel.tight_m, 1.0 - kernel.wide_share), density(kernel.wide_m, kernel.wide_share)];
    Residual { off, density, doubt }
}

/// The mixture of an item's guesses under a shape.
pub fn mixture(item: &Item, shape: &HorizonShape) -> Mixture {
    let mut parts = Vec::new();
    shape.parts(&item.guesses, 1.0, &mut parts);
    parts.retain(|p| p.weight > 1e-4);
    Mixture { parts }
}

/// Surprise of people under shapes learned from the others: mean of -ln density per m², nats.
pub fn surprise(items: &[Item], known: &Shapes) -> f64 {
    let halves = [0, 1].map(|half| fit(items, known, |p| p % 2 == half));
    let of = |i: &Item| {
        let shape = &halves[i.person % 2].classes[i.guesses.class][i.horizon];
        -mixture(i, shape).density(i.truth).max(1e-8).ln()
    };
    items.iter().map(of).sum::<f64>() / items.len().max(1) as f64
}

/// Sets the scale of every shape so that its 95 % region contains 95 % of the people it was not learned from.
pub fn calibrate(shapes: &mut Shapes, items: &[Item], known: &Shapes, folds: usize) {
    let without: Vec<Shapes> = (0..folds).map(|f| fit(items, known, |p| p % folds == f)).collect();
    let mut sorted: Vec<Vec<Vec<&Item>>> = vec![vec![Vec::new(); HORIZONS]; CLASSES];
    items.iter().for_each(|i| sorted[i.guesses.class][i.horizon].push(i));
    for (class, by_horizon) in sorted.iter().enumerate() {
        let found: Vec<f64> = (0..HORIZONS)
            .map(|h| {
                let all = &by_horizon[h];
                let thin = all.iter().step_by((all.len() / CALIBRATED_BY).max(1)).copied();
                scale(&thin.collect::<Vec<_>>(), |i| &without[i.person % folds].classes[class][h])
            })
            .collect();
        for h in 0..HORIZONS {
            // A scale from few items is uncertain; its neighbours carry as much information.
            let near = &found[h.saturating_sub(1)..(h + 2).min(HORIZONS)];
            shapes.classes[class][h].scale = near.iter().sum::<f64>() / near.len() as f64;
        }
    }
}

fn scale<'a>(items: &[&Item], shape: impl Fn(&Item) -> &'a HorizonShape) -> f64 {
    if items.len() < ITEMS_MIN / 2 {
        return 1.0;
    }
    let covered = |scale: f64| {
        let within = |i: &&&Item| {
            let wider = HorizonShape { scale, ..*shape(i) };
            mixture(i, &wider).level(i.truth) <= LEVEL
        };
        items.iter().filter(within).count() as f64
    };
    // Of n people and one more, the next one is within with probability ceil((n + 1) level) / (n + 1).
    let wanted = ((items.len() + 1) as f64 * LEVEL).ceil().min(items.len() as f64);
    let (mut low, mut high) = SCALES;
    for _ in 0..9 {
        let middle = (low * high).sqrt();
        if covered(middle) >= wanted { high = middle } else { low = middle }
    }
    high
}
