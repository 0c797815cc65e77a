//! What happened over time, as figures in buckets: deliveries, encounters, interruptions, planning, waiting.
//!
//! Main types: [`History`] (the last hour in steps of ten seconds, the last day in minutes, the last 31 days in ten
//! minutes), [`Bucket`], [`Lengths`] (how long searches took), [`Heat`] (where robots waited). Pure: the driver of
//! the fleet hands in views of it, live or from a recording. Refuses: to grow beyond the stated bounds (about 4 MB
//! of buckets and 10 MB of places in the worst case), to be an input of any decision.

mod bucket;
mod causes;
mod heat;
mod lengths;

pub use bucket::Bucket;
pub use causes::{RobotTimes, WaitCause};
pub use heat::{DAY, Heat, HeatBucket, STEP as HEAT_STEP};
pub use lengths::Lengths;

use crate::{Counts, Presence, RobotView, View, Why};
use giveway_floor::id::NodeId;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, VecDeque};

/// Length of a bucket, and how many are kept, finest first.
pub const TIERS: [(Span, usize); 3] =
    [(Span::from_secs(10), 360), (Span::from_secs(60), 1440), (Span::from_secs(600), 4464)];

/// Views farther apart than this have a gap between them, and what happened in the gap is in no bucket. A recording
/// that is shown many times as fast has views that are seconds apart.
const GAP: Span = Span::from_secs(60);

/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.05;

/// How long searches and steps took since the view before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoopTimes {
    /// How long each search for a route took, microseconds.
    pub searches_us: Vec<u64>,
    /// The longest step, microseconds.
    pub step_us: u64,
}

/// Figures over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    tiers: [VecDeque<Bucket>; 3],
    heat: Heat,
    last: Option<(Time, Counts)>,
}

impl History {
    /// The history with the buckets that were kept of earlier runs, each with its length, in any order.
    pub fn restore(kept: Vec<(Span, Bucket)>, heat: Vec<HeatBucket>) -> History {
        let mut out = History { heat: Heat::restore(heat), ..History::default() };
        let mut kept = kept;
        kept.sort_by_key(|(_, b)| b.start);
        for (step, bucket) in kept {
            if let Some(i) = TIERS.iter().position(|(s, _)| *s == step) {
                push(&mut out.tiers[i], bucket, TIERS[i].1);
            }
        }
        out
    }

    /// Takes a view in. If time runs backwards, as when a recording is wound back, what comes later is dropped.
    pub fn note(&mut self, view: &View, times: &LoopTimes) {
        let now = view.now;
        let Some((then, before)) = self.last.replace((now, view.counts)) else { return };
        if now < then {
            self.forget_after(now);
            return;
        }
        let span = now - then;
        if span > GAP {
            return;
        }
        let waiting = || view.robots.iter().filter(|r| waits(r));
        let people = view.workers.iter().filter(|w| w.presence != Presence::Absent).count();
        let mut fresh = Bucket::between(&before, &view.counts);
        fresh.covered = span;
        fresh.worker_time = span * people as i64;
        fresh.waiting_time = span * waiting().count() as i64;
        let idle = view.stations.iter().filter(|s| s.has_cell && s.paused.is_none() && !s.picking).count();
        fresh.idle_time = span * idle as i64;
        times.searches_us.iter().for_each(|us| fresh.searches.note(*us));
        fresh.robots = RobotTimes::of(view, span);
        fresh.step_max_us = times.step_us;
        for (tier, (step, most)) in self.tiers.iter_mut().zip(TIERS) {
            push(tier, Bucket { start: floor(now, step), ..fresh.clone() }, most);
        }
        let places: Vec<NodeId> = waiting().filter_map(|r| r.granted.first().copied()).collect();
        self.heat.note(now, span, &places);
    }

    /// Buckets of length `step` from `from` on and before `to`; buckets of which nothing is known are left out. The
    /// length is a multiple of the finest; the figures come from the finest buckets that go back so far.
    pub fn read(&self, from: Time, to: Time, step: Span) -> Vec<Bucket> {
        let mut found: BTreeMap<Time, Bucket> = BTreeMap::new();
        for bucket in &self.tiers[self.tier(from, step)] {
            let start = floor(bucket.start, step);
            if floor(from, step) <= start && start < to {
                let fresh = || Bucket { start, ..Bucket::default() };
                found.entry(start).or_insert_with(fresh).add(bucket);
            }
        }
        found.into_values().filter(|b| b.covered > Span::ZERO).collect()
    }

    /// Where robots waited, and for how long.
    pub fn heat(&self) -> &Heat {
        &self.heat
    }

    /// Buckets that changed since `saved`, with their lengths, to be stored.
    pub fn since(&self, saved: Time) -> Vec<(Span, Bucket)> {
        let tiers = self.tiers.iter().zip(TIERS);
        tiers
            .flat_map(|(tier, (step, _))| {
                let fresh = tier.iter().rev().take_while(move |b| b.start + step > saved);
                fresh.map(move |b| (step, b.clone()))
            })
            .collect()
    }

    /// From when on buckets of each length are kept: older ones need not be stored any longer.
    pub fn kept_from(now: Time) -> [(Span, Time); 3] {
        TIERS.map(|(step, most)| (step, now - step * most as i64))
    }

    /// The finest tier whose buckets fit the step and that goes back to `from`; else the coarsest that fits.
    fn tier(&self, from: Time, step: Span) -> usize {
        let fits = |i: &usize| step.0 % TIERS[*i].0.0 == 0;
        let reaches = |i: &usize| {
            let (own, most) = TIERS[*i];
            let last = self.last.map_or(Time::ZERO, |(at, _)| at);
            // A young history has everything in its finest tier.
            last - own * (most as i64) <= from || self.tiers[*i].len() < most && self.is_whole(*i)
        };
        let fitting = || (0..TIERS.len()).filter(fits);
        fitting().find(reaches).or_else(|| fitting().next_back()).unwrap_or(0)
    }

    /// Whether a tier goes back as far as coarser ones.
    fn is_whole(&self, i: usize) -> bool {
        let first = |t: &VecDeque<Bucket>| t.front().map(|b| b.start);
        let oldest = self.tiers.iter().filter_map(first).min();
        first(&self.tiers[i]).zip(oldest).is_some_and(|(own, oldest)| floor(own, TIERS[2].0) <= oldest)
    }

    fn forget_after(&mut self, now: Time) {
        for (tier, (step, _)) in self.tiers.iter_mut().zip(TIERS) {
            tier.retain(|b| b.start < floor(now, step));
        }
        self.heat.forget_after(now);
    }
}

/// Whether a robot stands and would drive on: others, people, closed areas or full queues hold it up.
pub fn waits(robot: &RobotView) -> bool {
    let kept = |why: Why| {
        why.station().is_some()
            || matches!(why, Why::WaitsFor(..) | Why::GivesWay(_) | Why::Closed(_) | Why::NoRoute)
    };
    robot.why.is_some_and(kept) && robot.speed_mps < STANDS_MPS
}

/// The beginning of the bucket that holds a time.
pub fn floor(t: Time, step: Span) -> Time {
    Time(t.0.div_euclid(step.0) * step.0)
}

/// Adds to the last bucket, or begins a new one; the oldest ones make room.
fn push(tier: &mut VecDeque<Bucket>, fresh: Bucket, most: usize) {
    match tier.back_mut() {
        Some(last) if last.start == fresh.start => last.add(&fresh),
        _ => tier.push_back(fresh),
    }
    while tier.len() > most {
        tier.pop_front();
    }
}

#[cfg(test)]
mod tests;
