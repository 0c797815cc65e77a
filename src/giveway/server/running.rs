//! The running core: fleet, floor, journal and everything around them, from wiring to shutdown.
//!
//! Main types: [`RunningCore`], [`CoreEnd`]. When the map is changed, the server replaces one core by another; the port
//! and the gate outlive it. Refuses: to leave a task behind that still has the database.

use super::inbox::Inbox;
use super::links::{Links, trial};
use super::publish::{MapKeeper, MapSwitch};
use super::settle::{SettleQueue, SettleRequest};
use super::start::ServerParts;
use super::{
    Clock, Outbound, Planted, ahead, alarm_keeper, answers, audit_keeper, control, custody, historian, inbox,
    journal, measure, people, recordings, records, tokens, watchdog, webhooks,
};
use anyhow::{Context, anyhow};
use axum::Router;
use giveway_api::{
    Alarms, Api, AuditLog, Caller, Feeds, FloorSimulation, Gate, KindChecks, Live, Metrics, Moment, Now,
    QUESTIONS, Question, WebhookAccess, router,
};
use giveway_drive::Drive;
use giveway_fleet::Fleet;
use giveway_fleet::alarm::AlarmKind;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::Span;
use giveway_store::{Store, StoreError};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot, watch};
use tokio::task::JoinHandle;
use tokio::time::timeout;

/// How long the journal may take for the last facts.
const FLUSH: Duration = Duration::from_secs(10);

/// How long the last frames of recordings may take.
const LAST_FRAMES: Duration = Duration::from_secs(3);

/// The loop is stuck if its view is older than this.
const STUCK: Duration = Duration::from_secs(2);

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
    inbox: Inbox,
    questions: mpsc::Receiver<Question>,
    journal: journal::Journal,
    notes: historian::HistorianSender,
    tap: recordings::BookmarkSender,
    displaced: watch::Receiver<bool>,
    moments: watch::Sender<Arc<Moment>>,
    settle: mpsc::Receiver<SettleRequest>,
    planted: Planted,
}

/// The loop, before its first turn.
fn control_loop(
    (fleet, links, period): (Fleet, Links, Span),
    simulation: Option<FloorSimulation>,
    ends: LoopEnds,
    shared: LoopShares,
) -> control::ControlLoop {
    let LoopEnds { inbox, questions, journal, notes, tap, displaced, moments, settle, planted } = ends;
    let LoopShares { store, clock, metrics, alarms, feeds } = shared;
    control::ControlLoop {
        drive: Drive::new(fleet),
        links,
        clock,
        period,
        simulation,
        inbox,
        questions,
        journal,
        measure: measure::Measure::default(),
        notes,
        metrics,
        ahead: ahead::LastForecasts::default(),
        feeds,
        tap,
        alarms,
        pace: control::LoopPace::default(),
        displaced,
        watchdog: watchdog::Watchdog::default(),
        store,
        moments,
        settling: SettleQueue::new(settle),
        planted,
    }
}

/// The tasks of a core.
struct Tasks {
    writer: JoinHandle<Result<(), StoreError>>,
    thread: oneshot::Receiver<Links>,
    feed: JoinHandle<()>,
    historian: JoinHandle<()>,
    /// The tasks that store alarms and audit entries.
    keepers: [JoinHandle<()>; 2],
    /// Tasks that may be aborted at any point.
    others: Vec<JoinHandle<()>>,
    /// Ends with the thread that keeps recordings.
    past: Option<oneshot::Receiver<()>>,
}

/// Why a core ended.
pub enum CoreEnd {
    /// The core was told to end.
    Told,
    /// A part failed and cannot go on.
    Failed(anyhow::Error),
    /// The server is to switch to another map.
    MapSwitch(Box<MapSwitch>),
}

/// The running core.
pub struct RunningCore {
    store: Arc<Store>,
    tasks: Tasks,
    switch_map: mpsc::Receiver<MapSwitch>,
    /// Ends sockets and streams.
    closing: watch::Sender<bool>,
    halt: watch::Sender<bool>,
    displaced: watch::Receiver<bool>,
}

