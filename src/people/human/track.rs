//! Where one worker is, from all sources: agreeing sources give one place, disagreeing ones several, and silence widens
//! it.
//!
//! Main types: [`Track`], [`SightingOutcome`], [`Presence`], [`Whereabouts`]. Every kind of bad sighting has one
//! answer: late and repeated ones are ignored; jumps are ignored until several agree on the new place, and then the
//! worker may be at both; impossible ones are refused; silence grows the disc in which the worker may be. One source
//! leads, the most trusted and then the most exact; a source that knows nothing is not missed while another one knows.
//! Refuses: to guess where anybody is going.

use super::mover::Mover;
use super::sighting::{Sighting, SourceId};
use super::source::{HELD, SourceTrack, SourceVerdict, is_near, reach_m};
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};

pub use super::source::{LOST, STALE};

/// How far clocks and predicted display times may be ahead.
const AHEAD: Span = Span::from_millis(150);
/// Another source of equal trust takes the lead if it is better by this factor and this many metres more, so that the
/// lead does not switch back and forth.
const BETTER: (f64, f64) = (1.5, 0.1);

/// Standard deviation of a place that the journal or a supervisor gives, metres.
const REMEMBERED_M: f64 = 0.3;

/// How well a worker's position is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Presence {
    /// Not on the floor.
    #[default]
    Absent,
    /// Seen recently.
    Tracked,
    /// Not seen for a moment; the region around the last position grows.
    Stale,
    /// Not seen for long: robots stop in everything within reach until the worker is seen or cleared.
    Lost,
}

impl Presence {
    /// The state's word on the wire.
    pub fn word(self) -> &'static str {
        match self {
            Presence::Absent => "absent",
            Presence::Tracked => "tracked",
            Presence::Stale => "stale",
            Presence::Lost => "lost",
        }
    }
}

/// Counts of a source's sightings by outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub struct FeedCounts {
    /// Accepted sightings.
    pub taken: u64,
    /// Sightings not newer than the newest, or seen already.
    pub late: u64,
    /// Sightings too far from where the worker can be.
    pub jumps: u64,
    /// Impossible sightings: off the map, in the future, not a number.
    pub absurd: u64,
}

impl FeedCounts {
    fn add(&mut self, verdict: SourceVerdict) {
        match verdict {
            SourceVerdict::Late => self.late += 1,
            SourceVerdict::Doubted => self.jumps += 1,
            SourceVerdict::Jumped => (self.jumps, self.taken) = (self.jumps + 1, self.taken + 1),
            SourceVerdict::Lost | SourceVerdict::Moved | SourceVerdict::Relocated => self.taken += 1,
        }
    }
}

/// What a sighting changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SightingOutcome {
    /// The worker has moved.
    Moved,
    /// The worker is in a new place without having walked there: a new frame, or a jump that lasted.
    Relocated,
    /// The sighting was accepted, but another source leads.
    Noted,
    /// The sighting was ignored.
    Ignored,
}

/// Where a worker is, at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whereabouts {
    /// The last known position.
    pub at: Point,
    /// Standard deviation of the position, metres.
    pub sigma_m: f64,
    /// How far the worker may have walked unseen since, metres.
    pub reach_m: f64,
    /// Velocity, metres per second.
    pub velocity: Vector,
    /// Where the worker faces, radians; taken from the course if the source does not report it.
    pub heading: Option<f64>,
    /// How well the position is known.
    pub presence: Presence,
    /// What the worker moves as.
    pub mover: Mover,
}

/// A worker's position from another source than sightings: the journal, or a supervisor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LastKnown {
    /// The position.
    pub at: Point,
    /// Time of that position.
    pub seen: Time,
    /// Greatest distance from there, metres on foot, if a person vouches for it. Otherwise as far as a worker can have
    /// walked unseen.
    pub within_m: Option<f64>,
}

/// All that is known about where a worker is.
#[derive(Clone, Debug, Default)]
pub struct Track {
    sources: [SourceTrack; SourceId::ALL.len()],
    /// The source whose place counts most.
    lead: SourceId,
    counts: FeedCounts,
    /// The last known place from elsewhere, until a source knows.
    remembered: Option<LastKnown>,
    /// When the worker was last cleared or signed off: earlier sightings are ignored.
    ended: Option<Time>,
    /// What the worker moves as.
    mover: Mover,
}

