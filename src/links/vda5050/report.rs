//! What the fleet is told of a robot: reports, and the state of its link.
//!
//! Refuses: the robot's clock; a report is from when the message arrived.

use super::contact::NotReady;
use super::session::RobotSession;
use giveway_fleet::{Fault, LinkReach, LinkState, ObeyedLimits, Telemetry};
use giveway_floor::text::sentence::links;
use giveway_floor::time::Time;
use giveway_vda5050::{EStop, ErrorLevel, OperatingMode, Position, Velocity};

impl RobotSession {
    /// Notes where the robot says that it is.
    pub(super) fn see(&mut self, now: Time, position: Option<&Position>, velocity: Option<Velocity>) {
        let knows = |p: &&Position| p.localized || !self.settings.needs_localized;
        let Some(position) = position.filter(knows) else { return };
        let frame = self.settings.maps.iter().find(|frame| frame.name == position.map);
        if let Some(frame) = frame {
            let pose = frame.to_floor(position.x, position.y, position.theta);
            self.motion.note(now, pose, velocity.map(|v| v.vx.hypot(v.vy)));
        }
    }

    /// Reports to the fleet, if the robot has joined and its place is known. Until it is known what the robot was
    /// ordered before, it would seem to be where it was never released to.
    pub(super) fn report(&mut self, now: Time) {
        if !self.knows_what_was_ordered() {
            return;
        }
        let (Some(progress), Some(pose), Some((_, state))) =
            (&self.progress, self.motion.pose(), &self.state)
        else {
            return;
        };
        self.seq = (self.seq + 1).max(now.0.unsigned_abs());
        let limit_mps = self.is_paused_by_us().then_some(0.0);
        self.out.reports.push(Telemetry {
            robot: progress.robot,
            seq: self.seq,
            seen: now,
            pose,
            speed_mps: self.motion.speed_mps(),
            reached: progress.reached,
            known: progress.known,
            acted: progress.acted,
            rack: progress.rack,
            // A robot that does not say its charge looks after it itself.
            battery: state.power.charge.unwrap_or(1.0),
            fault: self.fault(),
            limit_mps,
            recalls: progress.recalls,
        });
    }

    /// What keeps the robot from driving, by its own words.
    fn fault(&self) -> Option<Fault> {
        let (_, state) = self.state.as_ref()?;
        if !matches!(state.e_stop, EStop::None) {
            return Some(Fault::EmergencyStop);
        }
        match state.mode {
            OperatingMode::Automatic | OperatingMode::SemiAutomatic | OperatingMode::Intervened => {}
            OperatingMode::Manual
            | OperatingMode::Service
            | OperatingMode::TeachIn
            | OperatingMode::Startup => return Some(Fault::Manual),
        }
        if self.is_unplugged() {
            return Some(Fault::Unplugged);
        }
        let broken = self.progress.as_ref().is_some_and(|p| p.failed.is_some());
        // A robot may say FATAL of an order that it refuses, and drive on by another one.
        let fatal =
            state.errors.iter().any(|e| e.level == ErrorLevel::Fatal && e.refers_to("orderId").is_none());
        let is_stuck = fatal && !self.is_obeying();
        (broken || is_stuck).then_some(Fault::Broken)
    }

    /// Whether the robot has joined and takes orders, as the fleet was told last.
    pub fn is_commanded(&self) -> bool {
        self.progress.is_some() && self.link.reach.is_up() && self.link.refuses.is_none()
    }

    /// Whether messages get through to the robot.
    fn reach(&self, now: Time) -> LinkReach {
        match self.unreachable(now) {
            _ if self.line_down => LinkReach::LineDown,
            None => LinkReach::Answers,
            Some(NotReady::Offline) => LinkReach::Off,
            Some(_) => LinkReach::Lost,
        }
    }

    /// Whether the robot drives, or has nothing to drive.
    fn is_obeying(&self) -> bool {
        let waits = self.progress.as_ref().is_none_or(|p| p.known == p.reached);
        waits || !self.motion.stands()
    }

    /// Tells the fleet how the robot can be reached, if that changed.
    pub(super) fn note_link(&mut self, now: Time) {
        if self.progress.is_none() {
            return;
        }
        let refuses = match self.is_paused_by_hand() {
            true => Some(links::paused_where_it_is()),
            false => self.not_ready(now).map(|why| why.said()),
        };
        let capacity = Some(self.most_visits());
        let failed_stop = self.progress.as_ref().and_then(|p| p.failed.as_ref()).map(|failed| failed.serial);
        let limits = if self.pauses() { ObeyedLimits::Speeds } else { ObeyedLimits::Nothing };
        let link = LinkState { reach: self.reach(now), capacity, refuses, limits, failed_stop };
        if link != self.link {
            self.link = link.clone();
            self.out.link = Some(link);
        }
    }
}
