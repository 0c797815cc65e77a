//! What one source says of where a worker is, and whether it can be true.
//!
//! Main types: [`SourceTrack`], [`SourceVerdict`]. Late sightings change nothing. A place that nobody can have reached
//! is doubted until several sightings agree on it; then the source is followed there, and the place that it left is
//! kept in mind, because either may be the wrong one. Only marks that were touched make a new place true at once. Marks
//! on one line leave two places open until the map or another source rules one of them out.
//! Refuses: to compare sources with one another, which the track does.

use super::sighting::{Quality, Sighting};
use super::track::{Presence, WALK_MPS, Whereabouts};
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};
use std::collections::VecDeque;

/// Silence up to here is normal (headsets send at 10 to 60 Hz).
const FRESH: Span = Span::from_millis(300);
/// Silence up to here widens the disc; beyond it nobody guesses where the worker is going.
pub const STALE: Span = Span::from_secs(1);
/// After this much silence the worker is lost.
pub const LOST: Span = Span::from_secs(3);
/// Nobody runs faster than this in a warehouse, metres per second.
const RUN_MPS: f64 = 3.0;
/// So many sightings in a row that agree with one another move a worker to a place that cannot be reached.
const AGREE: usize = 5;
/// A source that claims to know better than this is not believed, metres.
const BEST_M: f64 = 0.01;
/// What a guessed position is taken to be off by, metres.
const GUESSED_M: f64 = 0.5;
/// Positions are remembered this long for the speed.
const MEMORY: Span = Span::from_millis(1600);

/// How long a person who is not seen is taken to walk straight away, at walking speed. After that a person is taken to
/// turn anywhere after each such piece of way, so that the distance grows with the square root of time.
const STRAIGHT: Span = Span::from_secs(3);
/// How far an unseen person is taken to get at most, metres on foot. The wearer is told to stand while the place is not
/// known; whoever has walked farther is seen by robots as everybody without a headset is.
const REACH_MOST_M: f64 = 8.0;

/// The place that a source left by a jump is held for so long. That is time to be asked for marks and to touch them;
/// after it the source has been consistent for longer than the jump is of interest.
pub(super) const HELD: Span = Span::from_secs(30);
/// So many places that a source left are held at once.
const LEFT_MOST: usize = 2;
/// A source that has jumped gives way to one that has not for so long.
const JUMPY: Span = Span::from_secs(300);

/// Two places nearer to one another than this are one, metres.
const SAME_M: f64 = 0.2;

/// So many sightings in a row whose other place is off the map rule that side out.
const OFF_MAP: u32 = 10;

/// What a source made of its own sighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SourceVerdict {
    /// Older than its newest, or seen already.
    Late,
    /// The source says that it does not know.
    Lost,
    /// Nobody can have got there, and too few sightings say so.
    Doubted,
    /// The worker has moved.
    Moved,
    /// The worker is somewhere else without having walked there: marks were touched, or it is the first sighting.
    Relocated,
    /// The worker is somewhere else, as several sightings agree that nobody could have walked to.
    Jumped,
}

/// A place that a source left without a walk.
#[derive(Clone, Copy, Debug)]
struct LeftPlace {
    /// The last sighting there.
    last: Sighting,
    /// When the source was followed to the new place.
    jumped: Time,
    /// From where the way since is measured, and how long it was before.
    landed: Point,
    walked_m: f64,
}

/// All that one source said.
#[derive(Clone, Debug, Default)]
pub(super) struct SourceTrack {
    newest: Option<Sighting>,
    /// Since when the source says that it does not know.
    lost_since: Option<Time>,
    memory: VecDeque<(Time, Point)>,
    /// Sightings that could not be, one after another.
    doubted: Vec<Sighting>,
    /// Places that it left by jumps, oldest first.
    left: Vec<LeftPlace>,
    /// When it jumped last.
    jumped: Option<Time>,
    /// Whether another source has shown that its jump was wrong, or that it sees as in a mirror.
    suspected: bool,
    /// What shows, in this epoch, on which side of its marks the worker is.
    side: SideTrial,
}

