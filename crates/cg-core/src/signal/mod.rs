//! From sensors and CAN frames to samples: SI units, ISO 8855 axes, one time stamp for all signals of a sample.

pub mod unit;
pub mod sample;
pub mod j1939;
pub mod align;
