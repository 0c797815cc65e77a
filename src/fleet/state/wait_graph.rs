//! The wait-for graph: what each robot and each worker waits for, in this step.
//!
//! Main types: [`WaitGraph`], [`Party`], [`Edge`], [`ChainEnd`]. Each party waits for one other at most, or for
//! something that is no party: a time, an operator, a route. So a walk along the edges comes to one end, or goes round
//! in a cycle (a deadlock), and the ends of all walks together cost one visit of each party. A chain whose end neither
//! moves, nor has a known time, nor is for an operator to end is a *standstill*. Refuses: to find out what anything
//! waits for, and to end a standstill.

use crate::state::why::Why;
use giveway_floor::geometry::Point;
use giveway_floor::id::{Dense, IdVec, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};

/// A standstill that begins again within this time has never ended: a robot tries another way in vain, or a person
/// shifts from one foot to the other.
const MOMENT: Span = Span::from_secs(3);

/// A robot that waits for a worker again within this time waits for the same thing: a robot that tries another way in
/// vain comes back.
const AGAIN: Span = Span::from_secs(15);

/// A person within this distance is in the same spot, metres: twice what the law of simulations has, since tags are off
/// by a few decimetres.
const SPOT_M: f64 = 1.5;

/// A robot or a worker: a node of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Party {
    /// A robot.
    Robot(RobotId),
    /// A worker.
    Worker(WorkerId),
}

/// What one party waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// For nothing: the party drives, walks, is at work, or goes on when its planned time comes.
    Moves,
    /// For another party.
    On(Party),
    /// Until a time that is known.
    Until(Time),
    /// For an operator, or for the person who looks after a robot that cannot drive.
    Operator,
    /// For a way: a robot without a route, or a worker who was told to stop, where no party is known to be in the way.
    NoWay,
    /// For nothing: a robot without a task, or a worker who stands.
    Still,
}

impl Edge {
    /// The robot that the party waits for.
    pub fn robot(self) -> Option<RobotId> {
        if let Edge::On(Party::Robot(robot)) = self { Some(robot) } else { None }
    }
}

/// How a chain of waiting ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainEnd {
    /// In something that goes on by itself, or at a known time.
    Moves,
    /// With an operator.
    Operator,
    /// In a party that neither moves nor waits.
    Still(Party),
    /// In parties that wait for one another; this is the one with the least number, robots first.
    Cycle(Party),
}

impl ChainEnd {
    /// Whether nothing at the end of the chain will go on by itself.
    pub fn is_standstill(self) -> bool {
        matches!(self, ChainEnd::Still(_) | ChainEnd::Cycle(_))
    }
}

/// What one party waits for, since when, and how that ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wait {
    /// Why the party does not go on; nothing for workers, and for robots that do.
    pub why: Option<Why>,
    /// What the party waits for.
    pub edge: Edge,
    /// Since when the party has been waiting, for whatever reason; nothing if it moves or has nothing to do.
    pub since: Option<Time>,
    /// How the chain of waiting that begins with the party ends.
    pub end: ChainEnd,
    /// Since when the chain has ended in a standstill, if it does. A moment in which it did not does not count.
    pub standstill: Option<Time>,
    /// While people keep a robot where it is: its visit, since when, and when it was last seen to be kept.
    kept: Option<(u64, Time, Time)>,
    /// How long people have kept a robot in all, on its way to where it acts next.
    on_its_way: OnItsWay,
    /// The last standstill: since when, and when it was last seen.
    stood: Option<(Time, Time)>,
}

impl Wait {
    /// Whether an operator has to end the wait.
    pub fn is_for_an_operator(&self) -> bool {
        self.end == ChainEnd::Operator
    }
}

/// How long people have kept a robot since it last acted: lifted or set down a rack, or was picked from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct OnItsWay {
    acted: Option<u64>,
    waited: Span,
    /// Since when the robot has been waiting for a worker, or when that was last counted.
    from: Option<Time>,
}

