//! Dead ends, corridors and stations in which a robot breaks down: all robots that have a way out leave and work on,
//! the others say what they wait for, and every job goes on after the repair.

use super::*;
use giveway_floor::warehouse::sketch;

const NEVER: Time = Time::MAX;

/// An aisle with one end among racks, and one rack and free storage beside the stations, each of which has room for one
/// robot.
const AISLE: &str = "
    PPP123S
    .......R
    .-----S----
    .RRRRRRRRRR
    ...........";
/// The racks that are farthest in, and the rack beside the stations.
const FAR: [u32; 3] = [10, 9, 8];
const BESIDE: u32 = 7;

/// Two halls and a corridor, in which robots cannot pass one another.
const CORRIDOR: &str = "
    P-------------------
    .P------------------
    .P------------------
    .R----------------S.
    ....................
    .R----------------S.
    .R----------------S.
    2------------------1";

fn drawn(drawing: &str, robots: usize) -> TestFloor {
    let map = sketch(drawing).build().unwrap_or_else(|e| panic!("a robot could get stuck there: {e}"));
    TestFloor::new(map, &scenario(robots))
}

fn to(rack: u32, station: u32) -> JobRequest {
    request(JobKind::Deliver { rack: RackId(rack), station: StationId(station), pick: None })
}

impl TestFloor {
    fn cell(&self, robot: RobotId) -> (i64, i64) {
        let at = self.fleet.warehouse().nodes[self.fleet.ledger().node_of(robot)].at;
        (at.x.round() as i64, at.y.round() as i64)
    }

    fn robots(&self) -> impl DoubleEndedIterator<Item = RobotId> + use<> {
        self.fleet.ledger().robots.ids()
    }

    fn carries(&self, robot: RobotId) -> bool {
        self.fleet.ledger().rack_on(robot).is_some()
    }

    pub(super) fn why_job(&self, job: JobId) -> Option<JobWhy> {
        self.fleet.view(self.now).why_job(self.fleet.warehouse(), job, &self.fleet.ledger().jobs[&job])
    }

    /// The robots with racks in a part of the floor, the westernmost first, once this many are there and the robot of
    /// this rank drives over open floor.
    fn caught(&mut self, count: usize, rank: usize, is_there: fn((i64, i64)) -> bool) -> Vec<RobotId> {
        let there = |f: &TestFloor| {
            let mut found: Vec<RobotId> =
                f.robots().filter(|r| f.carries(*r) && is_there(f.cell(*r))).collect();
            found.sort_by_key(|r| f.cell(*r));
            found
        };
        let open = |f: &TestFloor, r: RobotId| {
            let node = f.fleet.ledger().node_of(r);
            f.fleet.warehouse().kind(node) == NodeKind::Aisle
        };
        let so = |f: &TestFloor| there(f).get(rank).is_some_and(|r| there(f).len() >= count && open(f, *r));
        self.until(300, "the robots are there", so);
        there(self)
    }
}

#[test]
fn robots_behind_one_that_breaks_down_in_a_dead_end_set_their_racks_down_and_work_elsewhere() {
    let mut floor = drawn(AISLE, 3);
    let jobs: Vec<JobId> = (0..3).map(|i| floor.submit(to(FAR[i], i as u32))).collect();
    let robots = floor.caught(3, 0, |(x, y)| x >= 1 && y <= 1);
    floor.world.fail(robots[0], NEVER);
    let broken = robots[0];
    let own = floor.fleet.ledger().robots[broken].task.job().expect("it carries a rack for one");
    let elsewhere = floor.submit(to(BESIDE, 0));
    floor.until(600, "another robot has come out beneath the racks and works", |f| {
        f.state(elsewhere).is_none()
    });
    assert_eq!(floor.story(elsewhere).last(), Some(&"done"));
    let others: Vec<JobId> = jobs.iter().copied().filter(|j| *j != own).collect();
    floor.until(300, "no other robot keeps a rack", |f| f.robots().all(|r| r == broken || !f.carries(r)));
    for job in &others {
        assert_eq!(floor.state(*job), Some(JobState::Waiting));
        assert_eq!(floor.why_job(*job), Some(JobWhy::WayBlocked(broken)), "it says what has to be cleared");
    }
    assert_eq!(floor.why_job(own), Some(JobWhy::Robot(broken, Why::Failed)));
    floor.world.fail(broken, floor.now);
    floor.until_over(900);
    floor.assert_done_once(&jobs);
}

