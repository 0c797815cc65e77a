//! Keeps figures over time: takes views from the loop, and stores buckets.
//!
//! Main types: [`HistorianSender`] (the loop's end), [`Historian`] (the task). A crash costs the charts ten seconds,
//! and the heat map of waiting a minute. If the database refuses, figures continue in memory and are stored later, as
//! far back as they are kept. Refuses: to make the loop wait.

use giveway_api::{Moment, SharedHistory};
use giveway_fleet::history::{HEAT_STEP, LoopTimes, TIERS, floor};
use giveway_floor::time::{Span, Time};
use giveway_store::Store;
use std::sync::Arc;
use tokio::sync::mpsc;

/// The most views that wait: those of half a minute.
const NOTES: usize = 320;

/// Interval between stores of the heat map of waiting.
const HEAT_EVERY: Span = Span::from_secs(60);

/// A view, with the durations of searches and steps since the previous one.
struct Note {
    moment: Arc<Moment>,
    times: LoopTimes,
}

/// The loop's end.
pub struct HistorianSender {
    sender: mpsc::Sender<Note>,
    times: LoopTimes,
}

/// The task's end.
pub struct Historian {
    figures: Arc<SharedHistory>,
    store: Arc<Store>,
    notes: mpsc::Receiver<Note>,
}

/// Both ends of the channel.
pub fn historian(figures: Arc<SharedHistory>, store: Arc<Store>) -> (HistorianSender, Historian) {
    let (sender, notes) = mpsc::channel(NOTES);
    (HistorianSender { sender, times: LoopTimes::default() }, Historian { figures, store, notes })
}

impl HistorianSender {
    /// Notes the durations of a step and its searches.
    pub fn measure(&mut self, step: Span, searches_ns: &[u64]) {
        self.times.searches_us.extend(searches_ns.iter().map(|ns| ns / 1000));
        self.times.step_us = self.times.step_us.max(step.0.unsigned_abs());
    }

    /// Passes a view on. If the historian is behind, the measurements go with the next view.
    pub fn send(&mut self, moment: &Arc<Moment>) {
        if let Ok(place) = self.sender.try_reserve() {
            place.send(Note { moment: moment.clone(), times: std::mem::take(&mut self.times) });
        }
    }
}

/// The times up to which everything was stored.
struct Saved {
    buckets: Time,
    heat: Time,
    failed: bool,
}

impl Historian {
    /// Takes views until the loop ends, then stores the last figures.
    pub async fn run(mut self) {
        let mut last = None;
        let mut saved = Saved { buckets: self.figures.started, heat: self.figures.started, failed: false };
        while let Some(note) = self.notes.recv().await {
            let now = note.moment.view.now;
            self.figures.note(&note.moment.view, &note.times);
            let over = last.is_some_and(|last| floor(last, TIERS[0].0) != floor(now, TIERS[0].0));
            last = Some(now);
            if over {
                self.save(now, now - saved.heat >= HEAT_EVERY, &mut saved).await;
            }
        }
        if let Some(now) = last {
            self.save(now, true, &mut saved).await;
        }
    }

    async fn save(&self, now: Time, heat: bool, saved: &mut Saved) {
        // Starts with the last stored buckets, since these were not over.
        let buckets = self.figures.with(|h| h.since(saved.buckets));
        let places = if heat { self.figures.with(|h| h.heat().since(saved.heat)) } else { Vec::new() };
        match self.store.keep_history(now, &buckets, &places).await {
            Ok(()) => {
                saved.buckets = now;
                saved.heat = if heat { now } else { saved.heat };
                saved.failed = false;
            }
            Err(e) if !saved.failed => {
                tracing::warn!("figures over time cannot be saved and are kept in memory: {e}");
                saved.failed = true;
            }
            Err(_) => {}
        }
    }
}

/// The heat map of waiting is kept in buckets of this length, so that many of them are stored at once and seldom.
const _: () = assert!(HEAT_STEP.0 % HEAT_EVERY.0 == 0);
