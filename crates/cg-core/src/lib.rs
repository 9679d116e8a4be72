//! Estimates how high the load of a semitrailer sits, sample by sample, on board: the height of the trailer's
//! center of gravity (c.g.), its standard deviation, and the lateral acceleration at which the trailer rolls over.
//!
//! `no_std`, no heap, no panic, no `unsafe`; generic over [`Real`] (`f32` on the truck, `f64` to check it).
//!
//! ```
//! use cg_core::truck::reduced::Simulation;
//! use cg_core::{Estimator, FilteredArx, Prior, Sample, Settings};
//! # mod truck { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/kraz/design.rs")); }
//! // The constants of one truck. `cg design --emit rust` writes them from a vehicle file.
//! let design = &truck::DESIGN;
//! let mut estimator: Estimator<f32, FilteredArx<f32>, _> =
//!     Estimator::new(design, Settings::truck(), Prior::standard());
//!
//! // On a truck the roll angle comes from a sensor. Here the truck's own reduced model computes it, at
//! // 50 km/h and the reference height.
//! let mut roll = Simulation::new(&design.channels[0].models[3], 0.02, 0.0);
//! for k in 0..1000u32 {
//!     // Straight for 4 s, then a left turn that tightens for 2 s: front wheels at 0.02 rad.
//!     let steer_rad = 0.02 * ((k as f32 - 200.0) / 100.0).clamp(0.0, 1.0);
//!     let sample = Sample {
//!         steer_rad,
//!         roll_rad: roll.push(steer_rad),
//!         speed_mps: design.speed_mps[4],
//!         trailer_mass_kg: design.trailer_mass_kg[3],
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
//! # The way of a sample
//!
//! | folder | takes | gives |
//! |---|---|---|
//! | [`signal`] | CAN frames, sensor values at rates of their own | a checked [`Sample`]: SI units, ISO 8855 axes |
//! | [`truck`] | – | the [`Design`]: reduced models, ratio lines, rollover thresholds of one truck |
//! | [`identify`] | an input and the roll angle of a maneuver | a [`Fit`]: the DC ratio and its standard deviation |
//! | [`decide`] | samples, fits, heights | maneuvers, doubts about signals, one height for the load, a warning level |
//! | [`estimator`] | a [`Sample`] | a [`Step`]; joins all of the above |
//! | [`math`] | – | numbers and small matrices for all of them |
//! | [`word`] | – | options whose values are words |
//!
//! The modules are declared in the order in which they use each other: each uses only those above it, in this file
//! and within each folder. `tests/layers.rs` fails otherwise.
//!
//! The method is that of F. Yang's thesis (Concordia University, 2005); equation numbers are the thesis's.
#![no_std]
#![forbid(unsafe_code)]

#[macro_use]
pub mod word;
pub mod math;
pub mod signal;
pub mod truck;
pub mod identify;
pub mod decide;
pub mod estimator;

pub use decide::condition::{Conditioner, SampleError};
pub use decide::consistency::Inconsistency;
pub use decide::height::{Combined, Height};
pub use decide::maneuver::{Maneuver, Outcome, Reject, Status, Step};
pub use decide::memory::Memory;
pub use decide::settings::Settings;
pub use decide::warning::Warner;
pub use estimator::Estimator;
pub use identify::arx::Arx;
pub use identify::filtered::FilteredArx;
pub use identify::identifier::{Answer, Fit, Identify, Unexcited};
pub use identify::prior::Prior;
pub use math::real::Real;
pub use signal::align::{AlignSettings, Aligner};
pub use signal::sample::{Quantity, Sample};
pub use signal::unit::{Dimension, Unit};
pub use truck::design::{Channel, ChannelDesign, Design, DesignError, Spread};
pub use truck::ratio::{HeightError, Measured, RatioLine};
pub use truck::reduced::Reduced5;
pub use truck::rollover::{Rollover, RolloverDesign, ThresholdLine};
pub use word::{UnknownWord, Word};
