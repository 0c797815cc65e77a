//! Requests and sightings on their way into a step, and the handlers that wait for answers.
//!
//! Main type: [`Inbox`]. Refuses: requests for which no handler waits any more. The driver decides which other requests
//! are refused.

use super::audit_keeper::row_of;
use giveway_api::{AuditEntry, HeardHands, HeardSighting, QueuedRequest};
use giveway_cell::HandsSeen;
use giveway_fleet::{Answered, CausedFacts, Input, Reply, Request, Token};
use giveway_floor::geometry::{Point, inside};
use giveway_floor::id::StationId;
use giveway_floor::warehouse::Warehouse;
use giveway_store::StepCause;
use std::collections::BTreeMap;
use std::sync::Arc;
use tokio::sync::{mpsc, oneshot};

/// The most requests that wait in the queue.
pub const QUEUE: usize = 1024;

/// A request that has not been answered yet.
#[derive(Debug)]
struct WaitingRequest {
    by: Arc<AuditEntry>,
    reply: oneshot::Sender<Answered>,
}

/// Requests, and the handlers that wait for their answers.
#[derive(Debug)]
pub struct Inbox {
    queue: mpsc::Receiver<QueuedRequest>,
    heard: mpsc::Receiver<HeardSighting>,
    waiting: BTreeMap<Token, WaitingRequest>,
    /// Sightings that were taken out of the channel early, to check them.
    early: Vec<HeardSighting>,
    /// The workplaces of stations: hands of people there matter.
    workplaces: Vec<(StationId, Vec<Point>)>,
    next: u64,
}

impl Inbox {
    /// An inbox that is filled from a queue and from feeds.
    pub fn new(queue: mpsc::Receiver<QueuedRequest>, heard: mpsc::Receiver<HeardSighting>) -> Inbox {
        let (waiting, early, workplaces) = (BTreeMap::new(), Vec::new(), Vec::new());
        Inbox { queue, heard, waiting, early, workplaces, next: 0 }
    }

    /// An inbox that also passes on the hands of people in a building's workplaces.
    pub fn of(
        warehouse: &Warehouse,
        queue: mpsc::Receiver<QueuedRequest>,
        heard: mpsc::Receiver<HeardSighting>,
    ) -> Inbox {
        let cells = warehouse.stations.pairs();
        let workplaces = cells.filter_map(|(id, s)| Some((id, s.cell.as_ref()?.workplace.clone()))).collect();
        Inbox { workplaces, ..Inbox::new(queue, heard) }
    }

    /// Waiting requests, at most `room` of them; the others stay in the queue, which refuses more than it holds.
    pub fn requests(&mut self, room: usize) -> Vec<(Token, Request)> {
        let mut requests = Vec::new();
        while requests.len() < room
            && let Ok(ask) = self.queue.try_recv()
        {
            // A request for which no handler waits any more is not carried out, except acts by hand.
            if ask.reply.is_closed() && !ask.request.is_by_hand() {
                continue;
            }
            let token = self.token();
            self.waiting.insert(token, WaitingRequest { by: ask.by, reply: ask.reply });
            requests.push((token, ask.request));
        }
        requests
    }

    fn token(&mut self) -> Token {
        self.next += 1;
        Token::from(self.next)
    }

    /// The next sighting, as soon as it arrives. It is also kept for the next step.
    pub async fn hear(&mut self) -> HeardSighting {
        let Some(heard) = self.heard.recv().await else { return std::future::pending().await };
        self.early.push(heard);
        heard
    }

    /// Takes all waiting sightings, whatever the journal's state: stopping waits for nothing.
    pub fn look(&mut self, inputs: &mut Vec<Input>) {
        for heard in std::mem::take(&mut self.early) {
            self.see(&heard, inputs);
        }
        while let Ok(heard) = self.heard.try_recv() {
            self.see(&heard, inputs);
        }
    }

    /// Adds a sighting and, for a person in a workplace, the hands seen with the pose.
    fn see(&self, heard: &HeardSighting, inputs: &mut Vec<Input>) {
        inputs.push(Input::Sighted(heard.sighting));
        inputs.extend(self.hands_of(heard).map(Input::Hands));
    }

    /// The hands of a person in a workplace, if they were seen.
    pub fn hands_of(&self, heard: &HeardSighting) -> Option<HandsSeen> {
        let HeardSighting { sighting, hands, .. } = heard;
        let HeardHands { head, facing, eyes, hands } = (*hands)?;
        let (station, _) = self.workplaces.iter().find(|(_, outline)| inside(outline, sighting.at))?;
        let (person, seen) = (sighting.worker.0, sighting.seen);
        Some(HandsSeen { station: *station, person, seen, head, facing, eyes, hands })
    }

    /// Tells the handlers of these requests that the requests came to nothing.
    pub fn forget(&mut self, tokens: &[Token]) {
        for token in tokens {
            self.waiting.remove(token);
        }
    }

    /// Which external requests caused which facts of a step.
    pub fn causes(&self, caused: &[CausedFacts]) -> Vec<StepCause> {
        let of = |c: &CausedFacts| {
            let request = row_of(&self.waiting.get(&c.token)?.by);
            Some(StepCause { facts: c.facts.clone(), request })
        };
        caused.iter().filter_map(of).collect()
    }

