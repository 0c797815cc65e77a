//! Visits every state of a tiny floor within bounds, and checks for each whether the fleet makes progress from there.
//!
//! Main types: [`Exploration`], [`StateBounds`].

use super::actors::FootMove;
use super::floors::{Manner, TinyFloor};
use super::world::{QUANTUM_S, TinyMove, TinyWorld};
use crate::{GuidanceReason, GuidanceState, Who};
use giveway_floor::id::RobotId;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// If no robot makes progress for this long although all do what they may, the floor stands.
pub(super) const PATIENCE: Span = Span::from_secs(180);
/// All jobs end within this if all robots do what they may and no worker stands in their way for ever.
pub(super) const DRAIN: Span = Span::from_secs(900);

/// How many failures are told in words.
const IN_WORDS: usize = 5;

/// How far states are explored.
#[derive(Clone, Copy, Debug)]
pub(super) struct StateBounds {
    /// How many states are looked at, at most.
    pub states: usize,
    /// How many quanta from the start, at most.
    pub depth: usize,
    /// Of the states in which a robot can move, one in this many is followed to its end.
    pub sample: usize,
    /// Whether a worker who can move leaves in each end that is looked at.
    pub leaves: bool,
}

/// If robots wait, the worker is told again within this.
const TOLD_AGAIN: Span = Span::from_secs(20);

/// How the fleet goes on from a state.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Verdict {
    /// All jobs end.
    Ends,
    /// Each robot that has something to do waits only for the worker, who is told something.
    WaitsForWorker,
    /// Neither all jobs end nor robots wait only for the worker.
    Stands(String),
}

/// What was found.
#[derive(Debug, Default)]
pub(super) struct Exploration {
    pub states: usize,
    pub moves: usize,
    pub deepest: usize,
    /// Whether no state was left out.
    pub is_whole: bool,
    /// States in which no robot could move.
    pub still: usize,
    /// States that were followed to the end, and how many of them ended in waiting for the worker.
    pub followed: usize,
    pub waits: usize,
    /// The longest time until some robot made progress.
    pub longest: Span,
    /// Continuations on which the fleet failed, and the first ones in words.
    pub failed: usize,
    pub failures: Vec<String>,
    /// States that were judged.
    asked: usize,
}

/// How a worker goes on while a state is followed to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WorkerEnd {
    Stands,
    Obeys,
    Leaves,
}

fn ends(floor: &TinyFloor, bounds: StateBounds) -> &'static [WorkerEnd] {
    match floor.worker.map(|h| h.manner) {
        None | Some(Manner::Stands) => &[WorkerEnd::Stands],
        Some(Manner::Obeys | Manner::Wanders) if bounds.leaves => &[WorkerEnd::Leaves],
        Some(Manner::Obeys) => &[WorkerEnd::Obeys],
        Some(Manner::Wanders) => &[WorkerEnd::Stands, WorkerEnd::Obeys, WorkerEnd::Leaves],
    }
}

/// A state on the edge of what was explored, with the way to it.
struct EdgeState {
    world: TinyWorld,
    way: Vec<TinyMove>,
}

impl Exploration {
    pub fn of(floor: &TinyFloor, bounds: StateBounds) -> Exploration {
        let manner = floor.worker.map_or(Manner::Stands, |h| h.manner);
        let mut found = Exploration { is_whole: true, ..Exploration::default() };
        let start = TinyWorld::new(floor);
        let mut seen = BTreeSet::from([start.key()]);
        let mut layer = vec![EdgeState { world: start, way: Vec::new() }];
        let mut depth = 0;
        while !layer.is_empty() {
            found.deepest = depth;
            let mut next = Vec::new();
            let is_last = depth == bounds.depth;
            for state in layer {
                found.judge(floor, &state, bounds, is_last);
                if state.world.is_over() {
                    continue;
                }
                if is_last {
                    found.is_whole = false;
                    continue;
                }
                for m in state.world.moves(manner) {
                    found.moves += 1;
                    let way: Vec<TinyMove> = state.way.iter().cloned().chain([m.clone()]).collect();
                    let Some(world) = found.take(&state.world, &m, &way) else { continue };
                    if seen.len() >= bounds.states {
                        found.is_whole = false;
                    } else if seen.insert(world.key()) {
                        next.push(EdgeState { world, way });
                    }
                }
            }
            layer = next;
            depth += 1;
        }
        found.states = seen.len();
        found
    }

