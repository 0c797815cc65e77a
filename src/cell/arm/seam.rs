//! The seam between the cell and an arm, simulated or real: reports come in, trajectories of at most a second go out.
//!
//! Main types: [`ArmSeam`], [`ArmReport`], [`ArmTrajectory`], [`ArmTrouble`]. Refuses: trajectories to an arm that is
//! silent, late, or reports impossible joints. The arm stands at a trajectory's end unless a newer one came.

use super::kinematics::{ArmKind, Joints};
use super::mpc::{ArmPlan, CYCLE_S, HORIZON};
use giveway_floor::time::{Span, Time};

/// Time without a report after which an arm is silent.
pub const SILENT_AFTER: Span = Span(300_000);
/// Age of a report on arrival beyond which it is late.
pub const LATE_AFTER: Span = Span(200_000);
/// Time for which an arm must report well before it gets trajectories again.
pub const WELL_AFTER: Span = Span(1_000_000);
/// Longest duration of a trajectory.
pub const LONGEST_TRAJECTORY: Span = Span(1_000_000);

/// A report of an arm about itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmReport {
    /// Joint angles, radians.
    pub joints: Joints,
    /// When the angles were measured.
    pub seen: Time,
    /// Whether the arm's own protective stop holds it.
    pub is_stopped: bool,
}

/// Why an arm gets no trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArmTrouble {
    /// No report for a while, or none ever.
    #[error("the arm is silent")]
    Silent,
    /// Its reports are too old on arrival.
    #[error("the arm's reports are late")]
    Late,
    /// Angles that are not finite or are beyond the arm's limits.
    #[error("the arm reports joints that it cannot have")]
    Joints,
    /// Angles that the arm cannot have reached in the time.
    #[error("the arm reports joints that it cannot have come to")]
    Jump,
    /// The arm's own stop holds it.
    #[error("the arm's protective stop holds it")]
    Stopped,
}

/// What an arm should follow.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmTrajectory {
    /// Number of the trajectory: later ones replace earlier ones.
    pub number: u64,
    /// When the trajectory begins.
    pub begins: Time,
    /// Interval between the configurations.
    pub step: Span,
    /// The configurations, the first one an interval after the beginning; at the last one the arm stands.
    pub steps: Vec<Joints>,
}

/// One arm as the cell sees it.
#[derive(Clone, Debug)]
pub struct ArmSeam {
    kind: ArmKind,
    last: Option<ArmReport>,
    trouble: Option<(ArmTrouble, Time)>,
    sent: u64,
}

impl ArmSeam {
    /// The seam of an arm that has not reported yet.
    pub fn new(kind: ArmKind) -> ArmSeam {
        ArmSeam { kind, last: None, trouble: None, sent: 0 }
    }

    /// Takes a report. A report older than the last one is dropped.
    ///
    /// # Errors
    /// What is wrong with the report; the arm gets no trajectory until its reports were well for [`WELL_AFTER`].
    pub fn take(&mut self, now: Time, report: ArmReport) -> Result<(), ArmTrouble> {
        let found = self.wrong_with(now, &report);
        if let Some(trouble) = found {
            self.trouble = Some((trouble, now));
            return Err(trouble);
        }
        if self.last.is_none_or(|last| report.seen > last.seen) {
            self.last = Some(report);
        }
        Ok(())
    }

    fn wrong_with(&self, now: Time, report: &ArmReport) -> Option<ArmTrouble> {
        if !report.joints.iter().all(|q| q.is_finite()) || !self.kind.allows(&report.joints) {
            return Some(ArmTrouble::Joints);
        }
        if now - report.seen > LATE_AFTER {
            return Some(ArmTrouble::Late);
        }
        // Half as fast again as the limit, and a degree for noise.
        let last = self.last.filter(|last| report.seen > last.seen)?;
        let passed_s = (report.seen - last.seen).as_secs_f64();
        let jumps = |k: usize| {
            (report.joints[k] - last.joints[k]).abs() > 1.5 * self.kind.speed_radps[k] * passed_s + 0.02
        };
        (passed_s < 1.0 && (0..6).any(jumps)).then_some(ArmTrouble::Jump)
    }

    /// Why the arm would get no trajectory now.
    pub fn trouble(&self, now: Time) -> Option<ArmTrouble> {
        let Some(last) = self.last else {
            return Some(self.trouble.map_or(ArmTrouble::Silent, |(trouble, _)| trouble));
        };
        if let Some((trouble, _)) = self.trouble.filter(|(_, at)| now - *at < WELL_AFTER) {
            return Some(trouble);
        }
        if now - last.seen > SILENT_AFTER {
            return Some(ArmTrouble::Silent);
        }
        last.is_stopped.then_some(ArmTrouble::Stopped)
    }

    /// The joint angles of the last report.
    pub fn joints(&self) -> Option<&Joints> {
        self.last.as_ref().map(|last| &last.joints)
    }

