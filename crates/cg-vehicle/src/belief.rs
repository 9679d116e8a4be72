//! The uncertainty of a vehicle: a Gaussian distribution of a few physical parameters.
//!
//! Springs, roll centers, tires and sensors are usually not measured on the individual truck that
//! carries the estimator. Their values in the vehicle file are the mean of a prior, and its
//! `[uncertainty]` table contains the standard deviations. Calibration runs turn the prior into a
//! posterior. The uncertainty of the DC ratios is computed in the same way from either of them.
//!
//! The place of the payload is not a parameter of the truck but of a load. Its uncertainty is added to
//! that of the ratios, and a calibration neither learns nor reduces it.
//!
//! For a factor the distribution is that of its logarithm, so the factor is never negative. For a
//! height it is a shift in meters.

use cg_core::{Channel, Input, Output};
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use crate::reduction::Shapes;
use crate::tables::{AligningMomentTable, LateralForceTable, Spring};
use crate::vehicle::{Axle, Tyre, Vehicle};

/// Number of parameters.
pub const PARAMETERS: usize = Parameter::ALL.len();

/// Deviations of the parameters from the vehicle file (logarithm of a factor, or meters).
pub type Deviations = SVector<f64, PARAMETERS>;
/// Covariance of the deviations.
pub type Covariance = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// An uncertain parameter of a vehicle or its sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Parameter {
    /// Roll stiffness of the trailer's suspensions, factor.
    TrailerRollStiffness,
    /// Roll stiffness of the tractor's suspensions, factor.
    TractorRollStiffness,
    /// Height of the roll centers of the suspensions, shift in meters.
    RollCenterHeight,
    /// Height of the tractor's sprung c.g., shift in meters.
    TractorCgHeight,
    /// Roll stiffness of the fifth wheel, factor.
    FifthWheelStiffness,
    /// Vertical stiffness of the tires, factor.
    TyreVerticalStiffness,
    /// Cornering stiffness of the tires of the steered axles, factor.
    SteeredCorneringStiffness,
    /// Cornering stiffness of the tires of the tractor's other axles, factor.
    DriveCorneringStiffness,
    /// Cornering stiffness of the tires of the trailer, factor.
    TrailerCorneringStiffness,
    /// True steer angle divided by the measured one, factor.
    SteeringGain,
    /// True lateral acceleration divided by the measured one, factor.
    LateralAccelerationGain,
    /// `R_c`: roll angle divided by that of the model (eq. 5.19), factor.
    Compensation,
    /// True specific force of the trailer divided by the measured one, factor.
    SpecificForceGain,
    /// True specific force of the tractor divided by the measured one, factor.
    TractorSpecificForceGain,
    /// Suspension roll of the trailer divided by that of the model, factor.
    SuspensionRollGain,
    /// Suspension roll of the tractor divided by that of the model, factor.
    TractorSuspensionRollGain,
    /// Torsional stiffness of the trailer's frame, factor.
    FrameTorsionalStiffness,
    /// Friction of the trailer's measured springs, factor.
    TrailerSpringFriction,
    /// Friction of the tractor's measured springs, factor.
    TractorSpringFriction,
    /// Cornering stiffness of all tires at twice the middle load of their tables, over that at the middle, factor.
    CorneringOverLoad,
}

impl Parameter {
    /// All parameters, in the order of [`Deviations`].
    pub const ALL: [Self; 20] = [
        Self::TrailerRollStiffness,
        Self::TractorRollStiffness,
        Self::RollCenterHeight,
        Self::TractorCgHeight,
        Self::FifthWheelStiffness,
        Self::TyreVerticalStiffness,
        Self::SteeredCorneringStiffness,
        Self::DriveCorneringStiffness,
        Self::TrailerCorneringStiffness,
        Self::SteeringGain,
        Self::LateralAccelerationGain,
        Self::Compensation,
        Self::SpecificForceGain,
        Self::TractorSpecificForceGain,
        Self::SuspensionRollGain,
        Self::TractorSuspensionRollGain,
        Self::FrameTorsionalStiffness,
        Self::TrailerSpringFriction,
        Self::TractorSpringFriction,
        Self::CorneringOverLoad,
    ];

