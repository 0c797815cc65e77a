//! `/v1/robots/{id}/link`, its messages and actions, consent, and failures that people have looked after: robots that
//! speak VDA 5050.
//!
//! Main types: [`NewAction`], [`MessagesDto`]. Robots are found by the names under which they are listed, also before
//! they have joined the fleet. Refuses: to say to a robot what the fleet itself says to robots.

use crate::dto::linked::{ActionFateDto, LinkedRobotDto, SaidMessageDto};
use crate::port::linked::{LinkQuestion, NotDone, OperatorAction};
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, PathPair, PathPart};
use axum::Json;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// An action that is sent to a robot at once.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewAction {
    /// The action's type, by the standard's or the vendor's word.
    #[serde(rename = "type")]
    #[schema(example = "initPosition")]
    kind: String,
    /// The action's parameters by name.
    #[serde(default)]
    #[schema(value_type = Object)]
    parameters: serde_json::Map<String, serde_json::Value>,
    /// For `initPosition` in place of parameters: where the robot stands, in the coordinates of the floor's map.
    place: Option<FloorPlace>,
}

/// Where a robot stands, in the coordinates of the floor's map.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FloorPlace {
    /// Metres.
    #[schema(example = 4.0)]
    x: f64,
    /// Metres.
    #[schema(example = 2.5)]
    y: f64,
    /// Heading, radians, anticlockwise from the x axis.
    #[schema(example = 0.0)]
    theta: f64,
}

/// An action that was sent.
#[derive(Debug, Serialize, ToSchema)]
pub struct SentActionDto {
    /// The action's id; GET /v1/robots/{id}/actions/{action} says what became of it.
    pub action: String,
}

/// What was said.
#[derive(Debug, Serialize, ToSchema)]
pub struct MessagesDto {
    /// The last 200 messages from and to the robot, the newest last.
    pub messages: Vec<SaidMessageDto>,
}

/// The longest type of an action, in characters.
const LONGEST_TYPE: usize = 64;

fn no_such(name: &str) -> Problem {
    Problem::unknown("robot", requests::robot_not_linked(name))
}

/// The problem of a link that has not done what it was asked to.
pub fn not_done(name: &str, why: NotDone) -> Problem {
    match why {
        NotDone::Unknown => no_such(name),
        NotDone::Refused(why) => Problem::conflict("robot-link", "The robot's link cannot do this", why),
    }
}

/// Get what the link knows of a robot that speaks VDA 5050: whether it is commanded, why not, its order, its errors,
/// and what was noticed of it. Robots that are listed and have not joined the fleet yet are found, too.
#[utoipa::path(get, path = "/v1/robots/{id}/link", tag = "floor", operation_id = "getRobotLink",
    params(("id" = String, Path, example = "tug-1")), responses(
    (status = 200, description = "What the link knows", body = LinkedRobotDto),
    (status = 404, description = "No robot of this name is reached by such a link")))]
pub async fn get(Called(api): Called, PathPart(id): PathPart) -> Result<Json<LinkedRobotDto>, Problem> {
    let robot = api.ask_link(|reply| LinkQuestion::Robot(id.clone(), reply)).await?;
    robot.map(|robot| Json(robot.into())).ok_or_else(|| no_such(&id))
}

/// List the last messages from and to a robot.
#[utoipa::path(get, path = "/v1/robots/{id}/messages", tag = "floor", operation_id = "listRobotMessages",
    params(("id" = String, Path, example = "tug-1")), responses(
    (status = 200, description = "The last 200 messages, both ways", body = MessagesDto),
    (status = 404, description = "No robot of this name is reached by such a link")))]
pub async fn messages(Called(api): Called, PathPart(id): PathPart) -> Result<Json<MessagesDto>, Problem> {
    let said = api.ask_link(|reply| LinkQuestion::Messages(id.clone(), reply)).await?;
    let messages = said.ok_or_else(|| no_such(&id))?.into_iter().map(SaidMessageDto::from).collect();
    Ok(Json(MessagesDto { messages }))
}

