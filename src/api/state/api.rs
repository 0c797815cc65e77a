//! The state that all handlers share: the view, the queues to the fleet, and everything that answers requests.
//!
//! Main type: [`Api`]. Reads use the latest view or the durable lists; [`Api::ask`] queues a request and answers when
//! its facts are durable. Refuses: to decide anything about robots.

use crate::access::audit::{AuditEntry, AuditLog};
use crate::access::auth::Gate;
use crate::access::caller::Caller;
use crate::access::pseudonyms::Pseudonyms;
use crate::access::tokens::TokenPort;
use crate::dto::refusal::refused;
use crate::feed::hub::Feeds;
use crate::feed::massrobotics::Interop;
use crate::live::Live;
use crate::oidc::Oidc;
use crate::outgoing::webhooks::WebhookAccess;
use crate::port::Now;
use crate::port::answers::AnswerPort;
use crate::port::linked::LinkQuestion;
use crate::port::moment::{Moment, SharedHistory};
use crate::port::questions::Question;
use crate::port::trial::Trials;
use crate::recording::Folder;
use crate::state::alarms::Alarms;
use crate::state::kind_checks::KindChecks;
use crate::state::metrics::Metrics;
use crate::state::publish::MapPort;
use crate::state::records::{QueuedRequest, Records};
use crate::wire::error::Problem;
use crate::wire::text::worker_name;
use giveway_fleet::{Answered, Ask, Refusal, Request, WorkerAction};
use giveway_floor::text::sentence::requests;
use giveway_floor::warehouse::Warehouse;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot, watch};

/// How long a request waits until it is durable.
const PATIENCE: Duration = Duration::from_secs(10);

/// The state that handlers share. Cheap to clone.
#[derive(Clone)]
pub struct Api {
    /// The building.
    pub map: Arc<Warehouse>,
    /// Checks the map for robot kinds that are to be added.
    pub kind_checks: KindChecks,
    /// The latest view.
    pub moments: watch::Receiver<Arc<Moment>>,
    /// Durable lists: jobs, assignments, alarms, encounters, events and more.
    pub records: Arc<dyn Records>,
    /// Figures over time.
    pub figures: Arc<SharedHistory>,
    /// The queue of requests to the fleet; absent if a recording is shown, since the past accepts none.
    pub queue: Option<mpsc::Sender<QueuedRequest>>,
    /// Webhooks; absent if a recording is shown.
    pub hooks: Option<WebhookAccess>,
    /// The queue of questions to the fleet.
    pub questions: mpsc::Sender<Question>,
    /// The queue of questions to the link to robots of other vendors; absent if the floor has none.
    pub link: Option<mpsc::Sender<LinkQuestion>>,
    /// Active alarms.
    pub alarms: Arc<Alarms>,
    /// Recordings, if they are kept.
    pub past: Option<Arc<Folder>>,
    /// The live feed.
    pub live: Arc<Live>,
    /// Feeds of headsets and tags.
    pub feeds: Arc<Feeds>,
    /// Names of people.
    pub pseudonyms: Arc<Pseudonyms>,
    /// Settings for MassRobotics reports: workers and frames.
    pub interop: Arc<Interop>,
    /// The clock.
    pub now: Now,
    /// Metrics for Prometheus.
    pub metrics: Arc<Metrics>,
    /// Runs trials of maps.
    pub trials: Trials,
    /// Publishes maps.
    pub maps: MapPort,
    /// Decides which requests are authorised.
    pub gate: Arc<Gate>,
    /// The identity provider, if people sign in with one.
    pub oidc: Option<Arc<Oidc>>,
    /// Keeps named tokens; absent if a recording is shown.
    pub tokens: Option<Arc<dyn TokenPort>>,
    /// Keeps answers to requests with keys; absent if a recording is shown.
    pub answers: Option<Arc<dyn AnswerPort>>,
    /// Numbers the audit entries of requests, and passes them on to be stored.
    pub audit: Arc<AuditLog>,
    /// The caller, in the copy of this state that one request has.
    pub caller: Arc<Caller>,
    /// The audit entry of that request, if the request is to change something.
    pub entry: Option<Arc<AuditEntry>>,
    /// Turns true when the server shuts down.
    pub closing: watch::Receiver<bool>,
}

impl Api {
    /// The latest view.
    pub fn moment(&self) -> Arc<Moment> {
        self.moments.borrow().clone()
    }

    /// The queue of requests to the fleet; a recording accepts neither requests nor poses.
    pub fn queue(&self) -> Result<&mpsc::Sender<QueuedRequest>, Problem> {
        self.queue.as_ref().ok_or_else(Problem::of_recording)
    }

    /// Asks the fleet what the view does not contain.
    pub async fn query<T>(
        &self,
        question: impl FnOnce(oneshot::Sender<T>) -> Question,
    ) -> Result<T, Problem> {
        let (reply, answer) = oneshot::channel();
        let busy = || Problem::unavailable(requests::busy(), 1);
        self.questions.try_send(question(reply)).map_err(|_| busy())?;
        match tokio::time::timeout(PATIENCE, answer).await {
            Ok(Ok(answer)) => Ok(answer),
            _ => Err(Problem::unavailable(requests::fleet_did_not_answer(), 2)),
        }
    }

    /// Asks the link to robots of other vendors.
    pub async fn ask_link<T>(
        &self,
        question: impl FnOnce(oneshot::Sender<T>) -> LinkQuestion,
    ) -> Result<T, Problem> {
        let link = self.link.as_ref().ok_or_else(|| Problem::unknown("link", requests::no_robot_link()))?;
        let (reply, answer) = oneshot::channel();
        let busy = || Problem::unavailable(requests::busy(), 1);
        link.try_send(question(reply)).map_err(|_| busy())?;
        match tokio::time::timeout(PATIENCE, answer).await {
            Ok(Ok(answer)) => Ok(answer),
            _ => Err(Problem::unavailable(requests::fleet_did_not_answer(), 2)),
        }
    }

    /// The audit entry of a request that came over a feed.
    fn over_feed(&self, request: &Request) -> AuditEntry {
        let (words, worker) = match request {
            Request::Worker(WorkerAction::Finish(worker, _)) => ("done, over the feed", Some(*worker)),
            Request::Worker(WorkerAction::SignOff(worker)) => ("signed off, over the feed", Some(*worker)),
            _ => ("over a feed", None),
        };
        self.audit.begin(&self.caller, words.into(), worker.map(worker_name), (self.now)())
    }

    /// Sends a request to the fleet and waits until the answer is durable; a refusal becomes a problem that explains
    /// it.
    pub async fn ask<A>(&self, ask: Ask<A>) -> Result<A, Problem> {
        self.answer_to(ask).await?.map_err(|why| refused(&self.map, why))
    }

    /// Like [`Api::ask`], but a refusal of the fleet is returned to the caller.
    pub async fn answer_to<A>(&self, ask: Ask<A>) -> Result<Result<A, Refusal>, Problem> {
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
