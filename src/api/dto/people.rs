//! People as they travel: workers, assignments, closures, encounters.
//!
//! Main types: [`WorkerDto`], [`WorkerDetailDto`], [`AssignmentDto`], [`ClosureDto`], [`EncounterDto`]. Workers are
//! "w1", assignments "a1", closures "c1". Refuses: to add knowledge of its own.

use super::guidance::{line, reason};
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
    /// Its number.
    #[schema(example = "w1")]
    pub id: String,
    /// The name under which the worker was registered, for those who may see names (docs/secure.md); else, and in all
    /// feeds, a pseudonym such as `worker-3f2a`.
    pub name: String,
    /// Whether the worker is on the floor, and how well the place is known.
    pub presence: PresenceDto,
    /// Metres; null if the worker has not been seen.
    pub x: Option<f64>,
    /// Metres.
    pub y: Option<f64>,
    /// Radians, counter-clockwise from the x axis.
    pub heading: Option<f64>,
    /// When the worker was seen last, RFC 3339.
    pub seen: Option<String>,
    /// Metres per second.
    pub speed: f64,
    /// One standard deviation of the position, metres; it grows while no pose comes.
    pub accuracy: f64,
    /// Where a lost worker may be by now: `[x, y]` of nodes that robots keep out of, metres; empty if the worker is
    /// seen.
    pub area: Vec<[f64; 2]>,
    /// Radii of the stop, keep-out and slow zones around the worker, metres.
    pub regions: [f64; 3],
    /// What the worker is told.
    pub state: GuidanceStateDto,
    /// Why, in words.
    #[schema(value_type = Option<SentenceSchema>)]
    pub reason: Option<Sentence>,
    /// Counts up with every new path.
    pub version: u64,
    /// The path from here on, metres.
    pub path: Vec<[f64; 2]>,
    /// When its end is reached at usual speed, RFC 3339.
    pub eta: Option<String>,
    /// What the path is for.
    #[schema(example = "a3")]
    pub assignment: Option<String>,
    /// Where the worker may be going, most probable first.
    pub goals: Vec<GoalDto>,
    /// Probability that the goal cannot be told yet.
    pub undecided: f64,
    /// Probability of going somewhere else.
    pub elsewhere: f64,
    /// What became of the poses.
    pub feed: FeedDto,
}

/// A place where a worker may be going.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct GoalDto {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Probability.
    pub p: f64,
}

/// What became of a worker's poses.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct FeedDto {
    /// Accepted.
    pub taken: u64,
    /// Older than the newest, or seen already.
    pub late: u64,
    /// Too far from where the worker could be.
    pub jumps: u64,
    /// Could not be true.
    pub absurd: u64,
}

/// One worker, with what the headset says besides.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct WorkerDetailDto {
    /// As in the list of workers.
    #[serde(flatten)]
    pub worker: WorkerDto,
    /// Whether a headset is connected.
    pub connected: bool,
    /// The version of the guidance that the headset showed last.
    pub acknowledged: Option<u64>,
    /// How wrong the times of the headset's poses may be, milliseconds; null if its clock is not known.
    pub clock_error_ms: Option<f64>,
    /// How long ago the newest pose was seen, seconds.
    pub age_s: Option<f64>,
    /// What the worker has most probably been up to over the last hundred metres or so, the oldest first: the most
    /// probable sequence, which may differ from the goal that is most probable at any one moment.
    pub sequence: Vec<EpisodeDto>,
    /// Gaze, hands and charge.
    #[serde(flatten)]
    pub senses: SensesDto,
}

/// A stretch of time in which a worker was most probably up to the same thing.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EpisodeDto {
    /// What the worker was up to.
    pub state: IntentStateDto,
    /// Metres; null if it is no goal.
    pub x: Option<f64>,
    /// Metres.
    pub y: Option<f64>,
    /// Since when, RFC 3339.
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
    /// Where the worker looks.
    pub gaze: Option<GazeDto>,
    /// The worker's hands.
    pub hands: HandsDto,
}

/// A ray: map x, map y, height.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct GazeDto {
    /// What it comes from.
    pub kind: GazeKind,
    /// Where it begins, metres.
    pub origin: [f64; 3],
    /// Its direction, of length one.
    pub dir: [f64; 3],
}

/// Joints of hands, each map x, map y, height, radius, metres.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct HandsDto {
    /// Left.
    pub l: Option<Vec<[f64; 4]>>,
    /// Right.
    pub r: Option<Vec<[f64; 4]>>,
}

