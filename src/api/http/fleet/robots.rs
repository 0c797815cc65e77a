//! `POST /v1/robots`, `DELETE /v1/robots/{id}` and maintenance: robots that join, go to maintenance and come back, and
//! leave.
//!
//! Also reports that people took the rack off a robot that cannot drive.
//!
//! Main types: [`NewRobot`], [`TakenRack`]. Refuses: to let a robot join where another robot is, or will be.

use crate::http::fleet::linked::not_done;
use crate::http::shared::done::done;
use crate::http::shared::named::{parse_robot, unknown};
use crate::port::linked::{LinkQuestion, NewLinked};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, PathPart};
use axum::Json;
use axum::http::StatusCode;
use giveway_fleet::{Ask, Made, USUAL_KIND};
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The longest name of a robot, in characters.
const LONGEST_NAME: usize = 64;

/// A robot that is to join.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewRobot {
    /// The robot's name: letters, digits, `-`, `_` and `.`, 1 to 64 of them.
    #[schema(example = "robot-51")]
    name: String,
    /// The robot's kind, one of GET /v1/kinds; \"robot\" if the site or scenario defines no kinds.
    #[serde(default = "usual_kind")]
    #[schema(example = "robot")]
    kind: String,
    /// Id of the node on which the robot stands; absent for a robot that speaks VDA 5050, which says so itself.
    #[serde(default)]
    #[schema(example = "C1-15")]
    node: Option<String>,
    /// For a robot that speaks VDA 5050: the manufacturer, as in its topics.
    #[serde(default)]
    #[schema(example = "acme")]
    manufacturer: Option<String>,
    /// For a robot that speaks VDA 5050: the serial number, as in its topics.
    #[serde(default)]
    #[schema(example = "0001")]
    serial: Option<String>,
    /// For a robot that speaks VDA 5050: the version that is spoken with it; the one that it says if absent.
    #[serde(default)]
    #[schema(example = "2.1.0")]
    version: Option<String>,
    /// The name of the link to the robot, one of the site's links; if absent, the only link.
    #[serde(default)]
    #[schema(example = "sim")]
    link: Option<String>,
}

/// Where people set a rack down.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TakenRack {
    /// Id of the storage node on which the rack stands now.
    #[schema(example = "s3")]
    node: String,
}

/// A robot that has joined.
#[derive(Debug, Serialize, ToSchema)]
pub struct JoinedDto {
    /// The robot's name.
    #[schema(example = "robot-51")]
    pub id: String,
}

fn usual_kind() -> String {
    USUAL_KIND.to_owned()
}

/// Register a robot that stands on a node that no other robot holds. The same name is the same robot. A robot that
/// speaks VDA 5050 is registered with `manufacturer` and `serial` in place of `node`: it joins where it says that it
/// stands, and GET /v1/robots/{id}/link says what is missing until then.
#[utoipa::path(post, path = "/v1/robots", tag = "floor",
    operation_id = "registerRobot", request_body = NewRobot, responses(
    (status = 201, description = "It has joined, and that is durable; GET /v1/robots shows it", body = JoinedDto),
    (status = 200, description = "It had joined before, wherever it is by now", body = JoinedDto),
    (status = 404, description = "The floor has no link to robots of other vendors"),
    (status = 409, description = "Another robot holds the node, has this name, or is listed under this serial number"),
    (status = 429)))]
pub async fn register(
    Called(api): Called,
    JsonBody(new): JsonBody<NewRobot>,
) -> Result<(StatusCode, Json<JoinedDto>), Problem> {
    let name = new.name.trim().to_owned();
    let mut wrong: Vec<FieldError> = FieldError::of_plain_name(&name, LONGEST_NAME).into_iter().collect();
    let NewRobot { kind, node, manufacturer, serial, version, link, .. } = new;
    let is_new = match (node, manufacturer, serial) {
        (None, Some(manufacturer), Some(serial)) if wrong.is_empty() => {
            list(&api, NewLinked { name: name.clone(), manufacturer, serial, kind, version }).await?
        }
        (Some(named), None, None) if version.is_none() => {
            let node = api.map.node_named(&named);
            if node.is_none() {
                wrong.push(FieldError::new("node", unknown("node", &named)));
            }
            let Some(node) = node.filter(|_| wrong.is_empty()) else { return Err(Problem::invalid(wrong)) };
            let Made { new, .. } = api.ask(Ask::register_robot(name.clone(), kind, node, link)).await?;
            new
        }
        (None, Some(_), Some(_)) => return Err(Problem::invalid(wrong)),
        _ => {
            wrong.push(FieldError::new("node", requests::node_or_address()));
            return Err(Problem::invalid(wrong));
        }
    };
    let status = if is_new { StatusCode::CREATED } else { StatusCode::OK };
    Ok((status, Json(JoinedDto { id: name })))
}

