//! The running server: reads settings, restores the fleet, wires the parts, and shuts them down in order.
//!
//! Main types: [`Server`] (started, with its address), [`Config`]. `running` is the core behind the port, `drive` its
//! loop. The port answers first, and says "starting" until the journal is loaded. Shutting down: new requests are
//! refused, requests in progress are answered, one last step runs, the journal is flushed, sockets and files are
//! closed. Refuses: to start if anything is wrong with map, database, address or tokens.

mod ahead;
mod alarm_keeper;
mod answers;
mod audit_keeper;
mod basis;
mod budget;
mod certificate;
mod clock;
mod config;
mod connections;
mod control;
mod custody;
mod entrance;
mod historian;
mod inbox;
mod journal;
mod links;
mod measure;
mod metered;
mod past;
mod people;
mod publish;
mod queue;
mod recorder;
mod recordings;
mod records;
mod running;
mod settle;
mod start;
mod tls;
mod tokens;
mod watchdog;
mod webhooks;

pub use certificate::Identity;
pub use clock::Clock;
pub use config::{Config, Flags, FloorFile};
pub use links::FloorSource;
pub use links::recording::Show;
pub use recorder::FrameRecorder;

use anyhow::{Context, anyhow, ensure};
use axum::Router;
use basis::FloorBasis;
use entrance::Entrance;
use giveway_api::{Gate, Network, Oidc, Outgoing, Targets};
use giveway_drive::Trap;
use giveway_floor::warehouse::Warehouse;
use giveway_store::{MapNote, PublishedMap, Store};
use publish::MapSwitch;
use running::{CoreEnd, RunningCore};
use start::Built;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{oneshot, watch};
use tokio::task::JoinHandle;
use tokio::time::timeout;

/// How long requests in progress may take when the server shuts down.
const DRAIN: Duration = Duration::from_secs(12);

/// The floor that the server runs.
#[derive(Clone)]
pub struct ServedFloor {
    /// The description of the floor, and of what is simulated there.
    pub source: FloorSource,
    /// The building.
    pub map: Arc<Warehouse>,
    /// Panics that tests plant in the running server, one after the other.
    #[doc(hidden)]
    pub planted: Planted,
}

/// Panics to plant.
pub type Planted = Arc<Mutex<Vec<Trap>>>;

impl ServedFloor {
    /// A floor in a building.
    pub fn new(source: impl Into<FloorSource>, map: Arc<Warehouse>) -> ServedFloor {
        ServedFloor { source: source.into(), map, planted: Planted::default() }
    }

    /// The floor with the database's map, if one was published instead of this one.
    ///
    /// # Errors
    /// If both maps were changed since.
    pub async fn with_map_of(self, database: &Path) -> anyhow::Result<ServedFloor> {
        FloorBasis::choose(self, database).await.map(|(floor, _)| floor)
    }
}

/// A server at work.
pub struct Server {
    address: SocketAddr,
    summary: StartSummary,
    identity: Option<Identity>,
    store: watch::Receiver<Arc<Store>>,
    stop: watch::Sender<bool>,
    work: JoinHandle<anyhow::Result<()>>,
}

/// The state that was found at the start.
#[derive(Clone, Debug, Default)]
pub struct StartSummary {
    /// Name of the map.
    pub map: String,
    /// The publication of the map, if it was published to this server.
    pub published: Option<PublishedMap>,
    /// How many robots the scenario has.
    pub robots: usize,
    /// The broker of the site's robots, if there is one.
    pub broker: Option<String>,
    /// How many robots behind the broker are listed.
    pub listed: usize,
    /// How many facts since the last snapshot were restored.
    pub facts: usize,
    /// How many jobs were accepted so far.
    pub jobs: u64,
    /// How many of these jobs are not over.
    pub open_jobs: u64,
    /// Why simulated customers order nothing, although the scenario has some.
    pub idle: Option<&'static str>,
    /// Why the server does nothing except report this.
    pub trouble: Option<String>,
}

impl StartSummary {
    /// What is known of a floor before its database is read.
    fn of_floor(source: &FloorSource, map: &Warehouse, basis: &FloorBasis) -> StartSummary {
        let mqtt = source.site().links.mqtt.as_ref();
        StartSummary {
            map: map.name.clone(),
            published: basis.published.clone(),
            robots: source.robots(),
            broker: mqtt.map(|m| m.url.clone()),
            listed: mqtt.map_or(0, |m| m.robots.len()),
            idle: source.idle(map),
            ..StartSummary::default()
        }
    }
}

