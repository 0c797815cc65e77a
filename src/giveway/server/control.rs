//! The control loop: tokio around the pure driver. One thread owns the driver and the floor, and runs one turn per
//! period.
//!
//! Main type: [`ControlLoop`]. Missed ticks are skipped, not caught up. A pose that calls for a stop does not wait for
//! the next tick: the loop turns at once, and then rests for as long as the turn took. The driver ([`giveway_drive`])
//! decides what leaves when, what is kept, and what happens after a panic. Refuses: locks, waiting for the database,
//! and decisions of its own.

use super::Planted;
use super::ahead::LastForecasts;
use super::clock::Clock;
use super::historian::HistorianSender;
use super::inbox::Inbox;
use super::journal::Journal;
use super::links::Links;
use super::measure::Measure;
use super::recordings::BookmarkSender;
use super::settle::SettleQueue;
use super::watchdog::Watchdog;
use giveway_api::{
    Alarms, Feeds, FloorSimulation, HeardSighting, Metrics, Moment, QUESTIONS_AT_ONCE, Question,
};
use giveway_drive::{Drive, DriveAlarm, GuardedCall, Heard, JournalReport, Sent, WrittenStep};
use giveway_fleet::{CellWarning, Command, Input, SILENCE};
use giveway_floor::time::{Span, Time};
use giveway_store::Store;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval, sleep};

/// Interval between views; a little less than a tenth of a second, so that a tick does not just miss the next one.
const PUBLISH: Duration = Duration::from_millis(95);

/// Everything that the loop owns.
pub struct ControlLoop {
    /// The driver: fleet, journal gate, outbox.
    pub drive: Drive,
    /// Links to robots, and to simulated people.
    pub links: Links,
    /// The clock.
    pub clock: Arc<Clock>,
    /// Period of a turn.
    pub period: Span,
    /// The simulation, if all robots and people are simulated.
    pub simulation: Option<FloorSimulation>,
    /// Requests and sightings.
    pub inbox: Inbox,
    /// Questions about the fleet's current state.
    pub questions: mpsc::Receiver<Question>,
    /// Stores facts.
    pub journal: Journal,
    /// Measures the loop.
    pub measure: Measure,
    /// Passes views on for the figures over time.
    pub notes: HistorianSender,
    /// Metrics for Prometheus.
    pub metrics: Arc<Metrics>,
    /// Forecasts of people, for dashboards and recordings.
    pub ahead: LastForecasts,
    /// Receives guidance.
    pub feeds: Arc<Feeds>,
    /// Receives facts that may become bookmarks.
    pub tap: BookmarkSender,
    /// Active alarms.
    pub alarms: Arc<Alarms>,
    /// State of the loop's timing.
    pub pace: LoopPace,
    /// Whether the database files are no longer in their place.
    pub displaced: watch::Receiver<bool>,
    /// Checks whether laws hold.
    pub watchdog: Watchdog,
    /// The database, from which the fleet can be restored.
    pub store: Arc<Store>,
    /// Receives the view.
    pub moments: watch::Sender<Arc<Moment>>,
    /// Requests that robots stop for a change of the map.
    pub settling: SettleQueue,
    /// Panics that tests plant.
    pub planted: Planted,
}

/// The timing of the loop.
#[derive(Debug, Default)]
pub struct LoopPace {
    /// When the pose that calls for a stop was received, if it waits for the next turn.
    called: Option<Time>,
    /// Until when the loop turns only on its ticks.
    rests: Time,
}

impl ControlLoop {
    /// Turns until `stop` turns true. Returns the links in their final state.
    pub async fn run(mut self, mut stop: watch::Receiver<bool>) -> Links {
        let mut tick = interval(self.clock.lasts(self.period).max(Duration::from_millis(1)));
        tick.set_missed_tick_behavior(MissedTickBehavior::Skip);
        let mut published = self.clock.started();
        while !*stop.borrow_and_update() {
            let rest = (self.pace.rests - self.clock.now()).max(Span::ZERO);
            tokio::select! {
                _ = tick.tick() => self.turn(&mut published),
                () = sleep(self.clock.lasts(rest)), if self.pace.called.is_some() => {
                    self.turn_early(&mut published);
                }
                heard = self.inbox.hear() => self.listen(&heard, &mut published),
                () = self.journal.confirmed() => {}
                _ = stop.changed() => {}
            }
            self.release();
            if self.drive.wants_fold() {
                self.restore().await;
            }
        }
        // The last turn must not be of a fleet that a panic left half-way.
        self.drive.stop_deciding();
        self.turn(&mut published);
        self.links
    }

