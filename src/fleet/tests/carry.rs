//! A ledger under a changed map: what can be carried over is, the rest is listed, and the floor goes on.

use super::*;
use giveway_fleet::carry::{Carried, carry};
use giveway_floor::geometry::Spot;
use giveway_floor::id::AssignmentId;
use giveway_floor::time::Window;
use giveway_floor::warehouse::{Draft, DraftRack, Footprint, formats::json, mixed};
use std::collections::BTreeSet;

fn habits() -> Habits {
    let every = Habits { put_back: 0.5, relocate: 0.5, charge: 0.2, park: 0.3, go: 0.5, ..Habits::default() };
    Habits { priority: 0.3, deadline: 0.2, ..every }
}

fn busy(robots: usize, seed: u64) -> Scenario {
    Scenario { demand: Demand::Backlog(robots * 2), customers: habits(), seed, ..scenario(robots) }
}

/// A map that was changed by hand.
fn changed(map: &Warehouse, change: impl FnOnce(&mut Draft)) -> Warehouse {
    let mut draft = json::parse_draft(&json::write(map)).expect("what was written is read");
    change(&mut draft);
    draft.build().expect("well-formed")
}

/// The same floor, with all numbers changed.
fn permuted(map: &Warehouse) -> Warehouse {
    changed(map, |draft| {
        draft.nodes.reverse();
        draft.lanes.reverse();
        draft.stations.reverse();
        draft.racks.reverse();
    })
}

/// `lab` with a storage node on which no rack stands.
fn roomy() -> Warehouse {
    changed(&lab(), |draft| drop(draft.racks.pop()))
}

fn remove_rack(draft: &mut Draft, name: &str) {
    draft.racks.retain(|rack| rack.name != name);
}

impl TestFloor {
    fn carried(&self, map: &Warehouse) -> Carried {
        carry(self.fleet.ledger(), map, self.now)
    }

    /// The floor under another map: robots stand where the ledger has them.
    fn under(&self, map: Warehouse, scenario: &Scenario) -> TestFloor {
        let map = Arc::new(map);
        let parts = self.carried(&map).parts.expect("nothing is in the way");
        let ledger =
            Ledger::from_parts(map.clone(), &scenario.site.kinds, parts).expect("it contradicts nothing");
        ledger.assert_sound();
        let fleet = Fleet::resume(ledger, scenario.site.settings(), []);
        let world = World::new(map, scenario, &[], scenario.seed, fleet.ledger(), self.now);
        TestFloor { laws: Laws::new(&fleet), fleet, world, now: self.now, facts: Vec::new() }
    }

    fn name_of(&self, node: NodeId) -> String {
        self.fleet.warehouse().nodes[node].name.clone()
    }

    fn places(&self) -> Vec<(String, String)> {
        let ledger = self.fleet.ledger();
        let place = |(r, robot): (RobotId, &Robot)| (robot.name.clone(), self.name_of(ledger.node_of(r)));
        ledger.robots.pairs().map(place).collect()
    }

    /// Every rack by name, each with the robot or the node that it is on.
    fn rack_places(&self) -> BTreeSet<(String, String)> {
        let at = |at: RackAt| match at {
            RackAt::Stored(node) => self.name_of(node),
            RackAt::On(robot) => format!("{robot:?}"),
        };
        let ledger = self.fleet.ledger();
        let racks = ledger.racks.pairs();
        racks.map(|(k, a)| (self.fleet.warehouse().racks[k].name.clone(), at(*a))).collect()
    }

    fn jobs(&self) -> Vec<(JobId, String)> {
        let w = self.fleet.warehouse();
        let kind = |kind: JobKind| match kind {
            JobKind::Deliver { rack, station, .. } => {
                format!("{} to {}", w.racks[rack].name, w.stations[station].name)
            }
            JobKind::Return { rack } => format!("{} back", w.racks[rack].name),
            JobKind::Relocate { rack, node } => format!("{} onto {}", w.racks[rack].name, w.nodes[node].name),
            JobKind::Go { robot, node } => format!("{robot:?} to {}", w.nodes[node].name),
            other => format!("{other:?}"),
        };
        self.fleet.ledger().jobs.iter().map(|(id, j)| (*id, kind(j.request.kind))).collect()
    }

