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
                RobotSession::new(pair.session.version(), pair.settings.clone(), map.clone(), self.boot);
            pair.number = None;
            pair.to_robot.clear();
            pair.to_fleet.clear();
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

#[test]
fn messages_that_are_lost_doubled_late_and_overtaken_change_no_outcome() {
    for seed in 1..=12 {
        let setups = vec![standard(Version::V2_0), standard(Version::V2_1), standard(Version::V3_0)];
        let mut floor = LinkFloor::new(lab(), setups);
        floor.chance = Chance { state: seed, lost: 0.05, doubled: 0.1, late_ms: 400.0 };
        floor.all_joined();
        let jobs = floor.submit_deliveries(8);
        floor.until_done(&jobs, 3600);
    }
}
