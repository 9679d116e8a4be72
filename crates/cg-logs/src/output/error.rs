//! Why a file is not written.

use std::io;

use thiserror::Error;

use super::kind::Kind;

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
        "{path}: is there already and is no {kind} of ours; give {output} another file, or ⟨force⟩ to replace it"
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
    #[error("{path}: is write-protected; give {output} another file, or ⟨force⟩ to replace it")]
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
