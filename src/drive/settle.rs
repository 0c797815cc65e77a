//! Robots stand on nodes before the driver switches to another map.
//!
//! Main type: [`Settling`] (checked in every turn). Robots drive to the end of their grants. If one does not get there
//! in time, all go on, and the map is not changed. Refuses: to keep robots standing when the request for it is gone.

use super::rescue::GuardedCall;
use super::{Drive, Sent};
use giveway_fleet::Unsettled;
use giveway_floor::time::{Span, Time};

/// How long robots may take.
const PATIENCE: Span = Span::from_secs(20);

/// Robots that do not stand on nodes.
pub type NotStanding = Vec<Unsettled>;

/// Whether robots must stand.
#[derive(Debug, Default)]
pub enum Settling {
    /// Robots need not stand.
    #[default]
    Off,
    /// Robots must stand, by this time at the latest.
    Waiting(Time),
    /// Robots stand.
    Standing,
}

impl Drive {
    /// Robots that stand beside their nodes, and so would be in the way of a change of the map; nothing while the fleet
    /// cannot be asked.
    pub fn standing_off(&mut self, now: Time) -> Option<NotStanding> {
        let moving = self.ask(GuardedCall::Query, now, |fleet| fleet.unsettled())?;
        Some(moving.into_iter().filter(|u| u.stands_off).collect())
    }

    /// Makes all robots stand. A later turn reports in [`Sent::settled`] that they stand and their facts are durable;
    /// or names the robots that do not, or none if the journal takes no facts, and then all go on.
    pub fn settle_by(&mut self, now: Time) {
        self.settling = Settling::Waiting(now + PATIENCE);
    }

    /// Lets robots go on.
    pub fn go_on(&mut self) {
        self.settling = Settling::Off;
    }

    /// Checks at the end of a turn whether the robots that must stand do so.
    pub(super) fn settle(&mut self, now: Time, sent: &mut Sent) {
        if self.is_broken() {
            return;
        }
        match self.settling {
            Settling::Off => self.fleet.go_on(),
            // In every turn: a fleet rebuilt from the journal does not know it.
            Settling::Standing => self.fleet.settle(),
            Settling::Waiting(until) => {
                self.fleet.settle();
                let Some(moving) = self.ask(GuardedCall::Query, now, |fleet| fleet.unsettled()) else {
                    return;
                };
                let decided = match decide(moving, now >= until) {
                    Some(Ok(())) if !self.is_settled() => (now >= until).then_some(Err(Vec::new())),
                    other => other,
                };
                if let Some(answer) = decided {
                    self.settling = if answer.is_ok() { Settling::Standing } else { Settling::Off };
                    sent.settled = Some(answer);
                }
            }
        }
    }
}

/// Whether all robots stand, if that is decided. At the end of the time a robot that stands on its node is good enough,
/// though it may have further grants: a person is in its way, or it was told to stand.
fn decide(moving: NotStanding, is_end: bool) -> Option<Result<(), NotStanding>> {
    if moving.is_empty() {
        return Some(Ok(()));
    }
    if !is_end {
        return None;
    }
    let off: NotStanding = moving.into_iter().filter(|u| u.is_off).collect();
    Some(if off.is_empty() { Ok(()) } else { Err(off) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::geometry::Point;
    use giveway_floor::id::RobotId;

    fn robot(is_off: bool) -> Unsettled {
        let (robot, name, at) = (RobotId(0), "robot-1".to_owned(), Point::new(1.0, 2.0));
        Unsettled { robot, name, at, is_off, stands_off: is_off }
    }

    #[test]
    fn robots_are_waited_for_and_in_the_end_those_beside_their_nodes_are_in_the_way() {
        assert_eq!(decide(vec![], false), Some(Ok(())));
        assert_eq!(decide(vec![robot(false)], false), None, "it may drive on");
        assert_eq!(decide(vec![robot(true)], false), None, "it may get there");
        assert_eq!(
            decide(vec![robot(false)], true),
            Some(Ok(())),
            "it stands on its node, whatever it was granted"
        );
        assert_eq!(decide(vec![robot(false), robot(true)], true), Some(Err(vec![robot(true)])));
    }
}
