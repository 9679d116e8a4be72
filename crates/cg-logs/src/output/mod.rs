//! What a call may write: the one place that decides it, and the only way to a file.
//!
//! | module | what |
//! |---|---|
//! | [`kind`] | which files are ours and may be replaced |
//! | `place` | when two paths lead to the same file |
//! | [`draft`] | a file that takes its name when it is whole, and what a killed process left |
//!
//! A call tells [`Files`] what it reads and what it wants to write. [`Files::writes`] refuses, before
//! any work is done, an output that is
//!
//! * an input of the same call, or another of its outputs, by whatever link or spelling;
//! * a file that is not of the same kind of output of ours, or is write-protected, unless forced;
//! * a folder or a disk.
//!
//! The [`Target`] that it gives looks again before the file takes its name: hours may have passed.

pub mod draft;
pub mod kind;
mod place;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

pub use draft::Draft;
pub use kind::Kind;

use place::Place;

/// What one call reads and writes.
#[derive(Debug)]
pub struct Files {
    force: bool,
    inputs: Vec<Named>,
    outputs: Vec<Named>,
}

/// A file and the option that it was given to.
#[derive(Debug)]
struct Named {
    flag: String,
    path: PathBuf,
    place: Place,
}

impl Named {
    fn new(flag: &str, path: &Path) -> Option<Self> {
        let place = Place::of(path)?;
        Some(Self { flag: flag.to_owned(), path: path.to_owned(), place })
    }
}

/// Why a file is not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// It is an input of the same call.
    #[error(
        "{path}: given to {input} and to {output}, which would replace it; give {output} another file"
    )]
    Input {
        /// The output, and under which name it is read if that is another.
        path: String,
        /// What reads it.
        input: String,
        /// What would write it.
        output: String,
    },
    /// It is given twice.
    #[error("{path}: given to {first} and to {second}; give each a file of its own")]
    Twice {
        /// The file, and its other name if it has one.
        path: String,
        /// What writes it.
        first: String,
        /// What else would.
        second: String,
    },
    /// It is there and not ours.
    #[error(
        "{path}: is there already and is no {kind} of ours; give {output} another file, or --force to replace it"
    )]
    Foreign {
        /// The file.
        path: String,
        /// What would be written.
        kind: Kind,
        /// What would write it.
        output: String,
    },
    /// It is there and may not be written.
    #[error("{path}: is write-protected; give {output} another file, or --force to replace it")]
    Protected {
        /// The file.
        path: String,
        /// What would write it.
        output: String,
    },
    /// It is no file.
    #[error("{path}: is {what}; give {output} a file")]
    NoFile {
        /// The path.
        path: String,
        /// What it is.
        what: &'static str,
        /// What would write it.
        output: String,
    },
    /// The system refuses.
    #[error("{path}: cannot be written ({source}); check the folder, its permissions and space")]
    Write {
        /// The file.
        path: String,
        /// The system's reason.
        source: io::Error,
    },
}

impl Files {
    /// Those of a call; with `force` it replaces files that are not ours, but never its own inputs.
    pub fn new(force: bool) -> Self {
        let mut outputs = Vec::new();
        // What the shell has sent to a file is an output like any other.
        #[cfg(unix)]
        outputs.extend(Named::new("standard output", Path::new("/dev/stdout")));
        Self { force, inputs: Vec::new(), outputs }
    }

    /// Tells an input; `-` is what standard input comes from.
    #[must_use]
    pub fn reads(mut self, flag: &str, path: &Path) -> Self {
        #[cfg(unix)]
        let path = if path.as_os_str() == "-" { Path::new("/dev/stdin") } else { path };
        self.inputs.extend(Named::new(flag, path));
        self
    }

    /// The same where there is one.
    #[must_use]
    pub fn reads_some(self, flag: &str, path: Option<&Path>) -> Self {
        match path {
            Some(path) => self.reads(flag, path),
            None => self,
        }
    }

