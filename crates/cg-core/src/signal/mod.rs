//! Sensor signals: units, quantities, J1939 decoding, and alignment of all signals to samples.

pub mod unit;
pub mod sample;
pub mod j1939;
pub mod sensors;
pub mod align;
