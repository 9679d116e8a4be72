//! Prediction of the roll angle row by row, for plots next to the measured one.

use cg_core::truck::filters::{StateVariableFilter, StepMatrices};
use cg_core::{AlignSettings, Channel, Conditioner, Design, Output, Reduced5, SampleError};

use super::intake::LogEstimator;
use super::options::EstimateOptions;
use crate::log::LogRow;

/// Relative change of the trailer mass after which the dynamics are recomputed.
const NEW_MASS: f64 = 0.05;
/// Intervals that differ by less than this use the same discretization, s.
const SAME_INTERVAL_S: f64 = 1e-6;

/// Predicts the roll angle of one log for a given c.g. height.
///
/// The input of the channel is multiplied by the DC ratio at this height and at the present speed
/// and mass. The result is filtered by the reduced model. The offset of the roll sensor is not
/// included; the lags of a channel's roll angle are.
pub struct Prediction {
    design: Design<f64>,
    channel: Channel,
    height_m: f64,
    intake: LogEstimator,
    conditioner: Conditioner<f64>,
    running: Option<Running>,
}

/// The running filter, in scaled time.
struct Running {
    model: Reduced5<f64>,
    /// `U0/U − 1`, to which the numerator belongs.
    pace: f64,
    scale_radps: f64,
    trailer_mass_kg: f64,
    filter: StateVariableFilter<f64>,
    step: Option<(f64, StepMatrices<f64>)>,
    time_us: u64,
    roll_rad: f64,
}

impl Prediction {
    /// A prediction before the first row of a log.
    pub fn new(
        design: &Design<f64>,
        settings: AlignSettings<f64>,
        options: EstimateOptions,
        channel: Channel,
        height_m: f64,
    ) -> Self {
        Self {
            design: *design,
            channel,
            height_m,
            intake: LogEstimator::from_design(design, settings, options),
            conditioner: Conditioner::new(design),
            running: None,
        }
    }

    /// The predicted roll angle at the next row, rad. It is NaN if speed or mass are outside the
    /// design, or before the first value of the input. An absent input keeps its last value.
    ///
    /// # Errors
    /// [`SampleError`] if the time of the row is not later than that of the previous row.
    pub fn push(&mut self, row: &LogRow) -> Result<f64, SampleError> {
        let mut sample = self.intake.sample(row);
        // Only the input is used.
        let output = match self.channel.output() {
            Output::Roll => &mut sample.roll_rad,
            Output::SuspensionRoll => &mut sample.suspension_roll_rad,
            Output::TractorSuspensionRoll => &mut sample.tractor_suspension_roll_rad,
        };
        if output.is_nan() {
            *output = 0.0;
        }
        let Some(conditioned) = self.conditioner.push(&self.design, &sample)? else {
            return Ok(self.running.as_ref().map_or(f64::NAN, |running| running.roll_rad));
        };
        let (speed_mps, mass_kg) = (conditioned.speed_mps, conditioned.trailer_mass_kg);
        let Some(line) = self.design.line(self.channel, speed_mps, mass_kg) else {
            self.running = None;
            return Ok(f64::NAN);
        };
        let to_height =
            line.ratio_at(self.height_m) / line.ratio_at(self.design.reference_height_m);
        let input_rad = conditioned.expected_rad[self.channel.index()] * to_height;
        if input_rad.is_nan() {
            return Ok(self.running.as_ref().map_or(f64::NAN, |running| running.roll_rad));
        }
        let pace = self.design.pace(speed_mps);
        let fresh = self.running.as_ref().is_none_or(|running| {
            (mass_kg - running.trailer_mass_kg).abs() > NEW_MASS * running.trailer_mass_kg
        });
        if fresh {
            let model = self.design.model(self.channel.index(), mass_kg);
            self.running = model.map(|m| Running::at_rest(&m, mass_kg, sample.time_us, input_rad));
        }
        Ok(self
            .running
            .as_mut()
            .map_or(f64::NAN, |running| running.push(sample.time_us, input_rad, pace)))
    }
}

impl Running {
    fn at_rest(model: &Reduced5<f64>, trailer_mass_kg: f64, time_us: u64, input_rad: f64) -> Self {
        let unit = model.at_unit_gain();
        let scale_radps = unit.time_scale_radps();
        let model = unit.in_scaled_time(scale_radps);
        let filter = StateVariableFilter::at_rest(&model, input_rad);
        Self {
            model,
            pace: 0.0,
            scale_radps,
            trailer_mass_kg,
            filter,
            step: None,
            time_us,
            roll_rad: input_rad,
        }
    }

    fn push(&mut self, time_us: u64, input_rad: f64, pace: f64) -> f64 {
        #[allow(clippy::cast_precision_loss)] // an interval of a log
        let interval_s = (time_us - self.time_us) as f64 * 1e-6;
        self.time_us = time_us;
        if interval_s > 0.0 {
            let known =
                self.step.filter(|(known_s, _)| (known_s - interval_s).abs() < SAME_INTERVAL_S);
            let (_, step) = *self.step.insert(known.unwrap_or_else(|| {
                (interval_s, StepMatrices::new(&self.model, interval_s * self.scale_radps))
            }));
            self.filter.push(&step, input_rad);
            self.model.change_pace(pace - self.pace);
            self.pace = pace;
            self.roll_rad = self.model.response(&self.filter.derivatives(&self.model));
        }
        self.roll_rad
    }
}
