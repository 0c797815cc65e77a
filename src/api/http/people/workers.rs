//! `/v1/workers`: the workers on the floor.
//!
//! Main types: [`NewWorker`], [`ListedWorkerDto`]. Refuses: to list how fast workers are and where they are going.

use crate::access::caller::Role;
use crate::dto::names::{Names, Page};
use crate::dto::people::{EpisodeDto, SensesDto, WorkerDetailDto, WorkerDto};
use crate::dto::refusal::refused;
use crate::dto::vehicle::{NewVehicle, VehicleDto};
use crate::http::shared::paging::{Paging, is_wanted, page, read_words, refuse_wrong};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, Params, PathPart, read_time};
use crate::wire::sentence::SentenceSchema;
use crate::wire::text::{round3, worker_name};
use crate::wire::words::{GuidanceStateDto, PresenceDto};
use axum::Json;
use axum::http::{HeaderName, StatusCode, header};
use giveway_fleet::{Ask, Made};
use giveway_floor::id::{Dense, WorkerId};
use giveway_floor::text::sentence::requests;
use giveway_floor::text::{Sentence, name_fault};
use giveway_people::human::Mover;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// The longest name of a worker, in characters.
const LONGEST_NAME: usize = 64;

/// A worker to register.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewWorker {
    /// The worker's name, 1 to 64 characters. It is kept in one table, apart from everything else, which knows this
    /// worker by a pseudonym. For MassRobotics reports, the uuid.
    #[schema(example = "picker-7")]
    name: String,
    /// The vehicle that the worker drives, such as a forklift; absent for a worker on foot. A worker who is registered
    /// already then drives this vehicle.
    vehicle: Option<NewVehicle>,
}

/// What changes about a worker.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ChangedWorker {
    /// The vehicle that the worker drives from now on; null if the worker goes on foot.
    #[serde(deserialize_with = "Option::deserialize")]
    vehicle: Option<NewVehicle>,
}

/// A worker in a list, without pace and probable goals: side by side, these would reveal how people work. Robots need
/// them, and the map shows the current ones.
#[derive(Debug, Serialize, ToSchema)]
pub struct ListedWorkerDto {
    /// The worker's number.
    #[schema(example = "w1")]
    pub id: String,
    /// The name under which the worker was registered, for callers who may see names (docs/secure.md); for others, a
    /// pseudonym such as `worker-3f2a`.
    pub name: String,
    /// The vehicle that the worker drives; null on foot.
    pub vehicle: Option<VehicleDto>,
    /// Whether the worker is on the floor, and how well the position is known.
    pub presence: PresenceDto,
    /// Position x, metres; null if the worker has not been seen.
    pub x: Option<f64>,
    /// Position y, metres; null if the worker has not been seen.
    pub y: Option<f64>,
    /// Heading in radians, counter-clockwise from the x axis.
    pub heading: Option<f64>,
    /// When the worker was last seen, RFC 3339.
    pub seen: Option<String>,
    /// One standard deviation of the position, metres; it grows while no pose arrives.
    pub accuracy: f64,
    /// The state of the worker's guidance.
    pub state: GuidanceStateDto,
    /// Why the worker is told this, in words.
    #[schema(value_type = Option<SentenceSchema>)]
    pub reason: Option<Sentence>,
    /// The assignment that the worker's path serves.
    #[schema(example = "a3")]
    pub assignment: Option<String>,
}

impl From<WorkerDto> for ListedWorkerDto {
    fn from(w: WorkerDto) -> ListedWorkerDto {
        let WorkerDto {
            id,
            name,
            vehicle,
            presence,
            x,
            y,
            heading,
            seen,
            accuracy,
            state,
            reason,
            assignment,
            ..
        } = w;
        ListedWorkerDto {
            id,
            name,
            vehicle,
            presence,
            x,
            y,
            heading,
            seen,
            accuracy,
            state,
            reason,
            assignment,
        }
    }
}

