//! The read model: everything that is seen of the fleet from outside, as one immutable value.
//!
//! Main types: [`View`], [`RobotView`], [`JobWhy`]. Made on demand by [`crate::Fleet::view`], since
//! a simulation of an hour needs none of the 36 000 it could have. Refuses: to be an input of any decision.

use crate::state::activity::{Activity, Doing};
use crate::state::arms::ArmView;
use crate::state::cut_off::{Barrier, CutOff};
use crate::state::fact::Task;
use crate::state::fault::Fault;
use crate::state::io::WrongReach;
use crate::state::job::{Job, JobRequest, JobState, RobotChoice};
use crate::state::job_kind::JobKind;
use crate::state::kinds::RobotKinds;
use crate::state::ledger::{RackAt, Unconfirmed};
use crate::state::link::LinkState;
use crate::state::note::ReplanCause;
use crate::state::recurring::RecurringClosure;
use crate::state::visits::EndsHeld;
use crate::state::why::Why;
use crate::state::worker::{ClosureView, WorkerView};
use crate::traffic::state::InsertionCounts;
use giveway_cell::{Lines, Remaining, SeenReach};
use giveway_floor::geometry::Pose;
use giveway_floor::id::{
    BodyId, ClosureId, Dense, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_floor::time::Time;
use giveway_floor::warehouse::{NodeKind, Warehouse};
use giveway_people::aware::zone_answers::ZoneCounts;
use giveway_people::human::HorizonCoverage;
use smallvec::SmallVec;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// How many jobs in line a view has at most.
pub const LINE: usize = 100;

/// The building as a view has it. Two are equal if they are the same object; a view of no fleet has none.
#[derive(Clone, Debug, Default)]
pub struct ViewBuilding(pub Option<Arc<Warehouse>>);

impl PartialEq for ViewBuilding {
    fn eq(&self, other: &ViewBuilding) -> bool {
        match (&self.0, &other.0) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        }
    }
}

/// The fleet at one moment.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct View {
    /// The moment.
    pub now: Time,
    /// Every robot, by number.
    pub robots: Vec<RobotView>,
    /// Every rack, by number.
    pub racks: Vec<RackAt>,
    /// Every station, by number.
    pub stations: Vec<StationView>,
    /// Every worker, by number.
    pub workers: Vec<WorkerView>,
    /// Closed areas.
    pub closures: Vec<ClosureView>,
    /// Areas that are closed again and again.
    pub recurring: BTreeMap<SeriesId, RecurringClosure>,
    /// Since when all people are to leave the building.
    pub evacuation: Option<Time>,
    /// Waiting jobs that come after others, each with one that is not over yet. A robot that several jobs name does one
    /// of them first.
    pub blocked: BTreeMap<JobId, JobId>,
    /// Nodes that robots without a route cannot reach before the named robot leaves: it is going to stay there for a
    /// job, or stands there with a rack.
    pub kept: BTreeMap<NodeId, RobotId>,
    /// All robot kinds, including those of which no robot is.
    pub all_kinds: RobotKinds,
    /// The building for all kinds.
    pub building: ViewBuilding,
    /// The kinds of the robots that have joined.
    pub kinds: BTreeSet<BodyId>,
    /// How many robots of each kind could take a job now; kinds without such robots are left out.
    pub free: BTreeMap<BodyId, usize>,
    /// The kind and the node of each robot that could take a job now.
    pub free_at: Vec<(BodyId, NodeId)>,
    /// Stations for which no more racks are fetched at present, since enough robots with racks wait until they may set
    /// off there; each with the robot that has waited for the longest.
    pub full: BTreeMap<StationId, RobotId>,
    /// The first jobs, with their priorities, that wait for nothing but a robot, or for other jobs of the same rack,
    /// and that any robot may do: most urgent first, [`LINE`] at most.
    pub line: Vec<(JobId, u8)>,
    /// What closed areas and robots that cannot drive cut off.
    pub cut_off: Arc<CutOff>,
    /// Stations at which picking is paused, and since when.
    pub paused_stations: BTreeMap<StationId, Time>,
    /// Nodes that are closed, or will be soon.
    pub closing: BTreeSet<NodeId>,
    /// Since when the whole fleet is to stand, by hand.
    pub stopped: Option<Time>,
    /// Sums over the fleet's life.
    pub counts: Counts,
    /// How often forecasts of people have held, by horizon.
    pub forecast_coverage: Vec<HorizonCoverage>,
}