/// Whether the other side of the marks is ruled out.
#[derive(Clone, Copy, Debug, Default)]
struct SideTrial {
    /// How many sightings in a row had their other place off the map.
    off_map: u32,
    /// Whether the map or another source has ruled it out.
    is_known: bool,
}

impl SourceTrack {
    /// The newest sighting that was taken in.
    pub fn newest(&self) -> Option<&Sighting> {
        self.newest.as_ref()
    }

    /// Takes a sighting in whose numbers can be.
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
            // The wearer showed where the frame lies: what was wrong before is over.
            (self.jumped, self.suspected) = (None, false);
            self.left.clear();
            return self.accept(s, SourceVerdict::Relocated);
        }
        if !is_reachable(&last, s) {
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
        verdict
    }

    /// A place that cannot have been reached. If several sightings agree on it, the source is followed there, and the
    /// worker is held to be where it was, too.
    fn doubt(&mut self, last: &Sighting, s: &Sighting) -> SourceVerdict {
        if self.doubted.last().is_some_and(|d| !is_reachable(d, s)) {
            self.doubted.clear();
        }
        self.doubted.push(*s);
        if self.doubted.len() < AGREE {
            return SourceVerdict::Doubted;
        }
        // A source that comes back to a place that it left has not left it.
        self.left.retain(|l| (l.last.at - s.at).norm() > l.reach_m(last) + doubt_m(&l.last, s));
        self.rebase(last.at, s.at);
        if self.left.len() == LEFT_MOST {
            self.left.remove(0);
        }
        self.left.push(LeftPlace { last: *last, jumped: s.seen, landed: s.at, walked_m: 0.0 });
        self.jumped = Some(s.seen);
        self.accept(s, SourceVerdict::Jumped)
    }

    /// Notes whether the other place of the newest sighting is on the map: if it is off it for a while, the worker is
    /// on this side of the marks.
    pub fn try_side(&mut self, is_on_map: impl Fn(Point) -> bool) {
        let Some(mirror) = self.newest.and_then(|n| n.mirror) else { return };
        self.side.off_map = if is_on_map(mirror) { 0 } else { self.side.off_map + 1 };
        self.side.is_known |= self.side.off_map >= OFF_MAP;
    }

    /// The newest sighting on the other side of the marks, as long as that is not ruled out.
    fn mirrored(&self) -> Option<Sighting> {
        let newest = self.newest.filter(|_| !self.side.is_known)?;
        newest.mirror.map(|at| Sighting { at, ..newest })
    }

    /// Where the worker is if the marks of the source lie on one line and its frame has an axis exchanged; nothing if
    /// that is ruled out, or makes no difference there.
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

    /// The source's frame has moved: the way since a jump is measured on from here.
    fn rebase(&mut self, from: Point, to: Point) {
        for l in &mut self.left {
            l.walked_m += (from - l.landed).norm();
            l.landed = to;
        }
    }

    /// The source says that it will not know any more.
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
        let course = (velocity.norm() > 0.3).then(|| velocity.y.atan2(velocity.x));
        Some(Whereabouts {
            at: last.at,
            sigma_m: sigma_m(&last),
            reach_m: reach_m(silent),
            velocity,
            heading: last.heading.or(course),
            presence,
        })
    }

    /// Where else the worker may be, because the source left these places without a walk.
    pub fn left(&self, now: Time) -> impl Iterator<Item = Whereabouts> {
        let held = self.left.iter().filter(move |l| now - l.jumped < HELD);
        held.filter_map(move |l| {
            let (newest, silent) = (self.newest?, self.silent(now)?);
            // What the source says of the way since is true, whichever place is.
            let walked_m = l.reach_m(&newest) + reach_m(silent);
            Some(Whereabouts {
                at: l.last.at,
                sigma_m: sigma_m(&l.last),
                reach_m: walked_m.min(reach_m(now - l.last.seen)),
                velocity: Vector::zeros(),
                heading: None,
                presence: Presence::Stale,
            })
        })
    }

    /// For how long the source has said nothing of use.
    pub fn silent(&self, now: Time) -> Option<Span> {
        let seen = self.newest?.seen;
        Some((now - self.lost_since.map_or(seen, |t| t.min(seen))).max(Span::ZERO))
    }

    /// Whether it has jumped lately.
    pub fn is_jumpy(&self, now: Time) -> bool {
        self.jumped.is_some_and(|t| now - t < JUMPY)
    }

    /// Whether another source has shown that its jump was wrong, and it has not come back since.
    pub fn is_suspected(&self) -> bool {
        self.suspected
    }

    /// Whether it can bear witness about another source: it knows, has left no place by a jump, and is on a known side
    /// of its marks.
    pub fn is_witness(&self, now: Time) -> bool {
        let knows = self.lost_since.is_none() && self.silent(now).is_some_and(|s| s <= STALE);
        knows && !self.suspected && self.left(now).next().is_none() && self.mirrored().is_none()
    }

    /// Hears a witness: which of the places that it jumped from and to, or on both sides of its marks, is the right
    /// one?
    pub fn hear_witness(&mut self, witness: &Sighting, now: Time) {
        let Some(newest) = self.newest.filter(|_| self.silent(now).is_some_and(|s| s <= STALE)) else {
            return;
        };
        let is_here = is_near(&newest, witness, 0.0);
        let is_left = self.left.iter().any(|l| is_near(&l.last, witness, l.reach_m(&newest)));
        let is_across = self.mirrored().is_some_and(|other| is_near(&other, witness, 0.0));
        match (is_here, is_left || is_across) {
            (true, false) => {
                self.side.is_known = true;
                // It was wrong before the jump, and is right now; or it was shown to be wrong and has come back.
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

    /// Velocity over the last moments: the worse the source, the longer they are.
    fn velocity(&self) -> Vector {
        let (Some(last), Some((t, at))) = (&self.newest, self.memory.back()) else { return Vector::zeros() };
        let span = Span::from_secs_f64((0.4 + 4.0 * last.accuracy_m).clamp(0.4, 1.5));
        let old = self.memory.iter().rev().find(|(s, _)| *t - *s >= span).or(self.memory.front());
        match old {
            Some((s, from)) if *t - *s >= Span::from_millis(150) => (at - from) / (*t - *s).as_secs_f64(),
            _ => Vector::zeros(),
        }
    }
}

impl LeftPlace {
    /// How far from the place the worker is if it was the right one, by the way that the source saw since.
    fn reach_m(&self, newest: &Sighting) -> f64 {
        self.walked_m + (newest.at - self.landed).norm()
    }
}

/// How far somebody may have got who has not been seen for so long, metres on foot.
pub(super) fn reach_m(silent: Span) -> f64 {
    let (t, straight) = (silent.as_secs_f64(), STRAIGHT.as_secs_f64());
    match silent {
        s if s <= FRESH => 0.0,
        s if s <= STRAIGHT => WALK_MPS * t,
        _ => (WALK_MPS * (straight * t).sqrt()).min(REACH_MOST_M),
    }
}

/// One standard deviation of a position.
fn sigma_m(s: &Sighting) -> f64 {
    s.accuracy_m + if s.quality == Quality::Emulated { GUESSED_M } else { 0.0 }
}

/// What two positions of one place may differ by, metres.
fn doubt_m(a: &Sighting, b: &Sighting) -> f64 {
    3.0 * (a.accuracy_m + b.accuracy_m) + 0.3
}

/// Whether somebody seen as `a` can be where `b` says, by then.
fn is_reachable(a: &Sighting, b: &Sighting) -> bool {
    let time = (b.seen - a.seen).as_secs_f64().max(0.0);
    (b.at - a.at).norm() <= RUN_MPS * time + doubt_m(a, b)
}

/// Whether two sources say the same, up to `reach_m`: their errors, and a walk between the two moments.
pub(super) fn is_near(a: &Sighting, b: &Sighting, reach_m: f64) -> bool {
    let apart = (b.seen - a.seen).as_secs_f64().abs().min(STALE.as_secs_f64());
    (b.at - a.at).norm() <= reach_m + WALK_MPS * apart + doubt_m(a, b)
}
