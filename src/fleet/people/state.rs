//! What the fleet believes and keeps in mind about people, from step to step. Lost at a restart and seen again.
//!
//! Main types: [`HumanState`], [`Person`], [`WalkMode`]. Refuses: to decide.

use crate::people::barred::Barred;
use crate::people::intents::Intents;
use crate::people::message::Message;
use crate::state::floor::Floor;
use crate::state::regions::{KindConditions, KindRegions};
use crate::state::worker::{Guidance, GuidanceReason};
use giveway_floor::geometry::{Point, inside};
use giveway_floor::id::{AssignmentId, GoalId, IdVec, RobotId, StationId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::walkway::Walkways;
use giveway_floor::warehouse::{Cell, Warehouse};
use giveway_people::aware::{Afoot, Occupancy};
use giveway_people::human::motion::Motion;
use giveway_people::human::{Coverage, Follower, Hypothesis, Method, Presence, Track, Whereabouts};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A worker this near to the end of the path is there, metres.
const THERE_M: f64 = 0.6;

/// A person who comes no farther than this from a spot paces up and down there, metres.
const LINGERS_M: f64 = 4.0;

/// A person slower than this stands, more or less, metres per second.
pub(crate) const STROLL_MPS: f64 = 0.3;

/// Somebody who presses a button at a station is there for so long.
const USED: Span = Span::from_secs(120);

/// How a worker's walk stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum WalkMode {
    /// Nothing to do.
    #[default]
    Idle,
    /// On the path.
    Following,
    /// Off the path since then. A new path may be shown already.
    Deviating {
        /// Since when.
        since: Time,
    },
    /// Shown a new path, because the old one is blocked.
    Redirected,
    /// Told to stop, since then.
    Stopped {
        /// Since when.
        since: Time,
    },
}

/// The path that a worker was given.
#[derive(Clone, Debug)]
pub struct Plan {
    /// How far along it the worker is.
    pub follower: Follower,
    /// What it is for; nothing for a path that only leads out of the way.
    pub assignment: Option<AssignmentId>,
    /// How long the worker stays at its end.
    pub stay: Span,
    /// When it was made.
    pub made: Time,
    /// Whether the worker knows of it. A path that is only expected of a worker binds robots, and is not shown.
    pub is_shown: bool,
}

/// Which nodes a worker will take.
#[derive(Clone, Debug, Default)]
pub struct NodesTaken {
    /// For each set of regions, in the order of [`KindRegions::all`].
    pub nodes: Vec<Vec<Occupancy>>,
    /// When that was worked out, and what for.
    pub made: Option<(Time, WalkMode, u64)>,
}

/// One worker.
#[derive(Clone, Debug, Default)]
pub struct Person {
    /// Where the worker was seen.
    pub track: Track,
    /// How the worker moves just now; nothing before the first sighting that was taken in.
    pub motion: Option<Motion>,
    /// Where the worker may be going, in this step.
    pub ways: Vec<Hypothesis>,
    /// Which nodes the worker will take by the calibrated forecast, where that is what counts.
    pub occupied: NodesTaken,
    /// Whether something was seen of the worker in this step.
    pub fresh: bool,
    /// Whether the worker was put somewhere else without a walk.
    pub relocated: bool,
    /// The path that the worker is to take.
    pub plan: Option<Plan>,
    /// What the worker does about that path.
    pub mode: WalkMode,
    /// When the next way is looked for, if none was found.
    pub looks_again: Option<Time>,
    /// Counts up with every new path.
    pub version: u64,
    /// Since when the worker has been at the place of the assignment.
    pub there_since: Option<Time>,
    /// How long the worker was at the place of an assignment before leaving it: a worker who comes back goes on with
    /// it.
    pub was_there: Option<(AssignmentId, Span)>,
    /// Since when the worker has been standing.
    pub stands_since: Option<Time>,
    /// Where the worker has been pacing up and down, and since when.
    pub lingers: Option<(Point, Time)>,
    /// Since when a robot has been standing on the path just ahead.
    pub blocked_since: Option<(RobotId, Time)>,
    /// What a closed area means for the path, if anything.
    pub by_closure: Option<GuidanceReason>,
    /// The shortest way to a door while the building is evacuated, whatever robots stand on it.
    pub way_out: Vec<Point>,
    /// When closed areas were minded last.
    pub minded: Option<Time>,
    /// The robot that the worker lets pass, if one.
    pub lets_pass: Option<LetsPass>,
    /// When the worker let a robot pass last.
    pub let_pass_at: Option<Time>,
    /// When the worker's way was compared last with what robots are granted.
    pub on_time_at: Option<Time>,
    /// When the worker had waited on its way for robots for as long as anybody may.
    pub waited_at: Option<Time>,
    /// When the worker was asked last to touch marks for a robot.
    pub marks_asked: Option<Time>,
    /// The goal that was noted last, and when.
    pub goal_noted: Option<(GoalId, Time)>,
    /// What the worker is told now, and since when.
    pub message: Option<Message>,
    /// What was told last, and when.
    pub told: Option<(Guidance, Time)>,
}