impl RunningCore {
    /// Wires the parts and starts them. Also returns the routes that lead to them.
    pub async fn begin(
        parts: ServerParts,
        store: Arc<Store>,
        gate: Arc<Gate>,
        outbound: &Outbound,
    ) -> anyhow::Result<(RunningCore, Router)> {
        let ServerParts { fleet, links, clock, period, start, feeds, heard, live, past, charts, .. } = parts;
        let (alarms, planted, metrics) = (parts.alarms, parts.planted, Arc::new(Metrics::default()));
        let (journal, writer) =
            journal::journal(store.clone(), start, clock.clone(), alarms.clone(), metrics.clone());
        let ((queue, requests), (ask, questions)) = (mpsc::channel(inbox::QUEUE), mpsc::channel(QUESTIONS));
        let ((asks, settle), (switch, switch_map)) = (mpsc::channel(1), mpsc::channel(1));
        let ((displaced, gone), (closing, closes)) = (watch::channel(false), watch::channel(false));
        let custody =
            tokio::spawn(custody::watch_over(store.clone(), alarms.clone(), clock.clone(), displaced));
        let (map, view) = (fleet.warehouse().clone(), fleet.view(clock.now()));
        let (moments, picture) = watch::channel(Arc::new(Moment { view, ..Moment::default() }));
        let floor = (map.clone(), picture.clone());
        let (maps, map_keeper) = MapKeeper::new(&store, &parts.basis, floor, (asks, switch));
        let shares = LoopShares { store, clock, metrics, alarms, feeds };
        let (inbox, notes, tap) = (Inbox::of(&map, requests, heard), charts.notes, past.tap);
        let ((halt, halted), displaced) = (watch::channel(false), gone.clone());
        let ends = LoopEnds { inbox, questions, journal, notes, tap, displaced, moments, settle, planted };
        let desk = links.desk();
        let drive = control_loop((fleet, links, period), parts.simulation, ends, shares.clone());
        let LoopShares { store, clock, metrics, alarms, feeds } = shares;
        let feed = tokio::spawn(feed(live.clone(), picture.clone(), alarms.clone(), clock.clone()));
        let alarm_keeper = alarm_keeper::keep_alarms(store.clone(), alarms.clone(), halted.clone());
        let (writer, thread) = (tokio::spawn(writer.run()), spawn_loop(drive, halted)?);
        let (audit, answered) = AuditLog::new(parts.last_audit);
        let audit_keeper = audit_keeper::keep_audit(store.clone(), answered, halt.subscribe());
        let keepers = [tokio::spawn(alarm_keeper), tokio::spawn(audit_keeper)];
        let now: Now = Arc::new(move || clock.now());
        let (tokens, learner) = tokens::TokenKeeper::start((&store, &alarms), &gate, now.clone()).await;
        let (hooks, asked) = webhooks::hook_queue();
        let api = Api {
            map,
            kind_checks: KindChecks::default(),
            moments: picture,
            records: Arc::new(records::StoredRecords(store.clone())),
            figures: charts.figures,
            queue: Some(queue),
            hooks: Some(WebhookAccess { queue: hooks, targets: outbound.targets.clone() }),
            questions: ask,
            link: desk,
            alarms,
            past: past.folder,
            live,
            feeds,
            pseudonyms: Arc::new(people::pseudonyms(&store, &now, parts.names_for).await?),
            interop: Arc::new(parts.interop),
            now,
            metrics,
            trials: trial::trials(),
            maps,
            gate,
            oidc: outbound.oidc.clone(),
            tokens: Some(Arc::new(tokens)),
            answers: Some(Arc::new(answers::AnswerKeeper::new(store.clone()))),
            audit: Arc::new(audit),
            caller: Arc::new(Caller::anonymous()),
            entry: None,
            closing: closes,
        };
        let hooks = webhooks::HookKeeper::new(store.clone(), api.clone(), outbound, asked).run();
        let others = vec![custody, learner, tokio::spawn(hooks), tokio::spawn(map_keeper.run())];
        let (historian, past) = (charts.historian, past.ended);
        let tasks = Tasks { writer, thread, feed, historian, keepers, others, past };
        Ok((RunningCore { store, tasks, switch_map, closing, halt, displaced: gone }, router(api).0))
    }

