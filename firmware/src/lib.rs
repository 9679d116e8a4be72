//! The code that runs on both host and target: replays the log through the estimator and hashes
//! every answer.
//!
//! | module | what |
//! |---|---|
//! | [`log`] | the fixture logs, compiled in |
//! | [`truck`] | the design, as `cg design --emit rust` wrote it |
//! | [`trace`] | a hash of every bit of every answer |
//! | [`pair`] | the same truck and log with other channels |
//! | [`replay`] | samples in, costs and heights out |
//! | [`can`] | J1939 frames in, heights out |
#![no_std]
#![forbid(unsafe_op_in_unsafe_fn)]

/// Number of channels on a microcontroller.
pub const CHANNELS: usize = 2;

/// The result of a maneuver in these channels.
pub type Maneuver = cg_core::Maneuver<f32, CHANNELS>;

pub mod log;
#[allow(missing_docs)] // emitted
#[path = "../../crates/cg-core/examples/kraz/design.rs"]
pub mod truck;
pub mod pair;
pub mod trace;
pub mod replay;
pub mod can;
