//! `GET /v1/kinds`, `PUT` and `DELETE /v1/kinds/{name}`: the kinds of robots that may join, those of the scenario and
//! those that were added.
//!
//! Main types: [`KindDto`], [`NewKind`]. What is added or removed is so from the next start on: which places exclude
//! one another follows from the kinds, and the database is carried over to them. Refuses: to change kinds of the
//! scenario, and kinds that robots are of.

use crate::called::Called;
use crate::error::{FieldError, Problem};
use crate::extract::{JsonBody, PathPart};
use crate::port::{KindRefusal, KindRequest};
use crate::{Api, Kinds};
use axum::Json;
use axum::http::StatusCode;
use giveway_fleet::RobotKind;
use giveway_floor::text::sentence::requests;
use giveway_floor::warehouse::Footprint;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::sync::{MutexGuard, PoisonError};
use tokio::sync::oneshot;
use utoipa::ToSchema;

/// The longest name of a kind.
const LONGEST_NAME: usize = 50;

/// A robot kind. Lengths are in metres, times in seconds.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct KindDto {
    /// Its name: `kind` of POST /v1/robots.
    #[schema(example = "shuttle")]
    pub name: String,
    /// From when on, or until when, robots of it may join.
    pub valid: Validity,
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
    /// Whether it may leave the line of a lane that has a corridor, to pass people.
    pub free_navigation: bool,
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

/// When robots of a kind may join.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Validity {
    /// Now, and after the next start of the server.
    Now,
    /// From the next start of the server on.
    FromNextStart,
    /// No longer: it was removed, or replaced by another one of its name.
    UntilNextStart,
}

/// The figures of a robot kind, with the keys of `fleet` in scenarios; what is left out is as usual.
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
    /// Acceleration and braking with a rack.
    #[serde(skip_serializing_if = "Option::is_none")]
    accel_loaded_mps2: Option<f64>,
    /// How long it takes to lift a rack, or to set it down, seconds, 0 to 60.
    #[serde(skip_serializing_if = "Option::is_none")]
    lift_s: Option<f64>,
    /// When it charges.
    #[serde(skip_serializing_if = "Option::is_none")]
    battery: Option<NewBattery>,
    /// Its outline without a rack; the square of the map if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    footprint: Option<FootprintDto>,
    /// Its outline with a rack; the square of the map if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    footprint_loaded: Option<FootprintDto>,
    /// Whether it turns to face the direction in which it drives.
    #[serde(skip_serializing_if = "Option::is_none")]
    drive: Option<DriveDto>,
    /// The types of racks that it carries; all if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    carries: Option<Vec<String>>,
    /// The heaviest rack that it carries, kilograms; any if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    payload_kg: Option<f64>,
    /// Whether it may leave the line of a lane that has a corridor, to pass people; false if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    free_navigation: Option<bool>,
}

/// When robots of a kind charge, in shares of a full charge; each from the one before to 1.
#[derive(Clone, Debug, Default, Deserialize, Serialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NewBattery {
    /// Below this a robot takes no job and charges before all others.
    #[serde(skip_serializing_if = "Option::is_none")]
    critical: Option<f64>,
    /// Below this an idle robot charges before it takes a job.
    #[serde(skip_serializing_if = "Option::is_none")]
    low: Option<f64>,
    /// From this on a robot at a charger takes jobs.
    #[serde(skip_serializing_if = "Option::is_none")]
    enough: Option<f64>,
    /// From this on an idle robot does not go to a charger.
    #[serde(skip_serializing_if = "Option::is_none")]
    full: Option<f64>,
    /// Whether idle robots above `low` use chargers that are free.
    #[serde(skip_serializing_if = "Option::is_none")]
    opportunity: Option<bool>,
    /// Hours of driving on a full charge, 0.01 to 1000.
    #[serde(skip_serializing_if = "Option::is_none")]
    driving_h: Option<f64>,
}

/// How a robot drives.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DriveDto {
    /// It turns to face the direction in which it drives.
    Differential,
    /// It drives in any direction.
    Omnidirectional,
}

/// An outline around the point on which the robot turns.
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

/// All robot kinds: those of the scenario with which the server was started, and those that were added.
#[utoipa::path(get, path = "/v1/kinds", tag = "floor", operation_id = "listKinds", responses(
    (status = 200, description = "All kinds", body = Vec<KindDto>),
    (status = 503)))]
pub async fn kinds(Called(api): Called) -> Result<Json<Vec<KindDto>>, Problem> {
    let kinds = &api.kinds;
    let added = match &kinds.requests {
        Some(_) => kinds.ask("", KindRequest::List).await?,
        None => Vec::new(),
    };
    let stays = |k: &RobotKind| kinds.of_scenario.contains(k) || added.contains(k);
    let now = kinds.held.iter().map(|k| (k, if stays(k) { Validity::Now } else { Validity::UntilNextStart }));
    let comes = added.iter().filter(|k| !kinds.held.contains(k)).map(|k| (k, Validity::FromNextStart));
    Ok(Json(now.chain(comes).map(|(kind, valid)| KindDto::new(kind, valid)).collect()))
}

