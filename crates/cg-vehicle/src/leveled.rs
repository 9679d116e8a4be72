//! Air springs with leveling valves: the valves keep the height, and the stiffness grows with the
//! pressure, that is with the load and its place.

use std::borrow::Cow;

use crate::balance::{load_groups, static_balance};
use crate::error::VehicleError;
use crate::load::Load;
use crate::tables::Spring;
use crate::vehicle::{Axle, PlacedAxle, Vehicle};

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
        let all: Vec<usize> = (0..self.axles().len()).collect();
        self.level(&mut moved, &all, load)?;
        for axle in moved.axles_mut() {
            axle.leveled = false;
        }
        Ok(moved)
    }

    /// Makes the springs of another vehicle, whose axles are these of the present one, those that they are under a
    /// load of the other one.
    pub(crate) fn level(
        &self,
        other: &mut Self,
        kept: &[usize],
        load: Load,
    ) -> Result<(), VehicleError> {
        let axles = self.axles();
        if !kept.iter().any(|&i| axles[i].axle.leveled) {
            return Ok(());
        }
        let here = static_balance(other, load)?.axle_load_n;
        let reference = static_balance(self, self.reference_load())?.axle_load_n;
        let sprung_n = |placed: &PlacedAxle<'_>, load_n: f64| {
            load_n - placed.axle.unsprung_mass_kg * self.gravity_mps2
        };
        // Axles of a load group have the same load, and share the springs of the first one.
        let groups = load_groups(&axles);
        let group = |i: usize| groups.iter().position(|members| members.contains(&i));
        let first = |k: usize| kept.iter().position(|&i| group(i) == group(kept[k])).unwrap_or(k);
        let factor = |k: usize| {
            let placed = &axles[kept[k]];
            sprung_n(placed, here[k]) / sprung_n(placed, reference[kept[k]])
        };
        let mut scaled_springs = Vec::new();
        for (k, axle) in other.axles_mut().enumerate().filter(|(_, axle)| axle.leveled) {
            let (first, factor) = (first(k), factor(first(k)));
            axle.spring_stiffness_n_per_m *= factor;
            let Some(spring) = self.spring_of(axle) else { continue };
            let name = format!("{} of axle {}", spring.name, kept[first] + 1);
            axle.spring = Some(name.clone());
            scaled_springs.push(scaled(spring, name, factor));
        }
        for spring in scaled_springs {
            if other.spring.iter().all(|known| known.name != spring.name) {
                other.spring.push(spring);
            }
        }
        Ok(())
    }

    fn axles_mut(&mut self) -> impl Iterator<Item = &mut Axle> {
        let tractor = self.tractor.axle.iter_mut().map(|axle| &mut axle.axle);
        tractor.chain(self.trailer.axle.iter_mut().map(|axle| &mut axle.axle))
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
