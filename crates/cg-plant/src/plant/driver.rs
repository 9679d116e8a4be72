//! A preview driver: MacAdam's optimal preview control (1980, 1981).
//!
//! The driver models the tractor as a bicycle, `ẋ = F x + g δ` with `x = (y, v, ψ, r)`, and chooses
//! the steer angle that, held over the preview time `T`, brings the tractor closest to the path:
//!
//! ```text
//!     y(t + η) = mᵀ Φ(η) x + A(η) δ          A(η) = mᵀ ∫ Φ g
//!     δ        = ∫ (f(η) − mᵀ Φ(η) x) A(η) dη / ∫ A² dη
//! ```
//!
//! where `f(η)` is the path in the tractor's own axes. **Reference.** MacAdam, ASME J. Dyn. Syst. Meas.
//! Control 102 (1980) and IEEE Trans. SMC 11 (1981).

use nalgebra::{DMatrix, Matrix2, Vector2};

use super::integrate::{Progress, Simulation};
use super::path::Path;
use super::state::Coordinate;
use super::yaw_roll::YawRollPlant;
use cg_vehicle::error::VehicleError;
use cg_vehicle::matrix::exponential;
use serde::{Deserialize, Serialize};

/// Number of preview points.
const POINTS: usize = 15;

/// Settings of the driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriverSettings {
    /// Preview time.
    pub preview_s: f64,
    /// Delay of the driver's response.
    pub delay_s: f64,
    /// Lag of the driver's steering; zero for none.
    pub lag_s: f64,
}

impl Default for DriverSettings {
    fn default() -> Self {
        Self { preview_s: 1.5, delay_s: 0.0, lag_s: 0.0 }
    }
}

/// One point of the preview: how far ahead, row of `Φ`, effect of the steer angle.
#[derive(Clone, Copy, Debug)]
struct Preview {
    ahead_m: f64,
    by_velocity: f64,
    by_yaw_rate: f64,
    by_steer: f64,
}

/// A driver on a path at constant speed.
#[derive(Clone, Debug)]
pub struct Driver {
    path: Path,
    preview: Vec<Preview>,
    speed_mps: f64,
    arc_m: f64,
    lag_s: f64,
    steer_rad: f64,
    /// Ring buffer of responses that are delayed.
    delayed: Vec<f64>,
    next: usize,
    interval_s: f64,
}

/// What changes while a driver drives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriverMoment {
    arc_m: f64,
    steer_rad: f64,
    delayed: Vec<f64>,
    next: usize,
}

impl Driver {
    /// A driver of this plant, who responds at every step of it.
    ///
    /// # Errors
    /// If the tractor has no bicycle model, or a setting is invalid.
    pub fn new(
        plant: &YawRollPlant,
        path: Path,
        speed_mps: f64,
        settings: DriverSettings,
    ) -> Result<Self, VehicleError> {
        let DriverSettings { preview_s, delay_s, lag_s } = settings;
        if !(preview_s > 0.0 && delay_s >= 0.0 && lag_s >= 0.0 && preview_s.is_finite()) {
            return Err(VehicleError::Model(format!(
                "driver: preview of {preview_s} s, delay of {delay_s} s, lag of {lag_s} s"
            )));
        }
        let (rates, steer) = plant.bicycle(speed_mps)?;
        let interval_s = plant.step_s();
        // The delay in steps; it is at most seconds.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let waiting = (delay_s / interval_s).round().min(1e6) as usize;
        Ok(Self {
            path,
            preview: preview(rates, steer, speed_mps, preview_s),
            speed_mps,
            arc_m: 0.0,
            lag_s,
            steer_rad: 0.0,
            delayed: vec![0.0; waiting],
            next: 0,
            interval_s,
        })
    }

    /// The steer angle for the next step.
    pub fn steer_rad(&mut self, run: &Simulation<'_>) -> f64 {
        let demanded_rad = self.demanded_steer_rad(run);
        let delayed_rad = match self.delayed.get_mut(self.next) {
            Some(oldest) => std::mem::replace(oldest, demanded_rad),
            None => demanded_rad,
        };
        self.next = if self.next + 1 < self.delayed.len() { self.next + 1 } else { 0 };
        if self.lag_s > 0.0 {
            self.steer_rad += (delayed_rad - self.steer_rad) * self.interval_s / self.lag_s;
        } else {
            self.steer_rad = delayed_rad;
        }
        self.steer_rad
    }

    fn demanded_steer_rad(&mut self, run: &Simulation<'_>) -> f64 {
        let value = |c| run.state.get(c);
        let position = [value(Coordinate::PositionX), value(Coordinate::PositionY)];
        self.arc_m = self.path.nearest(position, self.arc_m);
        let (sin, cos) = libm::sincos(value(Coordinate::TractorYaw));
        let (side, yaw) = (value(Coordinate::LateralVelocity), value(Coordinate::TractorYawRate));
        let (mut error, mut square) = (0.0, 0.0);
        for ahead in &self.preview {
            let [x, y] = self.path.point(self.arc_m + ahead.ahead_m);
            let off_m = cos * (y - position[1]) - sin * (x - position[0]);
            let drift_m = ahead.by_velocity * side + ahead.by_yaw_rate * yaw;
            error += (off_m - drift_m) * ahead.by_steer;
            square += ahead.by_steer * ahead.by_steer;
        }
        error / square
    }

