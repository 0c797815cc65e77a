//! A simulated worker: walks where the device shows, works, and now and then does something else.
//!
//! Main types: [`Walker`], [`Shown`] (what the device shows), [`WorkKnowledge`] (what it knows of its work),
//! [`WalkCause`] and [`CauseStretch`] (the truth about it). Legs, character and impulses are files of their own; this
//! one joins them. Refuses: to walk through racks, through holes that lifted racks leave, or through robots; to tell
//! the fleet why.

mod cause;
mod crossing;
mod decide;
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
pub use legs::{RobotNear, WalkerSurroundings, ease};
pub use person::{APART_M, BODY_M, PersonNear};
pub use persona::Traits;

use crate::random::Stream;
use crate::scenario::Workers;
use giveway_floor::geometry::{Point, Pose, Vector};
use giveway_floor::id::AssignmentId;
use giveway_floor::time::{Span, Time};
use impulse::Impulses;
use legs::Legs;
use std::collections::VecDeque;

/// A walker that people have kept for so long does something about it.
const KEPT: Span = Span::from_millis(1500);
/// And tries to squeeze past them after this.
const SQUEEZES: Span = Span::from_millis(700);

/// Something to do at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errand {
    /// Its number.
    pub id: AssignmentId,
    /// Where one stands for it.
    pub at: Point,
    /// How long it takes.
    pub stay: Span,
}

/// What the device shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Counts up with every new path.
    pub version: u64,
    /// Where to walk; empty where nothing is shown.
    pub path: Vec<Point>,
    /// Whether it says that this is another way than before.
    pub redirected: bool,
    /// Whether it says to stand.
    pub stop: bool,
    /// Whether it says to leave: the building, or a closed area.
    pub leave: bool,
}

/// What a walker knows of its work and of the hall.
#[derive(Clone, Debug)]
pub struct WorkKnowledge<'a> {
    /// What is to be done next.
    pub job: Option<Errand>,
    /// Places that everybody knows, the fleet too.
    pub known: &'a [Point],
    /// Where colleagues are.
    pub colleagues: &'a [Point],
    /// The colleague with whom it walks.
    pub companion: Option<PersonNear>,
}

/// What a walker is at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WalkerDoing {
    /// Follows what is shown, or its own way to work; or waits for either.
    Duty,
    /// Works until then.
    Work(AssignmentId, Time),
    /// Goes somewhere else, and stays there.
    Job { cause: WalkCause, goal: Point, stay: Span, until: Option<Time> },
    /// Walks about until then.
    Wander(Time),
    /// Goes to a door for good.
    Leave(Point),
    /// Is off the floor.
    Gone,
}

/// A step aside, until when once it is there.
#[derive(Clone, Copy, Debug)]
struct Aside {
    goal: Point,
    stay: Span,
    until: Option<Time>,
}

/// One worker on the floor.
#[derive(Debug)]
pub struct Walker {
    /// Who it is.
    pub traits: Traits,
    /// Jobs that it has finished, in order; the reader takes them out.
    pub finished: Vec<AssignmentId>,
    legs: Legs,
    doing: WalkerDoing,
    impulses: Impulses,
    heeds: Stream,
    strolls: Stream,
    ignore: f64,
    /// What the device shows, and what will be noticed when.
    shown: Option<Shown>,
    news: VecDeque<(Time, Shown)>,
    /// The version of the path that is on the route, and the one that it would not follow.
    followed: Option<u64>,
    ignored: Option<u64>,
    idle_since: Time,
    pause_until: Time,
    look_until: Time,
    reacts_until: Time,
    calm_until: Time,
    blocked_since: Option<(Time, Point)>,
    /// Its number, and since when people have kept it from walking on, where.
    who: usize,
    kept_since: Option<(Time, Point)>,
    /// How it truly moved last, metres per second.
    velocity: Vector,
    /// How long it has stood for robots that cross its way, and until when it does not any more.
    waited: Span,
    waits_no_more_until: Time,
    /// Since when it has come no nearer to the place of its errand than so many metres.
    nearer_since: Option<(Time, f64)>,
    detour: bool,
    aside: Option<Aside>,
    log: Log,
}

impl Walker {
    /// Worker number `who` of a scenario that began at `start`, coming in at a door.
    pub(super) fn new(workers: &Workers, seed: u64, who: u64, at: Point, start: Time, now: Time) -> Walker {
        let traits = Traits::draw(&workers.personas, Stream::new(seed, 30, who));
        let mut impulses = Impulses::new(&workers.deviations, seed, who, start);
        // What came up before it came in is forgotten.
        while impulses.due(now).is_some() {}
        Walker {
            finished: Vec::new(),
            legs: Legs::new(at, traits.cut_m, traits.phase),
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

    /// Takes what the device shows from now on; it is noticed after the walker's reaction time.
    pub fn hear(&mut self, now: Time, shown: Shown) {
        self.news.push_back((now + self.traits.reaction, shown));
    }

    /// Sends it to a door for good.
    pub fn send_home(&mut self, door: Point) {
        if !matches!(self.doing, WalkerDoing::Leave(_) | WalkerDoing::Gone) {
            self.doing = WalkerDoing::Leave(door);
            self.legs.route.clear();
        }
    }

    /// Whether it is off the floor.
    pub fn is_gone(&self) -> bool {
        self.doing == WalkerDoing::Gone
    }

    /// Lives for `dt` seconds, up to `now`.
    pub fn tick(&mut self, now: Time, dt: f64, around: &WalkerSurroundings<'_>, work: &WorkKnowledge<'_>) {
        self.notice(now, around, work);
        self.decide(now, around, work);
        let foresight = self.traits.foresight_s();
        let wanted = self.pace_for_robots(now, dt, self.wanted_mps(now), around);
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

    /// Where it truly is, and where its head faces.
    pub fn pose(&self, now: Time) -> Pose {
        Pose { at: self.legs.trunk(now), heading: self.legs.heading + self.head_turn(now) }
    }

    /// As other walkers see it.
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

    /// Where it truly is on its way, without the sway of its trunk.
    pub fn way_at(&self) -> Point {
        self.legs.at
    }

    /// How fast it truly walks, metres per second.
    pub fn speed_mps(&self) -> f64 {
        self.legs.speed_mps
    }

    /// Metres walked so far.
    pub fn walked_m(&self) -> f64 {
        self.legs.walked_m
    }

    /// The truth about it so far.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// The head against the body, radians: up to 60° while looking around, a little while standing with the
    /// phone.
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
