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

pub mod kind;
mod place;
mod error;
mod target;
pub mod draft;
mod files;

pub use draft::Draft;
pub use error::OutputError;
pub use files::Files;
pub use kind::Kind;
pub use target::Target;
