//! Training of the arm's forecast, with people left out.
//!
//! Main functions: [`learn_arms`], [`regions_of`]. Regions hold a stated share of people left out, per horizon, part
//! and speed (a conformal quantile). Refuses: widths of a net as regions.

use super::arm::{ArmWindow, learn_arm, windows};
use super::items::Variety;
use super::lessons::PickLessons;
use giveway_people::reach::arm::{ARM_STEPS, ArmForecast, ArmNet};
use giveway_people::reach::model::CLASSES;
use giveway_people::reach::sample::ARM_PARTS;
use giveway_sim::random::Stream;

/// Number of groups of people to leave out, and of nets to train.
pub(super) const ARM_GROUPS: usize = 3;
/// Size of the state; then passes over all movements.
const HIDDEN: usize = 28;
const EPOCHS: usize = 6;
/// Number of variations of each movement to learn from.
const VARIED: usize = 2;
/// Largest number of windows to learn from.
const MOST: usize = 36_000;
/// A class of speed with fewer windows takes the radius of all classes.
const FEW: usize = 100;
/// Share of left-out people that regions of one net contain. The mean of all nets has smaller errors than one of them,
/// so that it contains about 0.95 of people whom none of them saw (measured on recorded people, `docs/picks.md`).
const HELD: f64 = 0.935;

/// A window of a person left out, with its forecast.
#[derive(Clone, Debug, PartialEq)]
pub struct ForecastWindow {
    /// The window.
    pub window: ArmWindow,
    /// The forecast from the window.
    pub forecast: ArmForecast,
}

/// The nets, and each net's forecasts for the people it never saw.
pub(super) fn learn_arms(
    lessons: &PickLessons,
    strangers: Option<Variety>,
    seed: u64,
    tell: &mut impl FnMut(&str),
) -> (Vec<ArmNet>, Vec<ForecastWindow>) {
    let groups = ARM_GROUPS.min(lessons.present().len()).max(2);
    let (mut nets, mut left_out) = (Vec::new(), Vec::new());
    for group in 0..groups {
        tell(&format!("where arms will be, {} of {groups}", group + 1));
        let mut chance = Stream::new(seed, 302, group as u64);
        let mut learned = Vec::new();
        for item in lessons.items.iter().filter(|i| lessons.group(i.person, groups) != group) {
            learned.extend(windows(item));
            for _ in 0..VARIED {
                learned.extend(windows(&Variety::PEOPLE.vary(item, &mut chance)));
            }
        }
        let every = learned.len().div_ceil(MOST).max(1);
        let learned: Vec<_> = learned.into_iter().step_by(every).collect();
        let mut net = learn_arm(&learned, HIDDEN, EPOCHS, &mut chance);
        net.memory.gates.round();
        net.out.round();
        for item in lessons.items.iter().filter(|i| lessons.group(i.person, groups) == group) {
            let varied = strangers.map(|v| v.vary(item, &mut chance));
            let forecasts = windows(varied.as_ref().unwrap_or(item)).into_iter().filter_map(|window| {
                Some(ForecastWindow { forecast: net.forecast(&window.observed)?, window })
            });
            left_out.extend(forecasts);
        }
        nets.push(net);
    }
    (nets, left_out)
}

/// Radii of regions in units of width, by class of speed, step and part.
pub(super) fn regions_of(left_out: &[ForecastWindow]) -> Vec<[[f64; ARM_PARTS]; ARM_STEPS]> {
    let radius = |class: Option<usize>, k: usize, p: usize| {
        let of = left_out.iter().filter(|w| class.is_none_or(|c| w.forecast.class == c));
        let ratio = |w: &ForecastWindow| {
            (w.forecast.middle[k][p] - w.window.after[k].parts()[p]).norm() / w.forecast.width_m[k][p]
        };
        let mut ratios: Vec<f64> = of.map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let at = ((ratios.len() + 1) as f64 * HELD).ceil() as usize;
        (ratios.len() >= FEW || class.is_none()).then(|| ratios.get(at.saturating_sub(1)).copied())
    };
    let class = |c: usize| {
        std::array::from_fn(|k| {
            std::array::from_fn(|p| {
                let own = radius(Some(c), k, p).or_else(|| radius(None, k, p));
                own.flatten().unwrap_or(3.0).clamp(0.01, 100.0)
            })
        })
    };
    (0..CLASSES).map(class).collect()
}
