//! The life of a job: one table of what may happen to it, and of what its robot does meanwhile.
//!
//! Main types: [`JobStage`], [`Work`], [`JobEvent`]; main functions [`next`] (the table) and [`work`] (what the robot
//! of a job in some stage does for it). `Ledger::evolve` asserts both for every fact in every build, so a job and the
//! task of the robot that serves it can never disagree. Refuses: to decide that something happens.

use crate::state::fact::Task;
use crate::state::job::JobState;
use crate::state::job_kind::JobKind;

/// How far a job has come, without the robot that serves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobStage {
    /// No robot has the job.
    Waiting,
    /// A robot is on its way to the rack, or to where it was sent.
    Assigned,
    /// A robot carries the rack.
    Carrying,
    /// The rack stands at the station.
    Picking,
    /// Done.
    Done,
    /// Cancelled.
    Cancelled,
    /// The job could not be done.
    Failed,
}

/// What a robot does for a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Nothing: no robot serves the job.
    Nothing,
    /// The robot goes to the rack.
    Fetch,
    /// The robot carries the rack to the station.
    Deliver,
    /// The robot carries the rack to a storage node.
    Store,
    /// The robot goes somewhere without a rack.
    Move,
}

/// What happens to a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobEvent {
    /// A robot gets the job.
    Assigned,
    /// A robot gets the job and already carries the rack that it asks for.
    Chained,
    /// The robot lifted the rack.
    Lifted,
    /// The robot stands at the station.
    AtStation,
    /// The robot was pushed away from the station before the pick had ended.
    PushedAway,
    /// The person at the station has what was wanted.
    Picked,
    /// The rack stands where it was to stand.
    SetDown,
    /// The robot is where it was sent.
    Arrived,
    /// The robot no longer serves the job; another one may.
    GivenBack,
    /// The customer no longer wants the job.
    Cancelled,
    /// The job cannot be done.
    Failed,
}

/// Kinds of jobs that have the same life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    /// A rack goes to a station and back.
    Deliver,
    /// A rack goes to a storage node.
    Put,
    /// A named robot goes somewhere.
    Send,
}

impl Family {
    fn of(kind: &JobKind) -> Family {
        match kind {
            JobKind::Deliver { .. } => Family::Deliver,
            JobKind::Return { .. } | JobKind::Relocate { .. } => Family::Put,
            JobKind::Charge { .. } | JobKind::Park { .. } | JobKind::Go { .. } => Family::Send,
        }
    }
}

impl JobStage {
    /// The stage of a state.
    pub fn of(state: JobState) -> JobStage {
        match state {
            JobState::Waiting => JobStage::Waiting,
            JobState::Assigned { .. } => JobStage::Assigned,
            JobState::Carrying { .. } => JobStage::Carrying,
            JobState::Picking { .. } => JobStage::Picking,
            JobState::Done => JobStage::Done,
            JobState::Cancelled => JobStage::Cancelled,
            JobState::Failed(_) => JobStage::Failed,
        }
    }
}

impl Work {
    /// What a task does for its job.
    pub fn of(task: &Task) -> Work {
        match task {
            _ if task.job().is_none() => Work::Nothing,
            Task::Idle => Work::Nothing,
            Task::Fetch { .. } => Work::Fetch,
            Task::Deliver { .. } => Work::Deliver,
            Task::Store { .. } => Work::Store,
            Task::Move { .. } => Work::Move,
        }
    }
}

/// The table: the stage to which an event takes a job; nothing if the event cannot happen in this stage.
pub fn next(kind: &JobKind, from: JobStage, event: JobEvent) -> Option<JobStage> {
    use Family::{Deliver, Put, Send};
    use JobStage::{Assigned, Cancelled, Carrying, Done, Failed, Picking, Waiting};
    let to = match (Family::of(kind), from, event) {
        (_, Done | Cancelled | Failed, _) => return None,
        (_, _, JobEvent::Cancelled) => Cancelled,
        (_, _, JobEvent::Failed) => Failed,
        (_, Waiting, JobEvent::Assigned) => Assigned,
        (Deliver, Waiting, JobEvent::Chained) => Carrying,
        (Deliver | Put, Assigned, JobEvent::Lifted) => Carrying,
        (Deliver, Carrying, JobEvent::AtStation) => Picking,
        (Deliver, Picking, JobEvent::PushedAway) => Carrying,
        (Deliver, Picking, JobEvent::Picked) => Done,
        (Put, Carrying, JobEvent::SetDown) => Done,
        (Send, Assigned, JobEvent::Arrived) => Done,
        (_, Assigned, JobEvent::GivenBack) => Waiting,
        // The robot found no way on to a station, or past a robot that cannot drive, and set the rack down in storage.
        (Deliver | Put, Carrying, JobEvent::GivenBack) => Waiting,
        _ => return None,
    };
    Some(to)
}

