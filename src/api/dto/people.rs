//! People as they travel: workers, assignments, closures, encounters.
//!
//! Main types: [`WorkerDto`], [`WorkerDetailDto`], [`AssignmentDto`], [`ClosureDto`], [`EncounterDto`]. Workers are
//! "w1", assignments "a1", closures "c1". Refuses: to add knowledge of its own.

use super::guidance::{line, reason};
use super::vehicle::VehicleDto;
use crate::dto::names::Names;
use crate::wire::sentence::SentenceSchema;
use crate::wire::text::{
    assignment_name, closure_name, offset_text, round3, series_name, time_text, worker_name,
};
use crate::wire::words::{
    AssignmentStateDto, BindsDto, ClosureStateDto, GazeKind, GuidanceStateDto, IntentStateDto, PresenceDto,
    ReactionDto, WeekdayDto,
};
use giveway_fleet::{
    AssignmentRow, AssignmentState, Closure, EncounterRow, RecurringClosure, WorkerEpisode, WorkerView,
};
use giveway_floor::geometry::Point;
use giveway_floor::id::{ClosureId, Dense, NodeId, SeriesId, WorkerId};
use giveway_floor::text::Sentence;
use giveway_floor::time::Time;
use giveway_people::aware::{Covered, covered, nodes_in};
use serde::Serialize;
use utoipa::ToSchema;

/// One worker.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct WorkerDto {
    /// The worker's number.
    #[schema(example = "w1")]
    pub id: String,
    /// The name under which the worker was registered, for callers who may see names (docs/secure.md); for others, and
    /// in all feeds, a pseudonym such as `worker-3f2a`.
    pub name: String,
    /// The vehicle that the worker drives; null on foot.
    pub vehicle: Option<VehicleDto>,
    /// Whether the worker is on the floor, and how well the position is known.
    pub presence: PresenceDto,
    /// Position x of the worker, or of the tag on the vehicle, metres; null if the worker has not been seen.
    pub x: Option<f64>,
    /// Position y, metres; null if the worker has not been seen.
    pub y: Option<f64>,
    /// Heading in radians, counter-clockwise from the x axis.
    pub heading: Option<f64>,
    /// When the worker was last seen, RFC 3339.
    pub seen: Option<String>,
    /// Speed, metres per second.
    pub speed: f64,
    /// One standard deviation of the position, metres; it grows while no pose arrives.
    pub accuracy: f64,
    /// For a lost worker, the area where the worker may be by now: `[x, y]` of nodes that robots keep out of, metres;
    /// else empty.
    pub area: Vec<[f64; 2]>,
    /// Radii of the stop, keep-out and slow zones around the worker, metres, for a robot without a rack.
    pub regions: [f64; 3],
    /// The state of the worker's guidance.
    pub state: GuidanceStateDto,
    /// Why the worker is told this, in words.
    #[schema(value_type = Option<SentenceSchema>)]
    pub reason: Option<Sentence>,
    /// The version of the path; it grows with every new path.
    pub version: u64,
    /// The path from the worker's place on, as points `[x, y]`, metres.
    pub path: Vec<[f64; 2]>,
    /// When the worker reaches the end of the path at usual speed, RFC 3339.
    pub eta: Option<String>,
    /// The assignment that the path serves.
    #[schema(example = "a3")]
    pub assignment: Option<String>,
    /// Goals of the worker's walk, the most probable first.
    pub goals: Vec<GoalDto>,
    /// Probability that the goal cannot be determined yet.
    pub undecided: f64,
    /// Probability that the worker goes to none of the goals.
    pub elsewhere: f64,
    /// Counts of the worker's poses, by what became of them.
    pub feed: FeedDto,
}

/// A possible goal of a worker.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct GoalDto {
    /// The goal's x, metres.
    pub x: f64,
    /// The goal's y, metres.
    pub y: f64,
    /// Probability that the worker goes there.
    pub p: f64,
}

