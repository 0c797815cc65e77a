//! How devices see a worker: poses with age, noise, drift, wrong anchors, jumps, new frames, silence, loss and repeats.
//!
//! Main type: [`Device`]. Faults act on the measurement only, never on the worker. Refuses: to say which poses are
//! wrong.

use crate::random::Stream;
use crate::scenario::{Sensor, Source};
use giveway_floor::geometry::{Point, Pose, Vector, wrap_angle};
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use giveway_people::human::{Quality, Sighting, SourceId};
use nalgebra::Rotation2;

/// Offset from the purposes of the first device's streams to those of the second.
const SECOND: u64 = 100;

/// How long a device reports that it is lost before the new frame begins.
const LOST: Span = Span::from_millis(300);
/// Shortest and longest jump of a position, metres, and shortest and longest duration of a jump, seconds.
const JUMP: ((f64, f64), (f64, f64)) = ((1.0, 3.0), (0.5, 2.0));

/// A fault that occurs at random and lasts for some time.
#[derive(Debug)]
struct Spell {
    per_hour: f64,
    next: Time,
    until: Time,
    random: Stream,
    count: u64,
}

impl Spell {
    fn new(per_hour: f64, now: Time, mut random: Stream) -> Spell {
        let next = if per_hour > 0.0 { after(now, per_hour, &mut random) } else { Time::MAX };
        Spell { per_hour, next, until: now, random, count: 0 }
    }

    /// Whether a spell begins by `now`; it then lasts between `low` and `high` seconds.
    fn begins(&mut self, now: Time, low: f64, high: f64) -> bool {
        if now < self.next {
            return false;
        }
        self.count += 1;
        self.until = self.next + Span::from_secs_f64(self.random.between(low, high));
        self.next = after(self.until, self.per_hour, &mut self.random);
        true
    }

    fn lasts(&self, now: Time) -> bool {
        now < self.until
    }
}

fn after(now: Time, per_hour: f64, random: &mut Stream) -> Time {
    now + Span::from_secs_f64(random.exponential(3600.0 / per_hour))
}

/// A device that a worker carries.
#[derive(Debug)]
pub(super) struct Device {
    sensor: Sensor,
    noise: Stream,
    radio: Stream,
    frames: Stream,
    silence: Spell,
    /// Until when the device also sends nothing because it was told to.
    mute_until: Time,
    jumps: Spell,
    resets: Spell,
    jump: Vector,
    next: Time,
    epoch: u32,
    seq: u64,
    /// Where the last anchor was and after how many metres walked; then the error of its direction, and the drift.
    anchor: Option<(Point, f64)>,
    anchor_turn: f64,
    drift: Vector,
    under_way: Vec<(Time, u64, Sighting)>,
}

impl Device {
    /// The device of worker number `who`, switched on at `now`.
    pub fn new(sensor: Sensor, seed: u64, who: u64, now: Time) -> Device {
        Device::drawing(sensor, |purpose| Stream::new(seed, purpose, who), now)
    }

    /// A second device for worker number `who`. It draws from streams of its own, so that the first device sees the
    /// same with and without it.
    pub fn second(sensor: Sensor, seed: u64, who: u64, now: Time) -> Device {
        Device::drawing(sensor, |purpose| Stream::new(seed, purpose + SECOND, who), now)
    }

    fn drawing(sensor: Sensor, stream: impl Fn(u64) -> Stream, now: Time) -> Device {
        Device {
            noise: stream(50),
            radio: stream(51),
            frames: stream(52),
            silence: Spell::new(sensor.silences_per_hour, now, stream(53)),
            mute_until: now,
            jumps: Spell::new(sensor.jumps_per_hour, now, stream(54)),
            resets: Spell::new(sensor.resets_per_hour, now, stream(55)),
            sensor,
            jump: Vector::zeros(),
            next: now,
            epoch: 1,
            seq: 0,
            anchor: None,
            anchor_turn: 0.0,
            drift: Vector::zeros(),
            under_way: Vec::new(),
        }
    }

