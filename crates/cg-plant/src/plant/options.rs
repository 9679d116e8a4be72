//! What can be chosen about a plant beside its vehicle and load.

use cg_vehicle::vehicle::Load;

/// Which characteristics of springs or tires.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Characteristics {
    /// Those measured, where the vehicle file has them.
    #[default]
    Measured,
    /// The linear ones always.
    Linear,
}

/// What can be chosen about a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantOptions {
    /// Springs.
    pub springs: Characteristics,
    /// Lateral force and aligning moment of the tires.
    pub tyres: Characteristics,
    /// Bank of the road, right side lower positive.
    pub bank_rad: f64,
    /// How far the payload's c.g. lies to the left of the middle.
    pub payload_left_m: f64,
    /// How far it lies behind the place that the vehicle file gives it. Springs and tires stay
    /// those of that place: the body settles.
    pub payload_behind_m: f64,
    /// The load under which the heights of the vehicle file hold; without it every load rests at
    /// those heights (as the linear model has it). The height of the load itself is always the
    /// one at rest.
    pub design_load: Option<Load>,
    /// Step of the integration.
    pub step_s: f64,
}

impl Default for PlantOptions {
    fn default() -> Self {
        Self {
            springs: Characteristics::Measured,
            tyres: Characteristics::Measured,
            bank_rad: 0.0,
            payload_left_m: 0.0,
            payload_behind_m: 0.0,
            design_load: None,
            step_s: 1e-3,
        }
    }
}
