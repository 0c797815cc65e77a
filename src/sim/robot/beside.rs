//! What a simulated robot may do beside the line, and what it does there.
//!
//! Main type: [`BesideLine`]. Refuses: to steer; `robot/passing.rs` does.

use giveway_fleet::ForeseenPerson;
use giveway_floor::time::Time;
use giveway_people::local::{DriveLimits, LocalMethod, Twist};

/// A robot's abilities and state beside the line.
#[derive(Debug)]
pub(crate) struct BesideLine {
    /// Whether the robot's kind may leave the line.
    pub may: bool,
    /// The robot's local planner.
    pub method: LocalMethod,
    /// Limits of motors and brakes, without and with a rack.
    pub limits: [DriveLimits; 2],
    /// People near the robot, as the fleet foresees them.
    pub people: Vec<ForeseenPerson>,
    /// The robot's motion, if it is beside the line or about to leave it.
    pub twist: Option<Twist>,
    /// The motion that the robot wants.
    pub wanted: Twist,
    /// When the robot last decided its motion.
    pub decided: Option<Time>,
    /// Since when the robot has stood although only its own planner keeps it.
    pub stuck: Option<Time>,
    /// Until when the robot keeps to the line.
    pub on_line_until: Time,
}

impl BesideLine {
    /// A robot on the line.
    pub fn new(may: bool, limits: [DriveLimits; 2]) -> BesideLine {
        BesideLine {
            may,
            method: LocalMethod::Improved(Default::default()),
            limits,
            people: Vec::new(),
            twist: None,
            wanted: Twist::default(),
            decided: None,
            stuck: None,
            on_line_until: Time::ZERO,
        }
    }

    /// Whether the robot steers by itself.
    pub fn steers(&self) -> bool {
        self.twist.is_some()
    }

    /// The robot keeps to the line from now on.
    pub fn end(&mut self) {
        (self.twist, self.decided, self.stuck) = (None, None, None);
    }
}
