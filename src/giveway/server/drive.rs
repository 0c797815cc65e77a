//! The loop: one thread owns the fleet and the floor, and turns twenty times a second.
//!
//! Main type: [`DriveLoop`]. Missed ticks are skipped, not caught up. A pose that calls for a stop does not wait for
//! the next tick: the loop turns at once, and rests after that for as long as it took. Stops, and what workers are
//! told, leave in the turn that decided them; warnings of hands leave before it. Orders and answers leave when the
//! journal has the facts behind them; where it has none of them for so long that no more may wait, every robot is told
//! to stand and the floor goes on. Refuses: locks, waiting for the database, and decisions of its own.

use super::ahead::LastForecasts;
use super::clock::Clock;
use super::historian::HistorianSender;
use super::inbox::Inbox;
use super::journal::Journal;
use super::measure::Measure;
use super::outbox::Outbox;
use super::recordings::Tap;
use super::rescue::{Rescue, drivers};
use super::settle::Settling;
use super::watchdog::Watchdog;
use giveway_api::alarms::Alarms;
use giveway_api::feed::hub::{Feeds, HeardSighting};
use giveway_api::metrics::Metrics;
use giveway_api::port::{Moment, QUESTIONS_AT_ONCE, Question};
use giveway_fleet::alarm::AlarmKind;
use giveway_fleet::{CellWarning, Command, Fleet, Guidance, Input, SILENCE};
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::{Span, Time};
use giveway_sim::World;
use giveway_store::Store;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval, sleep};

/// How often the view is published; a little less than a tenth of a second, so that a tick does not just miss it.
const PUBLISH: Span = Span::from_millis(95);

/// Everything that the loop owns.
pub struct DriveLoop {
    /// The core.
    pub fleet: Fleet,
    /// The simulated floor.
    pub world: World,
    /// The clock.
    pub clock: Arc<Clock>,
    /// Length of a turn.
    pub period: Span,
    /// Requests.
    pub inbox: Inbox,
    /// Questions about the fleet as it is.
    pub questions: mpsc::Receiver<Question>,
    /// Orders and answers.
    pub outbox: Outbox,
    /// Facts.
    pub journal: Journal,
    /// Figures.
    pub measure: Measure,
    /// Takes views for the figures over time.
    pub notes: HistorianSender,
    /// Figures for Prometheus.
    pub metrics: Arc<Metrics>,
    /// Where people may be soon, for dashboards and recordings.
    pub ahead: LastForecasts,
    /// Gets guidance.
    pub feeds: Arc<Feeds>,
    /// Gets what is worth a bookmark.
    pub tap: Tap,
    /// What stands.
    pub alarms: Arc<Alarms>,
    /// What lasts from one turn to the next.
    pub pace: LoopPace,
    /// Whether the database is not where it was: then nothing is asked for and nothing leaves.
    pub displaced: watch::Receiver<bool>,
    /// What is remembered of steps that ended in a panic.
    pub rescue: Rescue,
    /// Looks whether laws hold.
    pub watchdog: Watchdog,
    /// The journal, to make the fleet anew from.
    pub store: Arc<Store>,
    /// Gets the view.
    pub moments: watch::Sender<Arc<Moment>>,
    /// Whether robots are to stand for a change of the map.
    pub settling: Settling,
}

/// How the loop turns.
#[derive(Debug, Default)]
pub struct LoopPace {
    /// Whether all robots were told to stand, since nothing can be decided.
    halted: bool,
    /// When the pose was received that calls for a stop, if one waits for the next turn.
    called: Option<Time>,
    /// Until when the loop turns by its tick only.
    rests: Time,
}

impl DriveLoop {
    /// Turns until `stop` says so. Gives the floor as it is then.
    pub async fn run(mut self, mut stop: watch::Receiver<bool>) -> World {
        let mut tick = interval(Duration::from_micros(self.period.0.unsigned_abs().max(1000)));
        tick.set_missed_tick_behavior(MissedTickBehavior::Skip);
        let mut published = self.clock.started();
        while !*stop.borrow_and_update() {
            let rest = (self.pace.rests - self.clock.now()).max(Span::ZERO);
            tokio::select! {
                _ = tick.tick() => self.turn(&mut published),
                () = sleep(Duration::from_micros(rest.0.unsigned_abs())), if self.pace.called.is_some() => {
                    self.turn_early(&mut published);
                }
                heard = self.inbox.hear() => self.listen(&heard, &mut published),
                () = self.journal.confirmed() => {}
                _ = stop.changed() => {}
            }
            if self.rescue.is_needed() {
                self.rebuild(&mut stop).await;
            }
            self.release();
        }
        self.turn(&mut published);
        self.world
    }

