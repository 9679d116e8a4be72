//! How good the estimates are, and whether their intervals are true: Monte-Carlo experiments on
//! simulated logs.
//!
//! | file | what |
//! |---|---|
//! | [`experiment`] | one maneuver many times: bias, error, bound, coverage |
//! | `curves` | over noise, payload, height and time, as a study |

mod curves;
pub mod experiment;

pub(crate) use curves::study;
pub use experiment::{Experiment, Score, Truck};
