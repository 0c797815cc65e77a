//! The running server: reads settings, restores the fleet, wires the parts, and takes them down in order.
//!
//! Main types: [`Server`] (started, with its address), [`Config`]. `drive` is the loop. The port answers first, and
//! says "starting" until the journal is loaded. Going down: no new requests, those on their way are answered, one last
//! step, the journal flushed, sockets and files closed. Refuses: to start where anything is wrong with map, database,
//! address or tokens.

mod ahead;
mod alarm_keeper;
mod answers;
mod audit_keeper;
mod certificate;
mod clock;
mod config;
mod connections;
mod custody;
mod drive;
mod entrance;
mod historian;
mod inbox;
mod journal;
mod kinds;
mod measure;
mod outbox;
mod past;
mod people;
mod queue;
mod recorder;
mod recordings;
mod records;
mod rescue;
mod show;
mod start;
mod strangers;
mod tls;
mod tokens;
mod trial;
mod watchdog;
mod webhooks;

pub use certificate::Identity;
pub use clock::Clock;
pub use config::{Config, Flags};
pub use recorder::FrameRecorder;
pub use show::Show;

use crate::alarm::AlarmKind;
use crate::api::alarms::Alarms;
use crate::api::audit::AuditDesk;
use crate::api::feed::hub::Feeds;
use crate::api::live::Live;
use crate::api::metrics::Metrics;
use crate::api::oidc::Oidc;
use crate::api::outgoing::Outgoing;
use crate::api::port::{Moment, Now, QUESTIONS, Question};
use crate::api::{Api, auth::Gate, caller::Caller, router};
use crate::fleet::Fleet;
use crate::sim::{OrderLine, Scenario, World};
use crate::store::{Store, StoreError};
use crate::time::Span;
use crate::warehouse::Warehouse;
use anyhow::{Context, anyhow, ensure};
use axum::Router;
use axum::serve::ListenerExt;
use entrance::Entrance;
use start::{Built, ServerParts};
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{mpsc, oneshot, watch};
use tokio::task::JoinHandle;
use tokio::time::timeout;

/// How long requests on their way may take when the server goes down.
const DRAIN: Duration = Duration::from_secs(12);

/// How long the journal may take for the last facts.
const FLUSH: Duration = Duration::from_secs(10);

/// The loop is stuck when its view is older.
const STUCK: Span = Span::from_secs(2);

/// What the server runs: a simulated floor, until real robots come.
pub struct SimulatedFloor {
    /// Fleet, customers, faults.
    pub scenario: Scenario,
    /// The building.
    pub map: Arc<Warehouse>,
    /// What the customers order, where the scenario names a file.
    pub lines: Vec<OrderLine>,
}

impl SimulatedFloor {
    /// The same with the kinds of robots that were added to a database.
    pub async fn with_kinds_of(mut self, database: &Path) -> SimulatedFloor {
        let added = kinds::kinds_of(database).await;
        self.map = kinds::join_kinds(&mut self.scenario, self.map, &added);
        self
    }
}

/// A server at work.
pub struct Server {
    address: SocketAddr,
    summary: StartSummary,
    identity: Option<Identity>,
    store: Arc<Store>,
    stop: watch::Sender<bool>,
    work: JoinHandle<anyhow::Result<()>>,
}

/// What was found at the start.
#[derive(Clone, Debug)]
pub struct StartSummary {
    /// Name of the map.
    pub map: String,
    /// Robots that the scenario has.
    pub robots: usize,
    /// Facts restored, behind the last snapshot.
    pub facts: usize,
    /// Jobs accepted so far.
    pub jobs: u64,
    /// Of them, jobs that are not over.
    pub open_jobs: u64,
    /// Why the server does nothing but say so.
    pub trouble: Option<String>,
}

