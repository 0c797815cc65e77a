//! Writing a folder of recordings: a new file every few minutes, old ones deleted.
//!
//! Main types: [`Rotation`], [`Limits`]. Refuses: to keep anything in memory but the last frame, and to grow without
//! bound on the disk.

use super::folder::Piece;
use super::{Folder, Out, RecordedFrame, Recording};
use crate::live::Frame;
use giveway_fleet::Fact;
use std::io;
use std::sync::Arc;

/// How long one file is.
const PIECE_S: f64 = 600.0;

/// How much of the past is lost at most when the program is killed.
const FLUSH_EVERY_S: f64 = 2.0;

/// How much of the past is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Nothing older than this, seconds.
    pub age_s: f64,
    /// Not more than this, bytes on disk.
    pub bytes: u64,
}

/// Writes a folder.
pub struct Rotation {
    folder: Arc<Folder>,
    limits: Limits,
    recording: Recording,
    out: Option<Out>,
    began_s: f64,
    flushed_s: f64,
    pending: RecordedFrame,
}

impl Rotation {
    /// Goes on writing a folder.
    pub fn new(folder: Arc<Folder>, limits: Limits) -> Rotation {
        let recording = Recording::new(folder.map.clone(), folder.name.clone(), folder.start);
        Rotation {
            folder,
            limits,
            recording,
            out: None,
            began_s: 0.0,
            flushed_s: 0.0,
            pending: RecordedFrame::default(),
        }
    }

    /// Takes notice of a fact.
    pub fn note(&mut self, fact: &Fact) {
        self.recording.note(fact);
    }

    /// Takes a frame.
    ///
    /// # Errors
    /// Where the disk takes no more; what was flushed stays, and the next frame begins a new file.
    pub fn take(&mut self, frame: &Arc<Frame>) -> io::Result<()> {
        let taken = self.try_take(frame);
        if taken.is_err() {
            self.out = None;
            self.folder.forget_empty();
        }
        taken
    }

    /// Ends the last file.
    ///
    /// # Errors
    /// Where the disk takes no more.
    pub fn finish(mut self) -> io::Result<()> {
        self.close()
    }

    fn try_take(&mut self, frame: &Arc<Frame>) -> io::Result<()> {
        if self.out.is_some() && frame.time_s - self.began_s >= PIECE_S {
            self.close()?;
        }
        let fresh = self.out.is_none();
        let header = if fresh { self.recording.header() } else { String::new() };
        let Some(frame) = self.recording.add(frame) else { return Ok(()) };
        if fresh {
            (self.began_s, self.flushed_s) = (frame.at_s, frame.at_s);
            self.folder.prune(frame.at_s, self.limits);
            self.out = Some(self.folder.begin(frame.at_s)?);
        }
        let Some(out) = &mut self.out else { return Ok(()) };
        out.put(&header)?;
        out.put(&frame.lines)?;
        self.pending.at_s = frame.at_s;
        self.pending.marks.extend(frame.marks);
        self.pending.sums.extend(frame.sums);
        if fresh || frame.at_s - self.flushed_s >= FLUSH_EVERY_S {
            self.flushed_s = frame.at_s;
            out.flush()?;
            self.tell();
        }
        Ok(())
    }

    /// Lets readers know what there is.
    fn tell(&mut self) {
        let news = std::mem::take(&mut self.pending);
        self.pending.at_s = news.at_s;
        self.folder.grow(news);
    }

    fn close(&mut self) -> io::Result<()> {
        let Some(out) = self.out.take() else { return Ok(()) };
        out.finish()?;
        self.tell();
        self.folder.last().as_ref().map_or(Ok(()), Piece::write_index)
    }
}
