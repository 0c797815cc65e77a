//! From a message to a sighting: converts frame and time, and checks numbers.
//!
//! Main types: [`PoseIntake`] (the state of a connection), [`TakenPose`], [`PoseFault`]; [`align`] finds the frame,
//! [`clock`] the time, [`course`] whether axes are right, [`pose`], [`joints`] and [`swap`] heads and hands. Pure. A
//! pose that gives no position and time stops here, with a reason; all others go on, even late and repeated ones: the
//! core judges and counts these. Refuses: to decide whether a person can be where a pose says.

pub mod align;
pub mod clock;
pub mod course;
pub mod joints;
pub mod pose;
pub mod swap;

#[cfg(test)]
mod conventions;
#[cfg(test)]
mod tests;

use super::wire::{AnchorSaid, HandSaid, PoseFrame, PoseSaid, QualitySaid};
use crate::feed::intake::align::{Alignment, Misfit, PointPair};
use crate::feed::intake::clock::ClockSync;
use crate::feed::intake::course::Course;
use crate::feed::intake::pose::{Gaze, Hand, facing, plan, rotation};
use giveway_floor::geometry::{FARTHEST_M, Point, Vector};
use giveway_floor::id::WorkerId;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::feed;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_people::human::{Quality, Sighting, SourceId};

/// How far ahead a pose may be, beyond the clock's error: headsets predict poses for the moment at which they show
/// them.
const AHEAD: Span = Span::from_millis(100);

/// Poses older than this are useless.
const OLDEST: Span = Span::from_secs(10);

/// Walking speed if nothing better is known, metres per second (ISO 13855: 1.6).
const WALKING_MPS: f64 = 1.6;

/// Movements shorter than this are sway, not walking; metres.
const STRIDE_M: f64 = 0.25;

/// After this many poses in a row with a later time but a smaller number than an earlier pose, counting continues from
/// there.
const RECOUNT: u32 = 5;

/// If the two clocks advanced by amounts that differ this much between two poses, they are compared at once,
/// milliseconds. Poses that were delayed on their way look the same; then the comparison costs only a ping.
const JUMP_MS: f64 = 500.0;

/// Possible height of the eyes above the floor of the marks, from a person lying down to a person on a ladder; metres.
const EYES_M: std::ops::RangeInclusive<f64> = -0.5..=4.0;

/// The most joints of a hand.
const MOST_JOINTS: usize = 32;

/// The state of a connection.
#[derive(Clone, Debug)]
pub struct PoseIntake {
    worker: WorkerId,
    frame: PoseFrame,
    /// The device's clock.
    pub clock: ClockSync,
    alignment: Option<Alignment>,
    epoch: u32,
    /// Whether this epoch began with marks that were touched for it.
    at_marks: bool,
    last_seq: Option<u64>,
    /// How many poses in a row had a smaller number than the last one, but a later time.
    recounted: u32,
    /// How many poses of this epoch had a new number.
    counted: u64,
    /// The device time of the last pose, milliseconds, and when the pose arrived.
    heard: Option<(f64, Time)>,
    /// The latest device time, milliseconds, and the server's time for it.
    latest: Option<(f64, Time)>,
    /// The device's last position, and the direction that the head faced, in the device's frame.
    stood: Option<Vector>,
    faced: Option<f64>,
    /// Where the last stride ended, in the device's frame.
    strode: Option<Vector>,
    walked_m: f64,
    /// Whether the wearer faces in the direction of walking.
    course: Course,
}

/// A pose that was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct TakenPose {
    /// The sighting for the core.
    pub sighting: Sighting,
    /// Gaze, hands and battery, which the core does not use.
    pub senses: Senses,
    /// A fault of which the client should still know.
    pub fault: Option<PoseFault>,
    /// Whether the wearer has for metres walked in another direction than the device says the wearer faces: then the
    /// device's axes are in doubt, and its directions are left out.
    pub is_askew: bool,
}

/// What no decision depends on; it is passed on to clients that ask for it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Senses {
    /// Where the wearer looks.
    pub gaze: Option<Gaze>,
    /// The direction of the head by its own rotation: map x, map y, height; a unit vector.
    pub ahead: Option<[f64; 3]>,
    /// Joints of the left and the right hand.
    pub hands: [Option<Hand>; 2],
    /// Charge of the device, 0 to 1.
    pub battery: Option<f64>,
}

