//! CAN frames: their text formats, their decoding, and their conversion to samples.
//!
//! | file | what |
//! |---|---|
//! | `frame` | a CAN frame |
//! | `candump`, `reader` | lines in the candump format, and a log of them |
//! | `asc` | a log in the format ASC |
//! | `dbc`, `dbc_file` | signals of a DBC file, mapped to quantities |
//! | `device_filter` | the source address from which a quantity is accepted |
//! | `decoder` | values of frames: J1939 and the mapped signals |
//! | `clock` | a continuous time from time stamps |
//! | `sampler` | samples from frames, with all of these |
//! | `sources` | the addresses that send what is accepted from one address only |
//! | `tally` | counts of implausible values, each reported once |
//!
//! The J1939 table and the alignment of values to samples are [`cg_core::signal::j1939`] and
//! [`cg_core::signal::align`], which the firmware uses too.

mod clock;
mod frame;
mod candump;
mod dbc;
#[cfg(feature = "dbc")]
mod dbc_file;
mod device_filter;
mod decoder;
mod reader;
mod asc;
mod sources;
mod tally;
mod sampler;

pub use asc::AscReader;
pub(crate) use asc::is_asc;
pub use candump::{CandumpError, Content, Line, parse};
pub use clock::{Clock, Instant};
pub use dbc::{DbcError, Mapped, MappedSignal, SignalMap};
pub use decoder::{Decoder, Device, Vdc2};
pub use device_filter::DeviceFilter;
pub use frame::Frame;
pub use reader::{CandumpFault, CandumpReader};
pub(crate) use sampler::MASS_SERVES_US;
pub use sampler::Sampler;
pub use tally::Tally;
