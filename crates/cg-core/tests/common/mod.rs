//! The thesis's reduced model (eq. 5.12) as a plant, its rounded step, and white noise.
#![allow(
    dead_code,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::unwrap_used
)] // each test file uses its part; indices are small

pub(crate) mod told;

use std::array::from_fn;

use cg_core::identify::mean::Mean;
use cg_core::truck::design::{MASSES, SPEEDS, SPRING_MASSES};
use cg_core::truck::ratio::{Measured, RatioLine, solve_height};
use cg_core::truck::simulation::Simulation;
use cg_core::{
    Articulation, Channel, ChannelDesign, Design, Estimator, Friction, PathLead, Real, Reduced5,
    RolloverDesign, Spread, ThresholdLine,
};
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, Normal};

/// The channels of [`design`].
pub(crate) const PAIR: [Channel; 2] = [Channel::Steer, Channel::LateralAcceleration];

/// An estimator with these channels.
pub(crate) type Pair<T, I> = Estimator<T, I, Design<T, 2>, 2>;

/// Eq. 5.12 with ISO 8855 signs.
pub(crate) const EQ_5_12: Reduced5<f64> = Reduced5 {
    numerator: [51.7785, 27.8430, 24.3105, -0.9015, 2.6063, -0.2554],
    denominator: [61.2322, 83.2666, 57.4175, 22.6413, 5.8858],
    speed_slope: [0.0; 5],
};

/// Eq. 5.17 with ISO 8855 signs, heights in inches.
pub(crate) const EQ_5_17: RatioLine<f64> =
    RatioLine { a0: 1.9772e270, a1: 1.0268e270, b0: 1.6703e272, b1: -2.9656e269 };

/// Eq. 5.19.
pub(crate) const COMPENSATION: f64 = 29.55 / 19.84;

/// Rounded step of unit height and rate `a` (eq. 5.3) at time `t`.
pub(crate) fn rounded_step(t: f64, a: f64) -> f64 {
    2.0 * ((-(-a * t).exp()).exp2() - 0.5)
}

/// `(steer, roll)` of eq. 5.12 under a rounded step, `n` samples `interval_s` apart.
pub(crate) fn rounded_step_response(n: usize, interval_s: f64, a: f64) -> Vec<(f64, f64)> {
    let steer = |k: usize| 0.05 * rounded_step(interval_s * k as f64, a);
    let mut plant = Simulation::new(&EQ_5_12, interval_s, 0.0);
    (0..n).map(|k| (steer(k), if k == 0 { 0.0 } else { plant.push(steer(k)) })).collect()
}

/// Adds white noise to the roll, `snr_db` below its mean square.
pub(crate) fn with_noise(clean: &[(f64, f64)], snr_db: f64, seed: u64) -> Vec<(f64, f64)> {
    let mean_square = clean.iter().map(|(_, y)| y * y).sum::<f64>() / clean.len() as f64;
    let sd = (mean_square * 10f64.powf(-snr_db / 10.0)).sqrt();
    let normal = Normal::new(0.0, sd).unwrap();
    let mut rng = StdRng::seed_from_u64(seed);
    clean.iter().map(|&(u, y)| (u, y + normal.sample(&mut rng))).collect()
}

/// The rows that the estimator makes of samples (input, roll angle) at equal intervals: the first one alone, then means over
/// 80 ms, of eight samples at most. The last samples wait for others.
pub(crate) fn means<T: Real>(data: &[(T, T)], interval_s: f64) -> Vec<Mean<T>> {
    let many = (1..8_usize).find(|&n| (n + 1) as f64 * interval_s > 0.0804).unwrap_or(8);
    let (first, rest) = data.split_first().unwrap();
    let mut rows = vec![Mean::single(first.0, first.1, T::zero(), true)];
    let mut middle = 0.0;
    rows.extend(rest.chunks_exact(many).enumerate().map(|(k, samples)| {
        let weight = T::of(many as f64);
        let mean =
            |value: &dyn Fn(usize) -> T| (0..many).fold(T::zero(), |a, i| a + value(i)) / weight;
        let place = (1 + k * many) as f64 + 0.5 * (many - 1) as f64;
        let between = place - std::mem::replace(&mut middle, place);
        let times_s: Vec<T> = (0..many).map(|i| T::of(i as f64 * interval_s)).collect();
        let time_s = mean(&|i| times_s[i]);
        let more = |i: usize| samples[i].1 - samples[0].1;
        let rise = mean(&more);
        let (time, roll) = (|i: usize| times_s[i] - time_s, |i: usize| more(i) - rise);
        Mean {
            input: mean(&|i| samples[i].0),
            roll_rad: samples[0].1 + rise,
            interval_s: T::of(between * interval_s),
            elapsed_s: T::of(many as f64 * interval_s),
            samples: many as u32,
            weight,
            is_used: true,
            scatter: [
                mean(&|i| roll(i) * roll(i)) * weight,
                mean(&|i| roll(i) * time(i)) * weight,
                mean(&|i| time(i) * time(i)) * weight,
            ],
        }
    }));
    rows
}

