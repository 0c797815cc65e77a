//! What one source reports about a worker's position, and whether it can be true.
//!
//! Main types: [`SourceTrack`], [`SourceVerdict`]. Late sightings change nothing. A place that nobody can have reached
//! is doubted until several sightings agree on it; then the source is followed there, and the place it left is kept as
//! an alternative, because either may be the wrong one. Only marks that were touched make a new place true at once.
//! Marks on one line leave two places open until the map or another source rules one of them out. Refuses: to compare
//! sources with one another, which the track does.

use super::mover::{Mover, measured_over_s};
use super::sighting::{Quality, Sighting};
use super::track::{Presence, Whereabouts};
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};
use std::collections::VecDeque;

/// Silence up to here is normal (headsets send at 10 to 60 Hz).
const FRESH: Span = Span::from_millis(300);
/// Silence up to here widens the disc; beyond it the worker's direction is not predicted.
pub const STALE: Span = Span::from_secs(1);
/// After this much silence the worker is lost.
pub const LOST: Span = Span::from_secs(3);
/// This many sightings in a row that agree with one another move a worker to a place that cannot be reached.
const AGREE: usize = 5;
/// Least accuracy that a source is believed to have, metres.
const BEST_M: f64 = 0.01;
/// Additional error of a guessed position, metres.
const GUESSED_M: f64 = 0.5;
/// How long positions are kept for computing the velocity.
const MEMORY: Span = Span::from_millis(1600);

/// How long the place that a source left by a jump is kept. That is time to ask for marks and to touch them; after it
/// the source has been consistent for longer than the jump matters.
pub(super) const HELD: Span = Span::from_secs(30);
/// Largest number of left places kept at once.
const LEFT_MOST: usize = 2;
/// How long a source that has jumped ranks behind one that has not.
const JUMPY: Span = Span::from_secs(300);

/// Two places nearer to each other than this are the same, metres.
const SAME_M: f64 = 0.2;

/// This many sightings in a row whose mirrored place is off the map rule that side out.
const OFF_MAP: u32 = 10;

/// A source's verdict on its own sighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SourceVerdict {
    /// The sighting is not newer than the newest one, or was seen already.
    Late,
    /// The source reports that it is lost.
    Lost,
    /// Nobody can have got there, and too few sightings agree on it.
    Doubted,
    /// The worker has moved.
    Moved,
    /// The worker is in a new place without having walked there: marks were touched, or it is the first sighting.
    Relocated,
    /// The worker is in a new place that nobody could have walked to, as several sightings agree.
    Jumped,
}

/// A place that a source left by a jump.
#[derive(Clone, Copy, Debug)]
struct LeftPlace {
    /// The last sighting there.
    last: Sighting,
    /// When the source was followed to the new place.
    jumped: Time,
    /// Start of the distance measured since, and the distance walked before that.
    landed: Point,
    walked_m: f64,
}

/// The record of one source.
#[derive(Clone, Debug, Default)]
pub(super) struct SourceTrack {
    newest: Option<Sighting>,
    /// Since when the source has reported that it is lost.
    lost_since: Option<Time>,
    memory: VecDeque<(Time, Point)>,
    /// Impossible sightings, one after another.
    doubted: Vec<Sighting>,
    /// Places that the source left by jumps, oldest first.
    left: Vec<LeftPlace>,
    /// When the source last jumped.
    jumped: Option<Time>,
    /// Whether another source has shown that its jump was wrong, or that its frame is mirrored.
    suspected: bool,
    /// Evidence, in this epoch, of the side of its marks that the worker is on.
    side: SideTrial,
    /// What the worker moves as.
    pub mover: Mover,
    /// Direction in which the worker last moved, radians: a vehicle that stands is turned that way.
    course: Option<f64>,
}

/// Evidence on whether the other side of the marks is ruled out.
#[derive(Clone, Copy, Debug, Default)]
struct SideTrial {
    /// How many sightings in a row had their mirrored place off the map.
    off_map: u32,
    /// Whether the map or another source has ruled the other side out.
    is_known: bool,
}

impl SourceTrack {
    /// The newest accepted sighting.
    pub fn newest(&self) -> Option<&Sighting> {
        self.newest.as_ref()
    }

    /// Processes a sighting whose numbers are valid.
    pub fn see(&mut self, s: &Sighting) -> SourceVerdict {
        let Some(last) = self.newest else {
            self.accept(s, SourceVerdict::Relocated);
            return SourceVerdict::Relocated;
        };
        if (s.epoch, s.seq) <= (last.epoch, last.seq) || s.seen <= last.seen {
            return SourceVerdict::Late;
        }
        if s.quality == Quality::Lost {
            self.lost_since.get_or_insert(s.seen);
            return SourceVerdict::Lost;
        }
        if s.epoch != last.epoch && s.at_marks {
            // The wearer showed where the frame lies: earlier errors are over.
            (self.jumped, self.suspected) = (None, false);
            self.left.clear();
            return self.accept(s, SourceVerdict::Relocated);
        }
        if !self.is_reachable(&last, s) {
            return self.doubt(&last, s);
        }
        if s.epoch != last.epoch {
            // Across epochs a displacement is no movement.
            self.memory.clear();
            self.rebase(last.at, s.at);
        }
        self.accept(s, SourceVerdict::Moved)
    }

