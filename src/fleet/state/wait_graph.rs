//! The wait-for graph: what each robot and each worker waits for, in this step.
//!
//! Main types: [`WaitGraph`], [`Party`], [`Edge`], [`ChainEnd`]. Each party waits for one other at most, or for
//! something that is no party: a time, an operator, a route. So a walk along the edges comes to one end, or round and
//! round in a cycle, and the ends of all walks together cost one visit of each party. A chain whose end neither moves
//! nor has a known time nor is an operator's to end is a *standstill*. Refuses: to find out what anything waits for,
//! and to end a standstill.

use crate::fleet::state::why::Why;
use crate::id::{Dense, IdVec, RobotId, WorkerId};
use crate::time::{Span, Time};

/// A standstill that begins again within this has never ended: a robot tries another way in vain, a person shifts from
/// one foot to the other.
const MOMENT: Span = Span::from_secs(3);

/// Robots that wait for the same worker again within this wait for one thing: one that tries another way in vain comes
/// back.
const AGAIN: Span = Span::from_secs(15);

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
    /// For nothing: it drives, walks, is at work, or goes on when its planned time comes.
    Moves,
    /// For another party.
    On(Party),
    /// Until a time that is known.
    Until(Time),
    /// For an operator, or for whoever looks after a robot that cannot drive.
    Operator,
    /// For a way: a robot without a route, or a worker who was told to stop, where no party is known to be in the way.
    NoWay,
    /// For nothing: a robot without a task, a worker who stands.
    Still,
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
    /// In parties that wait for one another; this one of them, robots first, has the least number.
    Cycle(Party),
}

impl ChainEnd {
    /// Whether nothing at the end of the chain will go on by itself.
    pub fn is_standstill(self) -> bool {
        matches!(self, ChainEnd::Still(_) | ChainEnd::Cycle(_))
    }
}

/// One party and how its waiting stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wait {
    /// Why it does not go on; nothing for workers, and for robots that do.
    pub why: Option<Why>,
    /// What it waits for.
    pub edge: Edge,
    /// Since when it has been waiting, whatever for; nothing where it moves or has nothing to do.
    pub since: Option<Time>,
    /// How the chain of waiting ends that begins here.
    pub end: ChainEnd,
    /// Since when its chain has ended in a standstill, if it does. A moment in which it did not does not count.
    pub standstill: Option<Time>,
    /// While people keep a robot where it is: the visit at which it is, since when, and when one was seen to last.
    kept: Option<(u64, Time, Time)>,
    /// The last standstill: since when, and when it was seen last.
    stood: Option<(Time, Time)>,
}

impl Wait {
    /// Whether an operator has to end it.
    pub fn is_for_an_operator(&self) -> bool {
        self.end == ChainEnd::Operator
    }
}

/// Who waits for a worker.
#[derive(Clone, Copy, Debug)]
struct WaitedFor {
    /// The robot that has stood still for the worker the longest, and since when.
    robot: RobotId,
    robot_since: Time,
    /// Since when some robot has, one after the other.
    since: Time,
    /// When one was seen to last.
    last: Time,
}

/// A party for which nothing was noted yet.
const FRESH: Wait = Wait {
    why: None,
    edge: Edge::Moves,
    since: None,
    end: ChainEnd::Moves,
    standstill: None,
    kept: None,
    stood: None,
};

/// What all parties wait for.
#[derive(Clone, Debug, Default)]
pub(in crate::fleet) struct WaitGraph {
    robots: IdVec<RobotId, Wait>,
    workers: IdVec<WorkerId, Wait>,
    /// For each worker, who waits for that worker, if any robot does.
    waited_for: IdVec<WorkerId, Option<WaitedFor>>,
    /// Reused: which walk came by a party, while ends are looked for.
    walks: Vec<u32>,
    /// Reused: the parties of one walk.
    path: Vec<Party>,
}

impl WaitGraph {
    /// How the waiting of a robot stands.
    pub fn robot(&self, robot: RobotId) -> Wait {
        self.robots.get(robot).copied().unwrap_or(FRESH)
    }

    /// How the waiting of a worker stands.
    pub fn worker(&self, worker: WorkerId) -> Wait {
        self.workers.get(worker).copied().unwrap_or(FRESH)
    }

    /// How the waiting of a party stands.
    pub fn of(&self, party: Party) -> Wait {
        match party {
            Party::Robot(r) => self.robot(r),
            Party::Worker(w) => self.worker(w),
        }
    }

    /// The worker for whom a robot waits while that worker waits for it, directly or behind others; with since when.
    pub fn circle_with(&self, robot: RobotId) -> Option<(WorkerId, Time)> {
        let wait = self.robot(robot);
        let Edge::On(Party::Worker(worker)) = wait.edge else { return None };
        let is_in_it =
            matches!(wait.end, ChainEnd::Cycle(_)) && self.root(wait.end).contains(&Party::Robot(robot));
        wait.standstill.filter(|_| is_in_it).map(|since| (worker, since))
    }

    /// The robot that waits for a worker, and for nothing else that goes on; of several, the one that has done so for
    /// the longest. With since when some robot has.
    pub fn waits_for_worker(&self, worker: WorkerId) -> Option<(RobotId, Time)> {
        self.waited_for.get(worker).copied().flatten().map(|w| (w.robot, w.since))
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

    /// Robots that wait for workers and have come no farther for so long, the longest waiting first, each with the
    /// worker that it waits for now and since when it has come no farther: also where those workers walk, so that no
    /// chain stands still.
    pub fn starving(&self, now: Time, long: Span) -> Vec<(RobotId, WorkerId, Time)> {
        let kept = |(robot, wait): (RobotId, &Wait)| {
            let Edge::On(Party::Worker(worker)) = wait.edge else { return None };
            let (_, since, _) = wait.kept.filter(|(_, since, _)| now - *since > long)?;
            Some((since, robot, worker))
        };
        let mut starving: Vec<_> = self.robots.pairs().filter_map(kept).collect();
        starving.sort_unstable();
        starving.into_iter().map(|(since, robot, worker)| (robot, worker, since)).collect()
    }

    /// Notes what a robot waits for at a visit, and why. To be called for each robot, then [`WaitGraph::find_ends`].
    pub fn note_robot(&mut self, robot: RobotId, at: u64, (why, edge): (Option<Why>, Edge), now: Time) {
        while self.robots.get(robot).is_none() {
            self.robots.push(FRESH);
        }
        let wait = &mut self.robots[robot];
        note(wait, (why, edge), why.is_some(), now);
        let before = wait.kept.filter(|(visit, _, last)| *visit == at && now - *last <= AGAIN);
        wait.kept = match edge {
            Edge::On(Party::Worker(_)) => Some((at, before.map_or(now, |(_, since, _)| since), now)),
            _ => before,
        };
    }

    /// Notes what a worker waits for, likewise.
    pub fn note_worker(&mut self, worker: WorkerId, edge: Edge, now: Time) {
        while self.workers.get(worker).is_none() {
            self.workers.push(FRESH);
        }
        let wait = &mut self.workers[worker];
        note(wait, (None, edge), matches!(edge, Edge::On(_) | Edge::NoWay), now);
    }

    /// Where each chain ends, and since when it has ended in a standstill. O(robots and workers).
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
            // The robot that waits now is named; another one may have begun to.
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
            // What rests and is waited for by none is no standstill, but the end of one for those that wait for it.
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
                    graph.note_robot(r, 0, (why, *edge), now);
                }
                Party::Worker(w) => graph.note_worker(w, *edge, now),
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

    /// The end of the chain from one party, by walking so far that a cycle is certain.
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
