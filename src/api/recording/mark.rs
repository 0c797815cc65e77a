//! Bookmarks: the events that people look for in a recording.
//!
//! Main types: [`Mark`], [`MarkKind`], [`Met`] (the details of an encounter). Most bookmarks follow from facts; those
//! of alarms and lost workers follow from differences between two frames. Refuses: everyday events, such as robots that
//! wait for one another.

use crate::live::Frame;
use crate::wire::sentence::SentenceSchema;
use crate::wire::text::{closure_name, round3, worker_name};
use crate::wire::words::{PresenceDto, ReactionDto};
use giveway_fleet::{
    AreaFact, Encounter, EncounterFact, Fact, FloorFact, FloorNote, Reaction, ReplanCause, RobotFact,
};
use giveway_floor::id::{Dense, RobotId, WorkerId};
use giveway_floor::text::sentence::bookmarks;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A bookmark.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Mark {
    /// When it happened, seconds from the start.
    pub at_s: f64,
    /// The kind of event.
    pub kind: MarkKind,
    /// What happened, in words.
    #[schema(value_type = SentenceSchema)]
    pub words: Sentence,
    /// The robots and workers concerned.
    pub who: Vec<String>,
    /// Where it happened, `[x, y]`, metres.
    pub place: Option<[f64; 2]>,
    /// The details of an encounter; absent from other kinds, and from recordings of versions before this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub encounter: Option<Met>,
}

/// The details of an encounter, as in `GET /v1/encounters`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Met {
    /// Id of the worker.
    #[schema(example = "w1")]
    pub worker: String,
    /// Name of the robot.
    pub robot: String,
    /// When the encounter ended, seconds from the start.
    pub ended_s: f64,
    /// Position of the worker, x in metres.
    pub x: f64,
    /// Position of the worker, y in metres.
    pub y: f64,
    /// Radius of region 1 at that time, metres.
    pub radius: f64,
    /// Closest distance between the centres, metres.
    pub closest: f64,
    /// Speed of the robot when it entered the region, metres per second.
    pub robot_speed: f64,
    /// Speed of the worker at that time, metres per second.
    pub worker_speed: f64,
    /// What the fleet did about the robot.
    #[schema(value_type = ReactionDto)]
    pub reaction: String,
    /// Delay of the robot's task against the plan when the encounter began, seconds.
    pub delay_s: f64,
}

impl Mark {
    /// The bookmark with its times shifted by `by_s` seconds.
    pub(super) fn moved(&self, by_s: f64) -> Mark {
        let later = |s: f64| round3(s + by_s);
        let met = |e: &Met| Met { ended_s: later(e.ended_s), ..e.clone() };
        Mark { at_s: later(self.at_s), encounter: self.encounter.as_ref().map(met), ..self.clone() }
    }
}

/// The kind of event that a bookmark marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MarkKind {
    /// A worker left the path.
    Deviation,
    /// A moving robot came into region 1 of a worker.
    Encounter,
    /// A robot was replanned because of a worker, a closure, a robot that cannot drive, or an obstruction.
    Replan,
    /// An operator stopped robots, or resumed them.
    Stop,
    /// A robot broke down, or works again.
    Failure,
    /// An area was closed, or opened.
    Closure,
    /// An alarm, or a worker whom nothing sees any more.
    Alarm,
}

/// Alarms for which a fact gives a better bookmark.
const BY_FACT: [&str; 3] = ["stopped", "paused", "evacuation"];

/// Whether a fact makes a bookmark.
pub fn is_notable(fact: &Fact) -> bool {
    matches!(
        fact,
        Fact::Encounter(EncounterFact::Deviated { .. } | EncounterFact::Met(_))
            | Fact::Noted(FloorNote::Replanned { .. })
            | Fact::Floor(FloorFact::Halted { .. } | FloorFact::Released { .. })
            | Fact::Robot(RobotFact::Failed { .. } | RobotFact::Repaired { .. } | RobotFact::Fenced { .. })
            | Fact::Area(AreaFact::Closed { .. } | AreaFact::Reopened { .. })
            | Fact::Floor(FloorFact::Evacuated { .. } | FloorFact::EvacuationEnded { .. })
    )
}