/// The fault of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PoseFault {
    /// The clock offset of the device is not known yet.
    NoClock,
    /// The frame of the device is not aligned yet.
    NotAligned,
    /// The pose belongs to an earlier alignment.
    OldEpoch,
    /// The pose belongs to an alignment that never existed.
    UnknownEpoch,
    /// The pose has no position.
    NoPosition,
    /// The pose has impossible numbers.
    Absurd,
    /// The eyes are below the floor of the marks, or high above it.
    Height,
    /// The wearer walks in another direction than the device says the wearer faces.
    Askew,
    /// The quaternion is no rotation.
    Quaternion,
    /// The pose was seen in the future.
    Future,
    /// The pose was seen long ago.
    TooOld,
    /// The pose's number has come already.
    Repeated,
    /// A later number has come already.
    Reordered,
}

impl PoseFault {
    /// The word for the fault on the wire.
    pub fn word(self) -> &'static str {
        match self {
            PoseFault::NoClock => "no-clock",
            PoseFault::NotAligned => "not-aligned",
            PoseFault::OldEpoch => "old-epoch",
            PoseFault::UnknownEpoch => "unknown-epoch",
            PoseFault::NoPosition => "no-position",
            PoseFault::Absurd => "absurd",
            PoseFault::Height => "height",
            PoseFault::Askew => "askew",
            PoseFault::Quaternion => "quaternion",
            PoseFault::Future => "future",
            PoseFault::TooOld => "too-old",
            PoseFault::Repeated => "repeated",
            PoseFault::Reordered => "reordered",
        }
    }

    /// The fault in words, and what to do.
    pub fn sentence(self) -> Sentence {
        match self {
            PoseFault::NoClock => feed::pose_without_clock(),
            PoseFault::NotAligned => feed::pose_not_aligned(),
            PoseFault::OldEpoch => feed::pose_of_old_epoch(),
            PoseFault::UnknownEpoch => feed::pose_of_unknown_epoch(),
            PoseFault::NoPosition => feed::pose_without_position(),
            PoseFault::Absurd => feed::pose_absurd(),
            PoseFault::Height => feed::pose_at_height(),
            PoseFault::Askew => feed::pose_askew(),
            PoseFault::Quaternion => feed::pose_not_turned(),
            PoseFault::Future => feed::pose_in_future(),
            PoseFault::TooOld => feed::pose_too_old(),
            PoseFault::Repeated => feed::pose_repeated(),
            PoseFault::Reordered => feed::pose_reordered(),
        }
    }
}

impl PoseIntake {
    /// The state of a new connection; poses in the map's frame need no alignment.
    pub fn new(worker: WorkerId, frame: PoseFrame) -> PoseIntake {
        PoseIntake {
            worker,
            frame,
            clock: ClockSync::default(),
            alignment: (frame == PoseFrame::Map).then(Alignment::identity),
            epoch: 1,
            at_marks: false,
            last_seq: None,
            recounted: 0,
            counted: 0,
            heard: None,
            latest: None,
            stood: None,
            faced: None,
            strode: None,
            walked_m: 0.0,
            course: Course::default(),
        }
    }

    /// The epoch of poses from now on.
    pub fn epoch(&self) -> u32 {
        self.epoch
    }

    /// The alignment in use.
    pub fn alignment(&self) -> Option<&Alignment> {
        self.alignment.as_ref()
    }

    /// Aligns the device's frame anew; poses of the old epoch no longer count. If the marks do not fit, the old
    /// alignment stays. `touched` is whether the wearer touched these marks now, which proves the new position; marks
    /// that a client remembers prove nothing.
    ///
    /// # Errors
    /// Why the marks do not fit.
    pub fn align(&mut self, pairs: &[PointPair], touched: bool) -> Result<&Alignment, Misfit> {
        let alignment = Alignment::fit(pairs)?;
        self.begin_epoch();
        self.at_marks = touched;
        Ok(self.alignment.insert(alignment))
    }

    /// Notes that the device's origin jumped.
    pub fn reset(&mut self) {
        self.alignment = (self.frame == PoseFrame::Map).then(Alignment::identity);
        self.begin_epoch();
    }

    fn begin_epoch(&mut self) {
        self.epoch += 1;
        (self.last_seq, self.stood, self.faced) = (None, None, None);
        (self.recounted, self.counted) = (0, 0);
        (self.strode, self.walked_m, self.at_marks) = (None, 0.0, false);
        self.course = Course::default();
        self.clock.resync();
    }

