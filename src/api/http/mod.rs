//! The routes: one file per resource, one list here, and the layers around them. The rooms of handlers know [`shared`]
//! and never each other.
//!
//! Main function: [`router`]. Every route under `/v1` is registered together with its description, so that
//! `/openapi.json` cannot miss one. Refuses: errors that are not problem+json.

mod access;
mod describe;
mod feeds;
mod fleet;
mod floor;
mod once;
pub(super) mod operate;
mod orders;
mod past;
mod people;
mod shared;

use crate::access::audit::AuditEntry;
use crate::access::caller::Caller;
use crate::access::peer::{Peer, Recognised, SharedBody};
use crate::access::roles::{Access, OIDC_CALLBACK, access_of, check_role, is_audited, subject_of};
use crate::http::shared::shared_text::SharedText;
use crate::page::served;
use crate::state::api::Api;
use crate::state::metrics::HttpLabels;
use crate::wire::error::{Problem, SecretDoor};
use axum::extract::{MatchedPath, Request, State};
use axum::http::{Extensions, HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Version, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use giveway_floor::text::sentence::requests;
use serde_json::Value;
use std::net::IpAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::compression::predicate::{NotForContentType, Predicate, SizeAbove};
use tower_http::cors::CorsLayer;
use utoipa::OpenApi;
use utoipa::openapi::OpenApi as Document;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// All routes, and their OpenAPI description.
pub fn router(api: Api) -> (Router, Document) {
    let (v1, document) = routes().split_for_parts();
    let served = |document: Value| {
        let text = SharedText::of(document.to_string());
        get(async move |headers: HeaderMap| text.answer(&headers))
    };
    let origins = api.gate.origins().to_vec();
    let router = v1
        .route_layer(middleware::from_fn_with_state(api.clone(), authorise))
        .route("/openapi.json", served(describe::openapi::described(&document)))
        .route("/asyncapi.json", served(describe::asyncapi::messages()))
        .fallback(served::page)
        .method_not_allowed_fallback(wrong_method)
        .with_state(api.clone())
        .layer(Extension(floor::map::MapAnswer::of(&api.map)))
        .layer(CompressionLayer::new().compress_when(worth_compressing()))
        .layer(CatchPanicLayer::custom(|_| Problem::internal().into_response()))
        .layer(middleware::from_fn_with_state(api, account));
    // Without configured origins, pages of other sites get no answers.
    let router = if origins.is_empty() { router } else { router.layer(cross_origin(&origins)) };
    (router, document)
}

/// Lets pages of these origins send requests and read the answers, but without a session cookie.
fn cross_origin(origins: &[String]) -> CorsLayer {
    let origins: Vec<HeaderValue> = origins.iter().filter_map(|origin| origin.parse().ok()).collect();
    let requests = [
        header::ACCEPT,
        header::AUTHORIZATION,
        header::CONTENT_TYPE,
        header::IF_MATCH,
        header::IF_NONE_MATCH,
        HeaderName::from_static("idempotency-key"),
        HeaderName::from_static("last-event-id"),
    ];
    let answers = [
        header::CONTENT_DISPOSITION,
        header::ETAG,
        header::LINK,
        header::LOCATION,
        header::RETRY_AFTER,
        HeaderName::from_static("idempotency-replayed"),
    ];
    CorsLayer::new()
        .allow_origin(origins)
        .allow_methods([Method::GET, Method::HEAD, Method::POST, Method::PUT, Method::PATCH, Method::DELETE])
        .allow_headers(requests)
        .expose_headers(answers)
        .max_age(Duration::from_secs(600))
}

/// Compress texts of more than a kilobyte, but neither event streams, which must leave at once, nor compressed content.
fn worth_compressing() -> impl Predicate {
    SizeAbove::new(1024)
        .and(NotForContentType::SSE)
        .and(NotForContentType::const_new("application/gzip"))
        .and(NotForContentType::IMAGES)
        .and(is_not_shared)
}

/// A shared body is compressed once for all clients, and sent uncompressed until that is done.
fn is_not_shared(_: StatusCode, _: Version, _: &HeaderMap, extensions: &Extensions) -> bool {
    extensions.get::<SharedBody>().is_none()
}

/// Routes about stations, and for reports from stations.
fn station_routes() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(routes!(floor::stations::one))
        .routes(routes!(feeds::station::live_station))
        .routes(routes!(floor::stations::line))
        .routes(routes!(floor::stations::last))
        .routes(routes!(floor::stations::release))
        .routes(routes!(floor::stations::done))
        .routes(routes!(floor::stations::short))
        .routes(routes!(floor::stations::pause))
        .routes(routes!(floor::stations::resume))
}