impl Server {
    /// Starts a server.
    ///
    /// # Errors
    /// Where anything is wrong; the text says what to do.
    pub async fn start(config: &Config, floor: SimulatedFloor) -> anyhow::Result<Server> {
        let gate = Arc::new(config.gate()?);
        if !config.new {
            gate.learn(tokens::tokens_of(&config.database).await, Clock::start(None).started());
        }
        let address = config.address(&gate).await?;
        let listener = TcpListener::bind(address).await.with_context(|| {
            let remedy = "stop the program that does, or choose another with --listen HOST:PORT";
            format!("cannot listen on {address}: {remedy}")
        })?;
        let address = listener.local_addr()?;
        let kept =
            "keep_days must be at least 8: keys of jobs are kept for 7 days, and the jobs must outlive them";
        ensure!(config.keep_days >= 8, "{kept}");
        ensure!(config.people_keep_days >= 1, "people_keep_days must be at least 1");
        let identity = identity(config, address)?;
        let outbound = Outbound::of(config)?;
        let base = floor.scenario.clone();
        let floor = if config.new { floor } else { floor.with_kinds_of(&config.database).await };
        let door = (listener, identity.as_ref().map(|i| i.config.clone()));
        let (ready, is_ready) = oneshot::channel();
        let front = Front::open(door, gate, outbound, ready);
        tracing::info!("listening on {address}; the journal is being loaded");
        let store = match start::open(config, &floor).await {
            Ok(store) => store,
            Err(e) => return Err(front.shut(e).await),
        };
        let (built, summary) = match start::build(config, floor, base, &store).await {
            Ok(built) => built,
            Err(e) => {
                store.close().await;
                return Err(front.shut(e).await);
            }
        };
        let (stop, stopping) = watch::channel(false);
        let work = match built {
            Built::Whole(parts) => tokio::spawn(work(*parts, store.clone(), front, stopping)),
            Built::Broken(why) => tokio::spawn(explain(why, store.clone(), front, stopping)),
        };
        // It says nothing: being dropped is enough, and happens also where the work ends at once.
        let _ = is_ready.await;
        Ok(Server { address, summary, identity, store, stop, work })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What it shows itself with, where it speaks HTTPS.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// What was found at the start.
    pub fn summary(&self) -> &StartSummary {
        &self.summary
    }

    /// The database.
    pub fn store(&self) -> &Arc<Store> {
        &self.store
    }

    /// Waits until the server ends by itself, which it does only where it cannot go on.
    ///
    /// # Errors
    /// Why it ended.
    pub async fn ended(&mut self) -> anyhow::Result<()> {
        (&mut self.work).await.context("the server ended unexpectedly")?
    }

    /// Takes the server down in order.
    ///
    /// # Errors
    /// Where facts could not be written any more. None of them was acknowledged.
    pub async fn stop(self) -> anyhow::Result<()> {
        self.stop.send_replace(true);
        self.work.await.context("the server ended unexpectedly")?
    }
}

/// Where connections come in, and whether by TLS.
type Door = (TcpListener, Option<Arc<rustls::ServerConfig>>);

/// The side of the server that faces the network: it is there from the beginning to the end.
struct Front {
    entrance: Entrance,
    http: JoinHandle<std::io::Result<()>>,
    gate: Arc<Gate>,
    outbound: Outbound,
    /// Dropped when it no longer says "starting".
    ready: oneshot::Sender<()>,
    closing: watch::Sender<bool>,
    closes: watch::Receiver<bool>,
}

impl Front {
    fn open(door: Door, gate: Arc<Gate>, outbound: Outbound, ready: oneshot::Sender<()>) -> Front {
        let (entrance, (closing, closes)) = (Entrance::default(), watch::channel(false));
        let http = tokio::spawn(listen(door, entrance.router(), closes.clone()));
        Front { entrance, http, gate, outbound, ready, closing, closes }
    }

