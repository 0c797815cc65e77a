//! Robots that want one another's places: two that trade them, rings, permutations of all lasting places, chains that
//! end in an idle robot; and a floor on which there is no place to make room.

use super::*;
use giveway_floor::warehouse::formats::json;
use giveway_floor::warehouse::sketch;

/// Two robots begin at `c` and `p`; `s3` is a free place.
const SMALL: &str = include_str!("../../../docs/small.json");

/// Two chargers with a lane between, and no other place where a robot may stay.
const FULL: &str = "
    C...C";

impl TestFloor {
    pub(super) fn small(robots: usize) -> TestFloor {
        TestFloor::new(json::parse(SMALL).expect("a map"), &scenario(robots))
    }

    pub(super) fn go(&mut self, robot: RobotId, node: NodeId) -> JobId {
        self.submit(request(JobKind::Go { robot, node }))
    }

    pub(super) fn where_is(&self, robot: RobotId) -> NodeId {
        self.fleet.ledger().node_of(robot)
    }

    /// Sends each of these robots to the place of the next one, and the last robot to the place of the first.
    fn rotate(&mut self, robots: &[RobotId]) -> Vec<JobId> {
        let places: Vec<NodeId> = robots.iter().map(|r| self.where_is(*r)).collect();
        let goals = places.iter().cycle().skip(1);
        robots.iter().zip(goals).map(|(r, goal)| self.go(*r, *goal)).collect()
    }

    fn present(&self) -> Vec<RobotId> {
        self.fleet.ledger().present().collect()
    }
}

#[test]
fn two_robots_trade_places_where_a_third_place_is_free() {
    let mut floor = TestFloor::small(2);
    let (c, p) = (floor.node("c"), floor.node("p"));
    assert_eq!((floor.where_is(RobotId(0)), floor.where_is(RobotId(1))), (c, p));
    let jobs = floor.rotate(&[RobotId(0), RobotId(1)]);
    floor.until_over(60);
    floor.assert_done_once(&jobs);
    assert_eq!(
        (floor.where_is(RobotId(0)), floor.where_is(RobotId(1))),
        (p, c),
        "each stays where it was sent"
    );
}

#[test]
fn a_ring_of_three_on_an_empty_floor_is_turned() {
    let mut floor = TestFloor::thesis(3);
    let robots = floor.present();
    let jobs = floor.rotate(&robots);
    floor.until_over(180);
    floor.assert_done_once(&jobs);
}

#[test]
fn every_permutation_of_the_places_of_robots_is_driven() {
    let mut dice = TestDice(11);
    for round in 0..6 {
        let mut floor = TestFloor::thesis(4 + round);
        let robots = floor.present();
        let mut goals: Vec<NodeId> = robots.iter().map(|r| floor.where_is(*r)).collect();
        dice.shuffle(&mut goals);
        let jobs: Vec<JobId> = robots.iter().zip(goals).map(|(r, goal)| floor.go(*r, goal)).collect();
        floor.until_over(400);
        floor.assert_done_once(&jobs);
    }
}

#[test]
fn robots_that_are_sent_along_a_chain_push_the_idle_one_at_its_end_away() {
    let mut floor = TestFloor::thesis(6);
    let robots = floor.present();
    let places: Vec<NodeId> = robots.iter().map(|r| floor.where_is(*r)).collect();
    let jobs: Vec<JobId> = robots.iter().zip(&places[1..]).map(|(r, goal)| floor.go(*r, *goal)).collect();
    floor.until_over(300);
    floor.assert_done_once(&jobs);
}

#[test]
fn where_there_is_no_place_to_make_room_one_job_fails_and_says_so() {
    let map = sketch(FULL).build().unwrap_or_else(|e| panic!("a robot could get stuck there: {e}"));
    let mut floor = TestFloor::new(map, &scenario(2));
    let jobs = floor.rotate(&[RobotId(0), RobotId(1)]);
    floor.until_over(60);
    let states: Vec<JobState> =
        jobs.iter().filter_map(|j| floor.progress(*j).last()).map(|(s, _)| s).collect();
    let failed = states.iter().filter(|s| **s == JobState::Failed(JobFailure::NoPlaceAside)).count();
    assert!(failed >= 1, "{states:?}");
}

#[test]
fn a_search_that_gives_up_looks_farther_next_time() {
    // Fewer labels than the route has nodes.
    let mut floor = TestFloor::new(thesis(), &scenario(1));
    floor.fleet = Fleet::new(
        floor.fleet.warehouse().clone(),
        Settings { expansions_per_plan: 12, ..scenario(1).site.settings() },
    );
    floor.laws = Laws::new(&floor.fleet);
    floor.world =
        World::new(floor.fleet.warehouse().clone(), &scenario(1), &[], 1, floor.fleet.ledger(), Time::ZERO);
    floor.now = Time::ZERO;
    floor.step(vec![]);
    let far =
        floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Storage).pop().expect("the hall has storage");
    let job = floor.go(RobotId(0), far);
    floor.until_over(120);
    floor.assert_done_once(&[job]);
}