/// Routes about robots, their kinds, and the fleet as a whole.
fn fleet_routes() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(routes!(floor::lists::robots, fleet::robots::register))
        .routes(routes!(fleet::robot_life::get, fleet::robots::retire))
        .routes(routes!(fleet::robot_life::history))
        .routes(routes!(fleet::linked::get))
        .routes(routes!(fleet::linked::messages))
        .routes(routes!(fleet::linked::act))
        .routes(routes!(fleet::linked::fate))
        .routes(routes!(fleet::linked::consent))
        .routes(routes!(fleet::linked::settle))
        .routes(routes!(fleet::robots::take_rack))
        .routes(routes!(fleet::robots::maintain, fleet::robots::work_again))
        .routes(routes!(fleet::kinds::kinds))
        .routes(routes!(fleet::kinds::put, fleet::kinds::remove))
        .routes(routes!(fleet::why::robot))
        .routes(routes!(fleet::why::job))
        .routes(routes!(fleet::halt::fleet))
        .routes(routes!(fleet::halt::stop))
        .routes(routes!(fleet::halt::resume))
        .routes(routes!(fleet::halt::pause))
        .routes(routes!(fleet::halt::go_on))
}

/// The described routes, each with its description.
fn routes() -> OpenApiRouter<Api> {
    OpenApiRouter::with_openapi(describe::openapi::Description::openapi())
        .routes(routes!(operate::health::health))
        .routes(routes!(operate::health::live))
        .routes(routes!(operate::health::ready))
        .routes(routes!(operate::alarms::list))
        .routes(routes!(operate::alarms::acknowledge))
        .routes(routes!(operate::alarms::shelve, operate::alarms::unshelve))
        .routes(routes!(operate::alarms::write_note))
        .routes(routes!(floor::map::map, floor::publish::publish))
        .routes(routes!(floor::publish::check))
        .routes(routes!(floor::maps::file))
        .routes(routes!(floor::maps::check))
        .routes(routes!(floor::maps::trial))
        .routes(routes!(floor::lists::racks))
        .routes(routes!(floor::lists::stations))
        .routes(routes!(floor::timelines::timelines))
        .routes(routes!(orders::jobs::list, orders::jobs::submit))
        .routes(routes!(orders::batch::submit))
        .routes(routes!(orders::jobs::get, orders::jobs::change, orders::jobs::cancel))
        .routes(routes!(orders::jobs::reassign))
        .merge(fleet_routes())
        .merge(station_routes())
        .routes(routes!(people::workers::list, people::workers::hire))
        .routes(routes!(people::workers::get, people::workers::change))
        .routes(routes!(people::pseudonyms::list))
        .routes(routes!(people::pseudonyms::erase))
        .routes(routes!(people::lost::clear))
        .routes(routes!(people::lost::narrow))
        .routes(routes!(feeds::headset::feed))
        .routes(routes!(people::positions::one))
        .routes(routes!(people::positions::many))
        .routes(routes!(people::reports::post, people::reports::stream))
        .routes(routes!(orders::assignments::of_worker, orders::assignments::assign))
        .routes(routes!(orders::assignments::all, orders::assignments::assign_nearest))
        .routes(routes!(orders::assignments::get, orders::assignments::cancel))
        .routes(routes!(orders::assignments::finish))
        .routes(routes!(floor::closures::list, floor::closures::close))
        .routes(routes!(floor::closures::preview))
        .routes(routes!(floor::recurring::list))
        .routes(routes!(floor::closures::get, floor::closures::reopen))
        .routes(routes!(floor::evacuation::get, floor::evacuation::begin, floor::evacuation::end))
        .routes(routes!(past::encounters::list))
        .routes(routes!(past::events::list))
        .routes(routes!(operate::webhooks::list, operate::webhooks::add))
        .routes(routes!(operate::webhooks::remove))
        .routes(routes!(operate::webhooks::failures))
        .routes(routes!(past::recordings::past))
        .routes(routes!(past::recordings::figures))
        .routes(routes!(past::recordings::recording))
        .routes(routes!(past::history::history))
        .routes(routes!(past::shift::report))
        .routes(routes!(past::heat::heat))
        .merge(access_routes())
        .routes(routes!(feeds::floor::live))
        .routes(routes!(operate::health::metrics))
}

/// Routes about access rights, and the audit.
fn access_routes() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(routes!(access::audit::list))
        .routes(routes!(access::session::who, access::session::sign_in, access::session::sign_out))
        .routes(routes!(access::oidc::provider, access::oidc::begin))
        .routes(routes!(access::oidc::callback))
        .routes(routes!(access::tokens::list, access::tokens::make))
        .routes(routes!(access::tokens::revoke))
        .routes(routes!(access::tokens::rotate))
}

