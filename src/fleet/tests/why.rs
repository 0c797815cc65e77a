//! A query why a job or a robot does not go on gets the reason, to its root.

use super::*;
use giveway_floor::geometry::Point;
use giveway_floor::time::Window;

impl TestFloor {
    fn why(&self, job: JobId) -> Option<JobWhy> {
        self.fleet.view(self.now).why_job(self.fleet.warehouse(), job, &self.fleet.ledger().jobs[&job])
    }

    /// The chain of some robot whose root meets the condition, once there is one.
    fn chain_to(&mut self, seconds: i64, so: impl Fn(&[Waiting]) -> bool) -> Vec<Waiting> {
        let end = self.now + Span::from_secs(seconds);
        while self.now < end {
            self.step(vec![]);
            let robots = self.fleet.ledger().robots.ids().collect::<Vec<_>>();
            let chain = robots.into_iter().map(|r| self.fleet.waits(r, self.now)).find(|c| so(c));
            if let Some(chain) = chain {
                return chain;
            }
        }
        let robots = self.fleet.ledger().robots.ids();
        let all: Vec<_> = robots.map(|r| self.fleet.waits(r, self.now)).collect();
        panic!("no robot waits so within {seconds} s, but {all:#?}");
    }

    /// A closure of one node.
    fn around(&self, node: NodeId, window: Window) -> Closure {
        let at = self.fleet.warehouse().nodes[node].at;
        let corners = [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)];
        let outline = corners.map(|(x, y)| Point::new(at.x + x, at.y + y).into()).to_vec();
        Closure {
            outline,
            nodes: vec![node],
            window,
            reason: "repair".into(),
            binds: Binds::Robots,
            series: None,
        }
    }

    /// Racks for one station, each of which takes long there.
    fn submit_long(&mut self, racks: std::ops::Range<u32>) -> Vec<JobId> {
        let pick = Some(Span::from_secs(300));
        let long = |rack| request(JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick });
        racks.map(|rack| self.submit(long(rack))).collect()
    }
}

#[test]
fn a_waiting_job_says_what_it_waits_for() {
    let mut floor = TestFloor::lab(2);
    let first = floor.submit(request(deliver(3)));
    floor.until(60, "a robot has it", |f| f.is(first, "assigned"));
    let robot = floor.state(first).and_then(|s| s.robot()).expect("it is assigned");
    assert_eq!(floor.why(first), None, "it goes on");
    let after = floor.submit(JobRequest { after: vec![first], ..request(deliver(8)) });
    assert_eq!(floor.why(after), Some(JobWhy::After(first)));
    let same = floor.submit(request(deliver(3)));
    assert_eq!(floor.why(same), Some(JobWhy::RackBusy(RackId(3), robot, Some(first))), "being fetched");
    let named = floor.submit(request(JobKind::Park { robot }));
    assert_eq!(floor.why(named), Some(JobWhy::RobotBusy(robot, Some(first))));
    let second = floor.submit(request(deliver(8)));
    floor.until(60, "the other robot has it", |f| f.is(second, "assigned"));
    let third = floor.submit(request(deliver(5)));
    let ahead = JobsAhead { higher: 0, others: 1, more: false };
    assert_eq!(floor.why(third), Some(JobWhy::Outranked(ahead)), "the second one for the rack is older");
    floor.until(300, "the rack is carried", |f| f.is(first, "carrying"));
    assert_eq!(floor.why(same), Some(JobWhy::RackBusy(RackId(3), robot, Some(first))));
}

#[test]
fn a_job_at_work_gives_the_reason_of_its_robot() {
    let mut floor = TestFloor::lab(4);
    let jobs = floor.submit_long(2..6);
    let full = |f: &TestFloor, job: &JobId| {
        let robot = f.state(*job).and_then(|s| s.robot());
        let why = f.why(*job).zip(robot).and_then(|(why, r)| match why {
            JobWhy::Robot(of, why) if of == r => why.station(),
            _ => None,
        });
        why == Some(StationId(0))
    };
    floor.until(300, "a rack waits for the queue", |f| jobs.iter().any(|j| full(f, j)));
}