/// Add a robot kind beside those of the scenario, or replace one that was added. Robots of it may join from the next
/// start of the server on: the floor is worked out for its kinds then, and the database is carried over to them.
#[utoipa::path(put, path = "/v1/kinds/{name}", tag = "floor", operation_id = "putKind", request_body = NewKind,
    params(("name" = String, Path, example = "shuttle")), responses(
    (status = 201, description = "It is added, and that is durable", body = KindDto),
    (status = 200, description = "It replaces the one of its name, and that is durable", body = KindDto),
    (status = 409, description = "The scenario has one of this name, or robots are of it"),
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
    refuse_used(&api, &name)?;
    let figures = serde_json::to_string(&new).expect("figures are JSON");
    let request = |reply| KindRequest::Put(name.clone(), figures, reply);
    let (is_new, kind) = api.kinds.ask(&name, request).await?;
    let valid = if api.kinds.held.contains(&kind) { Validity::Now } else { Validity::FromNextStart };
    api.kinds.removed().remove(&name);
    if valid != Validity::Now && api.kinds.held.iter().any(|k| k.name == name) {
        // Robots of the one that is in force would be of the other one after the next start.
        api.kinds.removed().insert(name);
    }
    let status = if is_new { StatusCode::CREATED } else { StatusCode::OK };
    Ok((status, Json(KindDto::new(&kind, valid))))
}

/// Remove a robot kind that was added and that no robot is of. No robot of it joins any more.
#[utoipa::path(delete, path = "/v1/kinds/{name}", tag = "floor", operation_id = "removeKind",
    params(("name" = String, Path, example = "shuttle")), responses(
    (status = 204, description = "It is removed, and that is durable"),
    (status = 404, description = "No kind of this name was added"),
    (status = 409, description = "The scenario has it, or robots are of it")))]
pub async fn remove(Called(api): Called, PathPart(name): PathPart) -> Result<StatusCode, Problem> {
    refuse_used(&api, &name)?;
    api.kinds.ask(&name, |reply| KindRequest::Remove(name.clone(), reply)).await?;
    api.kinds.removed().insert(name);
    Ok(StatusCode::NO_CONTENT)
}

/// Refuses to change a kind that robots are of, also robots that have left: they may come back.
fn refuse_used(api: &Api, name: &str) -> Result<(), Problem> {
    let of_it = api.moment().view.robots.iter().filter(|r| r.kind == name).count();
    if of_it == 0 || api.kinds.is_of_scenario(name) {
        return Ok(());
    }
    let detail = requests::kind_in_use(of_it, name);
    Err(Problem::conflict("kind-in-use", "Robots are of this kind", detail))
}

impl Kinds {
    /// Whether a kind of this name was removed since the server started.
    pub(super) fn is_removed(&self, name: &str) -> bool {
        self.removed().contains(name)
    }

    fn is_of_scenario(&self, name: &str) -> bool {
        self.of_scenario.iter().any(|k| k.name == name)
    }

    fn removed(&self) -> MutexGuard<'_, BTreeSet<String>> {
        self.removed.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks the program about kinds that are added; `name` is that of the kind.
    async fn ask<T>(
        &self,
        name: &str,
        request: impl FnOnce(oneshot::Sender<Result<T, KindRefusal>>) -> KindRequest,
    ) -> Result<T, Problem> {
        let requests = self.requests.as_ref().ok_or_else(Problem::of_recording)?;
        let (reply, answer) = oneshot::channel();
        let busy = || Problem::unavailable(requests::busy(), 1);
        requests.try_send(request(reply)).map_err(|_| busy())?;
        let done = answer.await.map_err(|_| Problem::unavailable(requests::shutting_down(), 2))?;
        done.map_err(|why| refused(why, name))
    }
}

/// A refusal in words.
fn refused(why: KindRefusal, name: &str) -> Problem {
    match why {
        KindRefusal::OfScenario => {
            let detail = requests::kind_of_scenario(name);
            Problem::conflict("kind-of-scenario", "The scenario has this kind", detail)
        }
        KindRefusal::Unknown => Problem::unknown("kind", requests::kind_unknown(name)),
        KindRefusal::Figure(key, detail) => {
            Problem::invalid(vec![FieldError::new(key, requests::malformed(detail))])
        }
        KindRefusal::Map(found) => {
            let wrong = |text| FieldError::new("footprint", requests::malformed(text));
            Problem::invalid(found.into_iter().map(wrong).collect())
        }
        KindRefusal::TooMany(most) => Problem::no_room(requests::too_many_kinds(most)),
        KindRefusal::Database => Problem::unavailable(requests::database_does_not_answer(), 2),
    }
}

impl KindDto {
    fn new(k: &RobotKind, valid: Validity) -> KindDto {
        let [footprint, footprint_loaded] =
            k.footprints.each_ref().map(|f| f.as_ref().map(FootprintDto::from));
        let figures = k.kinematics;
        KindDto {
            name: k.name.clone(),
            valid,
            footprint,
            footprint_loaded,
            turns: figures.turn_radps.is_finite(),
            carries: k.carries.clone(),
            payload_kg: Some(k.payload_kg).filter(|kg| kg.is_finite()),
            free_navigation: k.free_navigation,
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

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::sync::mpsc;

    #[tokio::test]
    async fn a_change_of_kinds_beyond_those_that_may_wait_is_refused_until_one_is_answered() {
        let (send, mut waiting) = mpsc::channel(1);
        let kinds = Kinds { requests: Some(send), ..Kinds::default() };
        let first = tokio::spawn({
            let kinds = kinds.clone();
            async move { kinds.ask("", KindRequest::List).await }
        });
        while waiting.is_empty() {
            tokio::task::yield_now().await;
        }
        let busy = kinds.ask("", KindRequest::List).await.unwrap_err();
        assert_eq!((busy.status, busy.retry_after), (503, Some(1)));
        let Some(KindRequest::List(reply)) = waiting.recv().await else { panic!("it waits") };
        reply.send(Ok(Vec::new())).unwrap();
        assert_eq!(first.await.unwrap().unwrap(), []);
        drop(waiting);
    }
}
