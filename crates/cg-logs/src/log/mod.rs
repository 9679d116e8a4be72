//! Logs: the rows of sensors that come in and go out as files.
//!
//! | stage | file | what goes on |
//! |---|---|---|
//! | bytes | `source` | counted, unpacked where they are gzip |
//! | lines | `lines` | cut at line feeds, refused when too long |
//! | cells | `cell`, `quoted` | numbers read in place; rows with quotes split with care |
//! | rows | `rows`, `batches`, `frames` | CSV, parquet or CAN frames; comments and blank lines dropped |
//! | signals | `columns`, `options`, `signal` | header names to signals, units to SI, signs flipped |
//! | log | `reader`, `writer`, `candump` | time and values checked; the public face |
//!
//! # Format
//!
//! A header of names with units, then one row of numbers for each instant:
//!
//! `time_s` and the quantities of [`cg_core::quantities!`], each in SI (`roll_rad`) or another unit of
//! its dimension (`roll_deg`, [`cg_core::Dimension`]). Time is needed, a roll angle (`roll` or `tilt`) and
//! an input (`steer`, `steering_wheel`, `lateral_acceleration` or `yaw_rate`); everything else is optional.
//!
//! Signs are those of ISO 8855 (see [`LogRow`]). Other columns are passed over, but one of
//! ours in an unknown unit, or without one, is an error. The delimiter is a comma, a
//! semicolon or a tab, whichever the header has most of. A line that begins with `#` is a
//! comment and never looked into; blank lines, CRLF, a byte order mark and quotes are fine.
//! An empty cell, `NaN` or `NA` is an absent value, and so is, if the reader is told which truck
//! it is, a number that the truck [cannot have](cg_core::AlignSettings::believes). Time must be
//! there and increase.

mod signal;
mod error;
mod lines;
mod quoted;
mod candump;
mod options;
mod columns;
mod cell;
#[cfg_attr(not(feature = "parquet"), path = "no_batches.rs")]
mod batches;
mod frames;
mod rows;
mod source;
mod reader;
mod writer;

pub use candump::CandumpWriter;
pub use error::{ColumnName, LogError, Place, Position};
pub use frames::FrameRows;
pub use options::{CanOptions, ColumnMap, LogOptions, OptionError};
pub use reader::LogReader;
pub use signal::{LogRow, Signal, UnknownSignal};
pub use writer::LogWriter;
