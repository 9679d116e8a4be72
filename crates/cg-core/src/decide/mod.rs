//! Decisions: which samples form a maneuver, whether the signals are plausible, whether the load
//! has changed, which height follows from all maneuvers, and when to warn.

pub mod signals;
pub mod neighbors;
pub mod condition;
pub mod consistency;
pub mod height;
pub mod combined;
pub mod load;
pub mod memory;
pub mod maneuver;
pub mod settings;
pub(crate) mod road;
pub(crate) mod window;
pub(crate) mod judge;
pub(crate) mod lane;
pub(crate) mod closing;
pub mod warning;
pub mod curve;
