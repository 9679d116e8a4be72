//! The constants of one truck: reduced models, ratio lines over the height, rollover thresholds,
//! and the design that contains them.

pub mod reduced;
pub mod ratio;
pub mod rollover;
pub mod design;
