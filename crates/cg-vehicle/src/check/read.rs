//! Reads a vehicle file and runs all checks.

use std::path::Path;

use toml::Table;

use super::{place, ranges, relations, shapes, widths};
use crate::error::VehicleError;
use crate::files;
use crate::finding::{Finding, Severity};
use crate::vehicle::Vehicle;

/// Number of the least usual keys that an error names.
const NAMED: usize = 3;

impl Vehicle {
    /// Reads and checks a vehicle file.
    ///
    /// # Errors
    /// [`VehicleError`] with file, line, column, key and value of everything that is wrong.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, VehicleError> {
        Ok(Self::load_checked(path)?.0)
    }

    /// Reads and checks a vehicle file; returns the vehicle and the warnings.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_checked(path: impl AsRef<Path>) -> Result<(Self, Vec<Finding>), VehicleError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let text = files::read_text(path, files::VEHICLE_BYTES)
            .map_err(|source| VehicleError::Read { file: file.clone(), source })?;
        Self::check(&text, &file)
    }

    /// Checks the text of a vehicle file; `file` is its name in messages.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, file: &str) -> Result<Self, VehicleError> {
        Ok(Self::check(text, file)?.0)
    }

    /// Checks the text of a vehicle file; returns the vehicle and the warnings.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn check(text: &str, file: &str) -> Result<(Self, Vec<Finding>), VehicleError> {
        checked(text, file)
    }
}

/// Checks the text of a vehicle file; returns the vehicle and the warnings.
fn checked(text: &str, file: &str) -> Result<(Vehicle, Vec<Finding>), VehicleError> {
    let located = |findings| place::located(findings, text);
    let refused =
        |findings| VehicleError::Invalid { file: file.to_owned(), findings: located(findings) };
    let syntax = |source| VehicleError::syntax(file, &source);
    let root: Table = toml::from_str(text).map_err(syntax)?;
    // Unknown keys are reported first, because a misspelled key is also a missing one, and its
    // position is more useful.
    let unknown = shapes::axle_keys(&root);
    if !unknown.is_empty() {
        return Err(refused(unknown));
    }
    let mut vehicle: Vehicle = toml::from_str(text).map_err(syntax)?;
    for tyre in &mut vehicle.tyre {
        tyre.complete_cornering_stiffness();
    }
    let mut findings = ranges::findings(&ranges::numbers(&root));
    findings.extend(shapes::findings(&vehicle));
    let related = relations::findings(&vehicle, &findings);
    findings.extend(related);
    if findings.iter().any(|finding| finding.severity == Severity::Error) {
        return Err(refused(findings));
    }
    Ok((vehicle, located(findings)))
}

impl VehicleError {
    /// Adds the least usual numbers of the vehicle to an error of a model, and a full width of springs
    /// that may have been given as half of it.
    #[must_use]
    pub fn of_vehicle(self, vehicle: &Vehicle) -> Self {
        match self {
            Self::Model(message) => {
                let root = Table::try_from(vehicle).unwrap_or_default();
                let farthest = ranges::farthest(&ranges::numbers(&root), NAMED);
                let message = match widths::halved(vehicle) {
                    Some(hint) => format!("{message}; {hint}"),
                    None => message,
                };
                Self::Unusable { message, farthest }
            }
            other => other,
        }
    }
}
