//! The vehicle file: one tractor-semitrailer in SI units (TOML).
//!
//! Key names carry their units; unknown keys are refused. Heights are above ground at rest,
//! other positions are distances whose name says from where. Inertias are about each sprung
//! mass's own c.g. Any number of axles per unit; tyres and springs per axle.

use serde::{Deserialize, Serialize};

use crate::load::Load;
use crate::tables::{AligningMomentTable, LateralForceTable, Spring};

/// A tractor-semitrailer.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Vehicle {
    /// What it is called in reports.
    pub name: String,
    /// Acceleration of gravity.
    #[serde(default = "standard_gravity")]
    pub gravity_mps2: f64,
    /// The speed taken when nothing else is said.
    pub nominal_speed_mps: f64,
    /// Steering-wheel angle over mean road-wheel angle.
    #[serde(default)]
    pub steering_ratio: Option<f64>,
    /// Heights that the trailer's sprung c.g. can have.
    pub height: HeightRange,
    /// How well the uncalibrated model is trusted.
    pub uncertainty: Uncertainty,
    /// The fifth wheel.
    pub hitch: Hitch,
    /// The tractor.
    pub tractor: Tractor,
    /// The semitrailer.
    pub trailer: Trailer,
    /// Tyre types, by name.
    pub tyre: Vec<Tyre>,
    /// Measured springs, by name; nonlinear plant only.
    #[serde(default)]
    pub spring: Vec<Spring>,
    /// What only the source's printed model knows.
    #[serde(default)]
    pub as_printed: Option<AsPrinted>,
}

fn standard_gravity() -> f64 {
    9.806_65
}

/// Heights that the trailer's sprung c.g. can have.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct HeightRange {
    /// The lowest.
    pub least_m: f64,
    /// The greatest.
    pub greatest_m: f64,
}

/// How well the file is trusted: standard deviations of what calibration can change (see
/// [`crate::belief`]), relative where no unit is named.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Uncertainty {
    /// Roll stiffness of the suspensions, trailer and tractor each.
    pub roll_stiffness_sd: f64,
    /// Height of the suspensions' roll centres.
    pub roll_center_height_sd_m: f64,
    /// Height of the tractor's sprung c.g.
    pub tractor_cg_height_sd_m: f64,
    /// Roll stiffness of the fifth wheel.
    pub fifth_wheel_stiffness_sd: f64,
    /// Vertical stiffness of the tyres.
    pub tyre_vertical_stiffness_sd: f64,
    /// Cornering stiffness of steered, drive and trailer tyres, each.
    pub cornering_stiffness_sd: f64,
    /// Steer-angle sensor (or steering ratio).
    pub steering_gain_sd: f64,
    /// Lateral-acceleration sensor.
    pub lateral_acceleration_gain_sd: f64,
    /// Roll sensor, and what the model gets wrong everywhere alike.
    pub compensation_sd: f64,
    /// What the model gets wrong otherwise: new at each speed, load and road.
    pub residual_sd: f64,
}

/// The fifth wheel.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Hitch {
    /// Height of the coupling.
    pub height_m: f64,
    /// Roll stiffness between the units, frames and coupling in series.
    pub roll_stiffness_nm_per_rad: f64,
    /// Roll damping between the units; nonlinear plant only.
    #[serde(default)]
    pub roll_damping_nms_per_rad: f64,
    /// Moment at which the plates part on one side (about the load times half the plate's
    /// width); without it they never do. Nonlinear plant only.
    #[serde(default)]
    pub separation_moment_nm: Option<f64>,
    /// Angle through which the parted plates move freely until the kingpin locks; nonlinear
    /// plant only.
    #[serde(default)]
    pub lash_rad: f64,
}

