//! Sends events to webhooks, in order, each until the webhook accepts it or it is given up. An alarm is active while a
//! webhook has accepted nothing for long.
//!
//! Main types: [`HookKeeper`], [`Sender`]. The progress of a webhook is in the database: after a restart it continues
//! there, and events may be sent twice. A message counts as delivered only with a [`Taken`]. Refuses: to follow
//! redirects, to show users and passwords in addresses, and to let one webhook wait for another.

use super::Outbound;
use giveway_api::outgoing::failure;
use giveway_api::outgoing::targets::masked;
use giveway_api::outgoing::webhooks::{message, read_secret, signature};
use giveway_api::{Api, FailedMessage, HookRequest, Names, Taken, Webhook};
use giveway_fleet::EventQuery;
use giveway_fleet::alarm::AlarmKind;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_store::{FailedRow, HookRow, Store, StoreError};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep_until};

/// The most requests that wait.
const WAITING: usize = 16;

/// The most events in a message.
const AT_ONCE: u32 = 100;

/// How long a receiver may take to answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// The first pause after a failure, and the longest; each pause is twice as long as the previous one.
const PAUSES: (Duration, Duration) = (Duration::from_secs(1), Duration::from_secs(300));

/// A message is given up after this many attempts, which take more than an hour.
const ATTEMPTS: u32 = 20;

/// The longest interval between two checks of a webhook.
const LOOK: Duration = Duration::from_secs(30);

/// The queue of requests about webhooks.
pub fn hook_queue() -> (mpsc::Sender<HookRequest>, mpsc::Receiver<HookRequest>) {
    mpsc::channel(WAITING)
}

/// Answers requests about webhooks, and sends them events.
pub struct HookKeeper {
    store: Arc<Store>,
    api: Api,
    sender: Sender,
    requests: mpsc::Receiver<HookRequest>,
    /// Webhooks to which a message is being sent.
    busy: BTreeSet<i64>,
    on_the_way: JoinSet<(i64, u64, Result<Delivery, StoreError>)>,
    /// Webhooks that pause after a failure, and until when.
    resting: Vec<(i64, Instant)>,
    /// The webhooks in the database; nothing after a change.
    hooks: Option<Vec<HookRow>>,
    /// How often there was news of events.
    news: u64,
    /// The news up to which each webhook has received everything.
    known: BTreeMap<i64, u64>,
    /// Webhooks that have accepted nothing: since when, and why.
    failing: BTreeMap<i64, (Instant, String)>,
    /// How long a webhook may accept nothing before an alarm is raised.
    tolerance: Duration,
}

/// The result of an attempt.
enum Delivery {
    /// There was nothing to send.
    Nothing,
    /// A message was accepted.
    Done,
    /// The webhook's position moved past events that are not for it, or are no longer kept.
    Skipped,
    /// A message was refused: after how many attempts, and why.
    Refused(u32, String),
}

impl HookKeeper {
    /// A keeper for a server.
    pub fn new(
        store: Arc<Store>,
        api: Api,
        outbound: &Outbound,
        requests: mpsc::Receiver<HookRequest>,
    ) -> HookKeeper {
        let (busy, on_the_way) = (BTreeSet::new(), JoinSet::new());
        let (sender, known) =
            (Sender(outbound.outgoing.agent_for(outbound.targets.clone(), PATIENCE)), BTreeMap::new());
        HookKeeper {
            store,
            api,
            sender,
            requests,
            busy,
            on_the_way,
            resting: Vec::new(),
            hooks: None,
            news: 0,
            known,
            failing: BTreeMap::new(),
            tolerance: outbound.tolerance,
        }
    }

    /// Runs until no more requests can come.
    pub async fn run(mut self) {
        let mut changed = self.store.events_changed();
        loop {
            if let Err(e) = self.begin().await {
                tracing::warn!("webhooks are not told at present: {e}");
            }
            self.warn();
            let look = Instant::now() + LOOK;
            let rests = self.resting.iter().map(|(_, until)| *until);
            let overdue = self.failing.values().map(|(since, _)| *since + self.tolerance);
            let next = rests.chain(overdue.filter(|at| *at > Instant::now())).min();
            let next = next.map_or(look, |next| next.min(look));
            tokio::select! {
                request = self.requests.recv() => match request {
                    Some(request) => self.answer(request).await,
                    None => return,
                },
                _ = changed.changed() => self.news += 1,
                Some(done) = self.on_the_way.join_next() => self.note(done),
                () = sleep_until(next) => if next == look { self.known.clear() },
            }
        }
    }

