//! Reels and pages of a run that is stepped here.
//!
//! Main types: [`Reeler`]; [`write_page`]. Refuses: to leave a page without its reel.

use crate::api::reel::{Out, Reel, page};
use crate::fleet::{Fact, Fleet};
use crate::server::Film;
use crate::time::Time;
use anyhow::Context;
use std::path::{Path, PathBuf};

/// A reel being made.
pub struct Reeler {
    film: Film,
    reel: Reel,
    out: Out,
    path: PathBuf,
    page: Option<PathBuf>,
    /// Whether the reel was only wanted for the page.
    passing: bool,
}

impl Reeler {
    /// Begins a reel, where a reel or a page is wanted.
    pub fn create(
        reel: Option<&Path>,
        page: Option<&Path>,
        fleet: &Fleet,
        name: String,
    ) -> anyhow::Result<Option<Reeler>> {
        let path = match (reel, page) {
            (Some(reel), _) => reel.to_path_buf(),
            (None, Some(page)) => page.with_extension("reel.tmp"),
            (None, None) => return Ok(None),
        };
        let mut out = Out::create(&path).with_context(|| format!("cannot write {}", path.display()))?;
        let film = Film::default();
        let mut reel_of = Reel::new(fleet.warehouse().clone(), name, None);
        out.put(&reel_of.header())?;
        let page = page.map(Path::to_path_buf);
        Ok(Some(Reeler { film, reel: reel_of, out, path, page, passing: reel.is_none() }))
    }

    /// Takes a step.
    pub fn step(&mut self, fleet: &Fleet, now: Time, facts: &[Fact]) -> anyhow::Result<()> {
        facts.iter().for_each(|fact| self.reel.note(fact));
        let shot = self.film.shoot(fleet, now).and_then(|frame| self.reel.picture(&frame));
        if let Some(shot) = shot {
            self.out.put(&shot.lines).with_context(|| format!("cannot write to {}", self.path.display()))?;
        }
        Ok(())
    }

    /// Ends the reel, and makes the page of it.
    pub fn finish(self) -> anyhow::Result<()> {
        self.out.finish().with_context(|| format!("cannot write to {}", self.path.display()))?;
        let written = self.page.map_or(Ok(()), |page| write_page(&page, &self.path));
        if self.passing {
            std::fs::remove_file(&self.path)?;
        }
        written
    }
}

/// Writes a page with a reel in it.
pub fn write_page(path: &Path, reel: &Path) -> anyhow::Result<()> {
    let bytes = std::fs::read(reel).with_context(|| format!("cannot read {}", reel.display()))?;
    let title = path.file_stem().unwrap_or_default().to_string_lossy();
    let text = page(&title, &bytes).context(
        "the web page was not built into this program: install Node 20 or newer with npm and build again",
    )?;
    super::write(Some(path), &text)
}
