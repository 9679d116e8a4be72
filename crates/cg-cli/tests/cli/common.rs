//! Temporary folders, runs of the binary, and common checks of errors.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// The path of a file in the repository's fixtures.
pub(crate) fn fixture(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name).display().to_string()
}

pub(crate) fn baseline() -> String {
    fixture("vehicles/baseline.toml")
}

pub(crate) fn kraz() -> String {
    fixture("vehicles/kraz.toml")
}

/// The result of one run of the binary.
#[derive(Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

pub(crate) fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cg"));
    command.args(arguments);
    command
}

pub(crate) fn cg(arguments: &[&str]) -> Run {
    command(arguments).stdin(Stdio::null()).output().unwrap().into()
}

/// Runs the binary with this text on standard input.
pub(crate) fn cg_fed(arguments: &[&str], input: &[u8]) -> Run {
    let piped = |command: &mut Command| {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let mut child = piped(&mut command(arguments));
    let mut pipe = child.stdin.take().unwrap();
    std::thread::scope(|scope| {
        // A child that reads no further closes the pipe.
        scope.spawn(move || pipe.write_all(input).is_ok());
        child.wait_with_output().unwrap().into()
    })
}

impl Run {
    /// Checks that the run succeeded without a message on standard error.
    #[track_caller]
    pub(crate) fn done(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        assert!(self.err.is_empty(), "{self:?}");
        self.whole()
    }

    /// Checks that the exit status is `code`, that standard error contains all `parts`, that there
    /// was no panic, and that standard output is complete.
    #[track_caller]
    pub(crate) fn told(self, code: i32, parts: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert!(!self.err.contains("panicked"), "{self:?}");
        assert!(self.err.is_empty() || self.err.ends_with('\n'), "{self:?}");
        // An error of the system is printed once, not by every layer.
        assert!(self.err.matches("os error").count() <= self.err.lines().count(), "{self:?}");
        for part in parts {
            assert!(self.err.contains(part), "no {part:?} in {}", self.err);
        }
        self.whole()
    }

    /// Checks for exit status 2 with these parts, and nothing on standard output.
    #[track_caller]
    pub(crate) fn refused(self, parts: &[&str]) {
        let run = self.told(2, parts);
        assert!(run.out.is_empty(), "{run:?}");
    }

    #[track_caller]
    fn whole(self) -> Self {
        assert!(self.out.is_empty() || self.out.ends_with('\n'), "half a line: {self:?}");
        self
    }

    /// The objects of JSON Lines.
    #[track_caller]
    pub(crate) fn json(&self) -> Vec<Value> {
        self.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// The only object of JSON Lines.
    #[track_caller]
    pub(crate) fn answer(&self) -> Value {
        let mut answers = self.json();
        assert_eq!(answers.len(), 1, "{self:?}");
        answers.remove(0)
    }
}

/// The height of an answer, which must have one.
#[track_caller]
pub(crate) fn height_m(answer: &Value) -> f64 {
    answer["height_m"].as_f64().unwrap_or_else(|| panic!("no height in {answer}"))
}

/// A folder that is removed after its test.
pub(crate) struct Scratch(TempDir);

impl Scratch {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }

    /// Creates a file and returns its path.
    pub(crate) fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Writes a vehicle of the fixtures whose first trailer axle can be raised by 10 cm, and returns its path.
    pub(crate) fn lifting(&self, vehicle: &str) -> String {
        let text = std::fs::read_to_string(fixture(&format!("vehicles/{vehicle}.toml"))).unwrap();
        let text = text.replacen("[[trailer.axle]]", "[[trailer.axle]]\nlift_m = 0.1", 1);
        self.file("truck.toml", text)
    }

    /// Simulates a log of 20 s in this folder and returns its path.
    #[track_caller]
    pub(crate) fn simulate(&self, name: &str, vehicle: &str, more: &[&str]) -> String {
        let path = self.path(name);
        let mut arguments = vec!["simulate", "--vehicle", vehicle, "-o", &path];
        arguments.extend(more);
        let run = cg(&arguments).done();
        assert!(run.out.is_empty(), "{run:?}");
        path
    }

    /// The names of all files, including hidden and incomplete ones.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// Runs `cg estimate LOG --vehicle V --format json` with more arguments.
pub(crate) fn estimate(log: &str, vehicle: &str, more: &[&str]) -> Run {
    let mut arguments = vec!["estimate", log, "--vehicle", vehicle, "--format", "json"];
    arguments.extend(more);
    cg(&arguments)
}
