//! Whether a robot moves, by where it says it is: some robots never say that they drive.
//!
//! Main type: [`SeenMotion`]. Refuses: to take a robot that is not heard for one that stands.

use giveway_floor::geometry::Pose;
use giveway_floor::time::{Span, Time};
use std::collections::VecDeque;

/// A robot that has moved by less than this over [`STOOD`] stands, metres.
const STILL_M: f64 = 0.03;
/// A robot stands if it has not moved for this long.
const STOOD: Span = Span::from_secs(1);
/// Poses are kept for this long, and this many of them.
const KEPT: Span = Span::from_secs(3);
const MOST: usize = 64;

/// The last poses of a robot.
#[derive(Clone, Debug, Default)]
pub(super) struct SeenMotion {
    poses: VecDeque<(Time, Pose)>,
    /// The speed that the robot says it has, metres per second.
    said_mps: Option<f64>,
}

impl SeenMotion {
    /// Takes a pose that arrived now.
    pub fn note(&mut self, now: Time, pose: Pose, said_mps: Option<f64>) {
        self.said_mps = said_mps;
        self.poses.push_back((now, pose));
        while self.poses.len() > MOST
            || self.poses.len() > 2 && self.poses.get(1).is_some_and(|(at, _)| now - *at > KEPT)
        {
            self.poses.pop_front();
        }
    }

    /// Where the robot was last seen.
    pub fn pose(&self) -> Option<Pose> {
        self.poses.back().map(|(_, pose)| *pose)
    }

    /// When the robot was last seen.
    pub fn seen(&self) -> Option<Time> {
        self.poses.back().map(|(at, _)| *at)
    }

    /// Whether the robot has not moved for a second, by two poses at least.
    pub fn stands(&self) -> bool {
        let Some((last, pose)) = self.poses.back() else { return false };
        let before = self.poses.iter().rev().find(|(at, _)| *last - *at >= STOOD);
        let Some((since, _)) = before else { return false };
        let lately = self.poses.iter().filter(|(at, _)| at >= since);
        lately.clone().all(|(_, p)| (p.at - pose.at).norm() < STILL_M)
    }

    /// How fast the robot drives: as it says, or as its poses say if it says nothing or says that it stands while it
    /// moves; metres per second.
    pub fn speed_mps(&self) -> f64 {
        let moved = match (self.poses.back(), self.poses.iter().rev().nth(1)) {
            (Some((to, there)), Some((from, here))) if to > from => {
                (there.at - here.at).norm() / (*to - *from).as_secs_f64()
            }
            _ => 0.0,
        };
        match self.said_mps {
            Some(said) if said > 0.0 || moved < STILL_M => said,
            _ => moved,
        }
    }
}
