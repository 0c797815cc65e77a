//! Why a robot or a job waits, to the root: the resource, its holder, until when, and what the holder waits for.
//!
//! Main types: [`Waiting`], [`Because`], [`Standstill`]. The chain is that of the wait-for graph, which every step
//! notes; only until when, and how many pass before, is added on demand. Refuses: to find out reasons of its own, to
//! change anything, and to promise: windows slide when a robot is late.

use crate::Fleet;
use crate::JobState;
use crate::people::keep_out::COMES_OUT;
use crate::read::view::{JobWhy, View};
use crate::state::fact::{Act, Task};
use crate::state::floor::Floor;
use crate::state::wait_graph::{ChainEnd, Edge, Party, Wait};
use crate::state::why::Why;
use crate::traffic::state::Withheld;
use giveway_floor::id::{ClosureId, Dense, JobId, NodeId, ResourceId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::human::{Presence, Whereabouts};
use std::collections::BTreeSet;

/// How many links a chain has at most; it is seldom longer than the queue of a station.
const LONGEST: usize = 40;

/// A robot's action at a stop takes no longer than this, apart from a pick, which takes this beyond its planned time.
const HANDLES: Span = Span::from_secs(30);

/// A worker of whose place no source knows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LostWorker {
    /// The worker.
    pub worker: WorkerId,
    /// For how long the worker has been silent.
    pub silent: Span,
    /// Robots that wait for the worker, the longest waiting first.
    pub waiting: Vec<RobotId>,
}

/// One link of a chain of waiting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Waiting {
    /// What waits, or what the link before waits for.
    pub who: Who,
    /// What the robot, job or worker waits for.
    pub because: Because,
    /// Until when the wait lasts, as things stand; nothing if that cannot be known, as for all links of a chain whose
    /// end has no known time.
    pub until: Option<Time>,
    /// How many holders pass before, if a resource is waited for.
    pub ahead: usize,
}

/// What a link is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Who {
    /// A robot.
    Robot(RobotId),
    /// A job.
    Job(JobId),
    /// A worker, for whom a robot waits.
    Worker(WorkerId),
}

/// Robots and workers that wait for something that will not go on by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Standstill {
    /// How their chains of waiting end.
    pub end: ChainEnd,
    /// The parties that wait for one another, if the end is a cycle; otherwise the party at the end.
    pub root: Vec<Party>,
    /// All parties that wait for the root, directly or behind others.
    pub behind: Vec<Party>,
    /// Since when there has been a standstill with this root or any other: when the first party began to wait in vain.
    pub since: Time,
}

/// Why the party of a link does not go on, or what it is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Because {
    /// A job waits.
    Job(JobWhy),
    /// A robot waits.
    Robot(Why),
    /// A robot acts at a stop, and then goes on.
    AtStop(Act),
    /// A robot drives: what it holds is free once it has left.
    Drives,
    /// A robot's way goes on at a set time.
    Later,
    /// A robot stands where it may stay, and nothing moves it.
    Stays,
    /// A worker walks on, or is at work.
    Walks,
    /// A worker waits for this robot, which is in the way.
    InTheWay(RobotId),
    /// A worker was told to stop: there is no way on.
    NoWay,
    /// A worker stands, and may walk on or not.
    Stands,
    /// A worker's headset has lost its place: a person has to look.
    Lost,
}

impl Because {
    /// Whether the robot or the job does not go on because of something else.
    pub fn is_waiting(&self) -> bool {
        matches!(self, Because::Job(_) | Because::Robot(_) | Because::InTheWay(_) | Because::NoWay)
    }
}

impl Fleet {
    /// Why a robot does not go on, to the root. The first link is about the robot itself, whether it waits or not.
    pub fn waits(&self, robot: RobotId, now: Time) -> Vec<Waiting> {
        let mut chain = Vec::new();
        self.follow(robot, now, &mut chain);
        chain
    }

    /// Why a job does not go on, to the root; nothing if the job is over.
    pub fn job_waits(&self, job: JobId, now: Time) -> Vec<Waiting> {
        let view = self.view(now);
        let mut chain = Vec::new();
        let mut next = Some(job);
        while let Some(id) = next {
            next = self.follow_job(&view, id, now, &mut chain);
        }
        chain
    }