#[test]
fn a_robot_in_a_queue_waits_for_one_that_finishes_its_stop_at_a_known_time() {
    let mut floor = TestFloor::lab(4);
    let jobs = floor.submit_long(2..6);
    let picked = |c: &[Waiting]| {
        let waits = |w: &Waiting| matches!(w.because, Because::Robot(Why::WaitsFor(..)));
        c.len() == 2 && waits(&c[0]) && matches!(c[1].because, Because::AtStop(Act::Pick(_)))
    };
    let chain = floor.chain_to(300, picked);
    let robot = |w: &Waiting| match w.who {
        Who::Robot(r) => r,
        who => panic!("{who:?} in the chain of a robot: {chain:?}"),
    };
    for (link, behind) in chain.iter().zip(&chain[1..]) {
        let Because::Robot(Why::WaitsFor(_, holder)) = link.because else { continue };
        assert_eq!(holder, robot(behind), "each link names the next one");
        assert!(link.ahead >= 1 && link.until.is_none_or(|t| t >= floor.now), "{link:?}");
    }
    let root = chain[1];
    let here = floor.fleet.ledger().chain(robot(&root)).first();
    let depart = floor.fleet.ledger().chain(robot(&root)).get(here).map(|v| v.depart);
    assert!(!root.because.is_waiting());
    assert_eq!(root.until, depart, "it goes on when its stop is done");
    let last = jobs.into_iter().find(|j| floor.state(*j).and_then(|s| s.robot()) == Some(robot(&chain[0])));
    let of_job = floor.fleet.job_waits(last.expect("it works on one"), floor.now);
    assert_eq!(of_job, chain, "its job waits for the same");
}

#[test]
fn the_root_of_waiting_is_the_closed_place() {
    let mut floor = TestFloor::lab(3);
    floor.submit_long(2..4);
    let node = floor.fleet.warehouse().stations[StationId(0)].node;
    let window = Window::new(floor.now, Time::MAX);
    let area = floor.around(node, window);
    let both = |f: &TestFloor| f.fleet.ledger().jobs.values().all(|j| j.state.word() == "carrying");
    floor.until(300, "racks are carried", both);
    floor.step(vec![Input::ask(5, FloorAction::Close(area))]);
    let all_wait = |f: &TestFloor| {
        let stored = f.fleet.ledger().racks.iter().all(|r| matches!(r, RackAt::Stored(_)));
        stored && f.fleet.ledger().jobs.values().all(|j| j.state == JobState::Waiting)
    };
    floor.until(200, "the racks are set down, since none of them gets there", all_wait);
    let jobs: Vec<JobId> = floor.fleet.ledger().jobs.keys().copied().collect();
    for job in jobs {
        let chain = floor.fleet.job_waits(job, floor.now);
        let root = chain.last().expect("it waits");
        assert!(matches!(root.because, Because::Job(JobWhy::WayClosed(_))), "{chain:?}");
        assert_eq!(root.until, None, "nobody said until when");
    }
}

#[test]
fn the_root_of_waiting_is_the_person_in_the_way() {
    let mut floor = TestFloor::lab(3);
    floor.submit_long(2..4);
    let node = floor.fleet.warehouse().stations[StationId(0)].node;
    let at: Point = floor.fleet.warehouse().nodes[node].at;
    let mut ana = floor.hire(at);
    ana.own = true;
    for _ in 0..3000 {
        floor.walk(&mut ana);
        let robots = floor.fleet.ledger().robots.ids().collect::<Vec<_>>();
        let mut chains = robots.into_iter().map(|r| floor.fleet.waits(r, floor.now));
        let gives_way = Because::Robot(Why::GivesWay(ana.worker));
        let is_it = |c: &[Waiting]| match c {
            [.., robot, person] => robot.because == gives_way && person.who == Who::Worker(ana.worker),
            _ => false,
        };
        if chains.any(|c| is_it(&c)) {
            return;
        }
    }
    panic!("nobody gives way to who stands at the station");
}