/// Send a robot any instant action. It is sent at once and alone. Pauses and cancels are refused: Giveway says these to
/// robots by itself.
#[utoipa::path(post, path = "/v1/robots/{id}/actions", tag = "floor", operation_id = "sendRobotAction",
    params(("id" = String, Path, example = "tug-1")), request_body = NewAction, responses(
    (status = 202, description = "It was sent; `Location` says where its fate is", body = SentActionDto),
    (status = 404, description = "No robot of this name is reached by such a link"),
    (status = 409, description = "Nothing reaches the robot, or Giveway says this by itself")))]
pub async fn act(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(new): JsonBody<NewAction>,
) -> Result<(StatusCode, HeaderMap, Json<SentActionDto>), Problem> {
    if FieldError::of_plain_name(&new.kind, LONGEST_TYPE).is_some() {
        return Err(Problem::invalid(vec![FieldError::new("type", requests::plain_name(LONGEST_TYPE))]));
    }
    let place = new.place.map(|at| Pose { at: Point::new(at.x, at.y), heading: at.theta });
    let action = OperatorAction { kind: new.kind, parameters: new.parameters, place };
    let sent = api.ask_link(|reply| LinkQuestion::Act(id.clone(), action, reply)).await?;
    let action = sent.map_err(|why| not_done(&id, why))?;
    let mut headers = HeaderMap::new();
    if let Ok(location) = HeaderValue::from_str(&format!("/v1/robots/{id}/actions/{action}")) {
        headers.insert(header::LOCATION, location);
    }
    Ok((StatusCode::ACCEPTED, headers, Json(SentActionDto { action })))
}

/// Get what became of an action that was sent to a robot. The last 50 actions of each robot are remembered.
#[utoipa::path(get, path = "/v1/robots/{id}/actions/{action}", tag = "floor", operation_id = "getRobotAction",
    params(("id" = String, Path, example = "tug-1"), ("action" = String, Path, example = "gw-1700000000-7")), responses(
    (status = 200, description = "What became of it", body = ActionFateDto),
    (status = 404, description = "No such action is remembered")))]
pub async fn fate(
    Called(api): Called,
    PathPair(id, action): PathPair,
) -> Result<Json<ActionFateDto>, Problem> {
    let fate = api.ask_link(|reply| LinkQuestion::Fate(id.clone(), action.clone(), reply)).await?;
    let unknown = || Problem::unknown("action", requests::action_not_remembered(&action));
    fate.map(|fate| Json(ActionFateDto::new(action.clone(), fate))).ok_or_else(unknown)
}

/// Agree that a robot drives although it does not pause when told to. It is released one node at a time, and to no lane
/// that a person can reach before it stands.
#[utoipa::path(put, path = "/v1/robots/{id}/consent", tag = "floor", operation_id = "consentToRobot",
    params(("id" = String, Path, example = "tug-1")), responses(
    (status = 204, description = "The robot is commanded until the server restarts"),
    (status = 404, description = "No robot of this name is reached by such a link"),
    (status = 409, description = "The robot has not failed to pause")))]
pub async fn consent(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    let done = api.ask_link(|reply| LinkQuestion::Consent(id.clone(), reply)).await?;
    done.map(|()| StatusCode::NO_CONTENT).map_err(|why| not_done(&id, why))
}

/// Report that people have looked after a robot whose action failed, or that refused three orders in a row: it carries
/// what the fleet believes that it carries, and works again.
#[utoipa::path(post, path = "/v1/robots/{id}/settled", tag = "floor", operation_id = "settleRobot",
    params(("id" = String, Path, example = "tug-1")), responses(
    (status = 204, description = "The robot works again"),
    (status = 404, description = "No robot of this name is reached by such a link"),
    (status = 409, description = "No action of the robot has failed, and it refuses no orders")))]
pub async fn settle(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    let done = api.ask_link(|reply| LinkQuestion::Settle(id.clone(), reply)).await?;
    done.map(|()| StatusCode::NO_CONTENT).map_err(|why| not_done(&id, why))
}
