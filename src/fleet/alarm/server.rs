//! What is wrong with the server's own work: steps that are late, robots that wait for a search, forecasts that do not
//! come true, a clock that is off.
//!
//! Main types: [`StepRecord`] (how long steps took lately), [`LoopHealth`] (what the server measured). Refuses: to
//! measure anything.

use super::condition::{AlarmCondition, some_of};
use super::kind::{AlarmKind, AlarmSeverity};
use crate::{Fleet, View};
use giveway_floor::id::RobotId;
use giveway_floor::text::sentence::alarms;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, VecDeque};

/// How far back steps are looked at.
const RECENT: Span = Span::from_secs(10);
/// If at least one step in this many is late, the processor is too slow.
const LATE_ONE_IN: usize = 5;
/// How long the search of a robot's route may be put off.
const UNSEARCHED: Span = Span::from_secs(30);
/// By how much the clocks may differ.
const CLOCKS: Span = Span::from_secs(60);

/// How long the steps of the last seconds took.
#[derive(Clone, Debug, Default)]
pub struct StepRecord {
    steps: VecDeque<(Time, bool)>,
}

impl StepRecord {
    /// Notes a step, and whether it took longer than the control period.
    pub fn note(&mut self, at: Time, late: bool) {
        self.steps.push_back((at, late));
        while self.steps.front().is_some_and(|(first, _)| at - *first > RECENT) {
            self.steps.pop_front();
        }
    }

    /// The share of steps that were late, percent.
    fn late_percent(&self) -> usize {
        let late = self.steps.iter().filter(|(_, late)| *late).count();
        late * 100 / self.steps.len().max(1)
    }
}

/// What the server measured of its own work.
#[derive(Clone, Debug, Default)]
pub struct LoopHealth {
    /// The control period.
    pub period: Span,
    /// Recent steps.
    pub steps: StepRecord,
    /// How far the system's clock is ahead of the server's.
    pub clock_ahead: Span,
}

/// What is wrong with the server's own work.
pub(super) fn conditions(
    fleet: &Fleet,
    view: &View,
    health: &LoopHealth,
    robots: &BTreeMap<RobotId, AlarmCondition>,
) -> Vec<AlarmCondition> {
    let mut found = Vec::new();
    let late = health.steps.late_percent();
    if late * LATE_ONE_IN >= 100 {
        let period = health.period.0 / 1000;
        let said = alarms::steps_late(period, late);
        found.push(AlarmCondition::of_server(AlarmKind::StepsLate, said));
    }
    // A robot with a cause of its own is not held up by the processor.
    let mut queue = fleet.plan_queue(view.now);
    queue.retain(|(robot, _)| !robots.contains_key(robot));
    if queue.first().is_some_and(|(_, waited)| *waited > UNSEARCHED) {
        let names: Vec<String> = queue.iter().map(|(r, _)| fleet.ledger().robots[*r].name.clone()).collect();
        let said = alarms::plan_backlog(some_of(&names));
        let one = AlarmCondition::of_server(AlarmKind::PlanBacklog, said);
        found.push(AlarmCondition { waiting: queue.len(), ..one });
    }
    let horizon = |seconds: f64, covered: f64| {
        let (seconds, percent) = (SentenceArg::rounded(seconds, 1), SentenceArg::rounded(covered * 100.0, 0));
        alarms::forecast_horizon(seconds, percent)
    };
    let untrusted: Vec<Sentence> = view
        .forecast_coverage
        .iter()
        .filter(|f| !f.trusted)
        .map(|f| horizon(f.horizon_s, f.covered))
        .collect();
    if !untrusted.is_empty() {
        let said = alarms::forecasts_fail(some_of(&untrusted));
        found.push(AlarmCondition::of_server(AlarmKind::ForecastBad, said));
    }
    found.extend(clock(health.clock_ahead));
    found
}

fn clock(ahead: Span) -> Option<AlarmCondition> {
    let off = Span(ahead.0.abs());
    let seconds = off.0 / 1_000_000;
    let said = match ahead > Span::ZERO {
        true => alarms::clock_ahead(seconds),
        false => alarms::clock_behind(seconds),
    };
    let one = AlarmCondition::of_server(AlarmKind::ClockOff, said).at_least(AlarmSeverity::Warning);
    (off > CLOCKS).then_some(one)
}