/// Filters for the list of workers.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct WorkerParams {
    /// Only workers with this presence, or with any of several with commas between them.
    #[param(value_type = Option<Vec<PresenceDto>>, style = Form, explode = false)]
    presence: Option<String>,
    /// Only workers whose guidance is in this state, or in any of several with commas between them.
    #[param(value_type = Option<Vec<GuidanceStateDto>>, style = Form, explode = false)]
    state: Option<String>,
    /// Only workers who were seen at this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    updated_since: Option<String>,
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List workers; a device gets only its own.
#[utoipa::path(get, path = "/v1/workers", tag = "people", operation_id = "listWorkers", params(WorkerParams), responses(
    (status = 200, description = "Workers in order of joining", body = Page<ListedWorkerDto>)))]
pub async fn list(
    Called(api): Called,
    Params(p): Params<WorkerParams>,
) -> Result<Json<Page<ListedWorkerDto>>, Problem> {
    let mut errors = Vec::new();
    let presences = PresenceDto::ALL.map(PresenceDto::word);
    let presences = read_words("presence", p.presence.as_deref(), &presences, &mut errors);
    let states = GuidanceStateDto::ALL.map(GuidanceStateDto::word);
    let states = read_words("state", p.state.as_deref(), &states, &mut errors);
    let since = read_time("updated_since", p.updated_since.as_deref(), &mut errors);
    refuse_wrong(errors)?;
    let moment = api.moment();
    let is_new = |id: WorkerId| {
        let seen = moment.view.workers.get(id.ix()).and_then(|w| w.seen);
        since.is_none_or(|t| seen.is_some_and(|seen| seen >= t))
    };
    let mut workers: Vec<(WorkerId, String)> =
        api.feeds.names().into_iter().enumerate().map(|(i, name)| (WorkerId::at(i), name)).collect();
    workers.retain(|(_, name)| !name.is_empty());
    if api.caller.role == Role::Device {
        workers.retain(|(id, _)| api.caller.subject.as_deref() == Some(&worker_name(*id)));
    }
    workers.retain(|(id, _)| is_new(*id));
    let mut workers: Vec<ListedWorkerDto> =
        workers.into_iter().map(|(id, name)| worker(&api, id, name).into()).collect();
    workers.retain(|w| is_wanted(&presences, w.presence.word()) && is_wanted(&states, w.state.word()));
    page(workers, &Paging { limit: p.limit, cursor: p.cursor })
}

/// Get one worker, with gaze, hands and charge if a headset reports them.
#[utoipa::path(get, path = "/v1/workers/{id}", tag = "people", operation_id = "getWorker",
    params(("id" = String, Path, example = "w1")), responses(
    (status = 200, description = "The worker", body = WorkerDetailDto)))]
pub async fn get(Called(api): Called, PathPart(id): PathPart) -> Result<Json<WorkerDetailDto>, Problem> {
    let id = api.feeds.worker(&id)?;
    let carried = api.feeds.carried(id).unwrap_or_default();
    let name = api.feeds.name(id).unwrap_or_default();
    let moment = api.moment();
    let viewed = moment.view.workers.get(id.ix());
    let seen = viewed.and_then(|w| w.seen);
    Ok(Json(WorkerDetailDto {
        worker: worker(&api, id, name),
        clock_error_ms: carried.clock_error.map(|e| round3(e.0 as f64 / 1000.0)),
        age_s: seen.map(|seen| round3((moment.view.now - seen).as_secs_f64())),
        connected: carried.connected,
        acknowledged: carried.acknowledged,
        sequence: viewed.map(|w| w.episodes.iter().map(EpisodeDto::from).collect()).unwrap_or_default(),
        senses: SensesDto::from(&carried),
    }))
}

/// A worker, and its address as the header `Location`.
type LocatedWorker = ([(HeaderName, String); 1], Json<WorkerDto>);

/// A worker, as the answer to its registration.
fn located(api: &Api, id: WorkerId, name: String) -> LocatedWorker {
    let place = format!("/v1/workers/{}", worker_name(id));
    ([(header::LOCATION, place)], Json(worker(api, id, name)))
}

