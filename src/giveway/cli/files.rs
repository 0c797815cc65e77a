//! Files that commands read and write.
//!
//! Main functions: [`read`], [`write()`], [`read_map`], [`read_model`], [`read_pick_model`]. Refuses: errors that do
//! not name their file.

use super::out;
use anyhow::Context;
use giveway_floor::warehouse::{Warehouse, formats};
use giveway_people::human::Model;
use giveway_people::reach::PickModel;
use std::path::Path;
use std::sync::Arc;

/// Reads a text file; an error names the file. However a program wrote the file, the text has no byte order mark and
/// its lines end with LF.
pub fn read(path: &Path) -> anyhow::Result<String> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let text = String::from_utf8(bytes);
    let text = text.with_context(|| format!("{} is not text in UTF-8: save it as UTF-8", path.display()))?;
    Ok(text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n"))
}

/// Writes a text file, or to standard output if no path is given.
pub fn write(path: Option<&Path>, text: &str) -> anyhow::Result<()> {
    match path {
        Some(path) => std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display())),
        None => {
            out::bytes(text.as_bytes());
            Ok(())
        }
    }
}

/// Reads a map of any known format; notes of an import go to standard error.
pub fn read_map(path: &Path) -> anyhow::Result<Arc<Warehouse>> {
    let (warehouse, notes) = formats::import(&read(path)?, &formats::Options::default())
        .map_err(|e| anyhow::anyhow!("{} is refused:\n{e}", path.display()))?;
    notes.0.iter().for_each(|n| eprintln!("note: {n}"));
    Ok(Arc::new(warehouse))
}

/// Reads a model; the built-in one if no path is given.
pub fn read_model(path: Option<&Path>) -> anyhow::Result<Arc<Model>> {
    path.map_or_else(
        || Ok(Model::builtin()),
        |p| {
            let model = Model::parse(&read(p)?).with_context(|| format!("{} is refused", p.display()))?;
            Ok(Arc::new(model))
        },
    )
}

/// Reads what was learned about pickers.
pub fn read_pick_model(path: &Path) -> anyhow::Result<Arc<PickModel>> {
    let model = PickModel::parse(&read(path)?);
    Ok(Arc::new(model.with_context(|| format!("{} is refused", path.display()))?))
}