/// One robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotView {
    /// The robot's name.
    pub name: String,
    /// Where the robot was last seen; if it was never seen, where it is booked to be.
    pub pose: Pose,
    /// When the robot was last seen.
    pub seen: Option<Time>,
    /// When the robot's newest report came in.
    pub heard: Option<Time>,
    /// How fast the robot drives, metres per second.
    pub speed_mps: f64,
    /// The name of the robot's kind.
    pub kind: String,
    /// The name of the link over which the robot is reached.
    pub link: String,
    /// The state of the robot at its link; nothing if it is as usual.
    pub link_state: Option<LinkState>,
    /// Charge, 0 to 1.
    pub battery: f64,
    /// Below this charge the robot takes no job.
    pub critical: f64,
    /// Whether the robot is in maintenance, or will be when it has finished what it has begun.
    pub maintenance: bool,
    /// Whether the robot is to leave the floor, and has not left yet.
    pub leaving: bool,
    /// What the robot reports as wrong with itself.
    pub fault: Option<Fault>,
    /// The robot's state in the sense of the thesis, 4.2.4.
    pub state: RobotState,
    /// The robot's task.
    pub task: Task,
    /// The rack on the robot.
    pub rack: Option<RackId>,
    /// What the robot does for its task, whether it makes progress or not.
    pub doing: Doing,
    /// What the robot is doing, in one word.
    pub activity: Activity,
    /// Since when the robot has had this activity.
    pub since: Time,
    /// How far the robot was seen to drive since the program started, metres.
    pub driven_m: f64,
    /// The job on which the robot works.
    pub job: Option<JobId>,
    /// Nodes that the robot has been granted, in order, from where it is.
    pub granted: Vec<NodeId>,
    /// Nodes that the robot holds beyond its grant, in order.
    pub held: Vec<NodeId>,
    /// Why the robot does not go on, if it does not.
    pub why: Option<Why>,
    /// The worker whom the robot passes beside the line, if it does.
    pub passes: Option<WorkerId>,
    /// Why the robot was last given another route, and when; nothing if it was not since the program started.
    pub replanned: Option<(ReplanCause, Time)>,
}

/// The five states of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RobotState {
    /// The robot has nothing to do and stands where it may stay.
    Idle,
    /// The robot works on a job.
    Busy,
    /// The robot has no job and is on its way to a place to stay.
    Free,
    /// The robot lost its route and waits for a new one.
    Interrupted,
    /// The robot cannot drive.
    Failed,
    /// The robot has left the floor.
    Gone,
}

/// One station.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct StationView {
    /// The robot at the picking place.
    pub robot: Option<RobotId>,
    /// Whether a rack stands at the picking place to be picked from.
    pub picking: bool,
    /// The job for which the rack is picked from, unless that was cancelled.
    pub job: Option<JobId>,
    /// When the rack came; nothing if that was before the program started.
    pub since: Option<Time>,
    /// The lines of the job, if it has any.
    pub lines: Option<Lines>,
    /// How long the visit goes on from `now`, if its job has lines.
    pub left: Option<Remaining>,
    /// How long it takes from `now` until the last piece is in its tote.
    pub placed: Option<Remaining>,
    /// How well the ends of visits were expected.
    pub ends: EndsHeld,
    /// The visit whose rack left at the last grasp, until its last line is confirmed.
    pub unconfirmed: Option<Unconfirmed>,
    /// Whether the station has a work cell.
    pub has_cell: bool,
    /// Whether the picker's hands are tracked, so that they can confirm picks.
    pub hears_hands: bool,
    /// Whether the hands of exactly one person were seen at the station lately.
    pub saw_hands: bool,
    /// What the picker was warned of a moment ago.
    pub warning: Option<WrongReach>,
    /// The robot arm beside the picker.
    pub arm: Option<ArmView>,
    /// Where hands that are reaching go, with probabilities.
    pub reaches: SmallVec<[SeenReach; 4]>,
    /// The robot that brings the next rack, and when it is planned to be there, if that can be known.
    pub next: Option<(RobotId, Option<Time>)>,
    /// Since when picking has been paused by hand.
    pub paused: Option<Time>,
    /// Robots in the queue places of the station, first in line first.
    pub queue: Vec<RobotId>,
    /// Racks served so far.
    pub served: u64,
}

