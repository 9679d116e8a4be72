//! CAN frames: where they come from as text, and what they measure.
//!
//! | file | what |
//! |---|---|
//! | `frame` | a frame, and the lines that `candump -L` writes |
//! | `dbc` | signals of a DBC file, mapped to quantities |
//! | `decoder` | frames to values: J1939 and the mapped signals |
//!
//! The J1939 table itself and the alignment of values to samples are [`cg_core::j1939`] and
//! [`cg_core::align`], which firmware uses too.

mod dbc;
mod decoder;
mod frame;

pub use dbc::{DbcError, MappedSignal, SignalMap};
pub use decoder::{Decoder, Device, DeviceFilter, named};
pub use frame::{CandumpError, Frame};
