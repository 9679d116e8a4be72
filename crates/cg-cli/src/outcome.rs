//! How a command ended, and errors on standard error.

use std::io::Write;

use crate::flags;

/// What a command that ran has to say.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outcome {
    /// Everything asked for.
    Done,
    /// It ran, but some log gave no height.
    NoAnswer,
    /// Some input could not be read (already reported).
    Unreadable,
}

/// An error and its causes, each once: a library's message may hold its cause already.
pub(crate) fn told(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !text.contains(&cause) {
            text += if text.is_empty() { "" } else { ": " };
            text += &cause;
        }
    }
    flags::told(&text)
}

/// Tells an error on standard error.
pub(crate) fn tell(error: &anyhow::Error) {
    // A closed standard error leaves nobody to tell; `eprintln!` would panic.
    let _ = writeln!(std::io::stderr(), "cg: {}", told(error));
}