/// Where a robot is in its work.
#[derive(Clone, Copy, Debug, Default)]
pub struct WorkProgress {
    /// The visit at which the robot is.
    pub visit: u64,
    /// The visit at which the robot last acted, if it did.
    pub acted: Option<u64>,
}

/// The robots that wait for a worker.
#[derive(Clone, Copy, Debug)]
struct WaitedFor {
    /// The robot that has stood still for the worker the longest, and since when.
    robot: RobotId,
    robot_since: Time,
    /// Since when robots have stood still for the worker, one after the other.
    since: Time,
    /// When a robot was last seen to stand still for the worker.
    last: Time,
}

/// How long a worker has been kept in one spot.
#[derive(Clone, Copy, Debug)]
struct InOneSpot {
    spot: Point,
    /// How long in that spot the worker has waited for a robot, for a way, or to let a robot pass.
    waited: Span,
    /// When the worker was last looked at.
    looked: Time,
}

/// A party for which nothing was noted yet.
const FRESH: Wait = Wait {
    why: None,
    edge: Edge::Moves,
    since: None,
    end: ChainEnd::Moves,
    standstill: None,
    kept: None,
    on_its_way: OnItsWay { acted: None, waited: Span::ZERO, from: None },
    stood: None,
};

/// What all parties wait for.
#[derive(Clone, Debug, Default)]
pub struct WaitGraph {
    robots: IdVec<RobotId, Wait>,
    workers: IdVec<WorkerId, Wait>,
    /// For each worker, the robot that waits for that worker, if any does.
    waited_for: IdVec<WorkerId, Option<WaitedFor>>,
    /// How long the fleet has kept each worker in one spot.
    spots: IdVec<WorkerId, Option<InOneSpot>>,
    /// Reused: which walk passed each party, while ends are searched for.
    walks: Vec<u32>,
    /// Reused: the parties of one walk.
    path: Vec<Party>,
}

impl WaitGraph {
    /// What a robot waits for, and how that ends.
    pub fn robot(&self, robot: RobotId) -> Wait {
        self.robots.get(robot).copied().unwrap_or(FRESH)
    }

    /// What a worker waits for, and how that ends.
    pub fn worker(&self, worker: WorkerId) -> Wait {
        self.workers.get(worker).copied().unwrap_or(FRESH)
    }

    /// What a party waits for, and how that ends.
    pub fn of(&self, party: Party) -> Wait {
        match party {
            Party::Robot(r) => self.robot(r),
            Party::Worker(w) => self.worker(w),
        }
    }

    /// The worker for whom a robot waits while that worker waits for the robot, directly or behind others; and since
    /// when.
    pub fn circle_with(&self, robot: RobotId) -> Option<(WorkerId, Time)> {
        let wait = self.robot(robot);
        let Edge::On(Party::Worker(worker)) = wait.edge else { return None };
        let is_in_it =
            matches!(wait.end, ChainEnd::Cycle(_)) && self.root(wait.end).contains(&Party::Robot(robot));
        wait.standstill.filter(|_| is_in_it).map(|since| (worker, since))
    }

    /// The robot that waits for a worker, and for nothing else that goes on; if there are several, the one that has
    /// done so the longest. Also since when some robot has.
    pub fn waits_for_worker(&self, worker: WorkerId) -> Option<(RobotId, Time)> {
        self.waited_for.get(worker).copied().flatten().map(|w| (w.robot, w.since))
    }

    /// The last robot along the chain of waiting from a robot on, which does not wait for another robot.
    pub fn last_robot(&self, robot: RobotId) -> RobotId {
        let mut last = robot;
        for _ in 0..self.robots.len() {
            let Some(next) = self.robots.get(last).and_then(|wait| wait.edge.robot()) else { break };
            last = next;
        }
        last
    }

