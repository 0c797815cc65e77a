//! The loop: one thread owns the fleet and the floor, and turns twenty times a second.
//!
//! Main type: [`Drive`]. Missed ticks are skipped, not caught up. Stops, and what workers are told, leave in the turn
//! that decided them. Orders and answers leave when the journal has the facts behind them; where it has none of them
//! for long, the fleet stands and the floor goes on. Refuses: locks, waiting for the database, and decisions of its
//! own.

use super::clock::Clock;
use super::inbox::Inbox;
use super::journal::Journal;
use super::measure::Measure;
use super::outbox::Outbox;
use crate::api::feed::hub::Feeds;
use crate::api::metrics::Metrics;
use crate::api::port::Moment;
use crate::fleet::{Command, Fleet, Guidance};
use crate::id::{RobotId, WorkerId};
use crate::sim::World;
use crate::time::{Span, Time};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::{MissedTickBehavior, interval};

/// How often the picture is published; a little less than a tenth of a second, so that a tick does not just
/// miss it.
const PUBLISH: Span = Span::from_millis(95);

/// Everything that the loop owns.
pub struct Drive {
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
    /// Orders and answers.
    pub outbox: Outbox,
    /// Facts.
    pub journal: Journal,
    /// Figures.
    pub measure: Measure,
    /// Figures for Prometheus.
    pub metrics: Arc<Metrics>,
    /// Gets guidance.
    pub feeds: Arc<Feeds>,
    /// Gets the picture.
    pub moments: watch::Sender<Arc<Moment>>,
}

impl Drive {
    /// Turns until `stop` says so.
    pub async fn run(mut self, mut stop: watch::Receiver<bool>) {
        let mut tick = interval(Duration::from_micros(self.period.0.unsigned_abs().max(1000)));
        tick.set_missed_tick_behavior(MissedTickBehavior::Skip);
        let mut published = self.clock.started();
        while !*stop.borrow_and_update() {
            tokio::select! {
                _ = tick.tick() => self.turn(&mut published),
                () = self.journal.confirmed() => {}
                _ = stop.changed() => {}
            }
            self.release();
        }
        self.turn(&mut published);
    }

    /// One step: absorb, decide, record; publish where it is time.
    fn turn(&mut self, published: &mut Time) {
        let now = self.clock.now();
        let mut inputs = self.inbox.drain(self.journal.is_failing());
        inputs.extend(self.world.advance(now, &self.fleet));
        let heard = self.inbox.look(&mut inputs);
        if self.journal.is_full() {
            self.inbox.keep(inputs);
        } else {
            let began = self.clock.now();
            let step = self.fleet.step(now, inputs);
            self.note(self.clock.now() - began, step.facts.len());
            self.hurry(now, heard, step.urgent, step.guidance);
            let after = self.journal.record(now, step.facts);
            self.outbox.put(after, step.commands, step.replies);
        }
        if now - *published >= PUBLISH {
            *published = now;
            self.publish(now);
        }
    }

    /// Lets stops, and what workers are told, go at once.
    fn hurry(
        &mut self,
        now: Time,
        heard: Option<Time>,
        urgent: Vec<(RobotId, Command)>,
        guidance: Vec<(WorkerId, Guidance)>,
    ) {
        let stops = urgent.iter().any(|(_, c)| matches!(c, Command::Limit(Some(limit)) if *limit <= 0.0));
        if !urgent.is_empty() {
            self.world.command(self.clock.now(), urgent);
        }
        self.world.tell(self.clock.now(), guidance.clone());
        self.feeds.tell(now, guidance);
        if let Some(heard) = heard.filter(|_| stops) {
            let took = self.clock.now() - heard;
            self.metrics.pose_to_robot_stop.observe(took.as_secs_f64());
        }
        self.feeds.know(&self.fleet.ledger().workers);
    }

    /// Lets go what is durable.
    fn release(&mut self) {
        let (commands, replies) = self.outbox.take(self.journal.durable());
        if !commands.is_empty() {
            self.world.command(self.clock.now(), commands);
        }
        replies.into_iter().for_each(|reply| self.inbox.answer(reply));
    }

    fn note(&mut self, length: Span, facts: usize) {
        self.metrics.step_seconds.observe(length.as_secs_f64());
        self.measure.step(length, &self.fleet.take_plan_times());
        if length.0 > self.period.0 / 2 {
            tracing::warn!(step.ms = length.0 / 1000, facts, "a step took more than half its period");
        }
    }

    fn publish(&mut self, now: Time) {
        let view = self.fleet.view(now);
        self.feeds.refresh(&view);
        let measured = self.measure.figures(now, view.counts.robot_deliveries);
        let time_s = (now - self.clock.started()).as_secs_f64();
        self.moments.send_replace(Arc::new(Moment { view, time_s, measured }));
    }
}
