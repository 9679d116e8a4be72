//! The table of all keys of the vehicle file, on which the checks are based.
//!
//! Usual ranges are those of road tractors of 4 to 12 t and of semitrailers up to 60 t (UMTRI's
//! parameter studies of heavy vehicles, manufacturers' data, the trucks in fixtures/vehicles).
//! Possible ranges include heavy haulage and light vans. If possible, a possible range spans less
//! than a factor of 1000, so that a number in mm, kN or t is always an error.

use super::keys::{Key, Kind, Table, number, other};
use crate::limits::{GREATEST_HEIGHT_M, GREATEST_PAYLOAD_BEHIND_HITCH_M, GREATEST_TRAILER_MASS_KG};

/// All tables of the vehicle file.
pub static TABLES: &[Table] = &[
    table(&[""], "the vehicle", TOP),
    table(&["height"], "possible heights of the trailer's sprung c.g.", HEIGHT),
    table(&["uncertainty"], "uncertainty of the file: standard deviations", UNCERTAINTY),
    table(&["hitch"], "the fifth wheel", HITCH),
    table(&["tractor"], "the tractor's sprung mass", TRACTOR),
    table(&["tractor.axle[i]"], "an axle of the tractor, front to rear", TRACTOR_AXLE),
    table(&["trailer"], "the semitrailer", TRAILER),
    table(&["trailer.tare"], "the trailer's sprung mass without payload", TARE),
    table(&["trailer.payload"], "the payload, a homogeneous box", PAYLOAD),
    Table {
        required: false,
        ..table(
            &["trailer.suspension_pressure"],
            "two readings of a gauge on the air suspension",
            PRESSURE,
        )
    },
    Table {
        required: false,
        ..table(
            &["sensors.roll"],
            "places of the sensors of the trailer's roll angle; for a frame that twists",
            ROLL_SENSOR,
        )
    },
    Table {
        required: false,
        ..table(&["sensors.accelerometer"], "place of the trailer's accelerometer", ACCELEROMETER)
    },
    Table {
        required: false,
        ..table(
            &["sensors.tractor_accelerometer"],
            "place of the tractor's accelerometer",
            TRACTOR_ACCELEROMETER,
        )
    },
    Table {
        required: false,
        ..table(
            &["sensors.level", "sensors.tractor_level"],
            "level sensors on both sides of the trailer's axles, or of the tractor's drive axles",
            LEVEL,
        )
    },
    Table {
        required: false,
        ..table(
            &["sensors.drive_pressure"],
            "two readings of a gauge on the air suspension of the drive axles",
            PRESSURE,
        )
    },
    Table {
        required: false,
        ..table(&["sensors.yaw_rate"], "the sensor of the yaw rate", YAW_RATE)
    },
    Table {
        required: false,
        ..table(
            &["sensors.mass"],
            "standard deviations of the trailer mass, for each source of it",
            MASS,
        )
    },
    Table { required: false, ..table(&["road"], "the roads on which it drives", ROAD) },
    Table {
        required: false,
        ..table(
            &["wind"],
            "the side of the trailer's body, and the wind on it: of a box or a curtain body, or of a load that is as high; without it, no interval contains a side wind",
            WIND,
        )
    },
    table(&["trailer.axle[i]"], "an axle of the trailer, front to rear", TRAILER_AXLE),
    table(&["tractor.axle[i]", "trailer.axle[i]"], "parameters of every axle", AXLE),
    table(&["tyre[i]"], "a tire type", TYRE),
    Table {
        required: false,
        ..table(
            &["tyre[i].lateral_force"],
            "lateral force over slip angle and load, beyond the linear range; for rollover threshold and simulation",
            LATERAL,
        )
    },
    Table {
        required: false,
        ..table(
            &["tyre[i].aligning_moment"],
            "aligning moment over slip angle and load, beyond the linear range; for rollover threshold and simulation",
            ALIGNING,
        )
    },
    Table { required: false, ..table(&["spring[i]"], "a measured spring", SPRING) },
    Table {
        required: false,
        ..table(&["as_printed"], "parameters that only the thesis's printed model uses", AS_PRINTED)
    },
];

const fn table(
    paths: &'static [&'static str],
    meaning: &'static str,
    keys: &'static [Key],
) -> Table {
    Table { paths, required: true, meaning, keys }
}