    /// Runs the core until it is told to stop, until the map is to be changed, or until a part cannot go on.
    pub async fn run(
        &mut self,
        http: &mut JoinHandle<std::io::Result<()>>,
        stopping: &mut watch::Receiver<bool>,
    ) -> CoreEnd {
        let Tasks { writer, thread, feed, .. } = &mut self.tasks;
        tokio::select! {
            _ = stopping.wait_for(|stop| *stop) => CoreEnd::Told,
            Some(order) = self.switch_map.recv() => CoreEnd::MapSwitch(Box::new(order)),
            _ = thread => CoreEnd::Failed(anyhow!("the control loop failed, as logged above; nothing is lost")),
            out = writer => CoreEnd::Failed(written(out)),
            out = http => CoreEnd::Failed(anyhow!("the HTTP server stopped: {out:?}")),
            out = feed => CoreEnd::Failed(anyhow!("the live feed failed: {out:?}")),
        }
    }

    /// Ends sockets and streams: no new requests come from here on.
    pub fn close(&self) {
        self.closing.send_replace(true);
    }

    /// Shuts the core down, with the last step, its facts and the database; returns the floor in its final state. If
    /// the core is not `whole`, since a part of it failed, it waits for nothing.
    pub async fn end(self, whole: bool) -> anyhow::Result<Option<Links>> {
        let Tasks { writer, thread, feed, historian, keepers, others, past } = self.tasks;
        self.halt.send_replace(true);
        let (abort, displaced) = (writer.abort_handle(), *self.displaced.borrow());
        let flushed = match whole {
            true => flush(thread, writer, historian, displaced).await,
            false => Ok(None),
        };
        for keeper in keepers {
            let _ = keeper.await;
        }
        if let Some(past) = past.filter(|_| whole)
            && timeout(LAST_FRAMES, past).await.is_err()
        {
            tracing::warn!("the last frames of the past are still being written");
        }
        // The files are released in any case: tasks that still know the store cannot use it from here on.
        let others = others.iter().chain([&feed]).map(JoinHandle::abort_handle);
        for task in others.chain([abort]) {
            task.abort();
        }
        // What was written into files that have no name any more is gone with the process.
        let in_place = if whole { self.store.check_place() } else { Ok(()) };
        self.store.close().await;
        let links = flushed?;
        in_place.context("what was acknowledged may be lost")?;
        Ok(links)
    }
}

/// Waits until the last step, its facts and the figures over time are stored; returns the links.
async fn flush(
    thread: oneshot::Receiver<Links>,
    writer: JoinHandle<Result<(), StoreError>>,
    historian: JoinHandle<()>,
    displaced: bool,
) -> anyhow::Result<Option<Links>> {
    let links = thread.await.ok();
    // Files of a database that were taken away are unlikely to come back now.
    let patience = if displaced { FLUSH / 10 } else { FLUSH };
    let lost = "the journal did not take the last facts. None of them was acknowledged";
    timeout(patience, writer).await.context(lost)?.context(lost)?.context(lost)?;
    if timeout(patience, historian).await.is_err() {
        tracing::warn!("the last figures over time were not saved");
    }
    Ok(links)
}

/// Runs the loop on a thread of its own: steps are CPU work, and nothing else may wait for them.
fn spawn_loop(
    drive: control::ControlLoop,
    halted: watch::Receiver<bool>,
) -> anyhow::Result<oneshot::Receiver<Links>> {
    let (ended, end) = oneshot::channel();
    let runtime = tokio::runtime::Handle::current();
    let body = move || {
        let links = runtime.block_on(drive.run(halted));
        let _ = ended.send(links);
    };
    std::thread::Builder::new().name("fleet".into()).spawn(body).context("cannot start the control loop")?;
    Ok(end)
}

/// Publishes every new view in the live feed; raises an alarm if none comes.
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
        if age <= clock.passes(STUCK) {
            alarms.clear(AlarmKind::LoopStuck, clock.now());
        } else {
            alarms.raise(AlarmKind::LoopStuck, sentence::loop_stuck(), clock.now());
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