    fn accept(&mut self, s: &Sighting, verdict: SourceVerdict) -> SourceVerdict {
        if self.newest.is_some_and(|n| n.epoch != s.epoch) {
            self.side = SideTrial::default();
        }
        if verdict != SourceVerdict::Moved {
            self.memory.clear();
        }
        self.doubted.clear();
        if s.quality == Quality::Lost {
            self.lost_since.get_or_insert(s.seen);
        } else {
            self.lost_since = None;
            self.memory.push_back((s.seen, s.at));
        }
        while self.memory.front().is_some_and(|(t, _)| s.seen - *t > MEMORY) {
            self.memory.pop_front();
        }
        self.left.retain(|l| s.seen - l.jumped < HELD);
        self.newest = Some(Sighting { accuracy_m: s.accuracy_m.max(BEST_M), ..*s });
        self.course = course(self.velocity()).or(self.course);
        verdict
    }

    /// Handles a place that cannot have been reached. If several sightings agree on it, the source is followed there,
    /// and the worker may still be where it was, too.
    fn doubt(&mut self, last: &Sighting, s: &Sighting) -> SourceVerdict {
        if self.doubted.last().is_some_and(|d| !self.is_reachable(d, s)) {
            self.doubted.clear();
        }
        self.doubted.push(*s);
        if self.doubted.len() < AGREE {
            return SourceVerdict::Doubted;
        }
        // A source that returns to a place has not left it.
        self.left.retain(|l| (l.last.at - s.at).norm() > l.reach_m(last) + doubt_m(&l.last, s));
        self.rebase(last.at, s.at);
        if self.left.len() == LEFT_MOST {
            self.left.remove(0);
        }
        self.left.push(LeftPlace { last: *last, jumped: s.seen, landed: s.at, walked_m: 0.0 });
        self.jumped = Some(s.seen);
        self.accept(s, SourceVerdict::Jumped)
    }

    /// Checks whether the mirrored place of the newest sighting is on the map: if it is off the map for a while, the
    /// worker is on this side of the marks.
    pub fn try_side(&mut self, is_on_map: impl Fn(Point) -> bool) {
        let Some(mirror) = self.newest.and_then(|n| n.mirror) else { return };
        self.side.off_map = if is_on_map(mirror) { 0 } else { self.side.off_map + 1 };
        self.side.is_known |= self.side.off_map >= OFF_MAP;
    }

    /// The newest sighting on the other side of the marks, unless that side is ruled out.
    fn mirrored(&self) -> Option<Sighting> {
        let newest = self.newest.filter(|_| !self.side.is_known)?;
        newest.mirror.map(|at| Sighting { at, ..newest })
    }

    /// Where the worker is if the source's marks lie on one line and its frame is mirrored; nothing if that is ruled
    /// out, or makes no difference there.
    pub fn other_side(&self, now: Time) -> Option<Whereabouts> {
        let (other, here) = (self.mirrored()?, self.whereabouts(now)?);
        let across = other.at - here.at;
        let apart_m = across.norm();
        if apart_m < SAME_M {
            return None;
        }
        let velocity = here.velocity - across * (2.0 * here.velocity.dot(&across) / apart_m.powi(2));
        Some(Whereabouts { at: other.at, velocity, heading: None, ..here })
    }

    /// The source's frame has moved: the distance since a jump is measured on from here.
    fn rebase(&mut self, from: Point, to: Point) {
        for l in &mut self.left {
            l.walked_m += (from - l.landed).norm();
            l.landed = to;
        }
    }

    /// Whether a worker seen at `a` can be at `b` by its time.
    fn is_reachable(&self, a: &Sighting, b: &Sighting) -> bool {
        let time = (b.seen - a.seen).as_secs_f64().max(0.0);
        (b.at - a.at).norm() <= self.mover.possible_mps() * time + doubt_m(a, b)
    }

    /// The source signs off and will not know any more.
    pub fn sign_off(&mut self, now: Time) {
        if self.newest.is_some() {
            self.lost_since.get_or_insert(now);
        }
    }

    /// Where the worker is now, as far as this source knows.
    pub fn whereabouts(&self, now: Time) -> Option<Whereabouts> {
        let last = self.newest?;
        let silent = self.silent(now)?;
        let presence = match silent {
            _ if self.lost_since.is_some() => Presence::Lost,
            s if s <= FRESH => Presence::Tracked,
            s if s <= LOST => Presence::Stale,
            _ => Presence::Lost,
        };
        let velocity = self.velocity();
        let stands = self.course.filter(|_| self.mover != Mover::OnFoot);
        Some(Whereabouts {
            at: last.at,
            sigma_m: sigma_m(&last),
            reach_m: reach_m(&self.mover, velocity.norm(), silent),
            velocity,
            heading: last.heading.or(course(velocity)).or(stands),
            presence,
            mover: self.mover,
        })
    }

