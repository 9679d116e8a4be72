//! Reduction of the linear model (section 5.5).
//!
//! | module | contents |
//! |---|---|
//! | [`pade`](mod@pade) | the reduction of the thesis, for any order |
//! | [`balanced`](mod@balanced) | balanced truncation and residualization, for any order |
//! | [`fitted`](mod@fitted) | the best model of any order for one input |
//! | `in_band` | the best numerator for usual maneuvers |
//! | [`reduce`](mod@reduce) | the models of order 5 for the estimator |
//! | [`quality`] | error of a reduced model: step response, H∞ norm |

pub mod balanced;
pub mod pade;
pub mod fitted;
pub mod quality;
mod in_band;
pub mod reduce;

pub use balanced::{Keep, balanced};
pub use fitted::fitted;
pub use pade::pade;
pub use reduce::{Method, ReducedModels, Shapes, reduce};
