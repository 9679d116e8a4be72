//! The constants of one truck: channels, reduced models, ratio lines over the height, rollover thresholds,
//! and the design that contains them.

pub mod channel;
pub mod lags;
pub mod articulation;
pub mod path_lead;
pub mod friction;
pub(crate) mod axis;
pub mod reduced;
pub mod filters;
pub mod simulation;
pub mod ratio;
pub mod rollover;
pub mod spread;
pub mod design;
mod pace;
mod threshold;
pub(crate) mod gains;
mod mass;