/// One person lets one robot pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LetsPass {
    /// The robot.
    pub robot: RobotId,
    /// The visit at which the robot was.
    pub reached: u64,
    /// Since when.
    pub since: Time,
    /// Until when, at the latest.
    pub until: Time,
    /// What the person does for that now.
    pub stage: LetsPassStage,
}

/// What a person does who lets a robot pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LetsPassStage {
    /// Shows the headset where it is, since what it does not know closes more floor than the person.
    TouchesMarks,
    /// Walks to a place aside.
    Walks,
    /// Stands there.
    Stands,
    /// Waits on its way until the robot has passed, because that is earliest (`on_time.rs`).
    Waits,
}

/// Where the published procedure leads a worker.
#[derive(Clone, Debug)]
pub enum Led {
    /// Where it is expected to walk anyway: robots leave it this path.
    AsExpected(Vec<Point>),
    /// Along another path, which it is told.
    Redirected(Vec<Point>),
    /// Nowhere: a robot is in the way.
    Stopped {
        /// Which, if it is one.
        by: Option<RobotId>,
    },
}

/// Where the picker of a station stands.
#[derive(Clone, Debug)]
struct Workplace {
    station: StationId,
    outline: Vec<Point>,
    /// Whether a button was pressed there of late.
    is_used: bool,
}

/// All that is kept in mind about people.
#[derive(Clone, Debug)]
pub struct HumanState {
    pub walkways: Arc<Walkways>,
    pub intents: Intents,
    pub afoot: Afoot,
    pub people: IdVec<WorkerId, Person>,
    /// Whether forecasts hold.
    pub coverage: Coverage,
    /// What is closed to people.
    pub barred: Barred,
    /// Robots for which people have stood aside lately, with when they were asked last.
    pub passed: BTreeMap<RobotId, Time>,
    /// The workplaces of stations, which guards keep apart from robots.
    workplaces: Vec<Workplace>,
    /// What people mean for robots of each kind, in this step.
    pub(super) conditions: KindConditions,
}

impl HumanState {
    /// Nothing is known of any worker.
    pub fn new(warehouse: &Warehouse, regions: &KindRegions, method: Method) -> HumanState {
        let walkways = Arc::new(Walkways::of(warehouse));
        let workplace = |(station, cell): (StationId, &Cell)| Workplace {
            station,
            outline: cell.workplace.clone(),
            is_used: false,
        };
        let cells = warehouse.stations.pairs().filter_map(|(id, s)| Some(workplace((id, s.cell.as_ref()?))));
        HumanState {
            workplaces: cells.collect(),
            intents: Intents::new(warehouse, walkways.clone(), method),
            afoot: Afoot::new(warehouse, walkways.clone()),
            walkways,
            people: IdVec::new(),
            coverage: Coverage::default(),
            barred: Barred::default(),
            passed: BTreeMap::new(),
            conditions: KindConditions::none(warehouse, regions),
        }
    }

    /// The kinds of robots have changed: what is kept for each of them is found out again, in this step.
    pub(crate) fn refit(&mut self, floor: Floor<'_>) {
        self.conditions = KindConditions::none(floor.warehouse(), floor.regions);
        self.people.iter_mut().for_each(|person| person.occupied = NodesTaken::default());
    }

    /// The record of a worker.
    pub fn person(&mut self, worker: WorkerId) -> &mut Person {
        while self.people.get(worker).is_none() {
            self.people.push(Person::default());
        }
        &mut self.people[worker]
    }

