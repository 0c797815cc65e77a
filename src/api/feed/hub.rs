//! The hub of poses from all sources and of guidance for all workers.
//!
//! Main types: [`Feeds`], [`Connection`] (a connection's place), [`HeardSighting`], [`Told`]. A worker has one headset
//! at a time: a new connection takes the place of the old one. It may have another frame, so it begins an epoch; but
//! the worker is the same, and only marks that were touched prove a new position. Reports of tags and of devices that
//! report like robots count beside the headset. Guidance is the newest or none: there is no queue. Refuses: to judge
//! what is right for a worker, and to choose between sources.

use super::intake::Senses;
use super::lights::CellTold;
use super::thin::RateLimiter;
use crate::feed::intake::align::PointPair;
use crate::feed::intake::pose::hand_points;
use crate::wire::error::Problem;
use crate::wire::text::parse_worker_name;
use crate::wire::words::GazeKind;
use giveway_cell::HandPoints;
use giveway_fleet::{CellWarning, FeedCounts, Guidance, View};
use giveway_floor::id::{Dense, IdVec, WorkerId};
use giveway_floor::text::sentence::requests;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Place, Warehouse};
use giveway_people::human::{Presence, Sighting, SourceId};
use nalgebra::Vector3;
use std::sync::{Mutex, MutexGuard};
use tokio::sync::{mpsc, watch};

/// The most poses that wait for the next turn of the loop: from a thousand workers at sixty a second, while one turn
/// takes four times as long as it should.
pub const WAITING: usize = 12_000;

/// Assumed height of a head if the device gives none, metres.
const HEAD_M: f64 = 1.6;

/// A headset's gaze, hands and battery are forgotten after this long with only reports.
const HEADSET_SILENT: Span = Span::from_secs(3);

/// A sighting, with the time at which it was received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardSighting {
    /// The time of receipt.
    pub received: Time,
    /// The sighting.
    pub sighting: Sighting,
    /// The hands, if they were seen.
    pub hands: Option<HeardHands>,
}

/// Head and hands of a person who was seen, in the map's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardHands {
    /// The middle of the head, as well as it is known.
    pub head: Place,
    /// The direction in which the head points, if known.
    pub facing: Option<Vector3<f64>>,
    /// The direction in which the eyes look, if it is measured.
    pub eyes: Option<Vector3<f64>>,
    /// The left and the right hand.
    pub hands: [Option<HandPoints>; 2],
}

/// The middle of a seen person's head, as well as it is known.
pub(crate) fn head_of(sighting: &Sighting, senses: &Senses) -> Place {
    Place::from(senses.gaze.map_or([sighting.at.x, sighting.at.y, HEAD_M], |gaze| gaze.origin))
}

/// The direction in which a seen person's head points. Eyes turn in the head, so only a gaze ray of the head gives it;
/// without one, the pose does, and if that has only a heading, the head is taken to be level.
fn facing_of(sighting: &Sighting, senses: &Senses) -> Option<Vector3<f64>> {
    let ray = senses.gaze.filter(|gaze| gaze.kind == GazeKind::Head).map(|gaze| gaze.dir);
    let level = || sighting.heading.map(|heading| [heading.cos(), heading.sin(), 0.0]);
    ray.or(senses.ahead).or_else(level).map(Vector3::from)
}

/// The direction in which the eyes look; an estimated ray is not measured at the eyes.
fn eyes_of(senses: &Senses) -> Option<Vector3<f64>> {
    senses.gaze.filter(|gaze| gaze.kind == GazeKind::Eye).map(|gaze| gaze.dir.into())
}

impl HeardHands {
    /// The hands in a pose; nothing if the pose has none, or if the fleet will drop it as late or repeated.
    fn of(sighting: &Sighting, senses: &Senses) -> Option<HeardHands> {
        if sighting.seq == 0 {
            return None;
        }
        let hands = [0, 1].map(|i| senses.hands[i].as_ref().and_then(hand_points));
        hands.iter().any(Option::is_some).then(|| HeardHands {
            head: head_of(sighting, senses),
            facing: facing_of(sighting, senses),
            eyes: eyes_of(senses),
            hands,
        })
    }
}

