//! What a simulated robot may do beside the line, and what it does there.
//!
//! Main type: [`BesideLine`]. Refuses: to steer; `robot/passing.rs` does.

use giveway_fleet::ForeseenPerson;
use giveway_floor::time::Time;
use giveway_people::local::{DriveLimits, LocalMethod, Twist};

/// What a robot may do beside the line, and what it does there.
#[derive(Debug)]
pub(crate) struct BesideLine {
    /// Whether its kind may leave the line.
    pub may: bool,
    /// How it finds its way.
    pub method: LocalMethod,
    /// What motors and brakes allow, without and with a rack.
    pub limits: [DriveLimits; 2],
    /// People near it, as it was told.
    pub people: Vec<ForeseenPerson>,
    /// How it moves, if it is beside the line or about to leave it.
    pub twist: Option<Twist>,
    /// How it is to move.
    pub wanted: Twist,
    /// When it decided that.
    pub decided: Option<Time>,
    /// Since when it has stood although nothing but its own planner keeps it.
    pub stuck: Option<Time>,
    /// It keeps to the line until then.
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

    /// Whether it steers by itself.
    pub fn steers(&self) -> bool {
        self.twist.is_some()
    }

    /// It keeps to the line from now on.
    pub fn end(&mut self) {
        (self.twist, self.decided, self.stuck) = (None, None, None);
    }
}