impl Server {
    /// Starts a server.
    ///
    /// # Errors
    /// If anything is wrong; the text says what to do.
    pub async fn start(config: &Config, floor: ServedFloor) -> anyhow::Result<Server> {
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
        let door = (listener, identity.as_ref().map(|i| i.config.clone()));
        let (ready, is_ready) = oneshot::channel();
        let front = Front::open(door, gate, outbound, ready);
        tracing::info!("listening on {address}; the journal is being loaded");
        let entrance = front.entrance.clone();
        let restored = start::restore(config, &floor, |why| entrance.wait_for_room(why)).await;
        // The entrance counts its clones.
        drop(entrance);
        let (store, built, summary) = match restored {
            Ok(restored) => restored,
            Err(e) => return Err(front.shut(e).await),
        };
        let ((stop, stopping), (stores, opened)) = (watch::channel(false), watch::channel(store));
        let config = Config { new: false, ..config.clone() };
        let work = tokio::spawn(ServerRun { config, front, stores, stopping }.run(built));
        // No message is sent: dropping the sender is enough, and that also happens if the work ends at once.
        let _ = is_ready.await;
        Ok(Server { address, summary, identity, store: opened, stop, work })
    }

    /// The address on which the server listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The server's certificate, if it speaks HTTPS.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// The state that was found at the start.
    pub fn summary(&self) -> &StartSummary {
        &self.summary
    }

    /// The database that was opened last.
    pub fn store(&self) -> Arc<Store> {
        self.store.borrow().clone()
    }

    /// Waits until the server ends by itself, which happens only if it cannot go on.
    ///
    /// # Errors
    /// Why the server ended.
    pub async fn ended(&mut self) -> anyhow::Result<()> {
        (&mut self.work).await.context("the server ended unexpectedly")?
    }

    /// Shuts the server down in order.
    ///
    /// # Errors
    /// If facts could not be stored. None of them was acknowledged.
    pub async fn stop(self) -> anyhow::Result<()> {
        self.stop.send_replace(true);
        self.work.await.context("the server ended unexpectedly")?
    }
}

/// The listener, and the TLS configuration if the server speaks HTTPS.
type Door = (TcpListener, Option<Arc<rustls::ServerConfig>>);

/// The network side of the server, which exists from start to end.
struct Front {
    entrance: Entrance,
    http: JoinHandle<std::io::Result<()>>,
    gate: Arc<Gate>,
    outbound: Outbound,
    /// Dropped when the server no longer says "starting".
    ready: Option<oneshot::Sender<()>>,
    closing: watch::Sender<bool>,
}

impl Front {
    fn open(door: Door, gate: Arc<Gate>, outbound: Outbound, ready: oneshot::Sender<()>) -> Front {
        let (entrance, (closing, closes)) = (Entrance::default(), watch::channel(false));
        let http = tokio::spawn(listen(door, entrance.router(), closes));
        Front { entrance, http, gate, outbound, ready: Some(ready), closing }
    }

    /// Closes the port, since the server cannot start.
    async fn shut(self, why: anyhow::Error) -> anyhow::Error {
        self.http.abort();
        let _ = self.http.await;
        why
    }
}

/// Settings for the server's outgoing requests.
struct Outbound {
    outgoing: Outgoing,
    /// Where webhooks may be sent.
    targets: Targets,
    /// How long a webhook may accept nothing before an alarm is raised.
    tolerance: Duration,
    oidc: Option<Arc<Oidc>>,
}

impl Outbound {
    fn of(config: &Config) -> anyhow::Result<Outbound> {
        let outgoing = Outgoing::trusting(config.ca_file.as_deref()).map_err(anyhow::Error::msg)?;
        let oidc = config.oidc.clone().map(|settings| Oidc::new(settings, &outgoing)).transpose();
        let tolerance = Duration::from_secs(config.webhook_alarm_s.into());
        let inside = config.webhook_inside.iter().map(|network| network.parse());
        let inside: Vec<Network> =
            inside.collect::<Result<_, String>>().map_err(|why| anyhow!("webhook_inside: {why}"))?;
        let targets = Targets::allowing(inside);
        Ok(Outbound { targets, tolerance, oidc: oidc.map_err(anyhow::Error::msg)?.map(Arc::new), outgoing })
    }
}

/// The server's certificate, if it speaks HTTPS.
fn identity(config: &Config, address: SocketAddr) -> anyhow::Result<Option<Identity>> {
    let Some(place) = config.tls(address)? else { return Ok(None) };
    let now = jiff::Timestamp::from_microsecond(Clock::start(None).started().0)?;
    Ok(Some(Identity::open(&place, now.to_zoned(jiff::tz::TimeZone::UTC).date())?))
}

/// A server at work: one core after another, behind one port.
struct ServerRun {
    config: Config,
    front: Front,
    /// Receives each store that is opened.
    stores: watch::Sender<Arc<Store>>,
    stopping: watch::Receiver<bool>,
}

/// Answers the request to change the map once the server works again.
type LateAnswer = Box<dyn FnOnce() + Send>;

