//! The routes: one file per resource, one list here, and the layers around them.
//!
//! Main function: [`router`]. Every route under `/v1` is registered together with its description, so that
//! `/openapi.json` cannot forget one. Refuses: answers that are no problem+json where something went wrong.

mod alarms;
mod assignments;
mod asyncapi;
mod audit;
mod batch;
mod closing;
mod closures;
mod encounters;
mod evacuation;
mod events;
mod halt;
mod health;
mod heat;
mod history;
mod jobs;
mod kinds;
mod lists;
mod lost;
mod map;
mod maps;
mod new_job;
mod oidc;
mod openapi;
mod page;
mod past;
mod people;
mod positions;
mod publish;
mod recurring;
mod reports;
mod robot_life;
mod robots;
mod session;
mod shared_text;
mod shift;
pub(crate) mod stations;
mod timelines;
mod tokens;
mod webhooks;
mod why;
mod workers;

pub use health::alive;
pub use kinds::KindChecks;

use super::audit::AuditEntry;
use super::caller::Caller;
use super::cell::socket;
use super::error::Problem;
use super::feed::session as feed_session;
use super::metrics::HttpLabels;
use super::peer::{Peer, Recognised, SharedBody};
use super::roles::{Access, OIDC_CALLBACK, access_of, check_role, is_audited, subject_of};
use super::secrets::SecretDoor;
use super::{Api, once, ws};
use axum::extract::{MatchedPath, Request, State};
use axum::http::{Extensions, HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Version, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use giveway_floor::text::sentence::requests;
use serde_json::Value;
use shared_text::SharedText;
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

/// All routes, and what is said about them.
pub fn router(api: Api) -> (Router, Document) {
    let (v1, document) = routes().split_for_parts();
    let served = |document: Value| {
        let text = SharedText::of(document.to_string());
        get(async move |headers: HeaderMap| text.answer(&headers))
    };
    let origins = api.gate.origins().to_vec();
    let router = v1
        .route_layer(middleware::from_fn_with_state(api.clone(), authorise))
        .route("/openapi.json", served(openapi::described(&document)))
        .route("/asyncapi.json", served(asyncapi::messages()))
        .fallback(page::page)
        .method_not_allowed_fallback(wrong_method)
        .with_state(api.clone())
        .layer(Extension(map::MapAnswer::of(&api.map)))
        .layer(CompressionLayer::new().compress_when(worth_compressing()))
        .layer(CatchPanicLayer::custom(|_| Problem::internal().into_response()))
        .layer(middleware::from_fn_with_state(api, account));
    // Without origins nothing answers for pages of other sites.
    let router = if origins.is_empty() { router } else { router.layer(cross_origin(&origins)) };
    (router, document)
}

/// Lets browsers show answers to pages of these origins, and ask on their behalf; without the cookie of a session.
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

/// Texts of more than a kilobyte; neither event streams, which must leave at once, nor what is compressed already.
fn worth_compressing() -> impl Predicate {
    SizeAbove::new(1024)
        .and(NotForContentType::SSE)
        .and(NotForContentType::const_new("application/gzip"))
        .and(NotForContentType::IMAGES)
        .and(is_not_shared)
}

/// What is in memory once is compressed once, and sent as it is until that is done.
fn is_not_shared(_: StatusCode, _: Version, _: &HeaderMap, extensions: &Extensions) -> bool {
    extensions.get::<SharedBody>().is_none()
}

/// What is said of and at stations.
fn station_routes() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(routes!(stations::one))
        .routes(routes!(socket::live_station))
        .routes(routes!(stations::line))
        .routes(routes!(stations::last))
        .routes(routes!(stations::release))
        .routes(routes!(stations::done))
        .routes(routes!(stations::short))
        .routes(routes!(stations::pause))
        .routes(routes!(stations::resume))
}

