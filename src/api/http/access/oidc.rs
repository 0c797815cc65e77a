//! `/v1/session/oidc`: signing in with an identity provider.
//!
//! Main types: [`ProviderDto`], [`BeginSignOn`]. A page begins a sign-on and sends the browser to the provider, which
//! sends it back here; then the browser has a session, or the sign-in page says why not. Refuses: to lead to other
//! sites afterwards.

use super::session::{note, port};
use crate::access::auth::{fresh_token, hash_of};
use crate::access::caller::{Caller, SessionHolder, WebSession};
use crate::access::cookie::{attempt_cookie, attempt_secret, is_plain, session_cookie};
use crate::access::roles::OIDC_CALLBACK;
use crate::oidc::{AuthorizationResponse, Oidc, OidcRefusal, SIGN_ON_LIFE, SignedOn};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::{JsonBody, Params};
use axum::Json;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{AppendHeaders, IntoResponse, Response};
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::{IntoParams, ToSchema};

/// The longest path of a page to return to, in bytes.
const LONGEST_BACK: usize = 2000;

/// The identity provider with which people can sign in instead of with a token.
#[derive(Debug, Serialize, ToSchema)]
pub struct ProviderDto {
    /// The display name of the identity provider; null if the settings name no provider.
    #[schema(example = "Keycloak")]
    pub name: Option<String>,
}

/// How to begin a sign-on with the identity provider.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BeginSignOn {
    /// The page of this server to return to, as a path; the dashboard if absent.
    #[schema(example = "/?view=1", max_length = 2000)]
    back: Option<String>,
}

/// Where to send the browser to sign on.
#[derive(Debug, Serialize, ToSchema)]
pub struct ProviderRedirectDto {
    /// The address to which the browser must go.
    #[schema(example = "https://login.example/authorize?client_id=giveway")]
    pub address: String,
}

/// What the provider sends back with the browser. It may send more.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct CallbackParams {
    /// The `state` of the sign-on to which the answer belongs.
    state: Option<String>,
    /// The authorization code, to be exchanged for an ID token.
    code: Option<String>,
    /// The provider's error, if it refused.
    error: Option<String>,
    /// The issuer, as the provider names itself.
    iss: Option<String>,
}

/// Get the identity provider with which people sign in here.
#[utoipa::path(get, path = "/v1/session/oidc", tag = "server", operation_id = "getIdentityProvider", responses(
    (status = 200, description = "What it is called", body = ProviderDto)))]
pub async fn provider(Called(api): Called) -> Json<ProviderDto> {
    Json(ProviderDto { name: api.oidc.as_deref().map(Oidc::name) })
}

/// Begin to sign in with the identity provider: the answer contains the address to which the browser must go, and sets
/// a cookie without which the browser is refused when it returns. The browser must return within ten minutes.
#[utoipa::path(post, path = "/v1/session/oidc", tag = "server", operation_id = "beginSignOn",
    request_body = BeginSignOn, responses(
    (status = 200, description = "Where to go", body = ProviderRedirectDto, headers(("Set-Cookie" = String))),
    (status = 404, description = "The settings name no identity provider"),
    (status = 503, description = "The identity provider does not answer as it should: sign in with a token")))]
pub async fn begin(
    Called(api): Called,
    headers: HeaderMap,
    JsonBody(given): JsonBody<BeginSignOn>,
) -> Result<([(HeaderName, String); 1], Json<ProviderRedirectDto>), Problem> {
    let oidc = configured(&api)?;
    let plain = is_plain(&headers);
    let redirect = oidc.redirect().map_or_else(|| own_address(&headers, plain), str::to_owned);
    let back = given.back.filter(|back| is_own_page(back)).unwrap_or_else(|| "/".into());
    let request = oidc
        .begin(redirect, back, (api.now)())
        .await
        .map_err(|_| Problem::unavailable(requests::provider_does_not_answer(oidc.name()), 10))?;
    let cookie = attempt_cookie(&headers, &request.secret, SIGN_ON_LIFE.0 / 1_000_000, plain);
    Ok(([(header::SET_COOKIE, cookie)], Json(ProviderRedirectDto { address: request.address })))
}

