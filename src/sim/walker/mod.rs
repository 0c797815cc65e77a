//! A simulated worker: walks where the device shows, works, and sometimes does something else.
//!
//! Main types: [`Walker`], [`Shown`] (what the device shows), [`WorkKnowledge`] (what it knows of its work),
//! [`WalkCause`] and [`CauseStretch`] (the truth about it). Legs, character and impulses are files of their own; this
//! one joins them. Refuses: to walk through racks, through holes that lifted racks leave, or through robots; to tell
//! the fleet why.

mod cause;
mod crossing;
mod decide;
mod driving;
mod impulse;
mod legs;
mod pass;
mod people;
mod person;
mod persona;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_people;

pub use cause::{CauseStretch, Log, WalkCause};
pub use driving::parts;
pub use legs::{RobotNear, WalkerSurroundings, ease};
pub use person::{APART_M, BODY_M, PersonNear};
pub use persona::Traits;

use crate::random::Stream;
use crate::scenario::Workers;
use giveway_floor::geometry::{Point, Pose, Vector};
use giveway_floor::id::AssignmentId;
use giveway_floor::time::{Span, Time};
use giveway_people::human::Mover;
use impulse::Impulses;
use legs::Legs;
use std::collections::VecDeque;

/// A walker that people have kept for this long takes action.
const KEPT: Span = Span::from_millis(1500);
/// After this long, the walker tries to squeeze past.
const SQUEEZES: Span = Span::from_millis(700);

/// Something to do at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errand {
    /// Number of the assignment.
    pub id: AssignmentId,
    /// Where a person stands for the errand.
    pub at: Point,
    /// Duration of the errand.
    pub stay: Span,
}

/// What the device shows the walker.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Version of the path, which counts up with every new one.
    pub version: u64,
    /// The path to walk; empty if none is shown.
    pub path: Vec<Point>,
    /// Whether the device says that the path differs from the one before.
    pub redirected: bool,
    /// Whether the device says to stop.
    pub stop: bool,
    /// Whether the device says to leave: the building, or a closed area.
    pub leave: bool,
}

/// What a walker knows of its work and of the hall.
#[derive(Clone, Debug)]
pub struct WorkKnowledge<'a> {
    /// The next errand.
    pub job: Option<Errand>,
    /// Places that everybody knows, including the fleet.
    pub known: &'a [Point],
    /// Positions of colleagues.
    pub colleagues: &'a [Point],
    /// The colleague who walks in a pair with this walker.
    pub companion: Option<PersonNear>,
}

/// A walker's current activity.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WalkerDoing {
    /// Follows the shown path, or its own way to work; or waits for either.
    Duty,
    /// Works until this time.
    Work(AssignmentId, Time),
    /// Goes to another place, and stays there.
    Job { cause: WalkCause, goal: Point, stay: Span, until: Option<Time> },
    /// Walks about until this time.
    Wander(Time),
    /// Goes to a door for good.
    Leave(Point),
    /// Is off the floor.
    Gone,
}

/// A step aside, with the end of the stay once the walker is there.
#[derive(Clone, Copy, Debug)]
struct Aside {
    goal: Point,
    stay: Span,
    until: Option<Time>,
}

/// One worker on the floor.
#[derive(Debug)]
pub struct Walker {
    /// The walker's character.
    pub traits: Traits,
    /// Assignments that the walker has finished, in order; the reader takes them out.
    pub finished: Vec<AssignmentId>,
    legs: Legs,
    doing: WalkerDoing,
    impulses: Impulses,
    heeds: Stream,
    strolls: Stream,
    ignore: f64,
    /// What the device shows, and what the walker will notice later, with times.
    shown: Option<Shown>,
    news: VecDeque<(Time, Shown)>,
    /// The version of the path that the route follows, and the version that the walker ignored.
    followed: Option<u64>,
    ignored: Option<u64>,
    idle_since: Time,
    pause_until: Time,
    look_until: Time,
    reacts_until: Time,
    calm_until: Time,
    blocked_since: Option<(Time, Point)>,
    /// The walker's number, then since when and where people have kept it from walking on.
    who: usize,
    kept_since: Option<(Time, Point)>,
    /// The walker's true velocity in the last tick, metres per second.
    velocity: Vector,
    /// How long the walker has stood for crossing robots, and until when it does not wait for any.
    waited: Span,
    waits_no_more_until: Time,
    /// Since when the walker has come no nearer to the place of its errand, and how near that was, metres.
    nearer_since: Option<(Time, f64)>,
    detour: bool,
    aside: Option<Aside>,
    log: Log,
}

impl Walker {
    /// Worker number `who` of a scenario that began at `start`, entering at a door.
    pub(super) fn new(workers: &Workers, seed: u64, who: u64, at: Point, start: Time, now: Time) -> Walker {
        let traits = Traits::draw(&workers.personas, Stream::new(seed, 30, who));
        let mut impulses = Impulses::new(&workers.deviations, seed, who, start);
        // Impulses from before the walker entered are dropped.
        while impulses.due(now).is_some() {}
        let mover = workers.mover_of(who as usize);
        let traits = if mover == Mover::OnFoot { traits } else { traits.at_the_wheel(mover) };
        let mut legs = Legs::new(at, traits.cut_m, traits.phase);
        if let Mover::Vehicle(vehicle) = mover {
            legs.vehicle = Some(vehicle);
        }
        Walker {
            finished: Vec::new(),
            legs,
            doing: WalkerDoing::Duty,
            impulses,
            heeds: Stream::new(seed, 31, who),
            strolls: Stream::new(seed, 32, who),
            ignore: workers.deviations.causes.rates().ignore,
            shown: None,
            news: VecDeque::new(),
            followed: None,
            ignored: None,
            idle_since: now,
            pause_until: now,
            look_until: now,
            reacts_until: now,
            calm_until: now,
            blocked_since: None,
            who: who as usize,
            kept_since: None,
            velocity: Vector::zeros(),
            waited: Span::ZERO,
            waits_no_more_until: now,
            nearer_since: None,
            detour: false,
            aside: None,
            log: Log::default(),
            traits,
        }
    }

