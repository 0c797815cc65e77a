//! A folder of recordings: which times it covers, and cutting spans out of it.
//!
//! Main types: [`Folder`], [`Piece`] (one file), [`PastSpan`] (what is kept), [`Cut`]. Seconds count from the start of
//! the current run; earlier runs are before 0. Each file has an index beside it, which is rebuilt if it is missing.
//! Refuses: to keep frames in memory.

use super::{Limits, Mark, Out, RecordedFrame, RunningTotals, Sum, header, lines, split};
use crate::wire::text::round3;
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard};

/// Files with a shorter gap than this between them form one span, seconds.
const SEAM_S: f64 = 2.0;

/// The most bookmarks of one file that the index has; further ones are only in the file.
const MOST_MARKS: usize = 5000;

/// A folder of recordings.
pub struct Folder {
    /// The building.
    pub map: Arc<Warehouse>,
    /// The name of the floor.
    pub name: String,
    /// The time of day at which the seconds are zero; nothing in a simulation.
    pub start: Option<Time>,
    path: PathBuf,
    pieces: Mutex<Vec<Piece>>,
}

/// One recording file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Piece {
    #[serde(skip)]
    path: PathBuf,
    /// The start of the file's run, seconds since 1970.
    start: Option<f64>,
    from_s: f64,
    to_s: f64,
    marks: Vec<Mark>,
    /// Empty for files of versions before this one.
    #[serde(default)]
    sums: Vec<Sum>,
}

/// What is kept of the past, in seconds from the start.
#[derive(Debug, Default, PartialEq)]
pub struct PastSpan {
    /// Start and end of each span with frames, in order.
    pub spans: Vec<(f64, f64)>,
    /// The bookmarks in these spans, in order.
    pub marks: Vec<Mark>,
}

/// A span to cut out of the recordings.
pub struct Cut {
    head: String,
    pieces: Vec<(PathBuf, f64)>,
    from_s: f64,
    to_s: f64,
}

impl Folder {
    /// Opens a folder and reads its files' indexes; creates the folder if it is missing.
    ///
    /// # Errors
    /// If the folder cannot be read.
    pub fn open(path: PathBuf, map: Arc<Warehouse>, name: String, start: Option<Time>) -> io::Result<Folder> {
        std::fs::create_dir_all(&path)?;
        let mut files: Vec<PathBuf> = std::fs::read_dir(&path)?
            .flatten()
            .map(|entry| entry.path())
            .filter(|file| file.extension().is_some_and(|e| e == "reel"))
            .collect();
        files.sort();
        let pieces = files.iter().filter_map(|file| Piece::open(file)).collect();
        Ok(Folder { map, name, start, path, pieces: Mutex::new(pieces) })
    }

    /// All spans, and the bookmarks between two times.
    pub fn past(&self, from_s: f64, to_s: f64) -> PastSpan {
        let mut past = PastSpan::default();
        for piece in self.pieces().iter() {
            let shift = self.shift(piece);
            let (from, to) = (round3(piece.from_s + shift), round3(piece.to_s + shift));
            match past.spans.last_mut() {
                Some(last) if from - last.1 < SEAM_S => last.1 = last.1.max(to),
                _ => past.spans.push((from, to)),
            }
            let moved = piece.marks.iter().map(|m| m.moved(shift));
            past.marks.extend(moved.filter(|m| (from_s..=to_s).contains(&m.at_s)));
        }
        past.marks.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        past
    }

    /// The sums between two times, including the last one before and the first one after, in order.
    pub fn sums(&self, from_s: f64, to_s: f64) -> Vec<Sum> {
        let mut all: Vec<Sum> = Vec::new();
        for piece in self.pieces().iter() {
            let shift = self.shift(piece);
            all.extend(piece.sums.iter().map(|s| Sum { at_s: round3(s.at_s + shift), ..*s }));
        }
        all.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        let first = all.partition_point(|s| s.at_s < from_s).saturating_sub(1);
        let end = all.len().min(all.partition_point(|s| s.at_s <= to_s) + 1);
        all[first.min(end)..end].to_vec()
    }

    /// A span to cut out; nothing if no file has frames of it.
    pub fn cut(&self, from_s: f64, to_s: f64, with_map: bool) -> Option<Cut> {
        let marks = self.past(from_s, to_s).marks;
        let pieces = self.pieces();
        let within = |p: &&Piece| p.from_s + self.shift(p) <= to_s && p.to_s + self.shift(p) >= from_s;
        let pieces: Vec<_> = pieces.iter().filter(within).map(|p| (p.path.clone(), self.shift(p))).collect();
        let mut head = header(&self.name, self.start, with_map.then_some(&*self.map));
        for mark in marks {
            head += &format!("{{\"at\":{},\"mark\":{}}}\n", mark.at_s, serde_json::json!(mark));
        }
        (!pieces.is_empty()).then_some(Cut { head, pieces, from_s, to_s })
    }

    /// Begins a file.
    pub(super) fn begin(&self, at_s: f64) -> io::Result<Out> {
        std::fs::create_dir_all(&self.path)?;
        let name = self.start.and_then(|start| {
            let at = jiff::Timestamp::from_microsecond(start.0 + (at_s * 1e6) as i64).ok()?;
            Some(at.strftime("%Y-%m-%dT%H-%M-%S.%3fZ").to_string())
        });
        let path = self.path.join(format!("{}.reel", name.unwrap_or_else(|| format!("{at_s:012.3}"))));
        let start = self.start.map(|start| round3(start.as_secs_f64()));
        let out = Out::create(&path)?;
        let piece = Piece { path, start, from_s: at_s, to_s: at_s, marks: Vec::new(), sums: Vec::new() };
        self.pieces().push(piece);
        Ok(out)
    }

