//! Whether the curves of a log contradict each other, as they do on a banked road.

use cg_core::{Channel, Reject};

use super::intake::LogEstimator;

/// Standard deviation of a ratio from curve to curve, as a share of its mean, above which the road counts as
/// banked. On flat roads the independent truck and the nonlinear plant show up to 0.09 (measured springs), on
/// banked ones 0.26 and more.
const WIDE: f64 = 0.2;
/// How much greater than the noise it must be.
const SURE: f64 = 2.0;

/// The ratios of roll angle and lateral acceleration of a log, one for each curve.
pub(super) struct Scatter {
    /// Their standard deviation, as a share of their mean.
    share: f64,
    /// Number of curves without a height, and of all.
    rejected: [usize; 2],
    /// Whether no flat road explains them.
    pub(super) is_wide: bool,
}

impl LogEstimator {
    /// How much the ratios differ from curve to curve; `None` with fewer than two.
    pub(super) fn scatter(&self) -> Option<Scatter> {
        let place = Channel::LateralAcceleration.index();
        let outcomes = self.of_load().iter().map(|maneuver| maneuver.outcomes[place]);
        let fitted: Vec<_> = outcomes.filter(|outcome| outcome.fit.is_some()).collect();
        let believed =
            fitted.iter().filter(|one| matches!(one.height_m, Ok(_) | Err(Reject::Height(_))));
        let ratios: Vec<_> = believed.filter_map(|one| Some(one.fit?.ratio)).collect();
        if ratios.len() < 2 {
            return None;
        }
        #[allow(clippy::cast_precision_loss)] // a count
        let n = ratios.len() as f64;
        let mean = ratios.iter().map(|ratio| ratio.value).sum::<f64>() / n;
        let off = |value: f64| (value - mean) * (value - mean);
        let square = ratios.iter().map(|ratio| off(ratio.value)).sum::<f64>();
        let noise = (ratios.iter().map(|ratio| ratio.sd * ratio.sd).sum::<f64>() / n).sqrt();
        let sd = (square / (n - 1.0)).sqrt();
        let rejected = fitted.iter().filter(|one| one.height_m.is_err()).count();
        Some(Scatter {
            share: sd / mean.abs(),
            rejected: [rejected, fitted.len()],
            is_wide: sd > WIDE * mean.abs() && sd > SURE * noise,
        })
    }

    /// What is said of curves that contradict each other although the road counts as flat.
    pub(super) fn scattered(&self) -> Option<String> {
        let found = self.scatter().filter(|found| found.is_wide && !self.is_on_road())?;
        let Scatter { share, rejected: [rejected, all], .. } = found;
        let rest = match rejected {
            0 => String::new(),
            _ => format!(", and {rejected} of {all} maneuvers gave no height"),
        };
        let percent = 100.0 * share;
        Some(format!(
            "the ratio of roll angle and lateral acceleration differs by {percent:.0} % from curve to curve{rest}"
        ))
    }

    /// The likely cause if the suspension roll of a pair has the wrong sign.
    pub(super) fn reversed(&self, pair: Channel) -> Option<String> {
        let is_used = self.engine.height(pair).is_some();
        let outcomes = self.of_load().iter().map(|maneuver| maneuver.outcomes[pair.index()]);
        let fits: Vec<_> = outcomes.filter_map(|outcome| outcome.fit).collect();
        let reversed = fits.iter().filter(|fit| fit.ratio.value < -SURE * fit.ratio.sd).count();
        let (unit, prefix) = match pair {
            Channel::Tractor => ("tractor", "tractor_"),
            _ => ("trailer", ""),
        };
        (!is_used && reversed * 2 > fits.len()).then(|| {
            format!(
                "the suspension roll of the {unit} is reversed (left and right level are swapped, or \
                 ⟨flip {prefix}suspension_roll⟩), or its specific force is (⟨flip \
                 {prefix}lateral_specific_force⟩)"
            )
        })
    }
}
