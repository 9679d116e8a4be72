//! The part of a side wind in the uncertainty of a height or a ratio.

/// Share of the variance above which the wind is reported.
const MUCH: f64 = 0.25;

/// The part of a side wind in the uncertainty of a height, m, or of a ratio.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use]
pub struct ByWind {
    pub(super) sd: f64,
    /// Whether the vehicle file says what the body and the wind are.
    pub(super) is_stated: bool,
}

impl ByWind {
    /// Standard deviation that belongs in the interval: that of a wind that the vehicle file states.
    #[must_use]
    pub fn within(self) -> f64 {
        if self.is_stated { self.sd } else { 0.0 }
    }

    /// What is said of the wind if it makes a large part of the variance, or would make it, beside everything else with this
    /// standard deviation.
    #[must_use]
    pub fn message(self, other: f64) -> Option<String> {
        let share = self.sd * self.sd / (self.sd * self.sd + other * other);
        let percent = 100.0 * share;
        (share > MUCH).then(|| {
            if self.is_stated {
                format!(
                    "a side wind as strong as wind.speed_mps of the vehicle file says makes up {percent:.0} % of the variance of the \
                     height: a drive with turns in all directions, or a calm day with wind.speed_mps = 0, makes its interval narrower"
                )
            } else {
                format!(
                    "the interval contains no side wind, because the vehicle file has no [wind]: on a box body, 3 m/s would make up \
                     {percent:.0} % of the variance of the height. Give [wind], for a calm day with speed_mps = 0, or drive turns in \
                     all directions"
                )
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wind_that_is_a_quarter_of_the_variance_is_told() {
        for (is_stated, said) in [(true, "makes up 50 %"), (false, "would make up 50 %")] {
            let told = |sd: f64| ByWind { sd, is_stated }.message(0.1);
            assert!(told(0.057).is_none() && told(0.0).is_none());
            assert!(told(0.1).unwrap().contains(said));
        }
    }

    /// A wind that nobody has stated changes no interval.
    #[test]
    fn only_a_stated_wind_is_within() {
        let [stated, assumed] = [true, false].map(|is_stated| ByWind { sd: 0.1, is_stated });
        assert!((stated.within() - 0.1).abs() < 1e-15 && assumed.within() <= 0.0);
    }
}