/// The tractor's sprung mass and its axles.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Tractor {
    /// Sprung mass.
    pub sprung_mass_kg: f64,
    /// Height of the sprung c.g.
    pub cg_height_m: f64,
    /// Roll inertia of the sprung mass about its c.g.
    pub roll_inertia_kgm2: f64,
    /// Yaw inertia of the sprung mass about its c.g.
    pub yaw_inertia_kgm2: f64,
    /// Pitch inertia about its c.g.; without it the yaw inertia. Nonlinear plant only.
    #[serde(default)]
    pub pitch_inertia_kgm2: Option<f64>,
    /// Distance of the fifth wheel behind the sprung c.g.
    pub hitch_behind_cg_m: f64,
    /// Axles, front to rear.
    pub axle: Vec<TractorAxle>,
}

/// An axle of the tractor.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct TractorAxle {
    /// Distance ahead of the sprung c.g. (negative behind it).
    pub ahead_of_cg_m: f64,
    /// Whether the steer angle acts on it.
    #[serde(default)]
    pub steered: bool,
    /// The rest.
    #[serde(flatten)]
    pub axle: Axle,
}

/// The semitrailer: tare, payload, axles.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Trailer {
    /// Mass of the whole semitrailer (sprung mass and axles) when nothing else is said.
    pub reference_mass_kg: f64,
    /// Height of its sprung c.g. when nothing else is said.
    pub reference_cg_height_m: f64,
    /// Sprung mass without payload.
    pub tare: Tare,
    /// Where payload goes.
    pub payload: Payload,
    /// What a gauge on the air suspension shows; without it a pressure says nothing.
    #[serde(default)]
    pub suspension_pressure: Option<SuspensionPressure>,
    /// Axles, front to rear.
    pub axle: Vec<TrailerAxle>,
}

/// The trailer's sprung mass without payload.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Tare {
    /// Mass.
    pub sprung_mass_kg: f64,
    /// Distance of its c.g. behind the fifth wheel.
    pub cg_behind_hitch_m: f64,
    /// Height of its c.g.
    pub cg_height_m: f64,
    /// Roll inertia about its c.g.
    pub roll_inertia_kgm2: f64,
    /// Yaw inertia about its c.g.
    pub yaw_inertia_kgm2: f64,
    /// Pitch inertia about its c.g.; without it the yaw inertia. Nonlinear plant only.
    #[serde(default)]
    pub pitch_inertia_kgm2: Option<f64>,
}

/// Two readings of a gauge on the trailer's air suspension, such as empty and laden on a weighbridge:
/// the load of the axles is a straight line over the pressure (area of the bellows, lever of the arms).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SuspensionPressure {
    /// Pressure above that of the air, mean of both sides.
    pub gauge_pa: [f64; 2],
    /// Load of the trailer's axles on the road.
    pub axle_load_kg: [f64; 2],
}

/// The payload: a homogeneous box on the floor, whose mass and height are the load.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Payload {
    /// Distance of its c.g. behind the fifth wheel.
    pub behind_hitch_m: f64,
    /// Height of the floor it stands on.
    pub floor_height_m: f64,
    /// Length of the box.
    pub length_m: f64,
    /// Width of the box.
    pub width_m: f64,
}

/// An axle of the trailer.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct TrailerAxle {
    /// Distance behind the fifth wheel.
    pub behind_hitch_m: f64,
    /// The rest.
    #[serde(flatten)]
    pub axle: Axle,
}

