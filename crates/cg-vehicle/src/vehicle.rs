//! The vehicle file: one tractor-semitrailer in SI units (TOML).
//!
//! Key names contain their units, and unknown keys are refused. Heights are above the ground at
//! rest. Other positions are distances whose name states the reference point. Inertias are about
//! the c.g. of the respective sprung mass. A unit can have any number of axles, each with its own
//! tires and springs.

use serde::{Deserialize, Serialize};

use crate::load::Load;
use crate::sensor_places::{Road, SensorPlaces, SuspensionPressure};
use crate::tables::{AligningMomentTable, LateralForceTable, Spring};
pub use crate::uncertainty::Uncertainty;
use crate::wind::Wind;

/// A payload of less than this is none, kg.
const EMPTY_KG: f64 = 1.0;

/// A tractor-semitrailer.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Vehicle {
    /// Name of the vehicle in reports.
    pub name: String,
    /// Acceleration of gravity.
    #[serde(default = "standard_gravity")]
    pub gravity_mps2: f64,
    /// Speed that is used if no other one is given.
    pub nominal_speed_mps: f64,
    /// Steering-wheel angle divided by the mean road-wheel angle.
    #[serde(default)]
    pub steering_ratio: Option<f64>,
    /// Possible heights of the trailer's sprung c.g.
    pub height: HeightRange,
    /// Uncertainty of the model without calibration.
    pub uncertainty: Uncertainty,
    /// The fifth wheel.
    pub hitch: Hitch,
    /// The tractor.
    pub tractor: Tractor,
    /// The semitrailer.
    pub trailer: Trailer,
    /// Tire types, identified by name.
    pub tyre: Vec<Tyre>,
    /// Measured springs, identified by name; nonlinear plant only.
    #[serde(default)]
    pub spring: Vec<Spring>,
    /// Places of sensors; those that are not given have usual ones.
    #[serde(default)]
    pub sensors: SensorPlaces,
    /// The roads on which the vehicle drives, for roll angles relative to gravity.
    #[serde(default)]
    pub road: Option<Road>,
    /// The side of the trailer's body, and the wind on it. Without it, the wind is in no interval.
    #[serde(default)]
    pub wind: Option<Wind>,
    /// Parameters that only the thesis's printed model uses.
    #[serde(default)]
    pub as_printed: Option<AsPrinted>,
}

fn standard_gravity() -> f64 {
    9.806_65
}

/// Possible heights of the trailer's sprung c.g.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct HeightRange {
    /// The least height.
    pub least_m: f64,
    /// The greatest height.
    pub greatest_m: f64,
}

/// The fifth wheel.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Hitch {
    /// Height of the coupling.
    pub height_m: f64,
    /// Roll stiffness between the units: frames and coupling in series.
    pub roll_stiffness_nm_per_rad: f64,
    /// Roll damping between the units; nonlinear plant only.
    #[serde(default)]
    pub roll_damping_nms_per_rad: f64,
    /// Moment at which the plates separate on one side (about the load times half the width of the
    /// plate). Without it they never separate. Nonlinear plant only.
    #[serde(default)]
    pub separation_moment_nm: Option<f64>,
    /// Angle through which the separated plates move freely until the kingpin locks; nonlinear
    /// plant only.
    #[serde(default)]
    pub lash_rad: f64,
    /// Whether the fifth wheel tilts about an axis of the tractor, as a usual plate does, or about one of
    /// the trailer; not known if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilts_on_tractor: Option<bool>,
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
    /// Pitch inertia about its c.g.; if absent, the yaw inertia is used. Nonlinear plant only.
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
    /// Whether the axle is steered.
    #[serde(default)]
    pub steered: bool,
    /// The parameters that every axle has.
    #[serde(flatten)]
    pub axle: Axle,
}