    /// What has changed since the start.
    pub fn moment(&self) -> DriverMoment {
        let Self { arc_m, steer_rad, ref delayed, next, .. } = *self;
        DriverMoment { arc_m, steer_rad, delayed: delayed.clone(), next }
    }

    /// Goes on from a moment of a driver with the same path and settings.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if that driver had another delay. This one remains as it is.
    pub fn go_on_from(&mut self, moment: &DriverMoment) -> Result<(), VehicleError> {
        let DriverMoment { arc_m, steer_rad, ref delayed, next } = *moment;
        if delayed.len() != self.delayed.len() || next > delayed.len() {
            return Err(VehicleError::Model(
                "the moment is one of another driver: the delay is another one".to_owned(),
            ));
        }
        self.delayed.copy_from_slice(delayed);
        (self.arc_m, self.steer_rad, self.next) = (arc_m, steer_rad, next);
        Ok(())
    }

    /// Drives one step.
    pub fn drive(&mut self, run: &mut Simulation<'_>) -> Progress {
        let steer_rad = self.steer_rad(run);
        run.push(steer_rad, self.speed_mps, self.interval_s)
    }
}

/// Responses over the preview time, from the dependence of `(v̇, ṙ)` on `(v, r)` and on steer.
fn preview(
    rates: Matrix2<f64>,
    steer: Vector2<f64>,
    speed_mps: f64,
    preview_s: f64,
) -> Vec<Preview> {
    // States y, v, ψ, r and the held steer angle.
    let mut f = DMatrix::zeros(5, 5);
    f[(0, 1)] = 1.0;
    f[(0, 2)] = speed_mps;
    f[(2, 3)] = 1.0;
    for (i, row) in [1, 3].into_iter().enumerate() {
        f[(row, 1)] = rates[(i, 0)];
        f[(row, 3)] = rates[(i, 1)];
        f[(row, 4)] = steer[i];
    }
    (1..=POINTS)
        .map(|k| {
            #[allow(clippy::cast_precision_loss)] // fifteen points
            let eta_s = preview_s * k as f64 / POINTS as f64;
            let phi = exponential(&(&f * eta_s));
            Preview {
                ahead_m: speed_mps * eta_s,
                by_velocity: phi[(0, 1)],
                by_yaw_rate: phi[(0, 3)],
                by_steer: phi[(0, 4)],
            }
        })
        .collect()
}

impl YawRollPlant {
    /// The tractor as a bicycle, with the static load of the fifth wheel as a mass at its position:
    /// the derivatives of the rates of lateral velocity and yaw rate with respect to these two, and
    /// to the steer angle.
    fn bicycle(&self, speed_mps: f64) -> Result<(Matrix2<f64>, Vector2<f64>), VehicleError> {
        let run = self.start(speed_mps)?;
        let sample = run.sample();
        let p = &self.parameters;
        let hitch_m = p.hitch_arm[0];
        let hitch_kg = sample.hitch_load_n / p.gravity_mps2;
        let mut mass_kg = p.tractor.mass_kg + hitch_kg;
        let mut moment = hitch_kg * hitch_m;
        let mut inertia = p.tractor.inertia_kgm2[2] + hitch_kg * hitch_m * hitch_m;
        // Force and yaw moment per slip at the c.g., per yaw rate, per steer angle.
        let mut force = [Vector2::zeros(); 3];
        for (axle, seen) in p.axles.iter().zip(sample.axles()).filter(|(a, _)| !a.on_trailer) {
            let x = axle.roll_center[0];
            mass_kg += axle.mass_kg;
            moment += axle.mass_kg * x;
            inertia += axle.mass_kg * x * x + axle.inertia_kgm2;
            #[allow(clippy::cast_precision_loss)] // one or two
            let tyres = 2.0 * axle.tyres.per_side as f64;
            let load_n = (seen.left_load_n + seen.right_load_n) / tyres;
            let slip = 1e-4;
            let (side, aligning) = p.kinds[axle.tyres.kind].at(slip, load_n);
            let by_slip = Vector2::new(side, x * side + aligning) * (tyres / slip);
            force[0] += by_slip / speed_mps;
            force[1] += by_slip * (x / speed_mps);
            force[2] -= by_slip * axle.steered;
        }
        let mass = Matrix2::new(mass_kg, moment, moment, inertia);
        let inverse = mass.try_inverse().ok_or_else(|| {
            VehicleError::Model("driver: the tractor's mass matrix is singular".to_owned())
        })?;
        let turning = Vector2::new(mass_kg, moment) * speed_mps;
        Ok((
            Matrix2::from_columns(&[inverse * force[0], inverse * (force[1] - turning)]),
            inverse * force[2],
        ))
    }
}
