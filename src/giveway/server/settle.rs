//! Makes robots stand on nodes before the server switches to another map: requests for that, and their answers.
//!
//! Main types: [`SettleQueue`] (the loop's end), [`SettleRequest`]. Refuses: to keep robots standing when the request
//! for it is gone.

use giveway_drive::{Drive, NotStanding};
use giveway_floor::time::Time;
use tokio::sync::mpsc::error::TryRecvError;
use tokio::sync::{mpsc, oneshot};

/// A request to the loop.
#[derive(Debug)]
pub enum SettleRequest {
    /// Ask which robots stand beside their nodes, and so would be obstacles to a change.
    Look(oneshot::Sender<NotStanding>),
    /// Make all robots stand. The answer comes when they stand and their facts are durable; or it names the robots that
    /// do not stand, or none if the journal accepts no facts, and then all robots go on.
    Stand(oneshot::Sender<Result<(), NotStanding>>),
    /// Let robots go on.
    GoOn,
}

/// The loop's end.
#[derive(Debug)]
pub struct SettleQueue {
    requests: mpsc::Receiver<SettleRequest>,
    waits: Option<oneshot::Sender<Result<(), NotStanding>>>,
}

impl SettleQueue {
    /// A queue of these requests.
    pub fn new(requests: mpsc::Receiver<SettleRequest>) -> SettleQueue {
        SettleQueue { requests, waits: None }
    }

    /// Passes the next request on to the driver.
    pub fn look(&mut self, drive: &mut Drive, now: Time) {
        match self.requests.try_recv() {
            Ok(SettleRequest::Look(reply)) => {
                // Dropped if the fleet cannot be asked: the sender of the request learns that there is no answer.
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

    /// Passes the driver's answer on. If its receiver is gone, robots go on.
    pub fn answer(&mut self, settled: Option<Result<(), NotStanding>>, drive: &mut Drive) {
        let Some(answer) = settled else { return };
        let heard = self.waits.take().is_some_and(|reply| reply.send(answer).is_ok());
        if !heard {
            drive.go_on();
        }
    }
}
