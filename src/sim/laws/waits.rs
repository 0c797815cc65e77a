//! The laws of waiting: no parties wait for one another for long, the fleet keeps no person in one spot, and no robot
//! waits for something that no longer keeps it.
//!
//! Main type: [`WaitLaws`]. It reads the fleet's own wait-for graph and compares it with the floor: a person is where
//! the simulation has the person. The published policies do not promise short waits, so they are measured but not held
//! to the laws. Refuses: to excuse a person's wait because it was interrupted; it adds up in one spot.

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

/// Circles of waiting and people in one spot, each with its beginning.
#[derive(Debug, Default)]
pub(super) struct WaitLaws {
    circles: BTreeMap<Party, Time>,
    kept: BTreeMap<WorkerId, KeptPerson>,
    /// How often people were kept in one spot for [`KEPT`]; a person who stays kept counts again.
    standstills: u64,
}

/// A person in one spot.
#[derive(Clone, Copy, Debug)]
struct KeptPerson {
    spot: Point,
    /// How much of the time there the fleet was the reason.
    waited: Span,
    /// When `waited` was last updated.
    looked: Time,
}

impl WaitLaws {
    /// How often people were kept in one spot for a minute, under any policy.
    pub fn standstills(&self) -> u64 {
        self.standstills
    }

    /// Continues the count of an earlier object.
    pub fn keep_count(&mut self, earlier: &WaitLaws) {
        self.standstills = earlier.standstills;
    }

    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        // Standstills are counted for every policy, but break a law only for ours.
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
            // The fleet cannot move what a person holds in place, or what is broken.
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