impl LastKnown {
    fn whereabouts(&self, mover: Mover, now: Time) -> Whereabouts {
        // How fast the worker was is not remembered.
        let unseen_m = || reach_m(&mover, mover.assumed_mps(), (now - self.seen).max(Span::ZERO));
        Whereabouts {
            at: self.at,
            sigma_m: REMEMBERED_M,
            reach_m: self.within_m.unwrap_or_else(unseen_m),
            velocity: Vector::zeros(),
            heading: None,
            presence: Presence::Lost,
            mover,
        }
    }
}

impl Track {
    /// Counts of all sightings by outcome.
    pub fn counts(&self) -> FeedCounts {
        self.counts
    }

    /// The newest sighting of the leading source.
    pub fn newest(&self) -> Option<&Sighting> {
        self.of(self.lead).newest()
    }

    /// Clears the worker, who has left the floor or for whom a person vouches.
    pub fn clear(&mut self, now: Time) {
        let mover = self.mover;
        *self = Track { counts: self.counts, ended: Some(now), ..Track::default() };
        self.move_as(mover);
    }

    /// Sets what the worker moves as, from now on.
    pub fn move_as(&mut self, mover: Mover) {
        self.mover = mover;
        self.sources.iter_mut().for_each(|source| source.mover = mover);
    }

    /// What the worker moves as.
    pub fn mover(&self) -> Mover {
        self.mover
    }

    /// Sets the worker's last known place, which holds until a source knows better.
    pub fn remember(&mut self, place: LastKnown) {
        self.remembered = Some(place);
    }

    /// The wearer took the device off: no more sightings will come.
    pub fn sign_off(&mut self, now: Time) {
        self.ended = Some(now);
        self.sources.iter_mut().for_each(|source| source.sign_off(now));
    }

    /// Whether a supervisor vouches for the place.
    pub fn is_vouched(&self) -> bool {
        self.remembered.is_some_and(|r| r.within_m.is_some())
    }

    /// When the worker was last known to be somewhere.
    pub fn last_seen(&self) -> Option<Time> {
        self.newest().map(|s| s.seen).max(self.remembered.map(|r| r.seen))
    }

    /// Processes a sighting. `is_on_map` says whether a person can be at a place at all.
    pub fn see(&mut self, s: &Sighting, now: Time, is_on_map: impl Fn(Point) -> bool) -> SightingOutcome {
        let numbers = [s.at.x, s.at.y, s.accuracy_m, s.heading.unwrap_or(0.0)];
        if numbers.iter().any(|n| !n.is_finite()) || s.seen > now + AHEAD || !is_on_map(s.at) {
            self.counts.absurd += 1;
            return SightingOutcome::Ignored;
        }
        // The clock of a device may be ahead: a later sighting with an earlier time was already under way.
        if self.ended.is_some_and(|ended| s.seen <= ended + AHEAD) {
            self.counts.late += 1;
            return SightingOutcome::Ignored;
        }
        let before = self.newest().copied();
        let verdict = self.sources[s.source as usize].see(s);
        self.counts.add(verdict);
        let taken = match verdict {
            SourceVerdict::Late => return SightingOutcome::Ignored,
            SourceVerdict::Lost | SourceVerdict::Doubted => SightingOutcome::Ignored,
            SourceVerdict::Moved => SightingOutcome::Moved,
            SourceVerdict::Relocated | SourceVerdict::Jumped => SightingOutcome::Relocated,
        };
        if taken != SightingOutcome::Ignored {
            self.sources[s.source as usize].try_side(&is_on_map);
            self.remembered = None;
            self.compare(now);
        }
        let led = self.lead;
        self.lead = self.leader(now);
        match before {
            _ if taken == SightingOutcome::Ignored => taken,
            _ if self.lead != s.source => SightingOutcome::Noted,
            // Another source continues where the previous one was.
            Some(before) if led != s.source => {
                let reach_m = self.of(led).whereabouts(now).map_or(0.0, |w| w.reach_m);
                let goes_on = is_near(&self.mover, &before, s, reach_m);
                if goes_on { SightingOutcome::Moved } else { SightingOutcome::Relocated }
            }
            _ => taken,
        }
    }

