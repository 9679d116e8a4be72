//! What an FMU computes.

use crate::error::FmuError;
use crate::variable::Variable;

/// Plant or estimator of one truck, from which instances start.
pub(crate) trait Subject: Send + Sync {
    /// The variables: parameters, then inputs, then outputs.
    fn variables(&self) -> &[Variable];

    /// Starts at these values of parameters and inputs.
    fn start(&self, parameters: &[f64], inputs: &[f64]) -> Result<Box<dyn Running>, FmuError>;
}

/// A plant or an estimator at work.
pub(crate) trait Running: Send {
    /// Advances from a time by an interval. A message means that the simulation should end.
    fn step(
        &mut self,
        inputs: &[f64],
        from_s: f64,
        interval_s: f64,
    ) -> Result<Option<String>, FmuError>;

    /// Writes the outputs.
    fn write_outputs(&self, outputs: &mut [f64]);

    /// What is to be said at the end of the simulation.
    fn messages(&self) -> Vec<String>;

    /// A copy of the present state.
    fn copy(&self) -> Box<dyn Running>;
}
