//! What the fleet believes and remembers about people, from step to step. Lost at a restart and seen again.
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
use giveway_people::human::{Coverage, Follower, Hypothesis, Method, Mover, Presence, Track, Whereabouts};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A worker this near to the end of the path is there, metres.
const THERE_M: f64 = 0.6;

/// A person who goes no farther than this from a spot is pacing up and down there, metres.
const LINGERS_M: f64 = 4.0;

/// A person slower than this stands, more or less, metres per second.
pub(crate) const STROLL_MPS: f64 = 0.3;

/// How long a person is taken to be at a station after pressing a button there.
const USED: Span = Span::from_secs(120);

/// The state of a worker's walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum WalkMode {
    /// The worker has nothing to do.
    #[default]
    Idle,
    /// The worker is on the path.
    Following,
    /// The worker is off the path. A new path may be shown already.
    Deviating {
        /// When the worker left the path.
        since: Time,
    },
    /// The worker is shown a new path, because the old one is blocked.
    Redirected,
    /// The worker is told to stop.
    Stopped {
        /// Since when the worker has been told to stop.
        since: Time,
    },
}

/// The path that a worker was given.
#[derive(Clone, Debug)]
pub struct Plan {
    /// How far along the path the worker is.
    pub follower: Follower,
    /// The assignment that the path is for; nothing for a path that only leads out of the way.
    pub assignment: Option<AssignmentId>,
    /// How long the worker stays at the end of the path.
    pub stay: Span,
    /// When the path was made.
    pub made: Time,
    /// Whether the worker knows of the path. A path that is only expected of a worker restricts robots, and is not
    /// shown.
    pub is_shown: bool,
}

/// The nodes that a worker will take.
#[derive(Clone, Debug, Default)]
pub struct NodesTaken {
    /// The nodes for each set of regions, in the order of [`KindRegions::all`].
    pub nodes: Vec<Vec<Occupancy>>,
    /// When the nodes were computed, and for which mode and version of the path.
    pub made: Option<(Time, WalkMode, u64)>,
}

/// One worker.
#[derive(Clone, Debug, Default)]
pub struct Person {
    /// Where the worker was seen.
    pub track: Track,
    /// How the worker moves just now; nothing before the first sighting that was accepted.
    pub motion: Option<Motion>,
    /// Where the worker may be going, in this step.
    pub ways: Vec<Hypothesis>,
    /// The nodes that the worker will take by the calibrated forecast, if that is in use.
    pub occupied: NodesTaken,
    /// Whether the worker was seen in this step.
    pub fresh: bool,
    /// Whether the worker's place changed without a walk.
    pub relocated: bool,
    /// The path that the worker is to take.
    pub plan: Option<Plan>,
    /// The state of the worker's walk.
    pub mode: WalkMode,
    /// When a way is searched for again, if none was found.
    pub looks_again: Option<Time>,
    /// Counts up with every new path.
    pub version: u64,
    /// Since when the worker has been at the place of the assignment.
    pub there_since: Option<Time>,
    /// How long the worker was at the place of an assignment before leaving it: a worker who comes back continues from
    /// there.
    pub was_there: Option<(AssignmentId, Span)>,
    /// Since when the worker has been standing.
    pub stands_since: Option<Time>,
    /// Where the worker has been pacing up and down, and since when.
    pub lingers: Option<(Point, Time)>,
    /// Since when a robot has been standing on the path just ahead.
    pub blocked_since: Option<(RobotId, Time)>,
    /// How a closed area affects the path, if one does.
    pub by_closure: Option<GuidanceReason>,
    /// The shortest way to a door while the building is evacuated, whatever robots stand on it.
    pub way_out: Vec<Point>,
    /// When closed areas were last checked for the worker.
    pub minded: Option<Time>,
    /// How the worker lets a robot pass, if at all.
    pub lets_pass: Option<LetsPass>,
    /// When the worker last let a robot pass.
    pub let_pass_at: Option<Time>,
    /// When the worker's way was last compared with what robots are granted.
    pub on_time_at: Option<Time>,
    /// When the worker had waited for robots for as long as a worker may.
    pub waited_at: Option<Time>,
    /// When the worker was last asked to touch marks for a robot.
    pub marks_asked: Option<Time>,
    /// The goal that was last recorded, and when.
    pub goal_noted: Option<(GoalId, Time)>,
    /// What the worker is told now, and since when.
    pub message: Option<Message>,
    /// The guidance that was last sent, and when.
    pub told: Option<(Guidance, Time)>,
}

