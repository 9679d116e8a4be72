//! Plant and estimator as functional mock-up units (FMUs): FMI 3.0, co-simulation.
//!
//! | file | what |
//! |---|---|
//! | `error` | the error of this crate |
//! | [`variable`] | what a variable is |
//! | `subject` | what an FMU computes, and its variables |
//! | `plant`, `estimator` | the two kinds |
//! | [`fmu`] | an FMU from a vehicle file |
//! | [`instance`] | one instance: its values, and what may be called when |
//! | `description` | `modelDescription.xml` |
//! | [`mod@package`] | the file `.fmu` |
//!
//! The functions that FMI prescribes are C, in the crate `cg-fmi`. They call [`Instance`] and contain
//! nothing else.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod error;
pub mod variable;
mod subject;
mod plant;
mod estimator;
pub mod fmu;
pub mod instance;
mod description;
pub mod package;

pub use error::FmuError;
pub use fmu::{Fmu, FmuFiles, FmuKind};
pub use instance::{Instance, Stepped};
pub use package::{Binary, package};

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