    fn drain(&mut self) {
        self.world.stop_customers();
        self.until(3000, "the floor drains", |f| {
            let ledger = f.fleet.ledger();
            ledger.jobs.is_empty() && ledger.racks.iter().all(|at| matches!(at, RackAt::Stored(_)))
        });
        self.laws.check_drained(self.now, &self.world, &self.fleet);
        assert_eq!(self.laws.broken, []);
    }
}

#[test]
fn the_same_map_keeps_everything_and_robots_are_idle_or_bring_their_racks_away() {
    let scenario = busy(10, 3);
    let mut floor = TestFloor::new(thesis(), &scenario);
    floor.run(120);
    let before = floor.fleet.ledger().to_parts();
    let carried = floor.carried(&thesis());
    assert!(carried.report.is_clean() && carried.ids.keeps_ids(), "{}", carried.report);
    let after = carried.parts.expect("nothing is in the way");
    assert!(!carried.waiting.is_empty() && carried.failed.is_empty() && carried.cancelled.is_empty());
    let waits = |job: &Job| Job { state: JobState::Waiting, ..job.clone() };
    let jobs: Vec<(JobId, Job)> = before.jobs.iter().map(|(id, job)| (*id, waits(job))).collect();
    assert_eq!(after.jobs.iter().map(|(id, job)| (*id, job.clone())).collect::<Vec<_>>(), jobs);
    for (robot, record) in after.robots.pairs() {
        let rack = before.racks.pairs().find(|(_, at)| **at == RackAt::On(robot)).map(|(rack, _)| rack);
        let stores = matches!(record.task, Task::Store { job: None, rack: k, .. } if Some(k) == rack);
        assert!(if rack.is_some() { stores } else { record.task == Task::Idle }, "{record:?}");
        let old = floor.fleet.ledger().chain(robot);
        let chain = after.chains.iter().find(|c| c.holder == robot).unwrap();
        assert_eq!((chain.visits.len(), chain.granted), (1, chain.first + 1));
        assert!(chain.first >= old.end(), "no number is given twice");
        assert_eq!(chain.visits[0].node, floor.fleet.ledger().node_of(robot));
    }
    let Parts { promises: Promises { jobs, robots, .. }, chains, .. } = after;
    let rest = Parts { promises: Promises { jobs, robots, ..before.promises }, chains, ..before };
    let carried = floor.carried(&thesis()).parts.expect("as before");
    assert_eq!(carried, rest, "all else is as it was");
}

#[test]
fn a_floor_whose_ids_all_change_in_the_middle_of_things_goes_on_and_drains() {
    for (seed, robots) in [(1, 4), (2, 8), (3, 12), (4, 12)] {
        let scenario = busy(robots, seed);
        let mut floor = TestFloor::new(thesis(), &scenario);
        let mut map = thesis();
        for pause_s in [37, 61, 23, 90] {
            floor.run(pause_s);
            map = permuted(&map);
            let mut next = floor.under(map.clone(), &scenario);
            assert_eq!(next.places(), floor.places());
            assert_eq!(next.rack_places(), floor.rack_places());
            assert_eq!(next.jobs(), floor.jobs());
            next.run(5);
            floor = next;
        }
        let done = floor.done();
        floor.run(300);
        assert!(floor.done() > done, "it delivers, seed {seed}");
        floor.drain();
    }
}

#[test]
fn a_robot_or_a_rack_on_a_node_that_is_gone_or_for_something_else_is_in_the_way() {
    let mut floor = TestFloor::new(roomy(), &scenario(1));
    floor.run(1);
    let robot = floor.places()[0].1.clone();
    let moved = |draft: &mut Draft, from: &str| {
        for names in [&mut draft.parking, &mut draft.chargers, &mut draft.storage] {
            names.iter_mut().filter(|n| *n == from).for_each(|n| *n = "new".into());
        }
        draft.nodes.iter_mut().filter(|n| n.name == from).for_each(|n| n.name = "new".into());
        draft.racks.iter_mut().filter(|r| r.node == from).for_each(|r| r.node = "new".into());
        for lane in &mut draft.lanes {
            for end in [&mut lane.from, &mut lane.to] {
                if end == from {
                    *end = "new".into();
                }
            }
        }
    };
    let report = floor.carried(&changed(&roomy(), |draft| moved(draft, &robot))).report;
    let said = report.to_string();
    assert!(
        said.contains(&format!(
            "robot-1 stands on {robot}, which the new map does not have: with the old map"
        )),
        "{said}"
    );
    let rack = floor.fleet.warehouse().racks.iter().next().unwrap().clone();
    let home = floor.name_of(rack.home);
    let gone = floor.carried(&changed(&roomy(), |draft| moved(draft, &home)));
    let said = gone.report.to_string();
    assert!(gone.parts.is_none() && said.contains("relocate the rack to a node"), "{said}");
    assert!(said.contains(&format!("rack {} stands on {home}, which the new map does not have", rack.name)));
    let aisle = changed(&roomy(), |draft| {
        draft.storage.retain(|n| *n != home);
        remove_rack(draft, &rack.name);
        draft.racks.retain(|r| r.node != home);
        let free = draft.storage.iter().find(|n| draft.racks.iter().all(|r| r.node != **n)).cloned();
        draft.racks.push(DraftRack::plain(&rack.name, free.expect("some storage is free")));
    });
    let said = floor.carried(&aisle).report.to_string();
    assert!(said.contains("which is not a storage node on the new map"), "{said}");
}

