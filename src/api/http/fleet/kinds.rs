//! `GET /v1/kinds`, `PUT` and `DELETE /v1/kinds/{name}`: the robot kinds of the site and those that were added.
//!
//! Main types: [`KindDto`], [`NewKind`]. An added kind is valid at once. Whether the map suits a kind is checked in the
//! background (`state/kind_checks.rs`); the fleet decides everything else. Refuses: to change kinds of the site, and
//! kinds that robots have.

use crate::dto::refusal::{about_kinds, refused};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, PathPart};
use axum::Json;
use axum::http::StatusCode;
use giveway_fleet::{Ask, Capabilities, ObeyedLimits, Refusal, RobotKind, RobotKinds};
use giveway_floor::text::sentence::requests;
use giveway_floor::warehouse::Footprint;
use giveway_site::{SiteError, read_kind};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The longest name of a kind, in characters.
const LONGEST_NAME: usize = 50;

/// A robot kind. Lengths are in metres, times in seconds.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct KindDto {
    /// The kind's name: `kind` of POST /v1/robots.
    #[schema(example = "shuttle")]
    pub name: String,
    /// Whether the kind was added, and so may be replaced or removed; false for kinds of the site or scenario.
    pub added: bool,
    /// Outline of a robot without a rack; null if it is the square that the map gives.
    pub footprint: Option<FootprintDto>,
    /// Outline of a robot with a rack; null if it is the square that the map gives.
    pub footprint_loaded: Option<FootprintDto>,
    /// Whether robots turn to face the direction in which they drive.
    pub turns: bool,
    /// The types of racks that robots carry; null for all.
    pub carries: Option<Vec<String>>,
    /// The heaviest rack that robots carry, kilograms; null for any.
    pub payload_kg: Option<f64>,
    /// Whether robots may leave the line of a lane that has a corridor, to pass people.
    pub free_navigation: bool,
    /// What robots can do besides driving to granted nodes.
    pub can: CapabilitiesDto,
    /// Top speed without a rack, metres per second.
    pub speed_mps: f64,
    /// Top speed with a rack, metres per second.
    pub speed_loaded_mps: f64,
    /// Acceleration and braking without a rack, metres per second squared.
    pub accel_unloaded_mps2: f64,
    /// Acceleration and braking with a rack, metres per second squared.
    pub accel_loaded_mps2: f64,
    /// Speed of turning in place, radians per second; null if robots do not turn.
    pub turn_radps: Option<f64>,
    /// How long lifting a rack or setting it down takes, seconds.
    pub lift_s: f64,
    /// Charge below which a robot takes no job, 0 to 1.
    pub critical: f64,
    /// Hours of driving on a full charge.
    pub driving_h: f64,
}

/// The figures of a robot kind, with the keys of `fleet` in scenarios; figures that are left out have their usual
/// values.
#[derive(Clone, Debug, Default, Deserialize, Serialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NewKind {
    /// Top speed without a rack, metres per second, 0.1 to 5.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(example = 2.0)]
    speed_mps: Option<f64>,
    /// Top speed with a rack, metres per second; `speed_mps` if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    speed_loaded_mps: Option<f64>,
    /// Acceleration and braking without a rack, metres per second squared, 0.05 to 5.
    #[serde(skip_serializing_if = "Option::is_none")]
    accel_unloaded_mps2: Option<f64>,
    /// Acceleration and braking with a rack, metres per second squared, 0.05 to 5.
    #[serde(skip_serializing_if = "Option::is_none")]
    accel_loaded_mps2: Option<f64>,
    /// Speed of turning in place, radians per second, 0.1 to 10; not for omnidirectional robots.
    #[serde(skip_serializing_if = "Option::is_none")]
    turn_radps: Option<f64>,
    /// How long lifting a rack or setting it down takes, seconds, 0 to 60.
    #[serde(skip_serializing_if = "Option::is_none")]
    lift_s: Option<f64>,
    /// When robots charge.
    #[serde(skip_serializing_if = "Option::is_none")]
    battery: Option<NewBattery>,
    /// Outline of a robot without a rack; the square of the map if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    footprint: Option<FootprintDto>,
    /// Outline of a robot with a rack; the square of the map if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    footprint_loaded: Option<FootprintDto>,
    /// How robots drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    drive: Option<DriveDto>,
    /// The types of racks that robots carry; all if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    carries: Option<Vec<String>>,
    /// The heaviest rack that robots carry, kilograms; any if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    payload_kg: Option<f64>,
    /// Whether robots may leave the line of a lane that has a corridor, to pass people; false if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    free_navigation: Option<bool>,
    /// What robots can do besides driving to granted nodes; everything if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    can: Option<NewCapabilities>,
}

