//! Simulation of a reduced model.

use crate::math::real::Real;
use crate::truck::filters::{StateVariableFilter, StepMatrices};
use crate::truck::reduced::Reduced5;

/// Simulates the reduced model sample by sample, at the speed for which it was made.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Simulation<T: Real> {
    model: Reduced5<T>,
    step: StepMatrices<T>,
    filter: StateVariableFilter<T>,
}

impl<T: Real> Simulation<T> {
    /// Starts `model` in steady state at the constant `input`, with samples every `interval_s`.
    pub fn new(model: &Reduced5<T>, interval_s: T, input: T) -> Self {
        let scale = model.time_scale_radps();
        let model = model.in_scaled_time(scale);
        Self {
            model,
            step: StepMatrices::new(&model, interval_s * scale),
            filter: StateVariableFilter::at_rest(&model, input),
        }
    }

    /// Resets the simulation to the steady state at the constant `input`.
    pub fn rest(&mut self, input: T) {
        self.filter = StateVariableFilter::at_rest(&self.model, input);
    }

    /// The present roll angle, in radians.
    pub fn roll_rad(&self) -> T {
        self.model.response(&self.filter.derivatives(&self.model))
    }

    /// Advances one interval to the next input sample and returns the roll angle there, in radians.
    pub fn push(&mut self, input: T) -> T {
        self.filter.push(&self.step, input);
        self.roll_rad()
    }
}
