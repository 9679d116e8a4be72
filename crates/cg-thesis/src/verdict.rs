//! Whether a number of ours is that of the thesis: a range with two ends, which is stated beside the
//! verdict, and never less than both.

use std::fmt;

use serde::Serialize;

/// The range in which a number counts as the thesis's, and the reason for its width.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Criterion {
    /// Lower end.
    pub least: f64,
    /// Upper end.
    pub greatest: f64,
    /// Why it is that wide.
    pub reason: &'static str,
}

impl Criterion {
    /// The range from `least` to `greatest`.
    pub const fn between(least: f64, greatest: f64, reason: &'static str) -> Self {
        Self { least, greatest, reason }
    }

    /// The range of `half_width` to either side of a value.
    pub const fn around(value: f64, half_width: f64, reason: &'static str) -> Self {
        Self { least: value - half_width, greatest: value + half_width, reason }
    }

    /// Half the width of the range.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.greatest - self.least)
    }

    /// The verdict on a number; one that is not finite was not computed.
    ///
    /// ```
    /// use cg_thesis::verdict::{Criterion, Verdict};
    ///
    /// let slope = Criterion::around(4.1, 0.5, "a tenth of a degree at either end");
    /// assert_eq!([4.5, 3.5, 4.7].map(|ours| slope.judge(ours)), [
    ///     Verdict::Same,
    ///     Verdict::Differs,
    ///     Verdict::Differs,
    /// ]);
    /// assert_eq!(slope.judge(f64::NAN), Verdict::NotComputed);
    /// ```
    pub fn judge(&self, ours: f64) -> Verdict {
        if !ours.is_finite() {
            return Verdict::NotComputed;
        }
        // Ties may fall to either side, and decimal fractions are not exact in binary.
        let slack = 1e-9 * self.half_width();
        let within = self.least - slack <= ours && ours <= self.greatest + slack;
        if within { Verdict::Same } else { Verdict::Differs }
    }
}

/// What a comparison says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Ours is within the criterion.
    Same,
    /// The thesis has no such number; ours is additional.
    NotPrinted,
    /// A comparison cannot be computed.
    NotComputed,
    /// Ours is outside the criterion.
    Differs,
}

impl Verdict {
    /// Whether it is [`Verdict::Same`].
    pub fn is_same(self) -> bool {
        self == Self::Same
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Same => "same",
            Self::NotPrinted => "not printed",
            Self::NotComputed => "cannot be computed",
            Self::Differs => "differs",
        })
    }
}
