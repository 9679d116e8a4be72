//! The estimator as an FMU.

use cg_core::{Design, Measured, Status, Warner};
use cg_logs::estimate::{Basis, EstimateOptions, LogEstimate, LogEstimator, RoadChoice, Verdict};
use cg_logs::log::{LogRow, Signal};
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::Calibration;
use cg_vehicle::design::design_with;
use cg_vehicle::{Variant, Vehicle, hint};

use crate::error::FmuError;
use crate::subject::{Running, Subject};
use crate::variable::{Enumeration, Type, Variable, unit_of};

const STATE: Enumeration = Enumeration {
    name: "State",
    meaning: "State of the estimator at the last sample",
    items: &[
        ("absent", "No roll angle or no input"),
        ("straight", "Straight driving"),
        ("turning", "Part of a maneuver"),
    ],
};

const STATUS: Enumeration = Enumeration {
    name: "Status",
    meaning: "Whether there is a height",
    items: &[
        ("ok", "There is a height"),
        ("rejected", "There is no height"),
        ("inconsistent", "Channels or sensors contradict each other"),
    ],
};

/// Name, unit and meaning of the outputs that are numbers.
const NUMBERS: [(&str, &str, &str); 7] = [
    ("height_m", "m", "Height of the c.g. of the trailer's sprung mass above the road at rest"),
    ("height_sd_m", "m", "Standard deviation of the height"),
    ("height_low_m", "m", "Lower end of the 95 % interval of the height"),
    ("height_high_m", "m", "Upper end of the 95 % interval of the height"),
    (
        "static_rollover_threshold_mps2",
        "m/s2",
        "Lateral acceleration above which the vehicle rolls over in a steady turn at the present speed",
    ),
    ("static_rollover_threshold_sd_mps2", "m/s2", "Standard deviation of the threshold"),
    (
        "margin_mps2",
        "m/s2",
        "Threshold minus the magnitude of the present lateral acceleration, filtered over 0.2 s",
    ),
];

/// The estimator of a vehicle.
pub(crate) struct EstimatorSubject {
    vehicle: Vehicle,
    design: Design<f64>,
    options: EstimateOptions,
    variables: Vec<Variable>,
}

/// All signals but the time.
fn signals() -> impl Iterator<Item = Signal> {
    Signal::ALL.into_iter().filter(|signal| signal.quantity().is_some())
}

impl EstimatorSubject {
    pub(crate) fn new(
        vehicle: Vehicle,
        calibration: Option<&Calibration>,
    ) -> Result<Self, FmuError> {
        let variant = calibration.map_or(Variant::Complete, |calibration| calibration.model);
        let basis = calibration.map(Basis::of);
        let belief = calibration.map_or_else(|| Belief::prior(&vehicle), Calibration::belief);
        let design = design_with(&vehicle, variant, &belief)?;
        let options = EstimateOptions { variant, basis, ..EstimateOptions::default() };
        let options = options.with_file(&vehicle);
        Ok(Self { vehicle, design, options, variables: variables() })
    }
}

fn variables() -> Vec<Variable> {
    let mut variables = vec![
        Variable::parameter(
            (
                "road_bank_sd_rad",
                "Standard deviation of the bank of the roads in curves; NaN: as cg estimate without --road",
            ),
            "rad",
            f64::NAN,
        ),
        Variable::parameter(
            (
                "trailer_mass_sd_kg",
                "Standard deviation of the trailer mass; NaN: that of its scale in the vehicle file",
            ),
            "kg",
            f64::NAN,
        ),
    ];
    for quantity in signals().filter_map(Signal::quantity) {
        let meaning = format!("{} NaN: absent.", quantity.meaning());
        let text = (quantity.column(), meaning.as_str());
        variables.push(Variable::input(text, unit_of(quantity), f64::NAN));
    }
    for (name, unit, meaning) in NUMBERS {
        let meaning = format!("{meaning}. NaN: not known.");
        variables.push(Variable::output((name, meaning), Type::Float64(unit)));
    }
    variables.extend([
        Variable::output(("maneuvers", "Number of maneuvers so far"), Type::Int64),
        Variable::output(("state", STATE.meaning), Type::Enumeration(&STATE)),
        Variable::output(("status", STATUS.meaning), Type::Enumeration(&STATUS)),
    ]);
    variables
}

impl Subject for EstimatorSubject {
    fn variables(&self) -> &[Variable] {
        &self.variables
    }

