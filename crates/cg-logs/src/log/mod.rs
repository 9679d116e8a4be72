//! Log files: reading and writing of sensor rows.
//!
//! | stage | file | what it does |
//! |---|---|---|
//! | bytes | `source` | counts bytes and decompresses gzip |
//! | lines | `lines` | splits at line feeds and refuses lines that are too long |
//! | cells | `cell`, `quoted` | reads numbers in place; splits rows with quotes |
//! | rows | `rows`, `batches`, `frames` | reads CSV, parquet or CAN frames; skips comments |
//! | signals | `columns`, `options`, `signal` | finds columns, converts units, reverses signs |
//! | log | `reader`, `writer`, `candump` | checks time and values; the public interface |
//!
//! # Format
//!
//! A header with names and units, then one row of numbers for each time stamp:
//!
//! The columns are `time_s` and the quantities of [`cg_core::quantities!`], in SI units
//! (`roll_rad`) or in another unit of their dimension (`roll_deg`, [`cg_core::Dimension`]). The
//! time, a roll angle (`roll` or `tilt`) and an input (`steer`, `steering_wheel`,
//! `lateral_acceleration` or `yaw_rate`) are required; all other columns are optional.
//!
//! Signs are those of ISO 8855 (see [`LogRow`]). Other columns are ignored, except that a column
//! with one of these names and an unknown unit, or without a unit, is an error. The delimiter is a
//! comma, a semicolon or a tab: the one that occurs most often in the header. Lines that begin with
//! `#` are comments and are skipped. Blank lines, CRLF, a byte order mark and quotes are allowed.
//! An empty cell, `NaN` or `NA` is an absent value. If the reader knows the truck, a number that
//! the truck [cannot have](cg_core::AlignSettings::believes) is absent too. The time is required
//! and must increase.

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
