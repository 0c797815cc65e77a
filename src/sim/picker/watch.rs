//! How a headset sees the hands of a simulated picker.
//!
//! Main type: [`HandWatch`]. What it gives is late, noisy, sometimes missing, swapped or elsewhere; the hands are where
//! they are. Refuses: to change what is true.

use crate::cell::{FacePlace, HandPoints, HandsSeen, PickFace};
use crate::id::StationId;
use crate::sim::HandSensor;
use crate::sim::random::Stream;
use crate::time::{Span, Time};
use crate::warehouse::Place;

/// How long hands are taken for one another, and how long one is seen elsewhere, seconds.
const SWAP_S: f64 = 0.5;
const JUMP_S: f64 = 0.1;
/// How far away, metres.
const JUMP_M: f64 = 0.5;
/// From the finger tips to palm and wrist, metres.
const PALM_M: f64 = 0.09;
const WRIST_M: f64 = 0.17;

/// Where a picker truly is at one instant, in the frame of the face.
#[derive(Clone, Copy, Debug)]
pub struct TruePicker {
    /// The middle of the head.
    pub head: FacePlace,
    /// Where the head faces: yaw to the right of straight at the rack and pitch up, radians.
    pub faces: [f64; 2],
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
    /// What was seen and has not come yet, with when it comes.
    under_way: Vec<(Time, HandsSeen)>,
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
        }
    }

    /// When it looks next.
    pub fn next(&self) -> Time {
        self.next
    }

    /// Nobody wears it now.
    pub fn pass(&mut self) {
        self.next += Span::from_secs_f64(1.0 / self.sensor.rate_hz);
    }

    /// Looks once.
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
        let [yaw, pitch] = truth.faces;
        let ahead = FacePlace::new(yaw.sin() * pitch.cos(), -yaw.cos() * pitch.cos(), pitch.sin());
        let facing = Some(face.on_map(truth.head + ahead) - head);
        self.under_way.push((comes, HandsSeen { station, person, seen: now, head, facing, hands }));
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

    /// What has come by now, in the order in which it came.
    pub fn come(&mut self, now: Time) -> Vec<HandsSeen> {
        let (mut come, left): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.under_way).into_iter().partition(|(at, _)| *at <= now);
        self.under_way = left;
        come.sort_by_key(|(at, _)| *at);
        come.into_iter().map(|(_, seen)| seen).collect()
    }
}

/// Yaw to the right of straight at the rack, and pitch up, of a direction in the frame of the face; radians.
pub fn angles_of(off: FacePlace) -> (f64, f64) {
    (off.x.atan2(-off.y), off.z.atan2(off.xy().norm()))
}
