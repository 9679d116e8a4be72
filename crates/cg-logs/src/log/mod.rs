//! Log files: reading and writing of sensor rows.
//!
//! | stage | file | what it does |
//! |---|---|---|
//! | bytes | `source` | counts bytes and decompresses gzip |
//! | lines | `lines` | splits at line feeds and refuses lines that are too long |
//! | cells | `numbers`, `cell`, `clock`, `quoted` | reads numbers and points in time; splits rows with quotes |
//! | rows | `rows`, `batches`, `frames` | reads CSV, parquet or CAN frames; skips comments |
//! | signals | `heading`, `columns`, `options`, `signal` | finds columns, converts units, reverses signs |
//! | samples | `beginning`, `roll_rate`, `preparation` | aligns channels of different rasters; roll angles from a roll rate |
//! | values | `plausibility` | drops values that the truck cannot have, and counts them |
//! | log | `reader`, `writer`, `candump`, `frame_text` | checks time and values; the public interface |
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
//! Signs are those of ISO 8855 (see [`LogRow`]). The unit may also stand in brackets after the name
//! (`Roll [deg]`, `Speed (km/h)`) or in a row of units below the names. Other columns are ignored, except
//! that a column with one of these names and an unknown unit, or without a unit, is an error. The
//! delimiter is a comma, a semicolon or a tab: the one that occurs most often in the header. With the
//! other two, decimals may have a comma. The header may be UTF-8 or Latin-1. Lines that begin with `#`
//! are comments and are skipped. Blank lines, CRLF, a byte order mark and quotes are allowed. An empty
//! cell, `NaN` or `NA` is an absent value. If the reader knows the truck, a number that the truck
//! [cannot have](cg_core::AlignSettings::believes) is absent too. The time is required and must
//! increase. It may be points in time (`2024-05-01 12:00:00.02`, timestamps of parquet), which become
//! Unix time; the only column of such values is the time, whatever its name.

mod signal;
mod error;
mod quoted;
mod candump;
mod options;
mod heading;
mod columns;
mod clock;
mod cell;
mod numbers;
mod lines;
#[cfg(feature = "parquet")]
mod arrow_units;
#[cfg(feature = "parquet")]
mod parquet_kind;
#[cfg_attr(not(feature = "parquet"), path = "no_batches.rs")]
mod batches;
mod frames;
mod rows;
mod source;
mod frame_text;
mod roll_rate;
mod plausibility;
mod beginning;
mod preparation;
mod reader;
mod writer;

pub use beginning::Rasters;
pub use candump::CandumpWriter;
pub use error::{ColumnName, LogError, Place, Position};
pub use frame_text::FrameText;
pub use frames::FrameRows;
pub use options::{CanOptions, ColumnMap, LogOptions, OptionError};
pub use plausibility::Plausibility;
pub use preparation::Preparation;
pub use reader::LogReader;
pub use signal::{LogRow, Signal, UnknownSignal};
pub use writer::LogWriter;
