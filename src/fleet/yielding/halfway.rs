//! Robots that stand between two nodes and have forgotten what they were granted: to which of the two do they go on?
//!
//! Main function: `turn_halfway`. Refuses: to turn a robot that moves.

use crate::people::state::HumanState;
use crate::state::io::Telemetry;
use crate::state::writer::Writer;
use crate::traffic::state::{Direction, Traffic};
use crate::yielding::speed_limit::SpeedLimits;
use crate::yielding::state::Yielding;
use giveway_floor::time::Time;

impl Yielding {
    /// Has each robot go on to a node to which nothing keeps it from driving; if both are barred, the robot stays.
    pub(crate) fn turn_halfway(
        &self,
        writer: &mut Writer,
        people: &HumanState,
        traffic: &mut Traffic,
        now: Time,
    ) {
        let robots = traffic.halfway(writer, now);
        if robots.is_empty() {
            return;
        }
        let present = people.places(now);
        for robot in robots {
            let stands = writer.scene.robot(robot).is_some_and(Telemetry::stands);
            if !stands && traffic.direction(robot).is_some() {
                continue;
            }
            let limits = self.limits(writer.floor(), people, traffic);
            let may_go = |direction| {
                let limits = SpeedLimits { direction: Some(direction), ..limits };
                limits.limit_for(robot, &present, now).0 != Some(0.0)
            };
            let obstructed = traffic.is_obstructed_ahead(writer.floor(), robot);
            let all = traffic.directions_for(writer.floor(), robot, now);
            let open: Vec<Direction> = all.iter().copied().filter(|d| may_go(*d)).collect();
            let chosen = match open[..] {
                // Nothing keeps the robot from either: it takes the one that gets it to its next stop earlier.
                [_, _] if traffic.direction(robot).is_none() && !obstructed => {
                    Some(traffic.better_direction(writer.floor(), robot, now))
                }
                _ => open.first().copied(),
            };
            debug_assert!(chosen.is_none_or(|d| all.contains(&d)), "{robot:?} turns where it cannot go");
            traffic.direct(robot, chosen, now);
        }
    }
}
