//! Section 5.7 with this project's nonlinear plant in place of the Yaw/Roll program: the baseline with
//! measured springs and tires, other logs than the calibration's.
//!
//! Two procedures see the same logs. *The thesis's* is its own: the as-printed linear model of the
//! baseline, `F(s)` of order 3 from a calibration log, ARX, eq. 5.20. *Ours* is the complete linear model
//! of the vehicle file, `R_c` from the same calibration log, and the filtered identifier with its standard
//! prior and a free offset.

use cg_core::{Channel, RatioLine, Reduced5};
use cg_plant::plant::{PlantOptions, YawRollPlant};
use cg_vehicle::compensation::{Compensation, identify, validity_table};
use cg_vehicle::error::VehicleError;
use cg_vehicle::reduction::reduce;
use cg_vehicle::{LinearModel, Load, Variant, Vehicle};

use super::baseline::Baseline;
use super::monte_carlo::{Experiment, INTERVAL_S, RATE_PER_S, arx_ratio, standard_ratio, steps};
use super::solved::{bias_percent, solved};

/// Order of the compensation function that the thesis uses.
const F_ORDER: usize = 3;
/// Order of the ARX model that it uses.
const ARX_ORDER: usize = 5;
/// Steady lateral acceleration of the logs, g: "close to 0.2 g". The calibration drives more gently, and
/// at another rate of the step.
const LATERAL_G: f64 = 0.19;
const CALIBRATION_G: f64 = 0.15;
const CALIBRATION_RATE_PER_S: u32 = 1;

/// The nonlinear baseline.
pub(super) fn measured() -> Result<Vehicle, VehicleError> {
    let text = include_str!("../../fixtures/vehicles/baseline-tables.toml");
    Vehicle::parse(text, "fixtures/vehicles/baseline-tables.toml")
}

/// The vehicle with other springs on drive and trailer axles, measured curves included.
pub(super) fn with_springs(vehicle: &Vehicle, factor: f64) -> Vehicle {
    let mut truck = vehicle.clone();
    let mut named = Vec::new();
    let drive = truck.tractor.axle.iter_mut().filter(|axle| !axle.steered).map(|a| &mut a.axle);
    for axle in drive.chain(truck.trailer.axle.iter_mut().map(|a| &mut a.axle)) {
        axle.spring_stiffness_n_per_m *= factor;
        named.extend(axle.spring.clone());
    }
    for spring in truck.spring.iter_mut().filter(|spring| named.contains(&spring.name)) {
        for force_n in spring.compression_n.iter_mut().chain(&mut spring.extension_n) {
            *force_n *= factor;
        }
    }
    truck
}

/// Steer angle and roll angle of a truck in a rounded step.
pub(super) fn drive(
    truck: &Vehicle,
    load: Load,
    steer_rad: f64,
    rate_per_s: u32,
) -> Result<Experiment, VehicleError> {
    let speed_mps = truck.nominal_speed_mps;
    let plant = YawRollPlant::new(truck, load, &PlantOptions::default())?;
    let mut run = plant.start(speed_mps)?;
    let steer: Vec<f64> =
        steps(rate_per_s, INTERVAL_S).iter().map(|step| steer_rad * step).collect();
    let mut roll = Vec::with_capacity(steer.len());
    for (k, &steer_rad) in steer.iter().enumerate() {
        if k > 0 {
            run.push(steer_rad, speed_mps, INTERVAL_S);
        }
        roll.push(run.sample().trailer.roll_rad);
    }
    run.upright()?;
    Ok(Experiment { steer, roll })
}

/// What both procedures know of the vehicle before the calibration.
pub(super) struct Known<'a> {
    base: &'a Baseline,
    /// The nonlinear baseline.
    pub(super) vehicle: Vehicle,
    /// Its complete linear model and that model's reduction, from which our identifier starts.
    complete: LinearModel,
    nominal: Reduced5<f64>,
}

impl<'a> Known<'a> {
    pub(super) fn new(base: &'a Baseline) -> Result<Self, VehicleError> {
        let vehicle = measured()?;
        let (speed_mps, load) = (vehicle.nominal_speed_mps, vehicle.reference_load());
        let complete = LinearModel::new(&vehicle, Variant::Complete, speed_mps, load)?;
        let nominal = reduce(&complete.state_space, &[])?.of_channels[Channel::Steer.index()];
        Ok(Self { base, vehicle, complete, nominal })
    }

    pub(super) fn height_m(&self) -> f64 {
        self.vehicle.reference_load().cg_height_m
    }

