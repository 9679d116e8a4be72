//! Errors of a vehicle file or a model.

use thiserror::Error;

use crate::finding::{Finding, Unusual, plain};

/// The reason why a vehicle file or a model cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum VehicleError {
    /// The file cannot be read.
    #[error("{file}: cannot be read ({source}); check that it is a text file and may be read")]
    Read {
        /// Name of the file.
        file: String,
        /// Reason from the operating system.
        source: std::io::Error,
    },
    /// The text is not TOML, or it has an unknown key, a missing key or a value of the wrong type.
    #[error("{file}: {message}")]
    Syntax {
        /// Name of the file.
        file: String,
        /// The fault and its position (line and column).
        message: String,
    },
    /// Some values are impossible. Contains all findings of the check.
    #[error("{}", findings_text(file, findings))]
    Invalid {
        /// Name of the file.
        file: String,
        /// All findings, errors first.
        findings: Vec<Finding>,
    },
    /// Each number of the vehicle is possible, but the vehicle as a whole is not.
    #[error("{message}; {}", farthest_words(farthest))]
    Unusable {
        /// The fault.
        message: String,
        /// The keys with the least usual values, the least usual one first.
        farthest: Vec<Unusual>,
    },
    /// A load that the trailer cannot have, because it is lighter than empty.
    #[error(
        "trailer mass {trailer_mass_kg:.0} kg is below the empty trailer's {empty_mass_kg:.0} kg: \
         give the mass of the whole semitrailer as weighed (sprung mass and axles)"
    )]
    Load {
        /// The trailer mass of the load.
        trailer_mass_kg: f64,
        /// Mass of the empty trailer.
        empty_mass_kg: f64,
    },
    /// The thesis's printed model is known for one vehicle and load only.
    #[error("the as-printed model {0}; use ⟨model complete⟩")]
    AsPrinted(String),
    /// The thesis has no such table.
    #[error("no table `{name}` to reproduce; there are {known}")]
    UnknownTable {
        /// The requested name.
        name: String,
        /// All names.
        known: String,
    },
    /// There is no such study.
    #[error("no study `{name}`; there are {known}")]
    UnknownStudy {
        /// The requested name.
        name: String,
        /// All names.
        known: String,
    },
    /// Calibration runs for which no truck near the vehicle file can be found.
    #[error(
        "the calibration does not converge: the runs contradict the vehicle file; check heights, masses, \
         units and signs"
    )]
    Unsettled,
    /// The static balance, the model or its reduction has no usable solution.
    #[error("{0}")]
    Model(String),
}

impl VehicleError {
    /// The error for invalid TOML, with line and column.
    pub fn syntax(file: &str, source: &toml::de::Error) -> Self {
        Self::Syntax { file: file.to_owned(), message: source.to_string().trim_end().to_owned() }
    }
}

fn findings_text(file: &str, findings: &[Finding]) -> String {
    let lines: Vec<String> = findings.iter().map(|finding| finding.in_file(file)).collect();
    lines.join("\n")
}

fn farthest_words(farthest: &[Unusual]) -> String {
    let one = |unusual: &Unusual| {
        let Unusual { key, value, usual, .. } = unusual;
        format!("{key} = {} (usual: {usual})", plain(*value))
    };
    let words: Vec<String> = farthest.iter().map(one).collect();
    format!("least usual values in the vehicle file: {}", words.join(", "))
}
