//! Robots that leave the floor for good: when they are gone, and what becomes of jobs that name them.
//!
//! Refuses: to treat a robot as gone that can still be heard, carries a rack, or may be driving.

use crate::state::fact::{RobotFact, Task};
use crate::state::floor::Floor;
use crate::state::io::Telemetry;
use crate::state::job::{JobFailure, JobState};
use crate::state::ledger::Service;
use crate::state::link::LinkReach;
use crate::state::writer::Writer;
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::{Span, Time};

/// A robot that rests where it ends, or cannot drive, is gone when it has been silent for this long: a person switched
/// it off.
const SWITCHED_OFF: Span = Span::from_secs(10);
/// Any other robot is gone after this: a robot that merely cannot be heard drives on to the end of what it was granted.
const TAKEN_AWAY: Span = Span::from_secs(60);
/// A robot whose link is down is gone after this: silence says little meanwhile, but the link of a robot that was
/// switched off may stay down.
const CUT_OFF: Span = Span::from_secs(600);

/// Lets robots leave that were to leave and are no longer heard of.
pub(crate) fn let_leave(writer: &mut Writer, now: Time) {
    for robot in writer.ledger().present() {
        if !writer.floor().has_left(robot, now) {
            continue;
        }
        if let Some(job) = writer.ledger().robots[robot].task.job() {
            writer.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
        } else if writer.ledger().robots[robot].task != Task::Idle {
            writer.record(RobotFact::Tasked { robot, task: Task::Idle });
        }
        let named: Vec<JobId> = writer.ledger().index().named_for(robot).collect();
        for job in named {
            writer.progress(job, JobState::Failed(JobFailure::RobotGone), None, now);
        }
        tracing::info!(robot = writer.ledger().robots[robot].name, "a robot has left the floor");
        writer.record(RobotFact::Left { robot, at: now });
        // What is heard of the robot from now on is news.
        writer.scene.forget(robot);
    }
}

impl Floor<'_> {
    fn has_left(&self, robot: RobotId, now: Time) -> bool {
        let record = &self.ledger.robots[robot];
        let Service::Leaving { since } = record.service else { return false };
        if self.ledger.rack_on(robot).is_some() {
            return false;
        }
        if self.scene.reach(robot) == LinkReach::Answers {
            return false;
        }
        let seen = self.scene.robot(robot);
        // Before its first report after a start, the robot may stand anywhere, or drive.
        let heard = self.scene.silent_since(robot).or(self.scene.began()).unwrap_or(now).max(since);
        let chain = self.ledger.chain(robot);
        let rests = record.task == Task::Idle && chain.first() + 1 == chain.end();
        // The robot may have set off since: orders are sent to a robot that cannot say that it drives.
        let has_ended = |t: &Telemetry| t.speed_mps == 0.0 && t.reached + 1 >= chain.granted();
        let stays = rests || seen.is_some_and(|t| t.cannot_drive() || record.failed && has_ended(t));
        // A link that the site no longer has will not come back.
        let is_lost = matches!(self.scene.reach(robot), LinkReach::Lost | LinkReach::LineDown);
        let is_cut_off = self.settings.links.contains(&record.link) && is_lost;
        let patience = match is_cut_off {
            true => CUT_OFF,
            false if stays => SWITCHED_OFF,
            false => TAKEN_AWAY,
        };
        now - heard >= patience
    }
}
