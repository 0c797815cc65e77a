//! Because of whom or what robots got another way, as it travels.
//!
//! Main types: [`ReplannedDto`], [`ReplanCauseDto`]. Refuses: to find that out, which the fleet does.

use serde::Serialize;
use utoipa::ToSchema;

/// Because of whom or what a robot got another way.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ReplanCauseDto {
    /// worker, closure, robot (it cannot drive, or was pushed onto the way) or obstruction.
    #[schema(example = "worker")]
    pub kind: &'static str,
    /// The worker, closure or robot; null for an obstruction, which nobody knows.
    #[schema(example = "w1")]
    pub id: Option<String>,
}

/// That a robot got another way.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ReplannedDto {
    /// Because of whom or what.
    #[serde(flatten)]
    pub cause: ReplanCauseDto,
    /// When, RFC 3339.
    pub at: String,
}