/// How many jobs are ahead of a job in the line for a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct JobsAhead {
    /// Jobs of higher priority.
    pub higher: usize,
    /// Other jobs: older ones, or jobs with a nearer deadline.
    pub others: usize,
    /// Whether there are more jobs ahead than those counted.
    pub more: bool,
}

/// Why a job does not go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JobWhy {
    /// Another job must be over first.
    After(JobId),
    /// The job's rack is on a robot, or a robot is on its way to it, for another job or back to storage.
    RackBusy(RackId, RobotId, Option<JobId>),
    /// The robot that the customer named has something else to do.
    RobotBusy(RobotId, Option<JobId>),
    /// No robot that could do the job is free, and the job is the first in line.
    NoRobot,
    /// No robot that could do the job is free, and other jobs are before it.
    Outranked(JobsAhead),
    /// No robot has joined that can carry the rack, and may drive to it and to where it is wanted.
    NoKind,
    /// A robot stands in every place of the station.
    StationFull(StationId),
    /// Enough robots with racks wait for the station already; this robot has waited for the longest.
    RacksWait(StationId, RobotId),
    /// Picking is paused at the station.
    StationPaused(StationId),
    /// A robot that cannot drive stands at the station, in its queue or on the way out.
    StationBlocked(StationId, RobotId),
    /// The rack, or the place where it is to go, is closed off, or will be soon.
    ClosedOff,
    /// A robot that cannot take the job stands beneath the rack.
    RackBlocked(RackId, RobotId),
    /// The named robot is going to stay at the node where the job leads, or stands there with a rack.
    NodeTaken(NodeId, RobotId),
    /// A robot that cannot drive stands on the only way to the rack, or to the place where it is to go.
    WayBlocked(RobotId),
    /// This closed area cuts the rack off from the place where it is to go.
    WayClosed(ClosureId),
    /// No charger, or no parking place, is free.
    NoPlace(NodeKind),
    /// The robot that the customer named has too little charge for the job.
    RobotLow(RobotId),
    /// The robot that works on the job does not go on.
    Robot(RobotId, Why),
}

/// Says what is on the only way of a job.
impl From<Barrier> for JobWhy {
    fn from(cut: Barrier) -> JobWhy {
        match cut {
            Barrier::Robot(robot) => JobWhy::WayBlocked(robot),
            Barrier::Closure(closure) => JobWhy::WayClosed(closure),
            Barrier::Obstruction(_) => JobWhy::ClosedOff,
        }
    }
}

impl View {
    /// Why a job does not go on, if it does not.
    pub fn why_job(&self, map: &Warehouse, id: JobId, job: &Job) -> Option<JobWhy> {
        if let Some(robot) = job.state.robot() {
            return Some(JobWhy::Robot(robot, self.robots.get(robot.ix())?.why?));
        }
        if job.state != JobState::Waiting {
            return None;
        }
        if let Some(first) = self.blocked.get(&id) {
            return Some(JobWhy::After(*first));
        }
        if let Some(named) = job.request.kind.robot() {
            let robot = self.robots.get(named.ix())?;
            return match robot.why {
                Some(why) if why.is_by_itself() => Some(JobWhy::Robot(named, why)),
                _ if robot.task != Task::Idle => Some(JobWhy::RobotBusy(named, robot.job)),
                _ => match job.request.kind {
                    JobKind::Charge { .. } => Some(self.no_place(map, robot, NodeKind::Charger)),
                    _ if robot.battery < robot.critical => Some(JobWhy::RobotLow(named)),
                    JobKind::Go { node, .. } => {
                        let taken = self.kept.get(&node).map(|other| JobWhy::NodeTaken(node, *other));
                        let cut = || self.cuts_off(map, robot, node).map(JobWhy::from);
                        taken.or_else(cut).or(Some(JobWhy::NoPlace(NodeKind::Parking)))
                    }
                    _ => Some(self.no_place(map, robot, NodeKind::Parking)),
                },
            };
        }
        if let Some(why) = self.why_not_chosen(job) {
            return Some(why);
        }
        let rack_busy = job.request.kind.rack().and_then(|rack| {
            let robot = self.robot_at_work_on(rack)?;
            Some(JobWhy::RackBusy(rack, robot, self.robots.get(robot.ix())?.job))
        });
        rack_busy.or_else(|| self.why_not_fetched(map, id, &job.request))
    }