/// The key with a path such as `tyre[i].load_n`; `None` if there is no such key.
pub fn key(place: &str) -> Option<&'static Key> {
    let (path, name) = place.rsplit_once('.').unwrap_or(("", place));
    let mut tables = TABLES.iter().filter(|table| table.paths.contains(&path));
    tables.find_map(|table| table.keys.iter().find(|key| key.name == name))
}

const HEAVIEST_KG: f64 = GREATEST_TRAILER_MASS_KG;
const HIGHEST_M: f64 = GREATEST_HEIGHT_M;

#[rustfmt::skip] // one line for each key
const TOP: &[Key] = &[
    other("name", Kind::Text, "name of the vehicle in reports"),
    number("gravity_mps2", "m/s²", [9.76, 9.84], [9.5, 10.1], "acceleration of gravity").optional(),
    number("nominal_speed_mps", "m/s", [5.0, 28.0], [1.0, 45.0], "speed that is used if no other one is given"),
    number("steering_ratio", "", [12.0, 32.0], [5.0, 80.0], "steering-wheel angle divided by the mean road-wheel angle").optional(),
];

#[rustfmt::skip]
const HEIGHT: &[Key] = &[
    number("least_m", "m", [0.6, 1.8], [0.3, 4.0], "the least height"),
    number("greatest_m", "m", [1.8, 4.5], [1.0, HIGHEST_M], "the greatest height"),
];

#[rustfmt::skip]
const UNCERTAINTY: &[Key] = &[
    number("roll_stiffness_sd", "", [0.01, 0.4], [0.0, 1.0], "roll stiffness of the suspensions, for trailer and tractor separately, relative"),
    number("spring_friction_sd", "", [0.05, 0.5], [0.0, 1.0], "friction of measured springs, for trailer and tractor separately, relative; only if the file has such springs").optional(),
    number("roll_center_height_sd_m", "m", [0.005, 0.2], [0.0, 1.0], "height of the roll centers of the suspensions"),
    number("tractor_cg_height_sd_m", "m", [0.01, 0.4], [0.0, 1.0], "height of the tractor's sprung c.g."),
    number("fifth_wheel_stiffness_sd", "", [0.02, 1.0], [0.0, 1.0], "roll stiffness of the fifth wheel, relative"),
    number("tyre_vertical_stiffness_sd", "", [0.01, 0.4], [0.0, 1.0], "vertical stiffness of the tires, relative"),
    number("cornering_stiffness_sd", "", [0.01, 0.5], [0.0, 1.0], "cornering stiffness of the tires of steered, drive and trailer axles separately, relative"),
    number("cornering_over_load_sd", "", [0.01, 0.1], [0.0, 0.5], "cornering stiffness of all tires at twice the load, over that at the load in the middle of their tables, relative").optional(),
    number("steering_gain_sd", "", [0.002, 0.2], [0.0, 1.0], "gain of the steer-angle sensor, or steering ratio, relative"),
    number("lateral_acceleration_gain_sd", "", [0.001, 0.1], [0.0, 1.0], "gain of the lateral-acceleration sensor, relative"),
    number("compensation_sd", "", [0.002, 0.2], [0.0, 1.0], "gain of the roll sensor, and the error of the model that is the same everywhere, relative"),
    number("suspension_roll_gain_sd", "", [0.002, 0.2], [0.0, 1.0], "gain of the sensors of suspension roll, with the error of the model that is the same everywhere, for trailer and tractor separately, relative").optional(),
    number("specific_force_gain_sd", "", [0.001, 0.1], [0.0, 1.0], "gain of the sensors of specific force, for trailer and tractor separately, relative").optional(),
    number("frame_torsional_stiffness_sd", "", [0.05, 0.7], [0.0, 1.0], "torsional stiffness of the trailer's frame, relative; only if the file gives it").optional(),
    number("payload_place_sd_m", "m", [0.05, 1.0], [0.0, 3.0], "distance of a load's c.g. from trailer.payload.behind_hitch_m, to the front or to the rear; every load has its own place, so no calibration reduces it").optional().or(0.0, "every load at that place"),
    number("payload_beside_sd_m", "m", [0.01, 0.2], [0.0, 1.0], "distance of a load's c.g. from the middle of the trailer, to the left or to the right; it makes the rollover threshold uncertain").optional().or(0.0, "every load in the middle"),
    number("residual_sd", "", [0.001, 0.1], [0.0, 1.0], "the rest of the model error, relative; `cg vehicle residual` shows the least"),
];

