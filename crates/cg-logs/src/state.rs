//! What is learnt, as the text of a state file, checked when it is read.
//!
//! ```text
//!     {"format":"cg-height state","version":1,"design_crc32":…,"memory":{…},…}
//!     crc32 89abcdef
//! ```

use cg_core::{Design, Memory};
use serde::{Deserialize, Serialize};
use thiserror::Error;

const FORMAT: &str = "cg-height state";
const VERSION: u32 = 1;
/// How the line with the checksum of the line before it begins.
const CHECKSUM: &str = "crc32 ";

/// The content of a state file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct State {
    format: String,
    version: u32,
    /// Checksum of the design it was learnt with: vehicle file and calibration.
    design_crc32: u32,
    /// When it was written, Unix time of the source.
    pub saved_s: f64,
    /// Since when the load has been this one, if it was noticed.
    pub load_since_s: Option<f64>,
    /// What was learnt.
    pub memory: Memory<f64>,
}

/// Why a text is not the state that is wanted.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum StateError {
    /// Not UTF-8.
    #[error("it is not text")]
    NotText,
    /// Cut short, or something else.
    #[error("it has no checksum")]
    NoChecksum,
    /// Damaged.
    #[error("its checksum is wrong")]
    WrongChecksum,
    /// Of something else.
    #[error("it is no state of cg run")]
    Foreign,
    /// Of an older or newer program.
    #[error("it is of version {0}, this program reads {VERSION}")]
    Version(u64),
    /// A key that is missing, unknown or of the wrong type.
    #[error("{0}")]
    Content(String),
    /// Of another truck, or of the same one with another calibration.
    #[error("it was learnt with another vehicle file or calibration")]
    OtherDesign,
    /// Numbers that no estimator learns.
    #[error("its numbers cannot be")]
    Unsound,
}

impl State {
    /// What was learnt with a design of this [checksum](design_crc32).
    pub fn new(
        design_crc32: u32,
        memory: &Memory<f64>,
        saved_s: f64,
        load_since_s: Option<f64>,
    ) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            design_crc32,
            saved_s,
            load_since_s,
            memory: *memory,
        }
    }

    /// The text of its file.
    ///
    /// # Errors
    /// If a number cannot be written, which is a bug.
    pub fn to_text(&self) -> Result<String, serde_json::Error> {
        let json = serde_json::to_string(self)?;
        Ok(format!("{json}\n{CHECKSUM}{:08x}\n", crc32fast::hash(json.as_bytes())))
    }

    /// Reads a state, if it is whole and belongs to the design of this [checksum](design_crc32).
    ///
    /// # Errors
    /// [`StateError`] that says what it is instead.
    pub fn parse(bytes: &[u8], design_crc32: u32) -> Result<Self, StateError> {
        let text = std::str::from_utf8(bytes).map_err(|_| StateError::NotText)?;
        let (json, rest) = text.split_once('\n').ok_or(StateError::NoChecksum)?;
        let sum = rest.trim_ascii_end().strip_prefix(CHECKSUM).ok_or(StateError::NoChecksum)?;
        if u32::from_str_radix(sum, 16).ok() != Some(crc32fast::hash(json.as_bytes())) {
            return Err(StateError::WrongChecksum);
        }
        let version = serde_json::from_str::<serde_json::Value>(json)
            .ok()
            .filter(|value| value["format"] == FORMAT)
            .and_then(|value| value["version"].as_u64())
            .ok_or(StateError::Foreign)?;
        if version != u64::from(VERSION) {
            return Err(StateError::Version(version));
        }
        let state: Self =
            serde_json::from_str(json).map_err(|error| StateError::Content(error.to_string()))?;
        if state.design_crc32 != design_crc32 {
            return Err(StateError::OtherDesign);
        }
        if !state.memory.is_sound() {
            return Err(StateError::Unsound);
        }
        Ok(state)
    }
}

/// The checksum that tells designs apart.
pub fn design_crc32(design: &Design<f64>) -> u32 {
    // Numbers print as the shortest text that gives them again: equal designs, equal text.
    crc32fast::hash(format!("{design:?}").as_bytes())
}