    /// Reads a pose.
    ///
    /// # Errors
    /// Why the pose cannot be understood. It is then not passed on.
    pub fn take(&mut self, said: &PoseSaid, now: Time) -> Result<TakenPose, PoseFault> {
        match said.epoch.cmp(&self.epoch) {
            std::cmp::Ordering::Less => return Err(PoseFault::OldEpoch),
            std::cmp::Ordering::Greater => return Err(PoseFault::UnknownEpoch),
            std::cmp::Ordering::Equal => {}
        }
        let accuracy_m = said.accuracy.unwrap_or(usual_accuracy_m(said.quality));
        if !(0.0..=100.0).contains(&accuracy_m) || !said.t.is_finite() {
            return Err(PoseFault::Absurd);
        }
        self.compare_clocks(said.t, now);
        let (device, faced) = self.place(said)?;
        let alignment = self.alignment.as_ref().ok_or(PoseFault::NotAligned)?;
        let eyes_m =
            said.pos.filter(|_| said.quality != QualitySaid::Lost).map(|[_, y, _]| y - alignment.floor_m);
        if eyes_m.is_some_and(|y| !EYES_M.contains(&y)) {
            return Err(PoseFault::Height);
        }
        let (at, heading) = (alignment.point(device), faced.map(|phi| alignment.heading(phi)));
        let seen = self.clock.when(said.t, now).ok_or(PoseFault::NoClock)?;
        let error = self.clock.error(now).unwrap_or(Span::ZERO);
        if seen > now + AHEAD + error {
            return Err(PoseFault::Future);
        }
        if now - seen > OLDEST {
            return Err(PoseFault::TooOld);
        }
        let sigma_m = alignment.sigma_m(at, self.walked_m);
        let late_m = WALKING_MPS * error.as_secs_f64();
        let accuracy_m = (accuracy_m.powi(2) + sigma_m.powi(2) + late_m.powi(2)).sqrt();
        let mut senses = senses(alignment, said);
        let mirror = alignment.mirrored(at);
        let later = self.latest.is_none_or(|(before, _)| said.t > before);
        let seen = self.in_order(said.t, seen);
        let fault = self.count(said.seq, later);
        if fault.is_none() && said.quality == QualitySaid::Tracked {
            self.stride(device, faced);
        }
        let is_askew = self.course.is_askew();
        if is_askew {
            (senses.gaze, senses.ahead) = (None, None);
        }
        let heading = heading.filter(|_| !is_askew);
        (self.stood, self.faced) = (Some(device), faced);
        let quality = quality(said.quality);
        // The fleet drops poses without a number of their own.
        let seq = if fault.is_none() { self.counted } else { 0 };
        let (worker, epoch) = (self.worker, self.epoch);
        let (source, at_marks) = (SourceId::Headset, self.at_marks);
        let sighting =
            Sighting { worker, source, seen, epoch, at_marks, seq, at, mirror, heading, accuracy_m, quality };
        Ok(TakenPose { sighting, senses, fault, is_askew })
    }

    /// Keeps poses that are later on the device's clock later, even if its offset is corrected in between: otherwise
    /// the first poses after a correction would count as late.
    fn in_order(&mut self, device_ms: f64, seen: Time) -> Time {
        let seen = match self.latest {
            Some((before, at)) if device_ms > before => seen.max(at + Span(1)),
            _ => seen,
        };
        if self.latest.is_none_or(|(_, at)| seen > at) {
            self.latest = Some((device_ms, seen));
        }
        seen
    }

    /// The position of a pose in the device's floor plan, and the direction that the head faces.
    fn place(&self, said: &PoseSaid) -> Result<(Vector, Option<f64>), PoseFault> {
        let (device, given) = match (said.pos, said.at, self.frame) {
            (Some(pos), _, _) => (plan(pos), None),
            (None, Some([x, y]), PoseFrame::Map) => (Vector::new(x, y), said.heading),
            // A device that has lost its pose says so, and need not invent a position.
            _ if said.quality == QualitySaid::Lost => (self.stood.ok_or(PoseFault::NoPosition)?, self.faced),
            _ => return Err(PoseFault::NoPosition),
        };
        if !(device.x.abs() <= FARTHEST_M
            && device.y.abs() <= FARTHEST_M
            && given.unwrap_or(0.0).abs() <= 1e3)
        {
            return Err(PoseFault::Absurd);
        }
        let faced = match said.quat {
            None => given,
            // A person who looks straight up or down faces as before.
            Some(quat) => facing(rotation(quat).ok_or(PoseFault::Quaternion)?).or(self.faced),
        };
        Ok((device, faced))
    }

