//! Robot kinds that were added over HTTP: kept in the database, in force from the next start on.
//!
//! Main types: [`KindKeeper`], which answers requests about them; main function: [`join_kinds`]. A kind that the map is
//! not for any more is left out and said so: it must not keep the server from starting. Refuses: to change kinds of the
//! scenario.

use giveway_api::Kinds;
use giveway_api::port::{KindRefusal, KindRequest};
use giveway_fleet::{Fleet, RobotKind};
use giveway_floor::warehouse::{MOST_BODIES, Warehouse};
use giveway_site::{Site, SiteError, read_kind};
use giveway_store::{KindText, Store, StoreError};
use std::path::Path;
use std::sync::Arc;
use tokio::sync::mpsc;

/// How many requests may wait.
const WAITING: usize = 16;

/// The kinds that a database has beside those of the scenario; none where there is no database yet. One that cannot be
/// read is refused when it is opened.
pub async fn kinds_of(database: &Path) -> Vec<KindText> {
    if !std::fs::metadata(database).is_ok_and(|m| m.is_file() && m.len() > 0) {
        return Vec::new();
    }
    let Ok(store) = Store::inspect(database).await else { return Vec::new() };
    let kinds = store.kinds().await.unwrap_or_default();
    store.close().await;
    kinds
}

/// Adds kinds to a site; gives the building for all its kinds.
pub fn join_kinds(site: &mut Site, map: Arc<Warehouse>, kinds: &[KindText]) -> Arc<Warehouse> {
    kinds.iter().fold(map, |map, kind| match joined(site, &map, kind) {
        Ok((more, fitted)) => {
            *site = more;
            fitted
        }
        Err(why) => {
            tracing::warn!("the added kind {:?} is left out: {why:?}", kind.name);
            map
        }
    })
}

/// A site with one kind more, and the building for it.
fn joined(site: &Site, map: &Arc<Warehouse>, kind: &KindText) -> Result<(Site, Arc<Warehouse>), KindRefusal> {
    if site.kinds.iter().any(|k| k.name == kind.name) {
        return Err(KindRefusal::OfScenario);
    }
    let mut more = site.clone();
    more.kinds.push(read_kind(&kind.name, &kind.figures).map_err(|e| of_figures(&e))?);
    let fitted =
        more.fit(map).map_err(|e| KindRefusal::Map(e.0.iter().map(ToString::to_string).collect()))?;
    Ok((more, fitted))
}

fn of_figures(why: &SiteError) -> KindRefusal {
    match why {
        SiteError::Number { key, found, wanted } => {
            let key = key.strip_prefix("kind.").unwrap_or(key).to_owned();
            KindRefusal::Figure(key, format!("is {found}, but must be {wanted}"))
        }
        SiteError::Wrong { key, message } => KindRefusal::Figure((*key).to_owned(), message.clone()),
        SiteError::Syntax { message, .. } => KindRefusal::Figure("kind".to_owned(), message.clone()),
    }
}

/// The kinds of a recording: none can be added.
pub fn of_recording(fleet: &Fleet) -> Kinds {
    let held: Arc<[RobotKind]> = fleet.settings().kinds.clone().into();
    Kinds { of_scenario: held.clone(), held, ..Kinds::default() }
}

/// Answers requests about kinds that are added.
pub struct KindKeeper {
    store: Arc<Store>,
    /// The site as its file has it.
    site: Site,
    map: Arc<Warehouse>,
    requests: mpsc::Receiver<KindRequest>,
    /// Those that will be in force at the next start, since they were last worked out; nothing after a change.
    next: Option<Vec<RobotKind>>,
}

impl KindKeeper {
    /// One for a server whose fleet is this, with the kinds as the API sees them.
    pub fn new(store: Arc<Store>, site: Site, fleet: &Fleet) -> (KindKeeper, Kinds) {
        let (send, requests) = mpsc::channel(WAITING);
        let of_scenario = site.kinds.clone().into();
        let held = fleet.settings().kinds.clone().into();
        let kinds = Kinds { of_scenario, held, requests: Some(send), ..Kinds::default() };
        (KindKeeper { store, site, map: fleet.warehouse().clone(), requests, next: None }, kinds)
    }

    /// Answers until nothing can ask any more. A receiver of an answer that is gone is no error.
    pub async fn run(mut self) {
        while let Some(request) = self.requests.recv().await {
            match request {
                KindRequest::List(reply) => _ = reply.send(self.list().await),
                KindRequest::Put(name, figures, reply) => {
                    _ = reply.send(self.put(KindText { name, figures }).await);
                }
                KindRequest::Remove(name, reply) => _ = reply.send(self.remove(&name).await),
            }
        }
    }

    /// Those that will be in force at the next start.
    async fn list(&mut self) -> Result<Vec<RobotKind>, KindRefusal> {
        if let Some(next) = &self.next {
            return Ok(next.clone());
        }
        let all = self.store.kinds().await.map_err(|e| told(&e))?;
        let (mut site, map) = (self.site.clone(), self.map.clone());
        let of_file = site.kinds.len();
        let joined = aside(move || {
            join_kinds(&mut site, map, &all);
            site
        });
        let kinds = joined.await?.kinds.into_iter().skip(of_file);
        Ok(self.next.insert(kinds.collect()).clone())
    }

    async fn put(&mut self, kind: KindText) -> Result<(bool, RobotKind), KindRefusal> {
        let mut all = self.store.kinds().await.map_err(|e| told(&e))?;
        let known = all.len();
        all.retain(|k| k.name != kind.name);
        let is_new = all.len() == known;
        if is_new && known + self.site.kinds.len() >= MOST_BODIES {
            return Err(KindRefusal::TooMany(MOST_BODIES));
        }
        let (mut site, map, wanted) = (self.site.clone(), self.map.clone(), kind.clone());
        let more = aside(move || {
            let map = join_kinds(&mut site, map, &all);
            joined(&site, &map, &wanted).map(|(more, _)| more)
        });
        let more = more.await??;
        self.next = None;
        self.store.put_kind(&kind).await.map_err(|e| told(&e))?;
        let added = more.kinds.into_iter().next_back().expect("one was added");
        tracing::info!("the kind {:?} is added from the next start on", kind.name);
        Ok((is_new, added))
    }

    async fn remove(&mut self, name: &str) -> Result<(), KindRefusal> {
        if self.site.kinds.iter().any(|k| k.name == name) {
            return Err(KindRefusal::OfScenario);
        }
        self.next = None;
        let was_there = self.store.remove_kind(name).await.map_err(|e| told(&e))?;
        if was_there { Ok(()) } else { Err(KindRefusal::Unknown) }
    }
}

/// Works something out beside the runtime: fitting a map to kinds takes long on a large one.
async fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, KindRefusal> {
    tokio::task::spawn_blocking(work).await.map_err(|e| {
        tracing::error!("kinds of robots: {e}");
        KindRefusal::Database
    })
}

/// Logs the failure, once; the client only learns that it is the database.
fn told(e: &StoreError) -> KindRefusal {
    tracing::error!("kinds of robots: {e}");
    KindRefusal::Database
}
