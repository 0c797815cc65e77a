//! `/v1/jobs`: submit, list, get, cancel.
//!
//! Main types: [`NewJob`], [`JobParams`]. A request is answered when its facts are durable. Refuses: fields
//! that the kind of job does not have, names that the map does not have, and all of them at once rather than
//! one by one.

use super::lists::checked_limit;
use crate::api::Api;
use crate::api::dto::{JOB_STATES, JobDto, Names, Page};
use crate::api::error::{FieldError, Problem};
use crate::api::extract::{IdempotencyKey, JsonBody, Params, PathPart};
use crate::api::port::{Moment, What};
use crate::api::refusal::refused;
use crate::api::text::{job_name, parse_job_name, parse_time};
use crate::api::words::{JobKindDto, JobStateDto};
use crate::fleet::{JobKind, JobQuery, JobRequest, JobRow, Reply};
use crate::id::{Dense, JobId, NodeId, RackId, RobotId, StationId};
use crate::time::Span;
use crate::warehouse::Warehouse;
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderName, StatusCode, header};
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

/// The longest pick, seconds.
const LONGEST_PICK_S: f64 = 3600.0;

/// How many jobs one may come after.
const MOST_PREDECESSORS: usize = 100;

/// A job as a customer submits it. Which fields it has depends on its kind: `deliver` rack, station,
/// pick_s?; `return` rack; `relocate` rack, node; `charge` and `park` robot; `go` robot, node.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewJob {
    kind: JobKindDto,
    /// Name of a rack.
    #[schema(example = "K1")]
    rack: Option<String>,
    /// Name of a station.
    #[schema(example = "S1")]
    station: Option<String>,
    /// Name of a node.
    node: Option<String>,
    /// Name of a robot.
    robot: Option<String>,
    /// How long the pick takes, seconds; the station's usual time if absent.
    #[schema(minimum = 0, maximum = 3600)]
    pick_s: Option<f64>,
    /// 0 (whenever) to 9 (before all others); 0 if absent.
    #[schema(minimum = 0, maximum = 9)]
    priority: Option<i64>,
    /// When it should be done, RFC 3339.
    #[schema(example = "2027-01-31T12:00:00Z")]
    deadline: Option<String>,
    /// Jobs that must be over first.
    #[schema(example = json!(["j17"]))]
    after: Option<Vec<String>>,
}

/// Which jobs to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct JobParams {
    /// How many at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// Only jobs in this state.
    #[param(value_type = Option<JobStateDto>)]
    state: Option<String>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// Jobs, newest first.
#[utoipa::path(get, path = "/v1/jobs", tag = "jobs", operation_id = "listJobs", params(JobParams), responses(
    (status = 200, description = "Jobs, newest first", body = Page<JobDto>),
    (status = 422, body = Problem, content_type = "application/problem+json"),
    (status = 503, body = Problem, content_type = "application/problem+json")))]
pub async fn list(
    State(api): State<Api>,
    Params(p): Params<JobParams>,
) -> Result<Json<Page<JobDto>>, Problem> {
    let limit = checked_limit(p.limit, 50)?;
    let mut errors = Vec::new();
    let state = p.state.as_deref().and_then(|word| {
        let known = JOB_STATES.into_iter().find(|s| *s == word);
        if known.is_none() {
            errors.push(FieldError::new(
                "state",
                format!("\"{word}\" is not one of {}", JOB_STATES.join(", ")),
            ));
        }
        known
    });
    let before = p.cursor.as_deref().and_then(|cursor| {
        let id = parse_job_name(cursor);
        if id.is_none() {
            errors.push(FieldError::new("cursor", "use the value of `next` in the previous page"));
        }
        id
    });
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    let filter = JobQuery { state, before, limit: limit + 1 };
    let mut rows = api.records.jobs(filter).await.map_err(|why| Problem::unavailable(why, 2))?;
    let more = rows.len() > limit as usize;
    rows.truncate(limit as usize);
    let next = rows.last().filter(|_| more).map(|row| job_name(row.id));
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    Ok(Json(Page { items: rows.iter().map(|row| names.job(row)).collect(), next }))
}

/// One job.
#[utoipa::path(get, path = "/v1/jobs/{id}", tag = "jobs",
    operation_id = "getJob", params(("id" = String, Path, example = "j17")),
    responses(
    (status = 200, description = "The job", body = JobDto),
    (status = 404, body = Problem, content_type = "application/problem+json"),
    (status = 503, body = Problem, content_type = "application/problem+json")))]
pub async fn get(State(api): State<Api>, PathPart(id): PathPart) -> Result<Json<JobDto>, Problem> {
    let row = read(&api, parse_id(&id)?).await?;
    Ok(Json(dto(&api, &row)))
}

