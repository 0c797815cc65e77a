//! `/v1/webhooks`: sends events to other systems, so that these need not poll.
//!
//! Main types: [`WebhookDto`], [`NewWebhook`]. Refuses: addresses that are not HTTP, internal addresses unless a
//! setting allows them, and to show secrets again.

use crate::dto::names::Page;
use crate::http::shared::paging::checked_limit;
use crate::outgoing::webhooks::{
    FailedMessage, HookReply, HookRequest, Webhook, WebhookAccess, new_secret, read_secret,
};
use crate::state::api::Api;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, Params, PathPart};
use crate::wire::text::time_text;
use axum::Json;
use axum::extract::State;
use axum::http::{StatusCode, Uri};
use giveway_fleet::EventKind;
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Serialize};
use tokio::sync::oneshot;
use utoipa::{IntoParams, ToSchema};

/// The longest address, in characters.
const LONGEST_URL: usize = 2000;

/// The most webhooks.
const MOST_HOOKS: usize = 32;

/// A webhook: a system that receives events.
#[derive(Debug, Serialize, ToSchema)]
pub struct WebhookDto {
    /// The webhook's number.
    #[schema(example = "h1")]
    pub id: String,
    /// The address to which messages are sent; a user and a password in the address are shown as `***`.
    #[schema(example = "https://wms.example/giveway")]
    pub url: String,
    /// The kinds of events that are sent; empty for all kinds.
    pub kinds: Vec<&'static str>,
    /// When the webhook was added, RFC 3339.
    pub created: String,
    /// The number of the last event that was delivered or given up.
    pub cursor: i64,
    /// How often sending the next message has failed.
    pub attempts: u32,
    /// Why the last attempt failed; null if there has been no failure since the last success.
    pub failing: Option<String>,
    /// The secret with which messages are signed; null except in the answer to the request that added the webhook.
    pub secret: Option<String>,
}

/// A webhook to add.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewWebhook {
    /// The address to which messages are sent, with http:// or https://. An internal address (of this machine, or of a
    /// private network) is refused unless the setting `webhook_inside` names its network.
    #[schema(example = "https://wms.example/giveway", max_length = 2000)]
    url: String,
    /// Only events of these kinds; all kinds if absent.
    #[serde(default)]
    #[schema(example = json!(["job"]))]
    kinds: Vec<String>,
    /// The secret with which to sign messages, `whsec_` and 24 to 64 bytes in base64; generated if absent.
    secret: Option<String>,
}

/// A message that was given up after twenty attempts.
#[derive(Debug, Serialize, ToSchema)]
pub struct FailedMessageDto {
    /// The number of the message's first event.
    pub first: i64,
    /// The number of the message's last event: `GET /v1/events?after=` with the number before `first` reads the events
    /// again.
    pub last: i64,
    /// When the message was given up, RFC 3339.
    pub at: String,
    /// How often the message was tried.
    pub attempts: u32,
    /// Why the last attempt failed.
    pub error: String,
}

/// The page of the messages that were given up.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct FailureParams {
    /// How many messages at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List all webhooks.
#[utoipa::path(get, path = "/v1/webhooks", tag = "events", operation_id = "listWebhooks", responses(
    (status = 200, description = "In order of being added", body = Vec<WebhookDto>)))]
pub async fn list(State(api): State<Api>) -> Result<Json<Vec<WebhookDto>>, Problem> {
    let hooks = ask(&api, HookRequest::List).await?;
    Ok(Json(hooks.into_iter().map(dto).collect()))
}

/// Add a webhook: the system receives all events from now on. Each message is a POST of `{"type": "giveway.events",
/// "timestamp", "data": {"events": [...]}}` with up to a hundred events in order, in the form of `GET /v1/events`,
/// signed as the Standard Webhooks specification says: `webhook-id`, `webhook-timestamp`, and `webhook-signature` with
/// the HMAC-SHA256 of `ID.TIMESTAMP.BODY`. Any answer 2xx within ten seconds accepts the message. Otherwise, also after
/// an answer 3xx, which is not followed, the message is tried again after 1, 2, 4 … 300 seconds, twenty times in all;
/// then it is given up and listed in `failures`, and the next one is sent. A message that is tried again has the same
/// events and `webhook-id`. After a kill of the server, events may be sent again, perhaps together with later ones:
/// skip numbers that you have already received.
#[utoipa::path(post, path = "/v1/webhooks", tag = "events", operation_id = "addWebhook", request_body = NewWebhook,
    params(("Idempotency-Key" = Option<String>, Header,
        description = "Your own key, up to 255 characters: a repeat gets the same answer and makes nothing")),
    responses(
    (status = 201, description = "From now on it is told; the secret is not shown again", body = WebhookDto),
    (status = 429, description = "There are too many")))]
pub async fn add(
    State(api): State<Api>,
    JsonBody(new): JsonBody<NewWebhook>,
) -> Result<(StatusCode, Json<WebhookDto>), Problem> {
    let (kinds, secret) = check(&new)?;
    check_target(&api, &new.url).await?;
    if ask(&api, HookRequest::List).await?.len() >= MOST_HOOKS {
        return Err(Problem::no_room(requests::too_many_webhooks(MOST_HOOKS)));
    }
    let told = secret.clone();
    let hook = ask(&api, |reply| HookRequest::Add(new.url, kinds, secret, reply)).await?;
    Ok((StatusCode::CREATED, Json(WebhookDto { secret: Some(told), ..dto(hook) })))
}

