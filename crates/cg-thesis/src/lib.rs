//! The thesis beside ours: its tables and figures recomputed, its parameter studies, and Monte-Carlo
//! runs of errors and intervals.
//!
//! | module | what | source |
//! |---|---|---|
//! | [`accuracy`] | Monte-Carlo: errors and intervals | section 5.3.2 |
//! | [`study`] | the nonlinear plant over maneuver, load and vehicle | sections 2.5–2.7 |
//! | [`reproduce`] | the thesis's tables beside ours | all of it |

pub mod accuracy;
pub mod study;
pub mod reproduce;
