//! Requests and sightings on their way into a step, and whom to answer.
//!
//! Main type: [`Inbox`]. Refuses: requests while the journal does not take facts, and tokens that the
//! simulated customers could use.

use crate::api::feed::hub::Heard;
use crate::api::port::{Ask, What};
use crate::fleet::{Input, Reply};
use crate::human::Sighting;
use std::collections::BTreeMap;
use tokio::sync::{mpsc, oneshot};

/// How many requests may wait on the desk.
pub const DESK: usize = 1024;

/// How many inputs may wait while the fleet stands.
const MOST_KEPT: usize = 10_000;

/// Tokens of requests from outside have this bit.
const OURS: u64 = 1 << 63;

/// Requests, and whom to answer.
#[derive(Debug)]
pub struct Inbox {
    desk: mpsc::Receiver<Ask>,
    heard: mpsc::Receiver<Heard>,
    waiting: BTreeMap<u64, oneshot::Sender<Reply>>,
    kept: Vec<Input>,
    /// Sightings that were taken out of the channel to look at them.
    early: Vec<Sighting>,
    next: u64,
}

impl Inbox {
    /// An inbox that is filled from a desk and from feeds.
    pub fn new(desk: mpsc::Receiver<Ask>, heard: mpsc::Receiver<Heard>) -> Inbox {
        Inbox { desk, heard, waiting: BTreeMap::new(), kept: Vec::new(), early: Vec::new(), next: OURS }
    }

    /// Everything that waits. While `refusing`, those who ask now are told so instead.
    pub fn drain(&mut self, refusing: bool) -> Vec<Input> {
        let mut inputs = std::mem::take(&mut self.kept);
        while let Ok(ask) = self.desk.try_recv() {
            // Dropping the reply tells the handler; nobody waits for those who have left. Stopping waits for nothing.
            let stop = matches!(ask.what, What::Halt(_));
            if !stop && (refusing || ask.reply.is_closed()) {
                continue;
            }
            let token = self.next;
            self.next += 1;
            self.waiting.insert(token, ask.reply);
            inputs.push(match ask.what {
                What::Submit(request) => Input::Submit { token, request },
                What::Cancel(job) => Input::Cancel { token, job },
                What::Hire(name) => Input::Hire { token, name },
                What::Clear(worker) => Input::Clear { token, worker },
                What::Assign(worker, request) => Input::Assign { token, worker, request },
                What::Unassign(assignment) => Input::Unassign { token, assignment },
                What::Finish(worker, assignment) => Input::Finish { token, worker, assignment },
                What::Close(area) => Input::Close { token, area },
                What::Reopen(closure) => Input::Reopen { token, closure },
                What::Halt(robot) => Input::Halt { token, robot },
                What::Release(robot) => Input::Release { token, robot },
                What::Station(station, order) => Input::Station { token, station, order },
                What::Prioritise(job, priority) => Input::Prioritise { token, job, priority },
            });
        }
        inputs
    }

    /// The next sighting, as soon as it is there. It waits for the next step, too.
    pub async fn hear(&mut self) -> Heard {
        let Some(heard) = self.heard.recv().await else { return std::future::pending().await };
        self.early.push(heard.sighting);
        heard
    }

    /// Takes all sightings that wait, whatever the journal does: stopping waits for nothing.
    pub fn look(&mut self, inputs: &mut Vec<Input>) {
        inputs.extend(self.early.drain(..).map(Input::Sighted));
        while let Ok(heard) = self.heard.try_recv() {
            inputs.push(Input::Sighted(heard.sighting));
        }
    }

    /// Keeps inputs for a later step. Observations are not kept: they will be seen again.
    pub fn keep(&mut self, inputs: Vec<Input>) {
        self.kept
            .extend(inputs.into_iter().filter(|i| !matches!(i, Input::Telemetry(_) | Input::Sighted(_))));
        if self.kept.len() > MOST_KEPT {
            tracing::warn!(
                dropped = self.kept.len() - MOST_KEPT,
                "simulated orders are dropped: the journal is full"
            );
            self.kept.truncate(MOST_KEPT);
        }
    }

    /// Answers whoever asked; simulated customers want no answer.
    pub fn answer(&mut self, reply: Reply) {
        if let Some(waiting) = self.waiting.remove(&reply.token()) {
            // Whoever has left meanwhile finds the job in the list.
            let _ = waiting.send(reply);
        }
    }
}
