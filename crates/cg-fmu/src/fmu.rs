//! An FMU from a vehicle file.

use std::path::Path;

use cg_vehicle::Vehicle;
use cg_vehicle::calibration::Calibration;
use cg_vehicle::files;

use crate::error::FmuError;
use crate::estimator::EstimatorSubject;
use crate::plant::PlantSubject;
use crate::subject::Subject;
use crate::variable::Variable;

/// Name of the vehicle file among the resources.
pub(crate) const VEHICLE: &str = "vehicle.toml";
/// Name of the calibration among the resources.
pub(crate) const CALIBRATION: &str = "calibration.toml";

/// What an FMU computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuKind {
    /// The nonlinear plant.
    Plant,
    /// The estimator.
    Estimator,
}

cg_core::words!(FmuKind {
    Plant => "plant", "The nonlinear plant: steer angle, speed and road in, states and sensors out";
    Estimator => "estimator", "The estimator: sensors in, height, threshold and margin out";
});

impl FmuKind {
    /// The name of the shared library in the FMU, and of the model.
    pub(crate) fn model_identifier(self) -> &'static str {
        match self {
            Self::Plant => "cg_plant",
            Self::Estimator => "cg_estimator",
        }
    }
}

/// The files from which an FMU is made, which become its resources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FmuFiles {
    /// Text of the vehicle file.
    pub vehicle: String,
    /// Text of a calibration, for the estimator.
    pub calibration: Option<String>,
}

/// An FMU: what it computes, and its variables.
pub struct Fmu {
    kind: FmuKind,
    name: String,
    files: FmuFiles,
    subject: Box<dyn Subject>,
}

impl Fmu {
    /// An FMU from its files.
    ///
    /// # Errors
    /// [`FmuError`] if a file is not valid, or the vehicle gives no plant or no design.
    pub fn new(kind: FmuKind, files: FmuFiles) -> Result<Self, FmuError> {
        if kind == FmuKind::Plant && files.calibration.is_some() {
            return Err(FmuError::new(
                "a calibration belongs to the estimator: the plant has no use for it; leave it out",
            ));
        }
        let vehicle = Vehicle::parse(&files.vehicle, VEHICLE)?;
        let name = vehicle.name.clone();
        let calibration = files.calibration.as_deref();
        let calibration =
            calibration.map(|text| Calibration::parse(text, CALIBRATION, &vehicle)).transpose()?;
        let subject: Box<dyn Subject> = match kind {
            FmuKind::Plant => Box::new(PlantSubject::new(vehicle)?),
            FmuKind::Estimator => Box::new(EstimatorSubject::new(vehicle, calibration.as_ref())?),
        };
        Ok(Self { kind, name, files, subject })
    }

    /// The FMU whose resources are in a folder. `token` is the instantiation token of its model
    /// description, which says what it is.
    ///
    /// # Errors
    /// [`FmuError`] if the resources cannot be read, or do not belong to the token.
    pub fn unpacked(token: &str, resources: &Path) -> Result<Self, FmuError> {
        let kind = [FmuKind::Plant, FmuKind::Estimator]
            .into_iter()
            .find(|kind| token.starts_with(&prefix(*kind)))
            .ok_or_else(|| {
                FmuError::new(format!(
                    "the instantiation token {token:?} is not one of cg-height {}: make the FMU again \
                     with the program and the library of one version",
                    env!("CARGO_PKG_VERSION")
                ))
            })?;
        let read = |name: &str| {
            let path = resources.join(name);
            files::read_text(&path, files::VEHICLE_BYTES)
                .map_err(|error| FmuError::new(format!("{}: {error}", path.display())))
        };
        let vehicle = read(VEHICLE)?;
        let calibration =
            resources.join(CALIBRATION).exists().then(|| read(CALIBRATION)).transpose()?;
        let fmu = Self::new(kind, FmuFiles { vehicle, calibration })?;
        if fmu.token() != token {
            return Err(FmuError::new(
                "the resources of the FMU were changed after it was made, so its model description no \
                 longer describes it: make it again with cg fmu",
            ));
        }
        Ok(fmu)
    }

    /// Plant or estimator.
    pub fn kind(&self) -> FmuKind {
        self.kind
    }

    /// The name of the vehicle.
    pub fn vehicle_name(&self) -> &str {
        &self.name
    }

    /// The variables: parameters, then inputs, then outputs. The value reference of a variable is its place
    /// in this list, from one; that of the time is zero.
    pub fn variables(&self) -> &[Variable] {
        self.subject.variables()
    }

    /// The files of the FMU.
    pub(crate) fn files(&self) -> &FmuFiles {
        &self.files
    }

    pub(crate) fn subject(&self) -> &dyn Subject {
        &*self.subject
    }

    /// A text that changes with the version, the kind and the files. A library accepts only FMUs of its
    /// own version.
    pub(crate) fn token(&self) -> String {
        let mut crc = crc32fast::Hasher::new();
        crc.update(self.files.vehicle.as_bytes());
        if let Some(calibration) = &self.files.calibration {
            crc.update(&[0]);
            crc.update(calibration.as_bytes());
        }
        format!("{}{:08x}", prefix(self.kind), crc.finalize())
    }
}

fn prefix(kind: FmuKind) -> String {
    format!("cg-height {} {kind} ", env!("CARGO_PKG_VERSION"))
}
