//! Tripped rollover: the trailer slides sideways against a curb and turns about its outer wheels.
//!
//! The trailer is one rigid body of mass `m`, with half track `b` and c.g. height `h`. At the curb the
//! angular momentum about the outer wheels is conserved; what it turns into rotation lifts the c.g. by at most
//! `R − h`, where it stands above the wheels:
//!
//! ```text
//!     R² = b² + h²,  I_o = I_x + m R²,  ω = m v h / I_o
//!     critical sliding velocity            v_c  = √(2 g I_o (R − h)/(m h²))
//!     rollover prevention energy reserve   RPER = m g (R − h) − ½ I_o ω²       zero at v_c
//!     rollover prevention metric           RPM  = (½ m v² − ½ I_o ω²)/(½ m v²) = 1 − m h²/I_o
//! ```
//!
//! In a maneuver `ω` is the roll rate. The c.g. then sinks a little as the body rolls on its springs, which is
//! left out; the reserve is therefore on the safe side. The tractor, which holds the trailer, is left out too.
//!
//! **Reference.** The thesis, 1.2.3. Critical sliding velocity: Lund and Bernard, SAE 950306. Reserve: Nalecz
//! et al., SAE 930831. Metric: Hinch et al., SAE 920581.

use cg_vehicle::error::VehicleError;
use cg_vehicle::steady_turn::on_board;
use cg_vehicle::{Load, Vehicle};

/// A trailer as one rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTrailer {
    /// Mass with its axles.
    pub mass_kg: f64,
    /// Height of the c.g. of sprung mass and axles.
    pub height_m: f64,
    /// Half of the effective track, as in the static stability factor.
    pub half_track_m: f64,
    /// Roll inertia about the c.g.
    pub roll_inertia_kgm2: f64,
    /// Gravity.
    pub gravity_mps2: f64,
}

impl RigidTrailer {
    /// The trailer of a vehicle under a load.
    ///
    /// # Errors
    /// [`VehicleError`] if the load is impossible.
    pub fn of(vehicle: &Vehicle, load: Load) -> Result<Self, VehicleError> {
        let sprung = vehicle.trailer_sprung_mass(load)?;
        let body = (sprung.mass_kg, sprung.cg_height_m, sprung.roll_inertia_kgm2);
        let axles = vehicle.trailer.axle.iter().map(|placed| {
            let axle = &placed.axle;
            (axle.unsprung_mass_kg, axle.center_height_m, axle.roll_inertia_kgm2)
        });
        let parts: Vec<(f64, f64, f64)> = std::iter::once(body).chain(axles).collect();
        let mass_kg: f64 = parts.iter().map(|(m, ..)| m).sum();
        let height_m = parts.iter().map(|(m, h, _)| m * h).sum::<f64>() / mass_kg;
        let about = |&(m, h, i): &(f64, f64, f64)| i + m * (h - height_m) * (h - height_m);
        // The speed plays no part in it.
        let factor_g =
            on_board(vehicle, load, vehicle.nominal_speed_mps)?.static_stability_factor_g;
        Ok(Self {
            mass_kg,
            height_m,
            half_track_m: factor_g * height_m,
            roll_inertia_kgm2: parts.iter().map(about).sum(),
            gravity_mps2: vehicle.gravity_mps2,
        })
    }

    /// `R`.
    fn radius_m(&self) -> f64 {
        (self.half_track_m * self.half_track_m + self.height_m * self.height_m).sqrt()
    }

    /// `I_o`.
    fn inertia_kgm2(&self) -> f64 {
        self.roll_inertia_kgm2 + self.mass_kg * self.radius_m() * self.radius_m()
    }

    /// Energy that lifts the c.g. above the outer wheels, J.
    fn tip_over_j(&self) -> f64 {
        self.mass_kg * self.gravity_mps2 * (self.radius_m() - self.height_m)
    }

