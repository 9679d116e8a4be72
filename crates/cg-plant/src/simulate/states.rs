//! The true states of a sample as a list of named numbers, for callers that have no structs: Python and
//! FMUs.

use crate::plant::{AxleSample, PlantSample, UnitSample};

/// The name and the meaning of a state, with the unit of the name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateName {
    /// Name with the SI unit, such as `tractor_roll_rad`.
    pub name: String,
    /// Meaning, one line.
    pub meaning: String,
    /// Symbol of the unit; empty for a ratio.
    pub unit: &'static str,
}

/// Name, unit, meaning and value of each state of a unit, of an axle, and of the whole vehicle.
type States<T> = &'static [(&'static str, &'static str, &'static str, fn(&T) -> f64)];

const OF_UNIT: States<UnitSample> = &[
    ("roll_rad", "rad", "roll angle to the road, right side down", |unit| unit.roll_rad),
    ("pitch_rad", "rad", "pitch angle, nose down", |unit| unit.pitch_rad),
    ("yaw_rad", "rad", "yaw angle, to the left", |unit| unit.yaw_rad),
    ("roll_rate_radps", "rad/s", "rate of the roll angle", |unit| unit.roll_rate_radps),
    ("pitch_rate_radps", "rad/s", "rate of the pitch angle", |unit| unit.pitch_rate_radps),
    ("yaw_rate_radps", "rad/s", "rate of the yaw angle", |unit| unit.yaw_rate_radps),
    ("lateral_acceleration_mps2", "m/s2", "lateral acceleration, to the left", |unit| {
        unit.lateral_acceleration_mps2
    }),
];

const OF_AXLE: States<AxleSample> = &[
    ("left_load_n", "N", "vertical load of the left tires", |axle| axle.left_load_n),
    ("right_load_n", "N", "vertical load of the right tires", |axle| axle.right_load_n),
    ("lateral_force_n", "N", "lateral force of all tires, to the left", |axle| {
        axle.lateral_force_n
    }),
    ("slip_rad", "rad", "slip angle at the middle", |axle| axle.slip_rad),
    ("roll_rad", "rad", "roll angle, absolute", |axle| axle.roll_rad),
];

const OF_VEHICLE: States<PlantSample> = &[
    ("articulation_rad", "rad", "Yaw of the tractor minus that of the trailer", |all| {
        all.articulation_rad
    }),
    (
        "load_transfer_ratio",
        "",
        "(right − left)/(right + left) of the loads of all axles that are not steered",
        |all| all.load_transfer_ratio,
    ),
    ("hitch_load_n", "N", "Load of the trailer on the fifth wheel", |all| all.hitch_load_n),
    ("hitch_roll_moment_nm", "N.m", "Roll moment in the fifth wheel", |all| {
        all.hitch_roll_moment_nm
    }),
    ("position_x_m", "m", "Position of the tractor along its first heading", |all| {
        all.position_m[0]
    }),
    ("position_y_m", "m", "Position of the tractor to the left of its first heading", |all| {
        all.position_m[1]
    }),
];

/// A unit of a vehicle.
type OfSample = fn(&PlantSample) -> &UnitSample;

/// The units with their names.
const UNITS: [(&str, OfSample); 2] =
    [("tractor", |all| &all.tractor), ("trailer", |all| &all.trailer)];

impl PlantSample {
    /// The names of [`states`](Self::states), in the same order. Axles count from one, tractor first.
    pub fn state_names(&self) -> Vec<StateName> {
        let mut names = Vec::new();
        let mut add = |name: String, meaning: String, unit| {
            names.push(StateName { name, meaning, unit });
        };
        for (body, _) in UNITS {
            for (name, unit, meaning, _) in OF_UNIT {
                add(
                    format!("{body}_{name}"),
                    format!("Sprung mass of the {body}: {meaning}"),
                    unit,
                );
            }
        }
        for (name, unit, meaning, _) in OF_VEHICLE {
            add((*name).to_owned(), (*meaning).to_owned(), unit);
        }
        for axle in 1..=self.axles().len() {
            for (name, unit, meaning, _) in OF_AXLE {
                add(format!("axle{axle}_{name}"), format!("Axle {axle}: {meaning}"), unit);
            }
        }
        names
    }

    /// The true states of both units, of the vehicle and of its axles, in SI units.
    pub fn states(&self) -> impl Iterator<Item = f64> + '_ {
        let units = UNITS
            .iter()
            .flat_map(move |(_, unit)| OF_UNIT.iter().map(move |(.., value)| value(unit(self))));
        let vehicle = OF_VEHICLE.iter().map(|(.., value)| value(self));
        let axles = self.axles().iter();
        let axles = axles.flat_map(|axle| OF_AXLE.iter().map(move |(.., value)| value(axle)));
        units.chain(vehicle).chain(axles)
    }
}