    /// Turns at once if a pose calls for a stop, or hands for a warning, and the loop has rested.
    fn listen(&mut self, heard: &HeardSighting, published: &mut Time) {
        let now = self.clock.now();
        if self.drive.is_broken() {
            return;
        }
        let hands = self.inbox.hands_of(heard);
        let warning =
            self.drive.ask(GuardedCall::Pose, now, |fleet| fleet.warning_of(&hands?, now)).flatten();
        self.feeds.warn(warning.as_slice());
        if self.pace.called.is_some() {
            return;
        }
        let calls = |drive: &mut Drive| {
            drive
                .ask(GuardedCall::Pose, now, |fleet| fleet.calls_for_stop(&heard.sighting, now))
                .unwrap_or(false)
        };
        if warning.is_some() || calls(&mut self.drive) {
            self.pace.called = Some(heard.received);
            if now >= self.pace.rests {
                self.turn_early(published);
            }
        }
    }

    /// Sends warnings about hands before the next step, which repeats them: a headset does not show the repetition.
    fn warn_ahead(&mut self, heard: &[Input], now: Time) {
        let warnings = self.drive.ask(GuardedCall::Pose, now, |fleet| {
            let warning = |input: &Input| match input {
                Input::Hands(hands) => fleet.warning_of(hands, now),
                _ => None,
            };
            heard.iter().filter_map(warning).collect::<Vec<CellWarning>>()
        });
        self.feeds.warn(&warnings.unwrap_or_default());
    }

    /// Turns ahead of the tick, and then rests for as long as that took, whatever pose calls.
    fn turn_early(&mut self, published: &mut Time) {
        let began = self.clock.now();
        self.turn(published);
        let done = self.clock.now();
        self.pace.rests = done + (done - began);
    }

    /// One turn: everything that was heard goes into the driver, and its output goes to the links, feeds and journal.
    fn turn(&mut self, published: &mut Time) {
        let now = self.clock.now();
        let called = self.pace.called.take();
        self.metrics.poses_thinned.inc_by(self.feeds.pass(now));
        self.settling.look(&mut self.drive, now);
        self.plant();
        let requests = self.inbox.requests(self.drive.room());
        let mut inputs = self.links.hear(now, &mut self.drive);
        let before = inputs.len();
        self.inbox.look(&mut inputs);
        let looked = self.clock.now();
        self.warn_ahead(&inputs[before..], looked);
        let sent = self.drive.turn(now, Heard { journal: self.report(), requests, inputs });
        if sent.stepped {
            let facts = sent.written.as_ref().map_or(0, |written| written.facts.len());
            self.note(self.clock.now() - looked, facts);
        }
        let warned = self.send((looked, called), sent);
        // The display of a station shows a warning to a person at once.
        if warned || now - *published >= self.clock.passes(PUBLISH) {
            *published = now;
            self.publish(now);
        }
        for _ in 0..QUESTIONS_AT_ONCE {
            let Ok(question) = self.questions.try_recv() else { break };
            self.drive.ask(GuardedCall::Query, now, |fleet| question.answer(fleet, now));
        }
    }

    /// Plants the next panic of a test, if there is one.
    fn plant(&mut self) {
        let planted = self.planted.lock().map(|mut traps| traps.pop());
        planted.ok().flatten().into_iter().for_each(|trap| self.drive.plant(trap));
    }

    /// The state of the journal.
    fn report(&self) -> JournalReport {
        self.journal.report(*self.displaced.borrow())
    }

    /// Sends stops and guidance at once; they were decided with the poses known at `looked`, one of which `called`.
    /// Passes the facts to the journal. Returns whether there were warnings.
    fn send(&mut self, (looked, called): (Time, Option<Time>), sent: Sent) -> bool {
        self.links.take(self.clock.now(), &sent);
        let Sent { written, limits, guidance, warnings, refused, alarms, settled, .. } = sent;
        self.inbox.forget(&refused);
        self.feeds.warn(&warnings);
        let stops = limits.iter().any(|(_, c)| matches!(c, Command::Limit(Some(limit)) if *limit <= 0.0));
        self.feeds.tell(looked, guidance);
        if let Some(called) = called.filter(|_| stops) {
            let took = self.clock.now() - called;
            self.metrics.pose_to_robot_stop.observe(took.as_secs_f64());
        }
        self.feeds.know(&self.drive.fleet().ledger().workers);
        if let Some(counts) = self.links.take_counts() {
            self.metrics.note_link(&counts);
        }
        for alarm in alarms.into_iter().chain(self.links.take_alarms()) {
            match alarm {
                DriveAlarm::Raise(kind, text) => _ = self.alarms.raise(kind, text, self.clock.now()),
                DriveAlarm::Clear(kind) => _ = self.alarms.clear(kind, self.clock.now()),
            }
        }
        if let Some(WrittenStep { at, facts, caused }) = written {
            self.tap.note(&facts);
            let causes = self.inbox.causes(&caused);
            self.journal.record(at, facts, causes);
        }
        self.settling.answer(settled, &mut self.drive);
        !warnings.is_empty()
    }