#[rustfmt::skip]
const HITCH: &[Key] = &[
    number("height_m", "m", [0.9, 1.5], [0.5, 2.2], "height of the coupling plate above the ground"),
    number("roll_stiffness_nm_per_rad", "N m/rad", [1e5, 8e6], [2e4, 1e10], "roll stiffness between the units: frames and coupling in series").or(1e10, "rigid"),
    number("roll_damping_nms_per_rad", "N m s/rad", [300.0, 2e5], [0.0, 1e6], "roll damping between the units; for the simulation").optional().or(0.0, "none"),
    number("separation_moment_nm", "N m", [1e4, 2e5], [2e3, 1e6], "moment at which the plates separate on one side: about the load times half the width of the plate; if absent, never; for rollover threshold and simulation").optional(),
    number("lash_rad", "rad", [0.002, 0.12], [0.0, 0.35], "angle through which the separated plates move freely until the kingpin locks; for rollover threshold and simulation").optional().or(0.0, "none"),
    other("tilts_on_tractor", Kind::Flag, "whether the fifth wheel tilts about an axis of the tractor, as a usual plate does, or about one of the trailer; for the tractor's suspension roll in tight turns, and for simulation, where it does if absent").optional(),
];

#[rustfmt::skip]
const TRACTOR: &[Key] = &[
    number("sprung_mass_kg", "kg", [3e3, 1.2e4], [1.2e3, 5e4], "sprung mass"),
    number("cg_height_m", "m", [0.7, 1.6], [0.4, 2.5], "height of the sprung c.g."),
    number("roll_inertia_kgm2", "kg m²", [1e3, 1.2e4], [250.0, 1e5], "roll inertia of the sprung mass about its c.g."),
    number("yaw_inertia_kgm2", "kg m²", [4e3, 8e4], [1.2e3, 8e5], "yaw inertia of the sprung mass about its c.g."),
    number("pitch_inertia_kgm2", "kg m²", [4e3, 8e4], [1.2e3, 8e5], "pitch inertia of the sprung mass about its c.g.; if absent, the yaw inertia; for the simulation").optional(),
    number("hitch_behind_cg_m", "m", [1.0, 5.0], [0.2, 9.0], "distance of the fifth wheel behind the sprung c.g."),
];

#[rustfmt::skip]
const TRACTOR_AXLE: &[Key] = &[
    number("ahead_of_cg_m", "m", [-7.0, 3.2], [-12.0, 6.0], "distance ahead of the sprung c.g.; negative behind it"),
    other("steered", Kind::Flag, "whether the axle is steered").optional(),
];

#[rustfmt::skip]
const TRAILER: &[Key] = &[
    number("reference_mass_kg", "kg", [4e3, 6e4], [1.5e3, HEAVIEST_KG], "mass of the whole semitrailer, with axles and payload, if no other one is given"),
    number("reference_cg_height_m", "m", [0.8, 3.2], [0.3, HIGHEST_M], "height of the c.g. of its sprung mass if no other one is given"),
    number("frame_torsional_stiffness_nm_per_rad", "N m/rad", [1e5, 9e6], [2e4, 1e10], "torsional stiffness of the frame between the fifth wheel and the axles: 3e6 for a box van, 6e5 for a flatbed; if absent, it is taken as unknown, which makes the interval of a roll sensor wider").optional().or(1e10, "rigid"),
];

#[rustfmt::skip]
const TARE: &[Key] = &[
    number("sprung_mass_kg", "kg", [1.8e3, 1.5e4], [500.0, 8e4], "mass"),
    number("cg_behind_hitch_m", "m", [2.5, 10.0], [0.5, 20.0], "distance of its c.g. behind the fifth wheel"),
    number("cg_height_m", "m", [0.8, 2.3], [0.4, 4.0], "height of its c.g., of the empty trailer at rest"),
    number("roll_inertia_kgm2", "kg m²", [1e3, 4e4], [250.0, 2.4e5], "roll inertia about its c.g."),
    number("yaw_inertia_kgm2", "kg m²", [8e3, 4e5], [2.5e3, 2.4e6], "yaw inertia about its c.g."),
    number("pitch_inertia_kgm2", "kg m²", [8e3, 4e5], [2.5e3, 2.4e6], "pitch inertia about its c.g.; if absent, the yaw inertia; for the simulation").optional(),
];

