//! Where a simulated picker looks, and where the head faces meanwhile.
//!
//! Main type: [`Eyes`]. Eyes jump from place to place; the head follows part of the way, smoothly. Refuses: to know
//! where the hands are; the code that moves them gives their target.

use super::watch::angles_of;
use giveway_cell::FacePlace;
use giveway_floor::time::{Span, Time};

/// Shares of a target's yaw and pitch that the head turns, as measured of recorded people.
const TURNS: [f64; 2] = [0.7, 0.4];
/// The head follows through two lags of this length in a row, seconds: it starts and stops smoothly, and has completed
/// half of a turn after 0.17 s.
const LAG_S: f64 = 0.1;

/// Eyes and head of a picker.
#[derive(Clone, Copy, Debug)]
pub struct Eyes {
    /// The place that the eyes look at, and since when.
    at: FacePlace,
    since: Time,
    /// The next place to look at, and from when.
    next: Option<(Time, FacePlace)>,
    /// How far the head was from its final direction when the eyes jumped, and how fast that changed: yaw and pitch,
    /// radians and radians per second.
    lags: [[f64; 2]; 2],
}

impl Eyes {
    /// Eyes that have rested on a place.
    pub fn new(at: FacePlace, now: Time) -> Eyes {
        Eyes { at, since: now, next: None, lags: [[0.0; 2]; 2] }
    }

    /// The eyes jump to a place now, seen from the position of the head.
    pub fn look_at(&mut self, place: FacePlace, now: Time, head: FacePlace) {
        self.follow(now, head);
        self.next = None;
        self.jump(place, now, head);
    }

    /// The eyes jump to a place at a later time.
    pub fn look_later(&mut self, place: FacePlace, at: Time) {
        self.next = Some((at, place));
    }

    /// Makes the jumps that are due by now.
    pub fn follow(&mut self, now: Time, head: FacePlace) {
        if let Some((at, place)) = self.next.take_if(|(at, _)| *at <= now) {
            self.jump(place, at, head);
        }
    }

    /// Delays a pending jump by `by`.
    pub fn delay(&mut self, by: Span) {
        self.next = self.next.map(|(at, place)| (at + by, place));
    }

    /// The place that the eyes look at, and since when.
    pub fn place(&self) -> (FacePlace, Time) {
        (self.at, self.since)
    }

    /// Yaw and pitch of the eyes, seen from the position of the head.
    pub fn looks(&self, head: FacePlace) -> [f64; 2] {
        let (yaw, pitch) = angles_of(self.at - head);
        [yaw, pitch]
    }

    /// Yaw and pitch of the head at its position.
    pub fn faces(&self, now: Time, head: FacePlace) -> [f64; 2] {
        let (looks, lags) = (self.looks(head), self.lags_at(now));
        [0, 1].map(|i| TURNS[i] * (looks[i] + lags[i][0]))
    }

    fn jump(&mut self, place: FacePlace, now: Time, head: FacePlace) {
        if place == self.at {
            return;
        }
        let (before, lags) = (self.looks(head), self.lags_at(now));
        (self.at, self.since) = (place, now);
        let after = self.looks(head);
        self.lags = [0, 1].map(|i| [lags[i][0] + before[i] - after[i], lags[i][1]]);
    }

    /// The remainder of each lag, and how fast it changes.
    fn lags_at(&self, now: Time) -> [[f64; 2]; 2] {
        let t = (now - self.since).as_secs_f64().max(0.0);
        let left = libm::exp(-t / LAG_S);
        self.lags.map(|[off, rate]| {
            let slope = rate + off / LAG_S;
            [(off + slope * t) * left, (rate - slope * t / LAG_S) * left]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: FacePlace = FacePlace::new(0.0, 1.05, 1.63);

    fn ms(ms: i64) -> Time {
        Time::ZERO + Span::from_millis(ms)
    }

    #[test]
    fn at_rest_the_head_is_turned_by_seven_tenths_of_the_yaw_and_four_of_the_pitch() {
        let slot = FacePlace::new(0.33, 0.44, 0.75);
        let mut eyes = Eyes::new(FacePlace::new(0.0, 0.62, 2.15), Time::ZERO);
        eyes.look_at(slot, ms(100), HEAD);
        let (yaw, pitch) = angles_of(slot - HEAD);
        let [turned, tilted] = eyes.faces(ms(1500), HEAD);
        assert!((turned - 0.7 * yaw).abs() < 1e-4 && (tilted - 0.4 * pitch).abs() < 1e-4);
        assert_eq!(eyes.looks(HEAD), [yaw, pitch], "the eyes themselves are there");
    }

    #[test]
    fn a_head_neither_jumps_nor_starts_at_once_and_has_done_half_of_a_turn_after_a_sixth_of_a_second() {
        let (one, other) = (FacePlace::new(0.33, 0.44, 0.75), FacePlace::new(-0.75, 1.3, 0.85));
        let mut eyes = Eyes::new(one, Time::ZERO);
        // The second jump comes in the middle of the turn.
        eyes.look_at(other, ms(100), HEAD);
        eyes.look_later(one, ms(250));
        let mut turned = Vec::new();
        for at in 0..1500 {
            eyes.follow(ms(at), HEAD);
            turned.push(eyes.faces(ms(at), HEAD));
        }
        let step = |i: usize, k: usize| turned[i + 1][k] - turned[i][k];
        for (i, k) in (0..1498).flat_map(|i| [(i, 0), (i, 1)]) {
            assert!(step(i, k).abs() < 0.02, "no more than 20 radians a second");
            assert!((step(i + 1, k) - step(i, k)).abs() < 0.0006, "its speed does not jump at {i} ms");
        }
        assert!((turned[1499][0] - turned[0][0]).abs() < 1e-3, "it has turned back");
        let whole = 0.7 * angles_of(other - HEAD).0 - turned[0][0];
        let mut once = Eyes::new(one, Time::ZERO);
        once.look_at(other, Time::ZERO, HEAD);
        let share = (once.faces(ms(168), HEAD)[0] - turned[0][0]) / whole;
        assert!((share - 0.5).abs() < 0.01, "{share}");
    }
}
