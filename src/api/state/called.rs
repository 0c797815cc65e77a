//! The shared state with the caller of one request.
//!
//! Main type: [`Called`]. Refuses: to check anything; the layer around the routes has done that.

use crate::access::audit::AuditEntry;
use crate::access::caller::Caller;
use crate::state::api::Api;
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use std::convert::Infallible;
use std::sync::Arc;

/// The shared state, with the caller of this request.
pub struct Called(pub Api);

impl FromRequestParts<Api> for Called {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, api: &Api) -> Result<Self, Infallible> {
        let mut api = api.clone();
        if let Some(caller) = parts.extensions.get::<Arc<Caller>>() {
            api.caller = caller.clone();
        }
        api.entry = parts.extensions.get::<Arc<AuditEntry>>().cloned();
        Ok(Called(api))
    }
}
