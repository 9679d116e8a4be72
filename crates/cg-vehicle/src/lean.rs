//! The roll angle at which a trailer stands whose load is beside the middle.
//!
//! The estimator takes a constant lean for an offset of the roll sensor, and with linear springs that does
//! no harm to the height. Springs and fifth wheels with play are another matter: a turn away from the heavy side brings
//! the play into use at a lateral acceleration at which it would not with a load in the middle. Every trailer tips
//! earlier to its heavy side.

use crate::equations::{Equations, Variant, q, w};
use crate::error::VehicleError;
use crate::linear::{NO_STEADY_TURN, SteadyLines};
use crate::load::Load;
use crate::vehicle::Vehicle;
use cg_core::Channel;
use nalgebra::DVector;

/// What has play, so that a lean makes a height wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Play {
    /// Nothing.
    None,
    /// The fifth wheel.
    FifthWheel,
    /// The springs.
    Springs,
}

/// The lean of a trailer.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Lean {
    /// Roll angle per moment of the load about the middle, rad/(kg m).
    pub rad_per_kgm: f64,
    /// The same of the suspension roll.
    pub suspension_rad_per_kgm: f64,
    /// Suspension roll per specific force with the reference load, rad/(m/s²).
    pub suspension_rad_per_mps2: f64,
    /// Payload of the reference load, kg.
    pub reference_payload_kg: f64,
    /// Mass of the empty trailer, kg.
    pub empty_kg: f64,
    /// What has play.
    pub play: Play,
}

impl Lean {
    /// The lean of a vehicle.
    ///
    /// # Errors
    /// As [`Equations::new`].
    pub fn of(vehicle: &Vehicle) -> Result<Self, VehicleError> {
        let hitch = &vehicle.hitch;
        let slack = |n: &f64| *n <= 0.0;
        let springs = vehicle.axles().iter().any(|placed| {
            vehicle
                .spring_of(placed.axle)
                .is_some_and(|spring| spring.extension_n.iter().any(slack))
        });
        let fifth_wheel = hitch.separation_moment_nm.is_some() || hitch.lash_rad > 0.0;
        let play = match (springs, fifth_wheel) {
            (true, _) => Play::Springs,
            (false, true) => Play::FifthWheel,
            (false, false) => Play::None,
        };
        let load = vehicle.reference_load();
        let equations =
            Equations::new(vehicle, Variant::Complete, vehicle.nominal_speed_mps, load)?;
        let empty_kg = vehicle.empty_trailer_mass_kg();
        let angles = equations.angles_per_moment()?;
        let roll = equations.trailer_roll(|twisting| twisting.roll_share).dot(&angles);
        let suspension_roll = angles[q::ROLL_2] - equations.mean_axle_roll(1).dot(&angles);
        let speed_mps = vehicle.nominal_speed_mps;
        let lines = SteadyLines::new(vehicle, Variant::Complete, speed_mps, load)?;
        Ok(Self {
            rad_per_kgm: vehicle.gravity_mps2 * roll,
            suspension_rad_per_kgm: vehicle.gravity_mps2 * suspension_roll,
            suspension_rad_per_mps2: lines.channel(Channel::Suspension).ratio_at(load.cg_height_m),
            reference_payload_kg: load.trailer_mass_kg - empty_kg,
            empty_kg,
            play,
        })
    }

    /// The lean with this roll angle per moment (rad/(kg m)), reference payload and empty mass (kg). The suspension rolls by
    /// half of it, and by nothing on a banked road.
    pub fn from_parts([rad_per_kgm, reference_payload_kg, empty_kg]: [f64; 3], play: Play) -> Self {
        Self {
            rad_per_kgm,
            suspension_rad_per_kgm: 0.5 * rad_per_kgm,
            suspension_rad_per_mps2: 0.0,
            reference_payload_kg,
            empty_kg,
            play,
        }
    }

    /// Moment of a load about the middle, kg m, at which the trailer leans by an angle.
    pub fn moment_kgm(&self, lean_rad: f64) -> f64 {
        lean_rad / self.rad_per_kgm
    }

    /// The same of a suspension roll under a specific force, which the bank of the road adds to it.
    pub fn suspension_moment_kgm(
        &self,
        suspension_rad: f64,
        force_mps2: f64,
        trailer_mass_kg: f64,
    ) -> f64 {
        let share = trailer_mass_kg / (self.empty_kg + self.reference_payload_kg);
        let by_force_rad = share * self.suspension_rad_per_mps2 * force_mps2;
        (suspension_rad - by_force_rad) / self.suspension_rad_per_kgm
    }
}

/// Roll angles of a standing trailer to the road, rad, right side down positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Standing {
    /// That at the roll sensor.
    pub roll_rad: f64,
    /// Those of the front and the rear half.
    pub halves_roll_rad: [f64; 2],
}

impl Standing {
    /// Those of a vehicle with a load whose payload stands `payload_left_m` to the left of the middle. To first order in this
    /// distance nothing else changes in the linear model: it adds constants to the roll angles.
    ///
    /// # Errors
    /// As [`Equations::new`].
    pub fn of(vehicle: &Vehicle, load: Load, payload_left_m: f64) -> Result<Self, VehicleError> {
        let payload_kg = load.trailer_mass_kg - vehicle.empty_trailer_mass_kg();
        let moment_nm = -payload_kg * vehicle.gravity_mps2 * payload_left_m;
        let speed_mps = vehicle.nominal_speed_mps;
        let equations = Equations::new(vehicle, Variant::Complete, speed_mps, load)?;
        let angles = equations.angles_per_moment()? * moment_nm;
        let halves = [1.0, 0.0].map(|share| equations.trailer_roll(|_| share).dot(&angles));
        let roll_rad = equations.trailer_roll(|twisting| twisting.roll_share).dot(&angles);
        Ok(Self { roll_rad, halves_roll_rad: halves })
    }
}

impl Equations {
    /// The angles of a standing vehicle per roll moment on the trailer's sprung mass, rad/(N m).
    fn angles_per_moment(&self) -> Result<DVector<f64>, VehicleError> {
        let (front, _) = self.on_hitch();
        self.standing([front, w::ROLL_2].map(|body| (body, 0.5)))
    }

    /// The angles to gravity of a standing vehicle on whose bodies and axles roll moments act, rad. The moments are summed, each
    /// given with the roll rate of its body, N m.
    pub(crate) fn standing(
        &self,
        moments_nm: impl IntoIterator<Item = (usize, f64)>,
    ) -> Result<DVector<f64>, VehicleError> {
        let stiffness = self.stiffness_with_hitch();
        let n = stiffness.ncols() - q::ROLL_1;
        let rolls = stiffness.view((w::ROLL_1, q::ROLL_1), (n, n)).clone_owned();
        let mut moment_nm = DVector::zeros(n);
        for (body, of_body_nm) in moments_nm {
            moment_nm[body - w::ROLL_1] += of_body_nm;
        }
        let none = || VehicleError::Model(NO_STEADY_TURN.to_owned());
        let rolls = rolls.lu().solve(&moment_nm).ok_or_else(none)?;
        let mut angles = DVector::zeros(stiffness.ncols());
        angles.rows_mut(q::ROLL_1, n).copy_from(&rolls);
        Ok(angles)
    }
}
