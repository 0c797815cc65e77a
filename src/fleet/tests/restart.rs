//! Restarts: the ledger is what its facts say, and a fleet that has seen nothing goes on from the ledger.

use super::*;

impl TestFloor {
    /// Restarts from the facts and the floor alone: robots stand where the ledger has them.
    pub(super) fn restart(&mut self, scenario: &Scenario) {
        let warehouse = self.fleet.warehouse().clone();
        self.fleet = Fleet::restore(warehouse.clone(), scenario.site.settings(), self.facts.clone());
        self.world = World::new(warehouse, scenario, &[], scenario.seed, self.fleet.ledger(), self.now);
    }

    #[track_caller]
    pub(super) fn assert_fold(&self) {
        let (warehouse, settings) = (self.fleet.warehouse().clone(), self.fleet.settings().clone());
        let restored = Fleet::restore(warehouse, settings, self.facts.clone());
        let fold = restored.internals().writer.ledger();
        let live = self.fleet.ledger();
        assert!(fold == live, "the ledger is not the fold of its facts at {}", self.now);
    }
}

#[test]
fn the_ledger_is_the_fold_of_its_facts_at_any_step_of_a_busy_run() {
    let faults = Faults { failures_per_hour: 40.0, repair_s: 30.0, message_loss: 0.1, ..Faults::default() };
    let mut floor =
        TestFloor::new(thesis(), &Scenario { faults, demand: Demand::Backlog(12), ..scenario(8) });
    let mut pause = 1;
    while floor.now < Time::from_secs_f64(300.0) {
        for _ in 0..pause {
            floor.step(vec![]);
        }
        floor.assert_fold();
        pause = pause * 29 % 211;
    }
    assert!(floor.done() > 10, "it was busy: {} jobs done", floor.done());
    assert!(
        floor.facts.iter().any(|f| matches!(f, Fact::Route(RouteFact::Truncated { .. }))),
        "robots failed"
    );
}

#[test]
fn a_restarted_fleet_does_every_job_once_however_often_it_is_restarted() {
    let scenario = scenario(6);
    let mut floor = TestFloor::new(thesis(), &scenario);
    let jobs = floor.submit_batch(20);
    let mut restarts = 0;
    for pause_s in [3, 9, 14, 23, 11, 37, 5, 41, 19, 60] {
        floor.run(pause_s);
        if !floor.fleet.ledger().jobs.is_empty() {
            floor.restart(&scenario);
            floor.assert_fold();
            restarts += 1;
        }
    }
    floor.until_over(2000);
    floor.assert_done_once(&jobs);
    assert!(restarts >= 5, "only {restarts} restarts");
}

#[test]
fn a_restarted_fleet_knows_the_keys_of_jobs_that_are_over() {
    let scenario = scenario(1);
    let mut floor = TestFloor::new(lab(), &scenario);
    let keyed = JobRequest { key: Some("order 1".into()), ..request(deliver(3)) };
    let job = floor.submit(keyed.clone());
    floor.until_over(300);
    floor.restart(&scenario);
    assert_eq!(floor.ask(keyed), Ok(Answer::Job(Made { id: job, new: false })));
    floor.until(300, "the rack is put away", TestFloor::first_robot_is_idle);
    floor.assert_stored(3);
}

#[test]
fn a_restarted_fleet_that_hears_nothing_commands_nothing() {
    let mut floor = TestFloor::thesis(4);
    floor.submit_batch(8);
    floor.run(20);
    let (warehouse, settings) = (floor.fleet.warehouse().clone(), floor.fleet.settings().clone());
    let mut deaf = Fleet::restore(warehouse, settings, floor.facts.clone());
    for i in 0..100 {
        let step = deaf.step(floor.now + Span::from_millis(100 * i), vec![]);
        assert_eq!(step, Step::default());
    }
    let heard = floor.facts.len();
    floor.run(10);
    assert!(floor.facts.len() > heard, "the one that hears goes on");
}
