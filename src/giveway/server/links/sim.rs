//! Robots, people and customers that this process simulates: the toys of a scenario, or the robots of a site.
//!
//! Main types: [`FloorSource`] (what the floor is, and what of it is simulated), [`SimulatedFloor`] (while it runs).
//! Refuses: to show the simulated floor anything of the fleet but what was promised, which any client can read, and
//! what was sent to it.

use giveway_drive::{Drive, GuardedCall, LinkOutput};
use giveway_fleet::{Input, Ledger};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Warehouse, room_for};
use giveway_sim::{OrderFileLine, Scenario, WarmUp, World, nothing_to_order, warm_up};
use giveway_site::Site;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// What a floor is, and what of it is simulated.
#[derive(Clone)]
pub struct FloorSource {
    /// The site, with toys: robots, customers, people, faults.
    pub scenario: Scenario,
    /// What the customers order, where the scenario names a file.
    pub lines: Vec<OrderFileLine>,
    /// Whether anything is simulated. Else no robot is, also none that is registered later.
    pub is_simulated: bool,
}

impl From<Scenario> for FloorSource {
    fn from(scenario: Scenario) -> FloorSource {
        FloorSource { scenario, lines: Vec::new(), is_simulated: true }
    }
}

impl From<Site> for FloorSource {
    fn from(site: Site) -> FloorSource {
        FloorSource { is_simulated: site.links.sim.is_some(), ..FloorSource::from(Scenario::from(site)) }
    }
}

impl FloorSource {
    /// That of a scenario's text.
    ///
    /// # Errors
    /// Where and what is wrong with it.
    #[cfg(test)]
    pub fn parse(text: &str) -> Result<FloorSource, giveway_site::SiteError> {
        Scenario::parse(text).map(FloorSource::from)
    }

    /// What the floor is.
    pub fn site(&self) -> &Site {
        &self.scenario.site
    }

    /// What the floor is, to be changed before it works.
    pub fn site_mut(&mut self) -> &mut Site {
        &mut self.scenario.site
    }

    /// How many robots are simulated from the beginning on.
    pub fn robots(&self) -> usize {
        self.scenario.robots
    }

    /// Why a map is not for what is simulated; nothing where it is.
    pub fn unfit(&self, map: &Arc<Warehouse>) -> Vec<String> {
        let room = room_for(map, self.scenario.robots).err();
        let room = room.into_iter().flat_map(|findings| findings.0).map(|finding| finding.to_string());
        let areas = self.scenario.areas(map, Time::ZERO).err();
        let recurring = self.scenario.recurring(map, Time::ZERO).err();
        room.chain(areas.into_iter().chain(recurring).map(|e| e.to_string())).collect()
    }

    /// Why simulated customers order nothing, though the scenario has some.
    pub fn idle(&self, map: &Warehouse) -> Option<&'static str> {
        nothing_to_order(&self.scenario, map)
    }

    /// Whether a floor that has no past yet begins in the middle of a shift.
    pub fn begins_in_the_middle(&self) -> bool {
        self.scenario.warm_up > Span::ZERO
    }

    /// What the floor did before this moment.
    pub fn past(&self, map: &Arc<Warehouse>, now: impl Fn() -> Time) -> WarmUp {
        warm_up(map, &self.scenario, &self.lines, now)
    }

    /// The simulated floor as a ledger has it, if anything is simulated.
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
    /// What the floor says. While the fleet cannot be looked at, what it makes of it may end in a panic.
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

    /// What leaves arrives on the floor.
    pub fn take(&mut self, now: Time, out: LinkOutput<'_>) {
        self.world.take(now, out);
    }

    /// Robots stay as they were on a floor before this one.
    pub fn keep_robots_of(&mut self, before: &SimulatedFloor) {
        self.world.keep_robots_of(&before.world);
    }

    /// The floor itself, for tests.
    #[cfg(test)]
    pub fn world(&self) -> &World {
        &self.world
    }
}
