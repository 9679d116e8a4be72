//! A driver on a road: steers for its curvature and its bank, and keeps its speed.
//!
//! ```text
//!     steer = (L + K v²) κ + B β + (L + K v²)/(v T) e
//! ```
//!
//! `κ` is the curvature at the drive axles 0.2 s ahead, `β` the bank, `e` the direction of the road
//! minus the course of the drive axles. `L + K v²` is the steer angle per curvature of the linear
//! model in a steady turn; `B` is the steer angle per bank with which the plant drives straight. An
//! error of the course decays with the time constant `T`. The lateral position is not controlled.

use super::plant_run::PlantInput;
use crate::plant::{Coordinate, Ground, MAX_AXLES, PlantOptions, Simulation, YawRollPlant};
use crate::road::{Pace, Road};
use cg_vehicle::equations::Equations;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Variant, Vehicle};

/// The plane of the road is that at this distance behind the front axle: about the middle between the
/// c.g.s of tractor and trailer.
const BEHIND_FRONT_AXLE_M: f64 = 5.0;
/// How far ahead the driver steers.
const AHEAD_S: f64 = 0.2;
/// Time constant of the course.
const COURSE_S: f64 = 2.0;
/// Speeds at which the steer angle per curvature is computed.
const SPEEDS_MPS: [f64; 2] = [8.0, 20.0];
/// Bank on which the steer angle per bank is computed.
const BANK_RAD: f64 = 0.02;

/// A driver on a road.
#[derive(Clone, Debug)]
pub(super) struct RoadDriver {
    road: Road,
    pace: Pace,
    /// Steer angle per curvature: at low speed, and per square of the speed.
    by_curvature: [f64; 2],
    by_bank: f64,
    /// Distance of the drive axles behind the front axle and behind the tractor's c.g.
    drive_axle_m: [f64; 2],
    /// Distance of each axle behind the front axle, on a straight road.
    axle_m: Vec<f64>,
    /// Distance of the front axle along the road.
    front_m: f64,
    /// Course of the vehicle where it drives along the road's first direction.
    first_course_rad: Option<f64>,
}

impl RoadDriver {
    /// At the start of a road that has a speed limit.
    ///
    /// # Errors
    /// If the vehicle has no steady turn or cannot drive straight.
    pub(super) fn new(
        vehicle: &Vehicle,
        variant: Variant,
        load: Load,
        road: &Road,
    ) -> Result<Self, VehicleError> {
        let per_curvature = |speed_mps: f64| -> Result<f64, VehicleError> {
            let model = Equations::new(vehicle, variant, speed_mps, load)?.state_space()?;
            Ok(speed_mps / model.steady(&model.tractor_yaw_rate, 0.0)?)
        };
        let [slow, fast] = SPEEDS_MPS;
        let (first, second) = (per_curvature(slow)?, per_curvature(fast)?);
        let by_square = (second - first) / (fast * fast - slow * slow);
        let options = PlantOptions { bank_rad: BANK_RAD, ..PlantOptions::default() };
        let banked = YawRollPlant::new(vehicle, load, &options)?;
        let straight = banked.start(vehicle.nominal_speed_mps)?;
        let ahead_m = |axle| banked.axle_position_m(&straight.state, axle)[0];
        let first_m = (0..vehicle.axles().len()).map(ahead_m).fold(f64::MIN, f64::max);
        let axle_m = (0..vehicle.axles().len()).map(|axle| first_m - ahead_m(axle)).collect();
        let axles = &vehicle.tractor.axle;
        let front_m = axles.iter().map(|axle| axle.ahead_of_cg_m).fold(f64::MIN, f64::max);
        let drive = || axles.iter().filter(|axle| !axle.steered);
        #[allow(clippy::cast_precision_loss)] // one or two axles
        let drive_m = drive().map(|axle| axle.ahead_of_cg_m).sum::<f64>() / drive().count() as f64;
        Ok(Self {
            pace: road.pace(),
            front_m: road.ends_m()[0],
            road: road.clone(),
            by_curvature: [first - by_square * slow * slow, by_square],
            by_bank: straight.sample().steer_rad / BANK_RAD,
            axle_m,
            drive_axle_m: [front_m - drive_m, -drive_m],
            first_course_rad: None,
        })
    }

    /// Speed and road at the present place.
    pub(super) fn start(&self) -> (f64, Ground) {
        (self.pace.speed_mps(self.front_m), self.ground())
    }

    /// Distance of the front axle along the road.
    pub(super) fn distance_m(&self) -> f64 {
        self.front_m
    }

    fn ground(&self) -> Ground {
        let plane = self.road.at(self.front_m - BEHIND_FRONT_AXLE_M);
        let mut twist_rad = [0.0; MAX_AXLES];
        if self.road.is_twisted() {
            for (twist_rad, behind_m) in twist_rad.iter_mut().zip(&self.axle_m) {
                *twist_rad = self.road.at(self.front_m - behind_m).bank_rad - plane.bank_rad;
            }
        }
        Ground { bank_rad: plane.bank_rad, grade_rad: plane.grade_rad, twist_rad }
    }

    /// Drives on for one step.
    pub(super) fn next(&mut self, run: &Simulation<'_>, step_s: f64) -> PlantInput {
        let course_rad = self.course_rad(run);
        let before_mps = self.pace.speed_mps(self.front_m);
        let after_mps = self.pace.speed_mps(self.front_m + step_s * before_mps);
        self.front_m += 0.5 * step_s * (before_mps + after_mps);
        let speed_mps = self.pace.speed_mps(self.front_m);
        let drive_m = self.front_m - self.drive_axle_m[0];
        let curvature_per_m = self.road.at(drive_m + AHEAD_S * speed_mps).curvature_per_m;
        let first_rad = *self.first_course_rad.get_or_insert(course_rad);
        let error_rad = self.road.heading_rad(drive_m) - (course_rad - first_rad);
        let per_curvature = self.by_curvature[0] + self.by_curvature[1] * speed_mps * speed_mps;
        let ground = self.ground();
        let wanted_per_m = curvature_per_m + error_rad / (speed_mps * COURSE_S);
        let steer_rad = per_curvature * wanted_per_m + self.by_bank * ground.bank_rad;
        PlantInput { steer_rad, speed_mps, ground }
    }

    /// Direction in which the drive axles move.
    fn course_rad(&self, run: &Simulation<'_>) -> f64 {
        let value = |coordinate| run.state.get(coordinate);
        let side_mps = value(Coordinate::LateralVelocity)
            - self.drive_axle_m[1] * value(Coordinate::TractorYawRate);
        value(Coordinate::TractorYaw) + libm::atan2(side_mps, self.pace.speed_mps(self.front_m))
    }
}