    /// Releases what is durable.
    fn release(&mut self) {
        let released = self.drive.release(self.report());
        self.links.take(self.clock.now(), &released);
        released.replies.into_iter().for_each(|reply| self.inbox.answer(reply));
    }

    /// Restores the fleet from the journal when everything recorded is durable.
    async fn restore(&mut self) {
        let loaded = self.store.load(self.drive.empty_ledger()).await;
        let folded = catch_unwind(AssertUnwindSafe(|| loaded.map(|loaded| loaded.into_parts())));
        let folded = match folded {
            Ok(folded) => folded.map_err(|e| e.to_string()),
            Err(panic) => Err(giveway_drive::panic_text(&*panic)),
        };
        self.drive
            .restore(self.clock.now(), folded.map(|(ledger, facts)| (ledger, facts.into_iter().collect())));
    }

    fn note(&mut self, length: Span, facts: usize) {
        self.metrics.step_seconds.observe(length.as_secs_f64());
        let searches_ns = self.drive.take_plan_times();
        self.measure.step(length, &searches_ns);
        self.notes.measure(length, &searches_ns);
        self.watchdog.note_step(self.clock.now(), length, self.period);
        if length.0 > self.period.0 / 2 {
            tracing::warn!(step.ms = length.0 / 1000, facts, "a step took more than half its period");
        }
    }

    /// Publishes the view, if there is one.
    fn publish(&mut self, now: Time) {
        if self.drive.is_broken() {
            return;
        }
        let Some(view) = self.drive.ask(GuardedCall::View, now, |fleet| fleet.view(now)) else { return };
        self.feeds.refresh(&view, self.drive.fleet().warehouse());
        self.alarms.note(&view);
        let (watchdog, ahead, alarms) = (&mut self.watchdog, self.clock.system_ahead(), &self.alarms);
        self.drive.ask(GuardedCall::Watch, now, |fleet| watchdog.look(fleet, &view, ahead, alarms));
        let measured = self.measure.figures(now, view.counts.robot_deliveries);
        let time_s = (now - self.clock.started()).as_secs_f64();
        let (last, tap) = (&mut self.ahead, &mut self.tap);
        let shown =
            self.drive.ask(GuardedCall::View, now, |fleet| (last.of(fleet, now), tap.backlog(fleet, now)));
        let Some((forecasts, backlog)) = shown else { return };
        let is_known = now - self.clock.started() >= SILENCE;
        let unheard = view.robots.iter().filter(|robot| robot.heard.is_none() && !is_known).count();
        let (unheard, simulation) = (Some(unheard), self.simulation);
        let moment = Moment { view, unheard, time_s, simulation, measured, forecasts, backlog };
        let moment = Arc::new(moment);
        self.notes.send(&moment);
        self.moments.send_replace(moment);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::server::historian::historian;
    use crate::server::links::FloorSource;
    use crate::server::{inbox, journal};
    use giveway_api::{QueuedRequest, SharedHistory};
    use giveway_drive::Trap;
    use giveway_fleet::{
        Answered, Fleet, FloorAction, JobAction, JobKind, JobRequest, Request, Telemetry, WorkerAction,
    };
    use giveway_floor::geometry::Point;
    use giveway_floor::id::{NodeId, RobotId, WorkerId};
    use giveway_floor::warehouse::lab;
    use giveway_people::human::{Quality, Sighting};
    use giveway_store::Store;
    use tokio::sync::oneshot;

    const SCENARIO: &str = r#"{"giveway_scenario": 1, "name": "t", "map": "", "robots": 2, "period_ms": 100,
        "jobs": "none"}"#;

    fn truth(control: &ControlLoop) -> impl Iterator<Item = (RobotId, Telemetry)> {
        control.links.sim().world().truth()
    }

