//! Draws what simulated customers want besides deliveries, how they change their minds, and what operators do by hand.
//!
//! Main type: [`Choices`]. Refuses: to draw anything if a scenario has no such customers, so that its runs stay as they
//! were.

use crate::random::Stream;
use crate::scenario::Habits;
use giveway_fleet::{
    Answer, FloorAction, JobAction, JobKind, JobRequest, Ledger, Made, Reply, Request, StationOrder, Token,
    Visiting,
};
use giveway_floor::id::{Dense, JobId, NodeId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use std::collections::{BTreeMap, VecDeque};

/// The purpose of the stream of random numbers.
const PURPOSE: u64 = 41;
/// At most this many of the newest accepted jobs may be named in `after`.
const REMEMBERED: usize = 32;

/// A request that will later undo an earlier action.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Undo {
    Cancel(JobId),
    Reassign(JobId, Option<RobotId>),
    Release(RobotId),
    Resume(StationId),
}

/// Draws what customers and operators do.
#[derive(Debug)]
pub(super) struct Choices {
    habits: Habits,
    random: Stream,
    /// A second stream for habits that were added later, so that older runs repeat.
    later_random: Stream,
    storage: Vec<NodeId>,
    /// Places where robots may stay.
    places: Vec<NodeId>,
    /// Tokens of jobs that will be cancelled once accepted, with the delay after acceptance.
    doomed: BTreeMap<Token, Span>,
    /// Tokens of jobs that will be given to another robot: which one, if any, and the delay after acceptance.
    moved: BTreeMap<Token, (Option<RobotId>, Span)>,
    accepted: VecDeque<JobId>,
    later: Vec<(Time, Undo)>,
    /// Requests to submit a second time.
    again: Vec<JobRequest>,
    keys: u64,
    /// The last decision on a pick at a station: the robot, the serial number of its visit, and whether goods are
    /// missing.
    picks: BTreeMap<StationId, (RobotId, u64, bool)>,
}

impl Choices {
    pub fn new(habits: Habits, warehouse: &Warehouse, seed: u64) -> Choices {
        Choices {
            habits,
            random: Stream::new(seed, PURPOSE, 0),
            later_random: Stream::new(seed, PURPOSE, 1),
            storage: warehouse.nodes_where(|k| k == NodeKind::Storage),
            places: warehouse.nodes_where(NodeKind::is_lasting),
            doomed: BTreeMap::new(),
            moved: BTreeMap::new(),
            accepted: VecDeque::new(),
            later: Vec::new(),
            again: Vec::new(),
            keys: 0,
            picks: BTreeMap::new(),
        }
    }

    /// Whether customers want anything but plain deliveries.
    fn is_plain(&self) -> bool {
        self.habits == Habits::default()
    }

    /// A job in place of a plain delivery, submitted with this token.
    pub fn request(&mut self, plain: JobKind, token: Token, now: Time, ledger: &Ledger) -> JobRequest {
        let mut request = JobRequest::new(plain);
        if self.is_plain() {
            return request;
        }
        if let Some(again) = self.again.pop() {
            return again;
        }
        let h = self.habits;
        request.kind = self.kind(plain, ledger);
        if self.random.happens(h.priority) {
            request.priority = 1 + self.random.below(9) as u8;
        }
        if self.random.happens(h.deadline) {
            request.deadline = Some(now + Span::from_secs_f64(self.random.between(60.0, 3600.0)));
        }
        if self.random.happens(h.after) && !self.accepted.is_empty() {
            for _ in 0..=self.random.below(2) {
                request.after.push(self.accepted[self.random.below(self.accepted.len())]);
            }
        }
        if self.random.happens(h.cancel) {
            self.doomed.insert(token, Span::from_secs_f64(self.random.exponential(h.cancel_after_s)));
        }
        self.want_more(&mut request, token, ledger);
        if self.random.happens(h.twice) {
            self.keys += 1;
            request.key = Some(format!("order {} of {}", self.keys, now.0).into());
            self.again.push(request.clone());
        }
        request
    }

