//! The input and output files of a call.

use std::path::{Path, PathBuf};

use super::draft;
use super::error::OutputError;
use super::kind::Kind;
use super::place::{self, Place};
use super::target::Target;

/// The name of standard output in messages.
const STANDARD_OUTPUT: &str = "standard output";

/// The input and output files of a call.
#[derive(Debug)]
pub struct Files {
    force: bool,
    inputs: Vec<Named>,
    outputs: Vec<Named>,
}

/// A file and the option to which it was given.
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
    /// The files of a call. With `force`, outputs may replace files that cg did not write, but
    /// never inputs of the same call.
    pub fn new(force: bool) -> Self {
        // A file to which the shell redirects standard output is an output like any other. Windows
        // has no name for it.
        let stdout = cfg!(unix).then(|| Named::new(STANDARD_OUTPUT, Path::new("/dev/stdout")));
        let outputs = stdout.flatten().into_iter().collect();
        Self { force, inputs: Vec::new(), outputs }
    }

    /// Whether outputs may replace files that cg did not write (`--force`).
    pub fn replaces_foreign(&self) -> bool {
        self.force
    }

    /// Registers an input. `-` is the file from which standard input is redirected.
    #[must_use]
    pub fn reads(mut self, flag: &str, path: &Path) -> Self {
        #[cfg(unix)]
        let path = if path.as_os_str() == "-" { Path::new("/dev/stdin") } else { path };
        self.inputs.extend(Named::new(flag, path));
        self
    }

    /// Registers an input if there is one.
    #[must_use]
    pub fn reads_some(self, flag: &str, path: Option<&Path>) -> Self {
        match path {
            Some(path) => self.reads(flag, path),
            None => self,
        }
    }

    /// Refuses a file among the inputs so far to which the shell redirects standard output, for a
    /// call that prints something.
    ///
    /// # Errors
    /// [`OutputError::Printed`].
    pub fn prints(self) -> Result<Self, OutputError> {
        let printed = self.outputs.iter().find(|output| output.flag == STANDARD_OUTPUT);
        let is_printed = |input: &&Named| printed.is_some_and(|file| file.place == input.place);
        match self.inputs.iter().find(is_printed) {
            Some(input) => Err(OutputError::Printed {
                path: input.path.display().to_string(),
                input: input.flag.clone(),
            }),
            None => Ok(self),
        }
    }

    /// Registers `path`, given to the option `flag`, as an output of this kind. Removes drafts of
    /// this file that killed processes have left.
    ///
    /// # Errors
    /// [`OutputError`] with the conflict.
    pub fn writes(&mut self, flag: &str, path: &Path, kind: Kind) -> Result<Target, OutputError> {
        if path.as_os_str() == "-" {
            return Err(OutputError::Dash { output: flag.to_owned() });
        }
        let mut target =
            Target { path: path.to_owned(), flag: flag.to_owned(), kind, force: self.force };
        if let Some(named) = Named::new(flag, path) {
            self.refuse_clash(&named)?;
            self.outputs.push(named);
        }
        if let Some(resolved) = target.replaces()? {
            draft::sweep(&resolved);
        }
        // What this call itself prints to a stream in the meantime does not make it another
        // program's file.
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
            // A file behind `/dev/stdout` is named `/dev/stdout` in messages.
            if place::is_stream(&new.path) {
                return Ok(());
            }
            let (first, second) = (other.flag.clone(), new.flag.clone());
            return Err(OutputError::Twice { path: path(other), first, second });
        }
        Ok(())
    }
}
