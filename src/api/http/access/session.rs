//! `/v1/session`: signing a browser in and out, and the current caller.
//!
//! Main types: [`SignIn`], [`SessionDto`]. Refuses: to show the cookie's value to scripts of the page.

use crate::access::acts::AuditAct;
use crate::access::audit::AuditEntry;
use crate::access::auth::{SESSION_LIFE, fresh_token, hash_of};
use crate::access::caller::{Caller, Role, SessionHolder, WebSession};
use crate::access::cookie::{is_plain, no_session_cookie, session_cookie};
use crate::access::tokens::TokenPort;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{Problem, SecretDoor};
use crate::wire::extract::JsonBody;
use crate::wire::text::time_text;
use axum::Json;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The credentials for signing in.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SignIn {
    /// A valid token.
    #[schema(example = "gw_0123456789abcdef")]
    token: String,
}

/// How a caller was identified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SignedInBy {
    /// By the cookie of a session.
    Session,
    /// By a token in the request.
    Token,
    /// Not at all: this server needs no token.
    Nothing,
}

/// The caller.
#[derive(Debug, Serialize, ToSchema)]
pub struct SessionDto {
    /// The name of the token, or of the person who signed in with an identity provider; `configuration` for tokens of
    /// the settings, `this machine` if no token is needed.
    #[schema(example = "night shift")]
    pub name: String,
    /// The caller's role.
    pub role: Role,
    /// The worker or robot for which a device speaks; null for other roles.
    #[schema(example = "w1")]
    pub subject: Option<String>,
    /// How the caller was identified.
    pub by: SignedInBy,
    /// When the session or the token expires, RFC 3339; null if it does not.
    pub expires: Option<String>,
    /// What the caller may do besides reading; a device, only for its own worker or robot.
    pub may: Vec<AuditAct>,
}

/// Get the current caller.
#[utoipa::path(get, path = "/v1/session", tag = "server", operation_id = "getSession", responses(
    (status = 200, description = "Who asks, in which role", body = SessionDto)))]
pub async fn who(Called(api): Called) -> Json<SessionDto> {
    Json(dto(&api, &api.caller))
}

/// Sign in: get a cookie instead of a token, for pages of this server. It lasts until the browser is closed, seven days
/// at most, and never longer than the token.
#[utoipa::path(post, path = "/v1/session", tag = "server",
    operation_id = "signIn", request_body = SignIn, responses(
    (status = 201, description = "Signed in", body = SessionDto, headers(("Set-Cookie" = String))),
    (status = 401, description = "The token does not hold")))]
pub async fn sign_in(
    Called(api): Called,
    headers: HeaderMap,
    JsonBody(given): JsonBody<SignIn>,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<SessionDto>), Problem> {
    let (now, token) = ((api.now)(), hash_of(given.token.trim()));
    let Some(caller) = api.gate.holder(&token, now) else {
        let detail = requests::token_wrong();
        return Err(Problem::wrong_secret(SecretDoor::SignIn, "The token does not hold", detail));
    };
    let secret = fresh_token();
    let holder = SessionHolder::Token(token);
    let hash = hash_of(&secret);
    let session = WebSession { hash, holder, created: now, expires: now + SESSION_LIFE };
    port(&api)?.sign_in(session).await.map_err(Problem::of_records)?;
    let caller = Caller { session: Some(hash), ..caller };
    note(&api, &caller, "POST /v1/session", StatusCode::CREATED);
    let cookie = (header::SET_COOKIE, session_cookie(&headers, &secret, is_plain(&headers)));
    Ok((StatusCode::CREATED, [cookie], Json(dto(&api, &caller))))
}

/// Sign out: the cookie's session ends, and so do feeds that were opened with it.
#[utoipa::path(delete, path = "/v1/session", tag = "server", operation_id = "signOut", responses(
    (status = 204, description = "Nobody is signed in any more", headers(("Set-Cookie" = String)))))]
pub async fn sign_out(
    Called(api): Called,
    headers: HeaderMap,
) -> Result<(StatusCode, [(HeaderName, String); 1]), Problem> {
    if let Some(hash) = api.caller.session {
        port(&api)?.sign_out(hash).await.map_err(Problem::of_records)?;
        note(&api, &api.caller, "DELETE /v1/session", StatusCode::NO_CONTENT);
    }
    Ok((StatusCode::NO_CONTENT, [(header::SET_COOKIE, no_session_cookie(&headers))]))
}

/// Audits that a person signed in or out.
pub(super) fn note(api: &Api, caller: &Caller, what: &str, status: StatusCode) {
    let entry = api.audit.begin(caller, what.into(), None, (api.now)());
    api.audit.end(AuditEntry { status: Some(status.as_u16()), ..entry });
}

pub(super) fn port(api: &Api) -> Result<&dyn TokenPort, Problem> {
    api.tokens.as_deref().ok_or_else(Problem::of_recording)
}

fn dto(api: &Api, caller: &Caller) -> SessionDto {
    let by = match (&caller.session, &caller.key) {
        (Some(_), _) => SignedInBy::Session,
        (None, Some(_)) => SignedInBy::Token,
        (None, None) => SignedInBy::Nothing,
    };
    let may = AuditAct::of_caller(caller);
    let Caller { name, role, subject, .. } = caller.clone();
    let expires = api.gate.end_of(caller, (api.now)()).map(time_text);
    SessionDto { name, role, subject, by, expires, may }
}