    /// Starts a message to each webhook that neither pauses nor is being sent one.
    async fn begin(&mut self) -> Result<(), StoreError> {
        self.resting.retain(|(_, until)| *until > Instant::now());
        let hooks = match self.hooks.take() {
            Some(hooks) => hooks,
            None => self.store.webhooks().await?,
        };
        for hook in self.hooks.insert(hooks).clone() {
            let rests = self.resting.iter().any(|(id, _)| *id == hook.id);
            let knows = self.known.get(&hook.id).is_some_and(|news| *news == self.news);
            if rests || knows || !self.busy.insert(hook.id) {
                continue;
            }
            let news = self.news;
            let (store, api, sender) = (self.store.clone(), self.api.clone(), self.sender.clone());
            self.on_the_way.spawn(async move { (hook.id, news, tell(&store, &api, &sender, &hook).await) });
        }
        Ok(())
    }

    /// Notes the result of an attempt; makes the webhook pause after a failure.
    fn note(&mut self, done: Result<(i64, u64, Result<Delivery, StoreError>), tokio::task::JoinError>) {
        let Ok((id, news, told)) = done else {
            // It is unknown which webhook it was: all may be sent another message, under the same id.
            self.busy.clear();
            return;
        };
        self.busy.remove(&id);
        if !matches!(told, Ok(Delivery::Nothing)) {
            self.hooks = None;
        }
        let attempts = match told {
            Ok(Delivery::Done) => {
                self.failing.remove(&id);
                return;
            }
            Ok(Delivery::Skipped) => return,
            Ok(Delivery::Nothing) => {
                self.known.insert(id, news);
                return;
            }
            Ok(Delivery::Refused(attempts, why)) => {
                self.failing.entry(id).or_insert((Instant::now(), String::new())).1 = why;
                attempts
            }
            Err(e) => {
                tracing::warn!("how far webhook {id} is cannot be written down: {e}");
                1
            }
        };
        let pause = PAUSES.0 * 2_u32.saturating_pow(attempts.saturating_sub(1).min(16));
        self.resting.push((id, Instant::now() + pause.min(PAUSES.1)));
    }

    /// Raises or ends the alarm about webhooks that have accepted nothing for too long.
    fn warn(&mut self) {
        let Some(hooks) = &self.hooks else { return };
        let now = (self.api.now)();
        self.failing.retain(|id, _| hooks.iter().any(|hook| hook.id == *id));
        let overdue = self.failing.iter().filter(|(_, (since, _))| since.elapsed() >= self.tolerance);
        let fails = |id: i64, why: &str| sentence::webhook_fails(format!("h{id}"), why);
        let said: Vec<Sentence> = overdue.map(|(id, (_, why))| fails(*id, why)).collect();
        if said.is_empty() {
            self.api.alarms.clear(AlarmKind::WebhookFailing, now);
        } else {
            self.api.alarms.raise(AlarmKind::WebhookFailing, sentence::webhooks_fail(said), now);
        }
    }

    /// Answers a request; a receiver that is gone is no error.
    async fn answer(&mut self, request: HookRequest) {
        let text = |e: StoreError| {
            tracing::error!("webhooks: {e}");
            "the database does not answer; the server's log says why".to_owned()
        };
        match request {
            HookRequest::List(reply) => {
                let hooks = self.store.webhooks().await.map_err(text);
                let _ = reply.send(hooks.map(|hooks| hooks.into_iter().map(shown).collect()));
            }
            HookRequest::Add(url, kinds, secret, reply) => {
                self.hooks = None;
                let added = self.store.add_webhook(&url, &kinds, &secret, (self.api.now)()).await;
                let _ = reply.send(added.map(shown).map_err(text));
            }
            HookRequest::Remove(id, reply) => {
                self.hooks = None;
                let _ = reply.send(self.store.remove_webhook(id).await.map_err(text));
            }
            HookRequest::Failures(id, before, limit, reply) => {
                let _ = reply.send(self.failures(id, before, limit).await.map_err(text));
            }
        }
    }

