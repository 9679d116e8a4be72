//! Small fixed-size algebra and the trigonometry of small angles.

/// A vector in a yaw frame: forward, left, up.
pub(super) type Vector = [f64; 3];

#[inline]
pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
pub(super) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(super) fn scaled(a: Vector, k: f64) -> Vector {
    [a[0] * k, a[1] * k, a[2] * k]
}

/// The components of `a` in axes turned to the left by the angle with this sine and cosine.
#[inline]
pub(super) fn turned(a: Vector, (sin, cos): (f64, f64)) -> Vector {
    [cos * a[0] + sin * a[1], cos * a[1] - sin * a[0], a[2]]
}

/// Greatest angles for the short and the long series below.
const SHORT_RAD: f64 = 0.1;
const LONG_RAD: f64 = 0.65;

/// Sine and cosine, with series for the angles that vehicles have (remainders below 5e-17).
#[inline]
pub(super) fn sin_cos(x: f64) -> (f64, f64) {
    let size = x.abs();
    if size > LONG_RAD {
        return libm::sincos(x);
    }
    let q = x * x;
    // Quotients of consecutive factorials: sin to x⁹ or x¹⁵, cos to x⁸ or x¹⁶.
    let (sin_rest, cos_rest) = if size < SHORT_RAD {
        (1.0 / 72.0, 1.0 / 56.0)
    } else {
        let sin = 1.0 - q * (1.0 / 156.0 - q * (1.0 / (156.0 * 210.0)));
        let cos = 1.0 - q * (1.0 / 132.0) * (1.0 - q * (1.0 / 182.0) * (1.0 - q * (1.0 / 240.0)));
        (
            (1.0 - q * (1.0 / 110.0) * sin) * (1.0 / 72.0),
            (1.0 - q * (1.0 / 90.0) * cos) * (1.0 / 56.0),
        )
    };
    let sin = 1.0
        - q * (1.0 / 6.0)
            * (1.0 - q * (1.0 / 20.0) * (1.0 - q * (1.0 / 42.0) * (1.0 - q * sin_rest)));
    let cos =
        1.0 - q * 0.5 * (1.0 - q * (1.0 / 12.0) * (1.0 - q * (1.0 / 30.0) * (1.0 - q * cos_rest)));
    (sin * x, cos)
}

/// Arc tangent of a small number (remainder below 1e-15 of it up to 0.004).
#[inline]
pub(super) fn small_atan(x: f64) -> f64 {
    if x.abs() > 0.004 {
        return libm::atan(x);
    }
    let q = x * x;
    x * (1.0 - q * (1.0 / 3.0 - q * 0.2))
}

/// A symmetric positive definite matrix as `L D Lᵀ`.
pub(super) struct Factored<const N: usize> {
    /// `L D`, in the lower triangle.
    lower: [[f64; N]; N],
    /// Of `D`.
    inverse: [f64; N],
}

impl<const N: usize> Factored<N> {
    /// Of a matrix of which the lower triangle is read.
    #[inline]
    pub(super) fn new(mut a: [[f64; N]; N]) -> Self {
        let mut inverse = [0.0; N];
        for j in 0..N {
            inverse[j] = 1.0 / a[j][j];
            for i in j + 1..N {
                let factor = a[i][j] * inverse[j];
                for k in i..N {
                    a[k][i] -= a[k][j] * factor;
                }
            }
        }
        Self { lower: a, inverse }
    }

    /// Solves `A x = b`.
    #[inline]
    pub(super) fn solve(&self, mut b: [f64; N]) -> [f64; N] {
        let Self { lower, inverse } = self;
        for j in 0..N {
            for i in j + 1..N {
                b[i] -= lower[i][j] * inverse[j] * b[j];
            }
        }
        for i in (0..N).rev() {
            let mut sum = b[i];
            for k in i + 1..N {
                sum -= lower[k][i] * b[k];
            }
            b[i] = sum * inverse[i];
        }
        b
    }
}

/// Inverse of a symmetric 3 × 3 matrix.
#[inline]
pub(super) fn inverse_symmetric(a: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let (a00, a11, a22) = (a[0][0], a[1][1], a[2][2]);
    let (a10, a20, a21) = (a[1][0], a[2][0], a[2][1]);
    let c00 = a11 * a22 - a21 * a21;
    let c10 = a20 * a21 - a10 * a22;
    let c20 = a10 * a21 - a20 * a11;
    let scale = 1.0 / (a00 * c00 + a10 * c10 + a20 * c20);
    let c11 = a00 * a22 - a20 * a20;
    let c21 = a10 * a20 - a00 * a21;
    let c22 = a00 * a11 - a10 * a10;
    let rows = [[c00, c10, c20], [c10, c11, c21], [c20, c21, c22]];
    rows.map(|row| scaled(row, scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_agree_with_the_library() {
        for k in -100..=100 {
            let x = f64::from(k) * 0.0065;
            let (sin, cos) = sin_cos(x);
            // The tolerance is the rounding of the last operations.
            assert!((sin - x.sin()).abs() < 3e-16 && (cos - x.cos()).abs() < 3e-16, "{x}");
            assert!((small_atan(x) - x.atan()).abs() < 3e-16, "{x}");
        }
    }

    #[test]
    fn a_solution_solves() {
        let a = [[4.0, 1.0, -0.5], [1.0, 3.0, 0.25], [-0.5, 0.25, 2.0]];
        let b = [1.0, -2.0, 3.0];
        let x = Factored::new(a).solve(b);
        let inverse = inverse_symmetric(a);
        for i in 0..3 {
            let sum: f64 = (0..3).map(|j| a[i][j] * x[j]).sum();
            let inverted: f64 = (0..3).map(|j| inverse[i][j] * b[j]).sum();
            assert!((sum - b[i]).abs() < 1e-14 && (inverted - x[i]).abs() < 1e-14);
        }
    }
}
