//! Publishes maps to the running server: checks them, and passes them on when all robots stand.
//!
//! Main types: [`MapKeeper`] (answers requests), [`MapSwitch`] (the order to the server). Whether the database can be
//! carried over decides: the same as at a start with a changed map. Refuses: to begin while there are obstacles, and to
//! change anything itself.

use super::audit_keeper::row_of;
use super::basis::FloorBasis;
use super::settle::SettleRequest;
use giveway_api::{
    AuditEntry, MapDone, MapOrder, MapOrigin, MapOutlook, MapPort, MapRefusal, MapRequest, Moment,
    map_version,
};
use giveway_fleet::carry::{Report, ReportEntry};
use giveway_fleet::{RobotKind, Unsettled};
use giveway_floor::time::Time;
use giveway_floor::warehouse::{Draft, Finding, Remark, Review, Severity, Warehouse, differences, review};
use giveway_store::{AuditRow, PublishedMap, Store, StoreError, map_digest};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot, watch};
use tokio::time::timeout;

/// The remedy for a robot beside its node.
const GET_THERE: &str =
    "let it drive on, or push it onto a free node, where it rejoins the fleet; then try again";

/// The most requests that wait.
const WAITING: usize = 2;

/// How long the loop may take to answer; it gives robots less time.
const PATIENCE: Duration = Duration::from_secs(40);

/// The status of an answer that reports obstacles.
const REFUSED: u16 = 409;

/// The order to switch to another map: all checks passed, and all robots stand.
pub struct MapSwitch {
    /// The map, not yet fitted to kinds of robots.
    pub map: Arc<Warehouse>,
    /// Whether losses are accepted.
    pub accept_losses: bool,
    /// The publication to record.
    pub note: PublishedMap,
    /// The request's audit entry, to be stored after the switch.
    pub request: AuditRow,
    /// Receives the answer.
    pub reply: oneshot::Sender<Result<MapDone, MapRefusal>>,
}

/// A map that was checked.
struct Looked {
    outlook: MapOutlook,
    /// The building, and the building fitted to all kinds of the site; nothing if it has errors.
    map: Option<(Arc<Warehouse>, Arc<Warehouse>)>,
}

/// Answers requests about maps.
pub struct MapKeeper {
    store: Arc<Store>,
    basis: FloorBasis,
    /// The map in operation.
    map: Arc<Warehouse>,
    /// The fleet's latest view: it knows which robot kinds were added.
    moments: watch::Receiver<Arc<Moment>>,
    requests: mpsc::Receiver<MapRequest>,
    settle: mpsc::Sender<SettleRequest>,
    switch_map: mpsc::Sender<MapSwitch>,
}

/// Robots that do not stand, as obstacles.
fn obstacles(map: &Warehouse, standing: &[Unsettled]) -> Vec<ReportEntry> {
    let entry = |u: &Unsettled| {
        let near = map.nodes.iter().min_by(|a, b| (a.at - u.at).norm().total_cmp(&(b.at - u.at).norm()));
        let near = near.map_or("", |node| node.name.as_str());
        let what = format!("{} does not stand on a node, but near {near}", u.name);
        ReportEntry { what, remedy: GET_THERE.into(), at: Some(u.at.into()) }
    };
    standing.iter().map(entry).collect()
}

impl MapKeeper {
    /// A keeper for a server with this map in operation, and the port for handlers.
    pub fn new(
        store: &Arc<Store>,
        basis: &FloorBasis,
        (map, moments): (Arc<Warehouse>, watch::Receiver<Arc<Moment>>),
        (settle, switch_map): (mpsc::Sender<SettleRequest>, mpsc::Sender<MapSwitch>),
    ) -> (MapPort, MapKeeper) {
        let (ask, requests) = mpsc::channel(WAITING);
        let origin = basis.published.as_ref().map(origin_of);
        let port = MapPort { origin, requests: Some(ask) };
        let (store, basis) = (store.clone(), basis.clone());
        (port, MapKeeper { store, basis, map, moments, requests, settle, switch_map })
    }