#[test]
fn a_robot_that_has_left_stands_in_no_way_and_stays_away_under_a_changed_map() {
    let mut floor = TestFloor::thesis(2);
    let (gone, other) = (RobotId(0), RobotId(1));
    floor.answer_to(7, vec![Input::ask(7, RobotAction::Retire(gone))]).unwrap();
    floor.until(300, "it is gone", |f| f.fleet.ledger().robots[gone].is_gone());
    let node = floor.fleet.ledger().node_of(gone);
    let job = floor.submit(request(JobKind::Go { robot: other, node }));
    floor.until(300, "another one stands where it stood", |f| f.state(job).is_none());
    for map in [thesis(), permuted(&thesis())] {
        let next = floor.under(map, &scenario(2));
        assert!(next.fleet.ledger().robots[gone].is_gone());
        assert_eq!(next.places()[1], floor.places()[1]);
    }
    let small = changed(&thesis(), |draft| drop(draft.parking.pop()));
    floor.until(60, "nothing is on its way", |f| f.is_idle(other));
    assert!(floor.carried(&small).report.is_clean(), "{}", floor.carried(&small).report);
}

#[test]
fn two_robots_that_have_no_room_beside_one_another_on_the_new_map_are_in_the_way() {
    let floor = TestFloor::lab(2);
    let places = floor.places();
    let (a, b) = (&places[0].1, &places[1].1);
    // One robot's node is moved to within a robot's width of the other's: no well-formed map has that in `lab`.
    let mut draft = json::parse_draft(&json::write(&lab())).unwrap();
    let at = draft.nodes.iter().find(|n| n.name == *a).unwrap().at;
    let node = draft.nodes.iter_mut().find(|n| n.name == *b).unwrap();
    node.at = at + giveway_floor::geometry::Vector::new(0.3, 0.0);
    let carried = floor.carried(&draft.build_unchecked());
    let said = carried.report.to_string();
    assert!(carried.parts.is_none() && said.contains("are too close to one another"), "{said}");
    assert!(said.contains("robot-1") && said.contains("robot-2"), "{said}");
}

#[test]
fn robots_whose_footprints_grow_until_they_overlap_are_in_the_way_and_other_footprints_are_not() {
    let with = |radius_m: f64| {
        let mut scenario = scenario(2);
        scenario.site.kinds[0].footprints = [Some(Footprint::Circle { radius_m }), None];
        scenario.site.fit(&Arc::new(mixed())).expect("it lies within the square of the map")
    };
    let (small, other, large) = (with(0.2), with(0.24), with(0.3));
    let mut ledger = Ledger::new(small, &[RobotKind::default()], false);
    for (robot, node) in [(RobotId(0), "G3-9"), (RobotId(1), "G3-9~G3-10")] {
        let (name, kind) = (format!("robot-{robot:?}"), "robot".into());
        let node = ledger.warehouse().node_named(node).expect("it is there");
        ledger.evolve(&Fact::Robot(RobotFact::Registered { robot, name, kind, node, at: Time::ZERO }));
    }
    let carried = carry(&ledger, &other, Time::ZERO);
    assert!(carried.report.is_clean() && carried.parts.is_some(), "{}", carried.report);
    let carried = carry(&ledger, &large, Time::ZERO);
    let said = carried.report.to_string();
    assert!(carried.parts.is_none() && said.contains("are too close to one another"), "{said}");
}