/// What the robot that serves a job does for it in a stage; nothing if this kind of job has no such stage.
pub fn work(kind: &JobKind, stage: JobStage) -> Option<Work> {
    use Family::{Deliver, Put, Send};
    Some(match (Family::of(kind), stage) {
        (_, JobStage::Waiting | JobStage::Done | JobStage::Cancelled | JobStage::Failed) => Work::Nothing,
        (Deliver | Put, JobStage::Assigned) => Work::Fetch,
        (Send, JobStage::Assigned) => Work::Move,
        (Deliver, JobStage::Carrying | JobStage::Picking) => Work::Deliver,
        (Put, JobStage::Carrying) => Work::Store,
        (Put, JobStage::Picking) | (Send, JobStage::Carrying | JobStage::Picking) => return None,
    })
}

/// The event that takes a job from one stage to another, if one does.
pub fn event(kind: &JobKind, from: JobStage, to: JobStage) -> Option<JobEvent> {
    EVENTS.into_iter().find(|e| next(kind, from, *e) == Some(to))
}

/// Every event.
pub const EVENTS: [JobEvent; 11] = [
    JobEvent::Assigned,
    JobEvent::Chained,
    JobEvent::Lifted,
    JobEvent::AtStation,
    JobEvent::PushedAway,
    JobEvent::Picked,
    JobEvent::SetDown,
    JobEvent::Arrived,
    JobEvent::GivenBack,
    JobEvent::Cancelled,
    JobEvent::Failed,
];

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::id::{NodeId, RackId, RobotId, StationId};

    const STAGES: [JobStage; 7] = [
        JobStage::Waiting,
        JobStage::Assigned,
        JobStage::Carrying,
        JobStage::Picking,
        JobStage::Done,
        JobStage::Cancelled,
        JobStage::Failed,
    ];

    fn kinds() -> [JobKind; 6] {
        let (rack, robot, node) = (RackId(0), RobotId(0), NodeId(0));
        [
            JobKind::Deliver { rack, station: StationId(0), pick: None },
            JobKind::Return { rack },
            JobKind::Relocate { rack, node },
            JobKind::Charge { robot },
            JobKind::Park { robot },
            JobKind::Go { robot, node },
        ]
    }

    #[test]
    fn no_event_brings_a_job_back_that_is_over() {
        for kind in kinds() {
            for stage in [JobStage::Done, JobStage::Cancelled, JobStage::Failed] {
                assert!(EVENTS.iter().all(|e| next(&kind, stage, *e).is_none()), "{kind:?} {stage:?}");
            }
        }
    }

    #[test]
    fn a_job_can_be_cancelled_and_can_fail_at_every_stage_that_its_kind_has() {
        for kind in kinds() {
            for stage in [JobStage::Waiting, JobStage::Assigned, JobStage::Carrying, JobStage::Picking] {
                let has = work(&kind, stage).is_some();
                assert!(!has || next(&kind, stage, JobEvent::Cancelled) == Some(JobStage::Cancelled));
                assert!(!has || next(&kind, stage, JobEvent::Failed) == Some(JobStage::Failed));
            }
        }
    }

    #[test]
    fn every_stage_that_can_be_reached_says_what_the_robot_does_and_leads_to_done() {
        for kind in kinds() {
            let mut reached = vec![JobStage::Waiting];
            let mut i = 0;
            while let Some(from) = reached.get(i).copied() {
                i += 1;
                assert!(work(&kind, from).is_some(), "{kind:?} {from:?}");
                for to in EVENTS.iter().filter_map(|e| next(&kind, from, *e)) {
                    if !reached.contains(&to) {
                        reached.push(to);
                    }
                }
            }
            assert!(reached.contains(&JobStage::Done), "{kind:?} reaches {reached:?}");
            let unused = STAGES.into_iter().filter(|s| !reached.contains(s));
            unused.for_each(|s| assert_eq!(work(&kind, s), None, "{kind:?} never comes to {s:?}"));
        }
    }

    #[test]
    fn two_events_do_not_lead_from_one_stage_to_the_same_other_one() {
        for kind in kinds() {
            for from in STAGES {
                let ends: Vec<JobStage> = EVENTS.iter().filter_map(|e| next(&kind, from, *e)).collect();
                for to in &ends {
                    assert_eq!(ends.iter().filter(|s| *s == to).count(), 1, "{kind:?}: {from:?} to {to:?}");
                }
            }
        }
    }
}