/// One person lets one robot pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LetsPass {
    /// The robot.
    pub robot: RobotId,
    /// The visit at which the robot was when this began.
    pub reached: u64,
    /// Since when the person lets the robot pass.
    pub since: Time,
    /// Until when at the latest the person lets the robot pass.
    pub until: Time,
    /// What the person does for that now.
    pub stage: LetsPassStage,
}

/// What a person who lets a robot pass is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LetsPassStage {
    /// The person shows the headset where it is, since its uncertainty closes more floor than the person does.
    TouchesMarks,
    /// The person walks to a place aside.
    Walks,
    /// The person stands aside.
    Stands,
    /// The person waits on the way until the robot has passed, because that is fastest (`on_time.rs`).
    Waits,
}

/// Where the published procedure leads a worker.
#[derive(Clone, Debug)]
pub enum Led {
    /// Along the path on which the worker is expected to walk anyway: robots leave it free.
    AsExpected(Vec<Point>),
    /// Along another path, which the worker is told.
    Redirected(Vec<Point>),
    /// Nowhere: a robot is in the way.
    Stopped {
        /// The robot, if one is found.
        by: Option<RobotId>,
    },
}

/// The place where the picker of a station stands.
#[derive(Clone, Debug)]
struct Workplace {
    station: StationId,
    outline: Vec<Point>,
    /// Whether a button was pressed there lately.
    is_used: bool,
}

/// All that is remembered about people.
#[derive(Clone, Debug)]
pub struct HumanState {
    pub walkways: Arc<Walkways>,
    pub intents: Intents,
    pub afoot: Afoot,
    pub people: IdVec<WorkerId, Person>,
    /// Whether forecasts have come true.
    pub coverage: Coverage,
    /// What is closed to people.
    pub barred: Barred,
    /// Robots for which people have stood aside lately, with when people were last asked to.
    pub passed: BTreeMap<RobotId, Time>,
    /// The workplaces of stations, which guards keep apart from robots.
    workplaces: Vec<Workplace>,
    /// The conditions that people cause for robots of each kind, in this step.
    pub(super) conditions: KindConditions,
}

impl HumanState {
    /// The state in which nothing is known of any worker.
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

    /// Drops what is kept for each robot kind, after the kinds have changed; it is computed again in this step.
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

    /// What a worker moves as.
    pub fn mover(&self, worker: WorkerId) -> Mover {
        self.people.get(worker).map_or(Mover::OnFoot, |person| person.track.mover())
    }

    /// Where a worker is, if on the floor.
    pub fn whereabouts(&self, worker: WorkerId, now: Time) -> Option<Whereabouts> {
        self.people.get(worker)?.track.whereabouts(now)
    }

    /// Where else workers may be, if their sources disagree.
    pub fn others(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        let people = self.people.pairs();
        people.flat_map(|(w, p)| p.track.others(now).into_iter().map(move |place| (w, place))).collect()
    }

    /// All places where workers may be among robots: robots are slow near each of them.
    pub fn places(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        self.among_robots(now).into_iter().chain(self.others(now)).collect()
    }

    /// Every worker on the floor who is not seen in the workplace of a station: a guard there separates people from
    /// robots, so people do not restrict robots until they step out or are no longer seen.
    pub fn among_robots(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        let mut present = self.present(now);
        present.retain(|(_, place)| !self.is_at_workplace(place));
        present
    }

    /// Whether a worker is seen in the workplace of a station; or was last seen there before the headset went silent,
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

    /// Stations in whose workplace two or more people are seen.
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
    /// Notes where the worker is: within a few metres of the spot noted before, or in a new one.
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

    /// Expects the worker to walk along a path, without telling the worker.
    pub fn expect(&mut self, points: Vec<Point>, now: Time) {
        self.give(points, None, Span::ZERO, now);
        self.plan.as_mut().expect("just given").is_shown = false;
    }

    /// How the worker waits for a robot on the way, if so.
    pub fn waits(&self) -> Option<LetsPass> {
        self.lets_pass.filter(|l| l.stage == LetsPassStage::Waits)
    }

    /// The rest of the path, from where the worker is.
    pub fn rest_of_path(&self, at: Point) -> Option<Vec<Point>> {
        let plan = self.plan.as_ref()?;
        Some(std::iter::once(at).chain(plan.follower.ahead().iter().copied()).collect())
    }
}
