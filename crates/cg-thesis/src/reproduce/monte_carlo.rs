//! Many draws of the noise in place of one.
//!
//! The experiment is the rounded step of rate `a` (eq. 5.3) for 10 s, white noise on the roll angle, SNR
//! relative to its mean square, and `[n n+1 0]` ARX models in shift form. The thesis prints neither the
//! duration nor the sampling interval nor the kind of noise; 10 s and 0.05 s are ours, and Table 5.7 also
//! has rows at 50 and 100 Hz.
//! Draw `k` of every cell has the seed `seed + k`, so that cells differ by their settings only.

use cg_core::truck::simulation::Simulation;
use cg_core::{Answer, Arx, FilteredArx, Identify, Prior, Reduced5};
use rand::SeedableRng;
use rand::rngs::StdRng;

use super::baseline::Options;
use cg_plant::random::standard_normal;
use cg_vehicle::reduction::quality::rounded_step;

/// Sampling interval.
pub(super) const INTERVAL_S: f64 = 0.05;
/// Duration of an experiment.
const DURATION_S: f64 = 10.0;
/// Samples in an experiment.
pub(super) const SAMPLES: usize = 201;
/// Rate of the rounded step where the thesis does not state it.
pub(super) const RATE_PER_S: u32 = 3;
/// Estimates with a greater error are outliers: left out of bias and RMSE, and counted.
const OUTLIER_PERCENT: f64 = 30.0;

/// Input and noise-free output.
pub(super) struct Experiment {
    pub(super) steer: Vec<f64>,
    pub(super) roll: Vec<f64>,
}

/// The rounded step of unit height, sampled for ten seconds.
pub(super) fn steps(rate_per_s: u32, interval_s: f64) -> Vec<f64> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some hundreds
    let samples = (DURATION_S / interval_s).round() as u32;
    let at = |k| rounded_step(interval_s * f64::from(k), f64::from(rate_per_s));
    (0..=samples).map(at).collect()
}

impl Experiment {
    /// An experiment on a reduced model.
    pub(super) fn on_reduced(model: &Reduced5<f64>, rate_per_s: u32, steer_rad: f64) -> Self {
        Self::sampled(model, rate_per_s, steer_rad, INTERVAL_S)
    }

    /// The same at another sampling interval.
    pub(super) fn sampled(
        model: &Reduced5<f64>,
        rate_per_s: u32,
        steer_rad: f64,
        interval_s: f64,
    ) -> Self {
        let steps = steps(rate_per_s, interval_s);
        let steer: Vec<f64> = steps.iter().map(|step| steer_rad * step).collect();
        let mut simulation = Simulation::new(model, interval_s, 0.0);
        // The model is at rest at the first sample, where the step is zero.
        let roll = steer.iter().enumerate();
        let roll = roll.map(|(k, &u)| if k == 0 { 0.0 } else { simulation.push(u) }).collect();
        Self { steer, roll }
    }

    /// Mean square of the roll angle.
    pub(super) fn mean_square(&self) -> f64 {
        #[allow(clippy::cast_precision_loss)]
        let n = self.roll.len() as f64;
        self.roll.iter().map(|y| y * y).sum::<f64>() / n
    }

    /// The roll angle with one draw of the noise; `None` for none.
    pub(super) fn drawn(&self, snr_db: Option<f64>, seed: u64) -> Vec<f64> {
        let Some(snr_db) = snr_db else { return self.roll.clone() };
        let sd = (self.mean_square() * libm::pow(10.0, -snr_db / 10.0)).sqrt();
        let mut rng = StdRng::seed_from_u64(seed);
        self.roll.iter().map(|y| y + sd * standard_normal(&mut rng)).collect()
    }

    /// Bias and RMSE over many draws; `error_percent` returns the error for a drawn roll angle and its
    /// seed.
    pub(super) fn score(
        &self,
        snr_db: Option<f64>,
        options: &Options,
        error_percent: impl Fn(&[f64], u64) -> Option<f64>,
    ) -> ScorePercent {
        // Without noise all draws are equal.
        let runs = if snr_db.is_some() { options.runs } else { 1 };
        let (mut sum, mut squares, mut used) = (0.0, 0.0, 0);
        for run in 0..runs {
            let seed = options.seed.wrapping_add(u64::from(run));
            let error = error_percent(&self.drawn(snr_db, seed), seed)
                .filter(|error| error.abs() <= OUTLIER_PERCENT);
            if let Some(error) = error {
                sum += error;
                squares += error * error;
                used += 1;
            }
        }
        let n = f64::from(used);
        ScorePercent {
            bias: (used > 0).then(|| sum / n),
            rmse: (used > 0).then(|| (squares / n).sqrt()),
            scatter: if used > 0 {
                (squares / n - (sum / n) * (sum / n)).max(0.0).sqrt()
            } else {
                0.0
            },
            outliers: 100.0 * f64::from(runs - used) / f64::from(runs),
        }
    }
}

