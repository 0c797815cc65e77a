//! From files to parts: opens the database, folds the journal, builds the parts of the server.
//!
//! Main types: [`ServerParts`], [`Built`]. The fold runs on a thread of its own, so that the port answers meanwhile.
//! Refuses: to end the process if the journal contradicts itself; then the server stays up and says so.

use super::basis::{FloorBasis, not_for};
use super::clock::{self, Clock};
use super::links::{FloorSource, Links, MqttRobots, connect};
use super::recordings::KeptPast;
use super::{Config, Planted, ServedFloor, StartSummary, historian, journal};
use anyhow::Context;
use giveway_api::{Alarms, Feeds, FloorSimulation, HeardSighting, Interop, Live, Role, SharedHistory};
use giveway_fleet::history::History;
use giveway_fleet::{Fleet, Ledger, Settings};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_site::{ListedRobot, MqttLink};
use giveway_store::{CarryOver, LinkedRow, Loaded, MapNote, Opening, StepEntry, Store, StoreError};
use giveway_vda5050::{Address, Version};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;

/// How often the server checks whether there is room on the disk.
const LOOK: Duration = Duration::from_secs(2);

/// The parts of the server.
pub struct ServerParts {
    pub fleet: Fleet,
    pub links: Links,
    pub clock: Arc<Clock>,
    pub period: Span,
    pub simulation: Option<FloorSimulation>,
    pub start: journal::Start,
    pub interop: Interop,
    pub names_for: Vec<Role>,
    pub feeds: Arc<Feeds>,
    pub heard: mpsc::Receiver<HeardSighting>,
    pub live: Arc<Live>,
    pub alarms: Arc<Alarms>,
    pub past: KeptPast,
    pub charts: Charts,
    /// Panics that tests plant.
    pub planted: Planted,
    /// What stays the same from one map to the next.
    pub basis: FloorBasis,
    /// The number of the last stored audit entry.
    pub last_audit: i64,
}

/// Figures over time, and what keeps them.
pub struct Charts {
    pub figures: Arc<SharedHistory>,
    pub notes: historian::HistorianSender,
    pub historian: JoinHandle<()>,
}

impl Charts {
    /// Starts to keep the figures.
    fn keep(figures: Arc<SharedHistory>, store: &Arc<Store>) -> Charts {
        let (notes, historian) = historian::historian(figures.clone(), store.clone());
        Charts { figures, notes, historian: tokio::spawn(historian.run()) }
    }
}

/// The result of reading the files.
pub enum Built {
    /// All parts were built.
    Whole(Box<ServerParts>),
    /// There is no fleet: the journal contradicts itself, as the text says.
    Broken(String),
}

/// Opens the database, carried over to this floor with losses only if `accept_losses`; records `note` about its map.
pub async fn open(
    config: &Config,
    floor: &ServedFloor,
    (accept_losses, note): (bool, MapNote),
) -> anyhow::Result<Arc<Store>> {
    let stamp = || {
        let now = jiff::Timestamp::from_microsecond(Clock::start(None).started().0)?;
        anyhow::Ok(now.strftime("%Y-%m-%dT%H%M%SZ").to_string())
    };
    let new = config.new.then(stamp).transpose()?;
    let kinds = floor.source.site().kinds.clone();
    let carry = Some(CarryOver { kinds, accept_losses, stamp: stamp()? });
    let opening = Opening { new, traces: vec![config.past_folder()], carry, note };
    let store = Store::open_as(&config.database, &floor.map, &opening).await?;
    Ok(Arc::new(store.keep_days(config.keep_days).keep_people_days(config.people_keep_days)))
}

/// What to tell operators of a fold of the journal that panicked.
fn contradiction(e: tokio::task::JoinError, store: &Store) -> anyhow::Result<String> {
    let said = e.try_into_panic().map(|p| giveway_drive::panic_text(&*p)).context("the fold was given up")?;
    Ok(format!(
        "the journal of {} contradicts itself: {said}. Nothing was changed. Robots drive to the end of their grants \
         and stop. Keep a copy of the file, then run `giveway database restore BACKUP`",
        store.path().display()
    ))
}

