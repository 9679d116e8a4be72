//! How exact the trailer mass is.

use cg_core::Design;
use cg_vehicle::scales::{Scale, Scales};

use super::events::{MassSource, Result as Known};

/// What is known of the exactness of the trailer mass.
#[derive(Clone, Copy)]
pub(crate) struct Weighing {
    /// The given standard deviation.
    pub(crate) sd_kg: Option<f64>,
    /// The scales of the vehicle.
    pub(crate) scales: Scales,
    /// The scale of the last mass by a signal, also before a restart.
    pub(crate) scale: Option<Scale>,
    /// Whether the mass is that of the load before.
    pub(crate) of_another_load: bool,
    /// Time of the last mass by a signal, µs.
    pub(crate) last_us: Option<u64>,
}

impl Weighing {
    /// Exact scales, nothing given.
    pub(crate) const EXACT: Self = Self {
        sd_kg: None,
        scales: Scales::EXACT,
        scale: None,
        of_another_load: false,
        last_us: None,
    };

    /// Takes a mass by a signal.
    pub(crate) fn weigh(&mut self, time_us: u64) {
        (self.of_another_load, self.last_us) = (false, Some(time_us));
    }

    /// Takes a change of the load that a maneuver from `start_us` on has revealed. Returns a message if the
    /// mass from this source was weighed before it.
    pub(crate) fn unload(&mut self, start_us: u64, source: MassSource) -> Option<&'static str> {
        let weighed = matches!(source, MassSource::Kept | MassSource::Signal);
        let outdated = weighed && self.last_us.is_none_or(|last_us| last_us < start_us);
        self.of_another_load |= outdated;
        outdated.then_some(
            "the load changed, and no signal has given a trailer mass since: that of the load before is used, \
             and the interval contains any load; give --trailer-mass-kg or a signal of the mass",
        )
    }

    /// A result with the scale of its mass and its standard deviation.
    pub(crate) fn of(&self, design: &Design<f64>, result: Known) -> Known {
        let (source, mass_kg) = (result.trailer_mass_source, result.trailer_mass_kg);
        Known {
            trailer_mass_scale: self.scale(source),
            trailer_mass_sd_kg: self.sd_kg(source, mass_kg, design),
            ..result
        }
    }

    /// The scale of a mass from this source, if it was weighed.
    fn scale(&self, source: MassSource) -> Option<Scale> {
        match source {
            MassSource::Nominal => None,
            MassSource::Given => Some(Scale::Weighed),
            MassSource::Kept | MassSource::Signal => self.scale,
        }
    }

    /// Standard deviation of a mass from this source, kg. A mass that was never weighed may be any.
    fn sd_kg(&self, source: MassSource, mass_kg: f64, design: &Design<f64>) -> f64 {
        let of_scale = || match source {
            MassSource::Nominal => design.any_load_sd_kg(),
            MassSource::Kept | MassSource::Signal if self.of_another_load => {
                design.any_load_sd_kg()
            }
            _ => self.scale(source).map_or(0.0, |scale| self.scales.sd_kg(scale, mass_kg)),
        };
        self.sd_kg.unwrap_or_else(of_scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cg_vehicle::{Variant, Vehicle};

    #[test]
    fn a_mass_is_as_exact_as_its_source() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
        let vehicle = Vehicle::load(path).unwrap();
        let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
        let scales = Scales::of(&vehicle);
        let any_kg = design.any_load_sd_kg();
        for scale in [None, Some(Scale::AxleLoad)] {
            let weighing = Weighing { scales, scale, ..Weighing::EXACT };
            let signal_kg = scale.map_or(0.0, |scale| scales.sd_kg(scale, 20e3));
            for (source, named, sd_kg) in [
                (MassSource::Nominal, None, any_kg),
                (MassSource::Kept, scale, signal_kg),
                (MassSource::Signal, scale, signal_kg),
                (MassSource::Given, Some(Scale::Weighed), 0.0),
            ] {
                let mass = (20e3, source);
                let result = weighing.of(&design, Known::new(None, None, mass));
                assert_eq!(result.trailer_mass_scale, named);
                assert!((result.trailer_mass_sd_kg - sd_kg).abs() < 1e-9, "{source:?}");
                let given = Weighing { sd_kg: Some(70.0), ..weighing };
                let result = given.of(&design, Known::new(None, None, mass));
                assert!((result.trailer_mass_sd_kg - 70.0).abs() < 1e-9, "{source:?}");
            }
        }
        assert!(scales.sd_kg(Scale::AxleLoad, 20e3) > 100.0 && any_kg > 5e3);
    }
    #[test]
    fn a_mass_counts_until_the_load_changes_without_a_new_one() {
        let mut weighing = Weighing::EXACT;
        weighing.weigh(1_000_000);
        assert!(weighing.unload(1_000_000, MassSource::Signal).is_none());
        assert!(weighing.unload(1_000_001, MassSource::Given).is_none());
        assert!(weighing.unload(1_000_001, MassSource::Signal).is_some());
        assert!(weighing.of_another_load);
        weighing.weigh(2_000_000);
        assert!(!weighing.of_another_load);
        // After a restart.
        let mut resumed = Weighing::EXACT;
        assert!(resumed.unload(0, MassSource::Kept).is_some());
    }
}