    /// Measures the worker, whose true pose is `pose` after `walked_m` metres, if a measurement is due.
    pub fn look(&mut self, now: Time, worker: WorkerId, pose: Pose, walked_m: f64) {
        if now < self.next {
            return;
        }
        self.next += Span::from_secs_f64(1.0 / self.sensor.rate());
        self.silence.begins(now, 0.5 * self.sensor.silence_s, self.sensor.silence_s);
        if self.resets.begins(now, LOST.as_secs_f64(), LOST.as_secs_f64()) {
            self.begin_frame();
        }
        let sighting = self.measure(now, worker, pose, walked_m);
        self.seq += 1;
        if !self.silence.lasts(now) && now >= self.mute_until {
            self.send(now, sighting);
        }
    }

    /// The device sends nothing until `until`.
    pub fn fall_silent(&mut self, until: Time) {
        self.mute_until = until;
    }

    /// Begins a new frame at an anchor where the wearer is, without the errors of the old frame: the device lost its
    /// position, or the worker touched marks.
    pub fn begin_frame(&mut self) {
        (self.epoch, self.seq, self.anchor) = (self.epoch + 1, 0, None);
    }

    /// How often the device was silent, jumped, and began a new frame.
    pub fn counts(&self) -> [u64; 3] {
        [self.silence.count, self.jumps.count, self.resets.count]
    }

    /// Observations that have arrived by `now`, in order of arrival.
    pub fn arrivals(&mut self, now: Time) -> Vec<Sighting> {
        self.under_way.sort_by_key(|(due, order, _)| (*due, *order));
        let count = self.under_way.partition_point(|(due, ..)| *due <= now);
        self.under_way.drain(..count).map(|(_, _, s)| s).collect()
    }

    fn measure(&mut self, now: Time, worker: WorkerId, pose: Pose, walked_m: f64) -> Sighting {
        let (at, since) = match self.anchor {
            Some((at, since)) if walked_m - since < self.sensor.anchor_m => (at, since),
            _ => self.meet_anchor(pose.at, walked_m),
        };
        if self.jumps.begins(now, JUMP.1.0, JUMP.1.1) {
            let far = self.frames.between(JUMP.0.0, JUMP.0.1);
            let turn = self.frames.between(0.0, std::f64::consts::TAU);
            self.jump = Rotation2::new(turn) * Vector::new(far, 0.0);
        }
        let sigma = self.sensor.sigma();
        let noise = Vector::new(self.noise.normal(), self.noise.normal()) * sigma;
        let drift = self.sensor.drift * (walked_m - since);
        let jump = if self.jumps.lasts(now) { self.jump } else { Vector::zeros() };
        let turned = at + Rotation2::new(self.anchor_turn) * (pose.at - at);
        let yaw = self.noise.normal() * self.sensor.yaw_sigma_deg.to_radians();
        let heading = wrap_angle(pose.heading + self.anchor_turn + yaw);
        let lost = self.resets.lasts(now);
        let tag = self.sensor.source == Source::Tag;
        Sighting {
            mirror: None,
            worker,
            source: if tag { SourceId::Tag } else { SourceId::Headset },
            seen: now,
            epoch: self.epoch,
            // A headset's frame begins where it knows an anchor.
            at_marks: !tag,
            seq: self.seq,
            at: turned + noise + self.drift * drift + jump,
            heading: (!tag).then_some(heading),
            accuracy_m: (sigma.powi(2) + drift.powi(2)).sqrt().max(0.01),
            quality: if lost { Quality::Lost } else { Quality::Tracked },
        }
    }

    /// An anchor corrects the position and turns the frame by a small random angle.
    fn meet_anchor(&mut self, at: Point, walked_m: f64) -> (Point, f64) {
        self.anchor = Some((at, walked_m));
        self.anchor_turn = self.frames.between(-1.0, 1.0) * self.sensor.anchor_deg.to_radians();
        let turn = self.frames.between(0.0, std::f64::consts::TAU);
        self.drift = Rotation2::new(turn) * Vector::new(1.0, 0.0);
        (at, walked_m)
    }