/// The bookmark of a fact; `zero` is the time at which seconds are zero, `frame` the first frame after the fact.
pub fn of(fact: &Fact, zero: Time, frame: &Frame) -> Option<Mark> {
    let seconds = |at: &Time| round3((*at - zero).as_secs_f64());
    let robot = |r: &RobotId| frame.robots.get(r.ix()).map(|robot| (robot.id.clone(), [robot.x, robot.y]));
    let of_robot = |kind, at: &Time, r: &RobotId, what: &dyn Fn(&str) -> Sentence| {
        let (id, place) = robot(r)?;
        let words = what(&id);
        Some(Mark { at_s: seconds(at), kind, words, who: vec![id], place: Some(place), encounter: None })
    };
    let of_all = |kind, at_s, words: Sentence, place| {
        let (who, encounter) = (Vec::new(), None);
        Mark { at_s, kind, words, who, place, encounter }
    };
    match fact {
        Fact::Encounter(EncounterFact::Deviated { worker, at }) => {
            let place = frame.workers.get(worker.ix()).and_then(|w| Some([w.x?, w.y?]));
            let words = bookmarks::left_path(called(*worker, frame));
            let who = vec![worker_name(*worker)];
            Some(Mark { at_s: seconds(at), kind: MarkKind::Deviation, words, who, place, encounter: None })
        }
        Fact::Encounter(EncounterFact::Met(e)) => Some(met(e, seconds, robot(&e.robot)?.0, frame)),
        Fact::Noted(FloorNote::Replanned { robot: r, cause, at, .. }) => {
            let (what, with) = replanned(cause, frame)?;
            let mut mark = of_robot(MarkKind::Replan, at, r, &*what)?;
            mark.who.extend(with);
            Some(mark)
        }
        Fact::Floor(FloorFact::Halted { robot: Some(r), at }) => {
            of_robot(MarkKind::Stop, at, r, &|id| bookmarks::was_paused(id))
        }
        Fact::Floor(FloorFact::Released { robot: Some(r), at }) => {
            of_robot(MarkKind::Stop, at, r, &|id| bookmarks::goes_on(id))
        }
        Fact::Floor(FloorFact::Halted { robot: None, at }) => {
            Some(of_all(MarkKind::Stop, seconds(at), bookmarks::all_were_stopped(), None))
        }
        Fact::Floor(FloorFact::Released { robot: None, at }) => {
            Some(of_all(MarkKind::Stop, seconds(at), bookmarks::all_go_on(), None))
        }
        Fact::Robot(RobotFact::Failed { robot: r, at }) => {
            of_robot(MarkKind::Failure, at, r, &|id| bookmarks::broke_down(id))
        }
        Fact::Robot(RobotFact::Repaired { robot: r, at }) => {
            of_robot(MarkKind::Failure, at, r, &|id| bookmarks::works_again(id))
        }
        Fact::Robot(RobotFact::Fenced { robot: r, at }) => {
            of_robot(MarkKind::Failure, at, r, &|id| bookmarks::was_fenced_off(id))
        }
        Fact::Floor(FloorFact::Evacuated { at }) => {
            Some(of_all(MarkKind::Alarm, seconds(at), bookmarks::was_evacuated(), None))
        }
        Fact::Floor(FloorFact::EvacuationEnded { at }) => {
            Some(of_all(MarkKind::Alarm, seconds(at), bookmarks::evacuation_ended(), None))
        }
        Fact::Area(AreaFact::Closed { closure, area }) => {
            let words = bookmarks::area_was_closed(closure_name(*closure), &area.reason);
            let place = area.outline.first().map(|p| [p.x_mm as f64 / 1000.0, p.y_mm as f64 / 1000.0]);
            Some(of_all(MarkKind::Closure, frame.time_s, words, place))
        }
        Fact::Area(AreaFact::Reopened { closure, at }) => {
            let words = bookmarks::area_was_opened(closure_name(*closure));
            Some(of_all(MarkKind::Closure, seconds(at), words, None))
        }
        _ => None,
    }
}

/// Makes a sentence about the robot of this name.
type OfRobot = Box<dyn Fn(&str) -> Sentence>;

