//! One movement of a hand to a place.
//!
//! Main types: [`ArmReach`], [`ArmPose`]. All random values are drawn when the reach begins; from then on it is a
//! function of time. Refuses: to reach farther than the arm is long; the person leans instead.

use super::build::{ArmBuild, ArmRest, ArmSide};
use crate::random::Stream;
use giveway_people::reach::sample::angles;
use giveway_people::reach::{ArmPoint, ArmSample, ArmVector, ReachTarget};

/// A person at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmPose {
    /// What a perfect sensor would see, at the time of the reach.
    pub sample: ArmSample,
    /// Position of the elbow.
    pub elbow: ArmPoint,
    /// Position of the wrist.
    pub wrist: ArmPoint,
    /// Yaw and pitch of the eyes, radians.
    pub gaze: (f64, f64),
}

/// One reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmReach {
    build: ArmBuild,
    from: ArmRest,
    to: ArmRest,
    /// Duration of the first, large movement, seconds.
    first_s: f64,
    /// Exponent of the warp, which sets how early the speed peaks.
    warp: f64,
    /// Height and direction of the bend, metres.
    bend: ArmVector,
    /// How far the first movement misses, then the start and duration of the correction.
    missed: ArmVector,
    correction_s: (f64, f64),
    head_s: (f64, f64),
    look: (f64, f64),
    looks_from_s: f64,
    wanders: Option<(f64, f64, f64)>,
    tremor: [(f64, f64, f64); 3],
}

