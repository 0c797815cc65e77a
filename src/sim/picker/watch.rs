//! How a headset sees the hands of a simulated picker.
//!
//! Main type: [`HandWatch`]. Its observations are late, noisy, sometimes missing, swapped or misplaced; the hands are
//! where they are. Of gaze it reports what its kind measures. Refuses: to change the truth.

use crate::random::Stream;
use crate::scenario::{HandSensor, SeenGaze};
use giveway_cell::{FacePlace, HandPoints, HandsSeen, PickFace};
use giveway_floor::id::StationId;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Place;

/// How long the hands are taken for each other, and how long one is seen elsewhere, seconds.
const SWAP_S: f64 = 0.5;
const JUMP_S: f64 = 0.1;
/// How far away a misplaced hand is seen, metres.
const JUMP_M: f64 = 0.5;
/// Distance from the finger tips to palm and wrist, metres.
const PALM_M: f64 = 0.09;
const WRIST_M: f64 = 0.17;
/// Error of measured eye directions, radians in each of yaw and pitch: 1 degree in the median, like those of the
/// recorded wearer.
const EYES_RAD: f64 = 0.015;
/// How long the arrival times of hands are kept.
const REMEMBERS: Span = Span::from_secs(1);

/// A picker's true head and hands at one instant, in the frame of the face.
#[derive(Clone, Copy, Debug)]
pub struct TruePicker {
    /// The middle of the head.
    pub head: FacePlace,
    /// Where the head faces: yaw to the right of straight at the rack and pitch up, radians.
    pub faces: [f64; 2],
    /// Where the eyes look, as yaw and pitch like those of `faces`, radians.
    pub looks: [f64; 2],
    /// Where the finger tips of the left and the right hand are.
    pub grips: [FacePlace; 2],
}

/// A headset that sees hands.
#[derive(Clone, Debug)]
pub struct HandWatch {
    sensor: HandSensor,
    random: Stream,
    next: Time,
    swapped_until: Time,
    jumps_until: [Time; 2],
    jump: FacePlace,
    /// Observations under way, with their arrival times.
    under_way: Vec<(Time, HandsSeen)>,
    /// Recent observations: when the hands were seen, and when the observation arrived.
    came: Vec<(Time, Time)>,
}

impl HandWatch {
    /// A headset that is worn from now on.
    pub fn new(sensor: HandSensor, random: Stream, now: Time) -> HandWatch {
        let never = [Time::ZERO; 2];
        let jump = FacePlace::zeros();
        HandWatch {
            sensor,
            random,
            next: now,
            swapped_until: now,
            jumps_until: never,
            jump,
            under_way: vec![],
            came: vec![],
        }
    }

    /// When the headset looks next.
    pub fn next(&self) -> Time {
        self.next
    }

    /// Skips one look while nobody wears the headset.
    pub fn pass(&mut self) {
        self.next += Span::from_secs_f64(1.0 / self.sensor.rate_hz);
    }

    /// Makes one observation.
    pub fn look(&mut self, (station, person): (StationId, u32), face: &PickFace, truth: &TruePicker) {
        let (now, period) = (self.next, 1.0 / self.sensor.rate_hz);
        self.next = now + Span::from_secs_f64(period);
        self.go_wrong(now, period);
        if self.random.happens_of(self.sensor.loss) {
            return;
        }
        let mut hands = [0, 1].map(|i| self.hand(face, truth, (i, truth.grips[i]), now));
        if now < self.swapped_until {
            hands.swap(0, 1);
        }
        let late_ms = self.sensor.delay_ms + self.sensor.jitter_ms * self.random.normal();
        let comes = now + Span::from_secs_f64(late_ms.max(0.0) / 1000.0);
        let head = face.on_map(truth.head);
        let ray = |[yaw, pitch]: [f64; 2]| {
            let ahead = FacePlace::new(yaw.sin() * pitch.cos(), -yaw.cos() * pitch.cos(), pitch.sin());
            face.on_map(truth.head + ahead) - head
        };
        let facing = (self.sensor.gaze != SeenGaze::None).then(|| ray(truth.faces));
        let eyes = self.eyes(truth).map(ray);
        self.under_way.push((comes, HandsSeen { station, person, seen: now, head, facing, eyes, hands }));
    }

    /// Yaw and pitch of the eyes, if this kind of headset measures them.
    fn eyes(&mut self, truth: &TruePicker) -> Option<[f64; 2]> {
        let measures = self.sensor.gaze == SeenGaze::Eyes;
        measures.then(|| truth.looks.map(|angle| angle + EYES_RAD * self.random.normal()))
    }

    fn go_wrong(&mut self, now: Time, period: f64) {
        let hours = period / 3600.0;
        if self.random.happens(self.sensor.swaps_per_hour * hours) {
            self.swapped_until = now + Span::from_secs_f64(SWAP_S);
        }
        if self.random.happens(self.sensor.jumps_per_hour * hours) {
            let hand = self.random.below(2);
            self.jumps_until[hand] = now + Span::from_secs_f64(JUMP_S);
            let [x, y, z] = [0; 3].map(|_| self.random.normal());
            self.jump = FacePlace::new(x, y, z).normalize() * JUMP_M;
        }
    }

