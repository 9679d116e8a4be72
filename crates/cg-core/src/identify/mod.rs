//! Identification of the transfer function from an input to the roll angle by ARX least squares.

pub mod identifier;
mod long_run;
mod input_noise;
mod unknowns;
pub mod prior;
mod pending;
mod roll_noise;
pub mod arx;
pub mod filtered;
