//! Where one worker is, from what sources say: the newest that can be true wins, and silence widens it.
//!
//! Main types: [`Track`], [`SightingOutcome`], [`Presence`], [`Whereabouts`]. Every kind of bad sighting has one
//! answer: late and repeated ones are ignored; jumps are ignored until several agree on the new place; what
//! cannot be true is refused; silence grows the disc in which the worker may be. Refuses: to guess where
//! anybody is going.

use super::sighting::{Quality, Sighting};
use crate::geometry::{Point, Vector};
use crate::time::{Span, Time};
use std::collections::VecDeque;

/// Silence up to here is normal (headsets send at 10 to 60 Hz).
const FRESH: Span = Span::from_millis(300);
/// Silence up to here widens the disc; beyond it nobody guesses where the worker is going.
pub const STALE: Span = Span::from_secs(1);
/// After this much silence the worker is lost.
pub const LOST: Span = Span::from_secs(3);
/// Walking speed that is assumed of everybody who might walk, metres per second (ISO 13855).
pub const WALK_MPS: f64 = 1.6;
/// Nobody runs faster than this in a warehouse, metres per second.
const RUN_MPS: f64 = 3.0;
/// Clocks and predicted display times may be ahead by this.
const AHEAD: Span = Span::from_millis(150);
/// So many sightings in a row that agree with one another move a worker to a place that cannot be reached.
const AGREE: usize = 5;
/// A source that claims to know better than this is not believed, metres.
const BEST_M: f64 = 0.01;
/// What a guessed position is taken to be off by, metres.
const GUESSED_M: f64 = 0.5;
/// Positions are remembered this long for the speed.
const MEMORY: Span = Span::from_millis(1600);

/// How well a worker's place is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Presence {
    /// Not on the floor.
    #[default]
    Absent,
    /// Seen lately.
    Tracked,
    /// Not seen for a moment; the region around the last place grows.
    Stale,
    /// Not seen for long: robots stand in all that could be reached, until somebody sees or clears it.
    Lost,
}

impl Presence {
    /// The word for it on the wire.
    pub fn word(self) -> &'static str {
        match self {
            Presence::Absent => "absent",
            Presence::Tracked => "tracked",
            Presence::Stale => "stale",
            Presence::Lost => "lost",
        }
    }
}

/// How many sightings a source sent, and what became of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub struct FeedCounts {
    /// Taken in.
    pub taken: u64,
    /// Older than the newest, or seen already.
    pub late: u64,
    /// Too far from where the worker can be.
    pub jumps: u64,
    /// Cannot be true: off the map, in the future, not a number.
    pub absurd: u64,
}

/// What became of a sighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SightingOutcome {
    /// The worker has moved.
    Moved,
    /// The worker is somewhere else, without having walked there: a new frame, or a jump that proved true.
    Relocated,
    /// Ignored.
    Ignored,
}

/// Where a worker is, at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whereabouts {
    /// The last known place.
    pub at: Point,
    /// One standard deviation of it, metres.
    pub sigma_m: f64,
    /// How far the worker may have walked since, unseen, metres.
    pub reach_m: f64,
    /// Velocity, metres per second.
    pub velocity: Vector,
    /// Where the worker faces, radians; from the course where the source does not say.
    pub heading: Option<f64>,
    /// How well it is known.
    pub presence: Presence,
}

/// All that is known about where a worker is.
#[derive(Clone, Debug, Default)]
pub struct Track {
    newest: Option<Sighting>,
    /// Since when the source says that it does not know.
    lost_since: Option<Time>,
    memory: VecDeque<(Time, Point)>,
    /// Sightings that could not be, one after another.
    doubted: Vec<Sighting>,
    counts: FeedCounts,
}

impl Track {
    /// What became of all sightings.
    pub fn counts(&self) -> FeedCounts {
        self.counts
    }

    /// The newest sighting that was taken in.
    pub fn newest(&self) -> Option<&Sighting> {
        self.newest.as_ref()
    }

