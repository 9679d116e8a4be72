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
//! | signal | column | also accepted | needed |
//! |---|---|---|---|
//! | time | `time_s` | `_ms`, `_us` | yes |
//! | mean road-wheel angle | `steer_rad` | `_deg` | this … |
//! | steering-wheel angle | `steering_wheel_rad` | `_deg` | … or this |
//! | roll angle | `roll_rad` | `_deg` | this … |
//! | accelerometer inclinometer | `tilt_rad` | `_deg` | … or this |
//! | forward speed | `speed_mps` | `_kmh` | |
//! | lateral acceleration | `lateral_acceleration_mps2` | `_g` | |
//! | yaw rate | `yaw_rate_radps` | `_degps` | |
//! | whole semitrailer as weighed | `trailer_mass_kg` | `_t` | |
//! | load of its axles on the road | `trailer_axle_load_kg` | `_t` | |
//! | pressure in its air suspension | `trailer_suspension_pressure_pa` | `_kpa`, `_bar` | |
//!
//! Signs are those of ISO 8855 (see [`LogRow`]). Other columns are passed over, but one of
//! ours in an unknown unit, or without one, is an error. The delimiter is a comma, a
//! semicolon or a tab, whichever the header has most of. A line that begins with `#` is a
//! comment and never looked into; blank lines, CRLF, a byte order mark and quotes are fine.
//! An empty cell, `NaN` or `NA` is an absent value, and so is, if the reader is told which truck
//! it is, a number that the truck [cannot have](cg_core::AlignSettings::believes). Time must be
//! there and increase.

#[cfg_attr(not(feature = "parquet"), path = "no_batches.rs")]
mod batches;
mod candump;
mod cell;
mod columns;
mod error;
mod frames;
mod lines;
mod options;
mod quoted;
mod reader;
mod rows;
mod signal;
mod source;
mod writer;

pub use candump::CandumpWriter;
pub use error::{ColumnName, LogError, Place, Position};
pub use options::{CanOptions, ColumnMap, LogOptions, OptionError};
pub use reader::LogReader;
pub use signal::{LogRow, Signal};
pub use writer::LogWriter;
