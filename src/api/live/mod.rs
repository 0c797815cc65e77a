//! The live feed: a snapshot, then patches with base and version, each encoded once for all clients.
//!
//! Main types: [`Live`], [`FeedReader`]. [`Live::publish`] compares the new frame with the last one and writes one
//! patch for each format that has readers; readers fetch what they lack by version, so that a slow reader costs nothing
//! but its own fresh snapshot. Versions start above those of every earlier run, so that a reader that resumes after a
//! restart gets a snapshot. Refuses: a queue per reader, an encoding per reader, and work for formats without readers.

mod forecast;
mod frame;
pub(super) mod thin;

pub use forecast::ForecastDto;
pub use frame::Frame;

use crate::dto::building::map_version;
use crate::port::moment::Moment;
use axum::extract::ws::{Message, Utf8Bytes};
use bytes::Bytes;
use flate2::Compression;
use flate2::write::GzEncoder;
use giveway_fleet::alarm::Alarm;
use giveway_floor::warehouse::Warehouse;
use std::collections::VecDeque;
use std::io::Write;
use std::sync::{Arc, Mutex, MutexGuard};
use tokio::sync::watch;

/// How many patches are kept for readers that resume: half a minute of them.
const KEPT: usize = 300;

/// A reader that falls behind by more versions than this while it reads gets a snapshot: five seconds.
pub const LAGGING: u64 = 50;

/// The formats that a reader wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeedReader {
    /// The format of patches.
    pub patches: PatchFormat,
    /// The format of snapshots.
    pub snapshots: SnapshotFormat,
}

/// The format of snapshots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SnapshotFormat {
    /// A text message.
    Text,
    /// A binary message: the text compressed with gzip, about a tenth of the bytes.
    Gzip,
}

/// The format of patches. Snapshots are the same for both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchFormat {
    /// Rows by name, for programs that want a simple start.
    Plain,
    /// Numbers by row, for dashboards: about a tenth of the bytes.
    Thin,
}

/// The last patches of one format.
#[derive(Debug, Default)]
struct RecentPatches {
    patches: VecDeque<Utf8Bytes>,
    /// The version when a reader last read.
    read: Option<u64>,
}

#[derive(Debug)]
struct LiveState {
    version: u64,
    frame: Arc<Frame>,
    snapshot: Option<Utf8Bytes>,
    packed: Option<Bytes>,
    plain: RecentPatches,
    thin: RecentPatches,
}

/// The live feed.
#[derive(Debug)]
pub struct Live {
    map: Arc<Warehouse>,
    /// The version of the map: a reader that resumes learns whether the map is still the same.
    map_version: String,
    state: Mutex<LiveState>,
    newest: watch::Sender<u64>,
}

impl Live {
    /// A feed whose first version is `first`, which no earlier run may have reached.
    pub fn new(map: Arc<Warehouse>, first: u64) -> Live {
        let state = LiveState {
            version: first,
            frame: Arc::default(),
            snapshot: None,
            packed: None,
            plain: RecentPatches::default(),
            thin: RecentPatches::default(),
        };
        Live {
            map_version: map_version(&map),
            map,
            state: Mutex::new(state),
            newest: watch::Sender::new(first),
        }
    }

    /// Announces every new version.
    pub fn subscribe(&self) -> watch::Receiver<u64> {
        self.newest.subscribe()
    }

    /// Publishes the frame of a new moment. Only one thread may publish; readers do not wait while it writes patches.
    pub fn publish(&self, moment: &Moment, alarms: &[Alarm], started_s: f64) {
        let new = Arc::new(Frame::of(&self.map, moment, alarms, started_s));
        let (old, base, plain, thin) = {
            let state = self.state();
            let wanted =
                |kept: &RecentPatches| kept.read.is_some_and(|read| read + KEPT as u64 > state.version);
            (state.frame.clone(), state.version, wanted(&state.plain), wanted(&state.thin))
        };
        let plain = plain.then(|| old.patch(&new, base).to_string().into());
        let thin = thin.then(|| thin::patch(&old, &new, base).to_string().into());
        let mut state = self.state();
        state.plain.push(plain);
        state.thin.push(thin);
        state.version = base + 1;
        state.frame = new;
        state.snapshot = None;
        state.packed = None;
        drop(state);
        self.newest.send_replace(base + 1);
    }

    /// What a reader at version `since` lacks, and the version that it then has: patches if there are at most `most` of
    /// them, else a snapshot.
    pub fn after(&self, reader: FeedReader, since: Option<u64>, most: u64) -> (Vec<Message>, u64) {
        let mut state = self.state();
        let version = state.version;
        let missing = since.and_then(|s| version.checked_sub(s));
        let kept = match reader.patches {
            PatchFormat::Plain => &mut state.plain,
            PatchFormat::Thin => &mut state.thin,
        };
        kept.read = Some(version);
        let most = most.min(kept.patches.len() as u64);
        if let Some(missing) = missing.filter(|m| *m <= most) {
            let skip = kept.patches.len() - missing as usize;
            return (kept.patches.iter().skip(skip).cloned().map(Message::Text).collect(), version);
        }
        let LiveState { frame, snapshot, packed, .. } = &mut *state;
        let whole = || {
            let mut whole = frame.snapshot(version);
            whole["map"] = self.map_version.as_str().into();
            whole.to_string().into()
        };
        let text = snapshot.get_or_insert_with(whole);
        let message = match reader.snapshots {
            SnapshotFormat::Text => Message::Text(text.clone()),
            SnapshotFormat::Gzip => Message::Binary(packed.get_or_insert_with(|| gzip(text)).clone()),
        };
        (vec![message], version)
    }

    /// The latest frame; nothing before the first one was published.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        let state = self.state();
        (!state.frame.counters.is_null()).then(|| state.frame.clone())
    }

    /// How many patches back a reader may resume.
    pub fn kept(&self) -> u64 {
        KEPT as u64
    }

    fn state(&self) -> MutexGuard<'_, LiveState> {
        self.state.lock().expect("nobody panics with this lock")
    }
}

impl RecentPatches {
    /// Adds a patch. If a patch is missing, no reader can continue from before it, so the kept ones are dropped.
    fn push(&mut self, patch: Option<Utf8Bytes>) {
        let Some(patch) = patch else {
            self.patches.clear();
            return;
        };
        self.patches.push_back(patch);
        if self.patches.len() > KEPT {
            self.patches.pop_front();
        }
    }
}

#[cfg(test)]
mod tests;

fn gzip(text: &str) -> Bytes {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(text.as_bytes()).expect("memory takes what is written");
    packed.finish().expect("memory takes what is written").into()
}
