//! Comparison with the thesis: its tables and figures recomputed, its parameter studies, and
//! Monte-Carlo runs of errors and intervals.
//!
//! | module | contents | reference |
//! |---|---|---|
//! | [`accuracy`] | Monte-Carlo: errors and intervals | section 5.3.2 |
//! | [`study`] | the nonlinear plant over maneuver, load and vehicle | sections 2.5–2.7 |
//! | [`reproduce`] | the tables of the thesis recomputed | the whole thesis |

pub mod accuracy;
pub mod study;
pub mod reproduce;

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
