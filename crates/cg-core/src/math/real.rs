//! The two floating-point types of the estimator, `f32` and `f64`.

use core::fmt::{Debug, Display};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

mod sealed {
    /// Closes the set of types, and keeps the matrix library out of the public interface.
    pub trait Sealed: nalgebra::RealField + Copy {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A floating-point type: `f32` runs on the vehicle, and `f64` is used to check it.
///
/// Square root and logarithm come from `libm` on every target. A host and a Cortex-M4F
/// therefore give the same bits.
pub trait Real:
    sealed::Sealed
    + Copy
    + PartialOrd
    + Debug
    + Display
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// Zero as a constant.
    const ZERO: Self;
    /// One, as a constant.
    const ONE: Self;

    /// The nearest value to `value`.
    fn of(value: f64) -> Self;
    /// This value as `f64`.
    fn as_f64(self) -> f64;
    /// Square root (NaN for negative arguments).
    #[must_use]
    fn root(self) -> Self;
    /// Decimal logarithm.
    #[must_use]
    fn decimal_log(self) -> Self;
    /// The machine epsilon.
    fn machine_epsilon() -> Self;
    /// Not a number (NaN), which marks an absent signal in a [`Sample`](crate::Sample).
    fn absent() -> Self;
    /// Whether the value is neither NaN nor infinite, so that the signal is present.
    fn present(self) -> bool;
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn of(value: f64) -> Self {
        value
    }
    fn as_f64(self) -> f64 {
        self
    }
    fn root(self) -> Self {
        libm::sqrt(self)
    }
    fn decimal_log(self) -> Self {
        libm::log10(self)
    }
    fn machine_epsilon() -> Self {
        f64::EPSILON
    }
    fn absent() -> Self {
        f64::NAN
    }
    fn present(self) -> bool {
        self.is_finite()
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[allow(clippy::cast_possible_truncation)] // rounding to f32 is the purpose
    fn of(value: f64) -> Self {
        value as f32
    }
    fn as_f64(self) -> f64 {
        f64::from(self)
    }
    fn root(self) -> Self {
        libm::sqrtf(self)
    }
    fn decimal_log(self) -> Self {
        libm::log10f(self)
    }
    fn machine_epsilon() -> Self {
        f32::EPSILON
    }
    fn absent() -> Self {
        f32::NAN
    }
    fn present(self) -> bool {
        self.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Properties that both types have, to a few of their own ε.
    fn behaves<T: Real>() {
        let close = |a: T, b: f64| (a.as_f64() - b).abs() < 4.0 * T::machine_epsilon().as_f64();
        assert!(T::ZERO == T::zero() && close(T::of(0.75), 0.75));
        assert!(close(T::of(2.0).root(), core::f64::consts::SQRT_2));
        assert!(close(T::of(0.01).decimal_log(), -2.0));
        assert!(!T::absent().present() && !(T::one() / T::zero()).present() && T::one().present());
        let epsilon = T::machine_epsilon();
        assert!(T::one() + epsilon > T::one() && T::one() + epsilon / T::of(4.0) == T::one());
    }

    #[test]
    fn both_precisions_do_the_same() {
        behaves::<f32>();
        behaves::<f64>();
    }
}
