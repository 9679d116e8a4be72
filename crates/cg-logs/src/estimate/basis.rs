//! The calibration on which a height rests, and how old it was when the log was recorded.

use cg_vehicle::calibration::{Calibration, Judgment};
use serde::{Deserialize, Serialize};

/// Times before this one (9 September 2001) are not Unix time: logs of their own clocks begin near zero.
const UNIX_S: f64 = 1e9;
const DAY_S: f64 = 86_400.0;
/// Age from which a calibration is old, days. In half a year a stiffness that is known to 10 % before the calibration wanders
/// by 3.5 % (`cg_vehicle::calibration`), and the height by about half as much as the stiffness of all tires.
const OLD_DAYS: f64 = 183.0;

/// What an estimate says of the calibration on which it rests.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Basis {
    /// Whether its runs are possible.
    pub judgment: Judgment,
    /// Days since 1970 when it was made; `None` if its age does not matter, because later trips say what has changed, or if
    /// its date is none.
    pub day: Option<u32>,
}

impl Basis {
    /// That of a calibration.
    pub fn of(calibration: &Calibration) -> Self {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        // a negative one is the first day
        let day = date_s(calibration).map(|date_s| (date_s / DAY_S) as u32);
        Self { judgment: calibration.judgment(), day }
    }

    /// The same if later trips are used, whose uncertainty contains the time since the last of them.
    #[must_use]
    pub fn with_trips(self, are_used: bool) -> Self {
        Self { day: self.day.filter(|_| !are_used), ..self }
    }

    /// What is said of it in a log at the time `time_s`, s, if that is Unix time.
    pub fn age_message(&self, time_s: f64) -> Option<String> {
        let days = (time_s / DAY_S).floor() - f64::from(self.day?);
        (time_s >= UNIX_S && days >= OLD_DAYS).then(|| {
            format!(
                "the calibration was {days:.0} days old at the time of this drive, and the interval does not contain what tires, springs \
                 and sensors have changed since (a tenth less tire pressure makes the height about 2 % too great); calibrate again, \
                 or set residual_sd in the vehicle file before the calibration"
            )
        })
    }
}

/// Unix time of the date of a calibration, s.
#[allow(clippy::cast_precision_loss)] // seconds since 1970
pub(crate) fn date_s(calibration: &Calibration) -> Option<f64> {
    let date = chrono::DateTime::parse_from_rfc3339(&calibration.date).ok()?;
    Some(date.timestamp() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MADE: u32 = 20_000;

    #[test]
    fn half_a_year_is_told_if_both_times_are_known() {
        let basis = Basis { judgment: Judgment::Sound, day: Some(MADE) };
        let after = |basis: Basis, days: f64| basis.age_message((f64::from(MADE) + days) * DAY_S);
        assert_eq!(after(basis, 182.0), None);
        assert!(after(basis, 200.0).unwrap().starts_with("the calibration was 200 days old"));
        // A log of before the calibration, one with a clock of its own, and a truck that has learned since.
        assert_eq!(after(basis, -200.0), None);
        assert_eq!(basis.age_message(120.0), None);
        assert_eq!(after(basis.with_trips(true), 200.0), None);
        assert_eq!(basis.with_trips(false), basis);
    }
}
