//! Webhooks: requests to manage them, the message with some events, and its signature.
//!
//! Main types: [`Webhook`], [`HookRequest`], [`Taken`]; main functions: [`message`], [`signature`]. Messages and
//! headers follow the Standard Webhooks specification 1.0.0 (standardwebhooks.com). Refuses: to send anything.

use super::targets::Targets;
use crate::access::caller::Role;
use crate::dto::events::event;
use crate::dto::names::Names;
use axum::http::StatusCode;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use giveway_fleet::{EventKind, EventRow};
use giveway_floor::time::Time;
use hmac::{Hmac, Mac};
use serde_json::json;
use sha2::Sha256;
use tokio::sync::{mpsc, oneshot};

/// The prefix of a secret in base64.
pub const SECRET_PREFIX: &str = "whsec_";

/// Access to webhooks for the handlers of requests.
#[derive(Clone, Debug)]
pub struct WebhookAccess {
    /// The queue for requests about webhooks.
    pub queue: mpsc::Sender<HookRequest>,
    /// Where webhooks may be sent.
    pub targets: Targets,
}

/// Proof that a receiver accepted a message. Only an answer with a status of 200 to 299 creates one.
#[derive(Debug)]
pub struct Taken(());

impl Taken {
    /// Whether an answer with this status means that the message was accepted.
    ///
    /// # Errors
    /// If the message was not accepted; the text names the status.
    pub fn of(status: StatusCode) -> Result<Taken, String> {
        if status.is_success() {
            return Ok(Taken(()));
        }
        let more = if status.is_redirection() {
            "; redirects are not followed: add the webhook again with the address where it leads"
        } else {
            ""
        };
        Err(format!("it answered {status}, and only 200 to 299 takes a message{more}"))
    }
}

/// A webhook, without its secret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Webhook {
    /// The webhook's number.
    pub id: i64,
    /// The address, without user and password.
    pub url: String,
    /// The kinds of events that are sent; empty for all kinds.
    pub kinds: Vec<EventKind>,
    /// When the webhook was added.
    pub created: Time,
    /// The number of the last event that was delivered or given up.
    pub cursor: i64,
    /// How often sending the next message has failed.
    pub attempts: u32,
    /// Why the last attempt failed.
    pub failed: Option<String>,
}

/// A message that was given up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedMessage {
    /// The message's number.
    pub id: i64,
    /// The numbers of the message's first and last events.
    pub events: (i64, i64),
    /// When the message was given up.
    pub at: Time,
    /// How often the message was tried.
    pub attempts: u32,
    /// Why the last attempt failed.
    pub error: String,
}

/// An answer about webhooks. Errors are texts for people.
pub type HookReply<T> = oneshot::Sender<Result<T, String>>;

/// A request about webhooks.
#[derive(Debug)]
pub enum HookRequest {
    /// List all webhooks.
    List(HookReply<Vec<Webhook>>),
    /// Add a webhook: address, kinds, and secret.
    Add(String, Vec<EventKind>, String, HookReply<Webhook>),
    /// Remove a webhook; the answer is whether there was one of this number.
    Remove(i64, HookReply<bool>),
    /// List the given-up messages of a webhook: before a number, and at most this many; nothing if there is no such
    /// webhook.
    Failures(i64, Option<i64>, u32, HookReply<Option<Vec<FailedMessage>>>),
}

/// The secret in a text such as `whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw`: 24 to 64 bytes.
pub fn read_secret(text: &str) -> Option<Vec<u8>> {
    let bytes = STANDARD.decode(text.strip_prefix(SECRET_PREFIX)?).ok()?;
    (24..=64).contains(&bytes.len()).then_some(bytes)
}

/// A new random secret.
pub fn new_secret() -> String {
    let (a, b) = (uuid::Uuid::new_v4(), uuid::Uuid::new_v4());
    format!("{SECRET_PREFIX}{}", STANDARD.encode([a.into_bytes(), b.into_bytes()].concat()))
}

/// The body of a message, with everything that an administrator may see: only administrators add webhooks.
pub fn message(names: Names<'_>, rows: Vec<EventRow>) -> String {
    let events: Vec<_> = rows.into_iter().map(|row| event(names, Role::Admin, row)).collect();
    json!({"type": "giveway.events", "timestamp": events.last().map(|e| e.at.clone()), "data": {"events": events}})
        .to_string()
}

/// The header `webhook-signature`: HMAC-SHA256 over id, seconds since 1970 and body.
pub fn signature(secret: &[u8], id: &str, seconds: i64, body: &str) -> String {
    let mut mac = Hmac::<Sha256>::new_from_slice(secret).expect("HMAC takes keys of any length");
    mac.update(format!("{id}.{seconds}.{body}").as_bytes());
    format!("v1,{}", STANDARD.encode(mac.finalize().into_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example from the specification's reference libraries.
    #[test]
    fn a_message_is_signed_as_the_specification_says() {
        let secret = read_secret("whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw").unwrap();
        let signed =
            signature(&secret, "msg_p5jXN8AQM9LWM0D4loKWxJek", 1_614_265_330, r#"{"test": 2432232314}"#);
        assert_eq!(signed, "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=");
    }

    #[test]
    fn secrets_are_long_enough_and_new_ones_can_be_read() {
        assert_eq!(read_secret(&new_secret()).map(|s| s.len()), Some(32));
        for wrong in ["", "MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw", "whsec_c2hvcnQ=", "whsec_?"] {
            assert_eq!(read_secret(wrong), None, "{wrong}");
        }
    }
}