/// The semitrailer: tare, payload, axles.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Trailer {
    /// Mass of the whole semitrailer (sprung mass and axles) if no other one is given.
    pub reference_mass_kg: f64,
    /// Height of its sprung c.g. if no other one is given.
    pub reference_cg_height_m: f64,
    /// Sprung mass without payload.
    pub tare: Tare,
    /// Position and size of the payload.
    pub payload: Payload,
    /// Calibration of the pressure of the air suspension; without it a pressure is not used.
    #[serde(default)]
    pub suspension_pressure: Option<SuspensionPressure>,
    /// Torsional stiffness of the frame between the fifth wheel and the axles, [`RIGID_NM_PER_RAD`] for a
    /// rigid one; if absent, it is not known (see [`crate::twisting`]).
    ///
    /// [`RIGID_NM_PER_RAD`]: crate::twisting::RIGID_NM_PER_RAD
    #[serde(default)]
    pub frame_torsional_stiffness_nm_per_rad: Option<f64>,
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
    /// Pitch inertia about its c.g.; if absent, the yaw inertia is used. Nonlinear plant only.
    #[serde(default)]
    pub pitch_inertia_kgm2: Option<f64>,
}

/// The payload: a homogeneous box on the floor, whose mass and c.g. height follow from the load.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Payload {
    /// Distance of its c.g. behind the fifth wheel.
    pub behind_hitch_m: f64,
    /// Height of the floor on which it stands.
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
    /// Height by which a lift axle is raised; none if absent. All lift axles are raised together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lift_m: Option<f64>,
    /// The parameters that every axle has.
    #[serde(flatten)]
    pub axle: Axle,
}

/// Parameters of every axle, which is symmetric left and right.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct Axle {
    /// Mass of the axle with its wheels.
    pub unsprung_mass_kg: f64,
    /// Roll (and yaw) inertia about the axle's c.g.
    pub roll_inertia_kgm2: f64,
    /// Height of the axle's center: its c.g. and the wheel centers.
    pub center_height_m: f64,
    /// Height of the roll center of the suspension.
    pub roll_center_height_m: f64,
    /// Distance between left and right springs.
    pub spring_spread_m: f64,
    /// Stiffness of one spring.
    pub spring_stiffness_n_per_m: f64,
    /// Roll stiffness in addition to the springs (anti-roll bar).
    #[serde(default)]
    pub auxiliary_roll_stiffness_nm_per_rad: f64,
    /// Roll damping between body and axle.
    #[serde(default)]
    pub roll_damping_nms_per_rad: f64,
    /// Distance between left and right damper, from which bounce damping follows from roll damping.
    /// If absent, that of the springs is used. Nonlinear plant only.
    #[serde(default)]
    pub damper_spread_m: Option<f64>,
    /// Name of the measured spring; if absent, the spring is linear. The linear model uses its
    /// stiffness at the static load and the amplitude of a usual turn.
    #[serde(default)]
    pub spring: Option<String>,
    /// Whether the springs are air springs with a leveling valve: their stiffness and curves are
    /// those at the reference load, and in proportion to the load at others.
    #[serde(default)]
    pub leveled: bool,
    /// Steer angle of the axle per roll angle between body and axle, positive if it steers into the
    /// turn. Nonlinear plant only.
    #[serde(default)]
    pub roll_steer_rad_per_rad: f64,
    /// Axles of one unit with the same number share their load equally (walking beam, four-spring
    /// tandem). An axle without it is separate.
    #[serde(default)]
    pub load_group: Option<u32>,
    /// Height by which the unloaded springs lift the frame above its design position. It is needed
    /// only if the axle loads depend on stiffness (see [`crate::balance`]).
    #[serde(default)]
    pub spring_free_rise_m: f64,
    /// Name of the tire type.
    pub tyre: String,
    /// Distances of one side's tires from the middle: one entry for single, two for dual tires.
    pub tyre_positions_m: Vec<f64>,
}