    /// Turns at once where a pose calls for a stop, or hands for a warning, and the loop has rested.
    fn listen(&mut self, heard: &HeardSighting, published: &mut Time) {
        let now = self.clock.now();
        if self.rescue.is_broken() {
            return;
        }
        let hands = self.inbox.hands_of(heard);
        let warning = hands.and_then(|hands| self.fleet.warning_of(&hands, now));
        self.feeds.warn(warning.as_slice());
        if self.pace.called.is_some() {
            return;
        }
        if warning.is_some() || self.fleet.calls_for_stop(&heard.sighting, now) {
            self.pace.called = Some(heard.received);
            if now >= self.pace.rests {
                self.turn_early(published);
            }
        }
    }

    /// Warnings of hands do not wait for the step that is to come: a headset does not notice that it repeats them.
    fn warn_ahead(&self, heard: &[Input], now: Time) {
        let warning = |input: &Input| match input {
            Input::Hands(hands) => self.fleet.warning_of(hands, now),
            _ => None,
        };
        let warnings: Vec<CellWarning> = heard.iter().filter_map(warning).collect();
        self.feeds.warn(&warnings);
    }

    /// Turns before its time, and rests then for as long as that took, whatever pose calls.
    fn turn_early(&mut self, published: &mut Time) {
        let began = self.clock.now();
        self.turn(published);
        let done = self.clock.now();
        self.pace.rests = done + (done - began);
    }

    /// One step: absorb, decide, record; publish where it is time.
    fn turn(&mut self, published: &mut Time) {
        let now = self.clock.now();
        let called = self.pace.called.take();
        if self.rescue.is_broken() {
            return self.turn_broken(now);
        }
        self.metrics.poses_thinned.inc_by(self.feeds.pass(now));
        let refusing = self.refuses();
        let mut inputs = self.inbox.drain(refusing);
        inputs.extend(self.world.advance(now, &self.fleet));
        let before = inputs.len();
        self.inbox.look(&mut inputs);
        let looked = self.clock.now();
        self.warn_ahead(&inputs[before..], looked);
        let mut warned = false;
        if self.journal.is_full() {
            self.halt(now, &inputs);
            self.inbox.keep(inputs);
        } else {
            self.resume();
            let Some(step) = self.step(now, inputs) else { return };
            self.note(self.clock.now() - looked, step.facts.len());
            self.world.warn(self.clock.now(), &step.warnings);
            self.world.move_arms(&step.arms);
            self.feeds.warn(&step.warnings);
            warned = !step.warnings.is_empty();
            self.send_urgent((looked, called), step.urgent, step.guidance);
            self.tap.note(&step.facts);
            let causes = self.inbox.causes(&step.caused);
            let after = self.journal.record(now, step.facts, causes);
            self.outbox.put(after, step.commands, step.replies);
        }
        self.settling.look(&mut self.fleet, now, self.journal.is_settled());
        // A display of a station shows what somebody is warned of at once.
        if warned || now - *published >= PUBLISH {
            *published = now;
            self.publish(now);
        }
        for _ in 0..QUESTIONS_AT_ONCE {
            let Ok(question) = self.questions.try_recv() else { break };
            question.answer(&self.fleet, now);
        }
    }

    /// Whether new requests are refused at present.
    fn refuses(&self) -> bool {
        let facts_stay = self.journal.is_failing() || self.journal.is_full();
        facts_stay || *self.displaced.borrow()
    }

    /// Tells all robots to stand, until they say that they do. A decision changes what is promised and must be
    /// recorded, so there is none, while robots would finish what was granted and people walk on.
    fn halt(&mut self, now: Time, inputs: &[Input]) {
        let robots = if self.pace.halted {
            drivers(inputs).collect()
        } else {
            self.alarms.raise(AlarmKind::Halt, sentence::journal_full(), now);
            self.pace.halted = true;
            self.fleet.ledger().robots.ids().collect()
        };
        self.stand(robots);
    }

    /// Tells robots to stand.
    pub(super) fn stand(&mut self, robots: Vec<RobotId>) {
        let stops = robots.into_iter().map(|r| (r, Command::Limit(Some(0.0)))).collect();
        self.world.command(self.clock.now(), stops);
    }