    /// The least lateral velocity against a curb that tips the trailer.
    ///
    /// ```
    /// use cg_plant::rollover::RigidTrailer;
    ///
    /// // A point mass: its kinetic energy along the circle about the wheels, ½ m (v h/R)².
    /// let trailer = RigidTrailer {
    ///     mass_kg: 30e3,
    ///     height_m: 4.0,
    ///     half_track_m: 3.0,
    ///     roll_inertia_kgm2: 0.0,
    ///     gravity_mps2: 10.0,
    /// };
    /// assert!((trailer.critical_sliding_velocity_mps() - 20f64.sqrt() * 5.0 / 4.0).abs() < 1e-12);
    /// ```
    pub fn critical_sliding_velocity_mps(&self) -> f64 {
        let moment_kgm = self.mass_kg * self.height_m;
        (2.0 * self.inertia_kgm2() * self.tip_over_j()).sqrt() / moment_kgm
    }

    /// Roll rate after the impact of a lateral velocity.
    pub fn roll_rate_radps(&self, lateral_mps: f64) -> f64 {
        self.mass_kg * lateral_mps * self.height_m / self.inertia_kgm2()
    }

    /// Rollover prevention energy reserve at a roll rate, J; negative if the trailer tips.
    pub fn energy_reserve_j(&self, roll_rate_radps: f64) -> f64 {
        self.tip_over_j() - 0.5 * self.inertia_kgm2() * roll_rate_radps * roll_rate_radps
    }

    /// Rollover prevention metric: the share of the energy of sliding that an impact does not turn into
    /// rotation.
    pub fn prevention_metric(&self) -> f64 {
        1.0 - self.mass_kg * self.height_m * self.height_m / self.inertia_kgm2()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A solid box, 2.6 m wide and 4 m high, on the ground, as heavy as 30 t.
    fn solid() -> RigidTrailer {
        let (wide, high, mass_kg) = (2.6_f64, 4.0_f64, 30e3);
        RigidTrailer {
            mass_kg,
            height_m: 0.5 * high,
            half_track_m: 0.5 * wide,
            roll_inertia_kgm2: mass_kg * (wide * wide + high * high) / 12.0,
            gravity_mps2: 9.81,
        }
    }

    /// Of a box, `I_o = (4/3) m R²`. R = 2.38537 m, so the velocity is √(8/3 g R² (R − h))/h = 3.7869 m/s, and
    /// the metric is 1 − (3/4) h²/R² = 0.47276.
    #[test]
    fn a_box_tips_at_the_velocity_by_hand() {
        let found = solid();
        let velocity_mps = found.critical_sliding_velocity_mps();
        assert!((velocity_mps - 3.786_911).abs() < 1e-6, "{velocity_mps}");
        let metric = found.prevention_metric();
        assert!((metric - 0.472_759).abs() < 1e-6, "{metric}");
    }

    /// The reserve is what is left of the tip-over energy, and none is left at the critical velocity.
    #[test]
    fn no_reserve_is_left_at_the_critical_velocity() {
        let found = solid();
        let rate = |lateral_mps| found.roll_rate_radps(lateral_mps);
        let full_j = found.energy_reserve_j(0.0);
        assert!((full_j / (30e3 * 9.81 * (5.69_f64.sqrt() - 2.0)) - 1.0).abs() < 1e-12);
        let velocity_mps = found.critical_sliding_velocity_mps();
        assert!((found.energy_reserve_j(rate(velocity_mps)) / full_j).abs() < 1e-12);
        assert!(found.energy_reserve_j(rate(1.01 * velocity_mps)) < 0.0);
        // What the impact leaves: 1 − RPM of the energy of sliding is that of rotation.
        let rotation_j = full_j - found.energy_reserve_j(rate(2.0));
        let share = rotation_j / (0.5 * found.mass_kg * 2.0 * 2.0);
        assert!((1.0 - share - found.prevention_metric()).abs() < 1e-12);
    }
}
