//! The building is evacuated: all workers are led to doors, robots clear the ways and stand, and go on afterwards.

use super::people::Puppet;
use super::*;
use giveway_floor::geometry::{Point, Segment};

impl TestFloor {
    fn evacuate(&mut self, begins: bool) {
        let input = if begins {
            Input::ask(9, FloorAction::Evacuate)
        } else {
            Input::ask(9, FloorAction::EndEvacuation)
        };
        assert_eq!(self.step(vec![input]).replies, [Reply { token: 9.into(), answer: Ok(Answer::Done) }]);
    }

    fn doors(&self) -> Vec<Point> {
        let w = self.fleet.warehouse();
        w.nodes_where(|k| k == NodeKind::Exit).into_iter().map(|n| w.nodes[n].at).collect()
    }

    fn is_at_a_door(&self, at: Point) -> bool {
        self.doors().into_iter().any(|d| (d - at).norm() <= 1.0)
    }

    /// Nodes beside what is left of the ways of people to the doors.
    fn nodes_on_ways(&self, people: &[Puppet]) -> std::collections::BTreeSet<NodeId> {
        let w = self.fleet.warehouse();
        let mut on = std::collections::BTreeSet::new();
        for p in people {
            let way: Vec<Point> = std::iter::once(p.at).chain(p.way.iter().copied()).collect();
            for step in way.windows(2).map(|s| Segment { a: s[0], b: s[1] }) {
                on.extend(
                    w.nodes
                        .ids()
                        .filter(|n| step.distance_to(w.nodes[*n].at) < 0.5 && !w.kind(*n).is_lasting()),
                );
            }
        }
        on
    }

    /// Whether a robot at a place is on one of these nodes, or reaches onto it.
    fn is_beside(&self, at: Point, on: &std::collections::BTreeSet<NodeId>) -> bool {
        let w = self.fleet.warehouse();
        on.iter().any(|n| (w.nodes[*n].at - at).norm() < 0.9)
    }

    /// One period in which all people are seen, told and walk.
    fn all_walk(&mut self, people: &mut [Puppet]) -> Step {
        let seen = people.iter_mut().map(|p| p.sighting(self.now)).collect();
        let step = self.step(seen);
        for p in people.iter_mut() {
            let told = step.guidance.iter().rev().find(|(w, _)| *w == p.worker);
            if let Some((_, g)) = told {
                p.way = if g.state == GuidanceState::Stop { vec![] } else { g.path.clone() };
            }
            p.walk_on(self);
        }
        step
    }
}

#[test]
fn everybody_is_out_within_a_minute_and_a_half_and_all_jobs_are_done_afterwards() {
    let mut floor = TestFloor::thesis(20);
    let mut people: Vec<Puppet> = [("Ana", 3.0, 4.0), ("Ben", 9.0, 7.0), ("Eva", 6.0, 10.0)]
        .map(|(name, x, y)| floor.hire_as(name, Point::new(x, y)))
        .into();
    let mut jobs = Vec::new();
    for i in 0..40 {
        let (rack, station) = (RackId::at(i * 7 % floor.fleet.warehouse().racks.len()), StationId::at(i % 2));
        jobs.push(floor.submit(request(JobKind::Deliver { rack, station, pick: None })));
    }
    for _ in 0..600 {
        floor.all_walk(&mut people);
    }
    let begun =
        |f: &TestFloor| f.fleet.ledger().jobs.values().filter(|j| j.state != JobState::Waiting).count();
    assert!(begun(&floor) > 10, "robots are busy when it begins");
    let (at, waiting) = (floor.now, floor.fleet.view(floor.now).counts.waiting);
    floor.evacuate(true);
    let (mut out, mut entered) = (None, Vec::new());
    while out.is_none() {
        assert!(
            floor.now - at < Span::from_secs(90),
            "not all are out: {:?}",
            people.iter().map(|p| p.at).collect::<Vec<_>>()
        );
        let step = floor.all_walk(&mut people);
        // Grants follow the ways that were shown in the same step.
        let on = floor.nodes_on_ways(&people);
        for fact in &step.facts {
            let Fact::Route(RouteFact::Granted { robot, serial, .. }) = fact else { continue };
            let chain = floor.fleet.ledger().chain(*robot);
            let node = |s: u64| chain.get(s).map(|v| v.node);
            let onto = (chain.first()..=*serial).filter_map(node).any(|n| on.contains(&n));
            let from = floor.world.truth().any(|(r, t)| r == *robot && floor.is_beside(t.pose.at, &on));
            entered.extend((onto && !from).then_some((*robot, floor.now)));
        }
        out = people.iter().all(|p| floor.is_at_a_door(p.at)).then_some(floor.now - at);
    }
    assert_eq!(entered, [], "no robot enters a way between a worker and a door");
    let view = floor.fleet.view(floor.now);
    assert!(view.counts.waiting >= waiting, "no job has begun");
    assert!(view.workers.iter().all(|w| w.guidance.reason == Some(GuidanceReason::Evacuation)), "told why");
    // Robots that were in the way have left; then no robot moves any more.
    for _ in 0..300 {
        floor.all_walk(&mut people);
    }
    let places = |f: &TestFloor| f.world.truth().map(|(_, t)| t.pose.at).collect::<Vec<_>>();
    let stand = places(&floor);
    for _ in 0..100 {
        floor.all_walk(&mut people);
    }
    assert_eq!(places(&floor), stand, "all stand");
    floor.evacuate(false);
    let ended = floor.now;
    while !jobs.iter().all(|j| floor.state(*j).is_none()) {
        floor.all_walk(&mut people);
        assert!(floor.now - ended < Span::from_secs(1200), "all jobs are done afterwards");
    }
    assert_eq!(floor.done(), jobs.len() as u64);
}

#[test]
fn an_evacuation_lasts_over_a_restart_and_needs_a_door() {
    let scenario = scenario(2);
    let mut floor = TestFloor::new(thesis(), &scenario);
    floor.step(vec![]);
    floor.evacuate(true);
    let warehouse = floor.fleet.warehouse().clone();
    floor.fleet = Fleet::restore(warehouse, scenario.site.settings(), floor.facts.clone());
    assert!(floor.fleet.ledger().evacuation.is_some());
    floor.step(vec![]);
    assert_eq!(floor.fleet.why(RobotId::at(0)), Some(Why::Evacuation));
    floor.evacuate(false);
    floor.step(vec![]);
    assert_eq!(floor.fleet.why(RobotId::at(0)), None);
}
