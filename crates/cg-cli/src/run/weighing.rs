//! How exact the trailer mass is.

use cg_core::Design;
use cg_logs::estimate::Weighed;
use cg_vehicle::scales::{Scale, Scales};

use super::events::{MassSource, Result as Known};
use super::state::SavedLoad;

/// What is known of the exactness of the trailer mass.
#[derive(Clone, Copy)]
pub(crate) struct Weighing {
    /// The given standard deviation.
    pub(crate) sd_kg: Option<f64>,
    /// The last standard deviation beside a mass in a log of rows, kg.
    pub(crate) logged_sd_kg: Option<f64>,
    /// The scales of the vehicle.
    pub(crate) scales: Scales,
    /// The same before a restart, or of a mass that was given then, kg.
    pub(crate) kept_sd_kg: Option<f64>,
    /// The scale of the last mass by a signal, also before a restart.
    pub(crate) scale: Option<Scale>,
    /// Whether that mass is of the present load.
    pub(crate) weighed: Weighed,
    /// When the mass of the present sample came on a bus, where it is held, µs.
    pub(crate) heard_us: Option<u64>,
    /// The last one of these.
    known_us: Option<u64>,
}

impl Weighing {
    /// Exact scales, nothing given.
    pub(crate) const EXACT: Self = Self {
        sd_kg: None,
        logged_sd_kg: None,
        kept_sd_kg: None,
        scales: Scales::EXACT,
        scale: None,
        weighed: Weighed::NEVER,
        heard_us: None,
        known_us: None,
    };

    /// Takes the mass of a sample, kg, and the one that is used instead. The speed is NaN if it is not known. Returns whether the
    /// mass is a new one, and not one that is held.
    pub(crate) fn weigh(&mut self, sample_us: u64, masses_kg: [f64; 2], speed_mps: f64) -> bool {
        let is_new = self.heard_us.is_none() || self.heard_us != self.known_us;
        if is_new {
            self.known_us = self.heard_us;
            self.weighed.weigh(self.heard_us.unwrap_or(sample_us), masses_kg, speed_mps);
        }
        is_new
    }

    /// Takes a change of the load that a maneuver from `start_us` on has revealed, with the masses in the one before and in it, kg.
    /// Returns a message if the mass from this source was weighed before it.
    pub(crate) fn unload(
        &mut self,
        start_us: u64,
        masses_kg: [f64; 2],
        source: MassSource,
    ) -> Option<&'static str> {
        let is_weighed = matches!(source, MassSource::Kept | MassSource::Signal);
        (is_weighed && self.weighed.change_load(start_us, masses_kg)).then_some(
            "the load changed, and no signal has given a trailer mass since: that of the load before is used, \
             and the interval contains any load; give --trailer-mass-kg or a signal of the mass",
        )
    }

    /// What a restart needs of a mass from this source.
    pub(crate) fn saved(&self, source: MassSource) -> SavedLoad {
        SavedLoad {
            scale: self.scale(source).or(self.scale),
            mass_sd_kg: self.stated_sd_kg(source),
            mass_is_of_another_load: self.weighed.is_of_another_load(),
            ..SavedLoad::default()
        }
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
        let is_given = source == MassSource::Given;
        if !is_given && self.weighed.is_of_another_load() {
            return design.any_load_sd_kg();
        }
        let of_scale_kg =
            || self.scale(source).map_or(0.0, |scale| self.scales.sd_kg(scale, mass_kg));
        self.stated_sd_kg(source).unwrap_or_else(|| match source {
            MassSource::Nominal => design.any_load_sd_kg(),
            MassSource::Signal => libm::hypot(of_scale_kg(), self.weighed.scatter_kg()),
            MassSource::Kept | MassSource::Given => of_scale_kg(),
        })
    }

    /// The standard deviation of a mass from this source that was given or is beside it, kg.
    fn stated_sd_kg(&self, source: MassSource) -> Option<f64> {
        self.sd_kg.or(match source {
            MassSource::Signal => self.logged_sd_kg,
            MassSource::Kept => self.kept_sd_kg,
            MassSource::Nominal | MassSource::Given => None,
        })
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
    fn a_mass_of_another_load_may_be_any() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
        let vehicle = Vehicle::load(path).unwrap();
        let design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
        for (source, is_outdated) in [
            (MassSource::Nominal, false),
            (MassSource::Given, false),
            (MassSource::Kept, true),
            (MassSource::Signal, true),
        ] {
            let mut weighing = Weighing { sd_kg: Some(70.0), ..Weighing::EXACT };
            weighing.weighed.weigh(1_000_000, [20e3; 2], 15.0);
            assert!(weighing.unload(31_000_000, [20e3; 2], source).is_none());
            assert_eq!(weighing.unload(31_000_001, [20e3; 2], source).is_some(), is_outdated);
            let sd_kg = weighing.sd_kg(source, 20e3, &design);
            let expected_kg = if is_outdated { design.any_load_sd_kg() } else { 70.0 };
            assert!((sd_kg - expected_kg).abs() < 1e-9, "{source:?}: {sd_kg}");
        }
    }
}