    /// Adds more stations to a delivery, and draws whether a job goes to another robot.
    fn want_more(&mut self, request: &mut JobRequest, token: Token, ledger: &Ledger) {
        let (h, random) = (self.habits, &mut self.later_random);
        if h.more_stops > 0.0 && random.happens(h.more_stops) {
            let stations = ledger.warehouse().stations.len();
            for _ in 0..=random.below(2) {
                let last = request.stations().last();
                let next = StationId::at(random.below(stations));
                if last.is_some_and(|last| last.station != next) {
                    request.then.push(Visiting { station: next, pick: None });
                }
            }
        }
        if h.reassign > 0.0 && random.happens(h.reassign) {
            let robot = RobotId::at(random.below(ledger.robots.len().max(1)));
            let named = random.happens(0.5).then_some(robot);
            let after = Span::from_secs_f64(random.exponential(h.cancel_after_s));
            self.moved.insert(token, (named, after));
        }
    }

    fn kind(&mut self, plain: JobKind, ledger: &Ledger) -> JobKind {
        let JobKind::Deliver { rack, station, .. } = plain else { return plain };
        let h = self.habits;
        let weights = [h.deliver, h.put_back, h.relocate, h.charge, h.park, h.go];
        let mut left = self.random.unit() * weights.iter().sum::<f64>();
        let drawn = weights.iter().position(|w| {
            left -= w;
            left < 0.0
        });
        let robots = ledger.robots.len().max(1);
        let robot = RobotId::at(self.random.below(robots));
        match drawn {
            Some(1) => JobKind::Return { rack },
            Some(2) => JobKind::Relocate { rack, node: self.storage[self.random.below(self.storage.len())] },
            Some(3) => JobKind::Charge { robot },
            Some(4) => JobKind::Park { robot },
            Some(5) => {
                let node = NodeId::at(self.random.below(ledger.warehouse().nodes.len()));
                let to_place = self.later_random.happens(h.go_to_places);
                let place = to_place.then(|| self.places[self.later_random.below(self.places.len())]);
                JobKind::Go { robot, node: place.unwrap_or(node) }
            }
            _ => {
                let slow = self.random.happens(h.slow_pick);
                let pick = slow.then(|| Span::from_secs_f64(h.slow_pick_s));
                JobKind::Deliver { rack, station, pick }
            }
        }
    }

    /// Takes the fleet's reply.
    pub fn hear(&mut self, reply: &Reply, now: Time) {
        let Reply { token, answer: Ok(Answer::Job(Made { id: job, new: true })) } = *reply else { return };
        if let Some(after) = self.doomed.remove(&token) {
            self.later.push((now + after, Undo::Cancel(job)));
        }
        if let Some((robot, after)) = self.moved.remove(&token) {
            self.later.push((now + after, Undo::Reassign(job, robot)));
        }
        self.accepted.push_back(job);
        if self.accepted.len() > REMEMBERED {
            self.accepted.pop_front();
        }
    }

    /// Other requests due now: cancels, pauses, and their ends. Once `stopped`, customers begin nothing new.
    pub fn meddle(&mut self, now: Time, period: Span, stopped: bool, ledger: &Ledger) -> Vec<Undone> {
        if self.is_plain() {
            return Vec::new();
        }
        let due = |(at, undo): &mut (Time, Undo)| (*at <= now).then_some(*undo);
        let mut said: Vec<Undone> = Vec::new();
        self.later.retain_mut(|entry| match due(entry) {
            Some(undo) => {
                said.push(undo.into());
                false
            }
            None => true,
        });
        if stopped {
            return said;
        }
        let hours = period.as_secs_f64() / 3600.0;
        let until = now + Span::from_secs_f64(self.habits.pause_s);
        let robots = ledger.robots.len();
        if robots > 0 && self.random.happens(self.habits.robot_pauses_per_hour * hours) {
            let robot = RobotId::at(self.random.below(robots));
            said.push(Undone::Halt(robot));
            self.later.push((until, Undo::Release(robot)));
        }
        let stations = ledger.warehouse().stations.len();
        if stations > 0 && self.random.happens(self.habits.station_pauses_per_hour * hours) {
            let station = StationId::at(self.random.below(stations));
            said.push(Undone::Station(station, StationOrder::Pause));
            self.later.push((until, Undo::Resume(station)));
        }
        let trades = self.habits.trades_per_hour * hours;
        if self.later_random.happens(trades) {
            said.extend(self.trade(ledger));
        }
        said
    }

    /// Sends several robots to one another's places; half of the time, all of them.
    fn trade(&mut self, ledger: &Ledger) -> Vec<Undone> {
        let mut robots: Vec<RobotId> = ledger.present().collect();
        self.later_random.shuffle(&mut robots);
        if robots.len() > 2 && self.later_random.happens(0.5) {
            robots.truncate(2 + self.later_random.below(robots.len() - 1));
        }
        let mut goals: Vec<NodeId> = robots.iter().map(|r| ledger.node_of(*r)).collect();
        self.later_random.shuffle(&mut goals);
        robots.into_iter().zip(goals).map(|(robot, goal)| Undone::Go(robot, goal)).collect()
    }

