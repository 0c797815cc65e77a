//! `GET /v1/kinds`: the kinds of robots that may join.
//!
//! Main type: [`KindDto`]. Refuses: to change any; they are the scenario's.

use crate::api::Api;
use crate::fleet::RobotKind;
use crate::warehouse::Footprint;
use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

/// A robot kind. Lengths are in metres, times in seconds.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct KindDto {
    /// Its name: `kind` of POST /v1/robots.
    #[schema(example = "shuttle")]
    pub name: String,
    /// Its outline without a rack; null if it is the square that the map gives.
    pub footprint: Option<FootprintDto>,
    /// Its outline with a rack; null if it is the square that the map gives.
    pub footprint_loaded: Option<FootprintDto>,
    /// Whether it turns to face the direction in which it drives.
    pub turns: bool,
    /// The types of racks that it carries; null for all.
    pub carries: Option<Vec<String>>,
    /// The heaviest rack that it carries, kilograms; null for any.
    pub payload_kg: Option<f64>,
    /// Top speed without a rack, metres per second.
    pub speed_mps: f64,
    /// Top speed with a rack.
    pub speed_loaded_mps: f64,
    /// Acceleration and braking without a rack, metres per second squared.
    pub accel_unloaded_mps2: f64,
    /// Acceleration and braking with a rack.
    pub accel_loaded_mps2: f64,
    /// How long it takes to lift a rack, or to set it down.
    pub lift_s: f64,
    /// Below this charge, 0 to 1, it takes no job.
    pub critical: f64,
    /// Hours of driving on a full charge.
    pub driving_h: f64,
}

/// An outline around the point on which the robot turns.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FootprintDto {
    /// The side of a square along the map's axes.
    SquareM(f64),
    /// The radius of a disc.
    CircleM(f64),
    /// Corners, x ahead and y to the left.
    PolygonM(Vec<[f64; 2]>),
}

/// The robot kinds that may join. They come from the scenario with which the server was started.
#[utoipa::path(get, path = "/v1/kinds", tag = "floor", responses(
    (status = 200, description = "All kinds", body = Vec<KindDto>)))]
pub async fn kinds(State(api): State<Api>) -> Json<Vec<KindDto>> {
    Json(api.kinds.iter().map(KindDto::from).collect())
}

impl From<&RobotKind> for KindDto {
    fn from(k: &RobotKind) -> KindDto {
        let [footprint, footprint_loaded] =
            k.footprints.each_ref().map(|f| f.as_ref().map(FootprintDto::from));
        let figures = k.kinematics;
        KindDto {
            name: k.name.clone(),
            footprint,
            footprint_loaded,
            turns: figures.turn_radps.is_finite(),
            carries: k.carries.clone(),
            payload_kg: Some(k.payload_kg).filter(|kg| kg.is_finite()),
            speed_mps: figures.speed_mps,
            speed_loaded_mps: figures.speed_loaded_mps,
            accel_unloaded_mps2: figures.accel_unloaded_mps2,
            accel_loaded_mps2: figures.accel_loaded_mps2,
            lift_s: figures.lift.as_secs_f64(),
            critical: k.charging.critical,
            driving_h: k.charging.driving_h,
        }
    }
}

impl From<&Footprint> for FootprintDto {
    fn from(f: &Footprint) -> FootprintDto {
        match f {
            Footprint::Square { side_m } => FootprintDto::SquareM(*side_m),
            Footprint::Circle { radius_m } => FootprintDto::CircleM(*radius_m),
            Footprint::Polygon { corners, .. } => {
                FootprintDto::PolygonM(corners.iter().map(|c| [c.x, c.y]).collect())
            }
        }
    }
}