    /// The name of the parameter in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::TrailerRollStiffness => "trailer suspension roll stiffness",
            Self::TractorRollStiffness => "tractor suspension roll stiffness",
            Self::RollCenterHeight => "roll-center height",
            Self::TractorCgHeight => "tractor c.g. height",
            Self::FifthWheelStiffness => "fifth-wheel roll stiffness",
            Self::TyreVerticalStiffness => "vertical tire stiffness",
            Self::SteeredCorneringStiffness => "cornering stiffness, steered axles",
            Self::DriveCorneringStiffness => "cornering stiffness, drive axles",
            Self::TrailerCorneringStiffness => "cornering stiffness, trailer axles",
            Self::SteeringGain => "steering gain",
            Self::LateralAccelerationGain => "lateral-acceleration gain",
            Self::Compensation => "compensation R_c",
            Self::SpecificForceGain => "specific-force gain, trailer",
            Self::TractorSpecificForceGain => "specific-force gain, tractor",
            Self::SuspensionRollGain => "suspension-roll gain, trailer",
            Self::TractorSuspensionRollGain => "suspension-roll gain, tractor",
            Self::FrameTorsionalStiffness => "trailer frame torsional stiffness",
            Self::TrailerSpringFriction => "friction of the trailer's springs",
            Self::TractorSpringFriction => "friction of the tractor's springs",
            Self::CorneringOverLoad => "cornering stiffness over load",
        }
    }

    /// The gain of the signal that is the input of a channel.
    pub const fn of_input(input: Input) -> Self {
        match input {
            Input::Steer => Self::SteeringGain,
            Input::LateralAcceleration => Self::LateralAccelerationGain,
            Input::SpecificForce => Self::SpecificForceGain,
            Input::TractorSpecificForce => Self::TractorSpecificForceGain,
        }
    }

    /// The gain of the roll angle that a channel explains.
    pub const fn of_output(output: Output) -> Self {
        match output {
            Output::Roll => Self::Compensation,
            Output::SuspensionRoll => Self::SuspensionRollGain,
            Output::TractorSuspensionRoll => Self::TractorSuspensionRollGain,
        }
    }

    /// Whether the equations of a vehicle contain the parameter. They do not contain the gains of sensors, and not what the
    /// vehicle does not have: a frame that twists, or springs with friction.
    pub(crate) fn is_in_model_of(self, vehicle: &Vehicle) -> bool {
        match self {
            Self::FrameTorsionalStiffness => vehicle.trailer.frame_nm_per_rad().is_some(),
            Self::TrailerSpringFriction => vehicle.has_measured_springs_on(true),
            Self::TractorSpringFriction => vehicle.has_measured_springs_on(false),
            _ => Channel::ALL.into_iter().all(|channel| {
                self != Self::of_input(channel.input()) && self != Self::of_output(channel.output())
            }),
        }
    }

    /// Whether the deviation is the logarithm of a factor; otherwise it is in meters.
    pub const fn is_factor(self) -> bool {
        !matches!(self, Self::RollCenterHeight | Self::TractorCgHeight)
    }
}

/// A Gaussian distribution of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Belief {
    /// Mean of the deviations.
    pub mean: Deviations,
    /// Covariance of the deviations.
    pub covariance: Covariance,
    /// Relative standard deviation of the rest of the model error, which differs in every situation
    /// and which no calibration removes.
    pub residual_sd: f64,
    /// The shapes of the responses that a calibration found.
    pub shapes: Shapes,
}

impl Belief {
    /// The prior, as given by the vehicle file.
    pub fn prior(vehicle: &Vehicle) -> Self {
        let u = &vehicle.uncertainty;
        let sd = |parameter| match parameter {
            Parameter::TrailerRollStiffness | Parameter::TractorRollStiffness => {
                u.roll_stiffness_sd
            }
            Parameter::RollCenterHeight => u.roll_center_height_sd_m,
            Parameter::TractorCgHeight => u.tractor_cg_height_sd_m,
            Parameter::FifthWheelStiffness => u.fifth_wheel_stiffness_sd,
            Parameter::FrameTorsionalStiffness => {
                vehicle.trailer.frame_sd(u.frame_torsional_stiffness_sd)
            }
            Parameter::TrailerSpringFriction | Parameter::TractorSpringFriction
                if parameter.is_in_model_of(vehicle) =>
            {
                u.spring_friction_sd
            }
            Parameter::TrailerSpringFriction | Parameter::TractorSpringFriction => 0.0,
            Parameter::TyreVerticalStiffness => u.tyre_vertical_stiffness_sd,
            Parameter::SteeredCorneringStiffness
            | Parameter::DriveCorneringStiffness
            | Parameter::TrailerCorneringStiffness => u.cornering_stiffness_sd,
            Parameter::CorneringOverLoad => u.cornering_over_load_sd,
            Parameter::SteeringGain => u.steering_gain_sd,
            Parameter::LateralAccelerationGain => u.lateral_acceleration_gain_sd,
            Parameter::Compensation => u.compensation_sd,
            Parameter::SpecificForceGain | Parameter::TractorSpecificForceGain => {
                u.specific_force_gain_sd
            }
            Parameter::SuspensionRollGain | Parameter::TractorSuspensionRollGain => {
                u.suspension_roll_gain_sd
            }
        };
        let variances = Deviations::from_iterator(
            Parameter::ALL.into_iter().map(|parameter| sd(parameter) * sd(parameter)),
        );
        Self {
            mean: Deviations::zeros(),
            covariance: Covariance::from_diagonal(&variances),
            residual_sd: u.residual_sd,
            shapes: Shapes::default(),
        }
    }

