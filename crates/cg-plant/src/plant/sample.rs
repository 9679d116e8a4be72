//! Outputs of the plant at an instant.

use super::dynamics::{Control, Parameters, Probe};
use super::state::{
    AxleCoordinate, Coordinate as C, FRONT_ROLL, FRONT_ROLL_RATE, MAX_AXLES, State,
};

/// A sprung mass at an instant; ISO 8855 signs. Of a trailer whose frame twists, roll angles and specific
/// force are those at the sensors of the vehicle file (of two roll sensors, their sum by shares).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct UnitSample {
    /// Roll angle, right side down.
    pub roll_rad: f64,
    /// Pitch angle, nose down.
    pub pitch_rad: f64,
    /// Yaw angle, to the left.
    pub yaw_rad: f64,
    /// Rate of the roll angle.
    pub roll_rate_radps: f64,
    /// Rate of the pitch angle.
    pub pitch_rate_radps: f64,
    /// Rate of the yaw angle.
    pub yaw_rate_radps: f64,
    /// Lateral acceleration of the sprung c.g. in the plane of the road, to the left of the heading.
    pub lateral_acceleration_mps2: f64,
    /// Roll angle against the true vertical: roll angle plus the bank of the road (exactly, if the
    /// road is banked about the heading of this unit).
    pub roll_to_gravity_rad: f64,
    /// Specific force at the accelerometer along the body's lateral axis, gravity included.
    pub specific_force_mps2: f64,
    /// Roll angle minus the mean of the axles: all of the trailer, or the tractor's drive axles.
    pub suspension_roll_rad: f64,
}

/// An axle at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AxleSample {
    /// Vertical load of the left tires.
    pub left_load_n: f64,
    /// Vertical load of the right tires.
    pub right_load_n: f64,
    /// Force of the left spring.
    pub left_spring_n: f64,
    /// Force of the right spring.
    pub right_spring_n: f64,
    /// Whether the axle is steered.
    pub is_steered: bool,
    /// Whether the axle belongs to the trailer.
    pub is_on_trailer: bool,
    /// Lateral force of all tires, to the left of the wheels.
    pub lateral_force_n: f64,
    /// Slip angle at the middle of the axle.
    pub slip_rad: f64,
    /// Roll angle, absolute.
    pub roll_rad: f64,
}

impl AxleSample {
    /// Whether the left wheels are off the road.
    pub fn left_lifted(&self) -> bool {
        self.left_load_n <= 0.0
    }

    /// Whether the right wheels are off the road.
    pub fn right_lifted(&self) -> bool {
        self.right_load_n <= 0.0
    }
}

/// The vehicle at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlantSample {
    /// Road-wheel steer angle.
    pub steer_rad: f64,
    /// Forward speed.
    pub speed_mps: f64,
    /// Bank of the road.
    pub bank_rad: f64,
    /// Grade of the road, uphill positive.
    pub grade_rad: f64,
    /// The tractor's sprung mass.
    pub tractor: UnitSample,
    /// The trailer's sprung mass.
    pub trailer: UnitSample,
    /// Roll angles of the front and the rear half of the trailer; the same if its frame is rigid.
    pub halves_roll_rad: [f64; 2],
    /// Yaw of the tractor minus that of the trailer.
    pub articulation_rad: f64,
    /// `(right − left)/(right + left)` of the loads of all axles that are not steered.
    pub load_transfer_ratio: f64,
    /// Load of the trailer on the fifth wheel.
    pub hitch_load_n: f64,
    /// Roll moment in the fifth wheel.
    pub hitch_roll_moment_nm: f64,
    /// Position of the tractor's sprung c.g., along and to the left of the initial heading.
    pub position_m: [f64; 2],
    axle: [AxleSample; MAX_AXLES],
    axles: usize,
}

/// Roll, pitch and yaw of a unit, then their rates.
const TRACTOR: [C; 6] = [
    C::TractorRoll,
    C::TractorPitch,
    C::TractorYaw,
    C::TractorRollRate,
    C::TractorPitchRate,
    C::TractorYawRate,
];
const TRAILER: [C; 6] = [
    C::TrailerRoll,
    C::TrailerPitch,
    C::TrailerYaw,
    C::TrailerRollRate,
    C::TrailerPitchRate,
    C::TrailerYawRate,
];