    /// The state after a move; nothing if the fleet panics, or a law is broken.
    fn take(&mut self, world: &TinyWorld, m: &TinyMove, way: &[TinyMove]) -> Option<TinyWorld> {
        let after = catch_unwind(AssertUnwindSafe(|| {
            let mut after = world.clone();
            after.take(m);
            after.assert_lawful();
            after
        }));
        match after {
            Ok(after) => Some(after),
            Err(why) => {
                self.fails(&said(&*why), way);
                None
            }
        }
    }

    /// Notes a failure; the first ones in words.
    fn fails(&mut self, why: &str, way: &[TinyMove]) {
        self.failed += 1;
        if self.failures.len() < IN_WORDS {
            self.failures.push(format!("after {:?}: {why}", in_short(way)));
        }
    }

    /// Follows a state to its end if no robot can move in it, if the exploration ends there, or if it is of the sample.
    fn judge(&mut self, floor: &TinyFloor, state: &EdgeState, bounds: StateBounds, is_last: bool) {
        let is_still = state.world.able().iter().all(|able| !able);
        self.still += usize::from(is_still);
        let is_sample = self.asked.is_multiple_of(bounds.sample);
        self.asked += 1;
        if !(is_still || is_last || is_sample) {
            return;
        }
        for end in ends(floor, bounds) {
            self.followed += 1;
            match catch_unwind(AssertUnwindSafe(|| follow(&state.world, *end))) {
                Ok((Verdict::Ends, longest)) => self.longest = self.longest.max(longest),
                Ok((Verdict::WaitsForWorker, _)) => self.waits += 1,
                Ok((Verdict::Stands(why), _)) => self.fails(&why, &state.way),
                Err(why) => self.fails(&format!("worker {end:?}: {}", said(&*why)), &state.way),
            }
        }
    }
}

/// Lets all robots do what they may, until all is over or none makes progress. Also the longest time until one did.
fn follow(world: &TinyWorld, end: WorkerEnd) -> (Verdict, Span) {
    let mut world = world.clone();
    let worker = if end == WorkerEnd::Obeys { FootMove::Follows } else { FootMove::Stays };
    if end == WorkerEnd::Leaves {
        world.dismiss();
    }
    let (began, mut longest) = (world.now, Span::ZERO);
    world.progress = began;
    let mut lately = Lately::default();
    while !world.is_over() {
        let since = world.progress;
        let moves = vec![true; world.robots.len()];
        world.take(&TinyMove { moves, worker });
        world.assert_lawful();
        lately.note(&world);
        if world.now - world.progress > PATIENCE || world.now - began > DRAIN {
            return (judge_end(&world, &lately, end), longest);
        }
        longest = longest.max(world.now - since - Span::from_secs(QUANTUM_S));
    }
    (Verdict::Ends, longest)
}

/// When things last happened, while a state is followed to its end.
#[derive(Debug, Default)]
struct Lately {
    /// When robots gave way to the worker, and waited for nothing else, or stood since their scanners saw a person.
    gave_way: BTreeMap<RobotId, Time>,
    /// When the worker was told something, and when the worker was asked to make room.
    told: Option<Time>,
    asked: Option<Time>,
}

impl Lately {
    fn note(&mut self, world: &TinyWorld) {
        for robot in world.robots.iter().map(|r| r.id) {
            let root = world.fleet.waits(robot, world.now).last().map(|l| l.who);
            let gives_way = matches!(root, Some(Who::Worker(_)));
            if gives_way || world.is_scanning(robot) {
                self.gave_way.insert(robot, world.now);
            }
        }
        let Some(told) = world.worker.as_ref().map(|p| (p.told.state, p.told.reason)) else { return };
        if told != (GuidanceState::Idle, None) {
            self.told = Some(world.now);
        }
        if matches!(told.1, Some(GuidanceReason::RobotWaits(_) | GuidanceReason::CutsOff)) {
            self.asked = Some(world.now);
        }
    }
}