/// The height in inches that follows from a ratio (eqs. 5.17–5.20), and its standard deviation.
pub(crate) fn height_in(ratio: Measured<f64>) -> Measured<f64> {
    solve_height(&EQ_5_17, ratio, Measured::exact(COMPENSATION), 0.0).unwrap()
}

/// Units of each channel's input per radian of steer: 34 m/s² of lateral acceleration, and more of
/// the specific forces, which contain gravity.
pub(crate) const INPUT_PER_STEER: [f64; 4] = [1.0, 34.0, 44.0, 50.0];

/// A design with the steer and the lateral-acceleration channel.
pub(crate) fn design() -> Design<f64, 2> {
    design_with(PAIR)
}

/// A design with all channels.
pub(crate) fn full_design() -> Design<f64> {
    design_with(Channel::ALL)
}

/// A design in which every channel is eq. 5.12 times a factor, with the baseline's ratio line at
/// every speed and mass, in meters. Each ratio has a standard deviation of 1.3 %, any two a
/// correlation of one half.
pub(crate) fn design_with<const C: usize>(channels: [Channel; C]) -> Design<f64, C> {
    let steer_line = RatioLine { a0: 0.013_731, a1: 0.280_738, b0: 1.159_981, b1: -0.081_082 };
    let channel = |channel: Channel| {
        let gain = INPUT_PER_STEER[channel.index()];
        let scaled =
            |line: RatioLine<f64>| RatioLine { a0: line.a0 / gain, a1: line.a1 / gain, ..line };
        ChannelDesign {
            index: u32::try_from(channel.index()).unwrap(),
            models: [Reduced5 {
                numerator: EQ_5_12.numerator.map(|a| a / gain),
                denominator: EQ_5_12.denominator,
                speed_slope: [0.0; 5],
            }; MASSES],
            friction: [Friction::NONE; SPRING_MASSES],
            of_lines: [1.0; SPRING_MASSES],
            articulation: Articulation::NONE,
            lines: [[scaled(steer_line); MASSES]; SPEEDS],
            compensation: 1.489_6,
        }
    };
    let correlation = |i, j| if i == j { 1.0 } else { 0.5 };
    let covariance = from_fn(|i| from_fn(|j| correlation(i, j) * 0.013 * 0.013));
    let design = Design {
        speed_mps: [2.0, 5.0, 8.0, 11.0, 14.0, 18.0, 24.0, 30.0],
        trailer_mass_kg: [8e3, 15e3, 20e3, 25e3, 31e3, 40e3],
        channels: channels.map(channel),
        spread: [[Spread { covariance }; MASSES]; SPEEDS],
        nominal_speed_mps: 13.9,
        nominal_trailer_mass_kg: 31.3e3,
        reference_height_m: 1.973,
        least_height_m: 1.0,
        greatest_height_m: 3.0,
        trailer_wheelbase_m: 7.6,
        path_lead: PathLead::NONE,
        gravity_mps2: 9.81,
        rollover: RolloverDesign {
            half_track_m: 0.95,
            unsprung_mass_kg: 1.36e3,
            unsprung_height_m: 0.508,
            payload_beside_sd_m: 0.05,
            tightest_turn_g: 0.4,
        },
        thresholds: [ThresholdLine {
            threshold_g: [[0.6, 0.53, 0.47, 0.41, 0.36, 0.32, 0.29, 0.26]; 2],
        }; MASSES],
    };
    design.validate().unwrap();
    design
}

/// Converts to single precision.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn narrow(value: f64) -> f32 {
    value as f32
}
