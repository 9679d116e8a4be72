//! Judges a calibration: whether its runs are possible for the vehicle file.

/// Normal quantiles of the probabilities 1 % and 1e-4 with which a sound calibration is exceeded.
const DOUBTFUL: f64 = 2.326;
const CONTRADICTORY: f64 = 3.719;

/// Whether runs and vehicle file agree within the uncertainty of both.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Judgment {
    /// They agree.
    #[default]
    Sound,
    /// By chance they would differ as much in less than one of a hundred calibrations. All standard
    /// deviations are multiplied by the Birge ratio.
    Doubtful {
        /// `√(χ²/n)`.
        birge: f64,
    },
    /// By chance they would differ as much in less than one of ten thousand calibrations.
    Contradictory {
        /// `√(χ²/n)`.
        birge: f64,
    },
}

impl Judgment {
    /// Judges a sum of squares over `n` ratios, distributed as χ² with `n` degrees of freedom if the
    /// standard deviations are correct.
    pub(super) fn of(chi_square: f64, n: usize) -> Self {
        #[allow(clippy::cast_precision_loss)] // a count
        let n = n.max(1) as f64;
        // Wilson and Hilferty's approximation of the quantiles.
        let ninth = 2.0 / (9.0 * n);
        let limit = |quantile: f64| {
            let root = 1.0 - ninth + quantile * ninth.sqrt();
            n * root * root * root
        };
        let birge = (chi_square / n).sqrt();
        if chi_square <= limit(DOUBTFUL) {
            Self::Sound
        } else if chi_square <= limit(CONTRADICTORY) {
            Self::Doubtful { birge }
        } else {
            Self::Contradictory { birge }
        }
    }

    /// The factor of all standard deviations.
    pub fn birge(self) -> f64 {
        match self {
            Self::Sound => 1.0,
            Self::Doubtful { birge } | Self::Contradictory { birge } => birge,
        }
    }

    /// What every answer must say that rests on the calibration.
    pub fn message(self) -> Option<String> {
        (self != Self::Sound).then(|| {
            format!(
                "the runs of the calibration contradict the vehicle file more than its [uncertainty] \
                 allows: its standard deviations are multiplied by {:.1}; check heights, masses and \
                 sensors of the runs",
                self.birge()
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quantiles of χ² in tables. The approximation is within 8 %, the worst for 1e-4 and one degree
    /// of freedom.
    #[test]
    fn the_limits_are_the_quantiles_of_the_tables() {
        for (n, doubtful, contradictory) in
            [(1_u8, 6.635, 15.137), (4, 13.277, 23.513), (8, 20.090, 31.828)]
        {
            let of = |chi_square| Judgment::of(chi_square, n.into());
            assert_eq!(of(0.92 * doubtful), Judgment::Sound);
            for within in [1.08 * doubtful, 0.92 * contradictory] {
                assert!(matches!(of(within), Judgment::Doubtful { .. }), "{n}");
            }
            let beyond = of(1.08 * contradictory);
            assert!(matches!(beyond, Judgment::Contradictory { .. }), "{n}");
            let birge = (1.08 * contradictory / f64::from(n)).sqrt();
            assert!((beyond.birge() - birge).abs() < 1e-12);
        }
    }
}