/// What a worker is to do.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct AssignmentDto {
    /// Its number.
    #[schema(example = "a3")]
    pub id: String,
    /// The worker; null while it waits for the nearest one who is free. Of one that is over, administrators alone are
    /// told.
    #[schema(example = "w1")]
    pub worker: Option<String>,
    /// The node to go to.
    pub place: String,
    /// How long it takes there, seconds.
    pub stay_s: f64,
    /// What, in the customer's words.
    pub what: String,
    /// How far it has come.
    pub state: AssignmentStateDto,
    /// When it was accepted, RFC 3339.
    pub created: String,
    /// When its state changed last, RFC 3339.
    pub updated: String,
}

/// An area that robots, people or both keep out of.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ClosureDto {
    /// Its number.
    #[schema(example = "c2")]
    pub id: String,
    /// Its corners, metres.
    pub outline: Vec<[f64; 2]>,
    /// Nodes that are closed, by name: on them, a robot would reach into the outline.
    pub nodes: Vec<String>,
    /// From when, RFC 3339.
    pub from: String,
    /// Until when, RFC 3339; null if it stays closed until somebody opens it.
    pub until: Option<String>,
    /// Whether it is closed.
    pub state: ClosureStateDto,
    /// Whom it keeps out.
    pub binds: BindsDto,
    /// The recurring closure of which it is an occurrence.
    #[schema(example = "s1")]
    pub series: Option<String>,
    /// Why.
    pub reason: String,
}

/// What a closed area covers.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CoveredDto {
    /// How many nodes are closed.
    #[schema(example = 12)]
    pub nodes: usize,
    /// Stations at which no robot can stand, by name.
    pub stations: Vec<String>,
    /// How many of the nodes are storage.
    pub storage: usize,
    /// The area inside the outline, square metres; null where nodes are named.
    #[schema(example = 37.5)]
    pub area_m2: Option<f64>,
}

/// An area that is closed again and again.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RecurringClosureDto {
    /// Its number.
    #[schema(example = "s1")]
    pub id: String,
    /// Its corners, metres.
    pub outline: Vec<[f64; 2]>,
    /// Nodes that are closed, by name: on them, a robot would reach into the outline.
    pub nodes: Vec<String>,
    /// From one occurrence to the next, seconds; a day for those on weekdays.
    pub every_s: f64,
    /// How long each occurrence lasts in which no clock changes, seconds.
    pub lasts_s: f64,
    /// The days of the week on which occurrences begin.
    pub weekdays: Vec<WeekdayDto>,
    /// How far the building's time is ahead of UTC, now.
    #[schema(example = "+01:00")]
    pub utc_offset: String,
    /// The time zone whose clocks it follows; null where the offset is fixed.
    #[schema(example = "Europe/Berlin")]
    pub zone: Option<String>,
    /// No occurrence begins then or later, RFC 3339; null if it recurs until somebody ends it.
    pub until: Option<String>,
    /// Whom it keeps out.
    pub binds: BindsDto,
    /// Why.
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
    /// Its number, growing.
    pub id: i64,
    /// The worker; null when that has been forgotten, after `people_keep_days` or since the person was erased.
    #[schema(example = "w1")]
    pub worker: Option<String>,
    /// Name of the robot.
    pub robot: String,
    /// When it began, RFC 3339.
    pub began: String,
    /// How long the robot was in the region, seconds.
    pub lasted_s: f64,
    /// Where the worker was, metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Which region of the worker the robot came into: always 1 at present.
    pub region: u8,
    /// Radius of that region then, between the centres, metres.
    pub radius: f64,
    /// Closest distance between the centres, metres.
    pub closest: f64,
    /// Speed of the robot when it came in, metres per second.
    pub robot_speed: f64,
    /// Speed of the worker then.
    pub worker_speed: f64,
    /// What the fleet did about the robot.
    pub reaction: ReactionDto,
    /// How much later the task that the robot had when it began ends than was planned then, seconds; as known at the
    /// end of the encounter.
    pub delay_s: f64,
}

/// The words for the states of an assignment, in order of life.
pub const ASSIGNMENT_STATES: [AssignmentState; 5] = [
    AssignmentState::Waiting,
    AssignmentState::Walking,
    AssignmentState::Working,
    AssignmentState::Done,
    AssignmentState::Cancelled,
];

impl Names<'_> {
    /// All workers of the view, each at its number; a place that is free has no name.
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

    /// A worker of whom the view has nothing yet.
    pub fn absent_worker(id: WorkerId, name: String) -> WorkerDto {
        WorkerDto {
            id: worker_name(id),
            name,
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

    /// A closed area, as it stands `now`.
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

    /// What a closed area covers.
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

    /// All areas that are closed, now or later.
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
