//! Options of a plant in addition to its vehicle and load.

use cg_vehicle::Load;

/// The kind of characteristics of springs or tires.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Characteristics {
    /// Measured ones, if the vehicle file has them.
    #[default]
    Measured,
    /// Always linear ones.
    Linear,
}

/// Options of a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantOptions {
    /// Characteristics of the springs.
    pub springs: Characteristics,
    /// Lateral force and aligning moment of the tires.
    pub tyres: Characteristics,
    /// Bank of the road at the start of a run, left side higher positive. It stays unless
    /// [`push_on`](super::Simulation::push_on) changes it.
    pub bank_rad: f64,
    /// Grade of the road at the start of a run, uphill positive.
    pub grade_rad: f64,
    /// Velocity of the wind at the start of a run, forward and to the left. It acts on the side that `[wind]` of the vehicle file
    /// describes, and stays unless [`blow`](super::Simulation::blow) changes it.
    pub wind_mps: [f64; 2],
    /// Distance of the payload's c.g. to the left of the middle.
    pub payload_left_m: f64,
    /// Distance of the payload's c.g. behind its position in the vehicle file. Springs and tires remain
    /// those of that position, and the body settles.
    pub payload_behind_m: f64,
    /// The load under which the heights of the vehicle file hold. Without it every load rests at
    /// those heights, as in the linear model. The height of the load itself is always its height at
    /// rest.
    pub design_load: Option<Load>,
    /// Longest step of the integration. The plant takes a shorter one where its fastest motion needs it
    /// (a hard fifth wheel), and always a whole number of them in 10 ms.
    pub step_s: f64,
}

impl Default for PlantOptions {
    fn default() -> Self {
        Self {
            springs: Characteristics::Measured,
            tyres: Characteristics::Measured,
            bank_rad: 0.0,
            grade_rad: 0.0,
            wind_mps: [0.0; 2],
            payload_left_m: 0.0,
            payload_behind_m: 0.0,
            design_load: None,
            step_s: 2e-3,
        }
    }
}
