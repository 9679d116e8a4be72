//! The centre-of-gravity (c.g.) height of a semitrailer, from steer (or lateral
//! acceleration) and trailer roll angle, sample by sample.
//!
//! `no_std`, no heap, no panic, no `unsafe`; generic over [`Real`] (`f32` on the
//! truck, `f64` as its witness).
//!
//! | stage, in flow order | takes | gives | source |
//! |---|---|---|---|
//! | [`sample`] | sensor values, SI, ISO 8855 | a checked [`Sample`] | – |
//! | [`j1939`] | CAN frames | signals in SI units | SAE J1939-71 |
//! | [`align`] | signals at rates of their own | a [`Sample`] at each roll angle | – |
//! | [`design`] | – | [`Design`]: the constants of one truck | thesis ch. 4, 5.4, 5.5 |
//! | [`condition`] | [`Sample`] | roll free of tilt, gaps found, straight or turning | – |
//! | [`reduced`] | input signal | [`Reduced5`]: the reduced 5th-order compensated model | eq. 5.12 |
//! | [`identify`], [`arx`], [`filtered`] | input, roll | [`Fit`]: DC ratio and its standard deviation | eqs. 5.1, 5.2 |
//! | `long_run` | residuals | how slow their noise is | – |
//! | `input_noise` | input | how noisy it is | – |
//! | `prior`, `unknowns`, `pending` | – | parts of [`filtered`] | – |
//! | [`ratio`] | DC ratio | the height that explains it | eqs. 5.17–5.20 |
//! | [`consistency`] | rows of a maneuver | whether they can be believed | – |
//! | [`height`] | heights of maneuvers | one height, fused | – |
//! | `load` | heights of maneuvers | whether it is still the same load | – |
//! | [`memory`] | – | what is kept over a restart | – |
//! | [`rollover`] | height | rollover threshold and margin | – |
//! | [`maneuver`] | – | what is said of a sample and of a maneuver | – |
//! | [`settings`] | – | when maneuvers open and close, what is good enough | – |
//! | `lane` | rows | one channel's identifier and its heights | – |
//! | [`estimator`] | [`Sample`] | [`Step`] | all of the above, joined |
//!
//! A module uses only modules above it; `tests/layers.rs` fails otherwise.
//!
//! The heart of it in four lines, with the numbers printed in the source (inches
//! there, any consistent unit here):
//!
//! ```
//! use cg_core::ratio::{solve_height, Measured, RatioLine};
//!
//! let line: RatioLine<f64> = RatioLine { a0: -1.9772e270, a1: -1.0268e270, b0: 1.6703e272, b1: -2.9656e269 };
//! let (ratio, compensation) = (Measured::exact(-0.8456), Measured::exact(1.4894));
//! let height = solve_height(&line, ratio, compensation, 0.0).unwrap();
//! assert!((height.value - 77.69_f64).abs() < 0.005); // inches, Table 5.7
//! ```
#![no_std]
#![forbid(unsafe_code)]

pub mod real;
pub mod linalg;
pub mod sample;
pub mod j1939;
pub mod align;
pub mod reduced;
pub mod ratio;
pub mod rollover;
pub mod design;
pub mod condition;
pub mod identify;
pub mod arx;
mod long_run;
mod input_noise;
mod prior;
mod unknowns;
mod pending;
pub mod filtered;
pub mod height;
mod load;
pub mod memory;
pub mod consistency;
pub mod maneuver;
pub mod settings;
mod lane;
pub mod estimator;

pub use align::{AlignSettings, Aligner};
pub use arx::Arx;
pub use condition::{Conditioner, SampleError};
pub use consistency::Inconsistency;
pub use design::{Channel, ChannelDesign, Design, DesignError, Spread};
pub use estimator::{Estimator, Maneuver, Settings, Status, Step};
pub use filtered::FilteredArx;
pub use height::{Combined, Height};
pub use identify::{Answer, Fit, Identify, Unexcited};
pub use memory::Memory;
pub use prior::Prior;
pub use ratio::{HeightError, Measured, RatioLine};
pub use real::Real;
pub use reduced::Reduced5;
pub use rollover::{Rollover, RolloverDesign, ThresholdLine};
pub use sample::{Quantity, Sample};

// The example of the page on crates.io is a test too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