/// A tire type, with stiffnesses as functions of the load.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Tyre {
    /// Name of the tire type.
    pub name: String,
    /// Unloaded radius; needed only if the axle loads depend on stiffness.
    #[serde(default)]
    pub unloaded_radius_m: Option<f64>,
    /// Vertical stiffness.
    pub vertical_stiffness_n_per_m: f64,
    /// Moment about the forward axis per camber angle.
    #[serde(default)]
    pub overturning_stiffness_nm_per_rad: f64,
    /// Loads of the two tables below, strictly increasing.
    pub load_n: Vec<f64>,
    /// Lateral force per slip angle at each load: the secant at the lateral acceleration of usual
    /// maneuvers ([`crate::slip::USUAL_G`]). A file may leave it out if it has [`lateral_force`](Self::lateral_force).
    #[serde(default)]
    pub cornering_stiffness_n_per_rad: Vec<f64>,
    /// Aligning moment per slip angle at each load.
    pub aligning_stiffness_nm_per_rad: Vec<f64>,
    /// Vertical damping; nonlinear plant only.
    #[serde(default)]
    pub vertical_damping_ns_per_m: f64,
    /// Distance rolled until about two thirds of a new slip angle are effective; nonlinear plant
    /// only.
    #[serde(default)]
    pub relaxation_length_m: f64,
    /// Lateral force beyond the linear range; if absent, the cornering stiffness is used. Nonlinear
    /// plant only.
    #[serde(default)]
    pub lateral_force: Option<LateralForceTable>,
    /// Aligning moment beyond the linear range; if absent, the aligning stiffness is used.
    /// Nonlinear plant only.
    #[serde(default)]
    pub aligning_moment: Option<AligningMomentTable>,
}

impl Tyre {
    /// Cornering stiffness (N/rad) and aligning stiffness (N m/rad) at `load_n`. They are
    /// interpolated linearly between the loads of the table, and extrapolated beyond them.
    pub fn stiffness_at(&self, load_n: f64) -> (f64, f64) {
        let last = self.load_n.len().saturating_sub(2);
        let i = self.load_n.iter().rposition(|&l| l <= load_n).unwrap_or(0).min(last);
        let share = (load_n - self.load_n[i]) / (self.load_n[i + 1] - self.load_n[i]);
        let at = |table: &[f64]| table[i] + share * (table[i + 1] - table[i]);
        (at(&self.cornering_stiffness_n_per_rad), at(&self.aligning_stiffness_nm_per_rad))
    }
}

/// Parameters at the reference load that only the thesis's printed model (appendix B) uses.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct AsPrinted {
    /// `m1`: tractor with its axles.
    pub tractor_mass_kg: f64,
    /// `Xc1`.
    pub tractor_cg_ahead_of_hitch_m: f64,
    /// `Zc1`.
    pub tractor_cg_above_hitch_m: f64,
    /// `Iz1`.
    pub tractor_yaw_inertia_about_hitch_kgm2: f64,
    /// `m2`: trailer with its axles.
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

/// An axle with its position and unit.
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
    /// Its tire type.
    pub tyre: &'a Tyre,
}

impl PlacedAxle<'_> {
    /// Number of tires on both sides.
    pub fn tyres(&self) -> f64 {
        // The number of tires is small, so the conversion is exact.
        #[allow(clippy::cast_precision_loss)]
        let tyres = 2.0 * self.axle.tyre_positions_m.len() as f64;
        tyres
    }

    /// Roll stiffness between body and axle: springs and anti-roll bar.
    pub fn suspension_roll_stiffness_nm_per_rad(&self) -> f64 {
        let half_spread_m = 0.5 * self.axle.spring_spread_m;
        2.0 * self.axle.spring_stiffness_n_per_m * half_spread_m * half_spread_m
            + self.axle.auxiliary_roll_stiffness_nm_per_rad
    }

    /// Roll stiffness between axle and road: the tires.
    pub fn tyre_roll_stiffness_nm_per_rad(&self) -> f64 {
        let squares: f64 = self.axle.tyre_positions_m.iter().map(|y| y * y).sum();
        2.0 * self.tyre.vertical_stiffness_n_per_m * squares
            + self.tyres() * self.tyre.overturning_stiffness_nm_per_rad
    }
}

