//! Requests that are answered with 204 once they are durable.
//!
//! Main function: [`done`]. Refuses: to answer earlier.

use crate::state::api::Api;
use crate::wire::error::Problem;
use axum::http::StatusCode;
use giveway_fleet::Ask;

/// Sends a request to the fleet; answers 204 or the refusal.
pub async fn done(api: &Api, ask: Ask<()>) -> Result<StatusCode, Problem> {
    api.ask(ask).await?;
    Ok(StatusCode::NO_CONTENT)
}