    /// Adds one link for a job, and the links of the robot behind it. Returns the job that it waits for.
    fn follow_job(&self, view: &View, id: JobId, now: Time, chain: &mut Vec<Waiting>) -> Option<JobId> {
        let job = self.writer.ledger().jobs.get(&id)?;
        let who = Who::Job(id);
        if chain.len() >= LONGEST || chain.iter().any(|w| w.who == who) {
            return None;
        }
        let Some(why) = view.why_job(self.writer.warehouse(), id, job) else {
            if let Some(robot) = job.state.robot() {
                self.follow(robot, now, chain);
            }
            return None;
        };
        let robot = match why {
            JobWhy::RackBusy(_, robot, _) | JobWhy::RobotBusy(robot, _) | JobWhy::Robot(robot, _) => {
                Some(robot)
            }
            JobWhy::RackBlocked(_, robot) | JobWhy::NodeTaken(_, robot) | JobWhy::RobotLow(robot) => {
                Some(robot)
            }
            JobWhy::StationBlocked(_, robot) | JobWhy::WayBlocked(robot) | JobWhy::RacksWait(_, robot) => {
                Some(robot)
            }
            JobWhy::StationFull(station) => view.stations.get(station.ix()).and_then(|s| s.robot),
            JobWhy::After(_)
            | JobWhy::NoRobot
            | JobWhy::Outranked(_)
            | JobWhy::NoKind
            | JobWhy::StationPaused(_)
            | JobWhy::ClosedOff
            | JobWhy::WayClosed(_)
            | JobWhy::NoPlace(_) => None,
        };
        let (until, ahead) =
            (None, if let JobWhy::Outranked(ahead) = why { ahead.higher + ahead.others } else { 0 });
        // A job that has its robot waits for what the robot waits for: the link of the robot says it.
        if job.state == JobState::Waiting {
            chain.push(Waiting { who, because: Because::Job(why), until, ahead });
        }
        if let Some(robot) = robot {
            self.follow(robot, now, chain);
        }
        if let JobWhy::After(first) = why { Some(first) } else { None }
    }

    /// Adds the links from a robot on.
    fn follow(&self, robot: RobotId, now: Time, chain: &mut Vec<Waiting>) {
        let (begin, mut seen) = (chain.len(), BTreeSet::new());
        let mut next = Some(Party::Robot(robot));
        let mut wanted = None;
        while let Some(party) = next
            && chain.len() < LONGEST
            && seen.insert(party)
        {
            let link = match party {
                Party::Robot(r) => self.robot_link(r, wanted, now),
                Party::Worker(w) => self.worker_link(w),
            };
            chain.push(link);
            wanted = match link.because {
                Because::Robot(Why::WaitsFor(resource, _)) => Some((resource, link.until)),
                _ => None,
            };
            next = match self.writer.waits.of(party).edge {
                Edge::On(other) => Some(other),
                Edge::Moves | Edge::Until(_) | Edge::Operator | Edge::NoWay | Edge::Still => None,
            };
        }
        // What is planned behind something whose end is unknown is put off again and again.
        let has_time = next.is_none() && chain.last().is_some_and(|root| root.until.is_some());
        if !has_time {
            chain[begin..].iter_mut().for_each(|link| link.until = None);
        }
    }

    /// Whether a robot's action at a stop takes longer than planned, so that its plan is put off again and again.
    fn is_overdue(&self, robot: RobotId, act: Act, now: Time) -> bool {
        let (_, since) = self.activity(robot, now);
        let job =
            self.writer.ledger().robots[robot].task.job().and_then(|id| self.writer.ledger().jobs.get(&id));
        let planned = match (act, job) {
            // How long the lines of a visit take is estimated anew all the time.
            (Act::Pick(_), Some(job)) if job.lines_now().is_some() => return false,
            (Act::Pick(_), Some(job)) => job.request.stations().next().and_then(|visit| {
                Some(visit.pick.unwrap_or(self.writer.warehouse().stations.get(visit.station)?.pick))
            }),
            _ => None,
        };
        now - since > planned.unwrap_or(Span::ZERO) + HANDLES
    }

    /// What a robot waits for. `wanted` is the robot's resource that the link before waits for, and when it is to be
    /// free.
    fn robot_link(&self, robot: RobotId, wanted: Option<(ResourceId, Option<Time>)>, now: Time) -> Waiting {
        let who = Who::Robot(robot);
        let link = |because, until: Option<Time>, ahead| Waiting {
            who,
            because,
            until: until.filter(|t| !t.is_forever() && *t > now),
            ahead,
        };
        let chain = self.writer.ledger().chain(robot);
        let why = self.why(robot);
        // A robot that is broken, silent or told to stand is so at a stop, too.
        let stopped = why.is_some_and(Why::is_by_itself);
        if let Some(act) = self.floor().act_here(robot).filter(|_| !stopped) {
            let planned = chain.get(chain.first()).map(|v| v.depart);
            let until = planned.filter(|_| !self.is_overdue(robot, act, now));
            return link(Because::AtStop(act), until, 0);
        }
        let Some(why) = why else { return self.floor().goes_on(robot, wanted, now, link) };
        let (until, ahead) = match why {
            Why::WaitsFor(..) => {
                let before = self.writer.ledger().timeline().before(robot, chain.granted());
                let before = before.map(|(_, held)| held).unwrap_or_default();
                (before.iter().map(|h| h.window.end()).max(), before.len())
            }
            Why::GivesWay(_) | Why::Closed(_) => match self.traffic.withheld(robot) {
                Some(Withheld::Condition(_, until)) => (until, 0),
                _ => (None, 0),
            },
            _ => (None, 0),
        };
        link(Because::Robot(why), until, ahead)
    }

