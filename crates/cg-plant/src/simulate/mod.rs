//! Logs with known truth from the linear, the reduced or the nonlinear model.
//!
//! | file | contents |
//! |---|---|
//! | `scenario` | what to simulate, and what is true of it |
//! | `models` | the linear and the reduced model in time |
//! | `signals` | what perfect sensors show of the nonlinear plant |
//! | `plant_run` | the nonlinear plant, step by step |
//! | `states` | the true states as a list of named numbers |
//! | `on_road` | a driver who follows a road |
//! | `weather` | the wind |
//! | `nonlinear` | the nonlinear plant, steered by a steer history or by a driver |
//! | `simulation` | a scenario ready to run, and its log |

mod scenario;
mod models;
mod signals;
mod plant_run;
mod states;
mod on_road;
mod weather;
mod nonlinear;
mod simulation;

pub use plant_run::{PlantInput, PlantRun, PlantStart};
pub use scenario::{Plant, RoadTruth, Scenario, Track, Truth};
pub use simulation::LogSimulation;
pub use states::StateName;
