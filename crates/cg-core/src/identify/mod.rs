//! Identification of the transfer function from an input to the roll angle by ARX least squares.

pub mod mean;
pub mod identifier;
mod long_run;
mod input_noise;
mod unknowns;
mod pending;
mod roll_noise;
mod equations;
pub mod prior;
mod regression;
pub mod arx;
pub mod filtered;