/// What a worker's connection sends to the worker.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Told {
    /// The time of the poses on which the guidance is based.
    pub at: Time,
    /// The guidance; nothing if the fleet has none.
    pub guidance: Option<Guidance>,
    /// What to pick at the worker's station; nothing outside of workplaces.
    pub cell: Option<CellTold>,
    /// Counts of the worker's poses, by what became of them.
    pub counts: FeedCounts,
}

/// A worker's gaze, hands and battery, which the fleet does not use, and the state of the feed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarriedSenses {
    /// Gaze, hands, battery.
    pub senses: Senses,
    /// When the last pose arrived.
    pub received: Option<Time>,
    /// Whether a headset is connected.
    pub connected: bool,
    /// The version of the guidance that the headset showed last.
    pub acknowledged: Option<u64>,
    /// How wrong the times of the headset's poses may be.
    pub clock_error: Option<Span>,
}

/// The place of one connection.
#[derive(Debug)]
pub struct Connection {
    /// The connection's number: a later connection has a larger one.
    pub number: u64,
    /// The number of the connection that has the place now.
    pub taken: watch::Receiver<u64>,
    /// The newest guidance.
    pub told: watch::Receiver<Told>,
}

/// Why a report is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Untaken {
    /// There is no such worker.
    Unknown,
    /// Too many reports wait.
    Full,
}

/// The reports of one source about a worker.
#[derive(Debug, Default)]
struct ReportQueue {
    count: u64,
    /// Thins reports that come too fast; the newest waits.
    limiter: RateLimiter<HeardSighting>,
}

#[derive(Debug)]
struct WorkerSlot {
    name: String,
    /// The connection from which the last pose came, its epoch there, and the time of receipt.
    feed: Option<(u64, u32, Time)>,
    epoch: u32,
    /// The marks with which the worker's headset was last aligned.
    marks: Vec<PointPair>,
    reports: [ReportQueue; SourceId::ALL.len()],
    taken: watch::Sender<u64>,
    told: watch::Sender<Told>,
    carried: CarriedSenses,
}

impl WorkerSlot {
    fn new(name: String) -> WorkerSlot {
        let (taken, told) = (watch::Sender::new(0), watch::Sender::new(Told::default()));
        let (feed, epoch, marks, reports) = (None, 0, Vec::new(), Default::default());
        WorkerSlot { name, feed, epoch, marks, reports, taken, told, carried: CarriedSenses::default() }
    }
}

/// All feeds.
#[derive(Debug)]
pub struct Feeds {
    inbox: mpsc::Sender<HeardSighting>,
    slots: Mutex<IdVec<WorkerId, WorkerSlot>>,
}

impl Feeds {
    /// The worker of this name on the wire.
    ///
    /// # Errors
    /// A problem that says where the known workers are listed.
    pub fn worker(&self, text: &str) -> Result<WorkerId, Problem> {
        let known = parse_worker_name(text).filter(|w| self.name(*w).is_some());
        known
            .ok_or_else(|| Problem::unknown("worker", requests::no_such_thing("worker", text, "/v1/workers")))
    }

    /// Feeds without workers, and the receiver of sightings.
    pub fn new() -> (Feeds, mpsc::Receiver<HeardSighting>) {
        let (inbox, heard) = mpsc::channel(WAITING);
        (Feeds { inbox, slots: Mutex::default() }, heard)
    }

    /// Makes workers known, by number. A new worker of a number inherits nothing from a forgotten one: a connection
    /// that is still open is told that another one has its place.
    pub fn know(&self, names: &IdVec<WorkerId, String>) {
        let mut slots = self.slots();
        for (worker, name) in names.pairs() {
            match slots.get(worker).map(|slot| slot.name == *name) {
                Some(true) => {}
                Some(false) => slots[worker] = WorkerSlot::new(name.clone()),
                None => _ = slots.push(WorkerSlot::new(name.clone())),
            }
        }
    }

    /// The names of all workers, by number; empty for a free number.
    pub fn names(&self) -> Vec<String> {
        self.slots().iter().map(|s| s.name.clone()).collect()
    }

