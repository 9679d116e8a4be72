//! The studies of chapter 2: how the nonlinear plant's responses depend on maneuver, load and
//! vehicle, the source's statements beside what is found here.
//!
//! | file | studies |
//! |---|---|
//! | `sensitivity` | Figs. 2.5, 2.6: every response to a higher payload |
//! | `maneuvers` | Figs. 2.11–2.15, 2.17–2.22: cornering angle, gate length |
//! | `speed` | Figs. 2.23, 2.24 |
//! | `inertia` | Fig. 2.25: shape of the payload |
//! | `heights` | Figs. 2.26, 2.27: c.g. height, payload |
//! | `shift` | Figs. 2.28, 2.29: payload beside or behind its place |
//! | `variants` | Figs. 2.30, 2.31: suspensions, tyres |
//! | `accuracy` | Monte-Carlo over noise, load and time (no figure of the source) |
//! | `replay` | recorded logs driven again (no figure of the source) |
//! | `drive` | one run along a path with the preview driver |
//! | `data` | what a study returns |
//!
//! ```
//! use cg_thesis::study::{studies, study};
//!
//! assert_eq!(studies().len(), 13);
//! let turn = study("height-steady", None)?;
//! let responses = &turn.series("2.5", "payload c.g. 200 mm higher").unwrap().points;
//! assert!(responses[0][1] > 0.1); // the most sensitive one comes first
//! # Ok::<(), cg_vehicle::VehicleError>(())
//! ```

mod accuracy;
mod data;
mod drive;
mod heights;
mod inertia;
mod maneuvers;
mod replay;
mod sensitivity;
mod shift;
mod speed;
mod variants;

pub use data::{Abscissa, Panel, Quantity, Response, Series, Statement, Study, Unit};
pub use replay::{Recorded, Replayed, drive_again, replay};

use cg_vehicle::error::VehicleError;
use cg_vehicle::vehicle::Vehicle;
use drive::Drive;

/// A study as it is listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listed {
    /// Its name on the command line.
    pub name: &'static str,
    /// The source's figures.
    pub figures: &'static str,
    /// What it varies and watches.
    pub about: &'static str,
}

type Run = fn(&Setting) -> Result<Study, VehicleError>;

/// In the order of the source's pages; the last one is ours.
const STUDIES: [(Listed, Run); 13] = [
    (
        Listed {
            name: "height-steady",
            figures: "Fig. 2.5",
            about: "Change of every response in a turn when the payload's c.g. rises by 200 mm.",
        },
        sensitivity::steady,
    ),
    (
        Listed {
            name: "height-lane-change",
            figures: "Fig. 2.6",
            about: "The same in a lane change of 30 m gate length at 100 km/h.",
        },
        sensitivity::lane_change,
    ),
    (
        Listed {
            name: "cornering-angle",
            figures: "Figs. 2.11-2.15",
            about: "Roll and lateral acceleration in turns of 60, 90 and 120 degrees.",
        },
        maneuvers::cornering_angle,
    ),
    (
        Listed {
            name: "gate-length",
            figures: "Figs. 2.17-2.22",
            about: "The same in lane changes of 20 and 30 m gate length.",
        },
        maneuvers::gate_length,
    ),
    (
        Listed {
            name: "lane-change-speed",
            figures: "Figs. 2.23, 2.24",
            about: "Peaks over speed in lane change and turn, and roll over lateral acceleration.",
        },
        speed::study,
    ),
    (
        Listed {
            name: "roll-inertia",
            figures: "Fig. 2.25",
            about: "Peak roll of payloads of different shape in turn and lane change.",
        },
        inertia::study,
    ),
    (
        Listed {
            name: "height",
            figures: "Fig. 2.26",
            about: "Peak roll in a turn over the c.g. height.",
        },
        heights::height,
    ),
    (
        Listed {
            name: "payload-height",
            figures: "Fig. 2.27",
            about: "The same under payloads of 5 to 25 t.",
        },
        heights::payload_height,
    ),
    (
        Listed {
            name: "lateral-shift",
            figures: "Fig. 2.28",
            about: "Roll on a straight road and in a turn when the payload lies beside the middle.",
        },
        shift::lateral,
    ),
    (
        Listed {
            name: "longitudinal-shift",
            figures: "Fig. 2.29",
            about: "Peak roll in a turn when the payload lies before or behind its place.",
        },
        shift::longitudinal,
    ),
    (
        Listed {
            name: "suspension",
            figures: "Fig. 2.30",
            about: "Peak roll over the c.g. height with leaf springs and with air suspensions.",
        },
        variants::suspension,
    ),
    (
        Listed {
            name: "tyres",
            figures: "Fig. 2.31",
            about: "Peak roll over the c.g. height with new and worn tyres.",
        },
        variants::tyres,
    ),
    (
        Listed {
            name: "accuracy",
            figures: "",
            about: "Error, interval and bound of the estimate over noise, load and time.",
        },
        accuracy::study,
    ),
];

/// All studies, in the order of the source's pages.
pub fn studies() -> Vec<Listed> {
    STUDIES.iter().map(|(listed, _)| *listed).collect()
}

/// Runs one study, with a vehicle in place of the baseline if one is given. The baseline is
/// `fixtures/vehicles/baseline-tables.toml`.
///
/// # Errors
/// [`VehicleError::UnknownStudy`]; [`VehicleError`] if the vehicle cannot be simulated.
pub fn study(name: &str, vehicle: Option<&Vehicle>) -> Result<Study, VehicleError> {
    let unknown = || VehicleError::UnknownStudy {
        name: name.to_owned(),
        known: STUDIES.map(|(listed, _)| listed.name).join(", "),
    };
    let (listed, run) =
        STUDIES.iter().find(|(listed, _)| listed.name == name).ok_or_else(unknown)?;
    let text = include_str!("../../fixtures/vehicles/baseline-tables.toml");
    let vehicle = match vehicle {
        Some(vehicle) => vehicle.clone(),
        None => Vehicle::parse(text, "fixtures/vehicles/baseline-tables.toml")?,
    };
    run(&Setting { name: listed.name, vehicle })
}

/// What a study starts from.
struct Setting {
    name: &'static str,
    vehicle: Vehicle,
}

const PEAK_ROLL: Quantity =
    Quantity { name: "peak_roll", label: "Peak roll angle of the semitrailer", unit: Unit::Radian };
const PEAK_LATERAL: Quantity = Quantity {
    name: "peak_lateral_acceleration",
    label: "Peak lateral acceleration",
    unit: Unit::MetrePerSecondSquared,
};

/// Vehicle, load, maneuver.
fn scenario(setting: &Setting, drive: &Drive) -> Vec<String> {
    vec![
        format!("vehicle: {}", setting.vehicle.name),
        format!(
            "semitrailer of {:.0} kg, sprung c.g. at {:.3} m unless said otherwise",
            drive.load.trailer_mass_kg, drive.load.cg_height_m
        ),
        drive.told(),
    ]
}

/// Slope of an angle over metres, in degrees.
fn per_metre_deg(slope_rad_per_m: f64) -> f64 {
    slope_rad_per_m.to_degrees()
}
