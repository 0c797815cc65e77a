//! The running server: reads settings, restores the fleet, wires the parts, and takes them down in order.
//!
//! Main types: [`Server`] (started, with its address), [`Config`]. `drive` is the loop. Going down: no new
//! requests, those on their way are answered, one last step, the journal flushed, sockets and files closed.
//! Refuses: to start where anything is wrong with map, database, address or tokens.

mod ahead;
mod certificate;
mod clock;
mod config;
mod drive;
mod film;
mod historian;
mod inbox;
mod journal;
mod measure;
mod outbox;
mod past;
mod queue;
mod records;
mod reels;
mod show;
mod tls;

pub use certificate::Identity;
pub use clock::Clock;
pub use config::{Config, Flags};
pub use film::Film;
pub use show::Show;

use crate::api::feed::hub::{Feeds, Heard};
use crate::api::live::Live;
use crate::api::massrobotics::Interop;
use crate::api::metrics::Metrics;
use crate::api::port::{Alarms, Figures, Moment, QUESTIONS};
use crate::api::{Api, auth::Gate, router};
use crate::fleet::{Fleet, Ledger, Settings};
use crate::history::History;
use crate::sim::{OrderLine, Scenario, World};
use crate::store::{Store, StoreError};
use crate::time::Span;
use crate::warehouse::Warehouse;
use anyhow::{Context, anyhow, ensure};
use axum::serve::ListenerExt;
use reels::Past;
use std::net::SocketAddr;
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

/// The loop is stuck when its picture is older.
const STUCK: Span = Span::from_secs(2);

/// What the server runs: a simulated floor, until real robots come.
pub struct Floor {
    /// Fleet, customers, faults.
    pub scenario: Scenario,
    /// The building.
    pub map: Arc<Warehouse>,
    /// What the customers order, where the scenario names a file.
    pub lines: Vec<OrderLine>,
}

/// A server at work.
pub struct Server {
    address: SocketAddr,
    summary: Summary,
    identity: Option<Identity>,
    store: Arc<Store>,
    stop: watch::Sender<bool>,
    work: JoinHandle<anyhow::Result<()>>,
}

/// What was found at the start.
#[derive(Clone, Debug)]
pub struct Summary {
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
}

