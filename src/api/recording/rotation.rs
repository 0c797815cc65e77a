//! Writes a folder of recordings: a new file every few minutes; old files are deleted.
//!
//! Main types: [`Rotation`], [`Limits`]. Refuses: to keep more than the last frame in memory, and to grow without limit
//! on the disk.

use super::folder::Piece;
use super::{Folder, Out, RecordedFrame, Recording};
use crate::live::Frame;
use giveway_fleet::Fact;
use std::io;
use std::sync::Arc;

/// Length of one file, seconds.
const PIECE_S: f64 = 600.0;

/// The longest stretch that is lost if the program is killed, seconds.
const FLUSH_EVERY_S: f64 = 2.0;

/// How much of the past is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Nothing older than this is kept, seconds.
    pub age_s: f64,
    /// No more than this is kept, bytes on disk.
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
    /// Continues writing a folder.
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

    /// Notes a fact that may become a bookmark.
    pub fn note(&mut self, fact: &Fact) {
        self.recording.note(fact);
    }

    /// Writes a frame.
    ///
    /// # Errors
    /// If the disk is full or fails; flushed data stays, and the next frame begins a new file.
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
    /// If the disk is full or fails.
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

    /// Makes what was flushed available to readers.
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