/// The worker for whom a device speaks, if this is its name.
fn own_worker(api: &Api, name: &str) -> Result<LocatedWorker, Problem> {
    let subject = api.caller.subject.as_deref().unwrap_or_default();
    match api.feeds.worker(subject).ok().and_then(|id| Some((id, api.feeds.name(id)?))) {
        Some((id, own)) if own == name || api.pseudonyms.person(&own).is_some_and(|p| p.name == name) => {
            Ok(located(api, id, own))
        }
        _ => {
            let detail = requests::token_of_worker(subject);
            Err(Problem::new(StatusCode::FORBIDDEN, "role", "Another role is needed", detail))
        }
    }
}

/// Register a worker. The same name is the same worker. A device cannot register a worker: it signs in under the name
/// of the worker for whom it speaks.
#[utoipa::path(post, path = "/v1/workers", tag = "people",
    operation_id = "registerWorker", request_body = NewWorker, responses(
    (status = 201, description = "Registered, and that is durable", body = WorkerDto,
     headers(("Location" = String))),
    (status = 200, description = "Registered before", body = WorkerDto),
    (status = 429)))]
pub async fn hire(
    Called(api): Called,
    JsonBody(new): JsonBody<NewWorker>,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<WorkerDto>), Problem> {
    let name = new.name.trim();
    if let Some(fault) = name_fault(name, LONGEST_NAME) {
        return Err(Problem::invalid(vec![FieldError::new("name", fault.sentence())]));
    }
    let mover = new.vehicle.map(|vehicle| vehicle.mover()).transpose().map_err(Problem::invalid)?;
    if api.caller.role == Role::Device {
        return own_worker(&api, name).map(|own| (StatusCode::OK, own.0, own.1));
    }
    api.queue()?;
    let taken = |name: &str| api.feeds.named(name).is_some();
    let registered = api.pseudonyms.register(name, (api.now)(), taken).await;
    let pseudonym = registered.map_err(Problem::of_records)?;
    match api.answer_to(Ask::register_worker(pseudonym.clone())).await? {
        Ok(Made { id, new }) => {
            let status = if new { StatusCode::CREATED } else { StatusCode::OK };
            if let Some(mover) = mover {
                api.ask(Ask::move_as(id, mover)).await?;
            }
            let (location, Json(worker)) = located(&api, id, pseudonym);
            // The latest view may be from before the worker got in.
            let vehicle = mover.map_or(worker.vehicle, |mover| VehicleDto::of(&mover));
            Ok((status, location, Json(WorkerDto { vehicle, ..worker })))
        }
        Err(why) => {
            // No worker is registered under this name, so the name must not be kept.
            if let Err(why) = api.pseudonyms.erase(&pseudonym, None).await {
                tracing::warn!("a name is kept without its worker: {why}");
            }
            Err(refused(&api.map, why))
        }
    }
}

/// Let a worker get into a vehicle, change it, or get off. From then on the worker's poses are those of the tag on the
/// vehicle, and robots give way to all of it.
#[utoipa::path(patch, path = "/v1/workers/{id}", tag = "people", operation_id = "changeWorker",
    params(("id" = String, Path, example = "w1")), request_body = ChangedWorker, responses(
    (status = 200, description = "Changed, and that is durable", body = WorkerDto)))]
pub async fn change(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(changed): JsonBody<ChangedWorker>,
) -> Result<Json<WorkerDto>, Problem> {
    let id = api.feeds.worker(&id)?;
    let mover = match changed.vehicle {
        Some(vehicle) => vehicle.mover().map_err(Problem::invalid)?,
        None => Mover::OnFoot,
    };
    api.ask(Ask::move_as(id, mover)).await?;
    let name = api.feeds.name(id).unwrap_or_default();
    Ok(Json(WorkerDto { vehicle: VehicleDto::of(&mover), ..worker(&api, id, name) }))
}

/// A worker in the latest view, with the name that the caller may see.
fn worker(api: &Api, id: WorkerId, name: String) -> WorkerDto {
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let shown = api.pseudonyms.shown(&api.caller, id, &name);
    let worker = match moment.view.workers.get(id.ix()) {
        Some(seen) => names.worker(id, seen),
        None => Names::absent_worker(id, name),
    };
    WorkerDto { name: shown, ..worker }
}
