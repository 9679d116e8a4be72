//! The nonlinear plant, step by step, with what perfect sensors show of it.

use super::scenario::with_payload_at;
use super::signals::Signals;
use crate::plant::{
    Driver, DriverSettings, Ground, Moment, Path, PlantOptions, PlantSample, Progress, Simulation,
    YawRollPlant,
};
use cg_logs::log::LogRow;
use cg_vehicle::error::VehicleError;
use cg_vehicle::limits;
use cg_vehicle::{Load, Vehicle};

/// Steepest bank or grade of a road.
const GREATEST_SLOPE_RAD: f64 = 0.5;

/// The load and the first instant of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantStart {
    /// The trailer's load.
    pub load: Load,
    /// Distance of the payload's c.g. behind the fifth wheel.
    pub payload_behind_hitch_m: f64,
    /// Distance of the payload's c.g. to the left of the middle.
    pub payload_left_m: f64,
    /// Forward speed.
    pub speed_mps: f64,
    /// Bank of the road, left side higher positive.
    pub bank_rad: f64,
    /// Grade of the road, uphill positive.
    pub grade_rad: f64,
}

impl PlantStart {
    /// The load and the speed of the vehicle file, on a flat road.
    pub fn of(vehicle: &Vehicle) -> Self {
        Self {
            load: vehicle.reference_load(),
            payload_behind_hitch_m: vehicle.trailer.payload.behind_hitch_m,
            payload_left_m: 0.0,
            speed_mps: vehicle.nominal_speed_mps,
            bank_rad: 0.0,
            grade_rad: 0.0,
        }
    }
}

/// What the driver and the road do until the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantInput {
    /// Mean road-wheel angle, left positive.
    pub steer_rad: f64,
    /// Forward speed.
    pub speed_mps: f64,
    /// The road under the vehicle.
    pub ground: Ground,
}

impl PlantInput {
    /// Checks that a vehicle can have this input.
    ///
    /// # Errors
    /// [`VehicleError::Model`] that names the number and its limit.
    pub fn check(&self) -> Result<(), VehicleError> {
        limits::positive("speed_mps", self.speed_mps, limits::GREATEST_SPEED_MPS)?;
        for (name, angle_rad, greatest_rad) in [
            ("steer_rad", self.steer_rad, limits::GREATEST_STEER_RAD),
            ("bank_rad", self.ground.bank_rad, GREATEST_SLOPE_RAD),
            ("grade_rad", self.ground.grade_rad, GREATEST_SLOPE_RAD),
        ] {
            if !(angle_rad.abs() <= greatest_rad) {
                return Err(VehicleError::Model(format!(
                    "{name} {angle_rad} must lie between {} and {greatest_rad}",
                    -greatest_rad
                )));
            }
        }
        Ok(())
    }
}

/// A run of the nonlinear plant from straight driving on. Simulated logs, Python and FMUs all step the
/// plant by it.
#[derive(Clone, Debug)]
pub struct PlantRun {
    run: Simulation<'static>,
    signals: Signals,
}

impl PlantRun {
    /// A vehicle under its load that drives straight.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle cannot carry this load or cannot drive straight, or if a number is
    /// invalid.
    pub fn new(vehicle: &Vehicle, start: &PlantStart) -> Result<Self, VehicleError> {
        start.load.check()?;
        let vehicle = &*with_payload_at(vehicle, start.load, start.payload_behind_hitch_m)?;
        let PlantStart { load, payload_left_m, speed_mps, bank_rad, grade_rad, .. } = *start;
        let ground = Ground { bank_rad, grade_rad, ..Ground::default() };
        PlantInput { steer_rad: 0.0, speed_mps, ground }.check()?;
        let options =
            PlantOptions { bank_rad, grade_rad, payload_left_m, ..PlantOptions::default() };
        Self::of(vehicle, load, &options, speed_mps)
    }

