//! `/v1/tokens`: the tokens with which callers are admitted, and their roles.
//!
//! Main types: [`TokenDto`], [`NewToken`], [`TokenMade`]. Refuses: to show a token a second time.

use crate::access::auth::{fresh_token, hash_of};
use crate::access::caller::{Caller, MOST_TOKENS, NamedToken, Role};
use crate::access::tokens::TokenPort;
use crate::dto::names::Page;
use crate::http::shared::named::parse_robot;
use crate::http::shared::paging::{Paging, page};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, Params, PathPart, read_end};
use crate::wire::text::{parse_token_name, time_text, token_name};
use axum::Json;
use axum::http::{HeaderName, StatusCode, header};
use giveway_floor::text::name_fault;
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The longest name of a token, characters.
const LONGEST_NAME: usize = 64;

/// A token, without the secret. Times are RFC 3339.
#[derive(Debug, Serialize, ToSchema)]
pub struct TokenDto {
    /// The token's number.
    #[schema(example = "t3")]
    pub id: String,
    /// The user of the token.
    #[schema(example = "night shift")]
    pub name: String,
    /// The role of callers with this token.
    pub role: Role,
    /// The worker or robot for which a device speaks; null for other roles.
    #[schema(example = "w1")]
    pub subject: Option<String>,
    /// When the token was made, or rotated.
    pub created: String,
    /// When the token expires; null if it does not.
    pub expires: Option<String>,
    /// When the token was revoked; null if it was not.
    pub revoked: Option<String>,
    /// When the token was last used, to within ten seconds; null if it never was.
    pub last_used: Option<String>,
    /// Whether the token is valid now.
    pub holds: bool,
}

/// A token to make.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewToken {
    /// The user of the token, 1 to 64 characters; the audit shows this name. Only one token of a name is valid at a
    /// time.
    #[schema(example = "night shift")]
    name: String,
    /// The role of callers with this token.
    role: Role,
    /// The worker or robot for which a device speaks; absent for other roles.
    #[schema(example = "w1")]
    subject: Option<String>,
    /// When the token expires, RFC 3339; if absent, it does not expire.
    #[schema(example = "2031-01-31T06:00:00Z")]
    expires: Option<String>,
}

/// A token that was just made.
#[derive(Debug, Serialize, ToSchema)]
pub struct TokenMade {
    /// The token itself. It is shown here and never again: the server keeps its SHA-256 only.
    pub token: String,
    /// The token, without the secret.
    #[serde(flatten)]
    pub known: TokenDto,
}

/// List all named tokens, including those that are no longer valid; the secrets are never listed.
#[utoipa::path(get, path = "/v1/tokens", tag = "server", operation_id = "listTokens", params(Paging), responses(
    (status = 200, description = "Tokens in the order in which they were made", body = Page<TokenDto>),
    (status = 409)))]
pub async fn list(Called(api): Called, Params(p): Params<Paging>) -> Result<Json<Page<TokenDto>>, Problem> {
    let all = port(&api)?.list().await.map_err(Problem::of_records)?;
    page(all.iter().map(|token| dto(&api, token)).collect(), &p)
}

/// Make a token. It is valid at once. Once an administrator's token exists, a server that needed no token needs one.
#[utoipa::path(post, path = "/v1/tokens", tag = "server",
    operation_id = "makeToken", request_body = NewToken, responses(
    (status = 201, description = "Made; the token is in this answer only", body = TokenMade,
     headers(("Location" = String))),
    (status = 409, description = "Another token of this name holds, or a recording is shown"),
    (status = 429, description = "As many hold as may")))]
pub async fn make(
    Called(api): Called,
    JsonBody(new): JsonBody<NewToken>,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<TokenMade>), Problem> {
    let token = fresh_token();
    let wanted = NamedToken { hash: hash_of(&token), ..new.read(&api)? };
    let name = wanted.name.clone();
    let all = port(&api)?.list().await.map_err(Problem::of_records)?;
    let now = (api.now)();
    if all.iter().filter(|t| t.holds(now)).count() >= MOST_TOKENS {
        return Err(Problem::no_room(requests::too_many_tokens(MOST_TOKENS)));
    }
    let made = port(&api)?.add(wanted).await.map_err(Problem::of_records)?;
    let Some(made) = made else {
        let detail = requests::token_name_taken(name);
        return Err(Problem::conflict("name-taken", "The name is taken", detail));
    };
    let place = format!("/v1/tokens/{}", token_name(made.id));
    let answer = TokenMade { token, known: dto(&api, &made) };
    Ok((StatusCode::CREATED, [(header::LOCATION, place)], Json(answer)))
}

