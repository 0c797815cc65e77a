//! Violations of the laws of a simulation, in words.
//!
//! Main type: [`Violation`]. Refuses: to judge.

use giveway_fleet::{Edge, JobKind, JobState, JobWhy, MESSAGE, Party, Task, Why};
use giveway_floor::id::{JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::time::Span;
use std::fmt;

/// A robot with a task and without progress for this long is stuck.
pub const STUCK: Span = Span::from_secs(600);
/// A job in one state for longer than this needs a true reason.
pub const OVERDUE: Span = Span::from_secs(600);
/// While jobs wait and robots can drive, something is delivered within this time.
pub const DELIVERS: Span = Span::from_secs(1200);

/// Robots and workers wait for one another no longer than this.
pub(crate) const CIRCLE: Span = Span::from_secs(60);
/// The fleet keeps no person in one spot for longer than this.
pub const KEPT: Span = Span::from_secs(60);

/// A robot stands no longer than this with a rack that has no way to its goal while it could set the rack down.
pub(crate) const CARRIED: Span = Span::from_secs(180);

/// This many less urgent jobs may begin while one waits: if two robots get jobs in one step, each may be meant for what
/// the other one then does.
pub const PASSED_BY: u32 = 3;

/// A violation of one law.
#[derive(Clone, Debug, PartialEq)]
pub enum Violation {
    /// Two robots overlap.
    Overlap(RobotId, RobotId),
    /// A robot is beyond its grant.
    BeyondGrant(RobotId),
    /// A robot has had a task without progress for too long.
    Stuck(RobotId, Task, Option<Why>),
    /// A job vanished.
    JobLost(JobId),
    /// A job was acknowledged, and is not in the journal.
    AcknowledgedLost(JobId),
    /// A robot was sent farther than the journal has granted.
    SentUndurable(RobotId),
    /// A job was done twice.
    DoneTwice(JobId),
    /// A rack was lifted where it did not stand, or set down onto another one.
    Misplaced(RobotId, RackId),
    /// A robot moved at a station while a person's hand was in the opening or in its rack.
    MovedAtHand(RobotId, StationId),
    /// The guard of a station alone held a robot at a hand that the fleet saw.
    LeftToGuard(RobotId, StationId),
    /// The robot arm of a station touched a person while it moved.
    ArmTouched(StationId),
    /// Arm and hand together put down more pieces of a line than were ordered.
    PickedTwice(JobId, usize),
    /// A job was reported as ended in a way that did not happen.
    UntrueEnd(JobId, JobKind),
    /// A job has been in one state for too long without a true reason.
    Unexplained(JobId, JobState, Option<JobWhy>),
    /// The first job has waited while more than [`PASSED_BY`] less urgent ones began; the second is the last of these.
    PassedBy(JobId, JobId),
    /// Jobs wait and robots can drive, but nothing has been delivered for too long.
    NothingDelivered,
    /// After the customers stopped, this many jobs did not end, and this many racks are not in storage; then reasons.
    NotDrained(usize, usize, Vec<String>),
    /// A robot drove into a worker without braking.
    RunOver(RobotId, usize),
    /// A robot has stood where the fleet does not know it to be, or is called displaced without being so.
    Misjudged(RobotId),
    /// A robot has stood for too long with a rack that has no way to its goal, though it could set the rack down.
    CarriedInVain(RobotId),
    /// Robots and workers have waited for one another for too long.
    Circle(Vec<Party>),
    /// A person has stood in one spot for too long, waiting for a robot or for a way; last for this.
    Kept(WorkerId, Edge),
    /// A message to a person was replaced too soon by one that is not more severe.
    Flickers(WorkerId),
    /// A person has been told for too long to stop for a robot that waits for that person.
    Standoff(WorkerId, RobotId),
    /// A robot waits for something that no longer keeps it.
    NotSo(RobotId, Why),
    /// A robot was granted a place on a worker's way to a door.
    OntoWayOut(RobotId, NodeId),
    /// A robot was outside of the corridor that it was granted, or off its line without one.
    LeftCorridor(RobotId),
    /// The ledger is not the fold of the facts.
    Fold,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Violation::Overlap(a, b) => write!(f, "robots {} and {} overlap", a.0 + 1, b.0 + 1),
            Violation::BeyondGrant(r) => write!(f, "robot {} drove beyond its grant", r.0 + 1),
            Violation::Stuck(r, task, why) => {
                write!(f, "robot {} made no progress for {STUCK:?} on {task:?}: {why:?}", r.0 + 1)
            }
            Violation::JobLost(j) => write!(f, "job {j:?} was lost"),
            Violation::AcknowledgedLost(j) => write!(f, "job {j:?} was acknowledged and is not durable"),
            Violation::SentUndurable(r) => write!(f, "robot {} was sent beyond what is durable", r.0 + 1),
            Violation::DoneTwice(j) => write!(f, "job {j:?} was done twice"),
            Violation::Misplaced(r, k) => {
                write!(f, "robot {} lifted rack {k:?} where it was not, or set it onto another one", r.0 + 1)
            }
            Violation::MovedAtHand(r, s) => {
                write!(f, "robot {} moved at station {} while a hand was inside", r.0 + 1, s.0 + 1)
            }
            Violation::LeftToGuard(r, s) => {
                write!(f, "only the guard of station {} held robot {} at a hand", s.0 + 1, r.0 + 1)
            }
            Violation::ArmTouched(s) => {
                write!(f, "the arm of station {} touched a person while it moved", s.0 + 1)
            }
            Violation::PickedTwice(j, line) => {
                write!(f, "arm and hand put down too many pieces of line {} of job {j:?}", line + 1)
            }
            Violation::UntrueEnd(j, kind) => {
                write!(f, "job {j:?} ({kind:?}) is done, but that did not happen")
            }
            Violation::Unexplained(j, state, why) => {
                write!(f, "job {j:?} has been {state:?} for {OVERDUE:?} without a true reason: {why:?}")
            }
            Violation::PassedBy(j, last) => {
                write!(
                    f,
                    "job {j:?} waits while more than {PASSED_BY} less urgent ones began, at last {last:?}"
                )
            }
            Violation::NothingDelivered => {
                write!(f, "jobs wait and robots can drive, but nothing was delivered for {DELIVERS:?}")
            }
            Violation::NotDrained(jobs, racks, whys) => write_undrained(f, (*jobs, *racks), whys),
            Violation::RunOver(r, w) => {
                write!(f, "robot {} drove into worker {} and did not brake", r.0 + 1, w + 1)
            }
            Violation::Misjudged(r) => {
                write!(f, "robot {} does not stand where the fleet believes it to be", r.0 + 1)
            }
            Violation::CarriedInVain(r) => {
                write!(f, "robot {} stood for {CARRIED:?} with a rack for which there is no way", r.0 + 1)
            }
            Violation::Circle(parties) => {
                write!(f, "wait for one another for more than {CIRCLE:?}: {parties:?}")
            }
            Violation::Kept(w, because) => write_kept(f, *w, because),
            Violation::Flickers(w) => write_flickers(f, *w),
            Violation::Standoff(w, r) => write_standoff(f, *w, *r),
            Violation::NotSo(r, why) => write!(f, "robot {} does not wait because of {why:?}", r.0 + 1),
            Violation::OntoWayOut(r, n) => {
                write!(f, "robot {} was let onto node {n:?}, which is on somebody's way to a door", r.0 + 1)
            }
            Violation::LeftCorridor(r) => {
                write!(f, "robot {} left its line, or the corridor that it was granted", r.0 + 1)
            }
            Violation::Fold => write!(f, "the ledger is not the fold of its facts"),
        }
    }
}

