//! Roads: curvature, bank, grade and speed limit over the distance.
//!
//! | file | contents |
//! |---|---|
//! | `table` | a road as a table, and its values at a distance |
//! | `pace` | the speed that a driver chooses along it |
//! | `kinds` | usual roads, drawn from a seed |
//! | `file` | a road from a CSV file |
//!
//! Curvature is positive to the left. The bank is a rotation of the road about its direction, with
//! the sense of roll: it is positive if the left side of the road is the higher one. Superelevation
//! into a left curve is therefore negative, and the crown of a road with right-hand traffic positive.
//! The grade is positive uphill.

mod table;
mod pace;
mod kinds;
mod file;

pub use kinds::RoadKind;
pub use pace::Pace;
pub use table::{GREATEST_BANK_RAD, GREATEST_CURVATURE_PER_M, GREATEST_GRADE_RAD, Road, RoadPoint};
