//! Errors on the wire: RFC 9457 problems that say what happened and what to do.
//!
//! Main types: [`Problem`], [`FieldError`], [`SecretDoor`]. Use a constructor by status; every one takes a sentence of
//! `text/sentence`. Server faults are logged where they are made, and nowhere else. Refuses: to show internals.

use crate::wire::sentence::SentenceArgsSchema;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use giveway_floor::text::sentence::requests;
use giveway_floor::text::{Sentence, SentenceArg, SentenceArgs};
use serde::Serialize;
use utoipa::ToSchema;

/// How a client showed a secret.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SecretDoor {
    /// In the header `Authorization`, or offered by a WebSocket.
    Token,
    /// In the body of a request that signs in.
    SignIn,
    /// As the cookie of a session.
    Cookie,
}

impl SecretDoor {
    /// The wrong secret in words, for the audit.
    pub fn words(self) -> &'static str {
        match self {
            SecretDoor::Token => "wrong token",
            SecretDoor::SignIn => "wrong token when signing in",
            SecretDoor::Cookie => "wrong cookie of a session",
        }
    }
}

/// An error as `application/problem+json` (RFC 9457).
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct Problem {
    /// A name for this kind of error that never changes, such as `/problems/unknown-rack`.
    #[serde(rename = "type")]
    #[schema(value_type = String)]
    pub kind: Box<str>,
    /// The kind of error in words.
    pub title: &'static str,
    /// The HTTP status.
    #[schema(example = 422, minimum = 400, maximum = 599)]
    pub status: u16,
    /// What happened here, and what to do, in English.
    #[schema(value_type = String)]
    pub detail: Box<str>,
    /// The code of the sentence in `detail`.
    #[schema(value_type = String, example = "no_such_thing")]
    pub code: Option<&'static str>,
    /// The values for the placeholders of the sentence.
    #[schema(value_type = SentenceArgsSchema)]
    pub args: SentenceArgs,
    /// The path of the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, nullable = false)]
    pub instance: Option<Box<str>>,
    /// The wrong fields; left out if no field is wrong.
    #[serde(skip_serializing_if = "is_none")]
    #[schema(value_type = Vec<FieldError>)]
    pub errors: Box<[FieldError]>,
    /// Seconds after which a retry makes sense.
    #[serde(skip)]
    pub retry_after: Option<u16>,
    /// How the client showed a wrong secret, if that is the problem: the layer that answers delays such answers.
    #[serde(skip)]
    pub wrong_secret: Option<SecretDoor>,
}

/// A wrong field.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct FieldError {
    /// The field's name.
    pub field: String,
    /// What is wrong, and what would be right, in English.
    pub detail: String,
    /// The code of the sentence in `detail`.
    #[schema(value_type = String, example = "priority_out_of_range")]
    pub code: Option<&'static str>,
    /// The values for the placeholders of the sentence.
    #[schema(value_type = SentenceArgsSchema)]
    pub args: SentenceArgs,
}

fn is_none(errors: &[FieldError]) -> bool {
    errors.is_empty()
}

impl FieldError {
    /// An error in this field.
    pub fn new(field: impl Into<String>, detail: Sentence) -> FieldError {
        let (code, args, detail) = detail.into_parts();
        FieldError { field: field.into(), detail, code, args }
    }

    /// What is wrong, as a sentence.
    pub fn sentence(&self) -> Sentence {
        Sentence::from_parts(self.code, self.args.clone(), self.detail.clone())
    }

    /// The error in a machine's `name`, if it has any: a name has 1 to `longest` letters, digits, `-`, `_` and `.`.
    pub fn of_plain_name(name: &str, longest: usize) -> Option<FieldError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        let fits = (1..=longest).contains(&name.len()) && name.chars().all(plain);
        (!fits).then(|| FieldError::new("name", requests::plain_name(longest)))
    }
}

impl Problem {
    /// A problem of this kind, `kind` being the last part of its type.
    pub fn new(status: StatusCode, kind: &str, title: &'static str, detail: Sentence) -> Problem {
        let (code, args, detail) = detail.into_parts();
        Problem {
            kind: format!("/problems/{kind}").into(),
            title,
            status: status.as_u16(),
            detail: detail.into(),
            code,
            args,
            instance: None,
            errors: Box::default(),
            retry_after: None,
            wrong_secret: None,
        }
    }