/// Builds everything from the files: the map in operation, the database, the parts. If there is no room on the disk, it
/// reports that through `waits` and tries again until there is: nothing can be promised meanwhile, and a process that
/// ended would only be restarted.
pub async fn restore(
    config: &Config,
    floor: &ServedFloor,
    waits: impl Fn(String),
) -> anyhow::Result<(Arc<Store>, Built, StartSummary)> {
    let mut has_waited = false;
    loop {
        match try_restore(config, floor.clone()).await {
            Err(e) if e.downcast_ref::<StoreError>().is_some_and(StoreError::is_no_room) => {
                let why = format!(
                    "{e:#}. Nothing is accepted until there is room: robots drive to the end of their grants and \
                     stand. Make room; the server looks every {} s and goes on by itself",
                    LOOK.as_secs()
                );
                if !std::mem::replace(&mut has_waited, true) {
                    tracing::error!("{why}");
                }
                waits(why);
                tokio::time::sleep(LOOK).await;
            }
            Ok(restored) => {
                if has_waited {
                    tracing::info!("there is room again: the server starts");
                }
                return Ok(restored);
            }
            Err(e) => return Err(e),
        }
    }
}

async fn try_restore(
    config: &Config,
    floor: ServedFloor,
) -> anyhow::Result<(Arc<Store>, Built, StartSummary)> {
    let (floor, basis) = match config.new {
        true => {
            let basis = FloorBasis::of(&floor);
            (floor, basis)
        }
        false => FloorBasis::choose(floor, &config.database).await?,
    };
    let store = open(config, &floor, (false, MapNote::Keep)).await?;
    match build(config, floor, basis, &store).await {
        Ok((built, summary)) => Ok((store, built, summary)),
        Err(e) => {
            store.close().await;
            Err(e)
        }
    }
}

/// Refuses robots of an unknown kind, and a map that does not suit an added kind: its lanes may have been changed for
/// other kinds while the ids in the journal were not.
fn check_kinds(fleet: &Fleet) -> anyhow::Result<()> {
    let ledger = fleet.ledger();
    if let Some((robot, kind)) = ledger.unknown_kinds().first() {
        let kinds: Vec<&str> = ledger.kinds().iter().map(|k| k.name.as_str()).collect();
        anyhow::bail!(
            "{robot} is of kind {kind:?} in this database ({} robots are of missing kinds), but the scenario has {}. \
             Add that kind to the scenario, or use another database",
            ledger.unknown_kinds().len(),
            kinds.join(", ")
        )
    }
    let lost = not_for(ledger.warehouse(), ledger.kinds().added());
    anyhow::ensure!(
        lost.is_empty(),
        "{}. Change the map, or start with the map of before and remove the kind: DELETE /v1/kinds/NAME",
        lost.join("; ")
    );
    Ok(())
}

/// The most steps that are stored at once.
const AT_ONCE: usize = 500;

/// Stores the floor's history before this moment, for a scenario that begins in the middle of a shift.
async fn begin_in_the_middle(
    store: &Store,
    map: &Arc<Warehouse>,
    source: &FloorSource,
    next: i64,
) -> anyhow::Result<()> {
    let now = || Clock::start(None).started();
    let (map, source) = (map.clone(), source.clone());
    let past = tokio::task::spawn_blocking(move || source.past(&map, now)).await?;
    let entry = |(at, facts)| StepEntry { at, facts, causes: Vec::new() };
    let steps: Vec<StepEntry> = past.steps.into_iter().map(entry).collect();
    let mut next = next;
    for some in steps.chunks(AT_ONCE) {
        store.append(next, some).await?;
        next += some.len() as i64;
    }
    let (buckets, heat) = (past.history.since(Time(0)), past.history.heat().since(Time(0)));
    store.keep_history(now(), &buckets, &heat).await?;
    Ok(())
}