    /// Sources that have jumped hear those that have not.
    fn compare(&mut self, now: Time) {
        if self.sources.iter().filter(|s| s.newest().is_some()).count() < 2 {
            return;
        }
        for witness in SourceId::ALL {
            let Some(said) = self.of(witness).newest().copied().filter(|_| self.of(witness).is_witness(now))
            else {
                continue;
            };
            for other in SourceId::ALL.into_iter().filter(|o| *o != witness) {
                self.sources[other as usize].hear_witness(&said, now);
            }
        }
    }

    /// The source that should lead: the most trusted, then the most exact; the present leader if the difference is
    /// small.
    fn leader(&self, now: Time) -> SourceId {
        let rank = |id: SourceId| {
            let (source, place) = (self.of(id), self.of(id).whereabouts(now)?);
            let lost = place.presence == Presence::Lost;
            Some(((lost, source.is_suspected(), source.is_jumpy(now)), place.sigma_m + place.reach_m))
        };
        let others = SourceId::ALL.into_iter().filter(|id| *id != self.lead);
        let mut best = (self.lead, rank(self.lead));
        for id in others {
            let Some((trust, spread_m)) = rank(id) else { continue };
            let leads =
                best.1.is_none_or(|(t, m)| trust < t || trust == t && spread_m * BETTER.0 + BETTER.1 < m);
            if leads {
                best = (id, Some((trust, spread_m)));
            }
        }
        best.0
    }

    fn of(&self, id: SourceId) -> &SourceTrack {
        &self.sources[id as usize]
    }

    /// Where the worker is now, by the leading source.
    pub fn whereabouts(&self, now: Time) -> Option<Whereabouts> {
        let seen = self.of(self.lead).whereabouts(now);
        match self.remembered {
            Some(place) if place.within_m.is_some() || seen.is_none() => {
                Some(place.whereabouts(self.mover, now))
            }
            _ => seen,
        }
    }

    /// How long no source has known where the worker is.
    pub fn silent(&self, now: Time) -> Option<Span> {
        let silent = SourceId::ALL.into_iter().filter_map(|id| self.of(id).silent(now)).min();
        silent.or_else(|| self.remembered.map(|place| now - place.seen))
    }