/// What robots of a kind can do besides driving to granted nodes.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CapabilitiesDto {
    /// Whether a standing robot drops its grants when it is told to, and reports how often it has.
    pub revocation: bool,
    /// The speed limits that a robot obeys within its grants.
    pub limits: LimitsDto,
    /// Whether a robot between two nodes can drive back to the node from which it came.
    pub drives_back: bool,
    /// How many nodes beyond the granted ones a robot's orders show (its horizon).
    pub horizon_nodes: usize,
}

/// What robots of a kind can do; abilities that are left out are present.
#[derive(Clone, Debug, Default, Deserialize, Serialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NewCapabilities {
    /// Whether a standing robot drops its grants when it is told to; true if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    revocation: Option<bool>,
    /// The speed limits that a robot obeys within its grants; any speed if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    limits: Option<LimitsDto>,
    /// Whether a robot between two nodes can drive back to the node from which it came; true if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    drives_back: Option<bool>,
    /// How many nodes beyond the granted ones a robot's orders show (its horizon), 0 to 100; 0 if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(maximum = 100)]
    horizon_nodes: Option<usize>,
}

/// Charging thresholds of robots, as shares of a full charge; each from the previous one to 1.
#[derive(Clone, Debug, Default, Deserialize, Serialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NewBattery {
    /// Below this charge a robot takes no job and charges before all others.
    #[serde(skip_serializing_if = "Option::is_none")]
    critical: Option<f64>,
    /// Below this charge an idle robot charges before it takes a job.
    #[serde(skip_serializing_if = "Option::is_none")]
    low: Option<f64>,
    /// From this charge on, a robot at a charger takes jobs.
    #[serde(skip_serializing_if = "Option::is_none")]
    enough: Option<f64>,
    /// From this charge on, an idle robot does not go to a charger.
    #[serde(skip_serializing_if = "Option::is_none")]
    full: Option<f64>,
    /// Whether idle robots above `low` use chargers that are free.
    #[serde(skip_serializing_if = "Option::is_none")]
    opportunity: Option<bool>,
    /// Hours of driving on a full charge, 0.01 to 1000.
    #[serde(skip_serializing_if = "Option::is_none")]
    driving_h: Option<f64>,
}

/// The speed limits that a robot obeys within its grants.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitsDto {
    /// Any speed, and a stop.
    Speed,
    /// Only a stop.
    Stop,
    /// None: the robot is granted one node at a time.
    None,
}

/// How a robot drives.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DriveDto {
    /// The robot turns to face the direction in which it drives.
    Differential,
    /// The robot drives in any direction.
    Omnidirectional,
}

/// An outline around the point on which the robot turns; lengths in metres.
#[derive(Clone, Debug, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FootprintDto {
    /// The side of a square along the map's axes.
    SquareM(f64),
    /// The radius of a disc.
    CircleM(f64),
    /// Corners, x ahead and y to the left.
    PolygonM(Vec<[f64; 2]>),
}

/// List all robot kinds: those of the site or scenario with which the server was started, and those that were added.
#[utoipa::path(get, path = "/v1/kinds", tag = "floor", operation_id = "listKinds", responses(
    (status = 200, description = "All kinds", body = Vec<KindDto>)))]
pub async fn kinds(Called(api): Called) -> Json<Vec<KindDto>> {
    let kinds = api.moment().view.all_kinds.clone();
    Json(kinds.iter().map(|kind| KindDto::new(kind, !kinds.is_of_site(&kind.name))).collect())
}

/// Add a robot kind beside those of the site or scenario, or replace an added one that no robot has. Robots of this
/// kind may join at once.
#[utoipa::path(put, path = "/v1/kinds/{name}", tag = "floor", operation_id = "putKind", request_body = NewKind,
    params(("name" = String, Path, example = "shuttle")), responses(
    (status = 201, description = "Robots of it may join, and that is durable", body = KindDto),
    (status = 200, description = "It is so, in place of the one of its name, and that is durable", body = KindDto),
    (status = 409, description = "The site or scenario has one of this name, or robots are of it"),
    (status = 422, description = "A figure cannot be, or the map was not drawn for such robots"),
    (status = 429, description = "There are as many as a floor may have")))]