#[test]
fn robots_before_one_that_breaks_down_in_a_dead_end_leave_it_and_work_on() {
    let mut floor = drawn(AISLE, 3);
    let jobs: Vec<JobId> = (0..3).map(|i| floor.submit(to(FAR[i], i as u32))).collect();
    let robots = floor.caught(3, 2, |(x, y)| x >= 1 && y <= 1);
    let broken = robots[2];
    floor.world.fail(broken, NEVER);
    let own = floor.fleet.ledger().robots[broken].task.job().expect("it carries a rack for one");
    let elsewhere = floor.submit(to(BESIDE, 0));
    let over = |f: &TestFloor, j: &JobId| *j == own || f.state(*j).is_none();
    floor.until(600, "the others have done all", |f| jobs.iter().chain([&elsewhere]).all(|j| over(f, j)));
    let same = floor.submit(to(floor.fleet.ledger().rack_on(broken).expect("it carries one").0, 0));
    floor.run(1);
    let rack = floor.fleet.ledger().rack_on(broken).expect("it still does");
    assert_eq!(floor.why_job(same), Some(JobWhy::RackBusy(rack, broken, Some(own))));
    floor.world.fail(broken, floor.now);
    floor.until_over(900);
    floor.assert_done_once(&jobs);
}

#[test]
fn robots_behind_one_that_breaks_down_in_a_corridor_leave_backwards_and_work_on() {
    let mut floor = drawn(CORRIDOR, 3);
    let east: Vec<NodeId> = ["18,4", "18,2", "18,1"].map(|n| floor.node(n)).to_vec();
    let relocate = |(rack, node): (u32, &NodeId)| JobKind::Relocate { rack: RackId(rack), node: *node };
    let racks: Vec<u32> = (0..3).collect();
    let kinds = racks.iter().copied().zip(&east).map(relocate);
    let jobs: Vec<JobId> = kinds.map(|kind| floor.submit(request(kind))).collect();
    let mut robots = floor.caught(3, 2, |(x, y)| (2..=17).contains(&x) && y == 3);
    let broken = robots.pop().expect("some are there");
    floor.world.fail(broken, NEVER);
    let own = floor.fleet.ledger().robots[broken].task.job().expect("it carries a rack for one");
    floor.run(2);
    let west = |f: &TestFloor, r: &RobotId| f.cell(*r).0 <= 1;
    floor.until(120, "the others have left backwards", |f| robots.iter().all(|r| west(f, r)));
    floor.until(300, "they have set their racks down", |f| f.robots().all(|r| r == broken || !f.carries(r)));
    for job in jobs.iter().filter(|j| **j != own) {
        assert_eq!(
            (floor.state(*job), floor.why_job(*job)),
            (Some(JobState::Waiting), Some(JobWhy::WayBlocked(broken)))
        );
    }
    let held = floor.fleet.ledger().rack_on(broken).map(|k| k.0);
    // The first station of the drawing is the one in the west.
    let others = racks.iter().filter(|k| Some(**k) != held);
    let elsewhere: Vec<JobId> = others.map(|k| floor.submit(to(*k, 0))).collect();
    floor.until(300, "they work where they are", |f| elsewhere.iter().all(|j| f.state(*j).is_none()));
    floor.assert_done_once(&elsewhere);
    floor.world.fail(broken, floor.now);
    floor.until_over(1800);
    floor.assert_done_once(&jobs);
}