    /// The worker has left the floor, or somebody vouches for it.
    pub fn clear(&mut self) {
        *self = Track { counts: self.counts, ..Track::default() };
    }

    /// Takes a sighting in. `is_on_map` says whether anybody can be at a place at all.
    pub fn see(&mut self, s: &Sighting, now: Time, is_on_map: impl Fn(Point) -> bool) -> SightingOutcome {
        let numbers = [s.at.x, s.at.y, s.accuracy_m, s.heading.unwrap_or(0.0)];
        if numbers.iter().any(|n| !n.is_finite()) || s.seen > now + AHEAD || !is_on_map(s.at) {
            self.counts.absurd += 1;
            return SightingOutcome::Ignored;
        }
        let Some(last) = self.newest else { return self.accept(s, SightingOutcome::Relocated) };
        if (s.epoch, s.seq) <= (last.epoch, last.seq) || s.seen <= last.seen {
            self.counts.late += 1;
            return SightingOutcome::Ignored;
        }
        if s.quality == Quality::Lost {
            self.lost_since.get_or_insert(s.seen);
            self.counts.taken += 1;
            return SightingOutcome::Ignored;
        }
        if s.epoch != last.epoch {
            return self.accept(s, SightingOutcome::Relocated);
        }
        if is_reachable(&last, s) {
            return self.accept(s, SightingOutcome::Moved);
        }
        self.doubt(s)
    }

    fn accept(&mut self, s: &Sighting, taken: SightingOutcome) -> SightingOutcome {
        if taken == SightingOutcome::Relocated {
            self.memory.clear();
        }
        self.counts.taken += 1;
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
        self.newest = Some(Sighting { accuracy_m: s.accuracy_m.max(BEST_M), ..*s });
        taken
    }

    /// A place that cannot have been reached. If several sightings agree on it, it was the old one that was
    /// wrong.
    fn doubt(&mut self, s: &Sighting) -> SightingOutcome {
        self.counts.jumps += 1;
        if self.doubted.last().is_some_and(|d| !is_reachable(d, s)) {
            self.doubted.clear();
        }
        self.doubted.push(*s);
        if self.doubted.len() < AGREE {
            return SightingOutcome::Ignored;
        }
        self.accept(s, SightingOutcome::Relocated)
    }