/// Counts of a worker's poses, by what became of them.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct FeedDto {
    /// Poses that were accepted.
    pub taken: u64,
    /// Poses that were older than the newest one, or duplicates.
    pub late: u64,
    /// Poses too far from where the worker could be.
    pub jumps: u64,
    /// Poses with impossible values.
    pub absurd: u64,
}

/// One worker, with what the headset reports.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct WorkerDetailDto {
    /// The worker, as in the list of workers.
    #[serde(flatten)]
    pub worker: WorkerDto,
    /// Whether a headset is connected.
    pub connected: bool,
    /// The version of the guidance that the headset showed last.
    pub acknowledged: Option<u64>,
    /// How wrong the times of the headset's poses may be, milliseconds; null if its clock offset is unknown.
    pub clock_error_ms: Option<f64>,
    /// The age of the newest pose, seconds.
    pub age_s: Option<f64>,
    /// What the worker has been doing over about the last hundred metres, the oldest first: the most probable sequence,
    /// which may differ from the most probable goal at any one moment.
    pub sequence: Vec<EpisodeDto>,
    /// Gaze, hands and charge.
    #[serde(flatten)]
    pub senses: SensesDto,
}

/// A stretch of time in which a worker most probably had the same intent.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EpisodeDto {
    /// The intent.
    pub state: IntentStateDto,
    /// The goal's x, metres; null if the intent is not a goal.
    pub x: Option<f64>,
    /// The goal's y, metres; null if the intent is not a goal.
    pub y: Option<f64>,
    /// Since when the worker has had this intent, RFC 3339.
    pub since: String,
}

impl From<&WorkerEpisode> for EpisodeDto {
    fn from(e: &WorkerEpisode) -> EpisodeDto {
        let (x, y) = (e.place.map(|p| round3(p.x)), e.place.map(|p| round3(p.y)));
        EpisodeDto { state: e.state.into(), x, y, since: time_text(e.since) }
    }
}

/// What a headset reports besides its pose. No decision of the fleet depends on it.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SensesDto {
    /// Charge of the headset, 0 to 1.
    pub battery: Option<f64>,
    /// The worker's gaze.
    pub gaze: Option<GazeDto>,
    /// The worker's hands.
    pub hands: HandsDto,
}

/// A gaze ray; points are map x, map y, height.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct GazeDto {
    /// Whether the ray is measured or estimated.
    pub kind: GazeKind,
    /// Where the ray begins, metres.
    pub origin: [f64; 3],
    /// The ray's direction, a unit vector.
    pub dir: [f64; 3],
}

/// Joints of the hands, each as map x, map y, height, radius, metres.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct HandsDto {
    /// Joints of the left hand.
    pub l: Option<Vec<[f64; 4]>>,
    /// Joints of the right hand.
    pub r: Option<Vec<[f64; 4]>>,
}

/// An assignment: a task for a worker.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct AssignmentDto {
    /// The assignment's number.
    #[schema(example = "a3")]
    pub id: String,
    /// The worker; null while the assignment waits for the nearest worker who is free. Of an assignment that is over,
    /// only administrators and the worker's own device see the worker.
    #[schema(example = "w1")]
    pub worker: Option<String>,
    /// The node to which the worker goes.
    pub place: String,
    /// How long the worker stays there, seconds.
    pub stay_s: f64,
    /// The task, in the customer's words.
    pub what: String,
    /// How far the assignment has come.
    pub state: AssignmentStateDto,
    /// When the assignment was accepted, RFC 3339.
    pub created: String,
    /// When the assignment's state changed last, RFC 3339.
    pub updated: String,
}

