//! Why a robot or a job waits, to the root: the resource, its holder, until when, and what the holder waits for.
//!
//! Main types: [`Waiting`], [`Because`]. Worked out on demand for one robot or one job, never for all of them in a
//! step. The order of holders on every resource is fixed, so no robot waits for itself; the walk ends at a second
//! visit all the same. Refuses: to change anything, and to promise: windows slide when a robot is late.

use crate::fleet::Fleet;
use crate::fleet::JobState;
use crate::fleet::read::view::{JobWhy, View, Why};
use crate::fleet::state::fact::{Act, Task};
use crate::fleet::state::floor::Floor;
use crate::fleet::traffic::state::Withheld;
use crate::id::{JobId, ResourceId, RobotId};
use crate::time::Time;
use crate::timeline::Holder;
use std::collections::BTreeSet;

/// So many links at most; a chain is seldom longer than the queue of a station.
const LONGEST: usize = 40;

/// One link of the chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Waiting {
    /// What waits, or what the link before waits for.
    pub who: Who,
    /// For what.
    pub because: Because,
    /// Until when, as things stand; nothing where that cannot be known.
    pub until: Option<Time>,
    /// How many holders pass before, where a resource is waited for.
    pub ahead: usize,
}

/// What a link is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Who {
    /// A robot.
    Robot(RobotId),
    /// A job.
    Job(JobId),
}

/// What a link says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Because {
    /// A job waits.
    Job(JobWhy),
    /// A robot waits.
    Robot(Why),
    /// A robot is doing something at a stop, and goes on then.
    AtStop(Act),
    /// A robot drives: what it holds is free when it has left.
    Drives,
    /// A robot's way goes on at a set time.
    Later,
    /// A robot stands where it may stay, and nothing moves it.
    Stays,
}

impl Because {
    /// Whether the robot or the job does not go on because of something else.
    pub fn is_waiting(&self) -> bool {
        matches!(self, Because::Job(_) | Because::Robot(_))
    }
}

impl Fleet {
    /// Why a robot does not go on, to the root. The first link is about the robot itself, whether it waits or not.
    pub fn waits(&self, robot: RobotId, now: Time) -> Vec<Waiting> {
        let mut chain = Vec::new();
        self.follow(robot, now, &mut chain);
        chain
    }

    /// Why a job does not go on, to the root; nothing where it is over.
    pub fn job_waits(&self, job: JobId, now: Time) -> Vec<Waiting> {
        let view = self.view(now);
        let mut chain = Vec::new();
        let mut next = Some(job);
        while let Some(id) = next {
            next = self.follow_job(&view, id, now, &mut chain);
        }
        chain
    }

    /// One link for a job, and the links of the robot behind it. Gives the job that it waits for.
    fn follow_job(&self, view: &View, id: JobId, now: Time, chain: &mut Vec<Waiting>) -> Option<JobId> {
        let job = self.core.ledger.jobs.get(&id)?;
        let who = Who::Job(id);
        if chain.len() >= LONGEST || chain.iter().any(|w| w.who == who) {
            return None;
        }
        let Some(why) = view.why_job(self.core.warehouse(), id, job) else {
            if let Some(robot) = job.state.robot() {
                self.follow(robot, now, chain);
            }
            return None;
        };
        let robot = match why {
            JobWhy::RackBusy(_, robot, _) | JobWhy::RobotBusy(robot, _) | JobWhy::Robot(robot, _) => {
                Some(robot)
            }
            JobWhy::RackBlocked(_, robot) | JobWhy::RobotLow(robot) => Some(robot),
            JobWhy::After(_)
            | JobWhy::NoRobot
            | JobWhy::NoKind
            | JobWhy::StationFull(_)
            | JobWhy::StationPaused(_)
            | JobWhy::ClosedOff
            | JobWhy::NoPlace(_) => None,
        };
        let until = None;
        // A job that has its robot waits for what the robot waits for: the robot's own link says it.
        if job.state == JobState::Waiting {
            chain.push(Waiting { who, because: Because::Job(why), until, ahead: 0 });
        }
        if let Some(robot) = robot {
            self.follow(robot, now, chain);
        }
        if let JobWhy::After(first) = why { Some(first) } else { None }
    }

    /// The links from a robot on.
    fn follow(&self, robot: RobotId, now: Time, chain: &mut Vec<Waiting>) {
        let mut seen = BTreeSet::new();
        let mut next = Some(robot);
        let mut wanted = None;
        while let Some(r) = next {
            if chain.len() >= LONGEST || !seen.insert(r) {
                return;
            }
            let (link, behind) = self.link(r, wanted, now);
            chain.push(link);
            wanted = match link.because {
                Because::Robot(Why::WaitsFor(resource, _)) => Some((resource, link.until)),
                _ => None,
            };
            next = behind;
        }
    }

    /// What a robot waits for, and the robot behind that. `wanted` is what the link before wants of it, and when
    /// that is to be free.
    fn link(
        &self,
        robot: RobotId,
        wanted: Option<(ResourceId, Option<Time>)>,
        now: Time,
    ) -> (Waiting, Option<RobotId>) {
        let who = Who::Robot(robot);
        let link = |because, until: Option<Time>, ahead| Waiting {
            who,
            because,
            until: until.filter(|t| !t.is_forever()),
            ahead,
        };
        let chain = self.core.ledger.chain(robot);
        let why = self.why(robot, now);
        // A robot that is broken, silent or told to stand is so at a stop, too.
        let stopped = why.is_some_and(Why::is_by_itself);
        if let Some(act) = self.floor().act_here(robot).filter(|_| !stopped) {
            let until = chain.get(chain.first()).map(|v| v.depart);
            return (link(Because::AtStop(act), until, 0), None);
        }
        match why {
            Some(why @ Why::WaitsFor(_, holder)) => {
                let before = self.core.ledger.timeline().before(Holder::Robot(robot), chain.granted());
                let before = before.map(|(_, held)| held).unwrap_or_default();
                let until = before.iter().map(|h| h.window.end()).max();
                let behind = if let Holder::Robot(b) = holder { Some(b) } else { None };
                (link(Because::Robot(why), until, before.len()), behind)
            }
            Some(why @ (Why::GivesWay(_) | Why::Closed(_))) => {
                let until = match self.traffic.withheld(robot) {
                    Some(Withheld::Condition(_, until)) => until,
                    _ => None,
                };
                (link(Because::Robot(why), until, 0), None)
            }
            Some(why @ Why::BlockedBy(other)) => (link(Because::Robot(why), None, 0), Some(other)),
            Some(why @ Why::QueueFull(station)) => {
                let node = self.core.warehouse().stations[station].node;
                let there = self.core.ledger.present().find(|r| self.core.ledger.node_of(*r) == node);
                (link(Because::Robot(why), None, 0), there.filter(|r| *r != robot))
            }
            Some(why) => (link(Because::Robot(why), None, 0), None),
            None => (self.floor().goes_on(robot, wanted, now, link), None),
        }
    }
}

impl Floor<'_> {
    /// A robot that waits for nothing.
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

    /// What a robot does at the stop where it is, if that is not done yet.
    fn act_here(&self, robot: RobotId) -> Option<Act> {
        let here = self.ledger.chain(robot).first();
        let stop = self.ledger.robots[robot].stops.first().filter(|s| s.serial == here)?;
        (stop.act != Act::Arrive).then_some(stop.act)
    }
}
