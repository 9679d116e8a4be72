//! The estimator with the chosen method of identification.

use cg_core::Maneuver;
use cg_core::identify::arx::{ArxOptions, SampledArx};
use cg_core::{
    Channel, Combined, Design, Estimator, FilteredArx, Height, Prior, Sample, SampleError,
    Settings, Step,
};
use serde::{Deserialize, Serialize};

use super::options::{EstimateOptions, Method};
use cg_vehicle::Variant;

/// Sampling interval of the classical ARX, as in the thesis. Faster logs are downsampled to it.
const ARX_INTERVAL_S: f64 = 0.05;

/// The estimator with the chosen method of identification.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) enum Engine {
    Filtered(Box<Estimator<f64, FilteredArx<f64>>>),
    Arx(Box<Estimator<f64, SampledArx<f64>>>),
}

impl Engine {
    pub(crate) fn new(design: &Design<f64>, options: &EstimateOptions) -> Self {
        let mut settings = Settings::truck();
        if options.variant == Variant::AsPrinted {
            // The matrices printed in the thesis overshoot by a third; the plant and the truck do
            // not.
            settings.standstill = f64::INFINITY;
        }
        if let Some(road) = options.road {
            settings = settings.on_road(road.bank_sd_rad);
        }
        let standard = Prior::standard();
        match options.method {
            Method::Filtered => {
                Self::Filtered(Box::new(Estimator::new(*design, settings, standard)))
            }
            Method::Gain => {
                let fixed = Prior { dynamics_sd: 0.0, ..standard };
                Self::Filtered(Box::new(Estimator::new(*design, settings, fixed)))
            }
            Method::Arx => {
                let arx = ArxOptions { order: options.order, interval_s: ARX_INTERVAL_S };
                Self::Arx(Box::new(Estimator::new(*design, settings, arx)))
            }
        }
    }

    pub(crate) fn push(&mut self, sample: &Sample<f64>) -> Result<Step<f64>, SampleError> {
        match self {
            Self::Filtered(estimator) => estimator.push(sample),
            Self::Arx(estimator) => estimator.push(sample),
        }
    }

    pub(crate) fn finish(&mut self) -> Option<Maneuver<f64>> {
        match self {
            Self::Filtered(estimator) => estimator.finish(),
            Self::Arx(estimator) => estimator.finish(),
        }
    }

    pub(crate) fn height(&self, channel: Channel) -> Option<Height<f64>> {
        match self {
            Self::Filtered(estimator) => estimator.height(channel),
            Self::Arx(estimator) => estimator.height(channel),
        }
    }

    pub(crate) fn combined(&self) -> Option<Combined<f64>> {
        match self {
            Self::Filtered(estimator) => estimator.combined(),
            Self::Arx(estimator) => estimator.combined(),
        }
    }

    pub(crate) fn load_since_us(&self) -> Option<u64> {
        match self {
            Self::Filtered(estimator) => estimator.load_since_us(),
            Self::Arx(estimator) => estimator.load_since_us(),
        }
    }

    pub(crate) fn best_channel(&self) -> Option<Channel> {
        match self {
            Self::Filtered(estimator) => estimator.best_channel(),
            Self::Arx(estimator) => estimator.best_channel(),
        }
    }
}