    /// Deletes the last file if no more than one of its frames can be read.
    pub(super) fn forget_empty(&self) {
        let mut pieces = self.pieces();
        if let Some(empty) = pieces.pop_if(|piece| piece.to_s <= piece.from_s) {
            let _ = std::fs::remove_file(empty.path);
        }
    }

    /// Adds new lines' bookmarks and sums to the last file's entry.
    pub(super) fn grow(&self, news: RecordedFrame) {
        if let Some(piece) = self.pieces().last_mut() {
            piece.to_s = news.at_s;
            let room = MOST_MARKS.saturating_sub(piece.marks.len());
            piece.marks.extend(news.marks.into_iter().take(room));
            piece.sums.extend(news.sums);
        }
    }

    /// The last file.
    pub(super) fn last(&self) -> Option<Piece> {
        self.pieces().last().cloned()
    }

    /// Deletes the oldest files that are beyond the limits.
    pub(super) fn prune(&self, now_s: f64, limits: Limits) {
        let mut pieces = self.pieces();
        let size = |p: &Piece| std::fs::metadata(&p.path).map_or(0, |m| m.len());
        let mut sum: u64 = pieces.iter().map(size).sum();
        let mut old = 0;
        for piece in pieces.iter() {
            if piece.to_s + self.shift(piece) >= now_s - limits.age_s && sum <= limits.bytes {
                break;
            }
            sum -= size(piece);
            for path in [piece.path.clone(), piece.index()] {
                if let Err(e) = std::fs::remove_file(&path) {
                    tracing::debug!("{}: {e}", path.display());
                }
            }
            old += 1;
        }
        pieces.drain(..old);
    }

    /// Seconds to add to a file's times to get times of the current run.
    fn shift(&self, piece: &Piece) -> f64 {
        match (piece.start, self.start) {
            (Some(then), Some(now)) => then - round3(now.as_secs_f64()),
            _ => 0.0,
        }
    }

    fn pieces(&self) -> MutexGuard<'_, Vec<Piece>> {
        self.pieces.lock().expect("nobody panics with this lock")
    }
}

impl Piece {
    /// A file's entry, from its index or by reading the file; nothing if it has no frame.
    fn open(path: &Path) -> Option<Piece> {
        let index = |text: String| serde_json::from_str::<Piece>(&text).ok();
        let known = std::fs::read_to_string(path.with_extension("json")).ok().and_then(index);
        if let Some(piece) = known {
            return Some(Piece { path: path.into(), ..piece });
        }
        let piece = Piece::scan(path);
        match &piece {
            Some(piece) => {
                if let Err(e) = piece.write_index() {
                    tracing::warn!("{}: {e}", piece.index().display());
                }
            }
            None => tracing::warn!("{} contains no frame and is ignored", path.display()),
        }
        piece
    }

    fn scan(path: &Path) -> Option<Piece> {
        let mut lines = lines(path).ok()?;
        let head: serde_json::Value = serde_json::from_str(&lines.next()?).ok()?;
        head.get("reel")?;
        let start = head["start"].as_f64();
        let (mut from_s, mut to_s) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut marks, mut sums) = (Vec::new(), Vec::new());
        for line in lines {
            let Some((at, rest)) = split(&line) else { continue };
            match rest.strip_suffix('}').and_then(|rest| rest.split_once(':')) {
                Some(("\"mark\"", mark)) => marks.extend(serde_json::from_str::<Mark>(mark).ok()),
                Some(("\"sum\"", sum)) => {
                    sums.extend(
                        serde_json::from_str::<RunningTotals>(sum).ok().map(|tally| Sum { at_s: at, tally }),
                    );
                }
                Some(("\"key\"" | "\"patch\"", _)) => (from_s, to_s) = (from_s.min(at), to_s.max(at)),
                _ => {}
            }
        }
        (from_s <= to_s).then(|| Piece { path: path.into(), start, from_s, to_s, marks, sums })
    }

    fn index(&self) -> PathBuf {
        self.path.with_extension("json")
    }

    /// Writes the file's index, so that the next start need not read the whole file.
    pub(super) fn write_index(&self) -> io::Result<()> {
        std::fs::write(self.index(), serde_json::to_string(self).expect("plain"))
    }
}

impl Cut {
    /// Passes on every line, from the last key frame before the span to its end, until `put` returns false.
    pub fn each(self, mut put: impl FnMut(&str) -> bool) {
        if !put(&self.head) {
            return;
        }
        // Lines from the last key frame to the beginning of the span.
        let mut held = String::new();
        for (path, shift) in &self.pieces {
            let Ok(lines) = lines(path) else { continue };
            held.clear();
            for line in lines {
                let Some((at, rest)) = split(&line) else { continue };
                let at = round3(at + shift);
                if at > self.to_s {
                    put(&held);
                    return;
                }
                let whole = rest.starts_with("\"key\":");
                if rest.starts_with("\"mark\":") {
                    continue;
                }
                if whole && at <= self.from_s {
                    held.clear();
                }
                held += &format!("{{\"at\":{at},{rest}\n");
                if at > self.from_s && !put(&std::mem::take(&mut held)) {
                    return;
                }
            }
            if !put(&held) {
                return;
            }
        }
    }
}