/// The content of the database; if it is empty and the scenario wants that, with a simulated history before this
/// moment.
async fn load(store: &Store, floor: &ServedFloor) -> anyhow::Result<Loaded> {
    let empty = || Ledger::new(floor.map.clone(), &floor.source.site().kinds, false);
    let loaded = store.load(empty()).await?;
    if loaded.last.is_some() || !floor.source.begins_in_the_middle() {
        return Ok(loaded);
    }
    begin_in_the_middle(store, &floor.map, &floor.source, loaded.next).await?;
    Ok(store.load(empty()).await?)
}

/// A link with the robots that were listed over the API. Those of the site file go first.
async fn with_kept(mut link: MqttLink, store: &Store) -> anyhow::Result<MqttLink> {
    for LinkedRow { name, manufacturer, serial, kind, version } in store.linked_robots().await? {
        let address = Address::new(&manufacturer, &serial);
        let address = address.with_context(|| format!("the database lists robot {name}"))?;
        if link.robots.iter().any(|robot| robot.name == name || robot.address == address) {
            tracing::warn!(robot = name, "the site's file lists this robot, too; that counts");
            continue;
        }
        let version = version.as_deref().and_then(Version::of_text);
        link.robots.push(ListedRobot { name, address, kind, version });
    }
    Ok(link)
}

/// Builds the parts from the content of the database.
pub async fn build(
    config: &Config,
    floor: ServedFloor,
    basis: FloorBasis,
    store: &Arc<Store>,
) -> anyhow::Result<(Built, StartSummary)> {
    let loaded = load(store, &floor).await?;
    let ServedFloor { source, map, planted } = floor;
    let (next, facts) = (loaded.next, loaded.facts());
    let summary = StartSummary { facts, ..StartSummary::of_floor(&source, &map, &basis) };
    let clock = Arc::new(Clock::start(loaded.last).at_speed(source.speed));
    let settings = Settings { stopwatch: clock::stopwatch, ..source.site().settings() };
    let (buckets, heat) = store.load_history().await?;
    let figures =
        SharedHistory::new(clock.started(), settings.policy.word(), History::restore(buckets, heat));
    let (now, floor, period) = (clock.now(), map.clone(), source.site().period);
    let simulation = source.simulation();
    let broker = match source.site().links.mqtt.clone() {
        Some(link) => Some(connect(with_kept(link, store).await?, &source.site().name)?),
        None => None,
    };
    let fold = move || {
        let (ledger, facts) = loaded.into_parts();
        let fleet = Fleet::resume(ledger, settings, facts);
        check_kinds(&fleet)?;
        let robots = broker.map(|begun| MqttRobots::new(begun, fleet.warehouse().clone(), now));
        let links = Links::new(source.begin(floor, fleet.ledger(), now), robots);
        anyhow::Ok((fleet, links))
    };
    let (fleet, links) = match tokio::task::spawn_blocking(fold).await {
        Ok(folded) => folded?,
        Err(e) => {
            let why = contradiction(e, store)?;
            return Ok((Built::Broken(why.clone()), StartSummary { trouble: Some(why), ..summary }));
        }
    };
    let ledger = fleet.ledger();
    let summary = StartSummary { jobs: ledger.next_job - 1, open_jobs: ledger.jobs.len() as u64, ..summary };
    let start = journal::Start { next, ledger: ledger.clone(), behind: facts };
    let (feeds, heard) = Feeds::new();
    feeds.know(&fleet.ledger().workers);
    let live = Arc::new(Live::new(map, clock.started().0.unsigned_abs()));
    let alarms = Arc::new(Alarms::default());
    let (last, active) = store.active_alarms(clock.now()).await?;
    alarms.restore(last, active, clock.now());
    let past = KeptPast::keep(config.past(), fleet.warehouse(), &live, &clock, &alarms);
    let parts = ServerParts {
        fleet,
        links,
        clock,
        period,
        simulation,
        start,
        interop: config.massrobotics.clone(),
        names_for: config.people_names_for.clone(),
        feeds: Arc::new(feeds),
        heard,
        live,
        alarms,
        past,
        charts: Charts::keep(Arc::new(figures), store),
        planted,
        basis,
        last_audit: store.last_audit().await?,
    };
    Ok((Built::Whole(Box::new(parts)), summary))
}
