//! What is known of the load in a log of a calibration, and its form on the command line.

use std::str::FromStr;

use cg_core::Measured;
use cg_vehicle::Vehicle;

use crate::malformed::Malformed;

const FORM: &str = "expected LOG=HEIGHT_M, LOG=HEIGHT_M,TRAILER_MASS_KG or LOG=empty; ? is an unknown height, and \
     1.9±0.05 or 1.9+-0.05 is a height or a mass with its standard deviation";

/// Masses below this are in another unit, kg, or the decimals of a height with a decimal comma.
const LEAST_KG: f64 = 100.0;

/// A log with a known height.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownLog {
    /// Name of the log.
    pub log: String,
    /// What is known of the load.
    pub load: KnownLoad,
}

/// What is known of the load of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum KnownLoad {
    /// The empty trailer: height and mass are in the vehicle file.
    Empty,
    /// A load whose height was measured.
    Laden {
        /// Height of the c.g. of the trailer's sprung mass, m.
        height_m: Measured<f64>,
        /// Mass of the whole semitrailer; `None` uses the mass in the log.
        trailer_mass: Option<KnownMass>,
    },
    /// A load of unknown height.
    UnknownHeight {
        /// As for a load of known height.
        trailer_mass: Option<KnownMass>,
    },
}

/// The mass of a run's semitrailer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownMass {
    /// The mass, kg.
    pub kg: f64,
    /// Its standard deviation, kg; `None` is that of the vehicle file's scale.
    pub sd_kg: Option<f64>,
}

impl KnownLoad {
    /// A load whose height, m, is known exactly, and whose trailer mass, kg, is given or in the log.
    pub fn exact(height_m: f64, trailer_mass_kg: Option<f64>) -> Self {
        let trailer_mass = trailer_mass_kg.map(|kg| KnownMass { kg, sd_kg: None });
        Self::Laden { height_m: Measured::exact(height_m), trailer_mass }
    }

    /// Height of the c.g. of the trailer's sprung mass, m. One that is not known is that of the reference load, with an
    /// infinite standard deviation.
    pub fn height_m(self, vehicle: &Vehicle) -> Measured<f64> {
        match self {
            Self::Empty => Measured::exact(vehicle.trailer.tare.cg_height_m),
            Self::Laden { height_m, .. } => height_m,
            Self::UnknownHeight { .. } => {
                Measured { value: vehicle.reference_load().cg_height_m, sd: f64::INFINITY }
            }
        }
    }

    /// Whether neither its height nor its mass has a standard deviation.
    pub fn is_exact(self) -> bool {
        match self {
            Self::Empty => true,
            Self::Laden { height_m, trailer_mass } => {
                height_m.sd <= 0.0 && trailer_mass.is_none_or(|mass| mass.sd_kg.is_none())
            }
            Self::UnknownHeight { .. } => false,
        }
    }

    /// Mass of the whole semitrailer, if it is not that in the log.
    pub fn trailer_mass(self, vehicle: &Vehicle) -> Option<KnownMass> {
        match self {
            Self::Empty => Some(KnownMass { kg: vehicle.empty_trailer_mass_kg(), sd_kg: None }),
            Self::Laden { trailer_mass, .. } | Self::UnknownHeight { trailer_mass } => trailer_mass,
        }
    }
}

/// Reads `LOG=HEIGHT_M[,TRAILER_MASS_KG]`, the same with `?` for the height, and `LOG=empty`. Height and mass may have a
/// standard deviation (`1.9±0.05`).
impl FromStr for KnownLog {
    type Err = Malformed;

    fn from_str(text: &str) -> Result<Self, Malformed> {
        let (log, load) = text.rsplit_once('=').ok_or(FORM)?;
        if log.is_empty() {
            return Err(FORM.into());
        }
        let log = log.to_owned();
        if load.trim() == "empty" {
            return Ok(Self { log, load: KnownLoad::Empty });
        }
        let (height, mass) = match load.split_once(',') {
            Some((height, mass)) => (height, Some(mass)),
            None => (load, None),
        };
        let mass = mass.map(|mass| with_sd("trailer mass", mass)).transpose()?;
        if let Some((kg, _)) = mass.filter(|(kg, _)| *kg < LEAST_KG) {
            return Err(format!(
                "the trailer mass is {kg} kg, but no semitrailer is so light: give it in kg, and heights with a decimal \
                 point; {FORM}"
            )
            .into());
        }
        let trailer_mass = mass.map(|(kg, sd_kg)| KnownMass { kg, sd_kg });
        let load = if height.trim() == "?" {
            KnownLoad::UnknownHeight { trailer_mass }
        } else {
            let (value, sd_m) = with_sd("height", height)?;
            let height_m = Measured { value, sd: sd_m.unwrap_or(0.0) };
            KnownLoad::Laden { height_m, trailer_mass }
        };
        Ok(Self { log, load })
    }
}

/// A positive number, and its standard deviation if it has one.
fn with_sd(name: &str, text: &str) -> Result<(f64, Option<f64>), Malformed> {
    let positive = |name: &str, text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|value| value.is_finite() && *value > 0.0)
            .ok_or_else(|| format!("{name} \"{text}\" is not a positive number; {FORM}"))
    };
    let (value, sd) = match text.split_once('±').or_else(|| text.split_once("+-")) {
        Some((value, sd)) => (value, Some(sd)),
        None => (text, None),
    };
    let sd_name = format!("standard deviation of the {name}");
    Ok((positive(name, value)?, sd.map(|sd| positive(&sd_name, sd)).transpose()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_height_and_a_mass_may_have_a_standard_deviation() {
        let load = |text: &str| text.parse::<KnownLog>().map(|known| known.load);
        let laden = |sd: f64, trailer_mass| KnownLoad::Laden {
            height_m: Measured { value: 1.9, sd },
            trailer_mass,
        };
        let mass = |sd_kg| Some(KnownMass { kg: 24e3, sd_kg });
        let cases = [
            ("a.csv=1.9", laden(0.0, None)),
            ("a.csv=1.9±0.05", laden(0.05, None)),
            ("a.csv= 1.9 +- 0.05 ", laden(0.05, None)),
            ("a.csv=1.9,24000", laden(0.0, mass(None))),
            ("a.csv=1.9±0.05,24000±200", laden(0.05, mass(Some(200.0)))),
            ("a.csv=?,24e3+-2e2", KnownLoad::UnknownHeight { trailer_mass: mass(Some(200.0)) }),
            ("a=b.csv=empty", KnownLoad::Empty),
        ];
        for (text, expected) in cases {
            assert_eq!(load(text), Ok(expected), "{text}");
        }
        let wrong = [
            ("a.csv=1.9±", "standard deviation of the height \"\""),
            ("a.csv=1.9±-0.1", "standard deviation of the height \"-0.1\""),
            ("a.csv=±0.1", "height \"\""),
            ("a.csv=1.9,24000±2 %", "standard deviation of the trailer mass \"2 %\""),
            ("a.csv=?±0.1", "height \"?\""),
            ("=1.9", "expected LOG=HEIGHT_M"),
            ("a.csv=1,9", "the trailer mass is 9 kg, but no semitrailer is so light"),
            ("a.csv=?,24", "the trailer mass is 24 kg"),
        ];
        for (text, part) in wrong {
            let error = load(text).unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