/// Revoke a token at once: requests with it are refused, and live feeds that were opened with it end.
#[utoipa::path(delete, path = "/v1/tokens/{id}", tag = "server", operation_id = "revokeToken",
    params(("id" = String, Path, example = "t3")), responses(
    (status = 204, description = "Revoked"),
    (status = 404, description = "There is no such token, or it was revoked before")))]
pub async fn revoke(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    let revoked = port(&api)?.revoke(parse(&id)?).await.map_err(Problem::of_records)?;
    if revoked { Ok(StatusCode::NO_CONTENT) } else { Err(unknown(&id)) }
}

/// Rotate a token: a new one with the same name and role replaces it. The old one is invalid from now on.
#[utoipa::path(post, path = "/v1/tokens/{id}/rotate", tag = "server", operation_id = "rotateToken",
    params(("id" = String, Path, example = "t3")), responses(
    (status = 200, description = "Made anew; the token is in this answer only", body = TokenMade),
    (status = 404, description = "There is no such token, or it no longer holds")))]
pub async fn rotate(Called(api): Called, PathPart(id): PathPart) -> Result<Json<TokenMade>, Problem> {
    let (number, token) = (parse(&id)?, fresh_token());
    let made = port(&api)?.rotate(number, hash_of(&token)).await;
    let made = made.map_err(Problem::of_records)?.ok_or_else(|| unknown(&id))?;
    Ok(Json(TokenMade { token, known: dto(&api, &made) }))
}

impl NewToken {
    /// The requested token, without what the server adds.
    fn read(&self, api: &Api) -> Result<NamedToken, Problem> {
        let mut errors = Vec::new();
        let name = self.name.trim();
        if let Some(fault) = name_fault(name, LONGEST_NAME) {
            errors.push(FieldError::new("name", fault.sentence()));
        }
        if Caller::RESERVED.contains(&name) {
            errors.push(FieldError::new("name", requests::token_name_reserved(name)));
        }
        let expires = read_end("expires", self.expires.as_deref(), &mut errors);
        if expires.is_some_and(|end| end <= (api.now)()) {
            errors.push(FieldError::new("expires", requests::is_over_already()));
        }
        match (self.role, self.subject.as_deref()) {
            (Role::Device, Some(id)) if is_known(api, id) => {}
            (Role::Device, Some(id)) => {
                errors.push(FieldError::new("subject", requests::no_worker_or_robot(id)));
            }
            (Role::Device, None) => {
                errors.push(FieldError::new("subject", requests::name_the_subject()));
            }
            (_, Some(_)) => errors.push(FieldError::new("subject", requests::only_devices_speak())),
            (_, None) => {}
        }
        if !errors.is_empty() {
            return Err(Problem::invalid(errors));
        }
        Ok(NamedToken {
            id: 0,
            name: name.into(),
            role: self.role,
            subject: self.subject.clone(),
            hash: [0; 32],
            created: (api.now)(),
            expires,
            revoked: None,
            last_used: None,
        })
    }
}

/// Whether there is a worker or robot with this id.
fn is_known(api: &Api, id: &str) -> bool {
    api.feeds.worker(id).is_ok() || parse_robot(api, id).is_ok()
}

fn port(api: &Api) -> Result<&dyn TokenPort, Problem> {
    api.tokens.as_deref().ok_or_else(Problem::of_recording)
}

fn parse(id: &str) -> Result<i64, Problem> {
    parse_token_name(id).ok_or_else(|| unknown(id))
}

fn unknown(id: &str) -> Problem {
    Problem::unknown("token", requests::token_unknown(id))
}

fn dto(api: &Api, token: &NamedToken) -> TokenDto {
    TokenDto {
        id: token_name(token.id),
        name: token.name.clone(),
        role: token.role,
        subject: token.subject.clone(),
        created: time_text(token.created),
        expires: token.expires.map(time_text),
        revoked: token.revoked.map(time_text),
        last_used: token.last_used.map(time_text),
        holds: token.holds((api.now)()),
    }
}
