//! Whether two runs come from the same drive.

use cg_core::Measured;

/// Relative difference of ratios below which they are of the same drive: more than the rounding of its rows makes, and a
/// thousandth of the noise of the best trips.
const SAME: f64 = 1e-6;

/// Whether the ratios of two runs were computed from the same drive.
pub(crate) fn are_of_one_drive(first: &[f64], second: &[f64]) -> bool {
    let mut pairs = first.iter().zip(second);
    first.len() == second.len() && pairs.all(|(one, other)| (one / other - 1.0).abs() < SAME)
}

/// The ratios that there are.
pub(crate) fn values(ratios: &[Option<Measured<f64>>]) -> Vec<f64> {
    ratios.iter().flatten().map(|ratio| ratio.value).collect()
}