#[rustfmt::skip]
const PAYLOAD: &[Key] = &[
    number("behind_hitch_m", "m", [2.0, 11.0], [0.3, GREATEST_PAYLOAD_BEHIND_HITCH_M], "distance of its c.g. behind the fifth wheel"),
    number("floor_height_m", "m", [0.6, 1.7], [0.2, 3.0], "height of the floor on which it stands"),
    number("length_m", "m", [3.0, 16.0], [0.5, 40.0], "full length of the box"),
    number("width_m", "m", [1.8, 2.7], [0.5, 6.0], "full width of the box"),
];

#[rustfmt::skip]
const PRESSURE: &[Key] = &[
    number("gauge_pa", "Pa", [1e4, 1.2e6], [3e3, 2.5e6], "gauge pressure (above atmospheric), mean of both sides").list(),
    number("axle_load_kg", "kg", [1e3, 4e4], [300.0, HEAVIEST_KG], "load of the axles on the road").list(),
];

#[rustfmt::skip]
const ROLL_SENSOR: &[Key] = &[
    number("behind_hitch_m", "m", [-1.0, 14.0], [-3.0, 30.0], "distance behind the fifth wheel; if absent, over the axles").optional(),
    number("second_behind_hitch_m", "m", [-1.0, 14.0], [-3.0, 30.0], "the same of a second sensor").optional(),
    number("second_share", "", [0.05, 0.95], [0.0, 1.0], "share of the second sensor in the roll angle, if the log has it as second_roll_rad beside roll_rad; `cg vehicle check` says the best one; if absent, roll_rad is the mean of both sensors, and a log with second_roll_rad has no height").optional().or(0.0, "the first sensor alone"),
];

#[rustfmt::skip]
const ACCELEROMETER: &[Key] = &[
    number("behind_hitch_m", "m", [-1.0, 14.0], [-3.0, 30.0], "distance behind the fifth wheel; if absent, the middle of the axles").optional(),
    number("height_m", "m", [0.5, 1.6], [0.2, 4.5], "height").optional(),
];

#[rustfmt::skip]
const TRACTOR_ACCELEROMETER: &[Key] = &[
    number("ahead_of_cg_m", "m", [-6.0, 3.0], [-12.0, 6.0], "distance ahead of the sprung c.g.; if absent, the middle of the drive axles").optional(),
    number("height_m", "m", [0.5, 1.6], [0.2, 4.5], "height").optional(),
];

#[rustfmt::skip]
const LEVEL: &[Key] = &[
    number("spread_m", "m", [0.5, 1.6], [0.2, 2.6], "full distance between the left and the right sensor, across the vehicle"),
    number("gain", "", [0.9, 1.1], [0.3, 3.0], "true change of the level divided by the measured one").optional(),
];

#[rustfmt::skip]
const YAW_RATE: &[Key] = &[
    other("on_tractor", Kind::Flag, "whether the yaw rate is that of the tractor, from which the path of the trailer follows, or that of the trailer; without the table, that of VDC2 is the tractor's and any other one the trailer's if no column says otherwise"),
];

#[rustfmt::skip]
const MASS: &[Key] = &[
    number("weighed_sd_kg", "kg", [5.0, 1e3], [0.0, 1e4], "of a mass that is given, or in a log's column of the trailer mass").optional().or(0.0, "exact"),
    number("vehicle_weight_sd", "", [0.005, 0.15], [0.0, 0.5], "of the trailer's weight on the bus (VW), relative").optional().or(0.0, "exact"),
    number("axle_load_sd", "", [0.005, 0.15], [0.0, 0.5], "of the load of the trailer's axles (EBS22), relative to that load").optional().or(0.0, "exact"),
    number("pressure_sd", "", [0.005, 0.15], [0.0, 0.5], "of a load of axles that follows from the pressure in their air suspension, relative to that load").optional().or(0.0, "exact"),
];