    /// A worker's name.
    pub fn name(&self, worker: WorkerId) -> Option<String> {
        self.slots().get(worker).map(|s| s.name.clone()).filter(|name| !name.is_empty())
    }

    /// The worker with this name.
    pub fn named(&self, name: &str) -> Option<WorkerId> {
        self.slots().pairs().find(|(_, s)| s.name == name).map(|(w, _)| w)
    }

    /// Gives a new connection the worker's place, and notifies the connection that had it.
    pub fn connect(&self, worker: WorkerId) -> Option<Connection> {
        let mut slots = self.slots();
        let slot = slots.get(worker)?;
        let number = *slot.taken.borrow() + 1;
        let slot = &mut slots[worker];
        slot.taken.send_replace(number);
        (slot.carried.connected, slot.carried.acknowledged) = (true, None);
        slot.carried.clock_error = None;
        Some(Connection { number, taken: slot.taken.subscribe(), told: slot.told.subscribe() })
    }

    /// Notes that a connection has ended.
    pub fn disconnect(&self, worker: WorkerId, connection: &Connection) {
        let mut slots = self.slots();
        let slot = &mut slots[worker];
        if *slot.taken.borrow() == connection.number {
            slot.carried.connected = false;
        }
    }

    /// Passes on a pose of a connection. False if there was no room.
    pub fn hand(
        &self,
        connection: &Connection,
        mut sighting: Sighting,
        senses: Senses,
        received: Time,
    ) -> bool {
        let mut slots = self.slots();
        let slot = &mut slots[sighting.worker];
        // A new connection, or a new alignment of its frame, begins an epoch.
        let hands = HeardHands::of(&sighting, &senses);
        let begins = slot.feed.is_none_or(|(n, epoch, _)| (n, epoch) != (connection.number, sighting.epoch));
        slot.epoch += u32::from(begins);
        slot.feed = Some((connection.number, sighting.epoch, received));
        sighting.epoch = slot.epoch;
        slot.carried.received = Some(received);
        if sighting.seq > 0 {
            slot.carried.senses = senses;
        }
        drop(slots);
        self.inbox.try_send(HeardSighting { received, sighting, hands }).is_ok()
    }

    /// Takes a report of a tag or a similar device; its epoch and number do not matter. Reports that come faster than
    /// sixty times a second are thinned, and the newest of each source wins.
    ///
    /// # Errors
    /// Why the report is refused.
    pub fn report(&self, mut sighting: Sighting, received: Time) -> Result<(), Untaken> {
        let mut slots = self.slots();
        if slots.get(sighting.worker).is_none() {
            return Err(Untaken::Unknown);
        }
        let slot = &mut slots[sighting.worker];
        if slot.feed.is_none_or(|(.., at)| received - at >= HEADSET_SILENT) {
            slot.carried.senses = Senses::default();
        }
        slot.carried.received = Some(received);
        let queue = &mut slot.reports[sighting.source as usize];
        queue.count += 1;
        (sighting.epoch, sighting.seq) = (0, queue.count);
        let passes = queue.limiter.offer(HeardSighting { received, sighting, hands: None }, received);
        drop(slots);
        passes.map_or(Ok(()), |heard| self.inbox.try_send(heard).map_err(|_| Untaken::Full))
    }

    /// Passes on waiting reports that are due. Returns how many were left out since the last call.
    pub fn pass(&self, now: Time) -> u64 {
        let mut left_out = 0;
        for queue in self.slots().iter_mut().flat_map(|slot| &mut slot.reports) {
            left_out += std::mem::take(&mut queue.limiter.thinned);
            if let Some(heard) = queue.limiter.ready(now) {
                // If there is no room, the source is told at its next report.
                let _ = self.inbox.try_send(heard);
            }
        }
        left_out
    }

    /// Whether the worker's headset was never aligned with exactly these marks before: then a person has touched them
    /// now. A client that reconnects sends the marks that it remembers, equal to the last digit, and they prove
    /// nothing.
    pub fn are_new_marks(&self, worker: WorkerId, marks: &[PointPair]) -> bool {
        self.slots()[worker].marks != marks
    }

