//! Messages that are lost, a process that dies, robots that begin anew: every job is done once.

use super::*;

impl LinkFloor {
    /// The process dies and begins anew from the ledger; robots go on.
    fn restart(&mut self) {
        let (ledger, settings) = (self.fleet.ledger().clone(), self.fleet.settings().clone());
        self.fleet = Fleet::resume(ledger, settings, []);
        self.boot += 1;
        let map = self.map();
        for pair in &mut self.pairs {
            pair.session =
                RobotSession::new(pair.session.version(), super::settings(), map.clone(), self.boot);
            pair.number = None;
            pair.to_robot.clear();
        }
        self.picks.clear();
    }
}

#[test]
fn a_process_that_dies_again_and_again_knows_its_own_orders_and_no_job_is_done_twice() {
    for version in Version::ALL {
        let mut floor = LinkFloor::new(lab(), vec![standard(version), standard(version)]);
        floor.all_joined();
        let jobs = floor.submit_deliveries(6);
        for seconds in [3, 7, 12, 17, 23, 29, 8, 14] {
            floor.run(seconds);
            floor.restart();
        }
        floor.until_done(&jobs, 1800);
    }
}
