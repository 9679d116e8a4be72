//! The outcome of a command, and errors on standard error.

use std::io::Write;

use crate::flags;

/// The outcome of a command that ran.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outcome {
    /// The command did everything.
    Done,
    /// Some log gave no height.
    NoAnswer,
    /// Some input could not be read; the error has been reported.
    Unreadable,
}

/// An error with its causes. A cause that the message of a library already contains is not
/// repeated.
pub(crate) fn error_message(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !text.contains(&cause) {
            text += if text.is_empty() { "" } else { ": " };
            text += &cause;
        }
    }
    flags::with_flags(&text)
}

/// Prints an error to standard error.
pub(crate) fn print_error(error: &anyhow::Error) {
    // Standard error may be closed, and `eprintln!` would then panic.
    let _ = writeln!(std::io::stderr(), "cg: {}", error_message(error));
}

/// Whether the reader of standard output has closed it (`cg … | head`), which is not an error.
pub(crate) fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|io| io.kind() == std::io::ErrorKind::BrokenPipe)
    })
}

/// The value; nothing if the reader of standard output has closed it.
pub(crate) fn unless_closed<T>(result: anyhow::Result<T>) -> anyhow::Result<Option<T>> {
    match result {
        Err(error) if is_closed_pipe(&error) => Ok(None),
        result => result.map(Some),
    }
}