    /// Notes that a worker's headset was aligned with these marks.
    pub fn note_marks(&self, worker: WorkerId, marks: Vec<PointPair>) {
        self.slots()[worker].marks = marks;
    }

    /// Notes that the headset shows the guidance of this version.
    pub fn acknowledge(&self, worker: WorkerId, version: u64) {
        self.slots()[worker].carried.acknowledged = Some(version);
    }

    /// Notes how wrong the times of a worker's poses may be.
    pub fn clock_error(&self, worker: WorkerId, error: Option<Span>) {
        self.slots()[worker].carried.clock_error = error;
    }

    /// A worker's gaze, hands and battery, and the state of the feed.
    pub fn carried(&self, worker: WorkerId) -> Option<CarriedSenses> {
        self.slots().get(worker).map(|s| s.carried.clone())
    }

    /// The gaze, hands and battery of all workers and the state of their feeds, by number.
    pub fn all_carried(&self) -> Vec<CarriedSenses> {
        self.slots().iter().map(|s| s.carried.clone()).collect()
    }

    /// Passes on, at once, the guidance that a step decided with the poses known `at` that time.
    pub fn tell(&self, at: Time, guidance: Vec<(WorkerId, Guidance)>) {
        let slots = self.slots();
        for (worker, guidance) in guidance {
            let Some(slot) = slots.get(worker) else { continue };
            slot.told.send_modify(|told| (told.at, told.guidance) = (at, Some(guidance)));
        }
    }

    /// Warns, at once, the people whose hands are wrong.
    pub fn warn(&self, warnings: &[CellWarning]) {
        if warnings.is_empty() {
            return;
        }
        let slots = self.slots();
        for warning in warnings {
            let Some(slot) = slots.get(WorkerId(warning.person)) else { continue };
            slot.told.send_if_modified(|told| {
                let cell = told.cell.as_mut().filter(|cell| cell.station == warning.station);
                // The first observation of a mistake gives its time; a warning that was already passed on is not
                // repeated.
                let cell = cell.filter(|cell| cell.warning != Some(warning.wrong));
                let warned = (Some(warning.wrong), Some(warning.seen));
                cell.map(|cell| (cell.warning, cell.warned_of) = warned).is_some()
            });
        }
    }

    /// Updates guidance, lines to pick, and counts from the newest view.
    pub fn refresh(&self, view: &View, warehouse: &Warehouse) {
        for (worker, slot) in self.slots().pairs() {
            let seen = view.workers.get(worker.ix());
            let tracked = seen.filter(|w| w.presence == Presence::Tracked).and_then(|w| w.pose);
            let cell = tracked.and_then(|pose| CellTold::at(view, warehouse, pose.at));
            slot.told.send_modify(|told| {
                let warned_of = told.cell.as_ref().and_then(|cell| cell.warned_of);
                let cell = cell.map(|cell| CellTold { warned_of, ..cell });
                *told = Told {
                    // Poses may have arrived while the step was under way.
                    at: told.at.max(view.now),
                    guidance: seen.map(|w| w.guidance.clone()),
                    cell,
                    counts: seen.map(|w| w.feed).unwrap_or_default(),
                };
            });
        }
    }

    fn slots(&self) -> MutexGuard<'_, IdVec<WorkerId, WorkerSlot>> {
        self.slots.lock().expect("nobody panics with this lock")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::intake::pose::Gaze;
    use giveway_floor::geometry::Point;
    use giveway_people::human::Quality;

    const ANNA: WorkerId = WorkerId(0);

    fn sighting(epoch: u32, seq: u64) -> Sighting {
        Sighting {
            mirror: None,
            worker: ANNA,
            source: SourceId::Headset,
            seen: Time(0),
            epoch,
            at_marks: false,
            seq,
            at: Point::origin(),
            heading: None,
            accuracy_m: 0.1,
            quality: Quality::Tracked,
        }
    }

    fn feeds() -> (Feeds, mpsc::Receiver<HeardSighting>) {
        let (feeds, heard) = Feeds::new();
        feeds.know(&IdVec::from(vec!["anna".to_owned()]));
        (feeds, heard)
    }

    fn epochs(heard: &mut mpsc::Receiver<HeardSighting>) -> Vec<u32> {
        std::iter::from_fn(|| heard.try_recv().ok()).map(|h| h.sighting.epoch).collect()
    }