    fn hand(
        &mut self,
        face: &PickFace,
        truth: &TruePicker,
        (i, grip): (usize, FacePlace),
        now: Time,
    ) -> Option<HandPoints> {
        if !self.is_in_view(truth, grip) {
            return None;
        }
        let jump = if now < self.jumps_until[i] { self.jump } else { FacePlace::zeros() };
        // The arm comes from the shoulder.
        let back = (truth.head - FacePlace::new(0.0, 0.0, 0.25) - grip).try_normalize(1e-6)?;
        let mut seen = |at: FacePlace| {
            let [x, y, z] = [0; 3].map(|_| self.sensor.sigma_m * self.random.normal());
            face.on_map(at + jump + FacePlace::new(x, y, z))
        };
        let [wrist, palm]: [Place; 2] = [WRIST_M, PALM_M].map(|m| seen(grip + back * m));
        Some(HandPoints { wrist, palm, tips: [seen(grip), seen(grip)] })
    }

    fn is_in_view(&self, truth: &TruePicker, at: FacePlace) -> bool {
        let off = at - truth.head;
        let (yaw, pitch) = angles_of(off);
        let [wide, high] = self.sensor.view_deg.map(|deg| deg.to_radians() / 2.0);
        (yaw - truth.faces[0]).abs() <= wide && (pitch - truth.faces[1]).abs() <= high
    }

    /// Observations that have arrived by now, in order of arrival.
    pub fn come(&mut self, now: Time) -> Vec<HandsSeen> {
        let (mut come, left): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.under_way).into_iter().partition(|(at, _)| *at <= now);
        self.under_way = left;
        come.sort_by_key(|(at, _)| *at);
        self.came.retain(|(_, at)| now - *at < REMEMBERS);
        self.came.extend(come.iter().map(|(at, hands)| (hands.seen, *at)));
        come.into_iter().map(|(_, seen)| seen).collect()
    }

    /// When the observation made at `seen` arrived, if that was a moment ago.
    pub fn came_at(&self, seen: Time) -> Option<Time> {
        self.came.iter().find(|(of, _)| *of == seen).map(|(_, at)| *at)
    }
}

/// Yaw to the right of straight at the rack, and pitch up, of a direction in the frame of the face, radians.
pub fn angles_of(off: FacePlace) -> (f64, f64) {
    (off.x.atan2(-off.y), off.z.atan2(off.xy().norm()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::stations;

    const TRUTH: TruePicker = TruePicker {
        head: FacePlace::new(0.0, 1.05, 1.63),
        faces: [0.14, -0.2],
        looks: [0.2, -0.5],
        grips: [FacePlace::new(-0.22, 0.8, 1.2), FacePlace::new(0.1, 0.7, 1.2)],
    };

    fn face() -> PickFace {
        let w = stations();
        let (station, rack) = (&w.stations[StationId(0)], w.rack_types.iter().next().unwrap());
        PickFace::new(station.cell.as_ref().unwrap(), w.nodes[station.node].at, rack)
    }

    /// What a headset of this kind sends of a person who does not move.
    fn seen_by(gaze: SeenGaze) -> Vec<HandsSeen> {
        let sensor = HandSensor { gaze, loss: 0.0, ..HandSensor::default() };
        let mut watch = HandWatch::new(sensor, Stream::new(1, 99, 0), Time::ZERO);
        (0..300).for_each(|_| watch.look((StationId(0), 0), &face(), &TRUTH));
        watch.come(Time::from_secs_f64(60.0))
    }

    /// Yaw and pitch of a ray of an observation.
    fn angles_on_map(ray: Option<nalgebra::Vector3<f64>>) -> [f64; 2] {
        let (yaw, pitch) = angles_of(face().direction(ray.expect("it is sent")));
        [yaw, pitch]
    }

    #[test]
    fn a_headset_sends_where_the_head_faces_and_one_that_measures_eyes_where_they_look() {
        assert!(seen_by(SeenGaze::None).iter().all(|seen| (seen.facing, seen.eyes) == (None, None)));
        assert!(seen_by(SeenGaze::Head).iter().all(|seen| seen.eyes.is_none()));
        for seen in [SeenGaze::Head, SeenGaze::Eyes].into_iter().flat_map(seen_by) {
            let [yaw, pitch] = angles_on_map(seen.facing);
            assert!((yaw - 0.14).abs() < 1e-9 && (pitch + 0.2).abs() < 1e-9);
        }
        let off = |seen: &HandsSeen| {
            let [yaw, pitch] = angles_on_map(seen.eyes);
            (yaw - 0.2).hypot(pitch + 0.5).to_degrees()
        };
        let mut off: Vec<f64> = seen_by(SeenGaze::Eyes).iter().map(off).collect();
        off.sort_by(f64::total_cmp);
        assert!((off[150] - 1.0).abs() < 0.15, "median {}", off[150]);
        assert!((off[270] - 2.0).abs() < 0.4, "nine in ten {}", off[270]);
    }

    #[test]
    fn a_headset_knows_when_what_it_saw_has_come() {
        let mut watch = HandWatch::new(
            HandSensor { loss: 0.0, ..HandSensor::default() },
            Stream::new(1, 99, 0),
            Time::ZERO,
        );
        (0..30).for_each(|_| watch.look((StationId(0), 0), &face(), &TRUTH));
        let now = Time::from_secs_f64(0.4);
        let come = watch.come(now);
        for seen in come.iter().map(|hands| hands.seen) {
            let came = watch.came_at(seen).expect("it has come");
            assert!(seen <= came && came <= now);
        }
        assert!(come.len() > 10 && watch.came_at(Time(1)).is_none());
    }
}
