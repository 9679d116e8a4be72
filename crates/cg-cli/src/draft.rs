//! A text file that is written whole or not at all.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, anyhow};
use cg_vehicle::draft;

/// A file beside its place, whole; dropped before it is published, it removes itself.
pub(crate) struct Draft {
    draft: Option<draft::Draft>,
    target: String,
}

impl Draft {
    /// Writes `text` beside `target`, which was given with `flag`.
    pub(crate) fn write(target: &Path, flag: &str, text: &str) -> anyhow::Result<Self> {
        let name = target.display().to_string();
        if target.is_dir() {
            return Err(anyhow!("{name}: is a folder; give {flag} a file"));
        }
        let remedy = || format!("{name}: cannot be written; check the folder and its permissions");
        let (draft, mut file) = draft::Draft::open(target).with_context(remedy)?;
        writeln!(file, "{}", text.trim_end()).with_context(remedy)?;
        Ok(Self { draft, target: name })
    }

    /// Puts it in its place.
    pub(crate) fn publish(self) -> anyhow::Result<()> {
        let target = self.target;
        self.draft
            .map_or(Ok(()), draft::Draft::publish)
            .with_context(|| format!("{target}: cannot be written"))
    }
}