pub async fn put(
    Called(api): Called,
    PathPart(name): PathPart,
    JsonBody(new): JsonBody<NewKind>,
) -> Result<(StatusCode, Json<KindDto>), Problem> {
    if let Some(wrong) = FieldError::of_plain_name(&name, LONGEST_NAME) {
        return Err(Problem::invalid(vec![wrong]));
    }
    api.queue()?;
    let figures = serde_json::to_string(&new).expect("figures are JSON");
    let kind = read_kind(&name, &figures).map_err(|why| of_figures(&why))?;
    let (building, kinds) = (api.moment().view.building.0.clone(), api.moment().view.all_kinds.clone());
    if let Some(building) = building.filter(|_| is_to_be_checked(&kinds, &kind)) {
        api.kind_checks.check(building, kind.clone()).await?;
    }
    let made = ask(&api, Ask::put_kind(kind.clone()), &name).await?;
    let status = if made.new { StatusCode::CREATED } else { StatusCode::OK };
    Ok((status, Json(KindDto::new(&kind, true))))
}

/// Remove a robot kind that was added and that no robot has. No robot of this kind can join any more.
#[utoipa::path(delete, path = "/v1/kinds/{name}", tag = "floor", operation_id = "removeKind",
    params(("name" = String, Path, example = "shuttle")), responses(
    (status = 204, description = "It is removed, and that is durable"),
    (status = 404, description = "No kind of this name was added"),
    (status = 409, description = "The site or scenario has it, or robots are of it")))]
pub async fn remove(Called(api): Called, PathPart(name): PathPart) -> Result<StatusCode, Problem> {
    ask(&api, Ask::remove_kind(name.clone()), &name).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Whether the map must be checked for a kind: not for a kind of the site, which is refused, nor for an unchanged kind.
fn is_to_be_checked(kinds: &RobotKinds, kind: &RobotKind) -> bool {
    !kinds.is_of_site(&kind.name) && kinds.named(&kind.name) != Some(kind)
}

/// Sends a request to the fleet; a refusal names the kind.
async fn ask<A>(api: &Api, ask: Ask<A>, name: &str) -> Result<A, Problem> {
    api.answer_to(ask).await?.map_err(|why| match why {
        Refusal::Kind(why) => about_kinds(why, name),
        other => refused(&api.map, other),
    })
}

/// The problem of an invalid figure, with its key.
fn of_figures(why: &SiteError) -> Problem {
    let (key, detail) = match why {
        SiteError::Number { key, found, wanted } => {
            let key = key.strip_prefix("kind.").unwrap_or(key).to_owned();
            (key, format!("is {found}, but must be {wanted}"))
        }
        SiteError::Wrong { key, message } => ((*key).to_owned(), message.clone()),
        SiteError::Syntax { message, .. } => ("kind".to_owned(), message.clone()),
    };
    Problem::invalid(vec![FieldError::new(key, requests::malformed(detail))])
}

impl KindDto {
    fn new(k: &RobotKind, added: bool) -> KindDto {
        let [footprint, footprint_loaded] =
            k.footprints.each_ref().map(|f| f.as_ref().map(FootprintDto::from));
        let figures = k.kinematics;
        KindDto {
            name: k.name.clone(),
            added,
            footprint,
            footprint_loaded,
            turns: figures.turn_radps.is_finite(),
            carries: k.carries.clone(),
            payload_kg: Some(k.payload_kg).filter(|kg| kg.is_finite()),
            free_navigation: k.free_navigation,
            can: k.capabilities.into(),
            speed_mps: figures.speed_mps,
            speed_loaded_mps: figures.speed_loaded_mps,
            accel_unloaded_mps2: figures.accel_unloaded_mps2,
            accel_loaded_mps2: figures.accel_loaded_mps2,
            turn_radps: Some(figures.turn_radps).filter(|turn| turn.is_finite()),
            lift_s: figures.lift.as_secs_f64(),
            critical: k.charging.critical,
            driving_h: k.charging.driving_h,
        }
    }
}

impl From<Capabilities> for CapabilitiesDto {
    fn from(c: Capabilities) -> CapabilitiesDto {
        let Capabilities { revocation, limits, drives_back, horizon_nodes } = c;
        let limits = match limits {
            ObeyedLimits::Speeds => LimitsDto::Speed,
            ObeyedLimits::Stops => LimitsDto::Stop,
            ObeyedLimits::Nothing => LimitsDto::None,
        };
        CapabilitiesDto { revocation, limits, drives_back, horizon_nodes }
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
