//! The DC ratio as a function of the height, and its inverse.
//!
//! The height `h` occurs in one row only of the vehicle's steady-state equations, and linearly. By
//! Cramer's rule both the numerator and the denominator of the DC ratio are therefore exactly
//! linear in `h`:
//!
//! ```text
//!     R_a(h) = (a1 h + a0) / (b1 h + b0)                    eq. 5.18
//!     R_c R_a(h) = R_i                                      eq. 5.20
//!     h = (a0 − x b0) / (x b1 − a1),   x = R_i / R_c
//! ```

use core::fmt;

use crate::math::real::Real;

/// A value and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Measured<T> {
    /// The value.
    pub value: T,
    /// Its standard deviation, in the same unit.
    pub sd: T,
}

impl<T: Real> Measured<T> {
    /// A value without uncertainty.
    pub fn exact(value: T) -> Self {
        Self { value, sd: T::zero() }
    }

    /// The squared relative standard deviation.
    pub fn relative_variance(&self) -> T {
        let relative = self.sd / self.value;
        relative * relative
    }
}

/// The DC ratio `(a1 h + a0) / (b1 h + b0)` of one channel at one speed and mass (eq. 5.17). A
/// common factor of the four numbers has no effect.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RatioLine<T> {
    /// Numerator at zero height.
    pub a0: T,
    /// Increase of the numerator per meter of height.
    pub a1: T,
    /// Denominator at zero height.
    pub b0: T,
    /// Increase of the denominator per meter of height.
    pub b1: T,
}

impl<T: Real> RatioLine<T> {
    /// A sum of no lines.
    pub(crate) const NONE: Self = Self { a0: T::ZERO, a1: T::ZERO, b0: T::ZERO, b1: T::ZERO };

    /// The DC ratio at height `height_m` (eq. 5.18).
    pub fn ratio_at(&self, height_m: T) -> T {
        (self.a1 * height_m + self.a0) / (self.b1 * height_m + self.b0)
    }

    /// Relative change of the DC ratio per meter of height, `d ln R/dh`, 1/m.
    pub fn relative_slope_at(&self, height_m: T) -> T {
        self.a1 / (self.a1 * height_m + self.a0) - self.b1 / (self.b1 * height_m + self.b0)
    }

    /// Adds `weight` times `other` to every coefficient.
    pub(crate) fn add(&mut self, other: &Self, weight: T) {
        self.a0 += other.a0 * weight;
        self.a1 += other.a1 * weight;
        self.b0 += other.b0 * weight;
        self.b1 += other.b1 * weight;
    }
}

/// The reason why a ratio gives no height.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum HeightError<T> {
    /// The ratio is not a finite number, or no height gives this ratio.
    NoSolution {
        /// The identified ratio divided by the compensation.
        ratio: T,
    },
    /// A height gives this ratio, but it is outside the range that the trailer can have.
    OutOfRange {
        /// The height that would give the ratio, in meters.
        height_m: T,
    },
}

impl<T: Real> fmt::Display for HeightError<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSolution { ratio } => {
                write!(f, "no height gives the ratio {:.4}", ratio.as_f64())
            }
            Self::OutOfRange { height_m } => {
                write!(f, "height {:.2} m is outside the physical range", height_m.as_f64())
            }
        }
    }
}

impl<T: Real> core::error::Error for HeightError<T> {}