/// What every axle has. Symmetric left and right.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct Axle {
    /// Mass of the axle with its wheels.
    pub unsprung_mass_kg: f64,
    /// Roll (and yaw) inertia about its c.g.
    pub roll_inertia_kgm2: f64,
    /// Height of its centre: c.g. and wheel centres.
    pub center_height_m: f64,
    /// Height of the suspension's roll centre.
    pub roll_center_height_m: f64,
    /// Distance between left and right springs.
    pub spring_spread_m: f64,
    /// Stiffness of one spring.
    pub spring_stiffness_n_per_m: f64,
    /// Roll stiffness beside the springs (anti-roll bar).
    #[serde(default)]
    pub auxiliary_roll_stiffness_nm_per_rad: f64,
    /// Roll damping between body and axle.
    #[serde(default)]
    pub roll_damping_nms_per_rad: f64,
    /// Distance between left and right damper, which makes bounce damping out of roll damping;
    /// without it that of the springs. Nonlinear plant only.
    #[serde(default)]
    pub damper_spread_m: Option<f64>,
    /// Name of the measured spring; without it the spring is linear. Nonlinear plant only.
    #[serde(default)]
    pub spring: Option<String>,
    /// Steer angle of the axle per angle of roll between body and axle, positive where it steers
    /// into the turn. Nonlinear plant only.
    #[serde(default)]
    pub roll_steer_rad_per_rad: f64,
    /// Axles of one unit with the same number share their load equally (walking beam,
    /// four-spring tandem); without it an axle stands for itself.
    #[serde(default)]
    pub load_group: Option<u32>,
    /// How far the unloaded springs lift the frame above its design position; needed only
    /// where the axle loads depend on stiffness (more than two supports).
    #[serde(default)]
    pub spring_free_rise_m: f64,
    /// Name of the tyre type.
    pub tyre: String,
    /// Distances of one side's tyres from the middle: one entry for single, two for dual tyres.
    pub tyre_positions_m: Vec<f64>,
}

/// A tyre type: stiffnesses as functions of load.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Tyre {
    /// Its name.
    pub name: String,
    /// Unloaded radius; needed only where the axle loads depend on stiffness.
    #[serde(default)]
    pub unloaded_radius_m: Option<f64>,
    /// Vertical stiffness.
    pub vertical_stiffness_n_per_m: f64,
    /// Moment about the forward axis per camber angle.
    #[serde(default)]
    pub overturning_stiffness_nm_per_rad: f64,
    /// Loads of the two tables below, strictly increasing.
    pub load_n: Vec<f64>,
    /// Lateral force per slip angle at each load.
    pub cornering_stiffness_n_per_rad: Vec<f64>,
    /// Aligning moment per slip angle at each load.
    pub aligning_stiffness_nm_per_rad: Vec<f64>,
    /// Vertical damping; nonlinear plant only.
    #[serde(default)]
    pub vertical_damping_ns_per_m: f64,
    /// Distance rolled until about two thirds of a new slip angle act; nonlinear plant only.
    #[serde(default)]
    pub relaxation_length_m: f64,
    /// Lateral force beyond the linear range; without it the cornering stiffness. Nonlinear
    /// plant only.
    #[serde(default)]
    pub lateral_force: Option<LateralForceTable>,
    /// Aligning moment beyond the linear range; without it the aligning stiffness. Nonlinear
    /// plant only.
    #[serde(default)]
    pub aligning_moment: Option<AligningMomentTable>,
}

impl Tyre {
    /// Cornering stiffness (N/rad) and aligning stiffness (N m/rad) at `load_n`, linear between
    /// the table's loads and along the end segments beyond them.
    pub fn stiffness_at(&self, load_n: f64) -> (f64, f64) {
        let last = self.load_n.len().saturating_sub(2);
        let i = self.load_n.iter().rposition(|&l| l <= load_n).unwrap_or(0).min(last);
        let share = (load_n - self.load_n[i]) / (self.load_n[i + 1] - self.load_n[i]);
        let at = |table: &[f64]| table[i] + share * (table[i + 1] - table[i]);
        (at(&self.cornering_stiffness_n_per_rad), at(&self.aligning_stiffness_nm_per_rad))
    }
}