/// What a replanned robot did, and the id of the worker or robot that caused it.
fn replanned(cause: &ReplanCause, frame: &Frame) -> Option<(OfRobot, Option<String>)> {
    Some(match cause {
        ReplanCause::Worker(worker) => {
            let name = called(*worker, frame);
            (Box::new(move |id| bookmarks::went_another_way_for(id, &name)), Some(worker_name(*worker)))
        }
        ReplanCause::Closure(closure) => {
            let area = closure_name(*closure);
            (Box::new(move |id| bookmarks::went_round(id, &area)), None)
        }
        ReplanCause::Robot(robot) => {
            let other = frame.robots.get(robot.ix())?.id.clone();
            let with = other.clone();
            (Box::new(move |id| bookmarks::went_round(id, &other)), Some(with))
        }
        ReplanCause::Obstruction => (Box::new(|id| bookmarks::went_round_obstruction(id)), None),
    })
}

/// What people call a worker: the name if there is one, else the id.
fn called(worker: WorkerId, frame: &Frame) -> String {
    frame.workers.get(worker.ix()).map_or_else(|| worker_name(worker), |w| w.name.clone())
}

fn met(e: &Encounter, seconds: impl Fn(&Time) -> f64, robot: String, frame: &Frame) -> Mark {
    let name = called(e.worker, frame);
    let metres = |mm: i64| mm as f64 / 1000.0;
    let closest_m = SentenceArg::rounded(metres(e.closest_mm), 2);
    let words = match e.reaction {
        Reaction::Kept => bookmarks::met_and_drove_on(name, &robot, closest_m),
        Reaction::Slowed => bookmarks::met_and_was_slowed(name, &robot, closest_m),
        Reaction::Held => bookmarks::met_and_had_to_wait(name, &robot, closest_m),
        Reaction::Rerouted => bookmarks::met_and_rerouted(name, &robot, closest_m),
        Reaction::Stopped => bookmarks::met_and_was_stopped(name, &robot, closest_m),
    };
    let [x, y] = [e.at.x_mm, e.at.y_mm].map(metres);
    let worker = worker_name(e.worker);
    let who = vec![worker.clone(), robot.clone()];
    let details = Met {
        worker,
        robot,
        ended_s: seconds(&e.ended),
        x,
        y,
        radius: metres(e.radius_mm),
        closest: metres(e.closest_mm),
        robot_speed: metres(e.robot_mmps),
        worker_speed: metres(e.worker_mmps),
        reaction: e.reaction.word().into(),
        delay_s: e.delay.as_secs_f64(),
    };
    let (at_s, place, encounter) = (seconds(&e.began), Some([x, y]), Some(details));
    Mark { at_s, kind: MarkKind::Encounter, words, who, place, encounter }
}

/// The bookmarks that follow from the differences between two frames.
pub fn between(old: &Frame, new: &Frame) -> Vec<Mark> {
    let mut found = Vec::new();
    let rows = |frame: &Frame| frame.alarms.as_array().cloned().unwrap_or_default();
    if old.alarms != new.alarms {
        let before = rows(old);
        // An alarm that leaves a group was reported with the group, or before it.
        let has = |alarm: &serde_json::Value, id: &serde_json::Value| {
            alarm["id"] == *id
                || alarm["members"].as_array().is_some_and(|all| all.iter().any(|m| m["id"] == *id))
        };
        let is_new = |id: &serde_json::Value| !before.iter().any(|alarm| has(alarm, id));
        for alarm in rows(new).into_iter().filter(|alarm| is_new(&alarm["id"])) {
            let by_fact = alarm["kind"].as_str().is_some_and(|id| BY_FACT.contains(&id));
            if let (false, Ok(words)) = (by_fact, Sentence::deserialize(&alarm)) {
                let encounter = None;
                let who = alarm["subject"].as_str().map(str::to_owned).into_iter().collect();
                let place = alarm["x"].as_f64().zip(alarm["y"].as_f64()).map(|(x, y)| [x, y]);
                found.push(Mark { at_s: new.time_s, kind: MarkKind::Alarm, words, who, place, encounter });
            }
        }
    }
    for (before, now) in old.workers.iter().zip(&new.workers) {
        if now.presence == PresenceDto::Lost && before.presence != PresenceDto::Lost {
            let words = bookmarks::worker_was_lost(&now.name);
            let place = now.x.zip(now.y).map(|(x, y)| [x, y]);
            let (who, encounter) = (vec![now.id.clone()], None);
            found.push(Mark { at_s: new.time_s, kind: MarkKind::Alarm, words, who, place, encounter });
        }
    }
    found
}