    /// Where else the worker may be, because the source left these places by a jump.
    pub fn left(&self, now: Time) -> impl Iterator<Item = Whereabouts> {
        let held = self.left.iter().filter(move |l| now - l.jumped < HELD);
        held.filter_map(move |l| {
            let (newest, silent) = (self.newest?, self.silent(now)?);
            // The distance walked since is true, whichever place is.
            let moved_mps = self.velocity().norm();
            let walked_m = l.reach_m(&newest) + reach_m(&self.mover, moved_mps, silent);
            let unseen_m = reach_m(&self.mover, self.mover.assumed_mps(), now - l.last.seen);
            Some(Whereabouts {
                at: l.last.at,
                sigma_m: sigma_m(&l.last),
                reach_m: walked_m.min(unseen_m),
                velocity: Vector::zeros(),
                heading: None,
                presence: Presence::Stale,
                mover: self.mover,
            })
        })
    }

    /// How long the source has reported nothing useful.
    pub fn silent(&self, now: Time) -> Option<Span> {
        let seen = self.newest?.seen;
        Some((now - self.lost_since.map_or(seen, |t| t.min(seen))).max(Span::ZERO))
    }

    /// Whether the source has jumped recently.
    pub fn is_jumpy(&self, now: Time) -> bool {
        self.jumped.is_some_and(|t| now - t < JUMPY)
    }

    /// Whether another source has shown that this one's jump was wrong, and it has not come back since.
    pub fn is_suspected(&self) -> bool {
        self.suspected
    }

    /// Whether the source can testify about another one: it knows its place, has left none by a jump, and is on a known
    /// side of its marks.
    pub fn is_witness(&self, now: Time) -> bool {
        let knows = self.lost_since.is_none() && self.silent(now).is_some_and(|s| s <= STALE);
        knows && !self.suspected && self.left(now).next().is_none() && self.mirrored().is_none()
    }

    /// Uses a witness to decide which place is right: that before or after a jump, or on which side of the marks.
    pub fn hear_witness(&mut self, witness: &Sighting, now: Time) {
        let Some(newest) = self.newest.filter(|_| self.silent(now).is_some_and(|s| s <= STALE)) else {
            return;
        };
        let mover = self.mover;
        let is_here = is_near(&mover, &newest, witness, 0.0);
        let is_left = self.left.iter().any(|l| is_near(&mover, &l.last, witness, l.reach_m(&newest)));
        let is_across = self.mirrored().is_some_and(|other| is_near(&mover, &other, witness, 0.0));
        match (is_here, is_left || is_across) {
            (true, false) => {
                self.side.is_known = true;
                // The source was wrong before the jump, and is right now; or it was shown to be wrong and has come
                // back.
                if !self.suspected && !self.left.is_empty() {
                    self.jumped = None;
                }
                self.suspected = false;
                self.left.clear();
            }
            (false, true) => {
                self.suspected = true;
                self.left.clear();
            }
            _ => {}
        }
    }

    /// Mean velocity over the recent past: the less exact the source, the longer the interval.
    fn velocity(&self) -> Vector {
        let (Some(last), Some((t, at))) = (&self.newest, self.memory.back()) else { return Vector::zeros() };
        let span = Span::from_secs_f64(measured_over_s(last.accuracy_m));
        let old = self.memory.iter().rev().find(|(s, _)| *t - *s >= span).or(self.memory.front());
        match old {
            Some((s, from)) if *t - *s >= Span::from_millis(150) => (at - from) / (*t - *s).as_secs_f64(),
            _ => Vector::zeros(),
        }
    }
}

impl LeftPlace {
    /// How far the worker is from this place if it was the right one, by the distance that the source saw since.
    fn reach_m(&self, newest: &Sighting) -> f64 {
        self.walked_m + (newest.at - self.landed).norm()
    }
}

/// How far a worker may have come who has been unseen for this long, and moved at `moved_mps` before, metres.
pub(super) fn reach_m(mover: &Mover, moved_mps: f64, silent: Span) -> f64 {
    if silent <= FRESH { 0.0 } else { mover.unseen_m(moved_mps, silent) }
}

/// The direction of a movement, if it is one.
fn course(velocity: Vector) -> Option<f64> {
    (velocity.norm() > 0.3).then(|| velocity.y.atan2(velocity.x))
}

/// Standard deviation of a position, metres.
fn sigma_m(s: &Sighting) -> f64 {
    s.accuracy_m + if s.quality == Quality::Emulated { GUESSED_M } else { 0.0 }
}

/// Largest difference between two positions of one place, metres.
fn doubt_m(a: &Sighting, b: &Sighting) -> f64 {
    3.0 * (a.accuracy_m + b.accuracy_m) + 0.3
}

/// Whether two sightings agree, up to `reach_m`, their errors, and a walk between the two moments.
pub(super) fn is_near(mover: &Mover, a: &Sighting, b: &Sighting, reach_m: f64) -> bool {
    let apart = (b.seen - a.seen).as_secs_f64().abs().min(STALE.as_secs_f64());
    (b.at - a.at).norm() <= reach_m + mover.assumed_mps() * apart + doubt_m(a, b)
}