    /// What keeps the robot that an operator chose for a job, if one was chosen and something keeps it.
    fn why_not_chosen(&self, job: &Job) -> Option<JobWhy> {
        let RobotChoice::Only(chosen, until) = job.choice else { return None };
        if until <= self.now {
            return None;
        }
        let robot = self.robots.get(chosen.ix())?;
        if robot.maintenance || robot.leaving {
            return None;
        }
        match robot.why {
            Some(why) if why.is_by_itself() => Some(JobWhy::Robot(chosen, why)),
            // It ends what it does first: it puts away the rack that it has, or drives to where it may stay.
            _ if robot.task != Task::Idle => Some(JobWhy::RobotBusy(chosen, robot.job)),
            _ if robot.battery < robot.critical => Some(JobWhy::RobotLow(chosen)),
            _ => None,
        }
    }

    /// Why no robot fetches a rack that stands in storage, if that is so.
    fn why_not_fetched(&self, map: &Warehouse, id: JobId, request: &JobRequest) -> Option<JobWhy> {
        let kind = &request.kind;
        let rack = kind.rack()?;
        let RackAt::Stored(node) = *self.racks.get(rack.ix())? else { return None };
        let closed = |n: &NodeId| self.closing.contains(n);
        // The caller's map may be from before a kind was added.
        let for_all = self.building.0.as_deref().unwrap_or(map);
        let fits = |body: &BodyId| request.is_for(for_all, *body, (rack, node));
        if !self.kinds.is_empty() && !self.kinds.iter().any(fits) {
            return Some(JobWhy::NoKind);
        }
        match kind {
            JobKind::Deliver { station, .. } if self.paused_stations.contains_key(station) => {
                return Some(JobWhy::StationPaused(*station));
            }
            JobKind::Deliver { station, .. }
                if self.cut_off.blocks_for_long(*station, self.now).is_some() =>
            {
                return Some(match self.cut_off.blocks_for_long(*station, self.now)? {
                    Barrier::Robot(robot) => JobWhy::StationBlocked(*station, robot),
                    cut @ (Barrier::Closure(_) | Barrier::Obstruction(_)) => cut.into(),
                });
            }
            JobKind::Deliver { station, .. } if self.full.contains_key(station) => {
                return Some(match self.is_full(map, *station) {
                    true => JobWhy::StationFull(*station),
                    false => JobWhy::RacksWait(*station, self.full[station]),
                });
            }
            JobKind::Deliver { station, .. } if closed(&map.stations[*station].node) => {
                return Some(JobWhy::ClosedOff);
            }
            JobKind::Relocate { node, .. } if closed(node) => return Some(JobWhy::ClosedOff),
            _ if closed(&node) => return Some(JobWhy::ClosedOff),
            _ => {}
        }
        if let Some(cut) = self.cut_off.blocks_job(map, kind, node) {
            return Some(cut.into());
        }
        let stays = |r: &RobotView| r.held.last().or(r.granted.last()) == Some(&node);
        let blocked = self.robots.iter().position(stays).map(|r| JobWhy::RackBlocked(rack, RobotId::at(r)));
        blocked
            .or_else(|| (!self.free.keys().any(fits)).then(|| self.in_line(id, request.priority)))
            .or_else(|| self.out_of_reach(map, node, fits))
    }