impl ServerRun {
    async fn run(mut self, mut built: Built) -> anyhow::Result<()> {
        let mut answer: Option<LateAnswer> = None;
        loop {
            let parts = match built {
                Built::Whole(parts) => *parts,
                Built::Broken(why) => return self.explain(why).await,
            };
            let (map, basis) = (parts.fleet.warehouse().clone(), parts.basis.clone());
            let (mut core, inside) =
                RunningCore::begin(parts, self.store(), self.front.gate.clone(), &self.front.outbound)
                    .await?;
            self.front.entrance.open(inside);
            drop(self.front.ready.take());
            answer.take().into_iter().for_each(|answer| answer());
            let ended = match core.run(&mut self.front.http, &mut self.stopping).await {
                CoreEnd::MapSwitch(order) => {
                    // The request itself counts as in progress until it is answered.
                    core.close();
                    self.front.entrance.empty(1).await;
                    let links = core.end(true).await?;
                    (built, answer) = self.switch_map(*order, (map, basis)).await?;
                    if let (Built::Whole(parts), Some(before)) = (&mut built, &links) {
                        parts.links.keep_robots_of(before);
                    }
                    continue;
                }
                CoreEnd::Told => Ok(()),
                CoreEnd::Failed(why) => Err(why),
            };
            core.close();
            drain(self.front.http, &self.front.closing).await;
            let flushed = core.end(ended.is_ok()).await;
            return ended.and(flushed.map(drop));
        }
    }

    fn store(&self) -> Arc<Store> {
        self.stores.borrow().clone()
    }

    /// Opens the database with another map or, if that is refused at the last moment, with the previous one.
    async fn switch_map(
        &self,
        order: MapSwitch,
        (old, basis): (Arc<Warehouse>, FloorBasis),
    ) -> anyhow::Result<(Built, Option<LateAnswer>)> {
        let MapSwitch { map, accept_losses, note, request, reply } = order;
        let noted = MapNote::Publish(note.clone(), request.clone());
        let (store, floor, basis, answer) = match self.open(&basis, &map, (accept_losses, noted)).await {
            Ok((store, floor)) => {
                tracing::info!("the map {:?} is in operation: it was published by {}", map.name, note.by);
                let report = store.carried().map(|carried| carried.report.clone()).unwrap_or_default();
                let done = MapSwitch::done(Some(&note), &floor.map, report);
                (store, floor, FloorBasis { published: Some(note), ..basis }, Ok(done))
            }
            Err(why) => {
                if basis::has_gone_over(&self.config.database, &note).await {
                    return Err(
                        why.context("the database has gone over to the published map, but cannot be used")
                    );
                }
                tracing::warn!("the map {:?} is not published: {why:#}", map.name);
                let (store, floor) = self.open(&basis, &old, (false, MapNote::Keep)).await?;
                if let Err(e) = store.keep_audit(&[MapSwitch::refused_request(request)]).await {
                    tracing::warn!("an entry of the audit was not written down: {e}");
                }
                (store, floor, basis, Err(MapSwitch::refused(&why)))
            }
        };
        self.stores.send_replace(store.clone());
        let (built, _) = start::build(&self.config, floor, basis, &store).await?;
        Ok((built, Some(Box::new(move || _ = reply.send(answer)))))
    }

    /// Opens the database with a map.
    async fn open(
        &self,
        basis: &FloorBasis,
        map: &Arc<Warehouse>,
        note: (bool, MapNote),
    ) -> anyhow::Result<(Arc<Store>, ServedFloor)> {
        let unfit = |why: Vec<String>| anyhow::anyhow!("the map is not for this fleet: {}", why.join("; "));
        let floor = basis.with(basis.fit(map).map_err(unfit)?);
        Ok((start::open(&self.config, &floor, note).await?, floor))
    }

    /// Answers why the server does not work until it is told to stop: a process that ended would be restarted again and
    /// again, and could tell no one.
    async fn explain(mut self, why: String) -> anyhow::Result<()> {
        tracing::error!("{why}");
        self.front.entrance.shut(why);
        drop(self.front.ready.take());
        let _ = self.stopping.wait_for(|stop| *stop).await;
        drain(self.front.http, &self.front.closing).await;
        let store = self.stores.borrow().clone();
        store.close().await;
        Ok(())
    }
}

/// Accepts no more requests, and waits a while for requests in progress.
async fn drain(mut http: JoinHandle<std::io::Result<()>>, closing: &watch::Sender<bool>) {
    closing.send_replace(true);
    if !http.is_finished() && timeout(DRAIN, &mut http).await.is_err() {
        tracing::warn!("some requests did not end in time");
        http.abort();
    }
}

async fn listen(door: Door, router: Router, closes: watch::Receiver<bool>) -> std::io::Result<()> {
    let (listener, tls) = door;
    connections::serve(listener, tls, router, closes).await;
    Ok(())
}
