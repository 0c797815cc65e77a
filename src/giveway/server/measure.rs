//! The loop's measurements of itself.
//!
//! Main type: [`Measure`]. Keeps the last minute of steps and ten minutes of deliveries. Refuses: to
//! influence anything.

use giveway_api::LoopFigures;
use giveway_floor::time::{Span, Time};
use std::collections::VecDeque;

/// How many steps the figures cover.
const STEPS: usize = 1200;

/// The time over which deliveries are counted.
const RECENT: Span = Span::from_secs(600);

/// How often the number of deliveries is noted.
const NOTED: Span = Span::from_secs(10);

/// Sliding figures.
#[derive(Debug, Default)]
pub struct Measure {
    steps: VecDeque<u64>,
    plans: VecDeque<u64>,
    deliveries: VecDeque<(Time, u64)>,
}

impl Measure {
    /// Notes a step of this duration, with the durations of its searches in nanoseconds.
    pub fn step(&mut self, length: Span, searches_ns: &[u64]) {
        push(&mut self.steps, length.0.unsigned_abs());
        searches_ns.iter().for_each(|ns| push(&mut self.plans, ns / 1000));
    }

    /// All figures; `deliveries` is the total so far.
    pub fn figures(&mut self, now: Time, deliveries: u64) -> LoopFigures {
        if self.deliveries.back().is_none_or(|(at, _)| now - *at >= NOTED) {
            self.deliveries.push_back((now, deliveries));
        }
        while self.deliveries.len() > 1 && self.deliveries.front().is_some_and(|(at, _)| now - *at > RECENT) {
            self.deliveries.pop_front();
        }
        let (since, before) = self.deliveries.front().copied().unwrap_or((now, deliveries));
        let hours = (now - since).as_secs_f64() / 3600.0;
        let per_hour = if hours > 0.0 { deliveries.saturating_sub(before) as f64 / hours } else { 0.0 };
        LoopFigures {
            deliveries_per_hour: per_hour,
            plan_us_p50: quantile(&self.plans, 50),
            plan_us_p99: quantile(&self.plans, 99),
            step_us_p99: quantile(&self.steps, 99),
        }
    }
}

fn push(ring: &mut VecDeque<u64>, item: u64) {
    if ring.len() == STEPS {
        ring.pop_front();
    }
    ring.push_back(item);
}

fn quantile(ring: &VecDeque<u64>, percent: usize) -> u64 {
    let mut sorted: Vec<_> = ring.iter().copied().collect();
    sorted.sort_unstable();
    sorted.get((sorted.len() * percent / 100).min(sorted.len().saturating_sub(1))).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_of_the_last_minutes() {
        let mut m = Measure::default();
        (1..=100).for_each(|us| m.step(Span(us), &[us as u64 * 2000]));
        m.figures(Time(0), 5);
        let figures = m.figures(Time(0) + Span::from_secs(60), 15);
        assert_eq!(figures.step_us_p99, 100);
        assert_eq!(figures.plan_us_p50, 102);
        assert!((figures.deliveries_per_hour - 600.0).abs() < 1e-9);
        let later = m.figures(Time(0) + Span::from_secs(700), 15);
        assert!(later.deliveries_per_hour.abs() < 1e-9, "the first ones are long ago");
    }
}
