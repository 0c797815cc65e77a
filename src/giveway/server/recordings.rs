//! Keeps recordings: a thread of its own writes frames of the live feed to disk, five a second.
//!
//! Main types: [`KeptPast`], [`BookmarkSender`] (the loop's end, which never waits). If the disk is full or fails, an
//! alarm and the log say so, the fleet goes on, and the thread tries again. Refuses: to delay the loop; when facts come
//! too fast, some get no bookmark, but all of them are in the journal.

use super::clock::Clock;
use super::queue::LastBacklog;
use giveway_api::recording::{EVERY, Folder, Limits, Rotation, is_notable};
use giveway_api::{Alarms, Live};
use giveway_fleet::alarm::AlarmKind;
use giveway_fleet::{Backlog, Fact, Fleet};
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::Duration;
use tokio::sync::oneshot;

/// The most facts that wait for their bookmarks.
const WAITING: usize = 1024;

/// How long to wait after the disk refused.
const REST: Span = Span::from_secs(10);

/// Passes facts from the loop to the thread that writes recordings.
#[derive(Debug, Default)]
pub struct BookmarkSender {
    facts: Option<SyncSender<Fact>>,
    queue: LastBacklog,
}

impl BookmarkSender {
    /// Passes on the facts of a step that may become bookmarks.
    pub fn note(&self, facts: &[Fact]) {
        let Some(send) = &self.facts else { return };
        for fact in facts.iter().filter(|fact| is_notable(fact)) {
            let _ = send.try_send(fact.clone());
        }
    }

    /// Waiting jobs for the next frame; empty if no past is kept.
    pub fn backlog(&mut self, fleet: &Fleet, now: Time) -> Arc<Backlog> {
        self.facts.as_ref().map_or_else(Arc::default, |_| self.queue.of(fleet, now))
    }
}

/// The recordings that are kept, or none.
#[derive(Default)]
pub struct KeptPast {
    /// The folder of recordings.
    pub folder: Option<Arc<Folder>>,
    /// The loop's end.
    pub tap: BookmarkSender,
    /// Ends with the thread that writes.
    pub ended: Option<oneshot::Receiver<()>>,
}

impl KeptPast {
    /// Begins to keep recordings in a folder, if wanted; the thread ends when the tap is dropped. If they cannot be
    /// kept, only the log says so.
    pub fn keep(
        wanted: Option<(PathBuf, Limits)>,
        map: &Arc<Warehouse>,
        live: &Arc<Live>,
        clock: &Arc<Clock>,
        alarms: &Arc<Alarms>,
    ) -> KeptPast {
        let Some((path, limits)) = wanted else { return KeptPast::default() };
        let begin = || -> io::Result<KeptPast> {
            let folder = Folder::open(path.clone(), map.clone(), map.name.clone(), Some(clock.started()))?;
            let folder = Arc::new(folder);
            let (send, facts) = sync_channel(WAITING);
            let rotation = Rotation::new(folder.clone(), limits);
            let (live, clock, alarms) = (live.clone(), clock.clone(), alarms.clone());
            let keeper = Keeper { rotation, live, clock, alarms, rest: None };
            let (end, ended) = oneshot::channel();
            let write = move || {
                keeper.run(&facts);
                let _ = end.send(());
            };
            std::thread::Builder::new().name("past".into()).spawn(write)?;
            let tap = BookmarkSender { facts: Some(send), queue: LastBacklog::default() };
            Ok(KeptPast { folder: Some(folder), tap, ended: Some(ended) })
        };
        begin().unwrap_or_else(|e| {
            let text = sentence::past_not_begun(format!("{}: {e}", path.display()));
            alarms.raise(AlarmKind::PastNotKept, text, clock.now());
            KeptPast::default()
        })
    }
}

struct Keeper {
    rotation: Rotation,
    live: Arc<Live>,
    clock: Arc<Clock>,
    alarms: Arc<Alarms>,
    /// Until when nothing is written, since the disk refused.
    rest: Option<Time>,
}

impl Keeper {
    fn run(mut self, facts: &Receiver<Fact>) {
        let mut due = self.clock.now();
        loop {
            let wait = (due - self.clock.now()).0.max(0).unsigned_abs();
            match facts.recv_timeout(Duration::from_micros(wait)) {
                Ok(fact) => self.rotation.note(&fact),
                Err(RecvTimeoutError::Timeout) => {
                    due = self.clock.now() + EVERY;
                    self.take_frame();
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        if let Err(e) = self.rotation.finish() {
            tracing::error!("the last frames of the past were not written: {e}");
        }
    }

    fn take_frame(&mut self) {
        let now = self.clock.now();
        if self.rest.is_some_and(|until| now < until) {
            return;
        }
        let Some(frame) = self.live.frame() else { return };
        match self.rotation.take(&frame) {
            Ok(()) if self.rest.take().is_some() => {
                self.alarms.clear(AlarmKind::PastNotKept, now);
                tracing::info!("the past is kept again");
            }
            Ok(()) => {}
            Err(e) => {
                let text = sentence::past_not_kept(e.to_string());
                self.alarms.raise(AlarmKind::PastNotKept, text, now);
                self.rest = Some(now + REST);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_api::Moment;
    use giveway_fleet::Settings;
    use giveway_floor::warehouse::lab;
    use std::fs;

    #[test]
    fn a_disk_that_takes_no_more_is_an_alarm_until_it_does_again() {
        let path = std::env::temp_dir().join(format!("giveway-past-{}", std::process::id()));
        let (map, clock, alarms) =
            (Arc::new(lab()), Arc::new(Clock::start(None)), Arc::new(Alarms::default()));
        let live = Arc::new(Live::new(map.clone(), 1));
        let view = Fleet::new(map.clone(), Settings::default()).view(Time::ZERO);
        live.publish(&Moment { view, ..Moment::default() }, &[], 0.0);
        let folder = Arc::new(Folder::open(path.clone(), map, "lab".into(), None).unwrap());
        let rotation = Rotation::new(folder, Limits { age_s: 60.0, bytes: 1 << 20 });
        let mut keeper = Keeper { rotation, live, clock: clock.clone(), alarms: alarms.clone(), rest: None };
        let standing = || alarms.of_kind(AlarmKind::PastNotKept).map(|a| a.text.to_string());
        // A file in the place of the folder makes every write fail.
        fs::remove_dir_all(&path).unwrap();
        fs::write(&path, "in the way").unwrap();
        keeper.take_frame();
        let said = standing().expect("an alarm stands");
        assert!(said.contains("the past is not kept") && said.contains("The fleet goes on"), "{said}");
        fs::remove_file(&path).unwrap();
        fs::create_dir(&path).unwrap();
        keeper.take_frame();
        assert!(standing().is_some(), "it rests before it tries again");
        keeper.rest = Some(clock.now());
        keeper.take_frame();
        assert_eq!(standing(), None);
        fs::remove_dir_all(&path).unwrap();
    }
}