/// Complete a sign-on; the identity provider sends browsers here. Redirects to the page where the person wanted to go,
/// signed in, or to the sign-in page, which says why not.
#[utoipa::path(get, path = OIDC_CALLBACK, tag = "server", operation_id = "endSignOn", params(CallbackParams), responses(
    (status = 303, description = "On to a page of this server", headers(("Location" = String))),
    (status = 404, description = "The settings name no identity provider")))]
pub async fn callback(
    Called(api): Called,
    headers: HeaderMap,
    Params(p): Params<CallbackParams>,
) -> Result<Response, Problem> {
    let oidc = configured(&api)?;
    let given = AuthorizationResponse { state: p.state, code: p.code, error: p.error, issuer: p.iss };
    let over = (header::SET_COOKIE, attempt_cookie(&headers, "", 0, is_plain(&headers)));
    let on = |to: String, cookies: Vec<(HeaderName, String)>| {
        (StatusCode::SEE_OTHER, [(header::LOCATION, to)], AppendHeaders(cookies)).into_response()
    };
    let signed_on = match oidc.finish(given, attempt_secret(&headers), (api.now)()).await {
        Ok(signed_on) => signed_on,
        Err((why, back)) => return Ok(on(page_that_says(why, back.as_deref()), vec![over])),
    };
    let plain = signed_on.plain;
    let (secret, back) = begin_session(&api, signed_on).await?;
    Ok(on(back, vec![over, (header::SET_COOKIE, session_cookie(&headers, &secret, plain))]))
}

/// Begins a person's session; returns the value of the cookie and the next page.
async fn begin_session(api: &Api, signed_on: SignedOn) -> Result<(String, String), Problem> {
    let SignedOn { name, role, expires, back, .. } = signed_on;
    let (secret, created) = (fresh_token(), (api.now)());
    let (hash, holder) = (hash_of(&secret), SessionHolder::Person { name: name.clone(), role });
    let session = WebSession { hash, holder, created, expires };
    port(api)?.sign_in(session).await.map_err(Problem::of_records)?;
    let what = format!("GET {OIDC_CALLBACK}");
    note(api, &Caller::of_person(name, role, hash), &what, StatusCode::CREATED);
    Ok((secret, back))
}

fn configured(api: &Api) -> Result<&Arc<Oidc>, Problem> {
    api.oidc.as_ref().ok_or_else(|| Problem::unknown("provider", requests::no_provider()))
}

/// The address of the callback, under the host by which the browser knows this server.
fn own_address(headers: &HeaderMap, plain: bool) -> String {
    let host = headers.get(header::HOST).and_then(|v| v.to_str().ok()).unwrap_or("localhost");
    format!("{}://{host}{OIDC_CALLBACK}", if plain { "http" } else { "https" })
}

/// Whether browsers take this path to be a page of this server.
fn is_own_page(path: &str) -> bool {
    let rest = path.strip_prefix('/');
    let leads_away = rest.is_none_or(|rest| rest.starts_with(['/', '\\']));
    !leads_away && path.len() <= LONGEST_BACK && path.bytes().all(|b| b.is_ascii_graphic())
}

/// The sign-in page with the refusal's word and the page to go to after signing in.
fn page_that_says(why: OidcRefusal, back: Option<&str>) -> String {
    let back: String = back.unwrap_or("/").bytes().map(escaped).collect();
    format!("/sign-in?refused={}&back={back}", why.word())
}

/// A byte of a parameter, escaped if necessary.
fn escaped(byte: u8) -> String {
    match byte {
        b if b.is_ascii_alphanumeric() || b"/-._~".contains(&b) => char::from(b).to_string(),
        b => format!("%{b:02X}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_is_led_to_another_site() {
        for own in ["/", "/?view=1#map", "/headset"] {
            assert!(is_own_page(own), "{own}");
        }
        for other in
            ["", "//evil.example", "/\\evil.example", "https://evil.example", "/a\r\nb", "/ä", "javascript:x"]
        {
            assert!(!is_own_page(other), "{other}");
        }
        let said = page_that_says(OidcRefusal::NoRole, Some("/?view=1&x=a b#map"));
        assert_eq!(said, "/sign-in?refused=no_role&back=/%3Fview%3D1%26x%3Da%20b%23map");
    }
}
