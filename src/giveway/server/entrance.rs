//! The entrance while the server starts or switches to another map: it answers at once, and passes requests on as soon
//! as the server is ready.
//!
//! Main type: [`Entrance`]. Until then every request gets 503 with the reason, except the one that asks whether the
//! process lives. Refuses: to keep a client waiting for the journal.

use axum::Router;
use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use giveway_api::{Problem, alive};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::requests;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::watch;
use tokio::time::sleep;
use tower::ServiceExt;

/// Seconds after which a retry makes sense while the journal loads.
const AGAIN_S: u16 = 1;

/// Seconds after which a retry makes sense if there is no room on the disk.
const ROOM_S: u16 = 10;

/// Seconds after which a retry makes sense if a person must act first.
const MENDED_S: u16 = 60;

/// How long requests in progress may take when the map is changed, and how often their number is checked.
const LEAVE: Duration = Duration::from_secs(3);
const LOOK: Duration = Duration::from_millis(20);

/// What the entrance leads to.
#[derive(Clone, Debug)]
enum Inside {
    /// The journal is being loaded.
    Starting,
    /// The map is being changed.
    Changing,
    /// The server.
    Open(Router),
    /// Nothing yet, since there is no room on the disk; the text gives the reason.
    NoRoom(String),
    /// Nothing; the text gives the reason.
    Shut(String),
}

/// The entrance. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Entrance {
    inside: Arc<watch::Sender<Inside>>,
    /// One reference for each request inside, and one for each clone of the entrance.
    visitors: Arc<()>,
}

impl Default for Entrance {
    fn default() -> Entrance {
        Entrance { inside: Arc::new(watch::Sender::new(Inside::Starting)), visitors: Arc::new(()) }
    }
}

impl Entrance {
    /// The router that the listener serves from start to end.
    pub fn router(&self) -> Router {
        Router::new().fallback(enter).with_state(self.clone())
    }

    /// Passes requests on from now on.
    pub fn open(&self, inside: Router) {
        self.inside.send_replace(Inside::Open(inside));
    }

    /// Answers from now on that the map is being changed, and waits for a while until no more than `left` requests are
    /// in progress.
    pub async fn empty(&self, left: usize) {
        self.inside.send_replace(Inside::Changing);
        let begun = Instant::now();
        // Each clone of the entrance has one reference.
        while Arc::strong_count(&self.visitors) > self.doors() + left && begun.elapsed() < LEAVE {
            sleep(LOOK).await;
        }
    }

    /// How many clones of the entrance there are.
    fn doors(&self) -> usize {
        Arc::strong_count(&self.inside)
    }

    /// Answers from now on that the server will start as soon as there is room on the disk.
    pub fn wait_for_room(&self, why: String) {
        self.inside.send_replace(Inside::NoRoom(why));
    }

    /// Answers from now on with the reason why the server does not work.
    pub fn shut(&self, why: String) {
        self.inside.send_replace(Inside::Shut(why));
    }
}

async fn enter(State(entrance): State<Entrance>, request: Request) -> Response {
    let (inside, visitor) = (entrance.inside.borrow().clone(), entrance.visitors.clone());
    drop(entrance);
    let problem = match inside {
        Inside::Open(router) => {
            let response = router.oneshot(request).await.into_response();
            drop(visitor);
            return response;
        }
        Inside::Starting => {
            problem("starting", "The server is starting", requests::server_starting(), AGAIN_S)
        }
        Inside::Changing => {
            problem("starting", "The map is being changed", requests::map_being_changed(), AGAIN_S)
        }
        Inside::NoRoom(why) => {
            problem("no-room", "There is no room on the disk", requests::unavailable(why), ROOM_S)
        }
        Inside::Shut(why) => {
            problem("broken", "The server cannot work", requests::unavailable(why), MENDED_S)
        }
    };
    let path = request.uri().path().to_owned();
    let lives = Router::new().route("/v1/health/live", get(alive)).fallback(async move || problem.at(&path));
    lives.oneshot(request).await.into_response()
}

fn problem(kind: &str, title: &'static str, detail: Sentence, again_s: u16) -> Problem {
    let problem = Problem::new(StatusCode::SERVICE_UNAVAILABLE, kind, title, detail);
    Problem { retry_after: Some(again_s), ..problem }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::Body;
    use axum::http::header;

    async fn ask(entrance: &Entrance, path: &str) -> (u16, Option<String>, String) {
        let request = Request::builder().uri(path).body(Body::empty()).unwrap();
        let response = entrance.router().oneshot(request).await.unwrap();
        let again = response.headers().get(header::RETRY_AFTER).map(|v| v.to_str().unwrap().to_owned());
        let status = response.status().as_u16();
        let body = axum::body::to_bytes(response.into_body(), 10_000).await.unwrap();
        (status, again, String::from_utf8_lossy(&body).into_owned())
    }

    #[tokio::test]
    async fn it_says_that_it_starts_until_there_is_an_inside_and_why_there_is_none() {
        let entrance = Entrance::default();
        for path in ["/v1/health", "/v1/jobs", "/", "/nowhere"] {
            let (status, again, text) = ask(&entrance, path).await;
            assert_eq!((status, again.as_deref()), (503, Some("1")), "{path}");
            assert!(text.contains("/problems/starting") && text.contains(path), "{text}");
        }
        assert_eq!(ask(&entrance, "/v1/health/live").await.0, 200, "the process lives");
        entrance.wait_for_room("the disk is full".into());
        let (status, again, text) = ask(&entrance, "/v1/jobs").await;
        assert_eq!((status, again.as_deref()), (503, Some("10")));
        assert!(text.contains("/problems/no-room") && text.contains("the disk is full"), "{text}");
        assert_eq!(ask(&entrance, "/v1/health/live").await.0, 200, "a restart would not help");
        entrance.open(Router::new().route("/v1/health", get(async || "inside")));
        assert_eq!(ask(&entrance, "/v1/health").await, (200, None, "inside".into()));
        assert_eq!(ask(&entrance, "/nowhere").await.0, 404);
        entrance.shut("the journal contradicts itself".into());
        let (status, _, text) = ask(&entrance, "/v1/health").await;
        assert!(status == 503 && text.contains("the journal contradicts itself"), "{text}");
        assert_eq!(ask(&entrance, "/v1/health/live").await.0, 200);
    }
}
