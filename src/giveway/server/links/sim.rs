//! Robots, people and customers that this process simulates: the toys of a scenario, or the robots of a site.
//!
//! Main types: [`FloorSource`] (the floor, and what of it is simulated), [`SimulatedFloor`] (while it runs). Refuses:
//! to show the simulated floor anything of the fleet except the ledger, which any client can read, and what was sent to
//! it.

use giveway_api::FloorSimulation;
use giveway_drive::{Drive, GuardedCall, LinkOutput};
use giveway_fleet::{Input, Ledger};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Warehouse, room_for};
use giveway_sim::{OrderFileLine, Scenario, WarmUp, World, nothing_to_order, warm_up};
use giveway_site::Site;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// The description of a floor, and what of it is simulated.
#[derive(Clone)]
pub struct FloorSource {
    /// The site, with toys: robots, customers, people, faults.
    pub scenario: Scenario,
    /// The order lines of the customers, if the scenario names a file.
    pub lines: Vec<OrderFileLine>,
    /// Whether anything is simulated. If not, no robot is, not even one that is registered later.
    pub is_simulated: bool,
    /// How many times as fast as the system's clock the floor's clock goes: more than 1 only where everything is
    /// simulated.
    pub speed: u32,
}

impl From<Scenario> for FloorSource {
    fn from(scenario: Scenario) -> FloorSource {
        FloorSource { scenario, lines: Vec::new(), is_simulated: true, speed: 1 }
    }
}

impl From<Site> for FloorSource {
    fn from(site: Site) -> FloorSource {
        FloorSource { is_simulated: site.links.sim.is_some(), ..FloorSource::from(Scenario::from(site)) }
    }
}

impl FloorSource {
    /// The floor of a scenario's text.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    #[cfg(test)]
    pub fn parse(text: &str) -> Result<FloorSource, giveway_site::SiteError> {
        Scenario::parse(text).map(FloorSource::from)
    }

    /// The site.
    pub fn site(&self) -> &Site {
        &self.scenario.site
    }

    /// The simulation, if there are no links to real robots.
    pub fn simulation(&self) -> Option<FloorSimulation> {
        (self.is_simulated && self.site().links.mqtt.is_none())
            .then_some(FloorSimulation { speed: self.speed })
    }

    /// The site, to be changed before the floor runs.
    pub fn site_mut(&mut self) -> &mut Site {
        &mut self.scenario.site
    }

    /// How many robots are simulated from the start.
    pub fn robots(&self) -> usize {
        self.scenario.robots
    }

    /// Why a map does not suit what is simulated; empty if it does.
    pub fn unfit(&self, map: &Arc<Warehouse>) -> Vec<String> {
        let room = room_for(map, self.scenario.robots).err();
        let room = room.into_iter().flat_map(|findings| findings.0).map(|finding| finding.to_string());
        let areas = self.scenario.areas(map, Time::ZERO).err();
        let recurring = self.scenario.recurring(map, Time::ZERO).err();
        room.chain(areas.into_iter().chain(recurring).map(|e| e.to_string())).collect()
    }

    /// Why simulated customers order nothing, although the scenario has some.
    pub fn idle(&self, map: &Warehouse) -> Option<&'static str> {
        nothing_to_order(&self.scenario, map)
    }

    /// Whether a floor without a history begins in the middle of a shift.
    pub fn begins_in_the_middle(&self) -> bool {
        self.scenario.warm_up > Span::ZERO
    }

    /// The simulated history of the floor before this moment.
    pub fn past(&self, map: &Arc<Warehouse>, now: impl Fn() -> Time) -> WarmUp {
        warm_up(map, &self.scenario, &self.lines, now)
    }

    /// The simulated floor in the state of a ledger, if anything is simulated.
    pub fn begin(&self, map: Arc<Warehouse>, ledger: &Ledger, now: Time) -> Option<SimulatedFloor> {
        let world = || World::new(map, &self.scenario, &self.lines, self.scenario.seed, ledger, now);
        self.is_simulated.then(|| SimulatedFloor { world: world() })
    }
}

/// The simulated floor while it runs.
pub struct SimulatedFloor {
    world: World,
}

impl SimulatedFloor {
    /// The messages of the floor. While the fleet decides nothing, the floor's reaction to the ledger may panic; the
    /// panic is caught.
    pub fn hear(&mut self, now: Time, drive: &mut Drive) -> Vec<Input> {
        let world = &mut self.world;
        let passing = world.robots_beside();
        if !passing.is_empty() {
            let near = drive.ask(GuardedCall::Query, now, |fleet| fleet.people_near(&passing, now));
            world.foretell(near.unwrap_or_default());
        }
        let ledger = drive.fleet().ledger();
        if drive.decides() {
            return world.advance(now, ledger);
        }
        catch_unwind(AssertUnwindSafe(|| world.advance(now, ledger))).unwrap_or_default()
    }

    /// Delivers output to the floor.
    pub fn take(&mut self, now: Time, out: LinkOutput<'_>) {
        self.world.take(now, out);
    }

    /// Keeps the robots as they were on the previous floor.
    pub fn keep_robots_of(&mut self, before: &SimulatedFloor) {
        self.world.keep_robots_of(&before.world);
    }

    /// The floor itself, for tests.
    #[cfg(test)]
    pub fn world(&self) -> &World {
        &self.world
    }
}
