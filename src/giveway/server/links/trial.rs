//! Tries out a map: the simulation of `giveway sim` on a submitted map, by default for half an hour.
//!
//! Main function: [`simulate`]. Refuses: to touch the server's fleet, and to run longer than allowed.

use giveway_api::{TrialFigures, TrialOrder, Trials};
use giveway_fleet::history::waits;
use giveway_fleet::{Fact, JobFact, JobState};
use giveway_floor::id::{JobId, NodeId};
use giveway_floor::time::{Span, Time};
use giveway_sim::{Demand, Scenario, Simulation};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Interval between checks of which robots wait.
const LOOK: Span = Span::from_secs(1);
/// The most violations of laws that are reported in words.
const TOLD: usize = 5;

/// Trials by [`simulate`].
pub fn trials() -> Trials {
    Trials::by(Arc::new(simulate))
}

/// Simulates an order to its end, or until its patience runs out.
///
/// # Errors
/// Why the map does not suit these robots.
pub fn simulate(order: TrialOrder) -> Result<TrialFigures, String> {
    let begun = Instant::now();
    let scenario = scenario(&order)?;
    scenario.site.fit(&order.map).map_err(|findings| findings.to_string())?;
    let mut sim = Simulation::new(order.map.clone(), &scenario, &[], order.seed, false, || 0);
    let (mut times, mut waited) = (TrialTimes::default(), BTreeMap::<NodeId, Span>::new());
    let mut look = Time::ZERO;
    while !sim.is_over() && begun.elapsed() < order.patience {
        let now = sim.now();
        times.note(sim.step().facts());
        if now >= look {
            look = now + LOOK;
            let robots = sim.fleet().view(now).robots;
            for node in robots.iter().filter(|r| waits(r)).filter_map(|r| r.granted.first()) {
                *waited.entry(*node).or_default() += LOOK;
            }
        }
    }
    let outcome = sim.outcome();
    Ok(TrialFigures {
        simulated: outcome.simulated,
        took: begun.elapsed(),
        deliveries: outcome.counts.robot_deliveries,
        mean_job: times.mean(),
        waited: waited.into_iter().collect(),
        law_violations: outcome.law_violations,
        broken: outcome.broken.into_iter().take(TOLD).collect(),
    })
}

/// The scenario of a trial, with default robots.
fn scenario(order: &TrialOrder) -> Result<Scenario, String> {
    let text = r#"{"giveway_scenario": 1, "name": "trial", "map": "", "robots": 0}"#;
    let plain = Scenario::parse(text).map_err(|e| e.to_string())?;
    let demand = order.jobs_per_hour.map_or(Demand::Backlog(2 * order.robots), Demand::PerHour);
    Ok(Scenario { robots: order.robots, duration: order.span, demand, seed: order.seed, ..plain })
}

/// How long jobs took.
#[derive(Default)]
struct TrialTimes {
    given: BTreeMap<JobId, Time>,
    sum: Span,
    count: i64,
}

impl TrialTimes {
    fn note(&mut self, facts: &[Fact]) {
        for fact in facts {
            let Fact::Job(JobFact::Progressed { job, state, at, .. }) = fact else { continue };
            match state {
                JobState::Assigned { .. } => _ = self.given.entry(*job).or_insert(*at),
                JobState::Waiting => _ = self.given.remove(job),
                JobState::Done => {
                    if let Some(given) = self.given.remove(job) {
                        self.sum += *at - given;
                        self.count += 1;
                    }
                }
                _ => {}
            }
        }
    }

    fn mean(&self) -> Option<Span> {
        (self.count > 0).then(|| Span(self.sum.0 / self.count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn order(robots: usize, patience: Duration) -> TrialOrder {
        let map = Arc::new(giveway_floor::warehouse::lab());
        TrialOrder { map, robots, jobs_per_hour: None, span: Span::from_secs(300), seed: 1, patience }
    }

    #[test]
    fn robots_deliver_wait_and_keep_the_laws_and_the_same_seed_gives_the_same() {
        let long = Duration::from_secs(600);
        let figures = simulate(order(2, long)).expect("the lab is for them");
        assert_eq!(figures.simulated, Span::from_secs(300));
        assert!(figures.deliveries > 3 && figures.law_violations == 0, "{figures:?}");
        let mean = figures.mean_job.expect("some were done");
        assert!(mean > Span::from_secs(10) && mean < Span::from_secs(200), "{mean:?}");
        let again = simulate(order(2, long)).expect("the lab is for them");
        assert_eq!((again.deliveries, again.waited), (figures.deliveries, figures.waited));
    }

    #[test]
    fn patience_ends_a_trial_with_what_happened_until_then() {
        let figures = simulate(order(2, Duration::ZERO)).expect("the lab is for them");
        assert_eq!((figures.simulated, figures.deliveries, figures.mean_job), (Span::ZERO, 0, None));
    }
}