impl Vehicle {
    /// Distance of the trailer's axles (their mean) behind the fifth wheel, m.
    pub fn trailer_wheelbase_m(&self) -> f64 {
        #[allow(clippy::cast_precision_loss)] // a few axles
        let axles = self.trailer.axle.len() as f64;
        self.trailer.axle.iter().map(|axle| axle.behind_hitch_m).sum::<f64>() / axles
    }

    /// All axles from front to rear, the tractor's first.
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

    /// The readings of gauges on air suspensions, with their paths in the file.
    pub(crate) fn pressure_readings(
        &self,
    ) -> impl Iterator<Item = (&'static str, SuspensionPressure)> {
        [
            ("trailer.suspension_pressure", self.trailer.suspension_pressure),
            ("sensors.drive_pressure", self.sensors.drive_pressure),
        ]
        .into_iter()
        .filter_map(|(path, readings)| Some((path, readings?)))
    }

    /// The axles relative to which the suspension roll of a unit is measured, with their numbers: all
    /// of the trailer, or the tractor's drive axles.
    pub fn axles_of_unit(&self, on_trailer: bool) -> Vec<(usize, PlacedAxle<'_>)> {
        let wanted = |axle: &PlacedAxle<'_>| axle.on_trailer == on_trailer && !axle.steered;
        self.axles().into_iter().enumerate().filter(|(_, axle)| wanted(axle)).collect()
    }

    /// Positions of the accelerometers: ahead of the tractor's sprung c.g., and behind the fifth
    /// wheel. Without a place in the file they are in the middle of the axles.
    pub fn accelerometer_positions_m(&self) -> (f64, f64) {
        let middle_m = |on_trailer: bool| {
            let axles = self.axles_of_unit(on_trailer);
            #[allow(clippy::cast_precision_loss)] // a number of axles
            let count = axles.len().max(1) as f64;
            axles.iter().map(|(_, axle)| axle.position_m).sum::<f64>() / count
        };
        (
            self.sensors.tractor_accelerometer.ahead_of_cg_m.unwrap_or_else(|| middle_m(false)),
            self.sensors.accelerometer.behind_hitch_m.unwrap_or_else(|| middle_m(true)),
        )
    }

    /// Mass of the trailer's axles.
    pub fn trailer_unsprung_mass_kg(&self) -> f64 {
        self.trailer.axle.iter().map(|a| a.axle.unsprung_mass_kg).sum()
    }

    /// Mass of the empty trailer, axles included.
    pub fn empty_trailer_mass_kg(&self) -> f64 {
        self.trailer.tare.sprung_mass_kg + self.trailer_unsprung_mass_kg()
    }

    /// The empty trailer.
    pub fn empty_load(&self) -> Load {
        Load {
            trailer_mass_kg: self.empty_trailer_mass_kg(),
            cg_height_m: self.trailer.tare.cg_height_m,
        }
    }

    /// The load of a mass and a height. If they are absent, they are those of the reference load, and the height of the empty
    /// trailer is its own.
    pub fn load_of(&self, trailer_mass_kg: Option<f64>, cg_height_m: Option<f64>) -> Load {
        let reference = self.reference_load();
        let trailer_mass_kg = trailer_mass_kg.unwrap_or(reference.trailer_mass_kg);
        let is_empty = trailer_mass_kg < self.empty_trailer_mass_kg() + EMPTY_KG;
        let usual = if is_empty { self.empty_load() } else { reference };
        Load { trailer_mass_kg, cg_height_m: cg_height_m.unwrap_or(usual.cg_height_m) }
    }

    /// The reference load of the file.
    pub fn reference_load(&self) -> Load {
        Load {
            trailer_mass_kg: self.trailer.reference_mass_kg,
            cg_height_m: self.trailer.reference_cg_height_m,
        }
    }
}
