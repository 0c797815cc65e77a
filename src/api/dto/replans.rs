//! The causes of replanning, on the wire.
//!
//! Main types: [`ReplannedDto`], [`ReplanCauseDto`]. Refuses: to determine the cause; the fleet does.

use serde::Serialize;
use utoipa::ToSchema;

/// What caused a robot's new route.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ReplanCauseDto {
    /// The kind of cause: worker, closure, robot (it cannot drive, or was pushed into the way) or obstruction.
    #[schema(example = "worker")]
    pub kind: &'static str,
    /// The worker, closure or robot; null for an obstruction, which has no id.
    #[schema(example = "w1")]
    pub id: Option<String>,
}

/// A replanning of a robot's route.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ReplannedDto {
    /// What caused the replanning.
    #[serde(flatten)]
    pub cause: ReplanCauseDto,
    /// When the route was replanned, RFC 3339.
    pub at: String,
}