/// An area that robots, people or both keep out of.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ClosureDto {
    /// The closure's number.
    #[schema(example = "c2")]
    pub id: String,
    /// Corners of the area, metres.
    pub outline: Vec<[f64; 2]>,
    /// Nodes that are closed, by name: on these nodes, a robot would reach into the outline.
    pub nodes: Vec<String>,
    /// When the closure begins, RFC 3339.
    pub from: String,
    /// When the closure ends, RFC 3339; null if the area stays closed until somebody opens it.
    pub until: Option<String>,
    /// Whether the area is closed now.
    pub state: ClosureStateDto,
    /// Whether the closure keeps out robots, people or both.
    pub binds: BindsDto,
    /// The recurring closure of which this is an occurrence.
    #[schema(example = "s1")]
    pub series: Option<String>,
    /// Why the area is closed.
    pub reason: String,
}

/// What a closed area contains.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CoveredDto {
    /// How many nodes are closed.
    #[schema(example = 12)]
    pub nodes: usize,
    /// Stations at which no robot can stand, by name.
    pub stations: Vec<String>,
    /// How many of the nodes are storage.
    pub storage: usize,
    /// The area inside the outline, square metres; null if the closure names nodes.
    #[schema(example = 37.5)]
    pub area_m2: Option<f64>,
}

/// An area that is closed repeatedly.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RecurringClosureDto {
    /// The recurring closure's number.
    #[schema(example = "s1")]
    pub id: String,
    /// Corners of the area, metres.
    pub outline: Vec<[f64; 2]>,
    /// Nodes that are closed, by name: on these nodes, a robot would reach into the outline.
    pub nodes: Vec<String>,
    /// Seconds from one occurrence to the next; a day for occurrences on weekdays.
    pub every_s: f64,
    /// How long an occurrence lasts if the clocks do not change during it, seconds.
    pub lasts_s: f64,
    /// The days of the week on which occurrences begin.
    pub weekdays: Vec<WeekdayDto>,
    /// The current offset of the building's time from UTC.
    #[schema(example = "+01:00")]
    pub utc_offset: String,
    /// The time zone that the closure follows; null if the offset is fixed.
    #[schema(example = "Europe/Berlin")]
    pub zone: Option<String>,
    /// No occurrence begins at or after this time, RFC 3339; null if the closure recurs until somebody ends it.
    pub until: Option<String>,
    /// Whether the closure keeps out robots, people or both.
    pub binds: BindsDto,
    /// Why the area is closed.
    pub reason: String,
    /// When the next occurrence begins, RFC 3339; null if the last one has begun.
    pub next: Option<String>,
    /// The occurrences that are in force or announced, in order of time.
    pub occurrences: Vec<ClosureDto>,
}

/// The days of the week, as the bits of a recurrence have them.
pub const WEEKDAYS: [WeekdayDto; 7] = [
    WeekdayDto::Monday,
    WeekdayDto::Tuesday,
    WeekdayDto::Wednesday,
    WeekdayDto::Thursday,
    WeekdayDto::Friday,
    WeekdayDto::Saturday,
    WeekdayDto::Sunday,
];

/// A robot that came into region 1 of a worker.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct EncounterDto {
    /// The encounter's number; later encounters have greater numbers.
    pub id: i64,
    /// The worker; null once this has been forgotten, after `people_keep_days` or because the person was erased.
    #[schema(example = "w1")]
    pub worker: Option<String>,
    /// The robot's name.
    pub robot: String,
    /// When the encounter began, RFC 3339.
    pub began: String,
    /// How long the robot was in the region, seconds.
    pub lasted_s: f64,
    /// Position of the worker, x in metres.
    pub x: f64,
    /// Position of the worker, y in metres.
    pub y: f64,
    /// The region of the worker that the robot entered: always 1 at present.
    pub region: u8,
    /// Radius of that region at the time, between the centres, metres.
    pub radius: f64,
    /// Closest distance between the centres, metres.
    pub closest: f64,
    /// Speed of the robot when it entered the region, metres per second.
    pub robot_speed: f64,
    /// Speed of the worker at that time, metres per second.
    pub worker_speed: f64,
    /// What the fleet did about the robot.
    pub reaction: ReactionDto,
    /// Delay, in seconds, of the task that the robot had when the encounter began, against the plan at that time; as
    /// known at the end of the encounter.
    pub delay_s: f64,
}