fn write_kept(f: &mut fmt::Formatter<'_>, worker: WorkerId, because: &Edge) -> fmt::Result {
    let because = match because {
        Edge::On(Party::Robot(r)) => format!("by robot {}", r.0 + 1),
        Edge::Until(_) => "to let a robot pass".into(),
        _ => "without a way".into(),
    };
    write!(f, "worker {} was kept in one spot for {KEPT:?}, at last {because}", worker.0 + 1)
}

fn write_flickers(f: &mut fmt::Formatter<'_>, worker: WorkerId) -> fmt::Result {
    write!(f, "worker {} was told something else within {MESSAGE:?}, and nothing more severe", worker.0 + 1)
}

fn write_standoff(f: &mut fmt::Formatter<'_>, worker: WorkerId, robot: RobotId) -> fmt::Result {
    write!(
        f,
        "worker {} is told to stop for robot {}, which waits for that worker",
        worker.0 + 1,
        robot.0 + 1
    )
}

fn write_undrained(
    f: &mut fmt::Formatter<'_>,
    (jobs, racks): (usize, usize),
    whys: &[String],
) -> fmt::Result {
    let whys = whys.join("; ");
    write!(f, "the floor did not drain: {jobs} jobs are open, {racks} racks are not in storage: {whys}")
}