/// Solves eq. 5.20 for the height.
///
/// The relative standard deviations of the identified ratio, of the compensation and of the model's
/// ratio are propagated to the height to first order.
///
/// # Errors
/// [`HeightError::NoSolution`] if the ratio is not finite or the line does not depend on the height
/// there.
#[inline(never)]
pub fn solve_height<T: Real>(
    line: &RatioLine<T>,
    identified: Measured<T>,
    compensation: Measured<T>,
    model_sd_relative: T,
) -> Result<Measured<T>, HeightError<T>> {
    let x = identified.value / compensation.value;
    let slope = x * line.b1 - line.a1;
    let value = (line.a0 - x * line.b0) / slope;
    // dh/dx = (a1 b0 − a0 b1) / (x b1 − a1)². Each factor is divided by the slope first, because
    // the coefficients of eq. 5.17 reach 1e272 and their products would overflow.
    let derivative = (line.a1 / slope) * (line.b0 / slope) - (line.a0 / slope) * (line.b1 / slope);
    let relative_variance = identified.relative_variance()
        + compensation.relative_variance()
        + model_sd_relative * model_sd_relative;
    let sd = (derivative * x).abs() * relative_variance.root();
    if value.present() && sd.present() {
        Ok(Measured { value, sd })
    } else {
        Err(HeightError::NoSolution { ratio: x })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THESIS: RatioLine<f64> =
        RatioLine { a0: -1.9772e270, a1: -1.0268e270, b0: 1.6703e272, b1: -2.9656e269 };

    /// Tables 5.6 and 5.7: the printed ratio of four digits gives the printed height in inches.
    #[test]
    fn tables_5_6_and_5_7_to_all_printed_decimals() {
        let to_four =
            [(-0.8459, 77.7147), (-0.8462, 77.7390), (-0.8463, 77.7470), (-0.8464, 77.7551)];
        let to_two = [
            (-0.8456, 77.69),
            (-0.8430, 77.48),
            (-0.8466, 77.77),
            (-0.8405, 77.28),
            (-0.8342, 76.77),
            (-0.8511, 78.13),
        ];
        let solve = |ratio| {
            solve_height(&THESIS, Measured::exact(ratio), Measured::exact(1.4894), 0.0)
                .unwrap()
                .value
        };
        // Half a unit of the last printed decimal.
        for (ratio, height_in) in to_four {
            assert!((solve(ratio) - height_in).abs() <= 0.5e-4, "{ratio}: {}", solve(ratio));
        }
        for (ratio, height_in) in to_two {
            assert!((solve(ratio) - height_in).abs() <= 0.5e-2, "{ratio}: {}", solve(ratio));
        }
    }

    #[test]
    fn the_standard_deviation_is_the_slope_times_the_ratio_error() {
        let ratio = Measured { value: -0.8456, sd: 0.001 };
        let exact = Measured::exact(1.4894);
        let sd = solve_height(&THESIS, ratio, exact, 0.0).unwrap().sd;
        let at = |r| solve_height(&THESIS, Measured::exact(r), exact, 0.0).unwrap().value;
        let difference = (at(-0.8466) - at(-0.8446)).abs() / 2.0;
        // The second-order terms of a 0.1 % step are about 1e-3 of the difference squared.
        assert!((sd / difference - 1.0).abs() < 1e-4);
        // d ln R / d ln h = 1.136 for the baseline vehicle
        let h = at(-0.8456);
        assert!(((0.001 / 0.8456) / (sd / h) - 1.136).abs() < 1e-3);
    }

    #[test]
    fn the_relative_slope_is_that_of_the_logarithm() {
        let line = RatioLine { a0: -0.2, a1: 1.1, b0: 1.3, b1: -0.2_f64 };
        for h in [0.9, 1.7, 2.6] {
            let logarithm = |h: f64| line.ratio_at(h).ln();
            // Central differences: the third derivative is about 10, rounding 1e-16/1e-4.
            let difference = (logarithm(h + 1e-4) - logarithm(h - 1e-4)) / 2e-4;
            assert!((line.relative_slope_at(h) - difference).abs() < 1e-6, "{h} {difference}");
        }
    }

    #[test]
    fn a_ratio_that_no_height_gives_is_an_error() {
        let flat = RatioLine { a0: 1.0, a1: 0.0, b0: 1.0, b1: 0.0 };
        assert!(solve_height(&flat, Measured::exact(2.0), Measured::exact(1.0), 0.0).is_err());
        let nan = Measured::exact(f64::NAN);
        assert!(solve_height(&THESIS, nan, Measured::exact(1.0), 0.0).is_err());
    }

    #[test]
    fn a_height_without_a_standard_deviation_is_none() {
        let line = RatioLine { a0: 0.0, a1: 1.0, b0: 1.0, b1: 0.0 };
        let (ratio, exact) = (Measured { value: 2.0, sd: f64::NAN }, Measured::exact(1.0));
        let found = solve_height(&line, ratio, exact, 0.0);
        assert_eq!(found, Err(HeightError::NoSolution { ratio: 2.0 }));
    }

    /// In this line the height equals the ratio, so relative variances add.
    #[test]
    fn ratio_compensation_and_model_each_have_their_part() {
        let line = RatioLine { a0: 0.0, a1: 1.0, b0: 1.0, b1: 0.0 };
        let (ratio, compensation) =
            (Measured { value: 3.0, sd: 0.06 }, Measured { value: 1.5, sd: 0.045 });
        let found = solve_height(&line, ratio, compensation, 0.06_f64).unwrap();
        assert!((found.value - 2.0).abs() < 1e-14);
        assert!((found.sd - 2.0 * 0.07).abs() < 1e-14); // √(0.02² + 0.03² + 0.06²)
    }

    #[test]
    fn lines_add_coefficient_by_coefficient() {
        let mut line = RatioLine { a0: 1.0, a1: 2.0, b0: 3.0, b1: 4.0 };
        line.add(&RatioLine { a0: 10.0, a1: 20.0, b0: 40.0, b1: 80.0 }, 0.5);
        assert_eq!(line, RatioLine { a0: 6.0, a1: 12.0, b0: 23.0, b1: 44.0 });
    }
}