    /// Closes the port, since the server cannot start.
    async fn shut(self, why: anyhow::Error) -> anyhow::Error {
        self.http.abort();
        let _ = self.http.await;
        why
    }
}

/// What the server needs for its own requests.
struct Outbound {
    outgoing: Outgoing,
    /// How long a webhook may take nothing before that is an alarm.
    tolerance: Duration,
    oidc: Option<Arc<Oidc>>,
}

impl Outbound {
    fn of(config: &Config) -> anyhow::Result<Outbound> {
        let outgoing = Outgoing::trusting(config.ca_file.as_deref()).map_err(anyhow::Error::msg)?;
        let oidc = config.oidc.clone().map(|settings| Oidc::new(settings, &outgoing)).transpose();
        let tolerance = Duration::from_secs(config.webhook_alarm_s.into());
        Ok(Outbound { tolerance, oidc: oidc.map_err(anyhow::Error::msg)?.map(Arc::new), outgoing })
    }
}

/// What it shows itself with, where it speaks HTTPS.
fn identity(config: &Config, address: SocketAddr) -> anyhow::Result<Option<Identity>> {
    let Some(place) = config.tls(address)? else { return Ok(None) };
    let now = jiff::Timestamp::from_microsecond(Clock::start(None).started().0)?;
    Ok(Some(Identity::open(&place, now.to_zoned(jiff::tz::TimeZone::UTC).date())?))
}

/// Says why the server does not work until it is told to stop: a process that ended would be started again, and
/// again, and could tell no one.
async fn explain(
    why: String,
    store: Arc<Store>,
    front: Front,
    mut stopping: watch::Receiver<bool>,
) -> anyhow::Result<()> {
    tracing::error!("{why}");
    front.entrance.shut(why);
    drop(front.ready);
    let _ = stopping.wait_for(|stop| *stop).await;
    drain(front.http, &front.closing).await;
    store.close().await;
    Ok(())
}

/// Wires the parts and runs them.
async fn work(
    parts: ServerParts,
    store: Arc<Store>,
    front: Front,
    stopping: watch::Receiver<bool>,
) -> anyhow::Result<()> {
    let ServerParts { fleet, world, clock, period, start, interop, feeds, heard, live, past, charts, .. } =
        parts;
    let Front { entrance, http, gate, outbound, ready, closing, closes } = front;
    let (alarms, metrics) = (parts.alarms, Arc::new(Metrics::default()));
    let (journal, writer) =
        journal::journal(store.clone(), start, clock.clone(), alarms.clone(), metrics.clone());
    let ((queue, requests), (ask, questions)) = (mpsc::channel(inbox::QUEUE), mpsc::channel(QUESTIONS));
    let (displaced, gone) = watch::channel(false);
    let custody = tokio::spawn(custody::watch_over(store.clone(), alarms.clone(), clock.clone(), displaced));
    let (map, view) = (fleet.warehouse().clone(), fleet.view(clock.now()));
    let (keeper, kinds) = kinds::KindKeeper::new(store.clone(), parts.base, &fleet);
    let keeper = tokio::spawn(keeper.run());
    let (moments, picture) = watch::channel(Arc::new(Moment { view, ..Moment::default() }));
    let shares = LoopShares { store, clock, metrics, alarms, feeds };
    let (inbox, notes, tap) = (inbox::Inbox::new(requests, heard), charts.notes, past.tap);
    let ends = LoopEnds { inbox, questions, journal, notes, tap, displaced: gone.clone(), moments };
    let drive = drive_loop((fleet, world, period), ends, shares.clone());
    let LoopShares { store, clock, metrics, alarms, feeds } = shares;
    let (halt, halted) = watch::channel(false);
    let feed = tokio::spawn(feed(live.clone(), picture.clone(), alarms.clone(), clock.clone()));
    let alarm_keeper = alarm_keeper::keep_alarms(store.clone(), alarms.clone(), halted.clone());
    let (writer, thread) = (tokio::spawn(writer.run()), spawn_loop(drive, halted)?);
    let (audit, answered) = AuditDesk::new(parts.last_audit);
    let audit_keeper = audit_keeper::keep_audit(store.clone(), answered, halt.subscribe());
    let keepers = [tokio::spawn(alarm_keeper), tokio::spawn(audit_keeper)];
    let now: Now = Arc::new(move || clock.now());
    let (tokens, desk) = tokens::TokenKeeper::start(store.clone(), gate.clone(), now.clone()).await;
    let pseudonyms = people::pseudonyms(&store, &now, parts.names_for).await?;
    let (hooks, asked) = webhooks::hook_queue();
    let api = Api {
        map,
        kinds,
        moments: picture,
        records: Arc::new(records::Shelf(store.clone())),
        figures: charts.figures,
        queue: Some(queue),
        hooks: Some(hooks),
        questions: ask,
        alarms,
        past: past.folder,
        live,
        feeds,
        pseudonyms: Arc::new(pseudonyms),
        interop: Arc::new(interop),
        now,
        metrics,
        trials: trial::trials(),
        gate,
        oidc: outbound.oidc.clone(),
        tokens: Some(Arc::new(tokens)),
        answers: Some(Arc::new(answers::AnswerKeeper::new(store.clone()))),
        audit: Arc::new(audit),
        caller: Arc::new(Caller::anonymous()),
        entry: None,
        closing: closes,
    };
    let hook_keeper =
        tokio::spawn(webhooks::HookKeeper::new(store.clone(), api.clone(), &outbound, asked).run());
    entrance.open(router(api).0);
    drop(ready);
    let historian = charts.historian;
    let tasks = Tasks { http, writer, thread, feed, custody, keeper, desk, historian, keepers, hook_keeper };
    tasks.run(&store, stopping, (&closing, &halt), &gone).await
}

/// What the loop shares with other parts.
#[derive(Clone)]
struct LoopShares {
    store: Arc<Store>,
    clock: Arc<Clock>,
    metrics: Arc<Metrics>,
    alarms: Arc<Alarms>,
    feeds: Arc<Feeds>,
}

/// The loop's ends of channels.
struct LoopEnds {
    inbox: inbox::Inbox,
    questions: mpsc::Receiver<Question>,
    journal: journal::Journal,
    notes: historian::HistorianSender,
    tap: recordings::Tap,
    displaced: watch::Receiver<bool>,
    moments: watch::Sender<Arc<Moment>>,
}

/// The loop, before its first turn.
fn drive_loop(
    (fleet, world, period): (Fleet, World, Span),
    ends: LoopEnds,
    shared: LoopShares,
) -> drive::DriveLoop {
    let LoopEnds { inbox, questions, journal, notes, tap, displaced, moments } = ends;
    let LoopShares { store, clock, metrics, alarms, feeds } = shared;
    drive::DriveLoop {
        fleet,
        world,
        clock,
        period,
        inbox,
        questions,
        outbox: outbox::Outbox::default(),
        journal,
        measure: measure::Measure::default(),
        notes,
        metrics,
        ahead: ahead::LastForecasts::default(),
        feeds,
        tap,
        alarms,
        pace: drive::LoopPace::default(),
        displaced,
        rescue: rescue::Rescue::default(),
        watchdog: watchdog::Watchdog::default(),
        store,
        moments,
    }
}

/// What runs side by side.
struct Tasks {
    http: JoinHandle<std::io::Result<()>>,
    writer: JoinHandle<Result<(), StoreError>>,
    thread: oneshot::Receiver<()>,
    feed: JoinHandle<()>,
    custody: JoinHandle<()>,
    keeper: JoinHandle<()>,
    desk: JoinHandle<()>,
    historian: JoinHandle<()>,
    /// Of alarms and of the audit.
    keepers: [JoinHandle<()>; 2],
    hook_keeper: JoinHandle<()>,
}

impl Tasks {
    /// Lets all of it run until told to stop, or until something cannot go on; then takes it down in order.
    async fn run(
        self,
        store: &Store,
        mut stopping: watch::Receiver<bool>,
        (closing, halt): (&watch::Sender<bool>, &watch::Sender<bool>),
        displaced: &watch::Receiver<bool>,
    ) -> anyhow::Result<()> {
        let Tasks { mut http, mut writer, mut thread, mut feed, historian, keepers, .. } = self;
        let Tasks { custody, keeper, desk, hook_keeper, .. } = self;
        let ended: anyhow::Result<()> = tokio::select! {
            _ = stopping.wait_for(|stop| *stop) => Ok(()),
            _ = &mut thread => Err(anyhow!("the control loop failed, as logged above; nothing is lost")),
            out = &mut writer => Err(written(out)),
            out = &mut http => Err(anyhow!("the HTTP server stopped: {out:?}")),
            out = &mut feed => Err(anyhow!("the live feed failed: {out:?}")),
        };
        drain(http, closing).await;
        halt.send_replace(true);
        let (abort, displaced) = (writer.abort_handle(), *displaced.borrow());
        let flushed = match ended {
            Ok(()) => flush(thread, writer, historian, displaced).await,
            Err(_) => Ok(()),
        };
        for keeper in keepers {
            let _ = keeper.await;
        }
        // The files are given back whatever happened: nothing that still knows the store can use it from here on.
        let others = [&feed, &custody, &keeper, &desk, &hook_keeper].map(JoinHandle::abort_handle);
        for task in others.into_iter().chain([abort]) {
            task.abort();
        }
        store.close().await;
        ended.and(flushed)
    }
}

/// Lets the last step, its facts and the figures over time be written.
async fn flush(
    thread: oneshot::Receiver<()>,
    writer: JoinHandle<Result<(), StoreError>>,
    historian: JoinHandle<()>,
    displaced: bool,
) -> anyhow::Result<()> {
    let _ = thread.await;
    // A database that was taken away is hardly brought back now.
    let patience = if displaced { FLUSH / 10 } else { FLUSH };
    let lost = "the journal did not take the last facts. None of them was acknowledged";
    timeout(patience, writer).await.context(lost)?.context(lost)?.context(lost)?;
    if timeout(patience, historian).await.is_err() {
        tracing::warn!("the last figures over time were not saved");
    }
    Ok(())
}

/// Takes no more requests, and lets those that are being answered end, for a while.
async fn drain(mut http: JoinHandle<std::io::Result<()>>, closing: &watch::Sender<bool>) {
    closing.send_replace(true);
    if !http.is_finished() && timeout(DRAIN, &mut http).await.is_err() {
        tracing::warn!("some requests did not end in time");
        http.abort();
    }
}

/// Runs the loop on a thread of its own: steps are work, and nothing else may wait for them.
fn spawn_loop(
    drive: drive::DriveLoop,
    halted: watch::Receiver<bool>,
) -> anyhow::Result<oneshot::Receiver<()>> {
    let (ended, end) = oneshot::channel();
    let runtime = tokio::runtime::Handle::current();
    let body = move || {
        let _ended = ended;
        runtime.block_on(drive.run(halted));
    };
    std::thread::Builder::new().name("fleet".into()).spawn(body).context("cannot start the control loop")?;
    Ok(end)
}

async fn listen(door: Door, router: Router, closes: watch::Receiver<bool>) -> std::io::Result<()> {
    let (listener, tls) = door;
    if let Some(config) = tls {
        let listener = tls::TlsListener::new(listener, config)?;
        connections::serve(listener, router, closes).await;
        return Ok(());
    }
    let listener = listener.tap_io(|stream| {
        if let Err(e) = stream.set_nodelay(true) {
            tracing::debug!("TCP_NODELAY: {e}");
        }
    });
    connections::serve(listener, router, closes).await;
    Ok(())
}

/// Publishes every new view in the live feed; if none comes, raises an alarm.
async fn feed(
    live: Arc<Live>,
    mut picture: watch::Receiver<Arc<Moment>>,
    alarms: Arc<Alarms>,
    clock: Arc<Clock>,
) {
    let started_s = clock.started().as_secs_f64();
    loop {
        let moment = picture.borrow_and_update().clone();
        let age = clock.now() - moment.view.now;
        if age <= STUCK {
            alarms.clear(AlarmKind::LoopStuck, clock.now());
        } else {
            alarms.raise(
                AlarmKind::LoopStuck,
                "the control loop is stuck: robots get no orders.",
                clock.now(),
            );
        }
        live.publish(&moment, &alarms.list(), started_s);
        if let Ok(Err(_)) = timeout(Duration::from_secs(1), picture.changed()).await {
            return std::future::pending().await;
        }
    }
}

fn written(out: Result<Result<(), StoreError>, tokio::task::JoinError>) -> anyhow::Error {
    match out {
        Ok(Err(e)) => anyhow::Error::new(e).context("the journal contradicts the fleet"),
        Ok(Ok(())) => anyhow!("the journal ended because the control loop failed; see its error above"),
        Err(e) => anyhow::Error::new(e).context("the journal's task failed"),
    }
}
