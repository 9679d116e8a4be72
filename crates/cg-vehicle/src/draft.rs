//! A file that takes its name only when it is whole.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// A temporary file beside its target; dropped before it is published, it removes itself.
pub struct Draft {
    file: File,
    temporary: PathBuf,
    target: PathBuf,
    published: bool,
}

impl Draft {
    /// A draft for `path`, and the file to write to. No draft where the path leads to
    /// something that is no regular file and must not be replaced, such as `/dev/stdout`.
    ///
    /// # Errors
    /// Those of the system.
    pub fn open(path: &Path) -> io::Result<(Option<Self>, File)> {
        let target = match fs::metadata(path) {
            Ok(about) if !about.is_file() => {
                return Ok((None, OpenOptions::new().write(true).open(path)?));
            }
            // A link stays a link: what it leads to is replaced.
            Ok(_) => fs::canonicalize(path)?,
            Err(_) => path.to_path_buf(),
        };
        let name = target.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
        for attempt in 0.. {
            let mut hidden = OsString::from(".");
            hidden.push(name);
            hidden.push(format!(".{}-{attempt}.part", std::process::id()));
            let temporary = target.with_file_name(hidden);
            match OpenOptions::new().write(true).create_new(true).open(&temporary) {
                Ok(file) => {
                    let draft =
                        Self { file: file.try_clone()?, temporary, target, published: false };
                    return Ok((Some(draft), file));
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 100 => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// Gives the file its name, once its bytes are on the disk.
    ///
    /// # Errors
    /// Those of the system; then nothing of it stays.
    pub fn publish(mut self) -> io::Result<()> {
        self.file.sync_data()?;
        fs::rename(&self.temporary, &self.target)?;
        self.published = true;
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if !self.published {
            // Nobody is left to be told, and the name says what the remains are.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}
