//! A floor that has worked for a while: the initial state of a server that shows the middle of a shift.
//!
//! Main function: [`warm_up`]. It gives a past like any other: facts, which a journal takes, and figures. Refuses: laws
//! and measurements, which are for the simulation.

use crate::customers::OrderFileLine;
use crate::scenario::Scenario;
use crate::world::World;
use giveway_fleet::history::{History, LoopTimes};
use giveway_fleet::{Fact, Fleet};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use std::sync::Arc;

/// Interval between two entries of the figures.
const LOOK: Span = Span::from_secs(1);

/// The past of a floor before a server began.
pub struct WarmUp {
    /// The facts of each step that had some, with its time.
    pub steps: Vec<(Time, Vec<Fact>)>,
    /// Figures over time.
    pub history: History,
}

/// Lets a new floor work for the scenario's `warm_up_s`, up to now. It also simulates the time that the warm-up itself
/// takes; otherwise people would be lost for as long when the server begins.
pub fn warm_up(
    map: &Arc<Warehouse>,
    scenario: &Scenario,
    lines: &[OrderFileLine],
    until: impl Fn() -> Time,
) -> WarmUp {
    let mut now = until() - scenario.warm_up;
    // A machine slower than the floor itself would never catch up.
    let last = now + scenario.warm_up + scenario.warm_up;
    let mut fleet = Fleet::new(map.clone(), scenario.site.settings());
    let mut world = World::new(map.clone(), scenario, lines, scenario.seed, fleet.ledger(), now);
    let mut out = WarmUp { steps: Vec::new(), history: History::default() };
    let mut looked = now - LOOK;
    while now < until().min(last) {
        world.foretell(fleet.people_near(&world.robots_beside(), world.now()));
        let inputs = world.advance(now, fleet.ledger());
        let step = fleet.step(now, inputs);
        world.take(now, &step);
        if !step.facts.is_empty() {
            out.steps.push((now, step.facts));
        }
        if now - looked >= LOOK {
            looked = now;
            out.history.note(&fleet.view(now), &LoopTimes::default());
        }
        now += scenario.site.period;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::Ledger;
    use giveway_floor::warehouse::thesis;

    #[test]
    fn a_floor_that_has_worked_has_people_deliveries_and_figures_and_its_facts_are_all_that_is_needed() {
        let text = include_str!("../../../scenarios/first.json");
        let scenario = Scenario::parse(text).expect("it is read");
        let scenario = Scenario { warm_up: Span::from_secs(300), ..scenario };
        let (map, until) = (Arc::new(thesis()), Time(1_800_000_000_000_000));
        let past = warm_up(&map, &scenario, &[], || until);
        let mut ledger = Ledger::new(map, &scenario.site.kinds, false);
        past.steps.iter().flat_map(|(_, facts)| facts).for_each(|fact| ledger.evolve(fact));
        assert!(ledger.counts.robot_deliveries >= 10, "{:?}", ledger.counts);
        assert_eq!(ledger.workers.len(), scenario.workers.count);
        assert!(
            past.steps.windows(2).all(|pair| pair[0].0 < pair[1].0)
                && past.steps[0].0 >= until - scenario.warm_up
        );
        let buckets = past.history.read(until - scenario.warm_up, until, Span::from_secs(10));
        assert!(buckets.len() >= 29, "{} buckets", buckets.len());
        assert!(buckets.iter().map(|b| b.worker_time.0).sum::<i64>() > 0, "people are on the floor");
    }
}
