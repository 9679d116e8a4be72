//! The heights of the channels.

use cg_core::Channel;
use cg_logs::estimate::Engine;

/// The channels with a height.
fn with_height(estimator: &Engine) -> impl Iterator<Item = Channel> {
    Channel::ALL.into_iter().filter(|channel| estimator.height(*channel).is_some())
}

/// The channel with a height, if there is one alone.
pub(crate) fn alone(estimator: &Engine) -> Option<Channel> {
    let mut channels = with_height(estimator);
    channels.next().filter(|_| channels.next().is_none())
}

/// Standard deviation of a height due to that of the trailer mass, m. The pair is the mass and its standard
/// deviation, kg.
pub(crate) fn mass_sd_m(
    estimator: &Engine,
    speed_mps: f64,
    mass_kg: [f64; 2],
    height_m: f64,
) -> f64 {
    estimator.design().mass_sd_m(with_height(estimator), speed_mps, mass_kg, height_m)
}

/// The heights of channels that contradict each other. Of those without a possible one, the channels that have signals are
/// named.
pub(crate) fn heights(estimator: &Engine, has_signals: impl Fn(Channel) -> bool) -> String {
    let of = |channel: Channel| match estimator.height(channel) {
        Some(height) => {
            let height_m = height.height_m;
            Some(format!("{channel} channel {:.2} ± {:.2} m", height_m.value, height_m.sd))
        }
        None => {
            has_signals(channel).then(|| format!("{channel} channel without a possible height"))
        }
    };
    Channel::ALL.into_iter().filter_map(of).collect::<Vec<_>>().join(", ")
}