    /// Checks that the number of a pose is new. A number that was far too large does not silence the feed: if several
    /// poses in a row are later and have smaller numbers, the device's counting continues from there.
    fn count(&mut self, seq: u64, later: bool) -> Option<PoseFault> {
        let fault = match self.last_seq {
            Some(last) if seq == last => Some(PoseFault::Repeated),
            Some(last) if seq < last => Some(PoseFault::Reordered),
            _ => None,
        };
        let recounts = fault == Some(PoseFault::Reordered) && later;
        self.recounted = if recounts { self.recounted + 1 } else { 0 };
        if fault.is_some() && self.recounted < RECOUNT {
            return fault;
        }
        (self.last_seq, self.recounted) = (Some(seq), 0);
        self.counted += 1;
        None
    }

    /// Measures the device's clock anew if it and the server's advanced differently since the previous pose: it may
    /// have jumped.
    fn compare_clocks(&mut self, device_ms: f64, now: Time) {
        let Some((before_ms, before)) = self.heard.replace((device_ms, now)) else { return };
        if (device_ms - before_ms - 1000.0 * (now - before).as_secs_f64()).abs() > JUMP_MS {
            self.clock.doubt(now);
        }
    }

    fn stride(&mut self, device: Vector, faced: Option<f64>) {
        let Some(from) = self.strode else { return self.strode = Some(device) };
        let way = device - from;
        if way.norm() >= STRIDE_M {
            self.walked_m += way.norm();
            self.course.stride(way, faced);
            self.strode = Some(device);
        }
    }
}

/// Pairs from marks; looks up nodes of the map by name.
///
/// # Errors
/// What is wrong, in words.
pub fn pairs(said: &[AnchorSaid], map: &Warehouse) -> Result<Vec<PointPair>, Sentence> {
    let pair = |(i, a): (usize, &AnchorSaid)| {
        let named = |name: &String| {
            let mark = map.mark_named(name);
            mark.ok_or_else(|| feed::no_mark_named(i, name))
        };
        let at = match (a.map, &a.mark) {
            (Some([x, y]), None) => Point::new(x, y),
            (None, Some(name)) => named(name)?,
            _ => return Err(feed::map_or_mark(i)),
        };
        let no_rotation = || feed::pair_is_wrong(i, PoseFault::Quaternion.sentence());
        let turned = a.quat.map(|q| rotation(q).ok_or_else(no_rotation)).transpose()?;
        let turn = turned.and_then(facing).zip(a.heading).map(|(phi, heading)| heading - phi);
        let (heading, weight) = (turn.and(a.heading), a.weight.unwrap_or(1.0));
        Ok(PointPair { device: plan(a.device), height_m: a.device[1], map: at, weight, turn, heading })
    };
    said.iter().enumerate().map(pair).collect()
}

fn usual_accuracy_m(quality: QualitySaid) -> f64 {
    match quality {
        QualitySaid::Tracked => 0.05,
        QualitySaid::Emulated => 0.5,
        QualitySaid::Lost => 2.0,
    }
}

fn quality(said: QualitySaid) -> Quality {
    match said {
        QualitySaid::Tracked => Quality::Tracked,
        QualitySaid::Emulated => Quality::Emulated,
        QualitySaid::Lost => Quality::Lost,
    }
}

/// The senses in the map's axes. Impossible parts are left out.
fn senses(alignment: &Alignment, said: &PoseSaid) -> Senses {
    let near = |p: &[f64; 3]| p.iter().all(|x| x.abs() <= FARTHEST_M);
    let gaze = said.gaze.filter(|g| near(&g.origin)).and_then(|g| {
        let dir = pose::direction(alignment, g.dir)?;
        Some(Gaze { kind: g.kind, origin: pose::place(alignment, g.origin), dir })
    });
    let ahead = said.quat.and_then(rotation).and_then(|q| pose::direction(alignment, pose::ahead(q).into()));
    let joint = |&[x, y, z, radius]: &[f64; 4]| {
        let sound = near(&[x, y, z]) && (0.0..1.0).contains(&radius);
        let [x, y, z] = pose::place(alignment, [x, y, z]);
        sound.then_some([x, y, z, radius])
    };
    let hand = |said: &HandSaid| -> Option<Hand> {
        said.joints().filter(|joints| joints.len() <= MOST_JOINTS)?.iter().map(joint).collect()
    };
    let hands = said
        .hands
        .as_ref()
        .map_or([None, None], |h| [h.l.as_ref().and_then(hand), h.r.as_ref().and_then(hand)]);
    let battery = said.battery.filter(|b| (0.0..=1.0).contains(b));
    Senses { gaze, ahead, hands, battery }
}
