//! Publishing maps: what would change, what cannot be carried over, and the order to switch.
//!
//! Main types: [`MapRequest`], [`MapOutlook`], [`MapRefusal`], [`MapOrigin`]. The program that runs the API decides and
//! switches. Refuses: to know how.

use crate::access::audit::AuditEntry;
use crate::wire::error::Problem;
use giveway_fleet::carry::Report;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Time;
use giveway_floor::warehouse::{Difference, Draft, Review};
use std::sync::Arc;
use tokio::sync::{mpsc, oneshot};

/// The publication from which the map in operation comes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapOrigin {
    /// The number of the published map, counted from 1.
    pub number: u32,
    /// When it was published.
    pub at: Time,
    /// The publisher.
    pub by: String,
}

/// What switching to another map would mean at present.
#[derive(Clone, Debug)]
pub struct MapOutlook {
    /// The findings about the map itself.
    pub review: Review,
    /// The differences from the map in operation; empty if the map has errors.
    pub differences: Vec<Difference>,
    /// What the floor and the database cannot carry over.
    pub report: Report,
}

impl MapOutlook {
    /// Whether the server would refuse to switch to the map.
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
    /// The audit entry of the request, with the caller.
    pub by: Arc<AuditEntry>,
}

/// The map to which the server has switched.
#[derive(Clone, Debug)]
pub struct MapDone {
    /// The map's version.
    pub version: String,
    /// The publication of this map; nothing if it equals the map that was in operation and nothing was done.
    pub origin: Option<MapOrigin>,
    /// What became of everything on the floor.
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

/// A request about maps to the program that runs the API.
#[derive(Debug)]
pub enum MapRequest {
    /// Check what switching to this map would mean.
    Check(Box<Draft>, oneshot::Sender<Result<MapOutlook, MapRefusal>>),
    /// Switch to this map.
    Publish(Box<MapOrder>, oneshot::Sender<Result<MapDone, MapRefusal>>),
}

/// The port for requests about maps.
#[derive(Clone, Debug, Default)]
pub struct MapPort {
    /// The publication of the map in operation, if it was published.
    pub origin: Option<MapOrigin>,
    /// The queue of requests; absent if a recording is shown.
    pub requests: Option<mpsc::Sender<MapRequest>>,
}

impl MapPort {
    /// Sends a request and waits for the answer, however long robots take to stop.
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
