//! CAN frames: where they come from as text, and what they measure.
//!
//! | file | what |
//! |---|---|
//! | `frame` | a frame |
//! | `candump`, `reader` | the lines that candump writes, and a log of them |
//! | `dbc` | signals of a DBC file, mapped to quantities |
//! | `decoder` | frames to values: J1939 and the mapped signals |
//! | `clock` | time stamps to a time that never jumps |
//! | `sampler` | frames to samples, by all of these |
//! | `tally` | values that are not as they should be, counted and told once |
//!
//! The J1939 table itself and the alignment of values to samples are [`cg_core::signal::j1939`] and
//! [`cg_core::signal::align`], which firmware uses too.

mod clock;
mod frame;
mod candump;
mod dbc;
mod decoder;
mod reader;
mod tally;
mod sampler;

pub use candump::{CandumpError, Content, Line, parse};
pub use clock::{Clock, Instant};
pub use dbc::{DbcError, MappedSignal, SignalMap};
pub use decoder::{Decoder, Device, DeviceFilter};
pub use frame::Frame;
pub use reader::{CandumpFault, CandumpReader};
pub use sampler::Sampler;
pub use tally::Tally;