    /// Says that no robot is free for a job, and how many jobs are before it.
    fn in_line(&self, id: JobId, priority: u8) -> JobWhy {
        let place = self.line.iter().position(|(other, _)| *other == id);
        let before = &self.line[..place.unwrap_or(self.line.len())];
        let higher = before.iter().filter(|(_, other)| *other > priority).count();
        match before.len() {
            0 => JobWhy::NoRobot,
            all => JobWhy::Outranked(JobsAhead { higher, others: all - higher, more: place.is_none() }),
        }
    }

    /// What bars all ways of a robot to a node, if something does.
    fn cuts_off(&self, map: &Warehouse, robot: &RobotView, node: NodeId) -> Option<Barrier> {
        let here = robot.held.last().or(robot.granted.last())?;
        self.cut_off.between(map, (*here, node), false, std::iter::empty())
    }

    /// Why a robot goes to no place of a kind: something is on all ways to a free one, or none is free.
    fn no_place(&self, map: &Warehouse, robot: &RobotView, kind: NodeKind) -> JobWhy {
        let ends_at = |r: &RobotView, n: NodeId| {
            r.held.last().or(r.granted.last()) == Some(&n) || r.task.destination() == Some(n)
        };
        let is_free = |n: &NodeId| !self.closing.contains(n) && !self.robots.iter().any(|r| ends_at(r, *n));
        let mut free = map.nodes_where(|k| k == kind).into_iter().filter(is_free);
        let cut = free.find_map(|n| self.cuts_off(map, robot, n));
        cut.map_or(JobWhy::NoPlace(kind), JobWhy::from)
    }

    /// Whether a robot stands in every place of a station.
    pub fn is_full(&self, map: &Warehouse, station: StationId) -> bool {
        let is_at = |s: &StationView| s.robot.is_some() && s.queue.len() == map.stations[station].queue.len();
        self.stations.get(station.ix()).is_some_and(is_at)
    }

    /// What is between a rack and all robots that could take a job for it, if all of them are cut off from it.
    fn out_of_reach(&self, map: &Warehouse, node: NodeId, fits: impl Fn(&BodyId) -> bool) -> Option<JobWhy> {
        let mut free = self.free_at.iter().filter(|(body, _)| fits(body));
        let none = !self.cut_off.is_empty() && free.all(|(_, here)| !self.cut_off.may_fetch(*here, node));
        if none { self.cut_off.first_met(map, node).map(JobWhy::from) } else { None }
    }

    /// The robot that carries a rack, or is on its way to it.
    fn robot_at_work_on(&self, rack: RackId) -> Option<RobotId> {
        if let Some(RackAt::On(robot)) = self.racks.get(rack.ix()) {
            return Some(*robot);
        }
        let fetches = |r: &RobotView| matches!(r.task, Task::Fetch { rack: fetched, .. } if fetched == rack);
        self.robots.iter().position(fetches).map(RobotId::at)
    }
}

/// Sums over the fleet's life.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub struct Counts {
    /// Racks served at stations.
    pub robot_deliveries: u64,
    /// Assignments completed by workers.
    pub human_deliveries: u64,
    /// Jobs that no robot has yet.
    pub waiting: u64,
    /// Jobs that a robot has.
    pub active: u64,
    /// Jobs done.
    pub done: u64,
    /// Jobs cancelled.
    pub cancelled: u64,
    /// Jobs that could not be done.
    pub failed: u64,
    /// Routes planned.
    pub plans: u64,
    /// Searches that found no route.
    pub plan_failures: u64,
    /// Routes that were inserted by moving other robots.
    pub insertions: InsertionCounts,
    /// Order lines that were over, since the program started.
    pub lines: u64,
    /// Reaches of pickers that were warned of, since the program started.
    pub wrong_reaches: u64,
    /// Encounters of robots and workers.
    pub encounters: u64,
    /// How often a worker left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
    /// Routes planned anew because of workers and closures.
    pub replans: u64,
    /// Zones that robots and workers shared, by how the robots answered them.
    pub zones: ZoneCounts,
}