    /// All robots that wait for a worker, the longest waiting first.
    pub fn waiting_for(&self, worker: WorkerId) -> Vec<RobotId> {
        let waits = self.robots.pairs().filter(|(_, w)| w.edge == Edge::On(Party::Worker(worker)));
        let mut found: Vec<_> = waits.map(|(r, w)| (w.since, r)).collect();
        found.sort_unstable();
        found.into_iter().map(|(_, r)| r).collect()
    }

    /// All parties, robots first.
    pub fn parties(&self) -> impl Iterator<Item = (Party, Wait)> {
        let robots = self.robots.pairs().map(|(r, w)| (Party::Robot(r), *w));
        robots.chain(self.workers.pairs().map(|(w, wait)| (Party::Worker(w), *wait)))
    }

    /// The parties in which a chain ends: all that wait for one another in a cycle, or the one that is still.
    pub fn root(&self, end: ChainEnd) -> Vec<Party> {
        let first = match end {
            ChainEnd::Moves | ChainEnd::Operator => return Vec::new(),
            ChainEnd::Still(party) => return vec![party],
            ChainEnd::Cycle(first) => first,
        };
        let mut cycle = vec![first];
        while let Edge::On(next) = self.of(cycle[cycle.len() - 1]).edge
            && next != first
            && cycle.len() <= self.robots.len() + self.workers.len()
        {
            cycle.push(next);
        }
        cycle
    }

    /// Robots that wait for workers and have come no farther for longer than `here`, or have waited for longer than
    /// `on_its_way` since they last acted; the longest waiting first, each with the worker for whom it waits now and
    /// for how long. This finds also robots whose workers walk, so that no chain stands still, and robots that drive to
    /// and fro.
    pub fn starving(&self, now: Time, here: Span, on_its_way: Span) -> Vec<(RobotId, WorkerId, Span)> {
        let kept = |(robot, wait): (RobotId, &Wait)| {
            let Edge::On(Party::Worker(worker)) = wait.edge else { return None };
            let here = wait.kept.map(|(_, since, _)| now - since).filter(|waited| *waited > here);
            let on_its_way = Some(wait.on_its_way.waited).filter(|waited| *waited > on_its_way);
            Some((here.max(on_its_way)?, robot, worker))
        };
        let mut starving: Vec<_> = self.robots.pairs().filter_map(kept).collect();
        starving.sort_unstable_by_key(|(waited, robot, _)| (std::cmp::Reverse(*waited), *robot));
        starving.into_iter().map(|(waited, robot, worker)| (robot, worker, waited)).collect()
    }

    /// Notes what a robot waits for at a visit, and why. To be called for each robot, then [`WaitGraph::find_ends`].
    pub fn note_robot(
        &mut self,
        robot: RobotId,
        progress: WorkProgress,
        (why, edge): (Option<Why>, Edge),
        now: Time,
    ) {
        while self.robots.get(robot).is_none() {
            self.robots.push(FRESH);
        }
        let wait = &mut self.robots[robot];
        note(wait, (why, edge), why.is_some(), now);
        let visit = progress.visit;
        let before = wait.kept.filter(|(at, _, last)| *at == visit && now - *last <= AGAIN);
        let on_worker = matches!(edge, Edge::On(Party::Worker(_)));
        wait.kept = match on_worker {
            true => Some((visit, before.map_or(now, |(_, since, _)| since), now)),
            false => before,
        };
        wait.on_its_way.note(progress.acted, on_worker, now);
    }

    /// Notes what a worker waits for, and where the worker is: nowhere if not on the floor. To be called for each
    /// worker.
    pub fn note_worker(&mut self, worker: WorkerId, at: Option<Point>, edge: Edge, now: Time) {
        while self.workers.get(worker).is_none() {
            self.workers.push(FRESH);
            self.spots.push(None);
        }
        let wait = &mut self.workers[worker];
        note(wait, (None, edge), matches!(edge, Edge::On(_) | Edge::NoWay), now);
        let is_kept = matches!(edge, Edge::On(_) | Edge::NoWay | Edge::Until(_));
        self.spots[worker] = at.map(|at| {
            let before = self.spots[worker].filter(|s| (s.spot - at).norm() <= SPOT_M);
            let mut here = before.unwrap_or(InOneSpot { spot: at, waited: Span::ZERO, looked: now });
            if is_kept {
                here.waited += now - here.looked;
            }
            here.looked = now;
            here
        });
    }

