//! Recordings and pages of a run that this process steps.
//!
//! Main types: [`FrameWriter`]; [`write_page`]. Refuses: to leave a page without its recording.

use crate::server::FrameRecorder;
use anyhow::Context;
use giveway_api::page::single_file::page;
use giveway_api::recording::{Out, Recording};
use giveway_fleet::{Fact, Fleet};
use giveway_floor::time::Time;
use std::path::{Path, PathBuf};

/// A recording in progress.
pub struct FrameWriter {
    record: FrameRecorder,
    recording: Recording,
    out: Out,
    path: PathBuf,
    page: Option<PathBuf>,
    /// Whether the recording is only wanted for the page.
    passing: bool,
}

impl FrameWriter {
    /// Begins a recording, if a recording or a page is wanted.
    pub fn create(
        recording: Option<&Path>,
        page: Option<&Path>,
        fleet: &Fleet,
        name: String,
    ) -> anyhow::Result<Option<FrameWriter>> {
        let path = match (recording, page) {
            (Some(recording), _) => recording.to_path_buf(),
            (None, Some(page)) => page.with_extension("reel.tmp"),
            (None, None) => return Ok(None),
        };
        let mut out = Out::create(&path).with_context(|| format!("cannot write {}", path.display()))?;
        let record = FrameRecorder::default();
        let mut reel_of = Recording::new(fleet.warehouse().clone(), name, None);
        out.put(&reel_of.header())?;
        let page = page.map(Path::to_path_buf);
        Ok(Some(FrameWriter { record, recording: reel_of, out, path, page, passing: recording.is_none() }))
    }

    /// Adds a step.
    pub fn step(&mut self, fleet: &Fleet, now: Time, facts: &[Fact]) -> anyhow::Result<()> {
        facts.iter().for_each(|fact| self.recording.note(fact));
        let frame = self.record.take_frame(fleet, now).and_then(|frame| self.recording.add(&frame));
        if let Some(frame) = frame {
            self.out.put(&frame.lines).with_context(|| format!("cannot write to {}", self.path.display()))?;
        }
        Ok(())
    }

    /// Ends the recording, and writes its page if wanted.
    pub fn finish(self) -> anyhow::Result<()> {
        self.out.finish().with_context(|| format!("cannot write to {}", self.path.display()))?;
        let written = self.page.map_or(Ok(()), |page| write_page(&page, &self.path));
        if self.passing {
            std::fs::remove_file(&self.path)?;
        }
        written
    }
}

/// Writes a page with a recording in it.
pub fn write_page(path: &Path, recording: &Path) -> anyhow::Result<()> {
    let bytes = std::fs::read(recording).with_context(|| format!("cannot read {}", recording.display()))?;
    let title = path.file_stem().unwrap_or_default().to_string_lossy();
    let text = page(&title, &bytes).context(
        "the web page was not built into this program: install Node 20 or newer with npm and build again",
    )?;
    super::files::write(Some(path), &text)
}
