//! A simulated floor whose steps a test writes into a store, or not.

use giveway::fleet::{Fleet, Input, JobKind, JobRequest, Ledger, Step};
use giveway::id::{RackId, StationId};
use giveway::sim::{Scenario, World};
use giveway::store::{SNAPSHOT_AFTER, StepEntry, Store};
use giveway::time::{Span, Time};
use giveway::warehouse::Warehouse;
use std::sync::Arc;

/// A fleet on a simulated floor.
pub struct Run {
    pub fleet: Fleet,
    pub world: World,
    pub now: Time,
    period: Span,
}

/// A ledger of a map in which nothing is promised.
pub fn nothing(map: &Arc<Warehouse>, scenario: &Scenario) -> Ledger {
    Ledger::new(map.clone(), &scenario.site.kinds, false)
}

/// A delivery with a key, or without.
pub fn deliver(rack: u32, key: Option<&str>) -> JobRequest {
    let kind = JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick: None };
    JobRequest { priority: 5, key: key.map(Into::into), ..JobRequest::new(kind) }
}

impl Run {
    /// From a fleet that knows what was promised, with robots where its ledger has them.
    pub fn new(map: &Arc<Warehouse>, scenario: &Scenario, fleet: Fleet, now: Time) -> Run {
        let world = World::new(map.clone(), scenario, &[], scenario.seed, fleet.ledger(), now);
        Run { fleet, world, now, period: scenario.site.period }
    }

    /// From what a store has.
    pub async fn restart(map: &Arc<Warehouse>, scenario: &Scenario, store: &Store) -> Run {
        let loaded = store.load(nothing(map, scenario)).await.unwrap();
        let now = loaded.last.unwrap_or(Time::ZERO) + scenario.site.period;
        let (ledger, facts) = loaded.into_parts();
        Run::new(map, scenario, Fleet::resume(ledger, scenario.site.settings(), facts), now)
    }

    /// One control period, with `extra` inputs. Gives what is to be written, and what came of it.
    pub fn step(&mut self, extra: Vec<Input>) -> (StepEntry, Step) {
        let mut inputs = self.world.advance(self.now, self.fleet.ledger());
        inputs.extend(extra);
        let step = self.fleet.step(self.now, inputs);
        self.world.take(self.now, &step);
        let entry = StepEntry { at: self.now, facts: step.facts.clone(), causes: Vec::new() };
        self.now += self.period;
        (entry, step)
    }
}

/// Writes into a store as the server's journal does: steps, and a snapshot after so many facts.
pub struct Keeper {
    pub store: Store,
    pub next: i64,
    pub behind: usize,
    /// How many snapshots it made.
    pub made: usize,
    shadow: Ledger,
}

impl Keeper {
    pub fn new(store: Store, empty: Ledger) -> Keeper {
        Keeper { store, next: 1, behind: 0, made: 0, shadow: empty }
    }

    /// Appends steps; gives how many snapshots it made.
    pub async fn append(&mut self, steps: &[StepEntry]) -> usize {
        self.store.append(self.next, steps).await.unwrap();
        self.next += steps.len() as i64;
        for fact in steps.iter().flat_map(|s| &s.facts) {
            self.shadow.evolve(fact);
            self.behind += 1;
        }
        if self.behind < SNAPSHOT_AFTER {
            return 0;
        }
        self.snapshot(steps.last().unwrap().at).await;
        1
    }

    pub async fn snapshot(&mut self, at: Time) {
        self.store.snapshot(self.next - 1, at, self.shadow.to_parts()).await.unwrap();
        self.behind = 0;
        self.made += 1;
    }
}
