//! A file that may be written.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::error::OutputError;
use super::kind::{self, Kind};
use super::place;

/// A file that may be written.
#[derive(Clone, Debug)]
pub struct Target {
    pub(super) path: PathBuf,
    pub(super) flag: String,
    pub(super) kind: Kind,
    pub(super) force: bool,
}

impl Target {
    /// The path as given by the caller.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// An error of the system with the file's name and a remedy.
    pub fn failed(&self, source: io::Error) -> OutputError {
        match source.downcast::<OutputError>() {
            Ok(refusal) => refusal,
            Err(source) => OutputError::Write { path: self.path.display().to_string(), source },
        }
    }

    /// The path of the file with links resolved; `None` for a device or a pipe, which is written
    /// directly.
    pub(super) fn replaces(&self) -> Result<Option<PathBuf>, OutputError> {
        let path = || self.path.display().to_string();
        let output = || self.flag.clone();
        let no_file = |what| Err(OutputError::NoFile { path: path(), what, output: output() });
        let resolved = place::resolved(&self.path);
        let about = match fs::metadata(&self.path) {
            Ok(about) => about,
            // A mistyped device name must not create a file in `/dev`.
            Err(_) if resolved.parent() == Some(Path::new("/dev")) => {
                return no_file("not an existing device");
            }
            Err(_) if fs::read_link(&resolved).is_ok() => {
                return no_file("a link that leads back to itself");
            }
            Err(_) => return Ok(Some(resolved)),
        };
        if about.is_dir() {
            return no_file("a folder");
        }
        if place::is_disk(&about) {
            return no_file("a disk");
        }
        if !about.is_file() {
            // What is to be kept cannot be read back from a device, and reading a pipe may never end.
            return if self.kind == Kind::State { no_file("a device or a pipe") } else { Ok(None) };
        }
        if self.kind == Kind::State {
            // It may hold what a truck has learned in many trips, which is never replaced unread.
            let unreadable =
                |source| OutputError::Unreadable { path: path(), source, output: output() };
            kind::try_reading(&self.path).map_err(unreadable)?;
        }
        if !self.force && about.len() > 0 && !self.kind.is_ours(&self.path) {
            return Err(match self.kind {
                Kind::Vehicle | Kind::Frames => {
                    OutputError::Exists { path: path(), output: output() }
                }
                kind => OutputError::Foreign { path: path(), kind, output: output() },
            });
        }
        if !self.force && about.permissions().readonly() {
            return Err(OutputError::Protected { path: path(), output: output() });
        }
        Ok(Some(resolved))
    }
}
