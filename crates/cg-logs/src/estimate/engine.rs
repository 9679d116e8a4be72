//! The estimator with the chosen method of identification.

use cg_core::Maneuver;
use cg_core::decide::neighbors::{Most, Together};
use cg_core::identify::arx::{ArxOptions, SampledArx};
use cg_core::identify::filtered::LONG_BLOCK;
use cg_core::{
    Channel, Combined, Design, Estimator, FilteredArx, Height, Memory, Prior, Sample, SampleError,
    Settings, Step,
};
use serde::{Deserialize, Serialize};

use super::options::{EstimateOptions, Method};
use cg_vehicle::Variant;

/// Sampling interval of the classical ARX, as in the thesis. Faster logs are downsampled to it.
const ARX_INTERVAL_S: f64 = 0.05;

/// The estimator with the chosen method of identification.
#[derive(Clone, Serialize, Deserialize)]
pub enum Engine {
    /// ARX on filtered signals with prior dynamics.
    Filtered(Box<Estimator<f64, FilteredArx<f64, LONG_BLOCK>>>),
    /// Classical ARX in shift form.
    Arx(Box<Estimator<f64, SampledArx<f64>>>),
}

/// The options of an identifier.
enum Identifier {
    Filtered(Prior<f64>),
    Arx(ArxOptions<f64>),
}

impl Identifier {
    fn of(options: &EstimateOptions) -> Self {
        let standard = Prior::standard();
        match options.method {
            Method::Filtered => Self::Filtered(standard),
            Method::Gain => Self::Filtered(Prior { dynamics_sd: 0.0, ..standard }),
            Method::Arx => {
                Self::Arx(ArxOptions { order: options.order, interval_s: ARX_INTERVAL_S })
            }
        }
    }
}

fn settings(options: &EstimateOptions) -> Settings<f64> {
    let mut settings = Settings::truck();
    if options.variant == Variant::AsPrinted {
        // The matrices printed in the thesis overshoot by a third; the plant and the truck do not.
        settings.standstill = f64::INFINITY;
    }
    options.road.map_or(settings, |road| settings.on_road(road.bank_sd_rad))
}

impl Engine {
    /// An estimator before its first sample, with the method, the equations and the road of the
    /// options; the others are not used.
    pub fn new(design: &Design<f64>, options: &EstimateOptions) -> Self {
        let settings = settings(options);
        match Identifier::of(options) {
            Identifier::Filtered(prior) => {
                Self::Filtered(Box::new(Estimator::new(*design, settings, prior)))
            }
            Identifier::Arx(arx) => Self::Arx(Box::new(Estimator::new(*design, settings, arx))),
        }
    }

    /// An estimator of a truck that this one has become with the same load: it knows no height, and the given mass, kg, or that
    /// which this one knows.
    #[must_use]
    pub fn become_other(
        &self,
        (design, options): (&Design<f64>, &EstimateOptions),
        mass_kg: Option<f64>,
    ) -> Self {
        let new = Self::new(design, options);
        let trailer_mass_kg = mass_kg.unwrap_or(self.memory().trailer_mass_kg);
        let memory = Memory { trailer_mass_kg, ..new.memory() };
        Self::restored(design, options, &memory).unwrap_or(new)
    }

    /// The same with the learned state of another one with the same design and method; `None` if the
    /// memory is not [sound](Memory::is_sound).
    pub fn restored(
        design: &Design<f64>,
        options: &EstimateOptions,
        memory: &Memory<f64>,
    ) -> Option<Self> {
        let settings = settings(options);
        Some(match Identifier::of(options) {
            Identifier::Filtered(prior) => {
                let restored = Estimator::restored(*design, settings, prior, memory)?;
                Self::Filtered(Box::new(restored))
            }
            Identifier::Arx(arx) => {
                Self::Arx(Box::new(Estimator::restored(*design, settings, arx, memory)?))
            }
        })
    }

    /// The design of the truck.
    pub fn design(&self) -> &Design<f64> {
        match self {
            Self::Filtered(estimator) => estimator.design(),
            Self::Arx(estimator) => estimator.design(),
        }
    }

    /// The learned state.
    pub fn memory(&self) -> Memory<f64> {
        match self {
            Self::Filtered(estimator) => estimator.memory(),
            Self::Arx(estimator) => estimator.memory(),
        }
    }

    /// Processes one sample.
    ///
    /// # Errors
    /// As [`Estimator::push`].
    pub fn push(&mut self, sample: &Sample<f64>) -> Result<Step<f64>, SampleError> {
        match self {
            Self::Filtered(estimator) => estimator.push(sample),
            Self::Arx(estimator) => estimator.push(sample),
        }
    }

    /// How many samples make a mean, as [`Estimator::most`].
    pub fn most(&self) -> Most {
        match self {
            Self::Filtered(estimator) => estimator.most(),
            Self::Arx(estimator) => estimator.most(),
        }
    }

    /// Processes the mean of some samples, as [`Estimator::push_mean`].
    pub fn push_mean(&mut self, together: &Together<f64, Sample<f64>>) -> Step<f64> {
        match self {
            Self::Filtered(estimator) => estimator.push_mean(together),
            Self::Arx(estimator) => estimator.push_mean(together),
        }
    }

    /// Ends the drive, as [`Estimator::finish`].
    pub fn finish(&mut self) -> Option<Maneuver<f64>> {
        match self {
            Self::Filtered(estimator) => estimator.finish(),
            Self::Arx(estimator) => estimator.finish(),
        }
    }

    /// The fused height of one channel, as [`Estimator::height`].
    pub fn height(&self, channel: Channel) -> Option<Height<f64>> {
        match self {
            Self::Filtered(estimator) => estimator.height(channel),
            Self::Arx(estimator) => estimator.height(channel),
        }
    }

    /// The combined height of all channels, as [`Estimator::combined`].
    pub fn combined(&self) -> Option<Combined<f64>> {
        match self {
            Self::Filtered(estimator) => estimator.combined(),
            Self::Arx(estimator) => estimator.combined(),
        }
    }

    /// The end of the maneuver that revealed another load, as [`Estimator::load_since_us`].
    pub fn load_since_us(&self) -> Option<u64> {
        match self {
            Self::Filtered(estimator) => estimator.load_since_us(),
            Self::Arx(estimator) => estimator.load_since_us(),
        }
    }

    /// The channel with the smallest standard deviation, as [`Estimator::best_channel`].
    pub fn best_channel(&self) -> Option<Channel> {
        match self {
            Self::Filtered(estimator) => estimator.best_channel(),
            Self::Arx(estimator) => estimator.best_channel(),
        }
    }
}