/// Remove a webhook: the system receives no more events.
#[utoipa::path(delete, path = "/v1/webhooks/{id}", tag = "events", operation_id = "removeWebhook",
    params(("id" = String, Path, example = "h1")), responses(
    (status = 204, description = "It is told nothing any more"),
    (status = 409, description = "A recording is shown")))]
pub async fn remove(State(api): State<Api>, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    let number = parse(&id)?;
    match ask(&api, |reply| HookRequest::Remove(number, reply)).await? {
        true => Ok(StatusCode::NO_CONTENT),
        false => Err(unknown(&id)),
    }
}

/// List the messages to a system that were given up, newest first; the last thousand are kept.
#[utoipa::path(get, path = "/v1/webhooks/{id}/failures", tag = "events", operation_id = "listWebhookFailures",
    params(("id" = String, Path, example = "h1"), FailureParams), responses(
    (status = 200, description = "What was given up", body = Page<FailedMessageDto>)))]
pub async fn failures(
    State(api): State<Api>,
    PathPart(id): PathPart,
    Params(p): Params<FailureParams>,
) -> Result<Json<Page<FailedMessageDto>>, Problem> {
    let limit = checked_limit(p.limit, 50)?;
    let wrong = || Problem::invalid(vec![FieldError::new("cursor", requests::not_a_cursor())]);
    let before = p.cursor.map(|text| text.parse::<i64>().map_err(|_| wrong())).transpose()?;
    let number = parse(&id)?;
    let found = ask(&api, |reply| HookRequest::Failures(number, before, limit + 1, reply)).await?;
    let mut found = found.ok_or_else(|| unknown(&id))?;
    let more = found.len() > limit as usize;
    found.truncate(limit as usize);
    let next = found.last().filter(|_| more).map(|failed| failed.id.to_string());
    Ok(Json(Page { items: found.into_iter().map(failed).collect(), next }))
}

async fn ask<T>(api: &Api, request: impl FnOnce(HookReply<T>) -> HookRequest) -> Result<T, Problem> {
    let queue = &access(api)?.queue;
    let (reply, answer) = oneshot::channel();
    let busy = || Problem::unavailable(requests::busy(), 1);
    queue.try_send(request(reply)).map_err(|_| busy())?;
    answer.await.map_err(|_| busy())?.map_err(Problem::of_records)
}

fn access(api: &Api) -> Result<&WebhookAccess, Problem> {
    api.hooks.as_ref().ok_or_else(Problem::of_recording)
}

/// Refuses an address that webhooks must not have.
async fn check_target(api: &Api, url: &str) -> Result<(), Problem> {
    let Ok(uri) = url.parse::<Uri>() else { return Ok(()) };
    let usual = if uri.scheme_str() == Some("http") { 80 } else { 443 };
    let port = uri.port_u16().unwrap_or(usual);
    let checked = access(api)?.targets.check(uri.host().unwrap_or_default(), port).await;
    checked.map_err(|why| Problem::invalid(vec![FieldError::new("url", requests::malformed(why))]))
}

/// The kinds and the secret of a new webhook.
fn check(new: &NewWebhook) -> Result<(Vec<EventKind>, String), Problem> {
    let mut errors = Vec::new();
    let host = new.url.parse::<Uri>().ok().filter(|uri| {
        matches!(uri.scheme_str(), Some("http" | "https")) && uri.host().is_some_and(|host| !host.is_empty())
    });
    if host.is_none() || new.url.len() > LONGEST_URL {
        errors.push(FieldError::new(
            "url",
            requests::malformed("give an address such as https://wms.example/giveway"),
        ));
    }
    let mut kinds = Vec::new();
    for word in &new.kinds {
        match EventKind::of_word(word) {
            Some(kind) => kinds.push(kind),
            None => {
                let known = EventKind::ALL.map(EventKind::word).to_vec();
                errors.push(FieldError::new("kinds", requests::not_one_of(word, known)));
            }
        }
    }
    if new.secret.as_deref().is_some_and(|secret| read_secret(secret).is_none()) {
        let detail = requests::malformed("give whsec_ and 24 to 64 bytes in base64, or leave it out");
        errors.push(FieldError::new("secret", detail));
    }
    if errors.is_empty() {
        Ok((kinds, new.secret.clone().unwrap_or_else(new_secret)))
    } else {
        Err(Problem::invalid(errors))
    }
}

fn parse(id: &str) -> Result<i64, Problem> {
    id.strip_prefix('h').and_then(|digits| digits.parse().ok()).ok_or_else(|| unknown(id))
}

fn unknown(id: &str) -> Problem {
    Problem::unknown("webhook", requests::no_such_thing("webhook", id, "/v1/webhooks"))
}

fn dto(hook: Webhook) -> WebhookDto {
    WebhookDto {
        id: format!("h{}", hook.id),
        url: hook.url,
        kinds: hook.kinds.into_iter().map(EventKind::word).collect(),
        created: time_text(hook.created),
        cursor: hook.cursor,
        attempts: hook.attempts,
        failing: hook.failed,
        secret: None,
    }
}

fn failed(message: FailedMessage) -> FailedMessageDto {
    let (first, last) = message.events;
    FailedMessageDto {
        first,
        last,
        at: time_text(message.at),
        attempts: message.attempts,
        error: message.error,
    }
}
