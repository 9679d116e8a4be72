//! What a vehicle file says about its own uncertainty.

use serde::{Deserialize, Serialize};

/// Uncertainty of the file: standard deviations of the parameters that a calibration can change
/// (see [`crate::belief`]). They are relative unless the name contains a unit.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Uncertainty {
    /// Roll stiffness of the suspensions, for trailer and tractor separately.
    pub roll_stiffness_sd: f64,
    /// Friction of measured springs, for trailer and tractor separately.
    #[serde(default = "usual_spring_friction_sd")]
    pub spring_friction_sd: f64,
    /// Height of the roll centers of the suspensions.
    pub roll_center_height_sd_m: f64,
    /// Height of the tractor's sprung c.g.
    pub tractor_cg_height_sd_m: f64,
    /// Roll stiffness of the fifth wheel.
    pub fifth_wheel_stiffness_sd: f64,
    /// Torsional stiffness of the trailer's frame, if the file gives it.
    #[serde(default = "usual_frame_sd")]
    pub frame_torsional_stiffness_sd: f64,
    /// Vertical stiffness of the tires.
    pub tyre_vertical_stiffness_sd: f64,
    /// Cornering stiffness of the tires of steered, drive and trailer axles separately.
    pub cornering_stiffness_sd: f64,
    /// Cornering stiffness of all tires at twice the load, over that at the load in the middle of their tables.
    #[serde(default = "usual_over_load_sd")]
    pub cornering_over_load_sd: f64,
    /// Gain of the steer-angle sensor (or the steering ratio).
    pub steering_gain_sd: f64,
    /// Gain of the lateral-acceleration sensor.
    pub lateral_acceleration_gain_sd: f64,
    /// Gain of the roll sensor, and the error of the model that is the same everywhere.
    pub compensation_sd: f64,
    /// The same for the sensors of suspension roll, for trailer and tractor separately.
    #[serde(default = "usual_suspension_roll_sd")]
    pub suspension_roll_gain_sd: f64,
    /// Gain of the sensors of specific force, for trailer and tractor separately.
    #[serde(default = "usual_specific_force_sd")]
    pub specific_force_gain_sd: f64,
    /// Distance of a load's c.g. from [`behind_hitch_m`](crate::vehicle::Payload::behind_hitch_m). Every
    /// load has its own place, so a calibration does not change it.
    #[serde(default = "usual_payload_place_sd")]
    pub payload_place_sd_m: f64,
    /// Distance of a load's c.g. from the middle of the trailer, to the left or to the right. It makes the rollover
    /// threshold uncertain.
    #[serde(default = "usual_payload_beside_sd")]
    pub payload_beside_sd_m: f64,
    /// The rest of the model error, which differs at each speed, load and road.
    pub residual_sd: f64,
}

/// Wear, rust and grease change the friction of a leaf spring.
fn usual_spring_friction_sd() -> f64 {
    0.3
}

fn usual_frame_sd() -> f64 {
    0.3
}

/// Of nearly all truck tires, the stiffness at twice the load is 1.6 to 1.9 times as great: four standard deviations.
fn usual_over_load_sd() -> f64 {
    0.04
}

fn usual_payload_place_sd() -> f64 {
    0.3
}

/// Pallets stand in two rows, 1.2 m apart: one row has 54 % of the mass.
pub(crate) const USUAL_PAYLOAD_BESIDE_SD_M: f64 = 0.05;

fn usual_payload_beside_sd() -> f64 {
    USUAL_PAYLOAD_BESIDE_SD_M
}

fn usual_suspension_roll_sd() -> f64 {
    0.03
}

fn usual_specific_force_sd() -> f64 {
    0.01
}
