//! All studies by name.

use cg_vehicle::Vehicle;
use cg_vehicle::error::VehicleError;

use super::data::{Study, legend_of_printed};
use super::setting::Setting;
use super::{
    accuracy, heights, in_service, inertia, maneuvers, readings, roads, sensitivity, shift, speed,
    variants,
};

/// An entry in the list of studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Listed {
    /// Its name on the command line.
    pub name: &'static str,
    /// Figures of the thesis.
    pub figures: &'static str,
    /// What is varied and what is examined.
    pub about: &'static str,
}

type Run = fn(&Setting) -> Result<Study, VehicleError>;

/// All studies in the order of the thesis's pages; the last three are not in the thesis.
const STUDIES: [(Listed, Run); 16] = [
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
            figures: "Figs. 2.7-2.15",
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
            name: "fifth-wheel",
            figures: "Fig. 2.26",
            about: "The same with every reading of the fifth wheel that the thesis prints.",
        },
        readings::study,
    ),
    (
        Listed {
            name: "payload-height",
            figures: "Fig. 2.27",
            about: "The same with payloads of 5 to 25 t.",
        },
        heights::payload_height,
    ),
    (
        Listed {
            name: "lateral-shift",
            figures: "Fig. 2.28",
            about: "Roll on a straight road and in a turn over the lateral shift of the payload.",
        },
        shift::lateral,
    ),
    (
        Listed {
            name: "longitudinal-shift",
            figures: "Fig. 2.29",
            about: "Peak roll in a turn over the longitudinal shift of the payload.",
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
            about: "Peak roll over the c.g. height with new and worn tires.",
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
    (
        Listed {
            name: "roads",
            figures: "",
            about: "Error and interval of the height over the bank of the road.",
        },
        roads::study,
    ),
    (
        Listed {
            name: "in-service",
            figures: "",
            about: "A year of a truck that learns itself from its empty trips.",
        },
        in_service::study,
    ),
];

/// All studies, in the order of the thesis's pages.
pub fn studies() -> Vec<Listed> {
    STUDIES.iter().map(|(listed, _)| *listed).collect()
}

/// Runs one study, with a vehicle in place of the usual one if one is given. That is the baseline,
/// `fixtures/vehicles/baseline-tables.toml`; of the studies `roads` and `in-service`, which need
/// springs without friction, it is `fixtures/vehicles/kraz.toml`, and of `fifth-wheel`
/// `fixtures/vehicles/baseline-printed.toml`.
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
    let vehicle = match (vehicle, listed.name) {
        (Some(vehicle), _) => vehicle.clone(),
        (None, "roads" | "in-service") => Vehicle::parse(
            include_str!("../../fixtures/vehicles/kraz.toml"),
            "fixtures/vehicles/kraz.toml",
        )?,
        (None, "fifth-wheel") => Vehicle::parse(
            include_str!("../../fixtures/vehicles/baseline-printed.toml"),
            "fixtures/vehicles/baseline-printed.toml",
        )?,
        (None, _) => Vehicle::parse(
            include_str!("../../fixtures/vehicles/baseline-tables.toml"),
            "fixtures/vehicles/baseline-tables.toml",
        )?,
    };
    let mut study = run(&Setting { name: listed.name, vehicle })?;
    if !listed.figures.is_empty() {
        study.scenario.push(legend_of_printed(&study.panels).to_owned());
    }
    Ok(study)
}
