//! Logs with known truth from the linear, the reduced or the nonlinear model.
//!
//! | file | contents |
//! |---|---|
//! | `scenario` | what to simulate, and what is true of it |
//! | `models` | the linear and the reduced model in time |
//! | `nonlinear` | the nonlinear plant, steered by a steer history or by the driver |
//! | `simulation` | a scenario ready to run, and its log |

mod scenario;
mod models;
mod nonlinear;
mod simulation;

pub use scenario::{Plant, Scenario, Truth};
pub use simulation::LogSimulation;
