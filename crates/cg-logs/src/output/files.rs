//! What one call reads and writes.

use std::path::{Path, PathBuf};

use super::draft;
use super::error::OutputError;
use super::kind::Kind;
use super::place::{self, Place};
use super::target::Target;

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