#[test]
fn what_stands_still_for_a_person_is_known_and_the_person_is_asked_to_make_room() {
    let mut floor = TestFloor::lab(3);
    floor.submit_long(2..4);
    let node = floor.fleet.warehouse().stations[StationId(0)].node;
    let at: Point = floor.fleet.warehouse().nodes[node].at;
    let mut ana = floor.hire(at);
    ana.own = true;
    let person = Party::Worker(ana.worker);
    let (mut stood, mut asked) = (false, false);
    for _ in 0..3000 {
        floor.walk(&mut ana);
        let found = floor.fleet.standstills();
        for s in &found {
            assert_eq!(s.root, [person], "a robot alone stands still: {found:?}");
            assert!(s.behind.iter().all(|p| floor.fleet.wait(*p).end == ChainEnd::Still(person)), "{s:?}");
            stood |= !s.behind.is_empty();
        }
        let guidance = &floor.fleet.view(floor.now).workers[0].guidance;
        asked |= matches!(guidance.reason, Some(GuidanceReason::RobotWaits(_) | GuidanceReason::CutsOff));
    }
    assert!(stood && asked, "stood {stood}, asked {asked}");
}

#[test]
fn jobs_wait_for_jobs_and_these_for_robots() {
    let mut floor = TestFloor::lab(1);
    let first = floor.submit(request(deliver(3)));
    floor.until(60, "a robot has it", |f| f.is(first, "assigned"));
    let second = floor.submit(request(deliver(3)));
    let third = floor.submit(JobRequest { after: vec![second], ..request(deliver(8)) });
    let chain = floor.fleet.job_waits(third, floor.now);
    let who: Vec<Who> = chain.iter().map(|w| w.who).collect();
    assert_eq!(who, [Who::Job(third), Who::Job(second), Who::Robot(RobotId(0))], "{chain:?}");
    assert!(!chain[2].because.is_waiting(), "it drives: {chain:?}");
    assert_eq!(floor.fleet.job_waits(JobId(99), floor.now), []);
}

#[test]
fn strips_say_who_holds_the_nodes_of_an_area_and_what_is_closed_there() {
    let mut floor = TestFloor::lab(2);
    let robot = RobotId(0);
    let node = floor.fleet.ledger().node_of(robot);
    let window = Window::new(floor.now + Span::from_secs(30), floor.now + Span::from_secs(60));
    let area = floor.around(node, window);
    floor.step(vec![Input::ask(5, FloorAction::Close(area))]);
    floor.step(vec![]);
    let at = floor.fleet.warehouse().nodes[node].at;
    let d = nalgebra::Vector2::new(0.1, 0.1);
    let strips = |f: &TestFloor, ahead| {
        f.fleet.occupancy(Area { low: at - d, high: at + d }, Span::from_secs(ahead), f.now)
    };
    let found = strips(&floor, 60).unwrap();
    assert_eq!((found.len(), found[0].node), (1, node));
    let hold = found[0].holds.iter().find(|h| h.holder == robot).expect("it stands there");
    assert!(hold.granted && hold.window.contains(floor.now), "{hold:?}");
    let own = |r: &&RegionStay| r.of == Party::Robot(robot) && r.window.contains(floor.now);
    let own = found[0].regions.iter().find(own).expect("where it stands a person would be too near");
    assert_eq!(own.region, SafetyRegion::KeepOut);
    assert_eq!(found[0].conditions.len(), 1, "{:?}", found[0].conditions);
    assert!(strips(&floor, 20).unwrap()[0].conditions.is_empty(), "it begins later than that");
    let all = Area { low: Point::new(-1e3, -1e3), high: Point::new(1e3, 1e3) };
    let count = floor.fleet.warehouse().nodes.len();
    let of_all = floor.fleet.occupancy(all, Span::from_secs(60), floor.now);
    assert_eq!(of_all.map(|s| s.len()), if count > MOST_NODES { Err(count) } else { Ok(count) });
}

#[test]
fn the_root_of_waiting_is_the_robot_that_somebody_paused() {
    let mut floor = TestFloor::lab(4);
    floor.submit_long(2..6);
    let picked = |c: &[Waiting]| c.len() == 2 && matches!(c[1].because, Because::AtStop(Act::Pick(_)));
    let chain = floor.chain_to(300, picked);
    let (Who::Robot(last), Who::Robot(first)) = (chain[0].who, chain[1].who) else { panic!("{chain:?}") };
    floor.step(vec![Input::ask(4, FloorAction::Halt(Some(first)))]);
    let chain = floor.fleet.waits(last, floor.now);
    let root = chain.last().map(|w| (w.who, w.because));
    assert_eq!(root, Some((Who::Robot(first), Because::Robot(Why::Paused))));
    assert!(chain.iter().all(|w| w.until.is_none()), "nobody knows how long that takes: {chain:?}");
}