/// What only the source's printed model (appendix B) knows, at the reference load.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct AsPrinted {
    /// `m1`: tractor with axles.
    pub tractor_mass_kg: f64,
    /// `Xc1`.
    pub tractor_cg_ahead_of_hitch_m: f64,
    /// `Zc1`.
    pub tractor_cg_above_hitch_m: f64,
    /// `Iz1`.
    pub tractor_yaw_inertia_about_hitch_kgm2: f64,
    /// `m2`: trailer with axles.
    pub trailer_mass_kg: f64,
    /// `Xc2`.
    pub trailer_cg_behind_hitch_m: f64,
    /// `Zc2`.
    pub trailer_cg_above_hitch_m: f64,
    /// `Zsc2`.
    pub trailer_sprung_cg_above_hitch_m: f64,
    /// `Iz2`.
    pub trailer_yaw_inertia_about_hitch_kgm2: f64,
    /// `R`.
    pub wheel_radius_m: f64,
    /// `F_i`, tractor axles first.
    pub axle_load_n: Vec<f64>,
    /// `W_ui`, tractor axles first.
    pub unsprung_weight_n: Vec<f64>,
}

/// Where an axle is and which unit carries it.
#[derive(Clone, Copy, Debug)]
pub struct PlacedAxle<'a> {
    /// Whether it belongs to the trailer.
    pub on_trailer: bool,
    /// Distance ahead of the tractor's sprung c.g., or behind the fifth wheel.
    pub position_m: f64,
    /// Whether it is steered.
    pub steered: bool,
    /// The axle.
    pub axle: &'a Axle,
    /// Its tyre.
    pub tyre: &'a Tyre,
}

impl PlacedAxle<'_> {
    /// Number of tyres, both sides.
    pub fn tyres(&self) -> f64 {
        // At most a few tyres: exact.
        #[allow(clippy::cast_precision_loss)]
        let tyres = 2.0 * self.axle.tyre_positions_m.len() as f64;
        tyres
    }

    /// Roll stiffness between body and axle: springs and auxiliary.
    pub fn suspension_roll_stiffness_nm_per_rad(&self) -> f64 {
        let half_spread_m = 0.5 * self.axle.spring_spread_m;
        2.0 * self.axle.spring_stiffness_n_per_m * half_spread_m * half_spread_m
            + self.axle.auxiliary_roll_stiffness_nm_per_rad
    }

    /// Roll stiffness between axle and road: tyres.
    pub fn tyre_roll_stiffness_nm_per_rad(&self) -> f64 {
        let squares: f64 = self.axle.tyre_positions_m.iter().map(|y| y * y).sum();
        2.0 * self.tyre.vertical_stiffness_n_per_m * squares
            + self.tyres() * self.tyre.overturning_stiffness_nm_per_rad
    }
}

impl Vehicle {
    /// All axles, tractor first, front to rear.
    pub fn axles(&self) -> Vec<PlacedAxle<'_>> {
        let tyre = |axle: &Axle| self.tyre.iter().find(|tyre| tyre.name == axle.tyre);
        let tractor = self.tractor.axle.iter().filter_map(|a| {
            Some(PlacedAxle {
                on_trailer: false,
                position_m: a.ahead_of_cg_m,
                steered: a.steered,
                axle: &a.axle,
                tyre: tyre(&a.axle)?,
            })
        });
        let trailer = self.trailer.axle.iter().filter_map(|a| {
            Some(PlacedAxle {
                on_trailer: true,
                position_m: a.behind_hitch_m,
                steered: false,
                axle: &a.axle,
                tyre: tyre(&a.axle)?,
            })
        });
        tractor.chain(trailer).collect()
    }

    /// Mass of the trailer's axles.
    pub fn trailer_unsprung_mass_kg(&self) -> f64 {
        self.trailer.axle.iter().map(|a| a.axle.unsprung_mass_kg).sum()
    }

    /// Mass of the empty trailer, axles included.
    pub fn empty_trailer_mass_kg(&self) -> f64 {
        self.trailer.tare.sprung_mass_kg + self.trailer_unsprung_mass_kg()
    }

    /// The reference load of the file.
    pub fn reference_load(&self) -> Load {
        Load {
            trailer_mass_kg: self.trailer.reference_mass_kg,
            cg_height_m: self.trailer.reference_cg_height_m,
        }
    }
}
