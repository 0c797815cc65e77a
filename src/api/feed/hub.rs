//! Where poses of all sources and guidance for all workers meet.
//!
//! Main types: [`Feeds`], [`Connection`] (its place), [`HeardSighting`], [`Told`]. A worker has one headset at a time:
//! a new connection takes the place of an old one. It may have another frame, so it begins an epoch; but it is the same
//! worker, and only marks that were touched prove a new place. Reports of tags and of devices that report like robots
//! count beside the headset. Guidance is the newest or none: there is no queue. Refuses: to know what is right for a
//! worker, and to choose between sources.

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

/// So many poses may wait for the next turn of the loop: a thousand workers at sixty a second, for a turn that
/// takes four times as long as it should.
pub const WAITING: usize = 12_000;

/// How high a head is of which nothing is said, metres.
const HEAD_M: f64 = 1.6;

/// What a headset said of gaze, hands and battery is forgotten when only reports have come for so long.
const HEADSET_SILENT: Span = Span::from_secs(3);

/// A sighting, with the time at which it was received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardSighting {
    /// When.
    pub received: Time,
    /// What.
    pub sighting: Sighting,
    /// The hands, where they were seen.
    pub hands: Option<HeardHands>,
}

/// Head and hands of who was seen, in the map's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardHands {
    /// The middle of the head, as well as it is known.
    pub head: Place,
    /// Where it points, where that is known.
    pub facing: Option<Vector3<f64>>,
    /// Where the eyes look, where they are measured.
    pub eyes: Option<Vector3<f64>>,
    /// Left and right.
    pub hands: [Option<HandPoints>; 2],
}

/// The middle of the head of who is seen, as well as it is known.
pub(crate) fn head_of(sighting: &Sighting, senses: &Senses) -> Place {
    Place::from(senses.gaze.map_or([sighting.at.x, sighting.at.y, HEAD_M], |gaze| gaze.origin))
}

/// Where the head of who is seen points. Eyes turn in a head: only a ray of the head says that; without one the pose
/// does, and where that has a heading alone, the head is level.
fn facing_of(sighting: &Sighting, senses: &Senses) -> Option<Vector3<f64>> {
    let ray = senses.gaze.filter(|gaze| gaze.kind == GazeKind::Head).map(|gaze| gaze.dir);
    let level = || sighting.heading.map(|heading| [heading.cos(), heading.sin(), 0.0]);
    ray.or(senses.ahead).or_else(level).map(Vector3::from)
}

/// Where the eyes look: an estimated ray is none of theirs.
fn eyes_of(senses: &Senses) -> Option<Vector3<f64>> {
    senses.gaze.filter(|gaze| gaze.kind == GazeKind::Eye).map(|gaze| gaze.dir.into())
}

impl HeardHands {
    /// What a pose says of hands; nothing where it says nothing, or where the fleet drops it as late or repeated.
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

/// What a worker is to be told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Told {
    /// When the poses were taken that it was decided with.
    pub at: Time,
    /// Nothing where the fleet has nothing to say.
    pub guidance: Option<Guidance>,
    /// What is to be picked where the worker stands; nothing outside of workplaces.
    pub cell: Option<CellTold>,
    /// What became of the worker's poses.
    pub counts: FeedCounts,
}

/// What is carried through of a worker, and how the feed is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarriedSenses {
    /// Gaze, hands, battery.
    pub senses: Senses,
    /// When a pose came last.
    pub received: Option<Time>,
    /// Whether a headset is connected.
    pub connected: bool,
    /// The version of the guidance that the headset showed last.
    pub acknowledged: Option<u64>,
    /// How wrong the time of its poses may be.
    pub clock_error: Option<Span>,
}

/// One connection's place.
#[derive(Debug)]
pub struct Connection {
    /// Its number: a later connection has a larger one.
    pub number: u64,
    /// The number of the connection that has the place now.
    pub taken: watch::Receiver<u64>,
    /// The newest guidance.
    pub told: watch::Receiver<Told>,
}

/// Why a report is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Untaken {
    /// There is no such worker.
    Unknown,
    /// Too much is waiting.
    Full,
}

/// Reports of one source of a worker.
#[derive(Debug, Default)]
struct ReportQueue {
    count: u64,
    /// Reports that come too fast; the newest waits.
    limiter: RateLimiter<HeardSighting>,
}

#[derive(Debug)]
struct WorkerSlot {
    name: String,
    /// The connection that the last pose came from, in which of its epochs, and when.
    feed: Option<(u64, u32, Time)>,
    epoch: u32,
    /// The marks that a headset was aligned with last.
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
    /// A worker who is known, by the name on the wire.
    ///
    /// # Errors
    /// A problem that says where the known ones are listed.
    pub fn worker(&self, text: &str) -> Result<WorkerId, Problem> {
        let known = parse_worker_name(text).filter(|w| self.name(*w).is_some());
        known
            .ok_or_else(|| Problem::unknown("worker", requests::no_such_thing("worker", text, "/v1/workers")))
    }