/// Submit a job. When this call returns, the job is durable. With an `Idempotency-Key`, a retry never makes a
/// second job.
#[utoipa::path(post, path = "/v1/jobs", tag = "jobs", operation_id = "submitJob", request_body = NewJob,
    params(("Idempotency-Key" = Option<String>, Header, description = "Your own key, up to 255 characters")),
    responses(
    (status = 201, description = "Accepted and durable", body = JobDto, headers(("Location" = String))),
    (status = 200, description = "Accepted earlier under this key", body = JobDto),
    (status = 400, body = Problem, content_type = "application/problem+json"),
    (status = 409, body = Problem, content_type = "application/problem+json"),
    (status = 422, body = Problem, content_type = "application/problem+json"),
    (status = 429, description = "A limit is reached; see Retry-After", body = Problem,
     content_type = "application/problem+json"),
    (status = 503, description = "Temporarily unavailable; see Retry-After", body = Problem,
     content_type = "application/problem+json")))]
pub async fn submit(
    State(api): State<Api>,
    IdempotencyKey(key): IdempotencyKey,
    JsonBody(new): JsonBody<NewJob>,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<JobDto>), Problem> {
    let request = JobRequest { key, ..new.read(&api.map, &api.moment())? };
    let reply = api.ask(What::Submit(request.clone())).await?;
    let (job, new) = match reply {
        Reply::Accepted { job, new, .. } => (job, new),
        Reply::Refused { why, .. } => return Err(refused(&api.map, why)),
        _ => return Err(Problem::internal()),
    };
    let row = read(&api, job).await?;
    // Somebody may have changed its priority since.
    if row.job.request != (JobRequest { priority: row.job.request.priority, ..request }) {
        let detail = format!(
            "the Idempotency-Key was used for {}, which is another job: use a new key for a new job",
            job_name(job)
        );
        let status = StatusCode::UNPROCESSABLE_ENTITY;
        return Err(Problem::new(status, "key-reused", "The key belongs to another job", detail));
    }
    let status = if new { StatusCode::CREATED } else { StatusCode::OK };
    Ok((status, [(header::LOCATION, format!("/v1/jobs/{}", job_name(job)))], Json(dto(&api, &row))))
}

/// What may change about a job that waits.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct JobChange {
    /// 0 (whenever) to 9 (before all others).
    #[schema(minimum = 0, maximum = 9)]
    priority: u8,
}

/// Change the priority of a job that no robot has yet.
#[utoipa::path(patch, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "changeJob", request_body = JobChange,
    params(("id" = String, Path, example = "j17")), responses(
    (status = 200, description = "The job as it is now", body = JobDto),
    (status = 404, body = Problem, content_type = "application/problem+json"),
    (status = 409, description = "A robot already works on it, or it is over", body = Problem,
     content_type = "application/problem+json"),
    (status = 422, body = Problem, content_type = "application/problem+json"),
    (status = 503, body = Problem, content_type = "application/problem+json")))]
pub async fn prioritise(
    State(api): State<Api>,
    PathPart(id): PathPart,
    JsonBody(change): JsonBody<JobChange>,
) -> Result<Json<JobDto>, Problem> {
    let id = parse_id(&id)?;
    match api.ask(What::Prioritise(id, change.priority)).await? {
        Reply::Refused { why, .. } => Err(refused(&api.map, why)),
        _ => Ok(Json(dto(&api, &read(&api, id).await?))),
    }
}

/// Cancel a job. A robot that carries its rack puts it back first.
#[utoipa::path(delete, path = "/v1/jobs/{id}", tag = "jobs",
    operation_id = "cancelJob", params(("id" = String, Path, example = "j17")),
    responses(
    (status = 200, description = "It is cancelled, or will be as soon as its rack is back", body = JobDto),
    (status = 404, body = Problem, content_type = "application/problem+json"),
    (status = 409, description = "It is over already, or is part of a recording", body = Problem,
     content_type = "application/problem+json"),
    (status = 503, body = Problem, content_type = "application/problem+json")))]
pub async fn cancel(State(api): State<Api>, PathPart(id): PathPart) -> Result<Json<JobDto>, Problem> {
    let id = parse_id(&id)?;
    match api.ask(What::Cancel(id)).await? {
        Reply::Refused { why, .. } => Err(refused(&api.map, why)),
        _ => Ok(Json(dto(&api, &read(&api, id).await?))),
    }
}

fn parse_id(text: &str) -> Result<JobId, Problem> {
    parse_job_name(text)
        .ok_or_else(|| Problem::unknown("job", format!("\"{text}\" is not a job id; ids look like j17")))
}

async fn read(api: &Api, id: JobId) -> Result<JobRow, Problem> {
    let row = api.records.job(id).await.map_err(|why| Problem::unavailable(why, 2))?;
    row.ok_or_else(|| Problem::unknown("job", format!("{} does not exist", job_name(id))))
}

fn dto(api: &Api, row: &JobRow) -> JobDto {
    Names { map: &api.map, view: &api.moment().view }.job(row)
}

/// Reads fields and collects what is wrong with them.
struct Reader<'a> {
    map: &'a Warehouse,
    moment: &'a Moment,
    kind: JobKindDto,
    errors: Vec<FieldError>,
}

