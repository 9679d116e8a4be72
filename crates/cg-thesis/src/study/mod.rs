//! The studies of chapter 2: how the nonlinear plant's responses depend on maneuver, load and vehicle,
//! and whether the statements of the thesis agree with the results.
//!
//! | file | studies |
//! |---|---|
//! | `sensitivity` | Figs. 2.5, 2.6: every response to a higher payload |
//! | `maneuvers` | Figs. 2.7–2.15, 2.17–2.22: cornering angle, gate length |
//! | `speed` | Figs. 2.23, 2.24 |
//! | `inertia` | Fig. 2.25: shape of the payload |
//! | `heights` | Figs. 2.26, 2.27: c.g. height, payload |
//! | `readings` | Fig. 2.26 with every reading of the printed fifth wheel |
//! | `shift` | Figs. 2.28, 2.29: lateral and longitudinal shift of the payload |
//! | `variants` | Figs. 2.30, 2.31: suspensions, tires |
//! | `accuracy` | Monte-Carlo over noise, load and time (no figure of the thesis) |
//! | `roads` | banked roads (no figure of the thesis) |
//! | `in_service` | a truck that learns itself from its empty trips (no figure of the thesis) |
//! | `replay` | recorded logs driven again (no figure of the thesis) |
//! | `drive` | one run along a path with the preview driver |
//! | `data` | the result of a study |
//!
//! ```
//! use cg_thesis::study::{studies, study};
//!
//! assert_eq!(studies().len(), 16);
//! let turn = study("height-steady", None)?;
//! let responses = &turn.series("2.5", "payload c.g. 200 mm higher").unwrap().points;
//! assert!(responses[0][1] > 0.1); // the most sensitive one comes first
//! # Ok::<(), cg_vehicle::VehicleError>(())
//! ```

mod data;
mod drive;
mod replay;
mod setting;
mod accuracy;
mod roads;
mod in_service;
mod heights;
mod inertia;
mod maneuvers;
mod readings;
mod sensitivity;
mod shift;
mod speed;
mod variants;
mod list;

pub(crate) use data::legend_of_printed;
pub use data::{Abscissa, Panel, Quantity, Response, Series, Statement, Study, Unit};
pub use in_service::{Answer, InService, LadenTrip, in_service};
pub use list::{Listed, studies, study};
pub use replay::{Recorded, Replayed, drive_again, replay};
