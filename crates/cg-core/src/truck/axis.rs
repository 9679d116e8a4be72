//! Interpolation on the axes of a table.

use crate::math::real::Real;

/// A point on an axis: the index of the first of four nodes, and their weights.
pub(crate) struct Weights<T> {
    pub(crate) first: usize,
    pub(crate) weights: [T; 4],
}

/// The interval of a strictly increasing axis that contains `value`, and the relative position in
/// it.
#[inline(never)] // used often, and flash is scarce on a chip
pub(crate) fn locate<T: Real>(axis: &[T], value: T) -> Option<(usize, T)> {
    for (i, pair) in axis.windows(2).enumerate() {
        if let [low, high] = pair
            && value >= *low
            && value <= *high
        {
            return Some((i, (value - *low) / (*high - *low)));
        }
    }
    None
}

/// An interval of an axis, and the four nodes around it (near an end of the axis: the first or last four).
pub(crate) struct Cell<T> {
    /// The index of the first node.
    pub(crate) first: usize,
    pub(crate) nodes: [T; 4],
    pub(crate) span: [T; 2],
}

impl<T: Real> Cell<T> {
    /// The interval that contains `value`.
    pub(crate) fn around(axis: &[T], value: T) -> Option<Self> {
        let (interval, _) = locate(axis, value)?;
        let first = interval.saturating_sub(1).min(axis.len().saturating_sub(4));
        let nodes = *axis.get(first..)?.first_chunk::<4>()?;
        Some(Self { first, nodes, span: *axis.get(interval..)?.first_chunk::<2>()? })
    }
}

/// The [four nodes](Cell) around `value` and their Lagrange weights. With `curvature`, the axis is
/// 1/U² instead of a speed U, which is the curvature at a lateral acceleration.
#[inline(never)]
pub(crate) fn cubic<T: Real>(axis: &[T], value: T, curvature: bool) -> Option<Weights<T>> {
    let Cell { first, nodes, .. } = Cell::around(axis, value)?;
    let scale = |u: T| if curvature { T::one() / (u * u) } else { u };
    let (nodes, value) = (nodes.map(scale), scale(value));
    let mut place = 0;
    let weights = nodes.map(|node| {
        let (mut above, mut below) = (T::one(), T::one());
        for (k, other) in nodes.iter().enumerate() {
            if k != place {
                above *= value - *other;
                below *= node - *other;
            }
        }
        place += 1;
        above / below
    });
    Some(Weights { first, weights })
}

/// The coefficients, ascending, of the cubic with these values at these nodes.
#[inline(never)]
pub(crate) fn polynomial<T: Real>(nodes: &[T; 4], values: [T; 4]) -> [T; 4] {
    let mut c = values;
    // Newton's divided differences, then from Newton's form to powers.
    for k in 1..4 {
        for i in (k..4).rev() {
            c[i] = (c[i] - c[i - 1]) / (nodes[i] - nodes[i - k]);
        }
    }
    for k in (0..3).rev() {
        for i in k..3 {
            c[i] -= nodes[k] * c[i + 1];
        }
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_ends_belong_to_it_and_nothing_beyond() {
        let axis = [1.0, 2.0, 4.0];
        assert_eq!(locate(&axis, 1.0), Some((0, 0.0)));
        assert_eq!(locate(&axis, 4.0), Some((1, 1.0)));
        assert_eq!(locate(&axis, 3.0), Some((1, 0.5)));
        assert_eq!(locate(&axis, 0.99), None);
        assert_eq!(locate(&axis, f64::NAN), None);
    }

    /// In any interval of an axis with unequal spacing; exact at the nodes.
    #[test]
    fn a_cubic_is_met_by_its_nodes() {
        let axis = [3.0, 4.0, 5.5, 8.0, 12.0, 17.0];
        let law = |x: f64| 2.0 - x + 0.3 * x * x - 0.01 * x * x * x;
        for value in [3.0, 3.2, 4.7, 5.5, 7.0, 9.0, 16.0, 17.0_f64] {
            for curvature in [false, true] {
                let law = |x: f64| law(if curvature { 1.0 / (x * x) } else { x });
                let Weights { first, weights } = cubic(&axis, value, curvature).unwrap();
                let found: f64 = axis[first..].iter().zip(weights).map(|(x, w)| w * law(*x)).sum();
                assert!((found - law(value)).abs() < 1e-12, "{value}: {found}");
            }
        }
        assert!(cubic(&axis, 2.9, false).is_none() && cubic(&axis, 17.1, true).is_none());
    }
    #[test]
    fn a_polynomial_has_the_coefficients_of_the_law() {
        let law = |x: f64| 2.0 - x + 0.3 * x * x - 0.01 * x * x * x;
        let nodes = [-1.5, 0.0, 2.5, 6.5];
        for (found, known) in polynomial(&nodes, nodes.map(law)).iter().zip([2.0, -1.0, 0.3, -0.01])
        {
            // A dozen roundings of numbers up to ten.
            assert!((found - known).abs() < 1e-13, "{found} {known}");
        }
    }
}