    /// The trajectory of a plan that leads away from a person, whether or not the arm's own stop holds it; the arm
    /// itself decides whether to follow it.
    ///
    /// # Errors
    /// Why the arm gets none.
    pub fn trajectory_away(&mut self, now: Time, plan: &ArmPlan) -> Result<ArmTrajectory, ArmTrouble> {
        match self.trouble(now).filter(|trouble| *trouble != ArmTrouble::Stopped) {
            Some(trouble) => Err(trouble),
            None => self.of_plan(now, plan),
        }
    }

    /// The trajectory of a plan.
    ///
    /// # Errors
    /// Why the arm gets none.
    pub fn trajectory(&mut self, now: Time, plan: &ArmPlan) -> Result<ArmTrajectory, ArmTrouble> {
        if let Some(trouble) = self.trouble(now) {
            return Err(trouble);
        }
        self.of_plan(now, plan)
    }

    fn of_plan(&mut self, now: Time, plan: &ArmPlan) -> Result<ArmTrajectory, ArmTrouble> {
        if !plan.steps.iter().all(|q| q.iter().all(|x| x.is_finite()) && self.kind.allows(q)) {
            return Err(ArmTrouble::Joints);
        }
        self.sent += 1;
        let step = Span::from_secs_f64(CYCLE_S);
        debug_assert!(step.0 * HORIZON as i64 <= LONGEST_TRAJECTORY.0);
        Ok(ArmTrajectory { number: self.sent, begins: now, step, steps: plan.steps.to_vec() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: Joints = [0.0, -1.3, 1.7, -1.97, -1.57, 0.0];

    fn at(ms: i64) -> Time {
        Time(ms * 1000)
    }

    fn report(ms: i64, joints: Joints) -> ArmReport {
        ArmReport { joints, seen: at(ms), is_stopped: false }
    }

    fn seam() -> ArmSeam {
        let mut seam = ArmSeam::new(ArmKind::collaborative().clone());
        seam.take(at(10), report(0, HOME)).unwrap();
        seam
    }

    #[test]
    fn an_arm_that_reports_well_gets_a_second_and_then_a_newer_one() {
        let mut seam = seam();
        let plan = ArmPlan::standing(&HOME);
        let first = seam.trajectory(at(50), &plan).unwrap();
        assert_eq!((first.number, first.steps.len(), first.step), (1, 10, Span(100_000)));
        assert_eq!(seam.trajectory(at(150), &plan).unwrap().number, 2);
    }

    #[test]
    fn a_silent_arm_gets_none_until_it_speaks_again() {
        let mut seam = seam();
        let plan = ArmPlan::standing(&HOME);
        assert_eq!(seam.trajectory(at(301), &plan), Err(ArmTrouble::Silent));
        seam.take(at(400), report(390, HOME)).unwrap();
        assert!(seam.trajectory(at(410), &plan).is_ok());
        assert_eq!(ArmSeam::new(ArmKind::collaborative().clone()).trouble(at(0)), Some(ArmTrouble::Silent));
    }

    #[test]
    fn late_and_impossible_reports_are_not_taken_and_no_trajectory_follows_for_a_second() {
        let mut far = HOME;
        far[2] = 4.0;
        let mut jumped = HOME;
        jumped[0] = 0.8;
        let wrong = [
            (report(100, HOME), 350, ArmTrouble::Late),
            (report(100, far), 110, ArmTrouble::Joints),
            (report(100, [f64::NAN; 6]), 110, ArmTrouble::Joints),
            (report(100, jumped), 110, ArmTrouble::Jump),
        ];
        for (report_, ms, trouble) in wrong {
            let mut seam = seam();
            assert_eq!(seam.take(at(ms), report_), Err(trouble));
            assert_eq!(seam.joints(), Some(&HOME));
            assert_eq!(seam.trouble(at(ms)), Some(trouble));
            seam.take(at(ms + 950), report(ms + 940, HOME)).unwrap();
            assert_eq!(seam.trouble(at(ms + 960)), Some(trouble));
            seam.take(at(ms + 1000), report(ms + 990, HOME)).unwrap();
            assert_eq!(seam.trouble(at(ms + 1000)), None);
        }
    }

    #[test]
    fn an_arm_that_its_own_stop_holds_gets_none() {
        let mut seam = seam();
        seam.take(at(100), ArmReport { is_stopped: true, ..report(90, HOME) }).unwrap();
        assert_eq!(seam.trajectory(at(110), &ArmPlan::standing(&HOME)), Err(ArmTrouble::Stopped));
        assert!(seam.trajectory_away(at(110), &ArmPlan::standing(&HOME)).is_ok(), "but it may leave");
        let nowhere = ArmPlan::standing(&[9.0; 6]);
        seam.take(at(200), report(190, HOME)).unwrap();
        assert_eq!(seam.trajectory(at(210), &nowhere), Err(ArmTrouble::Joints));
    }
}