#[test]
fn a_rack_that_is_gone_is_a_loss_and_on_a_robot_it_is_in_the_way() {
    let mut floor = TestFloor::lab(1);
    let job = floor.submit(JobRequest { key: Some("order 1".into()), ..request(deliver(3)) });
    let next = floor.submit(JobRequest { after: vec![job], ..request(deliver(4)) });
    let other = floor.submit(request(deliver(5)));
    let name = floor.fleet.warehouse().racks[RackId(3)].name.clone();
    let without = changed(&lab(), |draft| remove_rack(draft, &name));
    let carried = floor.carried(&without);
    let said = carried.report.to_string();
    assert_eq!((carried.report.obstacles.len(), carried.report.losses.len()), (0, 2), "{said}");
    assert!(said.contains(&format!("job j1 (deliver) asks for rack {name}, which is gone")), "{said}");
    assert!(said.contains(&format!("rack {name}, which stands on")), "{said}");
    assert_eq!(carried.failed, [job]);
    let mut on = floor.under(without.clone(), &scenario(1));
    assert_eq!(
        on.fleet.ledger().keys.get(&"order 1".into()),
        Some(&job),
        "the key still answers with the same job"
    );
    assert_eq!(on.fleet.ledger().counts.failed, 1);
    on.until_over(600);
    assert_eq!(on.story(next), ["failed"], "it was to come after the one that failed");
    on.assert_done_once(&[other]);
    floor.until(300, "the rack is on the robot", |f| matches!(f.rack(3), RackAt::On(_)));
    let carried = floor.carried(&without);
    let said = carried.report.to_string();
    assert!(carried.parts.is_none() && said.contains(&format!("robot-1 carries rack {name}")), "{said}");
    floor.until(300, "the robot is under way", |f| {
        f.fleet.warehouse().nodes[f.fleet.ledger().node_of(RobotId(0))].kind != NodeKind::Storage
    });
    let mut draft = json::parse_draft(&json::write(&lab())).unwrap();
    draft.lanes.iter_mut().for_each(|lane| lane.users = giveway_floor::warehouse::Users::UNLOADED);
    let carried = floor.carried(&draft.build_unchecked());
    let said = carried.report.to_string();
    assert!(carried.parts.is_none() && said.contains("no lane for loaded robots leads from"), "{said}");
}

#[test]
fn jobs_for_what_is_gone_or_for_something_else_are_losses() {
    let mut floor = TestFloor::new(roomy(), &scenario(1));
    let free = floor.free_storage();
    let name = floor.name_of(free);
    let (rack, robot) = (RackId(2), RobotId(0));
    floor.submit(request(deliver(0)));
    floor.submit(request(JobKind::Relocate { rack, node: free }));
    floor.submit(request(JobKind::Go { robot, node: free }));
    floor.submit(request(JobKind::Park { robot }));
    floor.submit(request(JobKind::Return { rack }));
    let aisle = changed(&roomy(), |draft| draft.storage.retain(|n| *n != name));
    let report = floor.carried(&aisle).report;
    assert_eq!(report.losses.len(), 1, "{report}");
    assert!(report.to_string().contains("no longer a storage node"), "{report}");
    let mut draft = json::parse_draft(&json::write(&roomy())).unwrap();
    draft.storage.retain(|n| *n != name);
    draft.lanes.retain(|l| l.from != name && l.to != name);
    draft.nodes.retain(|n| n.name != name);
    draft.parking.clear();
    draft.stations[0].name = "another".into();
    let report = floor.carried(&draft.build_unchecked()).report;
    let lost: Vec<&str> = report.losses.iter().map(|e| &e.what[..6]).collect();
    assert_eq!(lost, ["job j1", "job j2", "job j3", "job j4"], "{report}");
}