/// Errors of the height over many draws, in %.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScorePercent {
    /// Mean error; `None` if all are outliers.
    pub(super) bias: Option<f64>,
    /// Root mean square error.
    pub(super) rmse: Option<f64>,
    /// Standard deviation of one draw.
    pub(super) scatter: f64,
    /// Share of draws with an error beyond 30 %, which are left out of both.
    pub(super) outliers: f64,
}

/// Coefficients `a1 … an, b0 … bn` of an ARX model of order n, `N = 2n + 1`.
pub(super) fn arx<const N: usize>(steer: &[f64], roll: &[f64]) -> Option<[f64; N]> {
    let order = (N - 1) / 2;
    let mut arx = Arx::<f64, N>::new(order, order + 1, 0)?;
    for (&u, &y) in steer.iter().zip(roll) {
        arx.push(u, y, true);
    }
    arx.coefficients()
}

/// DC ratio of an ARX model of order 1 to 5.
pub(super) fn arx_ratio(order: usize, steer: &[f64], roll: &[f64]) -> Option<f64> {
    fn ratio<const N: usize>(steer: &[f64], roll: &[f64]) -> Option<f64> {
        let coefficients = arx::<N>(steer, roll)?;
        let (past, inputs) = coefficients.split_at((N - 1) / 2);
        Some(inputs.iter().sum::<f64>() / (1.0 + past.iter().sum::<f64>()))
    }
    match order {
        1 => ratio::<3>(steer, roll),
        2 => ratio::<5>(steer, roll),
        3 => ratio::<7>(steer, roll),
        4 => ratio::<9>(steer, roll),
        5 => ratio::<11>(steer, roll),
        _ => None,
    }
}

/// DC ratio from the project's identifier as it is on board: its standard prior, a free offset.
pub(super) fn standard_ratio(
    nominal: &Reduced5<f64>,
    steer: &[f64],
    roll: &[f64],
    interval_s: f64,
) -> Option<f64> {
    let mut identifier = FilteredArx::new(nominal, Prior::standard());
    for (&u, &y) in steer.iter().zip(roll) {
        identifier.push(u, y, interval_s, true);
    }
    match identifier.fit() {
        Answer::Ready(fit) => Some(fit.ratio.value),
        Answer::Unexcited(_) => None,
    }
}

/// A model whose dynamics differ from those of `model` by 20 % (one standard deviation of each
/// coefficient), stable and with the same DC gain.
pub(super) fn off_by_a_fifth(model: &Reduced5<f64>, seed: u64) -> Reduced5<f64> {
    let mut rng = StdRng::seed_from_u64(seed ^ DYNAMICS_SEED);
    loop {
        let mut factor = || 1.0 + DYNAMICS_SD * standard_normal(&mut rng);
        let mut other = *model;
        other.denominator.iter_mut().chain(&mut other.numerator).for_each(|c| *c *= factor());
        let gain = model.dc_gain() / other.dc_gain();
        other.numerator.iter_mut().for_each(|c| *c *= gain);
        if other.is_stable() {
            return other;
        }
    }
}

/// Standard deviation of the dynamics, as the standard prior assumes it.
const DYNAMICS_SD: f64 = 0.2;
/// Keeps the draws of the dynamics apart from those of the noise.
const DYNAMICS_SEED: u64 = 0x5eed_0000_0000_0000;

/// The project's identifier around a nominal model, after all samples.
pub(super) fn filtered(nominal: &Reduced5<f64>, steer: &[f64], roll: &[f64]) -> FilteredArx<f64> {
    // The experiments have no constant offset, and neither have the thesis's models.
    let prior = Prior { offset_sd_rad: 0.0, ..Prior::standard() };
    let mut identifier = FilteredArx::new(nominal, prior);
    for (&u, &y) in steer.iter().zip(roll) {
        identifier.push(u, y, INTERVAL_S, true);
    }
    identifier
}

/// DC ratio from the same identifier.
pub(super) fn filtered_ratio(nominal: &Reduced5<f64>, steer: &[f64], roll: &[f64]) -> Option<f64> {
    match filtered(nominal, steer, roll).fit() {
        Answer::Ready(fit) => Some(fit.ratio.value),
        Answer::Unexcited(_) => None,
    }
}