    /// The same, unchecked, of a vehicle whose payload is where it is.
    pub(super) fn of(
        vehicle: &Vehicle,
        load: Load,
        options: &PlantOptions,
        speed_mps: f64,
    ) -> Result<Self, VehicleError> {
        let run = YawRollPlant::new(vehicle, load, options)?.into_run(speed_mps)?;
        Ok(Self { run, signals: Signals::new(vehicle, load.trailer_mass_kg, true) })
    }

    /// The same without sensors of suspension roll and specific force.
    pub(super) fn without_chassis(mut self) -> Self {
        self.signals = self.signals.without_chassis();
        self
    }

    /// Drives on for an interval, to the input at its end, which is reached linearly. A vehicle that has
    /// rolled over does not move any more.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if the vehicle cannot have this input, or the interval is not positive.
    pub fn step(&mut self, input: &PlantInput, interval_s: f64) -> Result<Progress, VehicleError> {
        limits::positive("interval_s", interval_s, limits::GREATEST_DURATION_S)?;
        input.check()?;
        Ok(self.run.push_on(input.steer_rad, input.speed_mps, &input.ground, interval_s))
    }

    /// A driver who follows a path at the present speed. The vehicle is where the path begins.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if the tractor has no bicycle model, or a setting is invalid.
    pub fn driver(&self, path: Path, settings: DriverSettings) -> Result<Driver, VehicleError> {
        Driver::new(self.run.plant(), path, self.run.control().speed_mps, settings)
    }

    /// Drives on for an interval, steered by a driver, to a road at its end, which is reached linearly. The
    /// speed is that of the driver.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if the vehicle cannot be on such a road, or the interval is not positive.
    pub fn follow(
        &mut self,
        driver: &mut Driver,
        ground: Ground,
        interval_s: f64,
    ) -> Result<Progress, VehicleError> {
        let from = *self.run.control();
        PlantInput { steer_rad: 0.0, speed_mps: from.speed_mps, ground }.check()?;
        let start_s = self.run.time_s();
        self.drive(interval_s, |run, until_s, _| PlantInput {
            steer_rad: driver.steer_rad(run),
            speed_mps: from.speed_mps,
            ground: from.ground.towards(&ground, (until_s - start_s) / interval_s),
        })
    }

    /// Drives on for an interval with an input that is asked for at every step of the plant: `next` gets
    /// the run, the time of the end of the step, and its length. The inputs are not checked. It ends at a
    /// rollover.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if the interval is not positive.
    pub fn drive(
        &mut self,
        interval_s: f64,
        mut next: impl FnMut(&Simulation<'_>, f64, f64) -> PlantInput,
    ) -> Result<Progress, VehicleError> {
        limits::positive("interval_s", interval_s, limits::GREATEST_DURATION_S)?;
        let steps = self.run.plant().steps(interval_s);
        let start_s = self.run.time_s();
        let step_s = interval_s / f64::from(steps);
        for done in 1..=steps {
            let until_s = start_s + interval_s * f64::from(done) / f64::from(steps);
            let input = next(&self.run, until_s, step_s);
            let PlantInput { steer_rad, speed_mps, ground } = input;
            if self.run.push_on(steer_rad, speed_mps, &ground, step_s) != Progress::Running {
                break;
            }
        }
        Ok(self.run.progress())
    }

    /// Goes on from a moment ([`Simulation::moment`]) of the same vehicle with the same start.
    ///
    /// # Errors
    /// As [`Simulation::go_on_from`].
    pub fn go_on_from(&mut self, moment: &Moment) -> Result<(), VehicleError> {
        self.run.go_on_from(moment)
    }

    /// Lets another wind blow from now on ([`Simulation::blow`]).
    pub(super) fn blow(&mut self, wind_mps: [f64; 2]) {
        self.run.blow(wind_mps);
    }

    /// The run itself: state, time and progress.
    pub fn simulation(&self) -> &Simulation<'static> {
        &self.run
    }

    /// The present values of the vehicle.
    pub fn sample(&self) -> PlantSample {
        self.run.sample()
    }

    /// What perfect sensors show of a sample at a time.
    pub fn row(&self, time_s: f64, sample: &PlantSample) -> LogRow {
        self.signals.row(time_s, sample)
    }
}