    /// Where the worker is now, as far as anybody knows.
    pub fn whereabouts(&self, now: Time) -> Option<Whereabouts> {
        let last = self.newest?;
        let silent = (now - self.lost_since.map_or(last.seen, |t| t.min(last.seen))).max(Span::ZERO);
        let presence = match silent {
            _ if self.lost_since.is_some() => Presence::Lost,
            s if s <= FRESH => Presence::Tracked,
            s if s <= LOST => Presence::Stale,
            _ => Presence::Lost,
        };
        let reach_m = if silent <= FRESH { 0.0 } else { WALK_MPS * silent.as_secs_f64() };
        let velocity = self.velocity();
        let course = (velocity.norm() > 0.3).then(|| velocity.y.atan2(velocity.x));
        let guessed = if last.quality == Quality::Emulated { GUESSED_M } else { 0.0 };
        Some(Whereabouts {
            at: last.at,
            sigma_m: last.accuracy_m + guessed,
            reach_m,
            velocity,
            heading: last.heading.or(course),
            presence,
        })
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

/// Whether somebody seen as `a` can be where `b` says, by then.
fn is_reachable(a: &Sighting, b: &Sighting) -> bool {
    let time = (b.seen - a.seen).as_secs_f64().max(0.0);
    let doubt = 3.0 * (a.accuracy_m + b.accuracy_m) + 0.3;
    (b.at - a.at).norm() <= RUN_MPS * time + doubt
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::id::WorkerId;

    fn sighting(ms: i64, x: f64) -> Sighting {
        Sighting {
            worker: WorkerId(0),
            seen: Time(ms * 1000),
            epoch: 0,
            seq: ms as u64,
            at: Point::new(x, 0.0),
            heading: None,
            accuracy_m: 0.02,
            quality: Quality::Tracked,
        }
    }

    fn walked() -> (Track, Time) {
        let mut track = Track::default();
        for i in 0..=20 {
            track.see(&sighting(i * 50, 0.06 * i as f64), Time(i * 50_000), |_| true);
        }
        (track, Time(1_000_000))
    }

    #[test]
    fn somebody_who_walks_has_the_speed_and_course_of_the_walk() {
        let (track, now) = walked();
        let w = track.whereabouts(now).unwrap();
        assert!((w.velocity.x - 1.2).abs() < 0.01 && w.presence == Presence::Tracked);
        assert_eq!(w.heading, Some(0.0));
    }

    #[test]
    fn late_and_repeated_sightings_change_nothing() {
        let (mut track, now) = walked();
        let before = track.whereabouts(now);
        for ms in [1000, 900, 20] {
            assert_eq!(track.see(&sighting(ms, 9.0), now, |_| true), SightingOutcome::Ignored);
        }
        assert_eq!(track.whereabouts(now), before);
        assert_eq!(track.counts().late, 3);
    }

    #[test]
    fn one_jump_is_ignored_and_five_that_agree_are_believed() {
        let (mut track, _) = walked();
        let jump = |ms: i64| sighting(ms, 30.0);
        for ms in [1050, 1100, 1150, 1200] {
            assert_eq!(track.see(&jump(ms), Time(ms * 1000), |_| true), SightingOutcome::Ignored);
        }
        assert_eq!(track.see(&jump(1250), Time(1_250_000), |_| true), SightingOutcome::Relocated);
        assert_eq!(track.counts().jumps, 5);
        assert_eq!(track.whereabouts(Time(1_250_000)).unwrap().velocity, Vector::zeros());
    }

    #[test]
    fn jumps_that_disagree_are_never_believed() {
        let (mut track, _) = walked();
        for i in 1..40 {
            let there = sighting(1000 + 50 * i, if i % 2 == 0 { 30.0 } else { -30.0 });
            assert_eq!(track.see(&there, there.seen, |_| true), SightingOutcome::Ignored);
        }
    }

    #[test]
    fn silence_grows_at_walking_speed_and_ends_in_being_lost() {
        let (track, now) = walked();
        let after = |ms: i64| track.whereabouts(now + Span::from_millis(ms)).unwrap();
        assert_eq!((after(200).presence, after(200).reach_m), (Presence::Tracked, 0.0));
        assert_eq!(after(900).presence, Presence::Stale);
        assert!((after(900).reach_m - 1.44).abs() < 1e-9);
        assert_eq!(after(4000).presence, Presence::Lost);
        assert!((after(10_000).reach_m - 16.0).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_is_refused_and_counted() {
        let (mut track, now) = walked();
        let absurd = [
            sighting(5000, 1.2),
            Sighting { at: Point::new(f64::NAN, 0.0), ..sighting(1050, 0.0) },
            Sighting { accuracy_m: f64::INFINITY, ..sighting(1060, 1.2) },
            sighting(1070, 999.0),
        ];
        for s in &absurd {
            assert_eq!(track.see(s, now, |p| p.x < 100.0), SightingOutcome::Ignored);
        }
        assert_eq!(track.counts().absurd, 4);
    }

    #[test]
    fn a_new_frame_moves_a_worker_without_a_walk() {
        let (mut track, now) = walked();
        let s = Sighting { epoch: 1, seq: 0, ..sighting(1050, 8.0) };
        assert_eq!(track.see(&s, now, |_| true), SightingOutcome::Relocated);
        assert_eq!(track.whereabouts(now).unwrap().velocity, Vector::zeros());
    }

    #[test]
    fn a_device_that_says_it_is_lost_is_believed_at_once() {
        let (mut track, now) = walked();
        let s = Sighting { quality: Quality::Lost, ..sighting(1050, 50.0) };
        track.see(&s, now, |_| true);
        let w = track.whereabouts(now + Span::from_millis(100)).unwrap();
        assert_eq!(w.presence, Presence::Lost);
        assert!((w.at.x - 1.2).abs() < 1e-9, "its last word on where it is does not count");
    }
}
