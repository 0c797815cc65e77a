//! The server's face: HTTP under `/v1`, the live feed, the feeds of headsets, metrics, the API's own description, the
//! page.
//!
//! Main types: [`Api`] (what handlers see), [`router`]; [`port`] is what it needs from the program that runs it;
//! [`live`] is the feed of the floor, [`feed`] those of people, [`recording`] keeps frames on file. Reads look at the
//! latest view or at durable lists; writes put a request into the queue and answer when its facts are durable.
//! Refuses: to decide anything about robots, and to know store or server.

mod acts;
pub mod alarms;
mod assets;
pub mod audit;
pub mod auth;
mod building;
mod called;
pub mod caller;
pub mod cell;
mod cookie;
pub mod dto;
pub mod error;
pub mod events;
mod extract;
pub mod feed;
pub mod guidance;
mod http;
pub mod live;
pub mod massrobotics;
pub mod metrics;
pub mod oidc;
pub mod once;
pub mod outgoing;
pub mod peer;
pub mod people;
pub mod port;
pub mod pseudonyms;
pub mod publish;
pub mod recording;
mod refusal;
mod replans;
mod roles;
pub mod secrets;
mod sentence;
mod shift;
pub mod targets;
pub mod text;
pub mod trial;
pub mod waits;
pub mod webhooks;
mod whys;
mod words;
mod ws;

pub use building::map_version;
pub use http::{KindChecks, alive, router};

use alarms::Alarms;
use audit::{AuditEntry, AuditLog};
use caller::Caller;
use error::Problem;
use giveway_fleet::{Answered, Ask, Refusal, Request, WorkerAction};
use giveway_floor::text::sentence::requests;
use giveway_floor::warehouse::Warehouse;
use port::{AnswerPort, Moment, Now, Question, QueuedRequest, Records, SharedHistory, TokenPort};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot, watch};

/// How long a request waits for being durable.
const PATIENCE: Duration = Duration::from_secs(10);

/// What handlers see. Cheap to clone.
#[derive(Clone)]
pub struct Api {
    /// The building.
    pub map: Arc<Warehouse>,
    /// Looks at the map for kinds of robots that are to be added.
    pub kind_checks: KindChecks,
    /// The latest view.
    pub moments: watch::Receiver<Arc<Moment>>,
    /// Durable jobs.
    pub records: Arc<dyn Records>,
    /// Figures over time.
    pub figures: Arc<SharedHistory>,
    /// Takes requests; absent where a recording is shown, since the past takes none.
    pub queue: Option<mpsc::Sender<QueuedRequest>>,
    /// Webhooks; absent where a recording is shown.
    pub hooks: Option<webhooks::WebhookAccess>,
    /// Takes questions.
    pub questions: mpsc::Sender<Question>,
    /// What stands.
    pub alarms: Arc<Alarms>,
    /// Frames of the past, if they are kept.
    pub past: Option<Arc<recording::Folder>>,
    /// The live feed.
    pub live: Arc<live::Live>,
    /// Feeds of headsets and tags.
    pub feeds: Arc<feed::hub::Feeds>,
    /// Names of people.
    pub pseudonyms: Arc<pseudonyms::Pseudonyms>,
    /// Frames and workers of MassRobotics reports.
    pub interop: Arc<massrobotics::Interop>,
    /// The clock.
    pub now: Now,
    /// Figures.
    pub metrics: Arc<metrics::Metrics>,
    /// Tries maps out.
    pub trials: trial::Trials,
    /// Takes maps that are to become the server's own.
    pub maps: publish::MapPort,
    /// Decides which requests are authorised.
    pub gate: Arc<auth::Gate>,
    /// The identity provider, if people sign in with one.
    pub oidc: Option<Arc<oidc::Oidc>>,
    /// Keeps named tokens; absent where a recording is shown.
    pub tokens: Option<Arc<dyn TokenPort>>,
    /// Keeps answers to requests with keys; absent where a recording is shown.
    pub answers: Option<Arc<dyn AnswerPort>>,
    /// Numbers requests that are to change something, and has them written down.
    pub audit: Arc<AuditLog>,
    /// Who called, in the copy of this that one request has.
    pub caller: Arc<Caller>,
    /// The entry of that request, if it is to change something.
    pub entry: Option<Arc<AuditEntry>>,
    /// Turns true when the server shuts down.
    pub closing: watch::Receiver<bool>,
}

impl Api {
    /// The latest view.
    fn moment(&self) -> Arc<Moment> {
        self.moments.borrow().clone()
    }

    /// Where requests go; a recording takes none, nor poses.
    fn queue(&self) -> Result<&mpsc::Sender<QueuedRequest>, Problem> {
        self.queue.as_ref().ok_or_else(Problem::of_recording)
    }

    /// Asks what the view does not say.
    async fn query<T>(&self, question: impl FnOnce(oneshot::Sender<T>) -> Question) -> Result<T, Problem> {
        let (reply, answer) = oneshot::channel();
        let busy = || Problem::unavailable(requests::busy(), 1);
        self.questions.try_send(question(reply)).map_err(|_| busy())?;
        match tokio::time::timeout(PATIENCE, answer).await {
            Ok(Ok(answer)) => Ok(answer),
            _ => Err(Problem::unavailable(requests::fleet_did_not_answer(), 2)),
        }
    }

    /// The entry of a request that came over a feed.
    fn over_feed(&self, request: &Request) -> AuditEntry {
        let (words, worker) = match request {
            Request::Worker(WorkerAction::Finish(worker, _)) => ("done, over the feed", Some(*worker)),
            Request::Worker(WorkerAction::SignOff(worker)) => ("signed off, over the feed", Some(*worker)),
            _ => ("over a feed", None),
        };
        self.audit.begin(&self.caller, words.into(), worker.map(text::worker_name), (self.now)())
    }

    /// Asks the fleet and waits until its answer is durable; a refusal is a problem that says why.
    async fn ask<A>(&self, ask: Ask<A>) -> Result<A, Problem> {
        self.answer_to(ask).await?.map_err(|why| refusal::refused(&self.map, why))
    }

    /// The same, for those who do something else where the fleet refuses.
    async fn answer_to<A>(&self, ask: Ask<A>) -> Result<Result<A, Refusal>, Problem> {
        match self.durable_answer(ask.request.clone()).await? {
            Err(why) => Ok(Err(why)),
            Ok(answer) => ask.read(answer).map(Ok).ok_or_else(|| {
                tracing::error!(request = ?ask.request, "the fleet answered what was not asked");
                Problem::internal()
            }),
        }
    }

    async fn durable_answer(&self, request: Request) -> Result<Answered, Problem> {
        let queue = self.queue()?;
        let (reply, answer) = oneshot::channel();
        let by = self.entry.clone().unwrap_or_else(|| Arc::new(self.over_feed(&request)));
        queue.try_send(QueuedRequest { request, by, reply }).map_err(|_| {
            let alarms: Vec<_> = self.alarms.list().into_iter().map(|a| a.text).collect();
            let cause = match alarms.is_empty() {
                true => requests::too_many_requests_wait(),
                false => requests::alarms_say(alarms),
            };
            Problem::unavailable(requests::nothing_accepted(cause), 1)
        })?;
        match tokio::time::timeout(PATIENCE, answer).await {
            Ok(Ok(reply)) => Ok(reply),
            Ok(Err(_)) => {
                let cause = requests::journal_takes_nothing();
                Err(Problem::unavailable(requests::nothing_accepted(cause), 2))
            }
            Err(_) => Err(Problem::unavailable(requests::not_durable_yet(), 5)),
        }
    }
}
