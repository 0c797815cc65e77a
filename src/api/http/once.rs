//! Requests with an `Idempotency-Key` whose effect carries no key of its own: a repeat gets the first request's answer.
//!
//! Main function: [`answer`]. Jobs and assignments carry their keys themselves, in the same transaction. For the routes
//! in `KEYED`, the key is stored before the request is carried out, and the answer after that. So a repeat never does
//! it twice; if the server ended in between, the repeat is told that the outcome is unknown. Refuses: to keep tokens,
//! which are shown once.

use crate::access::caller::Caller;
use crate::port::answers::{AnswerPort, KeptAnswer, KeyedRequest, KnownRequest};
use crate::state::api::Api;
use crate::wire::error::Problem;
use crate::wire::extract::{BODY_LIMIT, IdempotencyKey};
use axum::body::{Body, to_bytes};
use axum::extract::{FromRequestParts, Request};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use giveway_floor::text::sentence::requests;
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Routes that create things without a unique name. Robots and workers need no key: the same name is the same thing.
const KEYED: [&str; 2] = ["/v1/closures", "/v1/webhooks"];

/// The longest answer that is kept, in bytes.
const LONGEST: usize = 1 << 20;

/// The header that marks the repeat of an earlier answer.
const REPLAYED: HeaderName = HeaderName::from_static("idempotency-replayed");

/// Answers a request; if its key is known, with the answer that was given before.
pub async fn answer(api: &Api, caller: &Caller, route: &str, request: Request, next: Next) -> Response {
    let (mut parts, body) = request.into_parts();
    let keyed = parts.method == axum::http::Method::POST && KEYED.contains(&route);
    let (Some(port), true) = (api.answers.clone(), keyed && parts.headers.contains_key("idempotency-key"))
    else {
        return next.run(Request::from_parts(parts, body)).await;
    };
    let key = match IdempotencyKey::from_request_parts(&mut parts, &()).await {
        Ok(IdempotencyKey(key)) => key.unwrap_or_default(),
        Err(problem) => return problem.into_response(),
    };
    // A body that is too long leaves no key behind; the request is refused here.
    let Ok(body) = to_bytes(body, BODY_LIMIT + 1).await else {
        let detail = requests::malformed(format!("a body may have {BODY_LIMIT} bytes at most"));
        let status = StatusCode::PAYLOAD_TOO_LARGE;
        return Problem::new(status, "too-large", "The body is too long", detail).into_response();
    };
    let digest = Sha256::digest(&body).iter().map(|b| format!("{b:02x}")).collect();
    let keyed = KeyedRequest { caller: caller.account(), route: route.into(), key };
    match port.begin(keyed.clone(), digest, (api.now)()).await {
        Err(why) => Problem::of_records(why).into_response(),
        Ok(KnownRequest::Answered(kept)) => replayed(kept),
        Ok(KnownRequest::New) => {
            // The request runs to its end, whether or not the client waits.
            let request = Request::from_parts(parts, Body::from(body));
            let (theirs, request_key) = (port.clone(), keyed.clone());
            let run = tokio::spawn(async move { kept(theirs, request_key, next.run(request).await).await });
            run.await.unwrap_or_else(|_| {
                // The handler panicked: the outcome is unknown, and the request no longer runs.
                port.leave(&keyed);
                Problem::internal().into_response()
            })
        }
        Ok(known) => refused(&known).into_response(),
    }
}

/// Stores an answer under its key, and returns it.
async fn kept(port: Arc<dyn AnswerPort>, request: KeyedRequest, response: Response) -> Response {
    let (parts, body) = response.into_parts();
    if parts.status.is_server_error() {
        port.leave(&request);
        return Response::from_parts(parts, body);
    }
    if !parts.status.is_success() {
        port.forget(request).await;
        return Response::from_parts(parts, body);
    }
    let body = match to_bytes(body, LONGEST).await {
        Ok(body) => body,
        Err(_) => {
            port.leave(&request);
            return Problem::internal().into_response();
        }
    };
    let location = parts.headers.get(header::LOCATION).and_then(|v| v.to_str().ok()).map(str::to_owned);
    let text = String::from_utf8_lossy(&body).into_owned();
    port.finish(request, KeptAnswer { status: parts.status.as_u16(), location, body: text }).await;
    Response::from_parts(parts, Body::from(body))
}

fn replayed(kept: KeptAnswer) -> Response {
    // A repeat creates nothing, but gets the first answer's status and body.
    let status = StatusCode::from_u16(kept.status).unwrap_or(StatusCode::OK);
    let mut response = (status, kept.body).into_response();
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
    headers.insert(REPLAYED, HeaderValue::from_static("true"));
    if let Some(place) = kept.location.and_then(|place| HeaderValue::from_str(&place).ok()) {
        headers.insert(header::LOCATION, place);
    }
    response
}

fn refused(known: &KnownRequest) -> Problem {
    match known {
        KnownRequest::Other => {
            let detail = "the Idempotency-Key was used for another request: use a new key for a new one";
            let detail = requests::malformed(detail);
            let status = StatusCode::UNPROCESSABLE_ENTITY;
            Problem::new(status, "key-reused", "The key belongs to another request", detail)
        }
        KnownRequest::Running => {
            let detail = "the request with this key is still being carried out: ask again in a second";
            let detail = requests::malformed(detail);
            Problem { retry_after: Some(1), ..Problem::conflict("in-progress", "Still in progress", detail) }
        }
        _ => {
            let detail = "the server ended, or could not write, while it carried out the request with this key, so it \
                          is not known whether it did: look at the list, and use a new key if it is not there";
            let detail = requests::malformed(detail);
            Problem::conflict("outcome-unknown", "The outcome is not known", detail)
        }
    }
}