    /// How long in all the fleet has kept a worker in the present spot.
    pub fn kept_in_one_spot(&self, worker: WorkerId) -> Span {
        self.spots.get(worker).copied().flatten().map_or(Span::ZERO, |s| s.waited)
    }

    /// Finds where each chain ends, and since when it has ended in a standstill. O(robots and workers).
    pub fn find_ends(&mut self, now: Time) {
        let (robots, all) = (self.robots.len(), self.robots.len() + self.workers.len());
        let mut walks = std::mem::take(&mut self.walks);
        walks.clear();
        walks.resize(all, 0);
        for i in 0..all {
            self.walk(i, i as u32 + 1, &mut walks, now);
        }
        debug_assert!(walks.iter().all(|w| *w > 0), "every party has an end: {robots} robots of {all}");
        self.walks = walks;
        self.note_waited_for(now);
    }

    fn note_waited_for(&mut self, now: Time) {
        while self.waited_for.len() < self.workers.len() {
            self.waited_for.push(None);
        }
        for noted in self.waited_for.iter_mut() {
            *noted = noted.filter(|w| now - w.last <= AGAIN);
        }
        for (robot, wait) in self.robots.pairs() {
            let (Edge::On(Party::Worker(worker)), Some(since)) = (wait.edge, wait.standstill) else {
                continue;
            };
            let Some(noted) = self.waited_for.get(worker) else { continue };
            // Only a robot that waits now is named; it may be another than before.
            let named = noted.filter(|w| w.last == now && w.robot_since <= since);
            let (robot, robot_since) = named.map_or((robot, since), |w| (w.robot, w.robot_since));
            let since = noted.map_or(since, |w| w.since.min(since));
            self.waited_for[worker] = Some(WaitedFor { robot, robot_since, since, last: now });
        }
    }

    /// Walks from one party on until the end is known, and notes it for all parties of the walk.
    fn walk(&mut self, start: usize, number: u32, walks: &mut [u32], now: Time) {
        let mut path = std::mem::take(&mut self.path);
        path.clear();
        let mut party = self.party(start);
        let end = loop {
            let i = self.position(party);
            let Some(walk) = walks.get_mut(i) else { break ChainEnd::Moves };
            if *walk == number {
                let first = path.iter().position(|p| *p == party).expect("it is on this walk");
                break ChainEnd::Cycle(*path[first..].iter().min().expect("it has a member"));
            }
            if *walk > 0 {
                break self.of(party).end;
            }
            *walk = number;
            path.push(party);
            match self.of(party).edge {
                Edge::On(other) => party = other,
                Edge::Moves | Edge::Until(_) => break ChainEnd::Moves,
                Edge::Operator => break ChainEnd::Operator,
                Edge::NoWay | Edge::Still => break ChainEnd::Still(party),
            }
        };
        for party in &path {
            let wait = match party {
                Party::Robot(r) => &mut self.robots[*r],
                Party::Worker(w) => &mut self.workers[*w],
            };
            // A party that rests and is waited for by none is no standstill, but ends one for the parties that wait for
            // it.
            let stands = end.is_standstill() && wait.since.is_some();
            let before = wait.stood.filter(|(_, last)| now - *last <= MOMENT).map(|(since, _)| since);
            if stands {
                wait.stood = Some((before.unwrap_or(now), now));
            }
            (wait.end, wait.standstill) = (end, stands.then(|| before.unwrap_or(now)));
        }
        self.path = path;
    }

    fn party(&self, i: usize) -> Party {
        match i.checked_sub(self.robots.len()) {
            None => Party::Robot(RobotId::at(i)),
            Some(w) => Party::Worker(WorkerId::at(w)),
        }
    }

