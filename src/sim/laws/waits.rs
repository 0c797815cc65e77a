//! The laws of waiting: none wait for one another for long, no person is kept in one spot by the fleet, and nothing
//! waits for what does not keep it.
//!
//! Main type: [`WaitLaws`]. They read the fleet's own wait-for graph, and compare it with the floor: a person is where
//! the simulation has the person. The published policies do not promise that nothing waits for long, and are measured
//! instead of held to it. Refuses: to excuse a person's wait because it was interrupted; it adds up in one spot.

use super::violation::{CIRCLE, KEPT, Violation};
use crate::world::World;
use giveway_fleet::{ChainEnd, Edge, Fleet, Party, untrue};
use giveway_floor::geometry::Point;
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use giveway_people::aware::HumanAwarePolicy;
use std::collections::BTreeMap;

/// A person within this is in the same spot, metres.
const SPOT_M: f64 = 0.75;

/// Circles of waiting and people in one spot, with since when.
#[derive(Debug, Default)]
pub(super) struct WaitLaws {
    circles: BTreeMap<Party, Time>,
    kept: BTreeMap<WorkerId, KeptPerson>,
    /// How often people were kept in one spot for [`KEPT`]; one who is kept on counts again.
    standstills: u64,
}

/// A person in one spot.
#[derive(Clone, Copy, Debug)]
struct KeptPerson {
    spot: Point,
    /// For how long of the time there the fleet was the reason.
    waited: Span,
    /// When that was looked at last.
    looked: Time,
}

impl WaitLaws {
    /// How often people were kept in one spot for a minute, by whatever policy.
    pub fn standstills(&self) -> u64 {
        self.standstills
    }

    /// Goes on counting where an earlier one ended.
    pub fn keep_count(&mut self, earlier: &WaitLaws) {
        self.standstills = earlier.standstills;
    }

    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        // Standstills of people are counted for every policy, and are a broken law for ours alone.
        let kept = self.look_at_people(now, world, fleet);
        let mut broken = Vec::new();
        if fleet.settings().policy == HumanAwarePolicy::Giveway {
            broken = kept;
            self.look_at_circles(now, fleet, &mut broken);
        }
        let robots = fleet.ledger().present();
        broken.extend(robots.filter_map(|r| Some(Violation::NotSo(r, untrue(fleet, r, now)?))));
        broken
    }

    fn look_at_circles(&mut self, now: Time, fleet: &Fleet, broken: &mut Vec<Violation>) {
        let standstills = fleet.standstills();
        let circle = |end: &ChainEnd| if let ChainEnd::Cycle(first) = end { Some(*first) } else { None };
        let there: BTreeMap<Party, &Vec<Party>> =
            standstills.iter().filter_map(|s| Some((circle(&s.end)?, &s.root))).collect();
        self.circles.retain(|first, _| there.contains_key(first));
        for (first, parties) in there {
            let since = self.circles.entry(first).or_insert(now);
            if now - *since > CIRCLE {
                *since = now;
                broken.push(Violation::Circle(parties.clone()));
            }
        }
    }

    fn look_at_people(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        let mut broken = Vec::new();
        for (worker, walker) in world.walkers().filter(|(_, w)| !w.is_gone()) {
            let at = walker.pose(now).at;
            let fresh = KeptPerson { spot: at, waited: Span::ZERO, looked: now };
            let kept = self.kept.entry(worker).or_insert(fresh);
            if (kept.spot - at).norm() > SPOT_M {
                *kept = fresh;
            }
            let wait = fleet.wait(Party::Worker(worker));
            let because = wait.edge;
            // What stands by a person's hand, or is broken, the fleet cannot move.
            if matches!(because, Edge::On(_) | Edge::NoWay | Edge::Until(_)) && !wait.is_for_an_operator() {
                kept.waited += now - kept.looked;
            }
            kept.looked = now;
            if kept.waited > KEPT {
                *kept = fresh;
                self.standstills += 1;
                broken.push(Violation::Kept(worker, because));
            }
        }
        broken
    }
}