#[test]
fn closures_and_assignments_keep_what_is_left_of_them() {
    let mut floor = TestFloor::new(roomy(), &scenario(1));
    let (gone, left) = (floor.free_storage(), floor.node("R16"));
    let corner = |x_mm, y_mm| Spot { x_mm, y_mm };
    let area = |outline: Vec<Spot>, nodes: Vec<NodeId>| {
        let (window, reason) = (Window::from(Time(9_000_000_000)), "wet".to_owned());
        Input::ask(
            7,
            FloorAction::Close(Closure {
                outline,
                nodes,
                window,
                reason,
                binds: Binds::Robots,
                series: None,
            }),
        )
    };
    let outline = vec![corner(0, 0), corner(900, 0), corner(0, 900)];
    let assigned = |place, key: &str| {
        let request = AssignmentRequest {
            place,
            stay: Span::from_secs(9),
            what: "count".into(),
            key: Some(key.into()),
        };
        Input::ask(7, WorkerAction::Assign { worker: Some(giveway_floor::id::WorkerId(0)), request })
    };
    floor.step(vec![
        area(outline.clone(), vec![]),
        area(outline.clone(), vec![gone, left]),
        area(outline, vec![gone]),
        Input::ask(7, WorkerAction::Register("anna".into())),
        assigned(gone, "a"),
        assigned(left, "b"),
    ]);
    assert_eq!(floor.fleet.ledger().closures.len(), 3);
    let name = floor.name_of(gone);
    let map = changed(&permuted(&roomy()), |draft| {
        draft.storage.retain(|n| *n != name);
        draft.lanes.retain(|l| l.from != name && l.to != name);
        draft.nodes.retain(|n| n.name != name);
    });
    let carried = floor.carried(&map);
    let said = carried.report.to_string();
    assert_eq!(carried.report.losses.len(), 2, "{said}");
    assert!(said.contains("closure c3 (\"wet\") closes only nodes that are gone"), "{said}");
    assert!(said.contains("assignment a1 of worker anna is at node"), "{said}");
    assert_eq!(carried.cancelled, [AssignmentId(1)]);
    let parts = carried.parts.expect("nothing is in the way");
    let closed: Vec<Vec<NodeId>> = parts.closures.values().map(|c| c.nodes.clone()).collect();
    assert_eq!(closed, [vec![], vec![map.node_named("R16").unwrap()]]);
    assert_eq!(parts.assignment_keys.get(&"a".into()), Some(&AssignmentId(1)));
    assert_eq!(parts.assignment_keys.over().count(), 1, "and it is forgotten when it is old");
    assert_eq!(parts.assignments.keys().collect::<Vec<_>>(), [&AssignmentId(2)]);
}

#[test]
fn new_racks_stand_at_home_or_on_the_next_free_storage_node() {
    let mut floor = TestFloor::new(roomy(), &scenario(1));
    let free = floor.free_storage();
    let (home, kept) = (floor.name_of(free), floor.fleet.warehouse().racks[RackId(0)].clone());
    let map = changed(&roomy(), |draft| draft.racks.insert(0, DraftRack::plain("fresh", &home)));
    let on = floor.under(map, &scenario(1));
    assert!(on.rack_places().contains(&("fresh".to_owned(), home.clone())));
    assert_eq!(on.rack_places().len(), on.fleet.warehouse().racks.len(), "none stands where another does");
    // The home of the new rack is where an old rack has come to stand meanwhile.
    floor.submit(request(JobKind::Relocate { rack: RackId(0), node: free }));
    floor.until_over(600);
    let old_home = floor.name_of(kept.home);
    let map = changed(&roomy(), |draft| {
        draft.racks.iter_mut().filter(|r| r.name == kept.name).for_each(|r| r.name = "fresh".into());
        draft.racks.push(DraftRack::plain(&kept.name, &home));
    });
    assert!(floor.under(map, &scenario(1)).rack_places().contains(&("fresh".to_owned(), old_home.clone())));
    let map = changed(&roomy(), |draft| {
        draft.racks.iter_mut().filter(|r| r.name == kept.name).for_each(|r| r.node = old_home.clone());
        draft.racks.push(DraftRack::plain("fresh", &home));
    });
    let carried = floor.carried(&map);
    let fresh = map.rack_named("fresh").unwrap();
    let at = carried.parts.expect("there is another place").racks[fresh];
    assert_ne!(at, RackAt::Stored(map.node_named(&home).unwrap()));
    assert!(carried.report.to_string().contains("put the new rack fresh onto"), "{}", carried.report);
}

#[test]
fn notes_say_what_is_different() {
    let floor = TestFloor::lab(1);
    let map = changed(&lab(), |draft| {
        for node in &mut draft.nodes {
            node.at.y += match node.name.as_str() {
                "R118" => 0.1,
                "R119" => 0.15,
                _ => 0.0,
            };
        }
    });
    let report = floor.carried(&map).report;
    assert!(report.is_clean(), "{report}");
    assert_eq!(report.changes, ["2 nodes moved, by 0.15 m at most (R119)"]);
    let report = floor.carried(&thesis()).report;
    for word in ["nodes removed", "nodes added", "lanes removed", "stations added", "racks added"] {
        assert!(report.changes.iter().any(|n| n.contains(word)), "{word}: {report}");
    }
}