    /// What a worker waits for.
    fn worker_link(&self, worker: WorkerId) -> Waiting {
        let because = match self.writer.waits.worker(worker).edge {
            Edge::On(Party::Robot(robot)) => Because::InTheWay(robot),
            Edge::NoWay => Because::NoWay,
            Edge::Still => Because::Stands,
            Edge::Operator => Because::Lost,
            Edge::Moves | Edge::Until(_) | Edge::On(Party::Worker(_)) => Because::Walks,
        };
        Waiting { who: Who::Worker(worker), because, until: None, ahead: 0 }
    }

    /// Why a robot does not go on, if it does not, as of the last step.
    pub fn why(&self, robot: RobotId) -> Option<Why> {
        self.writer.waits.robot(robot).why
    }

    /// What a robot or a worker waits for, as of the last step.
    pub fn wait(&self, party: Party) -> Wait {
        self.writer.waits.of(party)
    }

    /// Workers of whom no source has known for this long: robots stay out of all places that each may have reached.
    pub fn lost_workers(&self, long: Span, now: Time) -> Vec<LostWorker> {
        let people = self.people.people.pairs();
        let lost = people.filter_map(|(worker, person)| {
            let silent = person.track.silent(now).filter(|s| *s > long)?;
            let waiting = self.writer.waits.waiting_for(worker);
            Some(LostWorker { worker, silent, waiting })
        });
        lost.collect()
    }

    /// Workers who are in an area that is closed to people, though they had time to leave it.
    pub fn in_closed_areas(&self, now: Time) -> Vec<(WorkerId, ClosureId)> {
        let inside = |(worker, place): (WorkerId, Whereabouts)| {
            let closure = self.people.barred.closed_for(place.at, COMES_OUT, now)?;
            (place.presence != Presence::Lost).then_some((worker, closure))
        };
        self.people.present(now).into_iter().filter_map(inside).collect()
    }

    /// Workers whom the fleet has kept in one spot for longer than this, and for how long: waiting for a robot, for a
    /// way, or to let a robot pass.
    pub fn kept_workers(&self, long: Span) -> Vec<(WorkerId, Span)> {
        let waited = |worker| (worker, self.writer.waits.kept_in_one_spot(worker));
        self.people.people.ids().map(waited).filter(|(_, waited)| *waited > long).collect()
    }

    /// Whether any place is closed for a while because a robot could not get there.
    pub fn has_obstructions(&self) -> bool {
        self.traffic.has_obstructions()
    }

    /// Places at which a robot reported an obstacle and from which it has turned away; they are closed until they are
    /// tried again. Each with the robot, and since when.
    pub fn left_obstacles(&self) -> Vec<(NodeId, RobotId, Time)> {
        self.traffic.left_obstacles(self.floor()).collect()
    }

    /// Robots and workers that wait without anything that would set them free, as of the last step.
    pub fn standstills(&self) -> Vec<Standstill> {
        let mut by_root: Vec<Standstill> = Vec::new();
        let waits = self.writer.waits.parties();
        for (party, wait) in waits.filter(|(_, wait)| wait.standstill.is_some()) {
            let since = wait.standstill.expect("just seen");
            let i = by_root.iter().position(|s| s.end == wait.end).unwrap_or_else(|| {
                let (root, behind) = (self.writer.waits.root(wait.end), Vec::new());
                by_root.push(Standstill { end: wait.end, root, behind, since });
                by_root.len() - 1
            });
            let found = &mut by_root[i];
            found.since = found.since.min(since);
            if !found.root.contains(&party) {
                found.behind.push(party);
            }
        }
        by_root
    }
}

impl Floor<'_> {
    /// The link of a robot that waits for nothing.
    fn goes_on(
        &self,
        robot: RobotId,
        wanted: Option<(ResourceId, Option<Time>)>,
        now: Time,
        link: impl Fn(Because, Option<Time>, usize) -> Waiting,
    ) -> Waiting {
        let chain = self.ledger.chain(robot);
        if chain.granted() > chain.first() + 1 {
            return link(Because::Drives, wanted.and_then(|(_, until)| until), 0);
        }
        let next = chain.get(chain.granted()).map(|v| v.enter);
        match next {
            Some(enter) if enter > now => link(Because::Later, Some(enter), 0),
            Some(_) => link(Because::Drives, wanted.and_then(|(_, until)| until), 0),
            None if self.ledger.robots[robot].task == Task::Idle => link(Because::Stays, None, 0),
            None => link(Because::Later, None, 0),
        }
    }
}