    fn report(worker: WorkerId) -> Sighting {
        Sighting { worker, source: SourceId::Tag, ..sighting(9, 9) }
    }

    #[test]
    fn every_connection_and_alignment_begins_an_epoch_and_reports_end_none() {
        let (feeds, mut heard) = feeds();
        let hand = |connection: &Connection, epoch, ms: i64| {
            assert!(feeds.hand(connection, sighting(epoch, 1), Senses::default(), Time(ms * 1000)));
        };
        let first = feeds.connect(ANNA).unwrap();
        hand(&first, 1, 0);
        hand(&first, 1, 1);
        hand(&first, 2, 2);
        let second = feeds.connect(ANNA).unwrap();
        hand(&second, 1, 3);
        feeds.report(report(ANNA), Time(4_000_000)).unwrap();
        feeds.report(report(ANNA), Time(4_100_000)).unwrap();
        hand(&second, 1, 4200);
        assert_eq!(epochs(&mut heard), [1, 1, 2, 3, 0, 0, 3]);
    }

    #[test]
    fn poses_beyond_those_that_may_wait_are_dropped_until_the_loop_has_taken_some() {
        let (feeds, mut heard) = feeds();
        let connection = feeds.connect(ANNA).unwrap();
        let hand = |i: usize| {
            let at = Time(i as i64 * 20_000);
            feeds.hand(&connection, sighting(1, i as u64), Senses::default(), at)
        };
        assert!((0..WAITING).all(hand));
        assert!(!hand(WAITING), "there is no room");
        heard.try_recv().unwrap();
        assert!(hand(WAITING + 1) && !hand(WAITING + 2));
    }

    #[test]
    fn a_tag_counts_beside_a_headset_and_does_not_hide_what_the_headset_senses() {
        let (feeds, mut heard) = feeds();
        let connection = feeds.connect(ANNA).unwrap();
        let senses = Senses { battery: Some(0.5), ..Senses::default() };
        feeds.hand(&connection, sighting(1, 1), senses, Time(1_000_000));
        assert_eq!(feeds.report(report(ANNA), Time(2_000_000)), Ok(()));
        let sources: Vec<SourceId> =
            std::iter::from_fn(|| heard.try_recv().ok()).map(|h| h.sighting.source).collect();
        assert_eq!(sources, [SourceId::Headset, SourceId::Tag]);
        assert_eq!(feeds.carried(ANNA).unwrap().senses.battery, Some(0.5));
        assert_eq!(feeds.report(report(ANNA), Time(4_000_000)), Ok(()));
        assert_eq!(feeds.carried(ANNA).unwrap().senses.battery, None, "long ago");
        assert_eq!(feeds.report(report(WorkerId(7)), Time(0)), Err(Untaken::Unknown));
    }

    #[test]
    fn hands_come_with_where_the_head_points_by_its_ray_else_by_the_pose_and_with_measured_eyes() {
        let (feeds, mut heard) = feeds();
        let connection = feeds.connect(ANNA).unwrap();
        let hand = Some(vec![[0.3, 0.0, 1.2, 0.01]; 25]);
        let gaze = |kind| Some(Gaze { kind, origin: [0.0, 0.0, 1.7], dir: [1.0, 0.0, 0.0] });
        let ahead = Some([0.0, 0.8, -0.6]);
        let mut heard_of = |gaze: Option<Gaze>, ahead, heading| {
            let senses = Senses { gaze, ahead, hands: [None, hand.clone()], battery: None };
            feeds.hand(&connection, Sighting { heading, ..sighting(1, 1) }, senses, Time(0));
            heard.try_recv().unwrap().hands.expect("one hand is seen")
        };
        let mut eyes = |kind| heard_of(gaze(kind), ahead, None).eyes.map(<[f64; 3]>::from);
        assert_eq!(eyes(GazeKind::Eye), Some([1.0, 0.0, 0.0]));
        assert_eq!([eyes(GazeKind::Head), eyes(GazeKind::Estimated)], [None; 2], "never passed off as eyes");
        let mut facing =
            |gaze: Option<Gaze>, ahead, heading| heard_of(gaze, ahead, heading).facing.map(<[f64; 3]>::from);
        let turned = Some(std::f64::consts::PI);
        assert_eq!(facing(gaze(GazeKind::Head), ahead, turned), Some([1.0, 0.0, 0.0]), "its ray");
        assert_eq!(facing(gaze(GazeKind::Eye), ahead, turned), ahead, "eyes turn in the head");
        assert_eq!(facing(None, ahead, turned), ahead, "the pose, with its pitch");
        let level = facing(None, None, turned).expect("the heading alone");
        assert!((level[0] + 1.0).abs() < 1e-9 && level[1].abs() < 1e-9 && level[2] == 0.0, "{level:?}");
        assert_eq!(facing(None, None, None), None);
    }

