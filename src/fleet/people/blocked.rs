//! Walkways on which nobody is led: robots block them for long, or they are in a closed area.
//!
//! Refuses: to cut what a robot leaves by itself.

use crate::fleet::people::state::HumanState;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::yielding::{STANDS, YieldingState};
use crate::time::Time;
use crate::warehouse::walkway::EdgeSet;

impl HumanState {
    /// Walkways that robots block for long, and those in areas that are closed to people.
    pub(super) fn edges_blocked_for_long(
        &self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        now: Time,
    ) -> EdgeSet {
        let mut cut = self.edges_robots_block(floor, yielding, now);
        self.barred.cut_shut(&self.walkways, &mut cut, now);
        cut
    }

    /// Walkways on which robots rest, are broken, or have yielded for long: no worker waits for those to go away. One
    /// that yields and has nowhere to go would be met again and again, by a worker who is led from one to the next.
    pub(super) fn edges_robots_block(
        &self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        now: Time,
    ) -> EdgeSet {
        let mut cut = self.walkways.no_edges();
        for robot in floor.ledger.present() {
            let chain = floor.ledger.chain(robot);
            let rests = chain.first() + 1 == chain.end();
            let stays = yielding.of(robot).waited(now) > STANDS && floor.stands(robot);
            if rests || stays || floor.ledger.robots[robot].failed {
                let at = floor.place_of(robot);
                for e in self.walkways.edges_within(at, floor.beside_m(robot, 0.2)) {
                    cut.insert(e);
                }
            }
        }
        cut
    }
}