impl UnitSample {
    fn new(state: &State, of: [C; 6], lateral_acceleration_mps2: f64) -> Self {
        let [roll_rad, pitch_rad, yaw_rad, roll_rate, pitch_rate, yaw_rate] =
            of.map(|c| state.get(c));
        Self {
            roll_rad,
            pitch_rad,
            yaw_rad,
            roll_rate_radps: roll_rate,
            pitch_rate_radps: pitch_rate,
            yaw_rate_radps: yaw_rate,
            lateral_acceleration_mps2,
            ..Self::default()
        }
    }
}

impl PlantSample {
    /// The axles, tractor first.
    pub fn axles(&self) -> &[AxleSample] {
        &self.axle[..self.axles]
    }

    pub(super) fn new(
        state: &State,
        control: &Control,
        (probe, parameters): (&Probe, &Parameters),
        steered: &[bool],
    ) -> Self {
        let lateral_mps2 = parameters.lateral_mps2(probe);
        let mut tractor = UnitSample::new(state, TRACTOR, lateral_mps2[0]);
        let mut trailer = UnitSample::new(state, TRAILER, lateral_mps2[1]);
        let turn_rad = trailer.yaw_rad - tractor.yaw_rad;
        let gravity = control.ground.gravity(parameters.gravity_mps2, turn_rad);
        let forces_mps2 = parameters.specific_force_mps2(probe, &gravity);
        let rolls_rad = parameters.roll_to_gravity_rad(probe, &gravity);
        for (unit, on_trailer) in [(&mut tractor, false), (&mut trailer, true)] {
            unit.specific_force_mps2 = forces_mps2[usize::from(on_trailer)];
            unit.roll_to_gravity_rad = rolls_rad[usize::from(on_trailer)];
            let ours = |&i: &usize| parameters.axles[i].on_trailer == on_trailer && !steered[i];
            unit.suspension_roll_rad =
                unit.roll_rad - mean_axle_roll_rad(state, (0..steered.len()).filter(ours));
        }
        let mut halves_roll_rad = [trailer.roll_rad; 2];
        if let Some(front) = &parameters.front {
            halves_roll_rad[0] = state.x[FRONT_ROLL];
            // So far these are the roll of the rear half.
            let share = front.roll_share;
            trailer.roll_rad += share * (state.x[FRONT_ROLL] - trailer.roll_rad);
            trailer.roll_rate_radps += share * (state.x[FRONT_ROLL_RATE] - trailer.roll_rate_radps);
        }
        let mut axle = [AxleSample::default(); MAX_AXLES];
        let (mut difference, mut sum) = (0.0, 0.0);
        for (i, steered) in steered.iter().enumerate() {
            let contact = &probe.contacts[i];
            let [left_spring_n, right_spring_n] = probe.springs_n[parameters.axles[i].group];
            axle[i] = AxleSample {
                left_load_n: contact.left_n,
                right_load_n: contact.right_n,
                left_spring_n,
                right_spring_n,
                is_steered: *steered,
                is_on_trailer: parameters.axles[i].on_trailer,
                lateral_force_n: contact.lateral_n,
                slip_rad: contact.slip_rad,
                roll_rad: state.axle(i, AxleCoordinate::Roll),
            };
            if !steered {
                difference += contact.right_n - contact.left_n;
                sum += contact.right_n + contact.left_n;
            }
        }
        Self {
            steer_rad: control.steer_rad,
            speed_mps: control.speed_mps,
            bank_rad: control.ground.bank_rad,
            grade_rad: control.ground.grade_rad,
            tractor,
            trailer,
            halves_roll_rad,
            articulation_rad: tractor.yaw_rad - trailer.yaw_rad,
            load_transfer_ratio: if sum > 0.0 { difference / sum } else { 0.0 },
            hitch_load_n: probe.hitch_force_n[2],
            hitch_roll_moment_nm: probe.hitch_moment_nm,
            position_m: [state.get(C::PositionX), state.get(C::PositionY)],
            axle,
            axles: steered.len(),
        }
    }
}

/// The mean roll angle of some axles; zero if there are none.
fn mean_axle_roll_rad(state: &State, axles: impl Iterator<Item = usize>) -> f64 {
    let (mut sum_rad, mut count) = (0.0, 0.0);
    for axle in axles {
        sum_rad += state.axle(axle, AxleCoordinate::Roll);
        count += 1.0;
    }
    sum_rad / f64::max(count, 1.0)
}