    /// A loop with a journal that writes only when the test runs the writer.
    async fn drive(
        folder: &std::path::Path,
    ) -> (ControlLoop, journal::JournalSender, mpsc::Sender<QueuedRequest>) {
        let (map, source) = (Arc::new(lab()), FloorSource::parse(SCENARIO).unwrap());
        let store = Arc::new(Store::open(&folder.join("t.sqlite"), &map).await.unwrap());
        let (clock, alarms) = (Arc::new(Clock::start(None)), Arc::new(Alarms::default()));
        let metrics = Arc::new(Metrics::default());
        let figures = Arc::new(SharedHistory::new(Time::ZERO, "giveway", Default::default()));
        let (notes, _) = historian(figures, store.clone());
        let fleet = Fleet::new(map.clone(), source.site().settings());
        let start = journal::Start { next: 1, ledger: fleet.ledger().clone(), behind: 0 };
        let (journal, writer) =
            journal::journal(store.clone(), start, clock.clone(), alarms.clone(), metrics.clone());
        let links = Links::new(source.begin(map, fleet.ledger(), clock.now()), None);
        let ((feeds, heard), (queue, asks)) = (Feeds::new(), mpsc::channel(8));
        let (measure, feeds) = (Measure::default(), Arc::new(feeds));
        let (inbox, moments) = (inbox::Inbox::new(asks, heard), watch::Sender::new(Arc::default()));
        let (period, (_, questions)) = (source.site().period, mpsc::channel(1));
        let drive = ControlLoop {
            drive: Drive::new(fleet),
            links,
            clock,
            period,
            simulation: Some(FloorSimulation { speed: 1 }),
            inbox,
            questions,
            journal,
            measure,
            notes,
            metrics,
            ahead: LastForecasts::default(),
            feeds,
            tap: BookmarkSender::default(),
            alarms,
            pace: LoopPace::default(),
            displaced: watch::channel(false).1,
            watchdog: Watchdog::default(),
            store: store.clone(),
            moments,
            settling: SettleQueue::new(mpsc::channel(1).1),
            planted: Planted::default(),
        };
        (drive, writer, queue)
    }

    /// Turns until all robots have this speed limit.
    async fn until(drive: &mut ControlLoop, limit: Option<f64>) {
        let mut published = drive.clock.now();
        for _ in 0..100 {
            drive.turn(&mut published);
            tokio::time::sleep(Duration::from_millis(10)).await;
            if truth(drive).next().is_some() && truth(drive).all(|(_, t)| t.limit_mps == limit) {
                return;
            }
        }
        panic!("no limit of {limit:?}: {:?}", truth(drive).collect::<Vec<_>>());
    }

    #[tokio::test]
    async fn a_step_that_panics_is_undone_from_the_database_and_a_stop_by_hand_outlasts_it() {
        let folder = std::env::temp_dir().join(format!("giveway-panics-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (mut drive, writer, queue) = drive(&folder).await;
        let writer = tokio::spawn(writer.run());
        until(&mut drive, None).await;
        let known = drive.drive.fleet().ledger().robots.len();
        let mut halt = ask(&queue, FloorAction::Halt(None));
        let mut job = ask(&queue, JobAction::Cancel(giveway_floor::id::JobId(1)));
        drive.drive.plant(Trap { call: GuardedCall::Step, robot: Some(RobotId(0)), times: 1 });
        let mut published = drive.clock.now();
        while halt.try_recv().is_err() {
            drive.turn(&mut published);
            if !drive.drive.is_settled() {
                drive.journal.confirmed().await;
            }
            drive.release();
            if drive.drive.wants_fold() {
                drive.restore().await;
            }
        }
        assert!(!drive.drive.is_broken());
        let ledger = drive.drive.fleet().ledger();
        assert_eq!(ledger.robots.len(), known, "made anew from what is durable");
        assert!(ledger.robots[RobotId(0)].fenced.is_some() && ledger.stopped.is_some());
        assert_eq!(job.try_recv(), Err(oneshot::error::TryRecvError::Closed), "nothing came of it");
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
        let from = truth(&drive).next().unwrap().1.pose.at;
        let away = |n: &NodeId| (drive.drive.fleet().warehouse().nodes[*n].at - from).norm();
        let node =
            drive.drive.fleet().warehouse().nodes.ids().max_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
        let kind = JobKind::Go { robot, node };
        let request = JobRequest { priority: 5, ..JobRequest::new(kind) };
        let hire = WorkerAction::Register("anna".into());
        let _answers = [ask(&queue, JobAction::Submit(request)), ask(&queue, hire)];
        let seen = loop {
            drive.turn(&mut published);
            drive.release();
            tokio::time::sleep(Duration::from_millis(10)).await;
            let seen = truth(&drive).next().unwrap().1;
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
        let stops = |d: &ControlLoop| {
            d.metrics.text(&Moment::default()).contains("pose_to_robot_stop_seconds_count 1")
        };
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
