//! Air springs with leveling valves: the valves keep the height, and the stiffness grows with the
//! pressure, that is with the load and its place.

use std::borrow::Cow;

use crate::balance::static_balance;
use crate::error::VehicleError;
use crate::load::Load;
use crate::tables::Spring;
use crate::vehicle::{PlacedAxle, Vehicle};

impl Vehicle {
    /// The vehicle with its springs as they are under a load. The springs of axles with `leveled` stay
    /// at their height, and their stiffness and curves are in proportion to the static load that
    /// they carry; the file gives them at the reference load. All others are as in the file.
    ///
    /// # Errors
    /// As [`static_balance`] at this load and at the reference load.
    pub fn with_springs_at(&self, load: Load) -> Result<Cow<'_, Self>, VehicleError> {
        if !self.axles().iter().any(|placed| placed.axle.leveled) {
            return Ok(Cow::Borrowed(self));
        }
        self.leveled(self.clone(), load).map(Cow::Owned)
    }

    /// The vehicle with the payload of this load elsewhere: its c.g. is at this distance behind the fifth
    /// wheel. The springs of axles with `leveled` are as they are under this load.
    ///
    /// # Errors
    /// As [`with_springs_at`](Self::with_springs_at).
    pub fn with_payload_at(&self, load: Load, behind_hitch_m: f64) -> Result<Self, VehicleError> {
        let mut moved = self.clone();
        moved.trailer.payload.behind_hitch_m = behind_hitch_m;
        self.leveled(moved, load)
    }

    /// A vehicle with the springs of this one, as they are under a load of the other one.
    fn leveled(&self, mut moved: Self, load: Load) -> Result<Self, VehicleError> {
        let axles = self.axles();
        if !axles.iter().any(|placed| placed.axle.leveled) {
            return Ok(moved);
        }
        let here = static_balance(&moved, load)?.axle_load_n;
        let reference = static_balance(self, self.reference_load())?.axle_load_n;
        let sprung_n = |placed: &PlacedAxle<'_>, load_n: f64| {
            load_n - placed.axle.unsprung_mass_kg * self.gravity_mps2
        };
        // Axles of a load group have the same load, and share the springs of the first one.
        let first = |i: usize| {
            let same = |other: &PlacedAxle<'_>| {
                other.axle.load_group.is_some()
                    && other.axle.load_group == axles[i].axle.load_group
                    && other.on_trailer == axles[i].on_trailer
            };
            axles.iter().position(same).unwrap_or(i)
        };
        let factor = |i: usize| sprung_n(&axles[i], here[i]) / sprung_n(&axles[i], reference[i]);
        let tractor = moved.tractor.axle.iter_mut().map(|axle| &mut axle.axle);
        let all = tractor.chain(moved.trailer.axle.iter_mut().map(|axle| &mut axle.axle));
        for (i, axle) in all.enumerate().filter(|(_, axle)| axle.leveled) {
            axle.leveled = false;
            axle.spring_stiffness_n_per_m *= factor(first(i));
            let Some(spring) = self.spring_of(axle) else { continue };
            let name = format!("{} of axle {}", spring.name, first(i) + 1);
            if moved.spring.iter().all(|known| known.name != name) {
                moved.spring.push(scaled(spring, name.clone(), factor(first(i))));
            }
            axle.spring = Some(name);
        }
        Ok(moved)
    }
}

/// A measured spring with its forces multiplied.
fn scaled(spring: &Spring, name: String, factor: f64) -> Spring {
    let mut scaled = Spring { name, ..spring.clone() };
    for force_n in scaled.compression_n.iter_mut().chain(&mut scaled.extension_n) {
        *force_n *= factor;
    }
    scaled
}