#[rustfmt::skip]
const ROAD: &[Key] = &[
    number("bank_sd_rad", "rad", [0.0, 0.04], [0.0, 0.15], "standard deviation of their bank in curves"),
];

#[rustfmt::skip]
const WIND: &[Key] = &[
    number("side_area_m2", "m²", [5.0, 45.0], [0.1, 100.0], "area of body and load seen from the side"),
    number("side_height_m", "m", [1.3, 3.2], [0.5, 4.5], "height of the middle of that area"),
    number("speed_mps", "m/s", [0.0, 8.0], [0.0, 30.0], "root mean square of the wind's speed at that height, from any direction").optional().or(0.0, "calm"),
];

#[rustfmt::skip]
const TRAILER_AXLE: &[Key] = &[
    number("behind_hitch_m", "m", [3.0, 15.0], [0.5, 30.0], "distance behind the fifth wheel"),
    number("lift_m", "m", [0.03, 0.25], [0.01, 0.5], "height by which this lift axle can be raised; all lift axles are raised together").optional(),
];

#[rustfmt::skip]
const AXLE: &[Key] = &[
    number("unsprung_mass_kg", "kg", [300.0, 1800.0], [80.0, 5e3], "mass of the axle with its wheels"),
    number("roll_inertia_kgm2", "kg m²", [150.0, 1200.0], [30.0, 5e3], "roll inertia of the axle about its c.g."),
    number("center_height_m", "m", [0.35, 0.62], [0.2, 1.0], "height of the axle's center: its c.g. and the wheel centers"),
    number("roll_center_height_m", "m", [0.25, 1.1], [0.02, 1.6], "height of the roll center of the suspension"),
    number("spring_spread_m", "m", [0.5, 1.5], [0.3, 2.5], "full distance between the left and the right spring, from center to center"),
    number("spring_stiffness_n_per_m", "N/m", [8e4, 4e6], [2e4, 1.5e7], "stiffness of one spring, of which an axle has two"),
    number("auxiliary_roll_stiffness_nm_per_rad", "N m/rad", [5e3, 1.5e6], [0.0, 5e6], "roll stiffness in addition to the springs (anti-roll bar)").optional().or(0.0, "none"),
    number("roll_damping_nms_per_rad", "N m s/rad", [300.0, 2e5], [0.0, 1e6], "roll damping between body and axle").optional().or(0.0, "none"),
    number("damper_spread_m", "m", [0.4, 1.9], [0.2, 2.6], "full distance between the left and the right damper; if absent, that of the springs; for the simulation").optional(),
    other("spring", Kind::Text, "name of the measured spring; if absent, the springs are linear").optional(),
    other("leveled", Kind::Flag, "whether a leveling valve keeps the height of its air springs; their stiffness and the curves of a measured spring are then those at the reference load, and grow in proportion to the load").optional(),
    number("roll_steer_rad_per_rad", "rad/rad", [-0.3, 0.3], [-1.0, 1.0], "steer angle of the axle per roll angle between body and axle; for rollover threshold and simulation").optional(),
    other("load_group", Kind::Whole, "axles of one unit with the same number share their load equally").optional(),
    number("spring_free_rise_m", "m", [0.01, 0.3], [0.0, 0.8], "height by which the unloaded springs lift the frame; needed if the axle loads depend on stiffness, that is without load groups").optional().or(0.0, "none"),
    other("tyre", Kind::Text, "name of the tire type"),
    number("tyre_positions_m", "m", [0.6, 1.3], [0.3, 2.0], "half widths: distances of the tires of one side from the middle of the axle, one for single and two for dual tires").list(),
];