    fn position(&self, party: Party) -> usize {
        match party {
            Party::Robot(r) => r.ix(),
            Party::Worker(w) => self.robots.len() + w.ix(),
        }
    }
}

impl OnItsWay {
    fn note(&mut self, acted: Option<u64>, on_worker: bool, now: Time) {
        if self.acted != acted {
            *self = OnItsWay { acted, ..OnItsWay::default() };
        }
        self.waited += self.from.map_or(Span::ZERO, |from| now - from);
        self.from = on_worker.then_some(now);
    }
}

fn note(wait: &mut Wait, (why, edge): (Option<Why>, Edge), waits: bool, now: Time) {
    (wait.why, wait.edge) = (why, edge);
    wait.since = waits.then(|| wait.since.unwrap_or(now));
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ROBOTS: usize = 6;
    const WORKERS: usize = 3;

    fn party(i: usize) -> Party {
        if i < ROBOTS { Party::Robot(RobotId::at(i)) } else { Party::Worker(WorkerId::at(i - ROBOTS)) }
    }

    fn graph(edges: &[Edge], now: Time, graph: &mut WaitGraph) {
        for (i, edge) in edges.iter().enumerate() {
            match party(i) {
                Party::Robot(r) => {
                    let why = (*edge != Edge::Moves).then_some(Why::NoRoute);
                    graph.note_robot(r, WorkProgress::default(), (why, *edge), now);
                }
                Party::Worker(w) => graph.note_worker(w, None, *edge, now),
            }
        }
        graph.find_ends(now);
    }

    fn edge() -> impl Strategy<Value = Edge> {
        prop_oneof![
            6 => (0..ROBOTS + WORKERS).prop_map(|i| Edge::On(party(i))),
            1 => Just(Edge::Moves),
            1 => Just(Edge::Still),
            1 => Just(Edge::NoWay),
            1 => Just(Edge::Operator),
            1 => Just(Edge::Until(Time(7))),
        ]
    }

    /// The end of the chain from one party, found by walking so far that a cycle is certain.
    fn walked(edges: &[Edge], start: usize) -> ChainEnd {
        let position = |p: Party| match p {
            Party::Robot(r) => r.ix(),
            Party::Worker(w) => ROBOTS + w.ix(),
        };
        let mut at = start;
        for _ in 0..edges.len() {
            match edges[at] {
                Edge::On(p) => at = position(p),
                Edge::Moves | Edge::Until(_) => return ChainEnd::Moves,
                Edge::Operator => return ChainEnd::Operator,
                Edge::NoWay | Edge::Still => return ChainEnd::Still(party(at)),
            }
        }
        let (begun, mut least) = (at, party(at));
        while let Edge::On(p) = edges[at] {
            at = position(p);
            least = least.min(party(at));
            if at == begun {
                break;
            }
        }
        ChainEnd::Cycle(least)
    }

    proptest! {
        #[test]
        fn every_chain_ends_where_a_walk_along_it_does(
            edges in proptest::collection::vec(edge(), ROBOTS + WORKERS)
        ) {
            let mut found = WaitGraph::default();
            graph(&edges, Time(1), &mut found);
            for i in 0..edges.len() {
                prop_assert_eq!(found.of(party(i)).end, walked(&edges, i), "of {:?} in {:?}", party(i), edges);
            }
        }
    }

    #[test]
    fn the_last_robot_of_a_chain_waits_for_none_and_a_cycle_has_an_end_too() {
        let mut found = WaitGraph::default();
        let ends = [Edge::On(party(1)), Edge::On(party(2)), Edge::On(party(ROBOTS))];
        graph(&ends, Time(1), &mut found);
        assert_eq!([0, 1, 2].map(|r| found.last_robot(RobotId(r))), [RobotId(2); 3]);
        graph(&[Edge::On(party(1)), Edge::On(party(0))], Time(2), &mut found);
        assert!([RobotId(0), RobotId(1)].contains(&found.last_robot(RobotId(0))));
    }

    #[test]
    fn a_robot_starves_by_waiting_at_one_visit_or_on_the_whole_way_to_where_it_acts_next() {
        let (mut found, robot) = (WaitGraph::default(), RobotId(0));
        let (here, way) = (Span::from_secs(90), Span::from_secs(180));
        let worker = Edge::On(party(ROBOTS));
        // The longest wait after this many seconds, in each of which the robot was looked at once.
        let mut at = 0;
        let mut noted = |seconds: i64, visit: u64, acted: Option<u64>, edge: Edge| {
            let mut longest = None;
            for _ in 0..seconds {
                let now = Time(at * 1_000_000);
                found.note_robot(robot, WorkProgress { visit, acted }, (None, edge), now);
                longest = found.starving(now, here, way).first().map(|(_, _, waited)| waited.as_secs_f64());
                at += 1;
            }
            longest
        };
        assert_eq!(noted(91, 1, None, worker), None);
        assert_eq!(noted(1, 1, None, worker), Some(91.0));
        assert_eq!(noted(20, 2, None, Edge::Moves), None, "it drives on");
        assert_eq!(noted(80, 1, None, worker), None);
        assert_eq!(noted(20, 2, None, Edge::Moves), None);
        assert_eq!(noted(20, 1, None, worker), Some(191.0), "to and fro");
        assert_eq!(noted(1, 1, Some(1), worker), None, "it has acted");
    }

    #[test]
    fn a_wait_in_one_spot_adds_up_though_it_is_interrupted_and_ends_where_the_person_leaves() {
        let (mut found, worker) = (WaitGraph::default(), WorkerId(0));
        let mut kept = |s: i64, x: Option<f64>, edge: Edge| {
            found.note_worker(worker, x.map(|x| Point::new(x, 0.0)), edge, Time(s * 1_000_000));
            found.kept_in_one_spot(worker)
        };
        let seconds = Span::from_secs;
        assert_eq!(kept(0, Some(0.0), Edge::NoWay), Span::ZERO);
        assert_eq!(kept(10, Some(0.5), Edge::On(party(0))), seconds(10));
        assert_eq!(kept(20, Some(-0.5), Edge::Moves), seconds(10), "it walks");
        assert_eq!(kept(30, Some(0.0), Edge::Until(Time(9))), seconds(20));
        assert_eq!(kept(40, Some(2.0), Edge::NoWay), Span::ZERO, "somewhere else");
        assert_eq!(
            (kept(50, Some(2.0), Edge::NoWay), kept(60, None, Edge::Moves)),
            (seconds(10), Span::ZERO)
        );
    }

    #[test]
    fn a_standstill_is_as_old_as_the_first_step_in_which_the_chain_ended_so() {
        let mut found = WaitGraph::default();
        let still = |last| [Edge::On(party(1)), Edge::On(party(2)), last];
        graph(&still(Edge::Moves), Time(1), &mut found);
        assert_eq!(found.robot(RobotId(0)).standstill, None);
        graph(&still(Edge::Still), Time(2), &mut found);
        graph(&still(Edge::On(party(0))), Time(3), &mut found);
        let wait = found.robot(RobotId(0));
        assert_eq!((wait.since, wait.standstill), (Some(Time(1)), Some(Time(2))));
        assert_eq!(wait.end, ChainEnd::Cycle(party(0)));
        graph(&still(Edge::Until(Time(9))), Time(4), &mut found);
        assert_eq!(found.robot(RobotId(0)).standstill, None);
        graph(&still(Edge::Still), Time(5), &mut found);
        assert_eq!(found.robot(RobotId(0)).standstill, Some(Time(2)), "it went on for a moment only");
        graph(&still(Edge::Moves), Time(6), &mut found);
        let later = Time(5) + MOMENT + Span(1);
        graph(&still(Edge::Still), later, &mut found);
        assert_eq!(found.robot(RobotId(0)).standstill, Some(later));
    }
}