/// The states of an assignment, in order of life.
pub const ASSIGNMENT_STATES: [AssignmentState; 5] = [
    AssignmentState::Waiting,
    AssignmentState::Walking,
    AssignmentState::Working,
    AssignmentState::Done,
    AssignmentState::Cancelled,
];

impl Names<'_> {
    /// All workers in the view, each with its number; a number that is free has no name.
    pub fn workers(&self) -> Vec<WorkerDto> {
        let workers = self.view.workers.iter().enumerate();
        workers.map(|(i, w)| self.worker(WorkerId::at(i), w)).collect()
    }

    /// One worker.
    pub fn worker(&self, id: WorkerId, w: &WorkerView) -> WorkerDto {
        let g = &w.guidance;
        let goal = |(at, p): &(Point, f64)| GoalDto { x: round3(at.x), y: round3(at.y), p: round3(*p) };
        WorkerDto {
            id: worker_name(id),
            name: w.name.clone(),
            vehicle: VehicleDto::of(&w.mover),
            presence: w.presence.into(),
            x: w.pose.map(|p| round3(p.at.x)),
            y: w.pose.map(|p| round3(p.at.y)),
            heading: w.pose.map(|p| round3(p.heading)),
            seen: w.seen.map(time_text),
            speed: round3(w.speed_mps),
            accuracy: round3(w.accuracy_m),
            area: w.area.iter().map(|n| self.place(*n)).collect(),
            regions: w.regions_m.map(round3),
            state: g.state.into(),
            reason: g.reason.map(|r| reason(r, *self)),
            version: g.version,
            path: line(&g.path),
            eta: g.eta.map(time_text),
            assignment: g.assignment.map(assignment_name),
            goals: w.goals.iter().map(goal).collect(),
            undecided: round3(w.undecided),
            elsewhere: round3(w.elsewhere),
            feed: FeedDto {
                taken: w.feed.taken,
                late: w.feed.late,
                jumps: w.feed.jumps,
                absurd: w.feed.absurd,
            },
        }
    }

    fn place(&self, node: NodeId) -> [f64; 2] {
        let at = self.map.nodes[node].at;
        [round3(at.x), round3(at.y)]
    }

    /// A worker whom the view does not contain yet.
    pub fn absent_worker(id: WorkerId, name: String) -> WorkerDto {
        WorkerDto {
            id: worker_name(id),
            name,
            vehicle: None,
            presence: PresenceDto::Absent,
            x: None,
            y: None,
            heading: None,
            seen: None,
            speed: 0.0,
            accuracy: 0.0,
            area: Vec::new(),
            regions: [0.0; 3],
            state: GuidanceStateDto::Idle,
            reason: None,
            version: 0,
            path: Vec::new(),
            eta: None,
            assignment: None,
            goals: Vec::new(),
            undecided: 1.0,
            elsewhere: 0.0,
            feed: FeedDto { taken: 0, late: 0, jumps: 0, absurd: 0 },
        }
    }

    /// An assignment.
    pub fn assignment(&self, record: &AssignmentRow) -> AssignmentDto {
        let a = &record.assignment;
        AssignmentDto {
            id: assignment_name(record.id),
            worker: a.worker.map(worker_name),
            place: record.gone.node.clone().unwrap_or_else(|| self.node(a.request.place)),
            stay_s: a.request.stay.as_secs_f64(),
            what: a.request.what.clone(),
            state: a.state.into(),
            created: time_text(a.accepted),
            updated: time_text(record.updated),
        }
    }

    /// Why an area is closed, in the supervisor's words.
    pub(crate) fn why_closed(&self, id: ClosureId) -> String {
        let found = self.view.closures.iter().find(|c| c.id == id);
        found.map_or_else(|| closure_name(id), |c| c.closure.reason.clone())
    }

    /// A closed area, in its state at `now`.
    pub fn closure(&self, id: ClosureId, closure: &Closure, now: Time) -> ClosureDto {
        let outline: Vec<Point> = closure.outline.iter().map(|s| Point::from(*s)).collect();
        let closed = match closure.nodes.as_slice() {
            [] => nodes_in(self.map, &outline),
            named => named.to_vec(),
        };
        let nodes = closed.iter().map(|n| self.map.nodes[*n].name.clone());
        let end = closure.window.end();
        ClosureDto {
            id: closure_name(id),
            outline: line(&outline),
            nodes: nodes.collect(),
            from: time_text(closure.window.start()),
            until: (!end.is_forever()).then(|| time_text(end)),
            state: closure.state(now).into(),
            binds: closure.binds.into(),
            series: closure.series.map(series_name),
            reason: closure.reason.clone(),
        }
    }

    /// What a closed area contains.
    pub fn covered(&self, closure: &Closure) -> CoveredDto {
        let outline: Vec<Point> = closure.outline.iter().map(|s| Point::from(*s)).collect();
        let Covered { nodes, stations, storage, area_m2 } = covered(self.map, &outline, &closure.nodes);
        let stations = stations.iter().map(|s| self.map.stations[*s].name.clone());
        CoveredDto { nodes: nodes.len(), stations: stations.collect(), storage, area_m2: area_m2.map(round3) }
    }

    /// A recurring closure with its occurrences that are not over.
    pub fn recurring(&self, id: SeriesId, recurring: &RecurringClosure, now: Time) -> RecurringClosureDto {
        let RecurringClosure { area, recurrence, .. } = recurring;
        let of = self
            .view
            .closures
            .iter()
            .filter(|c| c.closure.series == Some(id) && now < c.closure.window.end());
        let mut open: Vec<_> = of.collect();
        open.sort_by_key(|c| c.closure.window.start());
        let first = self.closure(ClosureId(0), area, now);
        let ahead = open.iter().map(|c| c.closure.window.start()).find(|t| now < *t);
        let next = ahead.or_else(|| recurring.due(now));
        let days = WEEKDAYS.iter().enumerate().filter(|(i, _)| recurrence.weekdays.0 >> i & 1 == 1);
        RecurringClosureDto {
            id: series_name(id),
            outline: first.outline,
            nodes: first.nodes,
            every_s: recurrence.every.as_secs_f64(),
            lasts_s: recurring.lasts().as_secs_f64(),
            weekdays: days.map(|(_, day)| *day).collect(),
            utc_offset: offset_text(recurrence.clock.offset_at(now)),
            zone: recurrence.clock.zone.clone(),
            until: (!recurrence.until.is_forever()).then(|| time_text(recurrence.until)),
            binds: area.binds.into(),
            reason: area.reason.clone(),
            next: next.map(time_text),
            occurrences: open.into_iter().map(|c| self.closure(c.id, &c.closure, now)).collect(),
        }
    }

    /// All areas that are closed now or will be.
    pub fn closures(&self) -> Vec<ClosureDto> {
        let ahead = self.view.closures.iter().filter(|c| self.view.now < c.closure.window.end());
        ahead.map(|c| self.closure(c.id, &c.closure, self.view.now)).collect()
    }

    /// An encounter.
    pub fn encounter(&self, record: &EncounterRow) -> EncounterDto {
        let e = &record.encounter;
        let m = |mm: i64| mm as f64 / 1000.0;
        EncounterDto {
            id: record.seq,
            worker: record.worker().map(worker_name),
            robot: self.robot(e.robot),
            began: time_text(e.began),
            lasted_s: (e.ended - e.began).as_secs_f64(),
            x: m(e.at.x_mm),
            y: m(e.at.y_mm),
            region: 1,
            radius: m(e.radius_mm),
            closest: m(e.closest_mm),
            robot_speed: m(e.robot_mmps),
            worker_speed: m(e.worker_mmps),
            reaction: e.reaction.into(),
            delay_s: e.delay.as_secs_f64(),
        }
    }
}
