//! Robots that stay as they are while the fleet switches to another map: the floor is rebuilt, the robots are not.
//!
//! Refuses: to move a robot off the node on which the fleet has it.

use super::World;
use giveway_fleet::Ledger;

impl World {
    /// Robots keep the heading, charge and faults that they had on the previous floor. Each stands where the fleet has
    /// it.
    pub fn keep_robots_of(&mut self, before: &World) {
        for (robot, was) in self.robots.iter_mut().zip(&before.robots) {
            robot.body.stay_as(&was.body);
        }
    }

    /// Reports links again to a new process, which knows nothing of them.
    pub fn say_links_again(&mut self) {
        self.robots.iter_mut().for_each(|r| r.trouble.tell_again());
    }

    /// Prepares for another fleet. It may have forgotten robots that had just joined: they stand where they will join
    /// again.
    pub fn meet_another(&mut self, ledger: &Ledger) {
        self.robots.truncate(ledger.robots.len());
        self.customers.expect_no_answers();
    }
}