    /// The steer angle that gives a lateral acceleration in the linear model.
    fn steer_rad(&self, lateral_g: f64) -> Result<f64, VehicleError> {
        let model = &self.complete.state_space;
        let gain = model.lateral_gain()?;
        Ok(lateral_g * self.vehicle.gravity_mps2 / gain)
    }

    /// The steer angle of the logs from which heights are estimated.
    pub(super) fn log_steer_rad(&self) -> Result<f64, VehicleError> {
        self.steer_rad(LATERAL_G)
    }

    /// The log of a truck at a height from which the height is estimated.
    pub(super) fn log(&self, truck: &Vehicle, height_m: f64) -> Result<Experiment, VehicleError> {
        let load = Load { cg_height_m: height_m, ..truck.reference_load() };
        drive(truck, load, self.log_steer_rad()?, RATE_PER_S)
    }

    /// Another log of the truck, at the reference height, which is known.
    pub(super) fn calibration_log(&self, truck: &Vehicle) -> Result<Experiment, VehicleError> {
        let steer_rad = self.steer_rad(CALIBRATION_G)?;
        drive(truck, truck.reference_load(), steer_rad, CALIBRATION_RATE_PER_S)
    }

    /// The thesis's analytical model in a log.
    pub(super) fn analytical(&self, log: &Experiment) -> Vec<f64> {
        let model = self.base.as_printed.state_space.to_trailer_roll();
        model.response(&log.steer, INTERVAL_S)
    }

    /// The compensation functions of orders 1 to 6 of the nonlinear baseline (Table 5.1).
    pub(super) fn functions(&self) -> Result<Vec<Compensation>, VehicleError> {
        let log = self.calibration_log(&self.vehicle)?;
        validity_table(&self.analytical(&log), &log.roll, INTERVAL_S)
    }

    /// Both procedures calibrated with the calibration log of a truck.
    pub(super) fn calibrated(&self, truck: &Vehicle) -> Result<Procedures, VehicleError> {
        let log = self.calibration_log(truck)?;
        let function = identify(&self.analytical(&log), &log.roll, INTERVAL_S, F_ORDER)?;
        let ratio = standard_ratio(&self.nominal, &log.steer, &log.roll, INTERVAL_S);
        let ratio = ratio.ok_or_else(not_identified)?;
        Ok(Procedures {
            thesis: (self.base.as_printed.ratio[0], function.dc_gain),
            ours: (
                self.complete.ratio[0],
                ratio / self.complete.ratio[0].ratio_at(self.height_m()),
            ),
            function,
            nominal: self.nominal,
            true_height_m: self.height_m(),
        })
    }
}

fn not_identified() -> VehicleError {
    VehicleError::Model("a log of the nonlinear plant does not determine a ratio".to_owned())
}

/// Both procedures on one truck.
pub(super) struct Procedures {
    /// Ratio over height and compensation of the thesis's procedure.
    pub(super) thesis: (RatioLine<f64>, f64),
    /// Those of ours.
    pub(super) ours: (RatioLine<f64>, f64),
    /// The compensation function of the thesis's procedure.
    pub(super) function: Compensation,
    nominal: Reduced5<f64>,
    true_height_m: f64,
}

impl Procedures {
    /// Error of the thesis's height, %, with an ARX model of this order.
    pub(super) fn thesis_percent(&self, order: usize, steer: &[f64], roll: &[f64]) -> Option<f64> {
        let height_m =
            solved(&self.thesis.0, arx_ratio(order, steer, roll)?, self.thesis.1).ok()?;
        Some(bias_percent(height_m, self.true_height_m))
    }

    /// Error of our height, %.
    pub(super) fn ours_percent(&self, steer: &[f64], roll: &[f64]) -> Option<f64> {
        let ratio = standard_ratio(&self.nominal, steer, roll, INTERVAL_S)?;
        let height_m = solved(&self.ours.0, ratio, self.ours.1).ok()?;
        Some(bias_percent(height_m, self.true_height_m))
    }

    /// The errors of both in a log whose height is `true_height_m`, %: the thesis's and ours.
    pub(super) fn errors_percent(
        self,
        log: &Experiment,
        true_height_m: f64,
    ) -> Result<[f64; 2], VehicleError> {
        let at = Self { true_height_m, ..self };
        let thesis = at.thesis_percent(ARX_ORDER, &log.steer, &log.roll);
        let ours = at.ours_percent(&log.steer, &log.roll);
        Ok([thesis.ok_or_else(not_identified)?, ours.ok_or_else(not_identified)?])
    }
}
