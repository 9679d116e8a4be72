//! Comparison with the thesis: its tables and figures recomputed, its parameter studies, and
//! Monte-Carlo runs of errors and intervals.
//!
//! | module | contents | reference |
//! |---|---|---|
//! | [`verdict`] | when a number of ours is that of the thesis | – |
//! | [`accuracy`] | Monte-Carlo: errors and intervals | section 5.3.2 |
//! | [`study`] | the nonlinear plant over maneuver, load and vehicle | sections 2.5–2.7 |
//! | [`reproduce`] | the tables of the thesis recomputed | the whole thesis |
//! | [`catalog`] | every table and figure with one verdict | the whole thesis |

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod verdict;
pub mod accuracy;
pub mod study;
pub mod reproduce;
pub mod catalog;

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