    /// How the pick with this robot at this station ends.
    pub fn pick(&mut self, station: StationId, robot: RobotId, serial: u64) -> StationOrder {
        let known = self.picks.get(&station).filter(|(r, s, _)| (*r, *s) == (robot, serial)).map(|p| p.2);
        let short = known.unwrap_or_else(|| self.random.happens(self.habits.short));
        self.picks.insert(station, (robot, serial, short));
        if short { StationOrder::Short } else { StationOrder::Done }
    }
}

/// A request other than a new job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Undone {
    Cancel(JobId),
    Reassign(JobId, Option<RobotId>),
    Halt(RobotId),
    Release(RobotId),
    Station(StationId, StationOrder),
    Go(RobotId, NodeId),
}

impl From<Undo> for Undone {
    fn from(undo: Undo) -> Undone {
        match undo {
            Undo::Cancel(job) => Undone::Cancel(job),
            Undo::Reassign(job, robot) => Undone::Reassign(job, robot),
            Undo::Release(robot) => Undone::Release(robot),
            Undo::Resume(station) => Undone::Station(station, StationOrder::Resume),
        }
    }
}

impl Undone {
    /// The request to the fleet.
    pub fn request(self) -> Request {
        match self {
            Undone::Cancel(job) => JobAction::Cancel(job).into(),
            Undone::Reassign(job, robot) => JobAction::Reassign(job, robot).into(),
            Undone::Halt(robot) => FloorAction::Halt(Some(robot)).into(),
            Undone::Release(robot) => FloorAction::Release(Some(robot)).into(),
            Undone::Station(station, order) => Request::Station(station, order),
            Undone::Go(robot, node) => JobAction::Submit(JobRequest::new(JobKind::Go { robot, node })).into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::{Fleet, Settings};
    use giveway_floor::id::RackId;
    use giveway_floor::warehouse::lab;
    use std::sync::Arc;

    fn plain(rack: u32) -> JobKind {
        JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick: None }
    }

    fn fleet() -> Fleet {
        Fleet::new(Arc::new(lab()), Settings::default())
    }

    #[test]
    fn plain_customers_want_deliveries_and_nothing_else() {
        let mut choices = Choices::new(Habits::default(), &lab(), 1);
        for i in 0..100 {
            let request = choices.request(plain(i % 4), u64::from(i).into(), Time::ZERO, fleet().ledger());
            assert_eq!(request, JobRequest::new(plain(i % 4)));
        }
        assert!(choices.meddle(Time::ZERO, Span::from_secs(3600), false, fleet().ledger()).is_empty());
    }

    #[test]
    fn customers_with_habits_want_every_kind_and_change_their_minds() {
        let habits = Habits {
            put_back: 1.0,
            relocate: 1.0,
            charge: 1.0,
            park: 1.0,
            go: 1.0,
            priority: 0.5,
            deadline: 0.5,
            after: 0.5,
            twice: 0.5,
            cancel: 0.5,
            ..Habits::default()
        };
        let mut choices = Choices::new(habits, &lab(), 1);
        let fleet = fleet();
        let mut requests = Vec::new();
        for token in 0..400 {
            let request = choices.request(plain(1), token.into(), Time::ZERO, fleet.ledger());
            let answer = Ok(Answer::Job(Made { id: JobId(token), new: true }));
            choices.hear(&Reply { token: token.into(), answer }, Time::ZERO);
            requests.push(request);
        }
        for word in ["deliver", "return", "relocate", "charge", "park", "go"] {
            assert!(requests.iter().any(|r| r.kind.word() == word), "{word}");
        }
        assert!(requests.iter().any(|r| r.priority > 0) && requests.iter().any(|r| r.deadline.is_some()));
        assert!(requests.iter().any(|r| !r.after.is_empty()));
        let twice =
            |r: &JobRequest| r.key.is_some() && requests.iter().filter(|o| o.key == r.key).count() == 2;
        assert!(requests.iter().any(twice));
        let said = choices.meddle(Time::ZERO + Span::from_secs(3600), Span::ZERO, true, fleet.ledger());
        assert!(said.iter().any(|u| matches!(u, Undone::Cancel(_))));
    }
}