    /// Answers until there are no more requests, or the server switches to another map.
    pub async fn run(mut self) {
        while let Some(request) = self.requests.recv().await {
            match request {
                MapRequest::Check(draft, reply) => _ = reply.send(self.check(*draft).await),
                MapRequest::Publish(order, reply) => {
                    let MapOrder { map, accept_losses, by } = *order;
                    let map = match self.prepare(map, accept_losses).await {
                        Ok(Some(map)) => map,
                        Ok(None) => {
                            _ = reply.send(Ok(MapSwitch::done(None, &self.map, Report::default())));
                            continue;
                        }
                        Err(why) => {
                            _ = reply.send(Err(why));
                            continue;
                        }
                    };
                    let note = self.note(&by);
                    let request = AuditRow { outcome: Some(200), ..row_of(&by) };
                    let order = MapSwitch { map, accept_losses, note, request, reply };
                    // The server now shuts this core down, or already has.
                    let _ = self.switch_map.send(order).await;
                    return std::future::pending().await;
                }
            }
        }
    }

    /// The publication of a map by this request.
    fn note(&self, by: &AuditEntry) -> PublishedMap {
        let number = self.basis.published.as_ref().map_or(1, |published| published.number + 1);
        PublishedMap { number, at: Time(by.id), by: by.actor.clone(), file: self.basis.file.clone() }
    }

    async fn check(&self, draft: Draft) -> Result<MapOutlook, MapRefusal> {
        let mut looked = self.look(draft).await?;
        let (reply, answer) = oneshot::channel();
        if self.settle.send(SettleRequest::Look(reply)).await.is_ok()
            && let Ok(Ok(standing)) = timeout(PATIENCE, answer).await
        {
            looked.outlook.report.obstacles.extend(obstacles(&self.map, &standing));
        }
        Ok(looked.outlook)
    }

    /// All preparations before the server switches: checks the map, makes robots stop, and compares again. Nothing if
    /// the map in operation is the same one.
    async fn prepare(&self, draft: Draft, accept_losses: bool) -> Result<Option<Arc<Warehouse>>, MapRefusal> {
        let mut looked = self.look(draft).await?;
        let Some((map, fitted)) = looked.map.take_if(|_| !looked.outlook.is_refused(accept_losses)) else {
            return Err(looked.outlook.into());
        };
        if map_digest(&map) == map_digest(&self.map) {
            return Ok(None);
        }
        tracing::info!("a map is being published: robots drive to the end of their grants and stand");
        let report = match self.have_robots_stand().await {
            Ok(()) => self.compare(&fitted).await,
            Err(Ok(obstacles)) => Ok(Report { obstacles, ..Report::default() }),
            Err(Err(why)) => Err(MapRefusal::Failed(why.into())),
        };
        looked.outlook.report = match report {
            Ok(report) => report,
            Err(why) => return Err(self.go_on(why).await),
        };
        if looked.outlook.is_refused(accept_losses) {
            return Err(self.go_on(looked.outlook.into()).await);
        }
        Ok(Some(map))
    }

    /// Lets robots go on, since the map in operation stays.
    async fn go_on(&self, why: MapRefusal) -> MapRefusal {
        let _ = self.settle.send(SettleRequest::GoOn).await;
        why
    }

    /// What switching to this map would mean at present.
    async fn look(&self, draft: Draft) -> Result<Looked, MapRefusal> {
        let added = self.moments.borrow().view.all_kinds.added().to_vec();
        let (basis, old) = (self.basis.clone(), self.map.clone());
        let look = tokio::task::spawn_blocking(move || look_at(&draft, &basis, &old, &added)).await;
        let mut looked = look.map_err(|_| MapRefusal::Failed("the map could not be looked at".into()))?;
        if let Some((_, fitted)) = &looked.map {
            looked.outlook.report = self.compare(fitted).await?;
        }
        Ok(looked)
    }

