//! Characteristics of springs, tires and the fifth wheel, prepared for fast evaluation.
//!
//! | file | contents |
//! |---|---|
//! | `springs` | measured springs with friction |
//! | `tyres` | lateral force and aligning moment over slip angle and load |
//! | `fifth_wheel` | roll moment of the fifth wheel: spring, separation, lash |

mod fifth_wheel;
mod springs;
mod tyres;

pub use fifth_wheel::FifthWheel;
pub use springs::{Envelope, Loop};
pub use tyres::Grip;
pub(crate) use tyres::lateral_force_n;