    /// Where a worker is, if on the floor.
    pub fn whereabouts(&self, worker: WorkerId, now: Time) -> Option<Whereabouts> {
        self.people.get(worker)?.track.whereabouts(now)
    }

    /// Where else workers may be, if their sources do not agree.
    pub fn others(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        let people = self.people.pairs();
        people.flat_map(|(w, p)| p.track.others(now).into_iter().map(move |place| (w, place))).collect()
    }

    /// All places where workers may be among robots: robots are slow near each of them.
    pub fn places(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        self.among_robots(now).into_iter().chain(self.others(now)).collect()
    }

    /// Every worker on the floor who is not seen in the workplace of a station: there a guard is between people and
    /// robots, so people mean nothing for robots until they step out of it or are no longer seen.
    pub fn among_robots(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        let mut present = self.present(now);
        present.retain(|(_, place)| !self.is_at_workplace(place));
        present
    }

    /// Whether a worker is seen in the workplace of a station; or was seen there last, before the headset went silent,
    /// and buttons are pressed there.
    pub fn is_at_workplace(&self, place: &Whereabouts) -> bool {
        let is_seen = place.presence == Presence::Tracked;
        self.workplaces.iter().any(|w| (is_seen || w.is_used) && inside(&w.outline, place.at))
    }

    /// Notes at which stations buttons are pressed.
    pub fn note_used(&mut self, used: &BTreeMap<StationId, Time>, now: Time) {
        for workplace in &mut self.workplaces {
            workplace.is_used = used.get(&workplace.station).is_some_and(|at| now - *at < USED);
        }
    }

    /// Stations in whose workplace two persons are seen, or more.
    pub fn in_company(&self, now: Time) -> Vec<StationId> {
        let seen = self.people.iter().filter_map(|p| p.track.whereabouts(now));
        let seen: Vec<Point> = seen.filter(|w| w.presence == Presence::Tracked).map(|w| w.at).collect();
        let is_shared = |w: &&Workplace| seen.iter().filter(|at| inside(&w.outline, **at)).nth(1).is_some();
        self.workplaces.iter().filter(is_shared).map(|w| w.station).collect()
    }

    /// Every worker on the floor, where the worker most probably is.
    pub fn present(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        let people = self.people.pairs();
        people.filter_map(|(w, p)| Some((w, p.track.whereabouts(now)?))).collect()
    }
}

impl Plan {
    /// Whether a worker at this place is at the end of the path.
    pub fn is_there(&self, at: Point) -> bool {
        (at - self.follower.goal()).norm() <= THERE_M
    }
}

impl Person {
    /// Notes where the worker is: within a few metres of where it was, or somewhere else.
    pub fn note_place(&mut self, at: Point, now: Time) {
        let here = self.lingers.filter(|(spot, _)| (spot - at).norm() <= LINGERS_M);
        self.lingers = here.or(Some((at, now)));
    }

    /// Gives the worker a path.
    pub fn give(&mut self, points: Vec<Point>, assignment: Option<AssignmentId>, stay: Span, now: Time) {
        let left = self.plan.as_ref().and_then(|p| p.assignment).zip(self.there_since.take());
        self.was_there = left.map(|(id, since)| (id, now - since)).or(self.was_there);
        let follower = Follower::new(points);
        self.plan = Some(Plan { follower, assignment, stay, made: now, is_shown: true });
        self.by_closure = None;
        self.version += 1;
    }

    /// Expects the worker to walk along a path, without a word about it.
    pub fn expect(&mut self, points: Vec<Point>, now: Time) {
        self.give(points, None, Span::ZERO, now);
        self.plan.as_mut().expect("just given").is_shown = false;
    }

    /// The robot for which the worker waits on its way.
    pub fn waits(&self) -> Option<LetsPass> {
        self.lets_pass.filter(|l| l.stage == LetsPassStage::Waits)
    }

    /// The rest of the path, from where the worker is.
    pub fn rest_of_path(&self, at: Point) -> Option<Vec<Point>> {
        let plan = self.plan.as_ref()?;
        Some(std::iter::once(at).chain(plan.follower.ahead().iter().copied()).collect())
    }
}