    async fn failures(
        &self,
        id: i64,
        before: Option<i64>,
        limit: u32,
    ) -> Result<Option<Vec<FailedMessage>>, StoreError> {
        if self.store.webhooks().await?.iter().all(|hook| hook.id != id) {
            return Ok(None);
        }
        let rows = self.store.webhook_failures(id, before, limit).await?;
        Ok(Some(rows.into_iter().map(failed).collect()))
    }
}

/// Sends a webhook its next message, and stores the result.
async fn tell(store: &Store, api: &Api, sender: &Sender, hook: &HookRow) -> Result<Delivery, StoreError> {
    let span = store.event_span().await?;
    if hook.cursor < span.before {
        store.webhook_missed(hook.id, span.before, "these events are not kept any more").await?;
        store.webhook_given_up(hook.id, (hook.cursor + 1, span.before), (api.now)()).await?;
        return Ok(Delivery::Skipped);
    }
    let query = EventQuery { kinds: hook.kinds.clone(), after: hook.cursor, limit: AT_ONCE };
    let mut rows = store.events(&query).await?;
    // A message that is tried again has the same events: receivers know it by its id.
    rows.retain(|row| hook.pending.is_none_or(|pending| row.seq <= pending));
    let (Some(first), Some(last)) = (rows.first().map(|r| r.seq), rows.last().map(|r| r.seq)) else {
        // Events of other kinds then do not look missed when they are deleted.
        if hook.cursor < (span.before + span.last) / 2 {
            store.webhook_reached(hook.id, span.last).await?;
            return Ok(Delivery::Skipped);
        }
        return Ok(Delivery::Nothing);
    };
    let id = format!("giveway-{}-{first}-{last}", hook.id);
    let seconds = (api.now)().0 / 1_000_000;
    let moment = api.moments.borrow().clone();
    let body = message(Names { map: &api.map, view: &moment.view }, rows);
    let sent = match read_secret(&hook.secret) {
        Some(secret) => {
            let signed = signature(&secret, &id, seconds, &body);
            sender.post(hook.url.clone(), [id, seconds.to_string(), signed], body).await
        }
        None => Err("its secret cannot be read: remove this webhook and add it again".to_owned()),
    };
    let why = match sent {
        Ok(Taken { .. }) => {
            store.webhook_reached(hook.id, last).await?;
            return Ok(Delivery::Done);
        }
        Err(why) => masked(&hook.url).text(&why),
    };
    store.webhook_missed(hook.id, last, &why).await?;
    let attempts = hook.attempts + 1;
    tracing::warn!(hook = hook.id, attempts, "a webhook does not take events {first} to {last}: {why}");
    if attempts >= ATTEMPTS {
        store.webhook_given_up(hook.id, (first, last), (api.now)()).await?;
    }
    Ok(Delivery::Refused(attempts, why))
}

/// Sends messages.
#[derive(Clone)]
pub struct Sender(ureq::Agent);

impl Sender {
    /// Posts a message with its id, time and signature; says why it was not accepted.
    async fn post(&self, url: String, headers: [String; 3], body: String) -> Result<Taken, String> {
        let agent = self.0.clone();
        let post = move || {
            let [id, seconds, signed] = headers;
            agent
                .post(url)
                .header("content-type", "application/json")
                .header("webhook-id", id)
                .header("webhook-timestamp", seconds)
                .header("webhook-signature", signed)
                .send(body)
                .map_err(|e| failure(&e))
                .and_then(|answer| Taken::of(answer.status()))
        };
        tokio::task::spawn_blocking(post).await.map_err(|_| "sending broke off".to_owned())?
    }
}

fn shown(row: HookRow) -> Webhook {
    let HookRow { id, url, kinds, created, cursor, attempts, failed, .. } = row;
    Webhook { id, url: masked(&url).to_string(), kinds, created, cursor, attempts, failed }
}

fn failed(row: FailedRow) -> FailedMessage {
    let FailedRow { id, first, last, at, attempts, error } = row;
    FailedMessage { id, events: (first, last), at, attempts, error }
}