    /// What happened, as a sentence.
    pub fn sentence(&self) -> Sentence {
        Sentence::from_parts(self.code, self.args.clone(), self.detail.clone().into())
    }

    /// 400: the request cannot be read; `detail` is for developers.
    pub fn malformed(detail: impl Into<SentenceArg>) -> Problem {
        let detail = requests::malformed(detail);
        Problem::new(StatusCode::BAD_REQUEST, "malformed", "The request cannot be read", detail)
    }

    /// 401: the client showed a wrong secret, in this way.
    pub fn wrong_secret(door: SecretDoor, title: &'static str, detail: Sentence) -> Problem {
        let problem = Problem::new(StatusCode::UNAUTHORIZED, "unauthorized", title, detail);
        Problem { wrong_secret: Some(door), ..problem }
    }

    /// 404: there is no such thing.
    pub fn unknown(what: &str, detail: Sentence) -> Problem {
        Problem::new(StatusCode::NOT_FOUND, &format!("unknown-{what}"), "Not found", detail)
    }

    /// 409: impossible in the current state.
    pub fn conflict(kind: &str, title: &'static str, detail: Sentence) -> Problem {
        Problem::new(StatusCode::CONFLICT, kind, title, detail)
    }

    /// 422: readable, but some fields are wrong.
    pub fn invalid(errors: Vec<FieldError>) -> Problem {
        let detail: Vec<_> =
            errors.iter().map(|e| requests::field_is_wrong(&e.field, e.sentence())).collect();
        let detail = requests::fields_are_wrong(detail);
        let status = StatusCode::UNPROCESSABLE_ENTITY;
        Problem { errors: errors.into(), ..Problem::new(status, "invalid", "Some fields are wrong", detail) }
    }

    /// 400: order lines that cannot be picked.
    pub fn bad_lines(errors: Vec<FieldError>) -> Problem {
        let title = "Lines that cannot be picked";
        let status = StatusCode::BAD_REQUEST.as_u16();
        Problem { status, kind: "/problems/bad-lines".into(), title, ..Problem::invalid(errors) }
    }

    /// 409: nothing in a recording can be changed.
    pub fn of_recording() -> Problem {
        Problem::conflict("recording", "This is a recording", requests::of_recording())
    }

    /// 429: a limit is reached, and only people can make room.
    pub fn no_room(detail: Sentence) -> Problem {
        Problem::new(StatusCode::TOO_MANY_REQUESTS, "too-many", "A limit is reached", detail)
    }

    /// 429: a limit is reached, for a while.
    pub fn too_many(detail: Sentence, retry_after: u16) -> Problem {
        Problem { retry_after: Some(retry_after), ..Problem::no_room(detail) }
    }

    /// 503: temporarily unavailable.
    pub fn unavailable(detail: Sentence, retry_after: u16) -> Problem {
        let status = StatusCode::SERVICE_UNAVAILABLE;
        let problem = Problem::new(status, "unavailable", "The server cannot do this now", detail);
        Problem { retry_after: Some(retry_after), ..problem }
    }

    /// 503: the database does not answer; `why` is for operators.
    pub fn of_records(why: String) -> Problem {
        Problem::unavailable(requests::unavailable(why), 2)
    }

    /// 500: a bug in this program.
    pub fn internal() -> Problem {
        let detail = requests::internal_error();
        Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", "Internal server error", detail)
    }

    /// The problem with this path.
    pub fn at(self, path: &str) -> Problem {
        Problem { instance: Some(path.into()), ..self }
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let status = StatusCode::from_u16(self.status).expect("made from a status");
        let body = serde_json::to_vec(&self).expect("problems are plain");
        let mut response = (status, body).into_response();
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
        if let Some(seconds) = self.retry_after {
            headers.insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        if status == StatusCode::UNAUTHORIZED {
            headers.insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer realm=\"giveway\""));
        }
        // The layer that knows the path fills it in.
        response.extensions_mut().insert(self);
        response
    }
}