impl Reader<'_> {
    fn wrong(&mut self, field: &str, detail: impl Into<String>) {
        self.errors.push(FieldError::new(field, detail));
    }

    /// A name that this kind of job needs, looked up.
    fn name<T>(
        &mut self,
        field: &str,
        text: Option<&str>,
        find: impl Fn(&Self, &str) -> Option<T>,
    ) -> Option<T> {
        let Some(text) = text else {
            self.wrong(field, format!("required for {}", self.kind.word()));
            return None;
        };
        let found = find(self, text);
        if found.is_none() {
            let list = if field == "node" { "map".into() } else { format!("{field}s") };
            self.wrong(field, format!("there is no {field} \"{text}\"; GET /v1/{list} lists them"));
        }
        found
    }

    fn rack(&mut self, new: &NewJob) -> Option<RackId> {
        self.name("rack", new.rack.as_deref(), |r, text| r.map.rack_named(text))
    }

    fn node(&mut self, new: &NewJob) -> Option<NodeId> {
        self.name("node", new.node.as_deref(), |r, text| r.map.node_named(text))
    }

    fn station(&mut self, new: &NewJob) -> Option<StationId> {
        self.name("station", new.station.as_deref(), |r, text| r.map.station_named(text))
    }

    fn robot(&mut self, new: &NewJob) -> Option<RobotId> {
        let find = |r: &Self, text: &str| r.moment.view.robots.iter().position(|robot| robot.name == text);
        self.name("robot", new.robot.as_deref(), find).map(RobotId::at)
    }

    /// Complains about fields that this kind of job does not have.
    fn superfluous(&mut self, new: &NewJob) {
        let fields: &[&str] = match self.kind {
            JobKindDto::Deliver => &["rack", "station", "pick_s"],
            JobKindDto::Return => &["rack"],
            JobKindDto::Relocate => &["rack", "node"],
            JobKindDto::Charge | JobKindDto::Park => &["robot"],
            JobKindDto::Go => &["robot", "node"],
        };
        let given = [
            ("rack", new.rack.is_some()),
            ("station", new.station.is_some()),
            ("node", new.node.is_some()),
            ("robot", new.robot.is_some()),
            ("pick_s", new.pick_s.is_some()),
        ];
        for (field, _) in given.into_iter().filter(|(f, given)| *given && !fields.contains(f)) {
            self.wrong(field, format!("no such field; a {} job has {}", self.kind.word(), fields.join(", ")));
        }
    }

    fn kind(&mut self, new: &NewJob) -> Option<JobKind> {
        Some(match self.kind {
            JobKindDto::Deliver => {
                let (rack, station) = (self.rack(new), self.station(new));
                let pick = new.pick_s.map(Span::from_secs_f64);
                JobKind::Deliver { rack: rack?, station: station?, pick }
            }
            JobKindDto::Return => JobKind::Return { rack: self.rack(new)? },
            JobKindDto::Relocate => {
                let (rack, node) = (self.rack(new), self.node(new));
                JobKind::Relocate { rack: rack?, node: node? }
            }
            JobKindDto::Charge => JobKind::Charge { robot: self.robot(new)? },
            JobKindDto::Park => JobKind::Park { robot: self.robot(new)? },
            JobKindDto::Go => {
                let (robot, node) = (self.robot(new), self.node(new));
                JobKind::Go { robot: robot?, node: node? }
            }
        })
    }
}

impl NewJob {
    fn read(&self, map: &Warehouse, moment: &Moment) -> Result<JobRequest, Problem> {
        let mut r = Reader { map, moment, kind: self.kind, errors: Vec::new() };
        r.superfluous(self);
        if self.pick_s.is_some_and(|s| !(0.0..=LONGEST_PICK_S).contains(&s)) {
            r.wrong("pick_s", format!("must be 0 to {LONGEST_PICK_S} seconds"));
        }
        let priority = self.priority.unwrap_or(0);
        if !(0..=9).contains(&priority) {
            r.wrong("priority", format!("{priority} is not between 0 and 9"));
        }
        let deadline = self.deadline.as_deref().and_then(|text| {
            let time = parse_time(text);
            if time.is_none() {
                r.wrong("deadline", format!("\"{text}\" is not a time such as 2027-01-31T12:00:00Z"));
            }
            time
        });
        let names = self.after.as_deref().unwrap_or(&[]);
        if names.len() > MOST_PREDECESSORS {
            r.wrong("after", format!("{} jobs; at most {MOST_PREDECESSORS} are allowed", names.len()));
        }
        let mut after = Vec::new();
        for (i, name) in names.iter().take(MOST_PREDECESSORS).enumerate() {
            match parse_job_name(name) {
                Some(id) => after.push(id),
                None => {
                    r.wrong(&format!("after[{i}]"), format!("\"{name}\" is not a job id; ids look like j17"))
                }
            }
        }
        match (r.kind(self), r.errors.is_empty()) {
            (Some(kind), true) => {
                let priority = u8::try_from(priority).unwrap_or(0);
                Ok(JobRequest { kind, priority, deadline, after, key: None })
            }
            _ => Err(Problem::invalid(r.errors)),
        }
    }
}