    #[test]
    fn a_pose_that_the_fleet_drops_as_late_brings_no_hands_and_hides_none() {
        let (feeds, mut heard) = feeds();
        let connection = feeds.connect(ANNA).unwrap();
        let senses =
            |x: f64| Senses { hands: [None, Some(vec![[x, 0.0, 1.2, 0.01]; 25])], ..Senses::default() };
        for (seq, x, comes) in [(1, 0.3, true), (0, 0.4, false)] {
            feeds.hand(&connection, sighting(1, seq), senses(x), Time(0));
            assert_eq!(heard.try_recv().unwrap().hands.is_some(), comes, "{seq}");
            assert_eq!(feeds.carried(ANNA).unwrap().senses, senses(0.3), "{seq}");
        }
    }

    #[test]
    fn marks_that_a_client_remembers_are_no_new_marks() {
        let (feeds, _heard) = feeds();
        let mark = |x: f64| PointPair {
            device: giveway_floor::geometry::Vector::new(x, 0.0),
            map: Point::origin(),
            weight: 1.0,
            turn: Some(0.0),
            height_m: 0.0,
            heading: Some(0.0),
        };
        assert!(feeds.are_new_marks(ANNA, &[mark(1.0)]), "the first ones");
        feeds.note_marks(ANNA, vec![mark(1.0)]);
        assert!(!feeds.are_new_marks(ANNA, &[mark(1.0)]), "sent again by another connection");
        assert!(feeds.are_new_marks(ANNA, &[mark(1.01)]), "touched again");
    }

    #[test]
    fn reports_that_come_too_fast_are_thinned_for_each_worker_and_the_newest_passes() {
        let (feeds, mut heard) = Feeds::new();
        feeds.know(&IdVec::from(vec!["anna".to_owned(), "ben".to_owned()]));
        let mut left_out = 0;
        for ms in 0..1000 {
            feeds.report(report(ANNA), Time(ms * 1000)).unwrap();
            left_out += feeds.pass(Time(ms * 1000));
        }
        feeds.report(report(WorkerId(1)), Time(999_000)).unwrap();
        left_out += feeds.pass(Time(1_100_000));
        let all: Vec<HeardSighting> = std::iter::from_fn(|| heard.try_recv().ok()).collect();
        let of =
            |w: u32| all.iter().filter(|h| h.sighting.worker == WorkerId(w)).collect::<Vec<&HeardSighting>>();
        let (annas, bens) = (of(0), of(1));
        assert_eq!(bens.len(), 1, "another worker's report passes at once");
        assert!((60..=72).contains(&annas.len()), "{}", annas.len());
        assert_eq!(annas.last().unwrap().sighting.seq, 1000, "the newest");
        assert_eq!(left_out + annas.len() as u64, 1000);
    }

    #[test]
    fn a_new_connection_takes_the_place_and_the_old_one_does_not_take_it_away() {
        let (feeds, _heard) = feeds();
        let first = feeds.connect(ANNA).unwrap();
        let second = feeds.connect(ANNA).unwrap();
        assert_eq!((*first.taken.borrow(), first.number, second.number), (2, 1, 2));
        feeds.disconnect(ANNA, &first);
        assert!(feeds.carried(ANNA).unwrap().connected);
        feeds.disconnect(ANNA, &second);
        assert!(!feeds.carried(ANNA).unwrap().connected);
    }
}
