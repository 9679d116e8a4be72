//! A text file that is written whole or not at all.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};

/// A file beside its place, whole; dropped before it is published, it removes itself.
pub(crate) struct Draft {
    partial: PathBuf,
    target: PathBuf,
}

impl Draft {
    /// Writes `text` beside `target`, which was given with `flag`.
    pub(crate) fn write(target: &Path, flag: &str, text: &str) -> anyhow::Result<Self> {
        let remedy = || {
            format!("{}: cannot be written; check the folder and its permissions", target.display())
        };
        if target.is_dir() {
            return Err(anyhow!("{}: is a folder; give {flag} a file", target.display()));
        }
        let mut partial = target.as_os_str().to_owned();
        partial.push(".partial");
        let draft = Self { partial: partial.into(), target: target.to_owned() };
        let mut file = File::create(&draft.partial).with_context(remedy)?;
        writeln!(file, "{}", text.trim_end())
            .and_then(|()| file.sync_all())
            .with_context(remedy)?;
        Ok(draft)
    }

    /// Puts it in its place.
    pub(crate) fn publish(self) -> anyhow::Result<()> {
        std::fs::rename(&self.partial, &self.target)
            .with_context(|| format!("{}: cannot be written", self.target.display()))
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // After publishing there is nothing to remove.
        let _ = std::fs::remove_file(&self.partial);
    }
}