/// Admits requests whose caller has the role that the route needs, passes the caller on to the handler, and audits
/// requests that are to change something, with their outcome.
async fn authorise(State(api): State<Api>, mut request: Request, next: Next) -> Response {
    let open = access_of(request.method().as_str(), request.uri().path()) == Some(Access::Open);
    let caller = match api.gate.check(request.method(), request.headers(), (api.now)()) {
        _ if request.uri().path() == OIDC_CALLBACK => Caller::anonymous(),
        Ok(caller) => caller,
        Err(problem) if open && problem.status == StatusCode::UNAUTHORIZED.as_u16() => Caller::anonymous(),
        Err(problem) => return problem.into_response(),
    };
    let (caller, method, path) = (Arc::new(caller), request.method().as_str(), request.uri().path());
    let route = request.extensions().get::<MatchedPath>().map_or("", MatchedPath::as_str);
    let entry = is_audited(method, route).then(|| {
        let subject = subject_of(route, path).map(str::to_owned);
        Arc::new(api.audit.begin(&caller, format!("{method} {route}"), subject, (api.now)()))
    });
    let mut response = match check_role(&caller, method, route, path) {
        Err(problem) => problem.into_response(),
        Ok(()) => {
            let (who, route) = (caller.clone(), route.to_owned());
            request.extensions_mut().insert(caller);
            if let Some(entry) = &entry {
                request.extensions_mut().insert(entry.clone());
            }
            once::answer(&api, &who, &route, request, next).await
        }
    };
    // An answer of an open route does not reveal whether the caller was recognised.
    if !open {
        response.extensions_mut().insert(Recognised);
    }
    if let Some(entry) = entry {
        let status = Some(response.status().as_u16());
        let subject = entry.subject.clone().or_else(|| made(&response));
        api.audit.end(AuditEntry { status, subject, ..(*entry).clone() });
    }
    response
}

/// The id of the created thing, if the answer has a `Location`.
fn made(response: &Response) -> Option<String> {
    let place = response.headers().get(header::LOCATION)?.to_str().ok()?;
    Some(place.rsplit('/').next()?.to_owned())
}

/// Counts requests, and writes the request's path into problems.
async fn account(State(api): State<Api>, request: Request, next: Next) -> Response {
    let method = method_word(request.method());
    let path = request.uri().path().to_owned();
    let route = request.extensions().get::<MatchedPath>().map_or("other", MatchedPath::as_str).to_owned();
    let peer = request.extensions().get::<Peer>().copied();
    let mut response = next.run(request).await;
    let status = response.status().as_u16();
    let recognised = response.extensions_mut().remove::<Recognised>();
    api.metrics.http.get_or_create(&HttpLabels { method: method.into(), route, status }).inc();
    if let Some(problem) = response.extensions_mut().remove::<Problem>() {
        if let Some(door) = problem.wrong_secret {
            slow_down(&api, door, peer).await;
        }
        response = problem.at(&path).into_response();
    }
    if let Some(recognised) = recognised {
        response.extensions_mut().insert(recognised);
    }
    response
        .headers_mut()
        .entry(HeaderName::from_static("x-content-type-options"))
        .or_insert(HeaderValue::from_static("nosniff"));
    response
}

/// Delays the answer to a wrong secret, and audits the attempt.
async fn slow_down(api: &Api, door: SecretDoor, peer: Option<Peer>) {
    let from = peer.map_or(IpAddr::from([127, 0, 0, 1]), |Peer(from)| from);
    let judged = api.gate.wrong_secrets().note(from, Instant::now());
    if let Some(times) = judged.note {
        let times = if times > 1 { format!(", {times} times") } else { String::new() };
        let what = format!("{}{times}", door.words());
        let entry = api.audit.begin(&Caller::anonymous(), what, Some(from.to_string()), (api.now)());
        api.audit.end(AuditEntry { status: Some(StatusCode::UNAUTHORIZED.as_u16()), ..entry });
    }
    tokio::time::sleep(judged.pause).await;
}

fn method_word(method: &Method) -> &'static str {
    match *method {
        Method::GET => "GET",
        Method::HEAD => "HEAD",
        Method::POST => "POST",
        Method::DELETE => "DELETE",
        Method::PATCH => "PATCH",
        _ => "other",
    }
}

async fn wrong_method(request: Request) -> Problem {
    let detail = format!("{} is not allowed here: /openapi.json lists what is", request.method());
    let detail = requests::malformed(detail);
    Problem::new(StatusCode::METHOD_NOT_ALLOWED, "method", "Method not allowed", detail)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::roles::RULES;
    use std::collections::BTreeSet;

    #[test]
    fn every_route_of_the_description_has_a_role_and_every_role_a_route() {
        let document = serde_json::to_value(routes().split_for_parts().1).unwrap();
        let mut described = BTreeSet::new();
        for (path, item) in document["paths"].as_object().unwrap() {
            described
                .extend(item.as_object().unwrap().keys().map(|method| (method.to_uppercase(), path.clone())));
        }
        let ruled: Vec<(String, String)> = RULES.iter().map(|(m, p, _)| ((*m).into(), (*p).into())).collect();
        assert_eq!(ruled.len(), ruled.iter().collect::<BTreeSet<_>>().len(), "no route has two rows");
        assert_eq!(described, ruled.into_iter().collect());
    }
}