/// Minimum jerk from 0 to 1 (Flash and Hogan 1985).
pub fn minimum_jerk(share: f64) -> f64 {
    let s = share.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

/// Minimum jerk over a warped time: faster at first.
fn warped(share: f64, warp: f64) -> f64 {
    let s = share.clamp(0.0, 1.0);
    minimum_jerk(1.0 - libm::pow(1.0 - s, warp))
}

/// The warp for which the speed peaks at this share of the time.
fn warp_of(peak: f64) -> f64 {
    const STEPS: usize = 60;
    let peak_of = |warp: f64| {
        let speed = |i: usize| {
            let s = i as f64 / STEPS as f64;
            warped(s + 0.005, warp) - warped(s - 0.005, warp)
        };
        let fastest = (1..STEPS).max_by(|a, b| speed(*a).total_cmp(&speed(*b)));
        fastest.unwrap_or(STEPS / 2) as f64 / STEPS as f64
    };
    let (mut low, mut high) = (0.6, 4.0);
    for _ in 0..10 {
        let middle = 0.5 * (low + high);
        if peak_of(middle) > peak { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

impl ArmReach {
    /// A reach of this person; `to` gives where the finger tip should end and where the place is seen.
    pub fn new(build: &ArmBuild, from: &ArmRest, to: &ReachTarget, chance: &mut Stream) -> ArmReach {
        let to = if build.side == ArmSide::Left { to.mirrored() } else { *to };
        let mut noise = |sd: f64| ArmVector::new(chance.normal(), chance.normal(), chance.normal()) * sd;
        let finger = to.hand + build.ends + noise(0.025);
        let (missed, bend_noise) = (noise(1.0), noise(0.35));
        let along = (finger - build.shoulder).normalize();
        let going = |metres: f64, chance: &mut Stream| along * metres * libm::exp(0.4 * chance.normal());
        let head = build.head + going(build.goes_along_m.1, chance);
        let mut shoulder = build.shoulder + going(build.goes_along_m.0, chance);
        // A person who cannot reach it leans.
        let lacks = (finger - shoulder).norm() - 0.97 * build.longest_m();
        shoulder += along * lacks.max(0.0);
        let (yaw, pitch) = angles(to.look - head);
        let turned = |share: f64, angle: f64, own: f64, chance: &mut Stream| {
            own + (share + 0.08 * chance.normal()) * (angle - own) + 0.02 * chance.normal()
        };
        let end = ArmRest {
            finger,
            shoulder,
            head,
            yaw: turned(build.yaw_share, yaw, build.ahead.0, chance),
            pitch: turned(build.pitch_share, pitch, build.ahead.1, chance),
            points: (along + ArmVector::new(0.2, 0.0, 0.0)).normalize(),
        };
        let way = finger - from.finger;
        let distance = way.norm().max(0.02);
        // Longer movements take longer, but not in proportion (Fitts 1954).
        let first_s = build.pace * (0.66 + 0.45 * distance) * libm::exp(0.10 * chance.normal());
        let bends_to = build.bends_to + bend_noise;
        let aside = bends_to - way * (bends_to.dot(&way) / (distance * distance));
        let height = (build.bend + 0.05 * chance.normal()).max(0.0) * distance;
        let is_corrected = chance.happens(0.35);
        let missed = missed * if is_corrected { 0.04 * distance } else { 0.0 };
        let starts = build.head_starts_s + 0.08 * chance.normal();
        let wanders = chance.happens(build.wanders);
        let wander = (chance.between(0.0, 0.8), 0.35 * chance.normal(), 0.25 * chance.normal());
        let mut wave = || (chance.between(7.0, 11.0), chance.unit() * std::f64::consts::TAU, chance.normal());
        ArmReach {
            build: *build,
            from: *from,
            to: end,
            first_s,
            warp: warp_of((build.peak + 0.07 * wave().2.clamp(-2.0, 2.0)).clamp(0.2, 0.55)),
            bend: aside.try_normalize(1e-9).unwrap_or_else(ArmVector::zeros) * height,
            missed,
            correction_s: (first_s * (0.70 + 0.03 * wave().2), 0.32),
            head_s: (starts, (0.75 * first_s).max(0.3)),
            look: (yaw, pitch),
            looks_from_s: starts - 0.15,
            wanders: wanders.then_some(wander),
            tremor: [wave(), wave(), wave()],
        }
    }

    /// Seconds from the first to the last motion of the hand.
    pub fn duration_s(&self) -> f64 {
        if self.missed.norm() > 0.0 {
            self.first_s.max(self.correction_s.0 + self.correction_s.1)
        } else {
            self.first_s
        }
    }

    /// The person's rest position at the end of the reach.
    pub fn end(&self) -> ArmRest {
        self.to
    }

    /// The person `t_s` seconds after the hand began to move; the hand rests before the start and after the end.
    pub fn at(&self, t_s: f64) -> ArmPose {
        let (from, to) = (&self.from, &self.to);
        let share = warped(t_s / self.first_s, self.warp);
        // The bend is highest a little before the middle of the way.
        let height = 3.2 * share * (1.0 - share) * (1.2 - 0.6 * share);
        let corrected = minimum_jerk((t_s - self.correction_s.0) / self.correction_s.1);
        let (early, late) = (to.finger - self.missed, self.missed * corrected);
        let path = from.finger + (early - from.finger) * share + late + self.bend * height;
        let tremor: [f64; 3] = self.tremor.map(|(hz, phase, size)| {
            size * self.build.tremor_m * libm::sin(std::f64::consts::TAU * hz * t_s + phase)
        });
        let finger = path + ArmVector::from(tremor);
        let shoulder = from.shoulder + (to.shoulder - from.shoulder) * share;
        let points =
            (from.points * (1.0 - share) + to.points * share).try_normalize(1e-6).unwrap_or(to.points);
        let turned = minimum_jerk((t_s - self.head_s.0) / self.head_s.1);
        let head = from.head + (to.head - from.head) * minimum_jerk(t_s / self.first_s);
        let (yaw, pitch) =
            (from.yaw + (to.yaw - from.yaw) * turned, from.pitch + (to.pitch - from.pitch) * turned);
        let wrist = finger - points * self.build.hand_m;
        let (elbow, wrist) = self.elbow(shoulder, wrist);
        let sample = ArmSample {
            at_s: t_s,
            shoulder,
            forearm: elbow + (wrist - elbow) * self.build.seen_at.0,
            hand: wrist + (finger - wrist) * self.build.seen_at.1,
            finger,
            head,
            yaw,
            pitch,
        };
        let pose = ArmPose { sample, elbow, wrist, gaze: self.gaze(t_s, yaw, pitch) };
        if self.build.side == ArmSide::Left { pose.mirrored() } else { pose }
    }

    /// The elbow, and the wrist as far as the arm can reach it.
    fn elbow(&self, shoulder: ArmPoint, wrist: ArmPoint) -> (ArmPoint, ArmPoint) {
        let (a, b) = (self.build.upper_m, self.build.lower_m);
        let way = wrist - shoulder;
        let far = way.norm().clamp((a - b).abs() + 0.02, 0.995 * (a + b));
        let ahead = way.try_normalize(1e-6).unwrap_or_else(ArmVector::x);
        let wrist = shoulder + ahead * far;
        let along = (a * a - b * b + far * far) / (2.0 * far);
        let aside = libm::sqrt((a * a - along * along).max(0.0));
        let (sin, cos) = (libm::sin(self.build.swivel), libm::cos(self.build.swivel));
        let down = ArmVector::new(-0.2, -sin, -cos);
        let down = (down - ahead * down.dot(&ahead)).try_normalize(1e-6).unwrap_or_else(ArmVector::y);
        (shoulder + ahead * along + down * aside, wrist)
    }

    /// Eyes are at the place from shortly before the head turns, except for a glance elsewhere.
    fn gaze(&self, t_s: f64, yaw: f64, pitch: f64) -> (f64, f64) {
        if t_s < self.looks_from_s {
            return (yaw, pitch);
        }
        match self.wanders {
            Some((at_s, yaw, pitch)) if (at_s..at_s + 0.25).contains(&t_s) => {
                (self.look.0 + yaw, self.look.1 + pitch)
            }
            _ => (self.look.0 + 0.2 * self.tremor[0].2 * 0.05, self.look.1 + 0.2 * self.tremor[1].2 * 0.05),
        }
    }
}

impl ArmPose {
    /// The pose, mirrored left to right.
    fn mirrored(&self) -> ArmPose {
        let flip = |p: ArmPoint| ArmPoint::new(p.x, -p.y, p.z);
        ArmPose {
            sample: self.sample.mirrored(),
            elbow: flip(self.elbow),
            wrist: flip(self.wrist),
            gaze: (-self.gaze.0, self.gaze.1),
        }
    }
}