    fn send(&mut self, now: Time, sighting: Sighting) {
        let Sensor { loss, repeat, delay_ms, jitter_ms, .. } = self.sensor;
        // Each pose takes the same number of draws, whatever happens to it.
        let (lost, twice) = (self.radio.happens_of(loss), self.radio.happens_of(repeat));
        for copy in [true, twice] {
            let delay = delay_ms + jitter_ms * self.radio.unit();
            if copy && !lost {
                let due = now + Span::from_secs_f64(delay / 1000.0);
                self.under_way.push((due, self.under_way.len() as u64, sighting));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All observations while a worker walks along x at 1.2 m/s for `seconds`, each with its arrival time.
    fn seen(sensor: Sensor, seconds: i64) -> Vec<(Time, Sighting)> {
        let mut device = Device::new(sensor, 1, 0, Time::ZERO);
        let mut all = Vec::new();
        for i in 0..seconds * 50 {
            let now = Time(i * 20_000);
            let walked = 1.2 * now.as_secs_f64();
            let pose = Pose { at: Point::new(walked, 0.0), heading: 0.0 };
            device.look(now, WorkerId(0), pose, walked);
            all.extend(device.arrivals(now).into_iter().map(|s| (now, s)));
        }
        all
    }

    fn error(s: &Sighting) -> f64 {
        (s.at - Point::new(1.2 * s.seen.as_secs_f64(), 0.0)).norm()
    }

    #[test]
    fn a_headset_without_faults_is_right_and_in_order() {
        let all = seen(Sensor::default(), 60);
        assert!((1150..=1200).contains(&all.len()), "{}", all.len());
        assert!(all.windows(2).all(|w| w[0].1.seen < w[1].1.seen));
        assert!(all.iter().all(|(now, s)| error(s) < 0.12 && s.heading.is_some() && *now > s.seen));
    }

    #[test]
    fn a_tag_knows_no_heading_and_is_off_by_a_quarter_metre() {
        let all = seen(Sensor { source: Source::Tag, ..Sensor::default() }, 600);
        assert!((2950..=3000).contains(&all.len()), "{}", all.len());
        assert!(all.iter().all(|(_, s)| s.heading.is_none()));
        let mean2 = all.iter().map(|(_, s)| error(s).powi(2)).sum::<f64>() / all.len() as f64;
        assert!((mean2.sqrt() - 0.25 * 2f64.sqrt()).abs() < 0.02, "{}", mean2.sqrt());
    }

    #[test]
    fn drift_grows_with_the_metres_walked_and_an_anchor_ends_it() {
        let all = seen(Sensor { drift: 0.02, sigma_m: Some(0.0), ..Sensor::default() }, 60);
        let worst = |metres: std::ops::Range<f64>| {
            let there = all.iter().filter(|(_, s)| metres.contains(&(1.2 * s.seen.as_secs_f64())));
            there.map(|(_, s)| error(s)).fold(0.0, f64::max)
        };
        assert!(worst(0.0..5.0) < 0.11 && (0.55..=0.61).contains(&worst(25.0..30.0)));
        assert!(worst(30.1..32.0) < 0.05, "{}", worst(30.1..32.0));
    }

    #[test]
    fn a_faulty_headset_shows_every_fault() {
        let all = seen(Sensor::default().faulty(), 7200);
        let sent = 7200.0 * 20.0;
        assert!((all.len() as f64) < 0.99 * sent, "nothing is lost");
        assert!(all.windows(2).any(|w| w[0].1.seen > w[1].1.seen), "nothing overtakes");
        assert!(all.iter().any(|(_, s)| s.quality == Quality::Lost), "it never loses itself");
        assert!(all.iter().any(|(_, s)| s.epoch > 1), "no new frame");
        assert!(all.iter().any(|(_, s)| error(s) > 1.0), "no jump");
        let keys: std::collections::BTreeSet<(u32, u64)> =
            all.iter().map(|(_, s)| (s.epoch, s.seq)).collect();
        assert!(keys.len() < all.len(), "nothing comes twice");
        let mut times: Vec<Time> = all.iter().map(|(_, s)| s.seen).collect();
        times.sort_unstable();
        assert!(times.windows(2).any(|w| w[1] - w[0] > Span::from_secs(1)), "no silence");
    }

    #[test]
    fn faults_of_one_kind_leave_the_noise_of_all_poses_as_it_was() {
        let plain = seen(Sensor::default(), 30);
        let lossy = seen(Sensor { loss: 0.3, ..Sensor::default() }, 30);
        assert!(lossy.len() < plain.len() * 8 / 10);
        assert!(lossy.iter().all(|(_, s)| plain.iter().any(|(_, p)| p == s)));
    }
}