    /// Feeds without workers, and the end from which sightings are taken.
    pub fn new() -> (Feeds, mpsc::Receiver<HeardSighting>) {
        let (inbox, heard) = mpsc::channel(WAITING);
        (Feeds { inbox, slots: Mutex::default() }, heard)
    }

    /// Makes workers known, by number. Nothing of one who is forgotten stays for the next one of this number: a
    /// connection that is still there is told that another one has its place.
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

    /// All workers' names, by number; empty where a place is free.
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

    /// Gives a new connection the worker's place; the connection that had it is told.
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

    /// The connection is gone.
    pub fn disconnect(&self, worker: WorkerId, connection: &Connection) {
        let mut slots = self.slots();
        let slot = &mut slots[worker];
        if *slot.taken.borrow() == connection.number {
            slot.carried.connected = false;
        }
    }

    /// Hands a pose of a connection on. Whether there was room.
    pub fn hand(
        &self,
        connection: &Connection,
        mut sighting: Sighting,
        senses: Senses,
        received: Time,
    ) -> bool {
        let mut slots = self.slots();
        let slot = &mut slots[sighting.worker];
        // Another connection, or another alignment of its frame, begins an epoch.
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

    /// Takes a report of a tag or the like, whose epoch and number are of no importance. What comes faster than sixty
    /// times a second is thinned, the newest of each source wins.
    ///
    /// # Errors
    /// Why it is not taken.
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

    /// Hands on reports that had to wait and may pass now. How many were left out since the last call.
    pub fn pass(&self, now: Time) -> u64 {
        let mut left_out = 0;
        for queue in self.slots().iter_mut().flat_map(|slot| &mut slot.reports) {
            left_out += std::mem::take(&mut queue.limiter.thinned);
            if let Some(heard) = queue.limiter.ready(now) {
                // If there is no room, the source is told so at its next report.
                let _ = self.inbox.try_send(heard);
            }
        }
        left_out
    }

    /// Whether a worker's headset was not aligned with exactly these marks before: then somebody touched them now. A
    /// client that connects again sends the marks that it remembers, to the last digit, and they prove nothing.
    pub fn are_new_marks(&self, worker: WorkerId, marks: &[PointPair]) -> bool {
        self.slots()[worker].marks != marks
    }

    /// A worker's headset was aligned with these marks.
    pub fn note_marks(&self, worker: WorkerId, marks: Vec<PointPair>) {
        self.slots()[worker].marks = marks;
    }

    /// The headset shows the guidance of this version.
    pub fn acknowledge(&self, worker: WorkerId, version: u64) {
        self.slots()[worker].carried.acknowledged = Some(version);
    }

    /// Notes how wrong the time of a worker's poses may be.
    pub fn clock_error(&self, worker: WorkerId, error: Option<Span>) {
        self.slots()[worker].carried.clock_error = error;
    }

    /// What is carried through of a worker.
    pub fn carried(&self, worker: WorkerId) -> Option<CarriedSenses> {
        self.slots().get(worker).map(|s| s.carried.clone())
    }

    /// What is carried through of all workers, by number.
    pub fn all_carried(&self) -> Vec<CarriedSenses> {
        self.slots().iter().map(|s| s.carried.clone()).collect()
    }

    /// What a step decided with the poses that were there `at`, at once.
    pub fn tell(&self, at: Time, guidance: Vec<(WorkerId, Guidance)>) {
        let slots = self.slots();
        for (worker, guidance) in guidance {
            let Some(slot) = slots.get(worker) else { continue };
            slot.told.send_modify(|told| (told.at, told.guidance) = (at, Some(guidance)));
        }
    }

    /// Warns those whose hands are wrong, at once.
    pub fn warn(&self, warnings: &[CellWarning]) {
        if warnings.is_empty() {
            return;
        }
        let slots = self.slots();
        for warning in warnings {
            let Some(slot) = slots.get(WorkerId(warning.person)) else { continue };
            slot.told.send_if_modified(|told| {
                let cell = told.cell.as_mut().filter(|cell| cell.station == warning.station);
                // The first observation says since when it is known; what is told already is told once.
                let cell = cell.filter(|cell| cell.warning != Some(warning.wrong));
                let warned = (Some(warning.wrong), Some(warning.seen));
                cell.map(|cell| (cell.warning, cell.warned_of) = warned).is_some()
            });
        }
    }

    /// Takes guidance, what is to be picked, and counts from the newest view.
    pub fn refresh(&self, view: &View, warehouse: &Warehouse) {
        for (worker, slot) in self.slots().pairs() {
            let seen = view.workers.get(worker.ix());
            let tracked = seen.filter(|w| w.presence == Presence::Tracked).and_then(|w| w.pose);
            let cell = tracked.and_then(|pose| CellTold::at(view, warehouse, pose.at));
            slot.told.send_modify(|told| {
                let warned_of = told.cell.as_ref().and_then(|cell| cell.warned_of);
                let cell = cell.map(|cell| CellTold { warned_of, ..cell });
                *told = Told {
                    // Poses may have come in while the step was under way.
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