    /// Deviations drawn from a belief without correlation, such as the prior. `standard` returns numbers of
    /// the standard normal distribution; it is called once for each parameter that is not certain, but for the
    /// last one, so that the trucks that a seed gives did not change when that was added.
    pub fn drawn(&self, mut standard: impl FnMut() -> f64) -> Deviations {
        let mut last = 0;
        Deviations::from_fn(|k, _| {
            let sd = self.covariance[(k, k)].sqrt();
            let normal = if k == Parameter::CorneringOverLoad as usize {
                scrambled(last)
            } else if sd > 0.0 {
                standard()
            } else {
                0.0
            };
            last ^= normal.to_bits();
            self.mean[k] + sd * normal
        })
    }

    /// The vehicle with its parameters at the mean.
    pub fn applied_to(&self, vehicle: &Vehicle) -> Vehicle {
        adjusted(vehicle, &self.mean)
    }

    /// The factor of the DC ratio of a channel: `R_c` times the gain of its sensor.
    pub fn gain(&self, channel: Channel) -> f64 {
        libm::exp(log_gain(&self.mean, channel))
    }

    /// `R_c`: the roll angle divided by that of the model at the mean of the parameters.
    pub(crate) fn roll_gain(&self) -> f64 {
        libm::exp(value(&self.mean, Parameter::Compensation))
    }
}

/// A number of the standard normal distribution, to 1 %: the sum of twelve even ones that follow from a seed by
/// `SplitMix64` (Steele, Lea and Flood, OOPSLA 2014).
fn scrambled(mut seed: u64) -> f64 {
    let mut even = || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        #[allow(clippy::cast_precision_loss)] // 53 bits
        let share = ((bits ^ (bits >> 31)) >> 11) as f64;
        share * 0.5 * f64::EPSILON - 0.5
    };
    (0..12).map(|_| even()).sum()
}

fn value(deviations: &Deviations, parameter: Parameter) -> f64 {
    deviations[parameter as usize]
}

/// Logarithm of the factor from the true input to the *measured* one: a sensor that reads too low
/// makes the ratio larger.
pub fn log_gain(deviations: &Deviations, channel: Channel) -> f64 {
    value(deviations, Parameter::of_input(channel.input()))
        + value(deviations, Parameter::of_output(channel.output()))
}

/// The vehicle with these deviations of its parameters.
pub fn adjusted(vehicle: &Vehicle, deviations: &Deviations) -> Vehicle {
    let factor = |parameter| libm::exp(value(deviations, parameter));
    let mut moved = vehicle.clone();
    moved.tractor.cg_height_m += value(deviations, Parameter::TractorCgHeight);
    moved.hitch.roll_stiffness_nm_per_rad *= factor(Parameter::FifthWheelStiffness);
    if let Some(stiffness) = vehicle.trailer.frame_nm_per_rad() {
        moved.trailer.frame_torsional_stiffness_nm_per_rad =
            Some(stiffness * factor(Parameter::FrameTorsionalStiffness));
    }
    moved.tyre.clear();
    let find = |axle: &Axle| vehicle.tyre.iter().find(|tyre| tyre.name == axle.tyre);
    let vertical = factor(Parameter::TyreVerticalStiffness);
    let over_load = value(deviations, Parameter::CorneringOverLoad);
    let shift_m = value(deviations, Parameter::RollCenterHeight);
    let mut adjust = |axle: &mut Axle, [stiffness, cornering, friction]: [Parameter; 3]| {
        // The change is added as roll stiffness that is separate from the springs, so that the
        // static loads do not change.
        let half_spread_m = 0.5 * axle.spring_spread_m;
        let springs = 2.0 * axle.spring_stiffness_n_per_m * half_spread_m * half_spread_m;
        let total = springs + axle.auxiliary_roll_stiffness_nm_per_rad;
        axle.auxiliary_roll_stiffness_nm_per_rad = factor(stiffness) * total - springs;
        axle.roll_center_height_m += shift_m;
        // The springs of each unit get names of their own, because units may share a type.
        let changed = value(deviations, friction) != 0.0;
        if let Some(spring) = vehicle.spring_of(axle).filter(|_| changed) {
            let name = format!("{}, {}", spring.name, friction.words());
            if moved.spring.iter().all(|known| known.name != name) {
                let scaled = spring.clone().with_friction(factor(friction));
                moved.spring.push(Spring { name: name.clone(), ..scaled });
            }
            axle.spring = Some(name);
        }
        // Each axle gets its own tire type, because axles may share a type.
        if let Some(tyre) = find(axle) {
            axle.tyre = format!("{} {}", moved.tyre.len() + 1, tyre.name);
            let mut scaled = Tyre { name: axle.tyre.clone(), ..tyre.clone() };
            scaled.vertical_stiffness_n_per_m *= vertical;
            scale_cornering(&mut scaled, factor(cornering), over_load);
            moved.tyre.push(scaled);
        }
    };
    for axle in &mut moved.tractor.axle {
        let cornering = if axle.steered {
            Parameter::SteeredCorneringStiffness
        } else {
            Parameter::DriveCorneringStiffness
        };
        let friction = Parameter::TractorSpringFriction;
        adjust(&mut axle.axle, [Parameter::TractorRollStiffness, cornering, friction]);
    }
    for axle in &mut moved.trailer.axle {
        let cornering = Parameter::TrailerCorneringStiffness;
        let friction = Parameter::TrailerSpringFriction;
        adjust(&mut axle.axle, [Parameter::TrailerRollStiffness, cornering, friction]);
    }
    moved
}