    /// Takes what the device shows from now on; the walker notices it after its reaction time.
    pub fn hear(&mut self, now: Time, shown: Shown) {
        self.news.push_back((now + self.traits.reaction, shown));
    }

    /// Sends the walker to a door for good.
    pub fn send_home(&mut self, door: Point) {
        if !matches!(self.doing, WalkerDoing::Leave(_) | WalkerDoing::Gone) {
            self.doing = WalkerDoing::Leave(door);
            self.legs.route.clear();
        }
    }

    /// Whether the walker is off the floor.
    pub fn is_gone(&self) -> bool {
        self.doing == WalkerDoing::Gone
    }

    /// Advances the walker by `dt` seconds, up to `now`.
    pub fn tick(&mut self, now: Time, dt: f64, around: &WalkerSurroundings<'_>, work: &WorkKnowledge<'_>) {
        self.notice(now, around, work);
        self.decide(now, around, work);
        let foresight = self.traits.foresight_s();
        let wanted = self.wanted_mps(now);
        // A driver looks along the way for what crosses it (`driving.rs`).
        let wanted = match self.legs.vehicle {
            Some(_) => wanted,
            None => self.pace_for_robots(now, dt, wanted, around),
        };
        let wanted = self.pace_with(work.companion, wanted);
        let before = self.legs.at;
        self.legs.is_kept = self.kept_since.is_some_and(|(since, _)| now - since > SQUEEZES);
        self.legs.walk(dt, wanted, foresight, around);
        self.velocity = (self.legs.at - before) / dt;
        self.give_up_waiting(now, around, work);
        self.get_past_people(now, around);
        let (cause, goal) = self.cause(now, work);
        self.log.note(now, cause, goal);
        if self.is_gone() {
            self.log.close(now);
        }
    }

    /// The walker's true position, and where its head faces.
    pub fn pose(&self, now: Time) -> Pose {
        let turns = if self.legs.vehicle.is_some() { 0.0 } else { self.head_turn(now) };
        Pose { at: self.legs.trunk(now), heading: self.legs.heading + turns }
    }

    /// The walker as other walkers see it.
    pub fn seen(&self, now: Time) -> PersonNear {
        let legs = &self.legs;
        PersonNear {
            who: self.who,
            at: legs.at,
            velocity: self.velocity,
            aim: legs.route.front().copied().filter(|_| self.wanted_mps(now) > 0.0),
            works: matches!(self.doing, WalkerDoing::Work(..)),
            kept: self.kept_since.is_some_and(|(since, _)| now - since > KEPT),
            usual_mps: self.traits.speed_mps,
        }
    }

    /// What the walker moves as.
    pub fn mover(&self) -> Mover {
        self.legs.vehicle.map_or(Mover::OnFoot, Mover::Vehicle)
    }

    /// The walker's true velocity, metres per second.
    pub fn velocity(&self) -> Vector {
        self.velocity
    }

    /// The walker's true position on its way, without the sway of its trunk.
    pub fn way_at(&self) -> Point {
        self.legs.at
    }

    /// The walker's true speed, metres per second.
    pub fn speed_mps(&self) -> f64 {
        self.legs.speed_mps
    }

    /// Metres walked so far.
    pub fn walked_m(&self) -> f64 {
        self.legs.walked_m
    }

    /// The truth about the walker so far.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// The head's direction relative to the body, radians: up to 60° while looking around, slightly turned while
    /// standing with the phone.
    fn head_turn(&self, now: Time) -> f64 {
        let swing = (1.5 * now.as_secs_f64() + self.traits.phase).sin();
        match () {
            () if now < self.look_until => swing * std::f64::consts::FRAC_PI_3,
            () if now < self.pause_until => 0.15 * swing,
            () => 0.0,
        }
    }

    fn cause(&self, now: Time, work: &WorkKnowledge<'_>) -> (WalkCause, Option<Point>) {
        let duty = work.job.map(|j| j.at);
        let on_way = if self.detour || self.aside.is_some() { Some(WalkCause::Detour) } else { None };
        match self.doing {
            WalkerDoing::Job { cause, goal, .. } => (cause, Some(goal)),
            WalkerDoing::Wander(_) => (WalkCause::Wander, None),
            WalkerDoing::Leave(door) => (on_way.unwrap_or(WalkCause::OnPath), Some(door)),
            WalkerDoing::Gone | WalkerDoing::Work(..) => (WalkCause::OnPath, duty),
            WalkerDoing::Duty if on_way.is_some() => (WalkCause::Detour, duty),
            WalkerDoing::Duty if self.ignored.is_some() => (WalkCause::IgnoresGuidance, duty),
            WalkerDoing::Duty if now < self.reacts_until => (WalkCause::Reaction(self.traits.persona), duty),
            WalkerDoing::Duty if now < self.pause_until => (WalkCause::Pause, duty),
            WalkerDoing::Duty if now < self.look_until => (WalkCause::LookAround, duty),
            WalkerDoing::Duty => (WalkCause::OnPath, duty),
        }
    }
}
