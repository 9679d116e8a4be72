//! Errors of output files.

use std::io;

use thiserror::Error;

use super::kind::Kind;

/// The reason why a file is not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The output is an input of the same call.
    #[error(
        "{path}: is given to {input} and to {output}, which would replace it; give {output} another file"
    )]
    Input {
        /// The path of the output, and the path under which it is read if it differs.
        path: String,
        /// The option that reads it.
        input: String,
        /// The option that would write it.
        output: String,
    },
    /// The output is `-`, which is standard output elsewhere.
    #[error(
        "{output} -: nothing is written to standard output here; name a file, ./- if it is to be called so"
    )]
    Dash {
        /// The option that would write it.
        output: String,
    },
    /// The standard output of this call is an input of it.
    #[error(
        "{path}: is given to {input} and is standard output, which would change it; redirect standard output to \
         another file"
    )]
    Printed {
        /// The path of the input.
        path: String,
        /// The option that reads it.
        input: String,
    },
    /// Two options would write the same file.
    #[error("{path}: is given to {first} and to {second}; give each option its own file")]
    Twice {
        /// The path, and the other path of the same file if it differs.
        path: String,
        /// The option that writes it.
        first: String,
        /// The other option that would write it.
        second: String,
    },
    /// The file exists and was not written by cg.
    #[error(
        "{path}: exists already and is not a {kind} written by cg-height; give {output} another file, or ⟨force⟩ to replace it"
    )]
    Foreign {
        /// The path.
        path: String,
        /// The kind of the output.
        kind: Kind,
        /// The option that would write it.
        output: String,
    },
    /// The file exists, and files of this kind are never replaced without being asked to.
    #[error("{path}: exists already; give {output} another file, or ⟨force⟩ to replace it")]
    Exists {
        /// The path.
        path: String,
        /// The option that would write it.
        output: String,
    },
    /// The file exists and is write-protected.
    #[error("{path}: is write-protected; give {output} another file, or ⟨force⟩ to replace it")]
    Protected {
        /// The path.
        path: String,
        /// The option that would write it.
        output: String,
    },
    /// The file exists and cannot be read, so that nobody can tell what would be lost.
    #[error(
        "{path}: cannot be read: {source}; it is not replaced, so make it readable or give {output} another file"
    )]
    Unreadable {
        /// The path.
        path: String,
        /// The error of the system.
        source: io::Error,
        /// The option that would write it.
        output: String,
    },
    /// The path does not lead to a file.
    #[error("{path}: is {what}; give {output} a file")]
    NoFile {
        /// The path.
        path: String,
        /// What it leads to.
        what: &'static str,
        /// The option that would write it.
        output: String,
    },
    /// An error of the system.
    #[error("{path}: cannot be written ({source}); check the folder, its permissions and space")]
    Write {
        /// The path.
        path: String,
        /// The error of the system.
        source: io::Error,
    },
}
