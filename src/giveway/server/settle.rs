//! Robots stand on nodes before the server switches to another map: requests for that, and their answers.
//!
//! Main types: [`SettleQueue`] (the loop's end), [`SettleRequest`]. Refuses: to keep robots standing when
//! the request for it is gone.

use giveway_drive::{Drive, NotStanding};
use giveway_floor::time::Time;
use tokio::sync::mpsc::error::TryRecvError;
use tokio::sync::{mpsc, oneshot};

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

/// The loop's end.
#[derive(Debug)]
pub struct SettleQueue {
    requests: mpsc::Receiver<SettleRequest>,
    waits: Option<oneshot::Sender<Result<(), NotStanding>>>,
}

impl SettleQueue {
    /// One that takes these requests.
    pub fn new(requests: mpsc::Receiver<SettleRequest>) -> SettleQueue {
        SettleQueue { requests, waits: None }
    }

    /// Hands on what is asked.
    pub fn look(&mut self, drive: &mut Drive, now: Time) {
        match self.requests.try_recv() {
            Ok(SettleRequest::Look(reply)) => {
                // Dropped where the fleet cannot be asked: who asked is told that there is no answer.
                drive.standing_off(now).map(|off| reply.send(off));
            }
            Ok(SettleRequest::Stand(reply)) => {
                self.waits = Some(reply);
                drive.settle_by(now);
            }
            Ok(SettleRequest::GoOn) | Err(TryRecvError::Disconnected) => {
                self.waits = None;
                drive.go_on();
            }
            Err(TryRecvError::Empty) => {}
        }
    }

    /// Passes the driver's answer on. If nobody waits for it any more, robots go on.
    pub fn answer(&mut self, settled: Option<Result<(), NotStanding>>, drive: &mut Drive) {
        let Some(answer) = settled else { return };
        let heard = self.waits.take().is_some_and(|reply| reply.send(answer).is_ok());
        if !heard {
            drive.go_on();
        }
    }
}
