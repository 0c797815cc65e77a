//! Robots stand on nodes before the server goes over to another map: the loop's side of that.
//!
//! Main types: [`Settling`] (looked at in every turn), [`SettleRequest`]. Robots drive to the end of what they were
//! granted. If one does not get there in time, all go on, and the map is not changed. Refuses: to keep robots standing
//! for nobody.

use giveway_fleet::{Fleet, Unsettled};
use giveway_floor::time::{Span, Time};
use tokio::sync::mpsc::error::TryRecvError;
use tokio::sync::{mpsc, oneshot};

/// How long robots may take.
const PATIENCE: Span = Span::from_secs(20);

/// Robots that do not stand on nodes.
pub type NotStanding = Vec<Unsettled>;

/// What is asked of the loop.
#[derive(Debug)]
pub enum SettleRequest {
    /// Which robots stand beside their nodes, and so would be in the way of a change.
    Look(oneshot::Sender<NotStanding>),
    /// All robots are to stand. The answer comes when they do, and what they did is durable; or names those that do
    /// not, or none where the journal takes no facts, and then all go on.
    Stand(oneshot::Sender<Result<(), NotStanding>>),
    /// Robots go on.
    GoOn,
}

/// Whether robots are to stand.
#[derive(Debug, Default)]
enum SettleState {
    /// They are not.
    #[default]
    Off,
    /// They are, until then at the latest.
    Waiting(Time, oneshot::Sender<Result<(), NotStanding>>),
    /// They do.
    Standing,
}

/// The loop's side.
#[derive(Debug)]
pub struct Settling {
    requests: mpsc::Receiver<SettleRequest>,
    state: SettleState,
}

impl Settling {
    /// One that takes these requests.
    pub fn new(requests: mpsc::Receiver<SettleRequest>) -> Settling {
        Settling { requests, state: SettleState::Off }
    }

    /// Looks after a turn what is asked, and whether robots stand. `settled` is whether everything is durable.
    pub fn look(&mut self, fleet: &mut Fleet, now: Time, settled: bool) {
        match self.requests.try_recv() {
            Ok(SettleRequest::Look(reply)) => {
                let _ = reply.send(fleet.unsettled().into_iter().filter(|u| u.stands_off).collect());
            }
            Ok(SettleRequest::Stand(reply)) => self.state = SettleState::Waiting(now + PATIENCE, reply),
            Ok(SettleRequest::GoOn) | Err(TryRecvError::Disconnected) => self.state = SettleState::Off,
            Err(TryRecvError::Empty) => {}
        }
        match std::mem::take(&mut self.state) {
            SettleState::Off => fleet.go_on(),
            // Each time anew: a fleet that was rebuilt from the journal does not know.
            SettleState::Standing => {
                fleet.settle();
                self.state = SettleState::Standing;
            }
            SettleState::Waiting(until, reply) => {
                fleet.settle();
                let moving = fleet.unsettled();
                let decided = match decide(moving, now >= until) {
                    Some(Ok(())) if !settled => (now >= until).then_some(Err(Vec::new())),
                    other => other,
                };
                self.state = match decided {
                    None => SettleState::Waiting(until, reply),
                    Some(answer) => {
                        let stand = answer.is_ok();
                        let heard = reply.send(answer).is_ok();
                        if stand && heard { SettleState::Standing } else { SettleState::Off }
                    }
                };
            }
        }
    }
}

/// Whether all robots stand, where that is known. At the end a robot that stands on its node is good enough, though it
/// may have been granted more: somebody is in its way, or it was told to stand.
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
