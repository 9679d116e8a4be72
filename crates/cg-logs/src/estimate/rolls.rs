//! Whether two roll sensors of a log agree.

use serde::{Deserialize, Serialize};

use cg_core::AlignSettings;

use super::pair::Pair;
use crate::log::LogRow;

/// Minimum number of rows for a statement.
const LEAST_ROWS: f64 = 100.0;
/// Minimum standard deviation of the first roll angle for a comparison, rad: a third of a degree.
const EXCITED_RAD: f64 = 0.006;
/// Slopes of one roll sensor with respect to another on the same frame of which nothing is known: the soft frame of an
/// empty flatbed swings 2.8 times as far at its front as over the axles.
const POSSIBLE: [f64; 2] = [0.25, 4.0];
/// By how much the gains of two sensors differ that are as good as usual: 3 % each, three standard deviations.
const GAINS: f64 = 1.13;

/// Checks the roll angles of one log.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct RollCheck {
    both: Pair,
    both_rows: f64,
    /// Rows with the first or the second sensor alone.
    alone: [u64; 2],
}

impl RollCheck {
    pub(super) fn push(&mut self, row: &LogRow) {
        let [first, second] = [row.roll_rad, row.second_roll_rad];
        match [first.is_finite(), second.is_finite()] {
            [true, true] => {
                self.both_rows += 1.0;
                self.both.push(self.both_rows, [first, second]);
            }
            [false, false] => {}
            [is_first, _] => self.alone[usize::from(!is_first)] += 1,
        }
    }

    /// Whether any row has the roll angle of a second sensor.
    pub(super) fn has_second(&self) -> bool {
        self.both_rows > 0.0 || self.alone[1] > 0
    }

    /// The contradiction between two roll sensors, or of both with the vehicle file, if there is one.
    pub(super) fn contradiction(
        &self,
        settings: &AlignSettings<f64>,
        slopes: Option<[f64; 2]>,
    ) -> Option<String> {
        if settings.second_roll_share.is_some() {
            return self.disagreement(slopes);
        }
        (settings.roll_is_mean_of_two && self.has_second()).then(|| {
            "the log has a roll angle of each of two sensors, but the vehicle file has \
             second_behind_hitch_m without second_share in [sensors.roll], so that the roll angle would be \
             the mean of both: add second_share (`cg vehicle check` says the best one)"
                .to_owned()
        })
    }

    fn disagreement(&self, slopes: Option<[f64; 2]>) -> Option<String> {
        let spread_rad = (self.both.square() / self.both_rows).sqrt();
        let slope = self.both.slope();
        let compared = self.both_rows >= LEAST_ROWS && spread_rad > EXCITED_RAD;
        let [least, greatest] =
            slopes.map_or(POSSIBLE, |[least, greatest]| [least / GAINS, greatest * GAINS]);
        if !compared || (least..=greatest).contains(&slope) {
            return None;
        }
        let cause = if slope < 0.0 {
            "one of them is reversed (⟨flip roll⟩ or ⟨flip second_roll⟩)"
        } else {
            "the unit or the gain of one of them is wrong (⟨columns second_roll=NAME[deg]⟩), or the frame is \
             not as stiff as in the vehicle file"
        };
        Some(format!(
            "the second roll sensor shows {slope:.2} times the roll angle of the first, but on this frame {least:.2} to \
             {greatest:.2} times are possible: {cause}"
        ))
    }

    /// What is wrong with the sensors of a log, with the vehicle file's share of the second one.
    pub(super) fn places(
        &self,
        settings: &AlignSettings<f64>,
        slopes: Option<[f64; 2]>,
    ) -> Option<String> {
        let [first, second] = self.alone;
        match settings.second_roll_share {
            None if settings.roll_is_mean_of_two => self.contradiction(settings, slopes),
            None => self.has_second().then(|| {
                "the log has the roll angle of a second sensor, but the vehicle file has no \
                 sensors.roll.second_share for it: it is not used"
                    .to_owned()
            }),
            Some(_) if first + second > 0 => Some(format!(
                "{} rows have the roll angle of one of the two sensors only and were left out, because \
                 the vehicle file has sensors.roll.second_share; if roll is already the mean of both, \
                 remove that key, and if there is only one sensor, second_behind_hitch_m too",
                first + second
            )),
            Some(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(rows: impl IntoIterator<Item = [f64; 2]>) -> RollCheck {
        let mut check = RollCheck::default();
        for [roll_rad, second_roll_rad] in rows {
            let row = LogRow { roll_rad, second_roll_rad, ..LogRow::ABSENT };
            check.push(&row);
        }
        check
    }

    fn swing(k: u32) -> f64 {
        0.03 * (0.1 * f64::from(k)).sin()
    }

    #[test]
    fn two_sensors_on_one_frame_agree_in_sign_and_size() {
        let both = |slope: f64, rows: u32, size: f64| {
            check((0..rows).map(|k| [size * swing(k), slope * size * swing(k) + 0.01]))
        };
        let found = |slope: f64, rows: u32, size: f64| both(slope, rows, size).disagreement(None);
        assert!(found(1.4, 200, 1.0).is_none() && found(0.6, 200, 1.0).is_none());
        assert!(found(-1.0, 200, 1.0).unwrap().contains("reversed"));
        assert!(found(57.3, 200, 1.0).unwrap().contains("unit"));
        // Too few rows, too little roll.
        assert!(found(-1.0, 99, 1.0).is_none() && found(-1.0, 200, 0.1).is_none());
        // On a known frame, less is possible: a rear sensor after a front one.
        let known = |slope: f64| both(slope, 200, 1.0).disagreement(Some([0.6, 1.0]));
        assert!(known(0.55).is_none() && known(1.1).is_none());
        let told = known(1.2).unwrap();
        assert!(told.contains("on this frame 0.53 to 1.13 times are possible"), "{told}");
        assert!(known(0.5).is_some());
    }

    #[test]
    fn a_log_and_a_file_need_the_same_sensors() {
        let (both, first) = (check([[0.01, 0.02]]), check([[0.01, f64::NAN]]));
        let none = AlignSettings::NONE;
        let half = AlignSettings { second_roll_share: Some(0.5), ..none };
        let mean = AlignSettings { roll_is_mean_of_two: true, ..none };
        assert!(both.places(&none, None).unwrap().contains("is not used"));
        assert!(both.places(&half, None).is_none() && first.places(&none, None).is_none());
        assert!(first.places(&half, None).unwrap().starts_with("1 rows"));
        assert!(both.places(&mean, None).unwrap().contains("add second_share"));
        assert!(
            both.contradiction(&mean, None).is_some() && both.contradiction(&none, None).is_none()
        );
        assert!(first.places(&mean, None).is_none() && first.contradiction(&mean, None).is_none());
    }
}