/// Whether a robot that speaks VDA 5050 is listed and not on the floor.
async fn is_listed_elsewhere(api: &Api, id: &str) -> Result<bool, Problem> {
    if api.link.is_none() {
        return Ok(false);
    }
    let robot = api.ask_link(|reply| LinkQuestion::Robot(id.to_owned(), reply)).await?;
    Ok(robot.is_some_and(|robot| !robot.joined))
}

/// Lists a robot that speaks VDA 5050, for good. Gives whether it is new.
async fn list(api: &Api, new: NewLinked) -> Result<bool, Problem> {
    let name = new.name.clone();
    let listed = api.ask_link(|reply| LinkQuestion::List(new.clone(), reply)).await?;
    let is_new = listed.map_err(|why| not_done(&name, why))?;
    if let Err(why) = api.records.keep_linked(new).await {
        if is_new {
            api.ask_link(|reply| LinkQuestion::Unlist(name, reply)).await?;
        }
        return Err(Problem::of_records(why));
    }
    Ok(is_new)
}

/// Take a robot off the floor for good. It finishes what it has begun, gives back jobs that it has not begun, and goes
/// to a parking place. Switch it off there: once it has been silent for ten seconds it is gone, and nothing is kept
/// free for it. A broken robot is then gone wherever it stands, if it carries no rack. Jobs that name the robot fail.
/// To bring it back, register it again under its name. A robot that speaks VDA 5050 and is not on the floor is listed
/// no more; one that the site's file lists is back with the next start.
#[utoipa::path(delete, path = "/v1/robots/{id}", tag = "floor", operation_id = "retireRobot",
    params(("id" = String, Path, example = "robot-1")), responses(
    (status = 204, description = "It will leave, and that is durable"),
    (status = 409, description = "It has left already")))]
pub async fn retire(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    if is_listed_elsewhere(&api, &id).await? {
        api.records.forget_linked(id.clone()).await.map_err(Problem::of_records)?;
        api.ask_link(|reply| LinkQuestion::Unlist(id, reply)).await?;
        return Ok(StatusCode::NO_CONTENT);
    }
    done(&api, Ask::retire(parse_robot(&api, &id)?)).await
}

/// Send a robot to maintenance. It finishes what it has begun, gives back jobs that it has not begun, goes to a parking
/// place and gets no jobs until `DELETE` ends the maintenance, even across a restart.
#[utoipa::path(put, path = "/v1/robots/{id}/maintenance", tag = "floor", operation_id = "beginMaintenance",
    params(("id" = String, Path, example = "robot-1")), responses(
    (status = 204, description = "It goes to maintenance, and that is durable")))]
pub async fn maintain(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    done(&api, Ask::begin_maintenance(parse_robot(&api, &id)?)).await
}

/// End a robot's maintenance, or keep a robot that was to leave.
#[utoipa::path(delete, path = "/v1/robots/{id}/maintenance", tag = "floor", operation_id = "endMaintenance",
    params(("id" = String, Path, example = "robot-1")), responses(
    (status = 204, description = "It works again")))]
pub async fn work_again(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    done(&api, Ask::end_maintenance(parse_robot(&api, &id)?)).await
}

/// Report that people took a rack off a robot that cannot drive, and where in storage the rack stands now. A delivery
/// with this rack waits for another robot, and the robot can be taken off the floor.
#[utoipa::path(post, path = "/v1/racks/{id}/taken", tag = "floor", operation_id = "takeRack", request_body = TakenRack,
    params(("id" = String, Path, example = "rack-1")), responses(
    (status = 204, description = "It stands there, and that is durable"),
    (status = 409, description = "The rack is on no robot, its robot can drive, or the node is taken"),
    (status = 422, description = "There is no such node, or it is not a storage node")))]
pub async fn take_rack(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(taken): JsonBody<TakenRack>,
) -> Result<StatusCode, Problem> {
    let no_rack = || Problem::unknown("rack", requests::no_such_thing("rack", &id, "/v1/racks"));
    let rack = api.map.rack_named(&id).ok_or_else(no_rack)?;
    let detail = || unknown("node", &taken.node);
    let node = api.map.node_named(&taken.node);
    let node = node.ok_or_else(|| Problem::invalid(vec![FieldError::new("node", detail())]))?;
    done(&api, Ask::take_rack(rack, node)).await
}