/// Whether all robots with something to do have lately waited only for the worker, who is told something. They may try
/// another way now and then.
fn judge_end(world: &TinyWorld, lately: &Lately, end: WorkerEnd) -> Verdict {
    let gave_way = |r: &RobotId| lately.gave_way.get(r).is_some_and(|t| world.now - *t < PATIENCE);
    // A robot without a job makes room, or looks for a place to park, while the worker keeps the others waiting.
    let has_a_job = |r: &RobotId| world.fleet.ledger().robots[*r].task.job().is_some();
    let is_busy = |r: &RobotId| !world.is_idle(*r) && has_a_job(r);
    let busy: Vec<RobotId> = world.robots.iter().map(|r| r.id).filter(is_busy).collect();
    // Between two requests a moment passes.
    let just_now = |at: Option<Time>| at.is_some_and(|t| world.now - t < TOLD_AGAIN);
    let waits = match end {
        WorkerEnd::Stands => just_now(lately.told),
        // A worker who obeys is asked to make room, but no place aside is known: leaving the floor is up to the worker.
        WorkerEnd::Obeys => just_now(lately.asked),
        WorkerEnd::Leaves => false,
    };
    if busy.iter().all(gave_way) && waits {
        return Verdict::WaitsForWorker;
    }
    let person = world.worker.as_ref().map(|p| p.at);
    let told = world.worker.as_ref().map(|p| (p.told.state, p.told.reason));
    let path = world.worker.as_ref().map(|p| &p.told.path);
    let mut text = format!("worker {end:?} at {person:?}, told {told:?} {path:?}");
    for robot in world.robots.iter().filter(|r| !world.is_idle(r.id)) {
        let waits = world.fleet.waits(robot.id, world.now);
        let links: Vec<_> = waits.iter().map(|l| (l.who, l.because)).collect();
        let at = robot.at(&world.warehouse());
        let lately = gave_way(&robot.id);
        let task = world.fleet.ledger().robots[robot.id].task;
        text += &format!(
            "; {:?} at {},{} visit {} gave way lately {lately} limit {:?} {task:?} {links:?}",
            robot.id, at.x, at.y, robot.reached, robot.limit_mps
        );
    }
    let jobs = world.fleet.ledger().jobs.iter().filter(|(_, job)| job.state.robot().is_none());
    for (id, _) in jobs {
        let waits = world.fleet.job_waits(*id, world.now);
        text += &format!("; {id:?} {:?}", waits.iter().map(|l| l.because).collect::<Vec<_>>());
    }
    Verdict::Stands(text)
}

fn said(why: &(dyn std::any::Any + Send)) -> String {
    let text = why.downcast_ref::<String>().map(String::as_str);
    format!("panics: {}", text.or(why.downcast_ref::<&str>().copied()).unwrap_or("?"))
}

fn in_short(way: &[TinyMove]) -> String {
    let word = |m: &TinyMove| {
        let robots: String = m.moves.iter().map(|b| if *b { '1' } else { '0' }).collect();
        match m.worker {
            FootMove::Stays => robots,
            FootMove::Follows => robots + "f",
            FootMove::Towards(p) => format!("{robots}>{},{}", p.x, p.y),
        }
    };
    way.iter().map(word).collect::<Vec<_>>().join(" ")
}

/// How the fleet goes on after these moves, written as by [`in_short`], if the worker obeys from then on, or stands.
pub(super) fn replay(floor: &TinyFloor, way: &str, obeys: bool) -> Verdict {
    let mut world = TinyWorld::new(floor);
    way.split_whitespace().map(parsed).for_each(|m| world.take(&m));
    follow(&world, if obeys { WorkerEnd::Obeys } else { WorkerEnd::Stands }).0
}

/// The move that [`in_short`] wrote.
fn parsed(word: &str) -> TinyMove {
    let robots: Vec<bool> = word.chars().take_while(|c| "01".contains(*c)).map(|c| c == '1').collect();
    let rest = &word[robots.len()..];
    let worker = match rest.chars().next() {
        None => FootMove::Stays,
        Some('f') => FootMove::Follows,
        _ => {
            let (x, y) = rest[1..].split_once(',').expect("a place has two numbers");
            let number = |s: &str| s.parse::<f64>().expect("a number");
            FootMove::Towards(giveway_floor::geometry::Point::new(number(x), number(y)))
        }
    };
    TinyMove { moves: robots, worker }
}