/// The routes that are described, each beside what it says of itself.
fn routes() -> OpenApiRouter<Api> {
    OpenApiRouter::with_openapi(openapi::Description::openapi())
        .routes(routes!(health::health))
        .routes(routes!(health::live))
        .routes(routes!(health::ready))
        .routes(routes!(alarms::list))
        .routes(routes!(alarms::acknowledge))
        .routes(routes!(alarms::shelve, alarms::unshelve))
        .routes(routes!(alarms::write_note))
        .routes(routes!(map::map, publish::publish))
        .routes(routes!(publish::check))
        .routes(routes!(maps::file))
        .routes(routes!(maps::check))
        .routes(routes!(maps::trial))
        .routes(routes!(lists::racks))
        .routes(routes!(lists::stations))
        .routes(routes!(lists::robots, robots::register))
        .routes(routes!(robot_life::get, robots::retire))
        .routes(routes!(robot_life::history))
        .routes(routes!(robots::take_rack))
        .routes(routes!(robots::maintain, robots::work_again))
        .routes(routes!(kinds::kinds))
        .routes(routes!(kinds::put, kinds::remove))
        .routes(routes!(why::robot))
        .routes(routes!(why::job))
        .routes(routes!(timelines::timelines))
        .routes(routes!(jobs::list, jobs::submit))
        .routes(routes!(batch::submit))
        .routes(routes!(jobs::get, jobs::change, jobs::cancel))
        .routes(routes!(jobs::reassign))
        .routes(routes!(halt::fleet))
        .routes(routes!(halt::stop))
        .routes(routes!(halt::resume))
        .routes(routes!(halt::pause))
        .routes(routes!(halt::go_on))
        .merge(station_routes())
        .routes(routes!(workers::list, workers::hire))
        .routes(routes!(workers::get))
        .routes(routes!(people::list))
        .routes(routes!(people::erase))
        .routes(routes!(lost::clear))
        .routes(routes!(lost::narrow))
        .routes(routes!(feed_session::feed))
        .routes(routes!(positions::one))
        .routes(routes!(positions::many))
        .routes(routes!(reports::post, reports::stream))
        .routes(routes!(assignments::of_worker, assignments::assign))
        .routes(routes!(assignments::all, assignments::assign_nearest))
        .routes(routes!(assignments::get, assignments::cancel))
        .routes(routes!(assignments::finish))
        .routes(routes!(closures::list, closures::close))
        .routes(routes!(closures::preview))
        .routes(routes!(recurring::list))
        .routes(routes!(closures::get, closures::reopen))
        .routes(routes!(evacuation::get, evacuation::begin, evacuation::end))
        .routes(routes!(encounters::list))
        .routes(routes!(events::list))
        .routes(routes!(webhooks::list, webhooks::add))
        .routes(routes!(webhooks::remove))
        .routes(routes!(webhooks::failures))
        .routes(routes!(past::past))
        .routes(routes!(past::figures))
        .routes(routes!(past::recording))
        .routes(routes!(history::history))
        .routes(routes!(shift::report))
        .routes(routes!(heat::heat))
        .merge(access_routes())
        .routes(routes!(ws::live))
        .routes(routes!(health::metrics))
}

/// Routes about who may do what, and who did.
fn access_routes() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(routes!(audit::list))
        .routes(routes!(session::who, session::sign_in, session::sign_out))
        .routes(routes!(oidc::provider, oidc::begin))
        .routes(routes!(oidc::callback))
        .routes(routes!(tokens::list, tokens::make))
        .routes(routes!(tokens::revoke))
        .routes(routes!(tokens::rotate))
}

/// Lets requests in whose caller has the role that the route needs, tells the handler whose they are, and notes those
/// that are to change something, with what came of them.
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
    // What is open to everybody shows of nobody who it is.
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

/// The id of what was made, where the answer says where that is.
fn made(response: &Response) -> Option<String> {
    let place = response.headers().get(header::LOCATION)?.to_str().ok()?;
    Some(place.rsplit('/').next()?.to_owned())
}

/// Counts requests, and writes the path into problems.
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

/// Lets the answer to a wrong secret wait, and writes down that there was one.
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
    use super::super::roles::RULES;
    use super::*;
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
