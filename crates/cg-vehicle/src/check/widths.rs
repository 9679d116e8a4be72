//! Widths that are full in the file and half of it by mistake.

use super::relations::axles;
use crate::finding::plain;
use crate::vehicle::{Axle, Vehicle};

/// Distance between the springs divided by that between the inner tires, below which the distance may be
/// half of the true one. Trucks have 0.4 (steered axles on leaf springs) to 0.9.
const LEAST_SHARE: f64 = 0.36;

/// A hint at the narrowest springs, if their distance is so small beside that of the tires that it may be
/// half of it. It is for a vehicle that is impossible as a whole.
pub(super) fn halved(vehicle: &Vehicle) -> Option<String> {
    let axles = axles(vehicle);
    let of = |(_, axle): &(String, &Axle)| share(axle);
    let (path, axle) = axles.iter().min_by(|a, b| of(a).total_cmp(&of(b)))?;
    let (spread_m, doubled_m) = (axle.spring_spread_m, 2.0 * axle.spring_spread_m);
    (share(axle) < LEAST_SHARE).then(|| {
        format!(
            "{path}.spring_spread_m = {} is small beside tyre_positions_m: it is the full distance between \
             the left and the right spring, so if you gave half of it, write {}",
            plain(spread_m),
            plain(doubled_m)
        )
    })
}

fn share(axle: &Axle) -> f64 {
    let inner_m = axle.tyre_positions_m.iter().copied().fold(f64::INFINITY, f64::min);
    axle.spring_spread_m / (2.0 * inner_m)
}
