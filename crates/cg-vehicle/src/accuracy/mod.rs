//! How good the estimates are, and whether their intervals are true: Monte-Carlo experiments on
//! simulated logs.
pub mod experiment;
pub use experiment::{Experiment, Score, Truck};
