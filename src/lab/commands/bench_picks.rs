//! `giveway bench picks`: what one sample of a hand costs.
//!
//! Main type: [`BenchPicksArgs`]. Hands are those of simulated people who reach for slots of a rack, 60 times a second.
//! Allocations are counted by the program's allocator while a sample is processed. Refuses: to print a figure without
//! the command that made it.

use super::stopwatch;
use crate::arm::bolts::BoltsBench;
use crate::arm::planners::{PlannerKind, Workshops};
use clap::Args;
use giveway_people::reach::arm::ARM_STEPS;
use giveway_people::reach::{ArmPoint, ArmSample, ArmVector, PickModel, ReachTarget, SlotTracker};
use giveway_sim::picker::motion::{ArmBuild, ArmReach};
use giveway_sim::random::Stream;
use serde_json::{Value, json};
use std::process::ExitCode;

/// Samples per second of a headset.
const HZ: f64 = 60.0;
/// Number of reaches of every worker.
const REACHES: usize = 6;

/// Arguments of `bench picks`.
#[derive(Args)]
pub struct BenchPicksArgs {
    /// How many workers send hands.
    #[arg(long, default_value_t = 40)]
    workers: usize,
    /// How many slots each of them may reach for.
    #[arg(long, default_value_t = 24)]
    slots: usize,
    /// Seed of the simulated people.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// One worker: the samples sent, and the tracker.
struct BenchedHand {
    samples: Vec<ArmSample>,
    tracker: SlotTracker,
}

impl BenchPicksArgs {
    /// Measures and prints.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!((1..=1000).contains(&self.workers), "--workers must be from 1 to 1000");
        anyhow::ensure!((1..=500).contains(&self.slots), "--slots must be from 1 to 500");
        let mut hands: Vec<BenchedHand> = (0..self.workers).map(|w| self.hand(w)).collect();
        let (mut times, mut allocations, mut first) = (Vec::new(), 0, true);
        let longest = hands.iter().map(|h| h.samples.len()).max().unwrap_or(0);
        for k in 0..longest {
            for hand in &mut hands {
                let Some(sample) = hand.samples.get(k) else { continue };
                let begun = stopwatch();
                let counted = allocation_counter::measure(|| hand.tracker.observe(*sample));
                times.push((stopwatch() - begun) as f64 / 1000.0);
                allocations += if first { 0 } else { counted.count_total };
            }
            // Buffers grow with the very first sample of every hand.
            first = false;
        }
        let forecasts = forecast_us(&hands[0].samples);
        let [mpc_us, planner_us] = arm_us(self.seed)?;
        let mean_us = times.iter().sum::<f64>() / times.len() as f64;
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
        let core_share = mean_us * 1e-6 * HZ * self.workers as f64;
        let per_sample = allocations as f64 / (times.len() - hands.len()).max(1) as f64;
        if self.json {
            let report = json!({
                "workers": self.workers, "slots": self.slots, "samples": times.len(),
                "sample_us": {"p50": at(0.5), "p99": at(0.99)}, "core_share": core_share,
                "forecast_us": quantiles(&forecasts), "mpc_us": quantiles(&mpc_us),
                "planner_us": quantiles(&planner_us),
                "allocations_per_sample": per_sample,
            });
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            println!(
                "giveway bench picks --workers {} --slots {} --seed {}",
                self.workers, self.slots, self.seed
            );
            println!("a sample {:.1} µs, 99 % below {:.1} µs", at(0.5), at(0.99));
            println!("{core_share:.3} of one core for {} hands at {HZ} Hz", self.workers);
            let timed = [
                ("a forecast of a person's arm", &forecasts),
                ("a robot arm: a cycle of its control", &mpc_us),
                ("a robot arm: a search for its way", &planner_us),
            ];
            for (what, us) in timed {
                println!("{what} {:.0} µs, 99 % below {:.0} µs", at_share(us, 0.5), at_share(us, 0.99));
            }
            println!("{per_sample} allocations per sample");
        }
        Ok(ExitCode::SUCCESS)
    }

    /// A simulated worker before a rack with that many slots.
    fn hand(&self, worker: usize) -> BenchedHand {
        let mut chance = Stream::new(self.seed, 320, worker as u64);
        let build = ArmBuild::any(0.0, &mut chance);
        let columns = (self.slots as f64).sqrt().ceil() as usize;
        let place = |i: usize| {
            let share = |k: usize| k as f64 / columns as f64 - 0.4;
            let (y, z) = (share(i % columns), share(i / columns));
            let hand: ArmPoint = build.shoulder + ArmVector::new(0.5, y * 0.8, z * 0.8);
            ReachTarget { hand, look: hand + ArmVector::x() * 0.1 }
        };
        let places: Vec<ReachTarget> = (0..self.slots).map(place).collect();
        let (mut samples, mut now_s): (Vec<ArmSample>, f64) = (Vec::new(), 0.0);
        for _ in 0..REACHES {
            let right = chance.below(places.len());
            let reach = ArmReach::new(&build, &build.rest(&mut chance), &places[right], &mut chance);
            let count = ((reach.duration_s() + 0.6) * HZ) as usize;
            for k in 0..count {
                let sample = reach.at(k as f64 / HZ - 0.3).sample;
                samples.push(ArmSample { at_s: now_s, ..sample });
                now_s += 1.0 / HZ;
            }
        }
        let mut tracker = SlotTracker::new(PickModel::builtin());
        tracker.set_places(&places, None);
        BenchedHand { samples, tracker }
    }
}

/// Durations of forecasts of the arm, microseconds.
fn forecast_us(samples: &[ArmSample]) -> Vec<f64> {
    let model = PickModel::builtin();
    let time = |window: &[ArmSample]| {
        let begun = stopwatch();
        std::hint::black_box(model.arm.forecast(window));
        (stopwatch() - begun) as f64 / 1000.0
    };
    let mut times: Vec<f64> = samples.windows(ARM_STEPS).map(time).collect();
    times.sort_by(f64::total_cmp);
    times
}

/// Number of timed path queries.
const QUERIES: u64 = 60;

/// Durations of a robot arm's control and of its planner (the net, or RRT-Connect if that finds no path), sorted,
/// microseconds.
fn arm_us(seed: u64) -> anyhow::Result<[Vec<f64>; 2]> {
    let mut clock = || stopwatch() as f64 / 1000.0;
    let mut control = BoltsBench::new(seed).control_times(&mut clock);
    let workshop = Workshops::new(seed, 1).ok_or_else(|| anyhow::anyhow!("the arm's net learned nothing"))?;
    let asked = PlannerKind::ALL.iter().position(|kind| *kind == PlannerKind::GraphFallback);
    let asked = asked.expect("it is one of them");
    let mut planner: Vec<f64> = (0..QUERIES).map(|n| workshop.ask(0, n, &mut clock)[asked].took_ms).collect();
    [&mut control, &mut planner].into_iter().for_each(|all| all.sort_by(f64::total_cmp));
    Ok([control, planner])
}

fn at_share(sorted: &[f64], share: f64) -> f64 {
    sorted.get(((sorted.len().max(1) - 1) as f64 * share) as usize).copied().unwrap_or(f64::NAN)
}

fn quantiles(sorted: &[f64]) -> Value {
    json!({"p50": at_share(sorted, 0.5), "p99": at_share(sorted, 0.99)})
}
