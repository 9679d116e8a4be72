//! Numbers as printed in the thesis.

use serde::Deserialize;
use serde::de::DeserializeOwned;

use cg_vehicle::error::VehicleError;

/// A printed number: its value, its rounding, and its correction if it is a misprint.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Form")]
pub(super) struct Printed {
    /// As printed.
    pub(super) value: f64,
    /// Half a unit of the last printed digit.
    pub(super) rounding: f64,
    /// The correction and its reason, if it is a misprint.
    pub(super) misprint: Option<Misprint>,
}

/// The correction of a misprint.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Misprint {
    /// The correct value.
    pub(super) corrected: f64,
    /// The reason.
    pub(super) why: String,
}

/// The two forms that a number has in the files.
#[derive(Deserialize)]
#[serde(untagged)]
enum Form {
    Text(String),
    Wrong { printed: String, corrected: String, misprint: String },
}

impl TryFrom<Form> for Printed {
    type Error = String;

    fn try_from(form: Form) -> Result<Self, String> {
        match form {
            Form::Text(text) => Self::parse(&text),
            Form::Wrong { printed, corrected, misprint } => {
                let corrected = Self::parse(&corrected)?.value;
                let misprint = Some(Misprint { corrected, why: misprint });
                Ok(Self { misprint, ..Self::parse(&printed)? })
            }
        }
    }
}

impl Printed {
    fn parse(text: &str) -> Result<Self, String> {
        let number = |part: &str| {
            part.parse::<f64>()
                .ok()
                .filter(|value| value.is_finite())
                .ok_or_else(|| format!("`{text}` is not a number"))
        };
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        #[allow(clippy::cast_precision_loss)] // a few digits
        let last_digit = libm::pow(10.0, number(exponent)? - decimals as f64);
        Ok(Self { value: number(text)?, rounding: 0.5 * last_digit, misprint: None })
    }

    /// The intended value: corrected if it is a misprint.
    pub(super) fn corrected_value(&self) -> f64 {
        self.misprint.as_ref().map_or(self.value, |misprint| misprint.corrected)
    }
}

/// The values of a list.
pub(super) fn values(list: &[Printed]) -> Vec<f64> {
    list.iter().map(Printed::corrected_value).collect()
}

/// A list of known length.
pub(super) fn fixed<const N: usize>(list: &[Printed]) -> Result<[f64; N], VehicleError> {
    values(list).try_into().map_err(|found: Vec<f64>| {
        VehicleError::Model(format!("fixtures/thesis: {} numbers where {N} belong", found.len()))
    })
}

/// Reads one of the thesis's tables.
pub(super) fn read<T: DeserializeOwned>(text: &str, name: &str) -> Result<T, VehicleError> {
    toml::from_str(text)
        .map_err(|source| VehicleError::syntax(&format!("fixtures/thesis/{name}"), &source))
}

/// [`read`] of a file of `fixtures/thesis`, embedded.
macro_rules! thesis {
    ($name:literal) => {
        $crate::reproduce::printed::read(
            include_str!(concat!("../../fixtures/thesis/", $name)),
            $name,
        )
    };
}
pub(super) use thesis;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_says_how_far_a_number_can_be_trusted() {
        for (text, value, rounding) in [
            ("77.69", 77.69, 0.005),
            ("-4.5839e+025", -4.5839e25, 0.5e21),
            ("9.7715e-004", 9.7715e-4, 0.5e-8),
            ("1.1", 1.1, 0.05),
            ("7028", 7028.0, 0.5),
        ] {
            let printed = Printed::parse(text).unwrap();
            // The tolerance is one rounding of a decimal power.
            assert!((printed.value / value - 1.0).abs() < 1e-15, "{text}");
            assert!((printed.rounding / rounding - 1.0).abs() < 1e-12, "{text}");
        }
        assert!(Printed::parse("about 2").is_err());
        assert!(Printed::parse("inf").is_err());
    }
}
