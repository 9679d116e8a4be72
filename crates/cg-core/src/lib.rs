//! Estimates the height of a semitrailer's center of gravity (c.g.) on board, sample by sample.
//!
//! For each load it gives the height, its standard deviation, and the lateral acceleration at which
//! the trailer rolls over.
//!
//! The crate is `no_std`, uses no heap and no `unsafe`, and does not panic. It is generic over
//! [`Real`]: `f32` runs on the truck, and `f64` is used to check it.
//!
//! ```
//! use cg_core::truck::simulation::Simulation;
//! use cg_core::{Estimator, FilteredArx, Prior, Sample, Settings};
//! # mod truck { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/kraz/design.rs")); }
//! // The constants of one truck. `cg design --emit rust` writes them from a vehicle file.
//! let design = &truck::DESIGN;
//! let mut estimator: Estimator<f32, FilteredArx<f32>, _, 2> =
//!     Estimator::new(design, Settings::truck(), Prior::standard());
//!
//! // On a truck the roll angle comes from a sensor. Here the truck's own reduced model computes it, at
//! // 50 km/h and the reference load.
//! let mut roll = Simulation::new(&design.channels[0].models[2], 0.02, 0.0);
//! for k in 0..1000u32 {
//!     // Straight for 4 s, then a left turn: the road-wheel steer angle grows to 0.02 rad within 1 s.
//!     let steer_rad = 0.02 * ((k as f32 - 200.0) / 100.0).clamp(0.0, 1.0);
//!     let sample = Sample {
//!         steer_rad,
//!         roll_rad: roll.push(steer_rad),
//!         speed_mps: design.speed_mps[4],
//!         trailer_mass_kg: design.trailer_mass_kg[2],
//!         ..Sample::absent(u64::from(k) * 20_000)
//!     };
//!     estimator.push(&sample)?;
//! }
//! estimator.finish();
//!
//! let height_m = estimator.combined_height().expect("one turn gives a height").height_m;
//! assert!((height_m.value - design.reference_height_m).abs() < 0.01);
//! # Ok::<(), cg_core::SampleError>(())
//! ```
//!
//! # From a sample to the height
//!
//! | folder | input | output |
//! |---|---|---|
//! | [`signal`] | CAN frames, or sensor values at different rates | a checked [`Sample`] in SI units and ISO 8855 axes |
//! | [`truck`] | – | the [`Design`] of one truck: reduced models, ratio lines, rollover thresholds |
//! | [`identify`] | an input and the roll angle of a maneuver | a [`Fit`]: the DC ratio and its standard deviation |
//! | [`decide`] | samples, fits and heights | maneuvers, detected signal faults, one height per load, a warning level |
//! | [`estimator`] | a [`Sample`] | a [`Step`]; it connects all of the above |
//! | [`math`] | – | floating-point types and small matrices for all modules |
//! | [`word`] | – | options whose values are words |
//!
//! The modules are declared in the order in which they use each other: a module uses only modules
//! above it, in this file and within each folder. `tests/layers.rs` checks this.
//!
//! The method is that of F. Yang's thesis (Concordia University, 2005). Equation numbers refer to
//! the thesis.
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

#[macro_use]
pub mod word;
pub mod math;
pub mod signal;
pub mod truck;
pub mod identify;
pub mod decide;
pub mod estimator;

pub use decide::combined::Combined;
pub use decide::condition::{Conditioner, SampleError};
pub use decide::consistency::Inconsistency;
pub use decide::curve::curve_speed_mps;
pub use decide::height::Height;
pub use decide::maneuver::{Maneuver, Outcome, Reject, Status, Step};
pub use decide::memory::Memory;
pub use decide::settings::Settings;
pub use decide::signals::Signals;
pub use decide::warning::Warner;
pub use estimator::Estimator;
pub use identify::arx::Arx;
pub use identify::filtered::FilteredArx;
pub use identify::identifier::{Answer, Fit, Identify, Unexcited};
pub use identify::prior::Prior;
pub use math::real::Real;
pub use signal::align::Aligner;
pub use signal::sample::{Quantity, Sample};
pub use signal::sensors::AlignSettings;
pub use signal::unit::{Dimension, Unit};
pub use truck::articulation::Articulation;
pub use truck::channel::{CHANNELS, Channel, Input, Output};
pub use truck::design::{ChannelDesign, Design, DesignError, Spread};
pub use truck::friction::Friction;
pub use truck::path_lead::PathLead;
pub use truck::ratio::{HeightError, Measured, RatioLine};
pub use truck::reduced::Reduced5;
pub use truck::rollover::{Rollover, RolloverDesign, ThresholdLine};
pub use word::{UnknownWord, Word};

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