#[rustfmt::skip]
const TYRE: &[Key] = &[
    other("name", Kind::Text, "its name"),
    number("unloaded_radius_m", "m", [0.38, 0.62], [0.25, 1.0], "unloaded radius; needed if the axle loads depend on stiffness").optional(),
    number("vertical_stiffness_n_per_m", "N/m", [4e5, 2e6], [1e5, 6e6], "vertical stiffness of one tire"),
    number("overturning_stiffness_nm_per_rad", "N m/rad", [800.0, 4e4], [0.0, 2e5], "moment about the forward axis per camber angle").optional().or(0.0, "none"),
    number("load_n", "N", [500.0, 1e5], [0.0, 2e5], "loads of the two tables of stiffness").list().or(0.0, "no load"),
    number("cornering_stiffness_n_per_rad", "N/rad", [2e3, 1e6], [0.0, 3e6], "lateral force per slip angle at each load, as the secant at a lateral acceleration of 0.15 g (some percent below the slope at zero slip); if absent, it is computed from lateral_force").list().optional().or(0.0, "no load"),
    number("aligning_stiffness_nm_per_rad", "N m/rad", [120.0, 1e5], [0.0, 5e5], "aligning moment per slip angle at each load").list().or(0.0, "none"),
    number("vertical_damping_ns_per_m", "N s/m", [100.0, 2e4], [0.0, 2e5], "vertical damping of one tire; for the simulation").optional().or(0.0, "none"),
    number("relaxation_length_m", "m", [0.1, 1.5], [0.0, 5.0], "distance rolled until two thirds of a new slip angle are effective; for the simulation").optional().or(0.0, "none"),
];

#[rustfmt::skip]
const LATERAL: &[Key] = &[
    number("load_n", "N", [500.0, 1e5], [300.0, 2e5], "loads of the columns").list(),
    number("slip_rad", "rad", [0.001, 0.7], [2e-4, 1.6], "slip angles of the rows").list(),
    number("coefficient", "", [0.005, 1.3], [0.0, 3.0], "lateral force divided by load: a row for each slip angle").rows(),
];

#[rustfmt::skip]
const ALIGNING: &[Key] = &[
    number("load_n", "N", [500.0, 1e5], [300.0, 2e5], "loads of the columns").list(),
    number("slip_rad", "rad", [0.001, 0.7], [2e-4, 1.6], "slip angles of the rows").list(),
    number("moment_nm", "N m", [-500.0, 6e3], [-1e4, 3e4], "aligning moment: a row for each slip angle").rows(),
];

#[rustfmt::skip]
const SPRING: &[Key] = &[
    other("name", Kind::Text, "its name"),
    number("deflection_m", "m", [-0.5, 0.6], [-1.5, 1.5], "compression of the spring").list(),
    number("compression_n", "N", [-2.5e5, 5e5], [-1e6, 1e6], "force during compression").list(),
    number("extension_n", "N", [-2.5e5, 5e5], [-1e6, 1e6], "force during release").list(),
    number("friction_deflection_m", "m", [2e-4, 0.03], [5e-5, 0.2], "deflection within which the force moves from one curve to the other"),
];

#[rustfmt::skip]
const AS_PRINTED: &[Key] = &[
    number("tractor_mass_kg", "kg", [4e3, 1.6e4], [1.5e3, 6e4], "m1: tractor with axles"),
    number("tractor_cg_ahead_of_hitch_m", "m", [0.5, 4.0], [0.1, 8.0], "Xc1"),
    number("tractor_cg_above_hitch_m", "m", [-0.7, 0.5], [-1.5, 1.5], "Zc1"),
    number("tractor_yaw_inertia_about_hitch_kgm2", "kg m²", [2e4, 4e5], [5e3, 4e6], "Iz1"),
    number("trailer_mass_kg", "kg", [4e3, 6e4], [1.5e3, HEAVIEST_KG], "m2: trailer with axles"),
    number("trailer_cg_behind_hitch_m", "m", [2.5, 10.0], [0.5, 20.0], "Xc2"),
    number("trailer_cg_above_hitch_m", "m", [-0.3, 2.0], [-1.5, 4.0], "Zc2"),
    number("trailer_sprung_cg_above_hitch_m", "m", [-0.3, 2.0], [-1.5, 4.0], "Zsc2"),
    number("trailer_yaw_inertia_about_hitch_kgm2", "kg m²", [1e5, 1e7], [3e4, 3e7], "Iz2"),
    number("wheel_radius_m", "m", [0.35, 0.62], [0.2, 1.0], "R"),
    number("axle_load_n", "N", [1.5e4, 1.3e5], [2e3, 4e5], "F_i, tractor axles first").list(),
    number("unsprung_weight_n", "N", [3e3, 1.8e4], [800.0, 5e4], "W_ui, tractor axles first").list(),
];
