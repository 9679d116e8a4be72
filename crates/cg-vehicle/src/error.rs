//! What can be wrong with a vehicle.

use thiserror::Error;

use crate::finding::{Finding, Unusual, plain};

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
    /// Values that no vehicle can have, and what else the check found.
    #[error("{}", told(file, findings))]
    Invalid {
        /// The file.
        file: String,
        /// All findings, errors first.
        findings: Vec<Finding>,
    },
    /// The numbers of a vehicle are possible one by one, but the vehicle is not.
    #[error("{message}; {}", farthest_words(farthest))]
    Unusable {
        /// What fails.
        message: String,
        /// The keys farthest from usual, farthest first.
        farthest: Vec<Unusual>,
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
    #[error("the as-printed model {0}; use ⟨model complete⟩")]
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
    /// A TOML file that is none, with line and column.
    pub fn syntax(file: &str, source: &toml::de::Error) -> Self {
        Self::Syntax { file: file.to_owned(), message: source.to_string().trim_end().to_owned() }
    }
}

fn told(file: &str, findings: &[Finding]) -> String {
    let lines: Vec<String> = findings.iter().map(|finding| finding.in_file(file)).collect();
    lines.join("\n")
}

fn farthest_words(farthest: &[Unusual]) -> String {
    let one = |unusual: &Unusual| {
        let Unusual { key, value, usual, .. } = unusual;
        format!("{key} = {} (usual: {usual})", plain(*value))
    };
    let words: Vec<String> = farthest.iter().map(one).collect();
    format!("farthest from usual in the vehicle file: {}", words.join(", "))
}