    /// Answers a request; simulated customers expect no answer.
    pub fn answer(&mut self, reply: Reply) {
        if let Some(waiting) = self.waiting.remove(&reply.token) {
            // A client that has left meanwhile finds the job in the list.
            let _ = waiting.reply.send(reply.answer);
        }
    }
}

/// The audit entry of a request in tests.
#[cfg(test)]
pub fn local_request() -> Arc<AuditEntry> {
    let caller = giveway_api::Caller::this_machine();
    let log = giveway_api::AuditLog::new(0).0;
    Arc::new(log.begin(&caller, "POST /v1/fleet/stop".into(), None, giveway_floor::time::Time(7)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::server::links::{FloorSource, Links};
    use giveway_drive::Drive;
    use giveway_fleet::{Answer, Fleet, FloorAction, JobAction};
    use giveway_floor::id::JobId;
    use giveway_floor::time::Time;
    use giveway_floor::warehouse::lab;

    const SCENARIO: &str =
        r#"{"giveway_scenario": 1, "name": "t", "map": "", "robots": 1, "jobs": {"backlog": 3}}"#;

    /// An inbox with the senders that feed it.
    fn inbox() -> (Inbox, mpsc::Sender<QueuedRequest>, mpsc::Sender<HeardSighting>) {
        let ((queue, asks), (feed, heard)) = (mpsc::channel(QUEUE), mpsc::channel(1));
        (Inbox::new(asks, heard), queue, feed)
    }

    fn ask(queue: &mpsc::Sender<QueuedRequest>, request: impl Into<Request>) -> oneshot::Receiver<Answered> {
        let (reply, answer) = oneshot::channel();
        queue.try_send(QueuedRequest { request: request.into(), by: local_request(), reply }).unwrap();
        answer
    }

    /// Whether the input submits a job.
    fn submits(input: &Input) -> bool {
        matches!(input, Input::Ask { request: Request::Job(JobAction::Submit(_)), .. })
    }

    /// The first orders of the simulated customers.
    fn orders() -> Vec<Input> {
        let (map, source) = (Arc::new(lab()), FloorSource::parse(SCENARIO).unwrap());
        let mut drive = Drive::new(Fleet::new(map.clone(), source.site().settings()));
        let floor = source.begin(map, drive.fleet().ledger(), Time(1));
        Links::new(floor, None).hear(Time(2), &mut drive)
    }

    #[test]
    fn a_reply_to_a_simulated_customer_answers_no_request_from_outside() {
        let (mut inbox, queue, _feed) = inbox();
        let mut answers: Vec<_> = (1..5).map(|job| ask(&queue, JobAction::Cancel(JobId(job)))).collect();
        assert_eq!(inbox.requests(9).len(), 4);
        let tokens = orders().into_iter().filter_map(|i| match i {
            Input::Ask { token, .. } if submits(&i) => Some(token),
            _ => None,
        });
        let tokens: Vec<Token> = tokens.collect();
        assert_eq!(tokens.len(), 3, "the customers order");
        for token in tokens {
            inbox.answer(Reply { token, answer: Ok(Answer::Done) });
        }
        for answer in &mut answers {
            assert_eq!(answer.try_recv(), Err(oneshot::error::TryRecvError::Empty));
        }
    }

    #[test]
    fn requests_beyond_the_room_wait_in_the_queue_and_those_whose_handler_has_left_are_not_carried_out() {
        let (mut inbox, queue, _feed) = inbox();
        let mut answers: Vec<_> = (1..4).map(|job| ask(&queue, JobAction::Cancel(JobId(job)))).collect();
        drop(answers.remove(1));
        let mut by_hand = ask(&queue, FloorAction::Halt(None));
        assert_eq!(inbox.requests(1).len(), 1);
        let rest = inbox.requests(9);
        assert_eq!(rest.len(), 2, "{rest:?}");
        inbox.forget(&[rest[1].0]);
        assert_eq!(by_hand.try_recv(), Err(oneshot::error::TryRecvError::Closed), "it is told so at once");
    }

    #[test]
    fn facts_of_a_step_are_those_of_who_asked_for_them_and_of_nobody_where_the_floor_is_simulated() {
        let (mut inbox, queue, _feed) = inbox();
        let _answers = [ask(&queue, FloorAction::Halt(None)), ask(&queue, JobAction::Cancel(JobId(9)))];
        let requests = inbox.requests(9);
        let mut inputs: Vec<Input> = requests.into_iter().map(|(t, r)| Input::ask(t, r)).collect();
        inputs.extend(orders());
        let source = FloorSource::parse(SCENARIO).unwrap();
        let mut fleet = Fleet::new(Arc::new(lab()), source.site().settings());
        let step = fleet.step(Time(3), inputs);
        let causes = inbox.causes(&step.caused);
        assert_eq!(causes.len(), 1, "what was refused caused nothing: {causes:?}");
        assert_eq!(causes[0].request.actor, "this machine");
        let facts = &step.facts[causes[0].facts.clone()];
        assert!(
            matches!(
                facts,
                [giveway_fleet::Fact::Floor(giveway_fleet::FloorFact::Halted { robot: None, .. })]
            ),
            "{facts:?}"
        );
        assert_eq!(step.caused.len(), 5, "the fleet says it of three orders and a robot that joins, too");
    }
}
