//! Recording files, compressed or not.
//!
//! Main types: [`RecordingWriter`], [`create`], [`open`]. Refuses: to leave half a file behind without an error.

use anyhow::Context;
use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A recording in progress.
pub struct RecordingWriter {
    path: PathBuf,
    out: RecordingOut,
}

enum RecordingOut {
    Plain(BufWriter<File>),
    Packed(GzEncoder<BufWriter<File>>),
}

fn is_packed(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "gz")
}

/// Begins a recording.
pub fn create(path: &Path) -> anyhow::Result<RecordingWriter> {
    let file = File::create(path).with_context(|| format!("cannot write {}", path.display()))?;
    let file = BufWriter::new(file);
    let out = if is_packed(path) {
        RecordingOut::Packed(GzEncoder::new(file, Compression::fast()))
    } else {
        RecordingOut::Plain(file)
    };
    Ok(RecordingWriter { path: path.to_path_buf(), out })
}

impl RecordingWriter {
    /// Writes a line.
    pub fn write(&mut self, line: &str) -> anyhow::Result<()> {
        let written = match &mut self.out {
            RecordingOut::Plain(f) => f.write_all(line.as_bytes()),
            RecordingOut::Packed(f) => f.write_all(line.as_bytes()),
        };
        written.with_context(|| format!("cannot write to {}", self.path.display()))
    }

    /// Makes sure that everything is written.
    pub fn finish(self) -> anyhow::Result<()> {
        let done = match self.out {
            RecordingOut::Plain(mut f) => f.flush(),
            RecordingOut::Packed(f) => f.finish().and_then(|mut f| f.flush()),
        };
        done.with_context(|| format!("cannot write to {}", self.path.display()))
    }
}

/// Opens a recording for reading, line by line.
pub fn open(path: &Path) -> anyhow::Result<Box<dyn BufRead + Send>> {
    let file = File::open(path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(match is_packed(path) {
        true => Box::new(BufReader::new(MultiGzDecoder::new(file))),
        false => Box::new(BufReader::new(file)),
    })
}