/// Multiplies the cornering and aligning stiffness of a tire by a factor at the middle load of its tables and by another
/// one more at each doubling of the load. Below an eighth of that load the change ends.
fn scale_cornering(tyre: &mut Tyre, factor: f64, over_load: f64) {
    let at = |loads_n: &[f64]| -> Vec<f64> {
        let [first, .., last] = loads_n else { return vec![factor; loads_n.len()] };
        let middle_n = 0.5 * (first + last);
        let doublings = |load_n: &f64| libm::log2((load_n / middle_n).max(0.125));
        loads_n.iter().map(|load_n| factor * libm::exp(over_load * doublings(load_n))).collect()
    };
    let scale = |loads_n: &[f64], rows: &mut dyn Iterator<Item = &mut Vec<f64>>| {
        let by = at(loads_n);
        rows.for_each(|row| row.iter_mut().zip(&by).for_each(|(entry, by)| *entry *= by));
    };
    let Tyre { cornering_stiffness_n_per_rad, aligning_stiffness_nm_per_rad, .. } = tyre;
    let mut both = [cornering_stiffness_n_per_rad, aligning_stiffness_nm_per_rad].into_iter();
    scale(&tyre.load_n, &mut both);
    if let Some(LateralForceTable { load_n, coefficient, .. }) = &mut tyre.lateral_force {
        scale(load_n, &mut coefficient.iter_mut());
    }
    if let Some(AligningMomentTable { load_n, moment_nm, .. }) = &mut tyre.aligning_moment {
        scale(load_n, &mut moment_nm.iter_mut());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the middle load the factor alone, at twice that load one doubling, and none more below an eighth.
    #[test]
    fn a_tire_changes_with_the_load() {
        let mut tyre: Tyre = toml::from_str(
            "name = \"t\"\nvertical_stiffness_n_per_m = 1e6\nload_n = [1e3, 2e3, 2e4, 3.9e4]\n\
             cornering_stiffness_n_per_rad = [1.0, 1.0, 1.0, 1.0]\n\
             aligning_stiffness_nm_per_rad = [1.0, 1.0, 1.0, 1.0]\n",
        )
        .unwrap();
        let by = 0.1_f64;
        scale_cornering(&mut tyre, 2.0, by);
        let expected =
            [-3.0, -3.0, 0.0, libm::log2(1.95)].map(|doublings| 2.0 * (by * doublings).exp());
        for table in [&tyre.cornering_stiffness_n_per_rad, &tyre.aligning_stiffness_nm_per_rad] {
            for (found, expected) in table.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
            }
        }
    }

    /// Mean, variance and the share beyond two standard deviations (4.6 %) of 10 000 numbers, within four of their
    /// own standard deviations.
    #[test]
    fn scrambled_numbers_are_normal() {
        let numbers: Vec<f64> = (0..10_000).map(scrambled).collect();
        let mean = |of: fn(f64) -> f64| numbers.iter().map(|x| of(*x)).sum::<f64>() / 1e4;
        assert!(mean(|x| x).abs() < 0.04 && (mean(|x| x * x) - 1.0).abs() < 0.057);
        let beyond = mean(|x| if x.abs() > 2.0 { 1.0 } else { 0.0 });
        assert!((beyond - 0.0455).abs() < 0.0084, "{beyond}");
    }
}