    /// Asks to write `path`, which was given to `flag`, as a file of some kind; removes what killed
    /// processes have left of it.
    ///
    /// # Errors
    /// [`OutputError`] naming what it clashes with.
    pub fn writes(&mut self, flag: &str, path: &Path, kind: Kind) -> Result<Target, OutputError> {
        let mut target =
            Target { path: path.to_owned(), flag: flag.to_owned(), kind, force: self.force };
        if let Some(named) = Named::new(flag, path) {
            self.refuse_clash(&named)?;
            self.outputs.push(named);
        }
        if let Some(resolved) = target.replaces()? {
            draft::sweep(&resolved);
        }
        // What this call itself prints there in the meantime is no foreign file.
        target.force |= place::is_stream(path);
        Ok(target)
    }

    fn refuse_clash(&self, new: &Named) -> Result<(), OutputError> {
        let path = |other: &Named| {
            let this = new.path.display();
            if new.path == other.path {
                this.to_string()
            } else {
                format!("{this} (the same file as {})", other.path.display())
            }
        };
        if let Some(input) = self.inputs.iter().find(|input| input.place == new.place) {
            let (input_flag, output) = (input.flag.clone(), new.flag.clone());
            return Err(OutputError::Input { path: path(input), input: input_flag, output });
        }
        if let Some(other) = self.outputs.iter().find(|output| output.place == new.place) {
            // `/dev/stdout` is asked for by that name.
            if place::is_stream(&new.path) {
                return Ok(());
            }
            let (first, second) = (other.flag.clone(), new.flag.clone());
            return Err(OutputError::Twice { path: path(other), first, second });
        }
        Ok(())
    }
}

/// A file that may be written.
#[derive(Clone, Debug)]
pub struct Target {
    path: PathBuf,
    flag: String,
    kind: Kind,
    force: bool,
}

impl Target {
    /// Its path as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A draft, and the file to write to. No draft where the path leads to something that is no
    /// regular file and must not be replaced, such as `/dev/stdout` or a pipe.
    ///
    /// # Errors
    /// Those of the system; [`OutputError`] if something else is there now.
    pub fn open(&self) -> io::Result<(Option<Draft>, fs::File)> {
        match self.replaces().map_err(io::Error::other)? {
            Some(resolved) => {
                let (draft, file) = Draft::create(self.clone(), resolved)?;
                Ok((Some(draft), file))
            }
            None => Ok((None, fs::OpenOptions::new().write(true).open(&self.path)?)),
        }
    }

    /// Writes `text` beside the file's place, with one line feed at its end; with
    /// [`Draft::publish`] it appears there.
    ///
    /// # Errors
    /// [`OutputError`].
    pub fn write(&self, text: &str) -> Result<Option<Draft>, OutputError> {
        let write = || -> io::Result<Option<Draft>> {
            let (draft, mut file) = self.open()?;
            io::Write::write_all(&mut file, format!("{}\n", text.trim_end()).as_bytes())?;
            Ok(draft)
        };
        write().map_err(|source| self.failed(source))
    }

    /// An error of the system with the file's name and a remedy.
    pub fn failed(&self, source: io::Error) -> OutputError {
        match source.downcast::<OutputError>() {
            Ok(refusal) => refusal,
            Err(source) => OutputError::Write { path: self.path.display().to_string(), source },
        }
    }

    /// Where the file is or will be, links followed; none if it is a device or a pipe, which is
    /// written as it is.
    fn replaces(&self) -> Result<Option<PathBuf>, OutputError> {
        let path = || self.path.display().to_string();
        let output = || self.flag.clone();
        let no_file = |what| Err(OutputError::NoFile { path: path(), what, output: output() });
        let resolved = place::resolved(&self.path);
        let Ok(about) = fs::metadata(&self.path) else {
            // Whoever mistypes a device's name does not want a file among the devices.
            let in_dev = resolved.parent() == Some(Path::new("/dev"));
            return if in_dev { no_file("no device that there is") } else { Ok(Some(resolved)) };
        };
        if about.is_dir() {
            return no_file("a folder");
        }
        if place::is_disk(&about) {
            return no_file("a disk");
        }
        if !about.is_file() {
            return Ok(None);
        }
        if !self.force && about.len() > 0 && !self.kind.is_ours(&self.path) {
            return Err(OutputError::Foreign { path: path(), kind: self.kind, output: output() });
        }
        if !self.force && about.permissions().readonly() {
            return Err(OutputError::Protected { path: path(), output: output() });
        }
        Ok(Some(resolved))
    }
}