    /// The journal takes facts: the step that follows lifts the limits, which it did not set.
    fn resume(&mut self) {
        if std::mem::take(&mut self.pace.halted) {
            self.alarms.clear(AlarmKind::Halt, self.clock.now());
            tracing::info!("the journal has room again: robots drive on");
        }
    }

    /// Lets stops, and what workers are told, go at once: what was decided with the poses that were there `looked`, of
    /// which one `called`.
    fn send_urgent(
        &mut self,
        (looked, called): (Time, Option<Time>),
        urgent: Vec<(RobotId, Command)>,
        guidance: Vec<(WorkerId, Guidance)>,
    ) {
        let stops = urgent.iter().any(|(_, c)| matches!(c, Command::Limit(Some(limit)) if *limit <= 0.0));
        if !urgent.is_empty() {
            self.world.command(self.clock.now(), urgent);
        }
        self.world.tell(self.clock.now(), guidance.clone());
        self.feeds.tell(looked, guidance);
        if let Some(called) = called.filter(|_| stops) {
            let took = self.clock.now() - called;
            self.metrics.pose_to_robot_stop.observe(took.as_secs_f64());
        }
        self.feeds.know(&self.fleet.ledger().workers);
    }

    /// Lets go what is durable.
    fn release(&mut self) {
        if *self.displaced.borrow() {
            return;
        }
        let (commands, replies) = self.outbox.take(self.journal.durable());
        if !commands.is_empty() {
            self.world.command(self.clock.now(), commands);
        }
        self.world.answer(self.clock.now(), &replies);
        replies.into_iter().for_each(|reply| self.inbox.answer(reply));
    }

    fn note(&mut self, length: Span, facts: usize) {
        self.metrics.step_seconds.observe(length.as_secs_f64());
        let searches_ns = self.fleet.take_plan_times();
        self.measure.step(length, &searches_ns);
        self.notes.measure(length, &searches_ns);
        self.watchdog.note_step(self.clock.now(), length, self.period);
        if length.0 > self.period.0 / 2 {
            tracing::warn!(step.ms = length.0 / 1000, facts, "a step took more than half its period");
        }
    }

