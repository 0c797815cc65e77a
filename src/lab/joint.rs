//! The cost of planning one robot together with the few in its way, on a floor where all robots are at work.
//!
//! Main types: [`JointSetup`], [`JointOutcome`]; main function: [`run`]. Robots, radios and batteries are those of the
//! simulator; only [`Fleet::plan_jointly`] is timed. Refuses: to look at a clock itself; the caller passes a stopwatch
//! in.

use super::steps::{PER_STEP, StepsCase, requests};
use giveway_fleet::{Fleet, Settings};
use giveway_floor::id::RobotId;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_sim::{Scenario, World};
use std::sync::Arc;

/// Steps from one measured plan to the next: half a second, in which robots drive on.
const BETWEEN: usize = 10;
/// Jobs per robot, so that no robot runs out of them.
const JOBS: usize = 4;

/// Parameters of the measurement.
#[derive(Clone, Copy, Debug)]
pub struct JointSetup {
    /// Number of robots.
    pub robots: usize,
    /// Steps before anything is measured.
    pub settle: usize,
    /// Number of measured plans.
    pub plans: usize,
}

/// Measured durations.
#[derive(Clone, Debug, Default)]
pub struct JointOutcome {
    /// Durations of plans that found routes for all of their robots, nanoseconds, ascending.
    pub found_ns: Vec<u64>,
    /// Durations of plans that did not, nanoseconds, ascending.
    pub failed_ns: Vec<u64>,
}

/// Plans one robot after another together with those in its way. The new routes are driven, so the next plan meets a
/// changed floor.
///
/// # Panics
/// If its own scenario text is refused, which would be a bug here.
pub fn run(
    warehouse: &Arc<Warehouse>,
    setup: &JointSetup,
    stopwatch: fn() -> u64,
    mut progress: impl FnMut(usize),
) -> JointOutcome {
    let JointSetup { robots, settle, plans } = *setup;
    let text = format!(
        r#"{{"giveway_scenario": 1, "name": "joint", "map": "-", "robots": {robots}, "period_ms": 50}}"#
    );
    let scenario = Scenario::parse(&text).expect("the text is a scenario");
    let mut now = Time::ZERO;
    let mut fleet = Fleet::new(warehouse.clone(), Settings { stopwatch, ..scenario.site.settings() });
    let mut world = World::new(warehouse.clone(), &scenario, &[], 1, fleet.ledger(), now);
    let mut jobs = requests(warehouse, StepsCase::Waiting(JOBS * robots), now).into_iter();
    let mut out = JointOutcome::default();
    let mut measured = 0;
    for step in 0..settle + plans * BETWEEN {
        let mut inputs = world.advance(now, fleet.ledger());
        if step > 0 {
            inputs.extend(jobs.by_ref().take(PER_STEP));
        }
        let done = fleet.step(now, inputs);
        world.take(now, &done);
        if step >= settle && (step - settle).is_multiple_of(BETWEEN) {
            // Robots with neighbouring numbers start side by side: robots far apart take turns.
            let robot = RobotId((measured * 7919 % robots) as u32);
            let start = stopwatch();
            let is_found = fleet.plan_jointly(robot, now);
            let spent = stopwatch() - start;
            if is_found { &mut out.found_ns } else { &mut out.failed_ns }.push(spent);
            measured += 1;
            progress(measured);
        }
        now += Span::from_millis(50);
    }
    out.found_ns.sort_unstable();
    out.failed_ns.sort_unstable();
    out
}