    fn start(&self, parameters: &[f64], _inputs: &[f64]) -> Result<Box<dyn Running>, FmuError> {
        let &[bank_sd_rad, mass_sd_kg] = parameters else {
            return Err(FmuError::new("the estimator has two parameters"));
        };
        let mut options = self.options;
        if !bank_sd_rad.is_nan() {
            let choice: Result<RoadChoice, _> = bank_sd_rad.to_string().parse();
            let choice = choice.map_err(|error| {
                FmuError::new(format!("road_bank_sd_rad {bank_sd_rad}: {error}"))
            })?;
            options.road = Some(choice);
        }
        if !mass_sd_kg.is_nan() {
            if !(mass_sd_kg >= 0.0 && mass_sd_kg.is_finite()) {
                return Err(FmuError::new(format!(
                    "trailer_mass_sd_kg {mass_sd_kg} must be zero or more; NaN if it is not known"
                )));
            }
            options.trailer_mass_sd_kg = Some(mass_sd_kg);
        }
        let settings = self.vehicle.align_settings();
        let estimator = LogEstimator::from_design(&self.design, settings, options);
        let warner = Warner::new(&[], 0.0).map_err(|error| FmuError::new(error.to_string()))?;
        let gravity_mps2 = self.vehicle.gravity_mps2;
        let speed_mps = self.vehicle.nominal_speed_mps;
        Ok(Box::new(RunningEstimator {
            estimator,
            warner,
            state: Status::Absent,
            gravity_mps2,
            speed_mps,
            origin_s: None,
        }))
    }
}

#[derive(Clone)]
struct RunningEstimator {
    estimator: LogEstimator,
    /// Filters the lateral acceleration of the margin, as in `cg run`.
    warner: Warner<f64>,
    state: Status,
    gravity_mps2: f64,
    /// The last speed.
    speed_mps: f64,
    /// Time of the first sample.
    origin_s: Option<f64>,
}

impl Running for RunningEstimator {
    fn step(
        &mut self,
        inputs: &[f64],
        from_s: f64,
        _interval_s: f64,
    ) -> Result<Option<String>, FmuError> {
        let mut values = [f64::NAN; Signal::COUNT];
        values[Signal::Time as usize] = from_s;
        for (signal, value) in signals().zip(inputs) {
            if value.is_infinite() {
                return Err(FmuError::new(format!(
                    "{} {value} at {from_s} s is not finite; NaN means that there is no value",
                    signal.column()
                )));
            }
            values[signal as usize] = *value;
        }
        let row = LogRow::from_values(values);
        let refused = |error| FmuError::new(format!("at {from_s} s: {error}"));
        self.state = self.estimator.push(&row).map_err(refused)?;
        let lateral_mps2 = self.estimator.felt_mps2(&row, self.speed_mps);
        let origin_s = *self.origin_s.get_or_insert(from_s);
        // Microseconds since the first sample, which are not negative: an earlier time was refused.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let time_us = ((from_s - origin_s) * 1e6).round() as u64;
        self.warner.push(time_us, lateral_mps2, None, self.gravity_mps2);
        if row.speed_mps.is_finite() {
            self.speed_mps = row.speed_mps;
        }
        Ok(None)
    }

    fn write_outputs(&self, outputs: &mut [f64]) {
        let estimate = self.estimator.clone().finish();
        let [low_m, high_m] = estimate.height_ci95_m.unwrap_or([f64::NAN; 2]);
        let threshold_mps2 = self.threshold_mps2(&estimate);
        let lateral_mps2 = self.warner.lateral_mps2().map(f64::abs);
        let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
        #[allow(clippy::cast_precision_loss)] // at most ten thousand
        let maneuvers = estimate.maneuvers.len() as f64;
        let values = [
            number(estimate.height_m),
            number(estimate.height_sd_m),
            low_m,
            high_m,
            number(threshold_mps2.map(|threshold| threshold.value)),
            number(threshold_mps2.map(|threshold| threshold.sd)),
            number(threshold_mps2.zip(lateral_mps2).map(|(limit, used)| limit.value - used)),
            maneuvers,
            match self.state {
                Status::Absent => 1.0,
                Status::Straight => 2.0,
                Status::Turning => 3.0,
            },
            match estimate.status {
                Verdict::Ok => 1.0,
                Verdict::Rejected => 2.0,
                Verdict::Inconsistent => 3.0,
            },
        ];
        for (output, value) in outputs.iter_mut().zip(values) {
            *output = value;
        }
    }

    fn messages(&self) -> Vec<String> {
        let messages = self.estimator.clone().finish().messages;
        messages.iter().map(|message| hint::told(message, option)).collect()
    }

    fn copy(&self) -> Box<dyn Running> {
        Box::new(self.clone())
    }
}

/// An option in a message, of which an FMU has none: they are those of its maker and of the vehicle file.
fn option(name: &str, value: &str) -> String {
    format!("`{}`", [name, value].join(" ").trim_end())
}

impl RunningEstimator {
    /// The rollover threshold at the present speed.
    fn threshold_mps2(&self, estimate: &LogEstimate) -> Option<Measured<f64>> {
        let height_m = Measured { value: estimate.height_m?, sd: estimate.height_sd_m? };
        let design = self.estimator.design();
        let rollover = design.rollover(height_m, estimate.trailer_mass_kg, self.speed_mps)?;
        let Measured { value, sd } = rollover.static_rollover_threshold_g;
        Some(Measured { value: value * self.gravity_mps2, sd: sd * self.gravity_mps2 })
    }
}
