//! Maps that are to become the server's own: what would change, what cannot be carried over, and the order to switch.
//!
//! Main types: [`MapRequest`], [`MapOutlook`], [`MapRefusal`], [`MapOrigin`]. The program that runs the API decides and
//! carries out. Refuses: to know how.

use crate::access::audit::AuditEntry;
use crate::wire::error::Problem;
use giveway_fleet::carry::Report;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Time;
use giveway_floor::warehouse::{Difference, Draft, Review};
use std::sync::Arc;
use tokio::sync::{mpsc, oneshot};

/// Where the map in operation comes from, if it was published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapOrigin {
    /// Which published map it is, counted from 1.
    pub number: u32,
    /// When it was published.
    pub at: Time,
    /// Who did.
    pub by: String,
}

/// What a change to another map would mean now.
#[derive(Clone, Debug)]
pub struct MapOutlook {
    /// What there is to say about the map itself.
    pub review: Review,
    /// What is different from the map in operation; nothing where the map has errors.
    pub differences: Vec<Difference>,
    /// What the floor and the database cannot carry over.
    pub report: Report,
}

impl MapOutlook {
    /// Whether the server does not switch to it.
    pub fn is_refused(&self, accept_losses: bool) -> bool {
        let Report { obstacles, losses, .. } = &self.report;
        !self.review.is_good() || !obstacles.is_empty() || (!losses.is_empty() && !accept_losses)
    }
}

impl From<MapOutlook> for MapRefusal {
    fn from(outlook: MapOutlook) -> MapRefusal {
        MapRefusal::Outlook(Box::new(outlook))
    }
}

/// A map to switch to.
#[derive(Clone, Debug)]
pub struct MapOrder {
    /// The map.
    pub map: Draft,
    /// Whether losses are accepted.
    pub accept_losses: bool,
    /// Who asks, and as what it is written down.
    pub by: Arc<AuditEntry>,
}

/// A map that the server has gone over to.
#[derive(Clone, Debug)]
pub struct MapDone {
    /// Its version.
    pub version: String,
    /// Where it comes from; nothing where the map in operation was the same one and nothing was done.
    pub origin: Option<MapOrigin>,
    /// What became of what was on the floor.
    pub report: Report,
}

/// Why the server does not switch to a map.
#[derive(Clone, Debug)]
pub enum MapRefusal {
    /// The map has errors, or not everything can be carried over.
    Outlook(Box<MapOutlook>),
    /// Something failed; in words, with what to do. The map in operation stays.
    Failed(String),
}

/// What is asked of the program about maps.
#[derive(Debug)]
pub enum MapRequest {
    /// What a change to this map would mean.
    Check(Box<Draft>, oneshot::Sender<Result<MapOutlook, MapRefusal>>),
    /// The change itself.
    Publish(Box<MapOrder>, oneshot::Sender<Result<MapDone, MapRefusal>>),
}

/// Takes requests about maps.
#[derive(Clone, Debug, Default)]
pub struct MapPort {
    /// Where the map in operation comes from, if it was published.
    pub origin: Option<MapOrigin>,
    /// Where requests go; absent where a recording is shown.
    pub requests: Option<mpsc::Sender<MapRequest>>,
}

impl MapPort {
    /// Asks, and waits for the answer, however long robots take to stand.
    pub(crate) async fn ask<T>(
        &self,
        request: impl FnOnce(oneshot::Sender<Result<T, MapRefusal>>) -> MapRequest,
    ) -> Result<Result<T, MapRefusal>, Problem> {
        let requests = self.requests.as_ref().ok_or_else(Problem::of_recording)?;
        let (reply, answer) = oneshot::channel();
        let busy = || Problem::unavailable(requests::map_busy(), 3);
        requests.try_send(request(reply)).map_err(|_| busy())?;
        answer.await.map_err(|_| Problem::unavailable(requests::map_changes(), 3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_map_beyond_those_that_may_wait_is_refused_until_one_is_answered() {
        let (send, mut waiting) = mpsc::channel(1);
        let port = MapPort { origin: None, requests: Some(send) };
        let check = |reply| MapRequest::Check(Box::default(), reply);
        let first = tokio::spawn({
            let port = port.clone();
            async move { port.ask(check).await }
        });
        while waiting.is_empty() {
            tokio::task::yield_now().await;
        }
        let busy = port.ask(check).await.unwrap_err();
        assert_eq!((busy.status, busy.retry_after), (503, Some(3)));
        let Some(MapRequest::Check(_, reply)) = waiting.recv().await else { panic!("it waits") };
        drop(reply);
        assert_eq!(first.await.unwrap().unwrap_err().status, 503, "the answer never comes");
    }
}
