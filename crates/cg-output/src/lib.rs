//! Files that a call may write: the only place that decides this, and the only way to write a file.
//!
//! | module | what |
//! |---|---|
//! | [`kind`] | files that cg wrote itself and may replace |
//! | `place` | whether two paths lead to the same file |
//! | [`draft`] | a file that gets its name when it is complete; removal of incomplete files |
//!
//! A call registers its inputs and its outputs with [`Files`]. Before any work is done,
//! [`Files::writes`] refuses an output that is
//!
//! * an input or another output of the same call, also if the path is a link or is spelled
//!   differently;
//! * an existing file that is not an output of the same kind, or that is write-protected, unless
//!   forced;
//! * a folder, a disk, a link that leads back to itself, or for a state a device or a pipe.
//!
//! The [`Target`] that it returns checks again before the file gets its name, because hours may
//! have passed.

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
pub use place::Place;
pub use target::Target;

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
