//! Reduction of the linear model (section 5.5).
//!
//! | module | what |
//! |---|---|
//! | [`pade`](mod@pade) | the source's reduction, of any order |
//! | [`balanced`](mod@balanced) | balanced truncation and residualisation, of any order |
//! | [`fitted`](mod@fitted) | the best of any order, for one input |
//! | [`reduce`](mod@reduce) | the models of order 5 that the estimator runs on |
//! | [`quality`] | error of a reduced model: step response, H∞ |

pub mod balanced;
pub mod pade;
pub mod fitted;
pub mod quality;
pub mod reduce;

pub use balanced::{Keep, balanced};
pub use fitted::fitted;
pub use pade::pade;
pub use reduce::{Method, ReducedModels, reduce};
