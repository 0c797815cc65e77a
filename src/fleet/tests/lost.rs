//! Workers whose place is not known: through restarts, by a supervisor's word, and by goodbyes.

use super::people::Puppet;
use super::*;
use giveway_people::human::Presence;

impl TestFloor {
    fn presence(&self, puppet: &Puppet) -> Presence {
        let view = self.fleet.view(self.now);
        view.workers.get(puppet.worker.ix()).map_or(Presence::Absent, |w| w.presence)
    }

    /// The fleet dies and comes back with its facts after this many seconds.
    fn come_back(&mut self, seconds: i64) {
        let (map, settings) = (self.fleet.warehouse().clone(), self.fleet.settings().clone());
        self.fleet = Fleet::restore(map, settings, self.facts.iter().cloned());
        self.now += Span::from_secs(seconds);
    }

    fn node_at(&self, number: usize) -> giveway_floor::geometry::Point {
        self.fleet.warehouse().nodes.iter().nth(number).expect("the hall has it").at
    }
}

#[test]
fn a_worker_on_the_floor_is_lost_after_a_restart_until_seen_or_cleared_and_not_forgotten() {
    let mut floor = TestFloor::thesis(6);
    floor.submit_batch(40);
    let mut ana = floor.hire(floor.node_at(100));
    floor.walk(&mut ana);
    floor.come_back(20);
    floor.run(10);
    assert_eq!(floor.presence(&ana), Presence::Lost, "her headset died with the server");
    let area = floor.fleet.view(floor.now).workers[ana.worker.ix()].area.clone();
    let moves = |n: &NodeId| {
        let ledger = floor.fleet.ledger();
        floor.world.truth().any(|(r, t)| t.speed_mps > 0.0 && ledger.node_of(r) == *n)
    };
    assert!(area.len() > 10 && !area.iter().any(moves), "robots stand where she may be: {area:?}");
    floor.walk(&mut ana);
    assert_eq!(floor.presence(&ana), Presence::Tracked);
    floor.come_back(20);
    floor.step(vec![Input::ask(4, WorkerAction::Clear { worker: ana.worker, by: "Ben".into() })]);
    assert_eq!(floor.presence(&ana), Presence::Absent);
    floor.come_back(20);
    assert_eq!(floor.presence(&ana), Presence::Absent, "that she left is a fact, too");
    assert!(
        floor
            .facts
            .iter()
            .any(|f| matches!(f, Fact::Worker(WorkerFact::Cleared { by: Some(by), .. }) if by == "Ben"))
    );
}

#[test]
fn a_worker_is_noted_every_few_metres_and_where_lost_and_no_oftener() {
    let mut floor = TestFloor::thesis(1);
    let mut ana = floor.hire(floor.node_at(100));
    (0..50).for_each(|_| _ = floor.walk(&mut ana));
    let noted = |floor: &TestFloor| {
        floor.facts.iter().filter(|f| matches!(f, Fact::Worker(WorkerFact::Noted { .. }))).count()
    };
    assert_eq!(noted(&floor), 1, "she stands");
    ana.at.x += 0.6;
    floor.walk(&mut ana);
    assert_eq!(noted(&floor), 1, "that is near");
    floor.run(60);
    assert_eq!((floor.presence(&ana), noted(&floor)), (Presence::Lost, 2), "where she was lost, once");
}

#[test]
fn poses_that_were_on_their_way_do_not_bring_back_who_was_cleared_and_later_ones_do() {
    let mut floor = TestFloor::thesis(1);
    let mut ana = floor.hire(floor.node_at(100));
    floor.walk(&mut ana);
    let on_its_way = ana.sighting(floor.now);
    floor.step(vec![Input::ask(4, WorkerAction::Clear { worker: ana.worker, by: "Ben".into() })]);
    floor.step(vec![on_its_way]);
    assert_eq!(floor.presence(&ana), Presence::Absent);
    floor.run(1);
    floor.walk(&mut ana);
    assert_eq!(floor.presence(&ana), Presence::Tracked, "she is there after all");
}

#[test]
fn a_supervisor_narrows_where_a_lost_worker_may_be_until_she_is_seen_again() {
    let mut floor = TestFloor::thesis(6);
    let mut ana = floor.hire(floor.node_at(100));
    floor.walk(&mut ana);
    let at: giveway_floor::geometry::Spot = ana.at.into();
    let narrow = |within_mm| {
        Input::ask(5, WorkerAction::Narrow { worker: ana.worker, by: "Ben".into(), at, within_mm })
    };
    let refused = |floor: &mut TestFloor, input| match floor.step(vec![input]).replies.pop().map(|r| r.answer)
    {
        Some(Err(why)) => Some(why),
        _ => None,
    };
    assert_eq!(refused(&mut floor, narrow(1500)), Some(Refusal::Worker(WorkerRefusal::NotLost(ana.worker))));
    floor.run(30);
    let area = |floor: &TestFloor| floor.fleet.view(floor.now).workers[ana.worker.ix()].area.len();
    let before = area(&floor);
    for wrong in [0, 100, 9000] {
        assert_eq!(
            refused(&mut floor, narrow(wrong)),
            Some(Refusal::Worker(WorkerRefusal::NoPlaceForPeople)),
            "{wrong}"
        );
    }
    assert_eq!(refused(&mut floor, narrow(1500)), None);
    let after = area(&floor);
    assert!(after > 0 && after * 3 < before, "{after} of {before}");
    floor.run(60);
    assert_eq!(area(&floor), after, "it does not grow again: somebody vouches for it");
    floor.come_back(5);
    assert_eq!(area(&floor), after, "after a restart, too");
    floor.walk(&mut ana);
    assert_eq!(floor.presence(&ana), Presence::Tracked);
}

#[test]
fn who_takes_the_headset_off_at_a_door_has_left_and_elsewhere_is_lost_at_once() {
    let mut floor = TestFloor::thesis(1);
    let map = floor.fleet.warehouse().clone();
    let doors = map.nodes_where(|kind| kind == NodeKind::Exit);
    let door = map.nodes[doors[0]].at;
    let far =
        |n: &&giveway_floor::warehouse::Node| doors.iter().all(|d| (map.nodes[*d].at - n.at).norm() > 5.0);
    let inside = map.nodes.iter().find(far).expect("the hall is larger").at;
    for (place, presence) in [(door, Presence::Absent), (inside, Presence::Lost)] {
        let mut ana = floor.hire_as(&format!("{presence:?}"), place);
        floor.walk(&mut ana);
        let last = ana.sighting(floor.now);
        // The goodbye may come before the last poses.
        floor.step(vec![Input::ask(6, WorkerAction::SignOff(ana.worker)), last]);
        assert_eq!(floor.presence(&ana), presence);
    }
}