    fn publish(&mut self, now: Time) {
        let view = self.fleet.view(now);
        self.feeds.refresh(&view, self.fleet.warehouse());
        self.alarms.note(&view);
        self.watchdog.look(&self.fleet, &view, self.clock.system_ahead(), &self.alarms);
        let measured = self.measure.figures(now, view.counts.robot_deliveries);
        let time_s = (now - self.clock.started()).as_secs_f64();
        let forecasts = self.ahead.of(&self.fleet, now);
        let backlog = self.tap.backlog(&self.fleet, now);
        let is_known = now - self.clock.started() >= SILENCE;
        let unheard = view.robots.iter().filter(|robot| robot.heard.is_none() && !is_known).count();
        let moment = Arc::new(Moment { view, unheard: Some(unheard), time_s, measured, forecasts, backlog });
        self.notes.send(&moment);
        self.moments.send_replace(moment);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::server::historian::historian;
    use crate::server::{inbox, journal, outbox};
    use giveway_api::port::{QueuedRequest, SharedHistory};
    use giveway_fleet::{
        Answered, EncounterFact, Fact, FloorAction, JobAction, JobKind, JobRequest, Request, WorkerAction,
    };
    use giveway_floor::geometry::Point;
    use giveway_floor::id::NodeId;
    use giveway_floor::warehouse::lab;
    use giveway_people::human::{Quality, Sighting};
    use giveway_sim::Scenario;
    use giveway_store::Store;
    use tokio::sync::oneshot;

    const SCENARIO: &str = r#"{"giveway_scenario": 1, "name": "t", "map": "", "robots": 2, "jobs": "none"}"#;

    /// A loop with a journal that is written only when the test lets the writer run.
    async fn drive(
        folder: &std::path::Path,
    ) -> (DriveLoop, journal::JournalSender, mpsc::Sender<QueuedRequest>) {
        let (map, scenario) = (Arc::new(lab()), Scenario::parse(SCENARIO).unwrap());
        let store = Arc::new(Store::open(&folder.join("t.sqlite"), &map).await.unwrap());
        let (clock, alarms) = (Arc::new(Clock::start(None)), Arc::new(Alarms::default()));
        let metrics = Arc::new(Metrics::default());
        let figures = Arc::new(SharedHistory::new(Time::ZERO, "giveway", Default::default()));
        let (notes, _) = historian(figures, store.clone());
        let fleet = Fleet::new(map.clone(), scenario.settings());
        let start = journal::Start { next: 1, ledger: fleet.ledger().clone(), behind: 0 };
        let (journal, writer) =
            journal::journal(store.clone(), start, clock.clone(), alarms.clone(), metrics.clone());
        let world = World::new(map, &scenario, &[], 1, &fleet, clock.now());
        let ((feeds, heard), (queue, asks)) = (Feeds::new(), mpsc::channel(8));
        let (measure, outbox, feeds) = (Measure::default(), outbox::Outbox::default(), Arc::new(feeds));
        let (inbox, moments) = (inbox::Inbox::new(asks, heard), watch::Sender::new(Arc::default()));
        let (period, (_, questions)) = (scenario.period, mpsc::channel(1));
        let drive = DriveLoop {
            fleet,
            world,
            clock,
            period,
            inbox,
            questions,
            outbox,
            journal,
            measure,
            notes,
            metrics,
            ahead: LastForecasts::default(),
            feeds,
            tap: Tap::default(),
            alarms,
            pace: LoopPace::default(),
            displaced: watch::channel(false).1,
            rescue: Rescue::default(),
            watchdog: Watchdog::default(),
            store: store.clone(),
            moments,
            settling: Settling::new(mpsc::channel(1).1),
        };
        (drive, writer, queue)
    }

    /// Turns until all robots have this limit.
    async fn until(drive: &mut DriveLoop, limit: Option<f64>) {
        let mut published = drive.clock.now();
        for _ in 0..100 {
            drive.turn(&mut published);
            tokio::time::sleep(Duration::from_millis(10)).await;
            let mut robots = drive.world.truth();
            if robots.next().is_some() && drive.world.truth().all(|(_, t)| t.limit_mps == limit) {
                return;
            }
        }
        panic!("no limit of {limit:?}: {:?}", drive.world.truth().collect::<Vec<_>>());
    }

    #[tokio::test]
    async fn while_the_journal_is_full_all_robots_are_told_to_stand_and_go_on_when_it_is_back() {
        let folder = std::env::temp_dir().join(format!("giveway-drive-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (mut drive, writer, queue) = drive(&folder).await;
        until(&mut drive, None).await;
        let fact = |i: u32| Fact::Encounter(EncounterFact::Deviated { worker: WorkerId(i), at: Time(1) });
        drive.journal.record(Time(1), (0..20_000).map(fact).collect(), Vec::new());
        assert!(drive.journal.is_full());
        let mut job = ask(&queue, JobAction::Cancel(giveway_floor::id::JobId(1)));
        let mut by_hand =
            [FloorAction::Halt(None), FloorAction::Release(None)].map(|action| ask(&queue, action));
        until(&mut drive, Some(0.0)).await;
        assert_eq!(job.try_recv(), Err(oneshot::error::TryRecvError::Closed), "it is answered");
        assert!(drive.alarms.of_kind(AlarmKind::Halt).is_some());
        let writer = tokio::spawn(writer.run());
        while drive.journal.is_full() {
            drive.journal.confirmed().await;
        }
        until(&mut drive, None).await;
        assert!(drive.alarms.of_kind(AlarmKind::Halt).is_none());
        while !drive.journal.is_settled() {
            drive.journal.confirmed().await;
        }
        drive.release();
        for answer in &mut by_hand {
            assert!(answer.try_recv().is_ok(), "what is done by hand is kept, and done in its order");
        }
        writer.abort();
        let _ = std::fs::remove_dir_all(&folder);
    }

    #[tokio::test]
    async fn a_step_that_panics_is_undone_and_where_it_happens_again_and_again_all_robots_stand() {
        let folder = std::env::temp_dir().join(format!("giveway-panics-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (mut drive, writer, queue) = drive(&folder).await;
        let writer = tokio::spawn(writer.run());
        until(&mut drive, None).await;
        let (_stop, mut stop) = watch::channel(false);
        let known = drive.fleet.ledger().robots.clone();
        let mut halt = ask(&queue, FloorAction::Halt(None));
        let mut job = ask(&queue, JobAction::Cancel(giveway_floor::id::JobId(1)));
        let inputs = drive.inbox.drain(false);
        let now = drive.clock.now();
        drive.fleet.trap = Some(RobotId(0));
        assert!(drive.step(now, inputs).is_none());
        drive.rebuild(&mut stop).await;
        assert!(!drive.rescue.is_broken());
        assert_eq!(drive.fleet.ledger().robots.len(), known.len(), "made anew from what is durable");
        assert!(job.try_recv().is_err(), "nothing came of it, and that is said");
        let mut published = drive.clock.now();
        while halt.try_recv().is_err() {
            drive.turn(&mut published);
            drive.journal.confirmed().await;
            drive.release();
        }
        assert!(drive.fleet.ledger().stopped.is_some(), "a stop by hand outlasts it");
        for _ in 0..3 {
            let now = drive.clock.now();
            drive.fleet.trap = Some(RobotId(0));
            assert!(drive.step(now, vec![]).is_none());
            drive.rebuild(&mut stop).await;
        }
        assert!(drive.rescue.is_broken());
        until(&mut drive, Some(0.0)).await;
        let said = drive.alarms.of_kind(AlarmKind::Broken).expect("it says so").text;
        assert!(said.text().contains("again and again"), "{said}");
        let mut refused = ask(&queue, JobAction::Cancel(giveway_floor::id::JobId(1)));
        drive.turn(&mut published);
        assert_eq!(refused.try_recv(), Err(oneshot::error::TryRecvError::Closed));
        writer.abort();
        let _ = std::fs::remove_dir_all(&folder);
    }

    fn ask(queue: &mpsc::Sender<QueuedRequest>, request: impl Into<Request>) -> oneshot::Receiver<Answered> {
        let (reply, answer) = oneshot::channel();
        let (request, by) = (request.into(), inbox::local_request());
        queue.try_send(QueuedRequest { request, by, reply }).unwrap();
        answer
    }

    #[tokio::test]
    async fn a_pose_that_calls_for_a_stop_does_not_wait_for_the_next_tick() {
        let folder = std::env::temp_dir().join(format!("giveway-called-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (mut drive, writer, queue) = drive(&folder).await;
        let writer = tokio::spawn(writer.run());
        let mut published = drive.clock.now();
        until(&mut drive, None).await;
        let robot = RobotId(0);
        let from = drive.world.truth().next().unwrap().1.pose.at;
        let away = |n: &NodeId| (drive.fleet.warehouse().nodes[*n].at - from).norm();
        let node = drive.fleet.warehouse().nodes.ids().max_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
        let kind = JobKind::Go { robot, node };
        let request = JobRequest { priority: 5, ..JobRequest::new(kind) };
        let hire = WorkerAction::Register("anna".into());
        let _answers = [ask(&queue, JobAction::Submit(request)), ask(&queue, hire)];
        let seen = loop {
            drive.turn(&mut published);
            drive.release();
            tokio::time::sleep(Duration::from_millis(10)).await;
            let seen = drive.world.truth().next().unwrap().1;
            if seen.speed_mps > 0.8 {
                break seen;
            }
        };
        let ahead = giveway_floor::geometry::Vector::new(seen.pose.heading.cos(), seen.pose.heading.sin());
        let now = drive.clock.now();
        let sighting = |seq: u64, at: Point| Sighting {
            mirror: None,
            worker: WorkerId(0),
            seen: now + Span::from_millis(10 * seq as i64),
            epoch: seq as u32,
            at_marks: true,
            source: giveway_people::human::SourceId::Headset,
            seq,
            at,
            heading: None,
            accuracy_m: 0.05,
            quality: Quality::Tracked,
        };
        let far = HeardSighting { received: Time(1), sighting: sighting(1, from - ahead * 2.0), hands: None };
        let near =
            HeardSighting { received: Time(2), sighting: sighting(2, seen.pose.at + ahead), hands: None };
        let stops =
            |d: &DriveLoop| d.metrics.text(&Moment::default()).contains("pose_to_robot_stop_seconds_count 1");
        let (feed, heard) = mpsc::channel(8);
        drive.inbox = inbox::Inbox::new(mpsc::channel(1).1, heard);
        for (pose, stops_now) in [(far, false), (near, true)] {
            feed.try_send(pose).unwrap();
            let heard = drive.inbox.hear().await;
            drive.pace.rests = Time::ZERO;
            drive.listen(&heard, &mut published);
            assert_eq!(stops(&drive), stops_now, "{heard:?}");
        }
        assert!(drive.pace.called.is_none() && drive.pace.rests > drive.clock.started());
        writer.abort();
        let _ = std::fs::remove_dir_all(&folder);
    }
}