    /// Where else the worker may be: the places of sources that disagree, the places that a source left by a jump, and
    /// the other side of marks that lie on one line. At most eleven: three of each source, and two other sources.
    pub fn others(&self, now: Time) -> Vec<Whereabouts> {
        if self.is_vouched() {
            return Vec::new();
        }
        let Some((lead, best)) = self.newest().zip(self.whereabouts(now)) else { return Vec::new() };
        let knows = best.presence != Presence::Lost;
        let mut found = Vec::new();
        for id in SourceId::ALL {
            let source = self.of(id);
            if source.is_suspected() && knows {
                continue;
            }
            found.extend(source.left(now));
            found.extend(source.other_side(now));
            let Some((said, place)) =
                source.newest().zip(source.whereabouts(now)).filter(|_| id != self.lead)
            else {
                continue;
            };
            // A source that has been silent for long no longer contradicts.
            let is_over = source.silent(now).is_none_or(|s| s > HELD) && knows;
            if !is_over && !is_near(&self.mover, lead, said, best.reach_m + place.reach_m) {
                found.push(place);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::Quality;
    use giveway_floor::id::WorkerId;

    fn sighting(ms: i64, x: f64) -> Sighting {
        Sighting {
            mirror: None,
            worker: WorkerId(0),
            source: SourceId::Headset,
            seen: Time(ms * 1000),
            epoch: 0,
            at_marks: false,
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
    }

    #[test]
    fn distrust_widens_slowly_after_the_first_seconds_and_no_farther_than_it_may() {
        let (track, now) = walked();
        let reach = |s: f64| track.whereabouts(now + Span::from_secs_f64(s)).unwrap().reach_m;
        assert!((reach(3.0) - 4.8).abs() < 1e-9, "straight on at walking speed");
        assert!((reach(6.0) - 4.8 * 2f64.sqrt()).abs() < 1e-9, "then anywhere: the square root of time");
        assert_eq!([reach(30.0), reach(3600.0)], [8.0, 8.0]);
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
        let s = Sighting { epoch: 1, seq: 0, at_marks: true, ..sighting(1050, 8.0) };
        assert_eq!(track.see(&s, now, |_| true), SightingOutcome::Relocated);
        assert_eq!(track.whereabouts(now).unwrap().velocity, Vector::zeros());
        assert!(track.others(now).is_empty(), "marks were touched: the old place is over");
    }

    /// Sightings every 50 ms from `from` to `until`.
    fn stands(track: &mut Track, from: i64, until: i64, s: impl Fn(i64) -> Sighting) -> Vec<SightingOutcome> {
        (from..until).step_by(50).map(|ms| track.see(&s(ms), Time(ms * 1000), |_| true)).collect()
    }

    fn tag(ms: i64, x: f64) -> Sighting {
        Sighting { source: SourceId::Tag, accuracy_m: 0.25, ..sighting(ms, x) }
    }

    fn other_places(track: &Track, ms: i64) -> Vec<f64> {
        track.others(Time(ms * 1000)).iter().map(|w| w.at.x).collect()
    }

    #[test]
    fn a_new_epoch_without_marks_is_no_new_place_and_no_new_person() {
        let (mut track, now) = walked();
        let again = |ms: i64, x: f64| Sighting { epoch: 1, ..sighting(ms, x) };
        assert_eq!(track.see(&again(1050, 1.25), now, |_| true), SightingOutcome::Moved, "goes on");
        let far = stands(&mut track, 1100, 1350, |ms| Sighting { epoch: 2, ..sighting(ms, 30.0) });
        assert_eq!(far[..4], [SightingOutcome::Ignored; 4]);
        assert_eq!(far[4], SightingOutcome::Relocated);
        assert_eq!(other_places(&track, 1350), [1.25], "held to where the worker was, too");
    }

    #[test]
    fn a_source_that_jumps_is_held_to_both_places_until_marks_are_touched_or_half_a_minute_is_over() {
        let (mut track, _) = walked();
        stands(&mut track, 1050, 11_000, |ms| sighting(ms, 30.0));
        let held = track.others(Time(11_000_000));
        assert_eq!(held.len(), 1);
        assert!((held[0].at.x - 1.2).abs() < 1e-9 && held[0].reach_m < 0.01, "nobody walked since: {held:?}");
        let mut aligned = track.clone();
        let marks = Sighting { epoch: 1, at_marks: true, ..sighting(11_050, 30.0) };
        aligned.see(&marks, Time(11_050_000), |_| true);
        assert!(other_places(&aligned, 11_050).is_empty());
        let mut walks = track.clone();
        stands(&mut walks, 11_050, 13_050, |ms| sighting(ms, 30.0 + (ms - 11_000) as f64 / 1000.0));
        let reach_m = walks.others(Time(13_000_000))[0].reach_m;
        assert!((reach_m - 2.0).abs() < 0.01, "as far as the source saw a walk: {reach_m}");
        stands(&mut track, 11_050, 32_000, |ms| sighting(ms, 30.0));
        assert!(other_places(&track, 32_000).is_empty(), "half a minute is over");
    }

    #[test]
    fn a_source_that_jumps_to_and_fro_is_held_to_the_place_that_it_leaves() {
        let (mut track, _) = walked();
        stands(&mut track, 1050, 2000, |ms| sighting(ms, 30.0));
        assert_eq!(other_places(&track, 2000).len(), 1);
        stands(&mut track, 2000, 3000, |ms| sighting(ms, 1.2));
        assert_eq!(other_places(&track, 3000), [30.0], "it came back: that place is not left any more");
    }

    #[test]
    fn another_source_says_which_of_two_places_is_the_right_one() {
        for (truth, leads) in [(1.2, SourceId::Tag), (30.0, SourceId::Headset)] {
            let (mut track, _) = walked();
            stands(&mut track, 1050, 2000, |ms| sighting(ms, 30.0));
            track.see(&tag(2000, truth), Time(2_000_000), |_| true);
            assert!(other_places(&track, 2000).is_empty(), "the truth is {truth}");
            assert!((track.whereabouts(Time(2_000_000)).unwrap().at.x - truth).abs() < 1e-9);
            assert_eq!(track.newest().unwrap().source, leads, "the one that was right");
        }
    }

    #[test]
    fn marks_on_one_line_hold_a_worker_to_both_sides_until_the_map_or_another_source_shows_which() {
        let both = |ms: i64| {
            let y = 2.0 + 0.001 * ms as f64;
            Sighting { at: Point::new(1.0, y), mirror: Some(Point::new(1.0, -y)), ..sighting(ms, 0.0) }
        };
        let mut track = Track::default();
        stands(&mut track, 50, 1050, both);
        let others = track.others(Time(1_000_000));
        assert_eq!((others.len(), others[0].at), (1, Point::new(1.0, -3.0)));
        assert!((others[0].velocity - Vector::new(0.0, -1.0)).norm() < 0.01, "it walks there as in a mirror");
        let tag = |ms: i64, y: f64| Sighting { at: Point::new(1.0, y), ..tag(ms, 0.0) };
        for (truth, leads) in [(3.05, SourceId::Headset), (-3.05, SourceId::Tag)] {
            let mut track = track.clone();
            track.see(&tag(1050, truth), Time(1_050_000), |_| true);
            stands(&mut track, 1100, 1200, both);
            assert!(track.others(Time(1_150_000)).is_empty(), "the truth is {truth}");
            assert_eq!(track.newest().unwrap().source, leads, "the one that was right");
        }
        let mut track = Track::default();
        for ms in (50..1050).step_by(50) {
            track.see(&both(ms), Time(ms * 1000), |p| p.y > -1.0);
        }
        assert!(track.others(Time(1_000_000)).is_empty(), "nobody is off the map");
        let again = |ms: i64| Sighting { epoch: 1, at_marks: true, ..both(ms) };
        stands(&mut track, 1050, 1150, again);
        assert_eq!(track.others(Time(1_100_000)).len(), 1, "other marks begin anew");
    }

    #[test]
    fn sources_that_agree_are_one_place_and_the_more_exact_one_leads() {
        let (mut track, now) = walked();
        assert_eq!(track.see(&tag(1000, 1.5), now, |_| true), SightingOutcome::Noted);
        assert!(track.others(now).is_empty());
        assert_eq!(track.newest().unwrap().source, SourceId::Headset);
        // Each source has its own order: an older number of another source is not late.
        assert_eq!(track.see(&sighting(1010, 1.2), now, |_| true), SightingOutcome::Moved);
        assert_eq!(track.counts().late, 0);
    }

    #[test]
    fn sources_that_do_not_agree_hold_a_worker_to_both_places() {
        let (mut track, now) = walked();
        track.see(&tag(1000, 9.0), now, |_| true);
        assert_eq!(track.whereabouts(now).unwrap().at.x, 1.2);
        assert_eq!(other_places(&track, 1000), [9.0]);
    }

    #[test]
    fn a_source_that_is_silent_or_lost_is_not_missed_while_another_one_knows() {
        let (mut track, _) = walked();
        let mut taken = Vec::new();
        for ms in (1000..40_000).step_by(200) {
            taken.push(track.see(&tag(ms, 1.2), Time(ms * 1000), |_| true));
        }
        let w = track.whereabouts(Time(39_900_000)).unwrap();
        assert_eq!((w.presence, w.reach_m), (Presence::Tracked, 0.0));
        assert!(track.others(Time(39_900_000)).is_empty());
        assert!(!taken.contains(&SightingOutcome::Relocated), "it goes on where the headset was");
        // The headset is back, and better.
        let back = stands(&mut track, 40_000, 40_100, |ms| sighting(ms, 1.3));
        assert_eq!(back, [SightingOutcome::Moved; 2]);
        assert_eq!(track.newest().unwrap().source, SourceId::Headset);
        track.see(&Sighting { quality: Quality::Lost, ..sighting(40_100, 1.3) }, Time(40_100_000), |_| true);
        assert_eq!(track.whereabouts(Time(40_100_000)).unwrap().presence, Presence::Tracked);
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
