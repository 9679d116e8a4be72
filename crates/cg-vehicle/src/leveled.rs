//! Air springs with leveling valves: the valves keep the height, and the stiffness grows with the
//! pressure, that is with the load.

use std::borrow::Cow;

use crate::balance::static_balance;
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
        let axles = self.axles();
        if !axles.iter().any(|placed| placed.axle.leveled) {
            return Ok(Cow::Borrowed(self));
        }
        let [here, reference] =
            [load, self.reference_load()].map(|load| static_balance(self, load));
        let (here, reference) = (here?.axle_load_n, reference?.axle_load_n);
        let sprung_n = |placed: &PlacedAxle<'_>, load_n: f64| {
            load_n - placed.axle.unsprung_mass_kg * self.gravity_mps2
        };
        let factors: Vec<f64> = axles
            .iter()
            .zip(here.iter().zip(&reference))
            .map(|(placed, (here_n, reference_n))| {
                sprung_n(placed, *here_n) / sprung_n(placed, *reference_n)
            })
            .collect();
        let mut moved = self.clone();
        let tractor = moved.tractor.axle.iter_mut().map(|axle| &mut axle.axle);
        let all = tractor.chain(moved.trailer.axle.iter_mut().map(|axle| &mut axle.axle));
        let mut springs = Vec::new();
        for (axle, factor) in all.zip(factors) {
            if axle.leveled {
                scale(self, axle, factor, &mut springs);
            }
        }
        moved.spring.extend(springs);
        Ok(Cow::Owned(moved))
    }
}

/// Multiplies the forces of an axle's springs. Measured curves get a name of their own, which axles of
/// a load group share, because they have the same load.
fn scale(vehicle: &Vehicle, axle: &mut Axle, factor: f64, springs: &mut Vec<Spring>) {
    axle.leveled = false;
    axle.spring_stiffness_n_per_m *= factor;
    let named = vehicle.spring.iter().find(|spring| Some(&spring.name) == axle.spring.as_ref());
    let Some(spring) = named else { return };
    let mut scaled = spring.clone();
    scaled.name = format!("{} at {factor:.12}", spring.name);
    for force_n in scaled.compression_n.iter_mut().chain(&mut scaled.extension_n) {
        *force_n *= factor;
    }
    axle.spring = Some(scaled.name.clone());
    springs.push(scaled);
}
