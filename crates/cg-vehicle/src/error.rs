//! What can be wrong with a vehicle.

use thiserror::Error;

/// A vehicle file or a model that cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum VehicleError {
    /// The file cannot be read.
    #[error("{file}: cannot be read ({source}); check that it is a text file and may be read")]
    Read {
        /// The file.
        file: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Not TOML, an unknown key, a missing key or a value of the wrong type.
    #[error("{file}: {message}")]
    Syntax {
        /// The file.
        file: String,
        /// What and where (line and column).
        message: String,
    },
    /// A value that no vehicle can have.
    #[error("{file}:{line}:{column}: {key} = {value}: {remedy}")]
    Invalid {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The offending key.
        key: String,
        /// Its value.
        value: String,
        /// What to do.
        remedy: String,
    },
    /// A load that the trailer cannot have.
    #[error(
        "trailer mass {trailer_mass_kg:.0} kg is below the empty trailer's {empty_mass_kg:.0} kg: \
         give the mass of the whole semitrailer as weighed (sprung mass and axles)"
    )]
    Load {
        /// The mass asked for.
        trailer_mass_kg: f64,
        /// The empty trailer's.
        empty_mass_kg: f64,
    },
    /// The printed model is known for one vehicle and load only.
    #[error("the as-printed model {0}; use --model complete")]
    AsPrinted(String),
    /// No such table of the source.
    #[error("no table `{name}` to reproduce; there are {known}")]
    UnknownTable {
        /// The name asked for.
        name: String,
        /// All names.
        known: String,
    },
    /// No such study.
    #[error("no study `{name}`; there are {known}")]
    UnknownStudy {
        /// The name asked for.
        name: String,
        /// All names.
        known: String,
    },
    /// The static balance, the model or its reduction has no usable solution.
    #[error("{0}")]
    Model(String),
}

impl VehicleError {
    pub(crate) fn syntax(file: &str, source: &toml::de::Error) -> Self {
        Self::Syntax { file: file.to_owned(), message: source.to_string().trim_end().to_owned() }
    }
}