impl Server {
    /// Starts a server.
    ///
    /// # Errors
    /// Where anything is wrong; the text says what to do.
    pub async fn start(config: &Config, floor: Floor) -> anyhow::Result<Server> {
        let gate = config.gate()?;
        let address = config.address(&gate).await?;
        let Floor { scenario, map, lines } = floor;
        let listener = TcpListener::bind(address).await.with_context(|| {
            let remedy = "stop the program that does, or choose another with --listen HOST:PORT";
            format!("cannot listen on {address}: {remedy}")
        })?;
        let address = listener.local_addr()?;
        let place = config.tls(address)?;
        let kept =
            "keep_days is at least 8, since keys of jobs are known for 7 days, and so must the jobs be";
        ensure!(config.keep_days >= 8, "{kept}");
        let store = Store::open(&config.database, &map).await?.keep_days(config.keep_days);
        let store = Arc::new(store);
        let loaded = store.load(Ledger::new(map.clone(), scenario.kinematics.clearance, false)).await?;
        let (next, behind) = (loaded.next, loaded.facts());
        let clock = Arc::new(Clock::start(loaded.last));
        let today = jiff::Timestamp::from_microsecond(clock.started().0)?.to_zoned(jiff::tz::TimeZone::UTC);
        let identity = place.map(|place| Identity::open(&place, today.date())).transpose()?;
        let settings = Settings { stopwatch: clock::stopwatch, ..scenario.settings() };
        let (buckets, heat) = store.load_history().await?;
        let history = History::restore(buckets, heat);
        let figures = Arc::new(Figures::new(clock.started(), settings.arm.word(), history));
        let (ledger, facts) = loaded.into_parts();
        let fleet = Fleet::resume(ledger, settings, facts);
        let ledger = fleet.ledger();
        let summary = Summary {
            map: map.name.clone(),
            robots: scenario.robots,
            facts: behind,
            jobs: ledger.next_job - 1,
            open_jobs: ledger.jobs.len() as u64,
        };
        let start = journal::Start { next, ledger: ledger.clone(), behind };
        let world = World::new(map, &scenario, &lines, scenario.seed, &fleet, clock.now());
        let (stop, stopping) = watch::channel(false);
        let (feeds, heard) = Feeds::new();
        feeds.know(&fleet.ledger().workers);
        let (period, feeds) = (scenario.period, Arc::new(feeds));
        let interop = config.massrobotics.clone();
        let live = Arc::new(Live::new(fleet.warehouse().clone(), clock.started().0.unsigned_abs()));
        let alarms = Arc::new(Alarms::default());
        let past = Past::keep(config.past(), fleet.warehouse(), &live, &clock, &alarms);
        let (notes, historian) = historian::historian(figures.clone(), store.clone());
        let charts = Charts { figures, notes, historian: tokio::spawn(historian.run()) };
        let parts = Parts {
            fleet,
            world,
            clock,
            period,
            start,
            gate,
            interop,
            feeds,
            heard,
            live,
            alarms,
            past,
            charts,
        };
        let door = (listener, identity.as_ref().map(|i| i.config.clone()));
        let work = tokio::spawn(work(parts, store.clone(), door, stopping));
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
    pub fn summary(&self) -> &Summary {
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

/// What the parts of the server are made of.
struct Parts {
    fleet: Fleet,
    world: World,
    clock: Arc<Clock>,
    period: Span,
    start: journal::Start,
    gate: Gate,
    interop: Interop,
    feeds: Arc<Feeds>,
    heard: mpsc::Receiver<Heard>,
    live: Arc<Live>,
    alarms: Arc<Alarms>,
    past: Past,
    charts: Charts,
}

/// Figures over time, and who keeps them.
struct Charts {
    figures: Arc<Figures>,
    notes: historian::Notes,
    historian: JoinHandle<()>,
}

/// Runs everything until told to stop, or until something cannot go on; then takes it down in order.
async fn work(
    parts: Parts,
    store: Arc<Store>,
    door: Door,
    mut stopping: watch::Receiver<bool>,
) -> anyhow::Result<()> {
    let Parts { fleet, world, clock, period, start, gate, interop, feeds, heard, live, past, charts, .. } =
        parts;
    let (alarms, metrics) = (parts.alarms, Arc::new(Metrics::default()));
    let (journal, writer) =
        journal::journal(store.clone(), start, clock.clone(), alarms.clone(), metrics.clone());
    let ((desk, requests), (ask, questions)) = (mpsc::channel(inbox::DESK), mpsc::channel(QUESTIONS));
    let (map, view) = (fleet.warehouse().clone(), fleet.view(clock.now()));
    let (moments, picture) = watch::channel(Arc::new(Moment { view, ..Moment::default() }));
    let drive = drive::Drive {
        fleet,
        world,
        clock: clock.clone(),
        period,
        inbox: inbox::Inbox::new(requests, heard),
        questions,
        outbox: outbox::Outbox::default(),
        journal,
        measure: measure::Measure::default(),
        notes: charts.notes,
        metrics: metrics.clone(),
        ahead: ahead::Ahead::default(),
        feeds: feeds.clone(),
        tap: past.tap,
        alarms: alarms.clone(),
        pace: drive::Pace::default(),
        moments,
    };
    let ((closing, closes), (halt, halted)) = (watch::channel(false), watch::channel(false));
    let mut feed = tokio::spawn(feed(live.clone(), picture.clone(), alarms.clone(), clock.clone()));
    let (mut writer, mut thread) = (tokio::spawn(writer.run()), spawn_loop(drive, halted)?);
    let api = Api {
        map,
        moments: picture,
        records: Arc::new(records::Shelf(store.clone())),
        figures: charts.figures,
        desk: Some(desk),
        questions: ask,
        alarms,
        past: past.folder,
        live,
        feeds,
        interop: Arc::new(interop),
        now: Arc::new(move || clock.now()),
        metrics,
        gate: Arc::new(gate),
        closing: closes.clone(),
    };
    let mut http = tokio::spawn(listen(door, api, closes));
    let ended: anyhow::Result<()> = tokio::select! {
        _ = stopping.wait_for(|stop| *stop) => Ok(()),
        _ = &mut thread => Err(anyhow!("the control loop broke, as said above; nothing is lost")),
        out = &mut writer => Err(written(out)),
        out = &mut http => Err(anyhow!("the HTTP server ended: {out:?}")),
        out = &mut feed => Err(anyhow!("the live feed broke: {out:?}")),
    };
    drain(http, &closing).await;
    halt.send_replace(true);
    if ended.is_ok() {
        flush(thread, writer, charts.historian).await?;
    }
    feed.abort();
    store.close().await;
    ended
}

/// Lets the last step, its facts and the figures over time be written.
async fn flush(
    thread: oneshot::Receiver<()>,
    writer: JoinHandle<Result<(), StoreError>>,
    historian: JoinHandle<()>,
) -> anyhow::Result<()> {
    let _ = thread.await;
    let lost = "the journal did not take the last facts. None of them was acknowledged";
    timeout(FLUSH, writer).await.context(lost)?.context(lost)?.context(lost)?;
    if timeout(FLUSH, historian).await.is_err() {
        tracing::warn!("the last figures over time were not written down");
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
fn spawn_loop(drive: drive::Drive, halted: watch::Receiver<bool>) -> anyhow::Result<oneshot::Receiver<()>> {
    let (ended, end) = oneshot::channel();
    let runtime = tokio::runtime::Handle::current();
    let body = move || {
        let _ended = ended;
        runtime.block_on(drive.run(halted));
    };
    std::thread::Builder::new().name("fleet".into()).spawn(body).context("cannot start the control loop")?;
    Ok(end)
}

async fn listen(door: Door, api: Api, mut closes: watch::Receiver<bool>) -> std::io::Result<()> {
    let (router, _) = router(api);
    let closed = async move { _ = closes.wait_for(|closing| *closing).await.is_ok() };
    let (listener, tls) = door;
    if let Some(config) = tls {
        let listener = tls::TlsListener::new(listener, config)?;
        return axum::serve(listener, router).with_graceful_shutdown(closed).await;
    }
    let listener = listener.tap_io(|stream| {
        if let Err(e) = stream.set_nodelay(true) {
            tracing::debug!("TCP_NODELAY: {e}");
        }
    });
    axum::serve(listener, router).with_graceful_shutdown(closed).await
}

/// Publishes every new picture, and says so where there is none.
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
            alarms.clear("loop");
        } else if alarms.raise("loop", "the control loop is stuck: robots get no orders.".into(), clock.now())
        {
            tracing::error!(age.s = age.as_secs_f64(), "the control loop is stuck");
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
        Ok(Ok(())) => anyhow!("the journal ended, since the control loop broke; what it said is above"),
        Err(e) => anyhow::Error::new(e).context("the journal's task broke"),
    }
}
