//! Rollover measures of a vehicle under a load (the thesis, section 1.2).
//!
//! | file | contents | computed from |
//! |---|---|---|
//! | `ramp` | static rollover threshold, wheel lift, load transfer | nonlinear plant |
//! | `transfer` | load transfer ratio, roll safety factor | an instant of the plant |
//! | `time` | time to rollover, predicted and simulated | ramp |
//! | `maneuver` | peaks in a lane change and in a sine: rearward amplification | nonlinear plant |
//! | `small` | rearward amplification over frequency, yaw modes | linear model |
//! | `decay` | yaw damping from a steer pulse | nonlinear plant |
//! | `offtracking` | off-tracking at high and low speed | nonlinear plant, geometry |
//! | `tripped` | critical sliding velocity, energy reserve and metric of a tripped rollover | rigid trailer |
//! | `curve` | the speed at which a curve keeps a margin | threshold as on board |
//! | `measure` | all measures with units and one sentence each | – |

pub mod decay;
pub mod offtracking;
pub mod small;
mod transfer;
pub mod maneuver;
mod ramp;
mod time;
mod tripped;
mod curve;
mod measure;

pub use curve::Curve;
pub use measure::{Measure, RolloverMeasures, RolloverOptions, measures};
pub use ramp::{Ramp, RampEnd, RampPoint};
pub use time::{TimeToRollover, time_to_rollover_s};
pub use transfer::Transfer;
pub use tripped::RigidTrailer;