    /// What the floor and the database cannot carry over to a map, compared when everything is durable.
    async fn compare(&self, fitted: &Arc<Warehouse>) -> Result<Report, MapRefusal> {
        let kinds = &self.basis.source.site().kinds;
        let report = self.store.compare(fitted, kinds).await.map_err(|e| told(&e))?;
        Ok(report.unwrap_or_default())
    }

    /// Makes robots stop. An error names the robots that do not stand, or another obstacle.
    async fn have_robots_stand(&self) -> Result<(), Result<Vec<ReportEntry>, &'static str>> {
        let (reply, answer) = oneshot::channel();
        let stuck = "the control loop does not answer: look at the alarms. The map in operation stays.";
        self.settle.send(SettleRequest::Stand(reply)).await.map_err(|_| Err(stuck))?;
        match timeout(PATIENCE, answer).await {
            Ok(Ok(Ok(()))) => Ok(()),
            Ok(Ok(Err(moving))) if moving.is_empty() => {
                Err(Err("the database takes no facts: look at the alarms. The map in operation stays."))
            }
            Ok(Ok(Err(moving))) => Err(Ok(obstacles(&self.map, &moving))),
            _ => Err(Err(stuck)),
        }
    }
}

/// The findings about a map without the floor, and the building.
fn look_at(draft: &Draft, basis: &FloorBasis, old: &Arc<Warehouse>, added: &[RobotKind]) -> Looked {
    let mut review = review(draft);
    let good = review.warehouse.take().filter(|_| review.is_good()).map(Arc::new);
    let fitted = good.and_then(|map| match basis.fit_all(&map, added) {
        Ok(fitted) => Some((map, fitted)),
        Err(why) => {
            why.into_iter().for_each(|why| not_for_fleet(&mut review, why));
            None
        }
    });
    let differences = fitted.as_ref().map_or_else(Vec::new, |(map, _)| differences(old, map));
    Looked { outlook: MapOutlook { review, differences, report: Report::default() }, map: fitted }
}

/// An error that is one only for this fleet.
fn not_for_fleet(review: &mut Review, why: String) {
    let finding = Finding {
        place: "the fleet of this server".into(),
        nodes: Vec::new(),
        corners: Vec::new(),
        problem: why,
        remedy: "change the map, or start the server with another scenario".into(),
    };
    review.remarks.insert(0, Remark { severity: Severity::Error, finding, at: Vec::new() });
}

fn origin_of(published: &PublishedMap) -> MapOrigin {
    MapOrigin { number: published.number, at: published.at, by: published.by.clone() }
}

/// Logs the failure, once.
fn told(e: &StoreError) -> MapRefusal {
    tracing::error!("maps: {e}");
    MapRefusal::Failed("the database does not answer; the server's log says why. Nothing was changed.".into())
}

impl MapSwitch {
    /// The answer after the switch.
    pub fn done(note: Option<&PublishedMap>, map: &Warehouse, report: Report) -> MapDone {
        MapDone { version: map_version(map), origin: note.map(origin_of), report }
    }

    /// The answer if the database could not be carried over after all: the floor changed at the last moment.
    pub fn refused(why: &anyhow::Error) -> MapRefusal {
        match why.downcast_ref::<StoreError>() {
            Some(StoreError::ChangedMap { report, .. }) => {
                let review = Review {
                    remarks: Vec::new(),
                    shut_in: Vec::new(),
                    dead_ends: Vec::new(),
                    warehouse: None,
                };
                let report = (**report).clone();
                MapRefusal::Outlook(Box::new(MapOutlook { review, differences: Vec::new(), report }))
            }
            _ => MapRefusal::Failed(format!("{why:#}. The map in operation stays.")),
        }
    }

    /// The request's audit entry after a refusal.
    pub fn refused_request(request: AuditRow) -> AuditRow {
        AuditRow { outcome: Some(REFUSED), ..request }
    }
}
