//! One recording file: compressed lines, readable up to the place where the file was cut off.
//!
//! Main types: [`Out`]; [`lines`] reads. Refuses: to call a file broken that merely ends too soon, as a killed server
//! leaves it behind.

use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::path::Path;

/// A recording that is being written.
pub struct Out(GzEncoder<BufWriter<File>>);

impl Out {
    /// Begins a file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(path: &Path) -> io::Result<Out> {
        Ok(Out(GzEncoder::new(BufWriter::new(File::create(path)?), Compression::fast())))
    }

    /// Writes lines.
    ///
    /// # Errors
    /// If the disk is full or fails.
    pub fn put(&mut self, lines: &str) -> io::Result<()> {
        self.0.write_all(lines.as_bytes())
    }

    /// Makes everything so far readable.
    ///
    /// # Errors
    /// If the disk is full or fails.
    pub fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }

    /// Ends the file.
    ///
    /// # Errors
    /// If the disk is full or fails.
    pub fn finish(self) -> io::Result<()> {
        self.0.finish()?.flush()
    }
}

/// The lines of a recording, up to its end or to where it was cut off.
///
/// # Errors
/// If the file cannot be opened.
pub fn lines(path: &Path) -> io::Result<impl Iterator<Item = String> + use<>> {
    let mut file = BufReader::new(File::open(path)?);
    let packed = file.fill_buf()?.starts_with(&[0x1f, 0x8b]);
    let text: Box<dyn Read> = if packed { Box::new(MultiGzDecoder::new(file)) } else { Box::new(file) };
    let mut text = BufReader::new(text);
    Ok(std::iter::from_fn(move || {
        let mut line = String::new();
        // A line without its line break is where the file was cut off.
        let whole = text.read_line(&mut line).is_ok() && line.ends_with('\n');
        whole.then(|| line.trim_end().to_owned())
    }))
}

/// Whether a file begins like a recording.
pub fn is_reel(path: &Path) -> bool {
    lines(path).ok().and_then(|mut lines| lines.next()).is_some_and(|line| line.starts_with("{\"reel\":"))
}
