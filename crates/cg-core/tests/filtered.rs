//! Tests of [`FilteredArx`]: drift, bend, misfit, weight of rows, and data without an answer.

#![allow(clippy::unwrap_used, clippy::panic, clippy::cast_precision_loss)] // helpers of tests

use crate::common::{EQ_5_12, means, rounded_step_response};
use cg_core::identify::mean::Mean;
use cg_core::math::linalg::Triangle;
use cg_core::truck::filters::{StateVariableFilter, StepMatrices};
use cg_core::truck::simulation::Simulation;
use cg_core::{Answer, FilteredArx, Fit, Identify, Prior, Unexcited};
use rand::{Rng, SeedableRng, rngs::StdRng};
use rand_distr::StandardNormal;

const INTERVAL_S: f64 = 0.01;

/// Only the gain is free, and the noise floor is the last digit of a sensor, more than [`BETWEEN_MEANS`] of
/// the roll angle.
const GAIN_ALONE: Prior<f64> =
    Prior { dynamics_sd: 0.0, noise_floor_rad: 8e-5, offset_sd_rad: 0.0, drift_sd_radps: 0.0 };

fn pushed(prior: Prior<f64>, data: &[(f64, f64)]) -> FilteredArx<f64> {
    let mut identifier = FilteredArx::new(&EQ_5_12, prior);
    for mean in means(data, INTERVAL_S) {
        identifier.push_mean(&mean);
    }
    identifier
}

fn ready(answer: Answer<f64>) -> Fit<f64> {
    let Answer::Ready(fit) = answer else { panic!("{answer:?}") };
    fit
}

/// A half cosine of 4 s into a turn, then a steady roll angle of 0.042 rad. It is so slow that no
/// part of it is mistaken for noise of the input.
fn drive(rows: u32) -> Vec<(f64, f64)> {
    let steer = |k: u32| {
        let share = (f64::from(k) * INTERVAL_S / 4.0).min(1.0);
        0.025 * (1.0 - (core::f64::consts::PI * share).cos())
    };
    let mut plant = Simulation::new(&EQ_5_12, INTERVAL_S, 0.0);
    (0..rows).map(|k| (steer(k), if k == 0 { 0.0 } else { plant.push(steer(k)) })).collect()
}

/// Ten seconds of [`drive`].
fn step() -> Vec<(f64, f64)> {
    drive(1000)
}

/// The data of [`step`] with the roll angle replaced by a function of time and roll angle.
fn bent(law: impl Fn(f64, f64) -> f64) -> Vec<(f64, f64)> {
    let time_s = (0..).map(|k| f64::from(k) * INTERVAL_S);
    step().into_iter().zip(time_s).map(|((u, y), t)| (u, law(t, y))).collect()
}

/// A line between means over τ = 80 ms misses a signal of ω = π/4 rad/s, the half cosine of [`drive`], by
/// `(ω τ)²/12` of it.
const BETWEEN_MEANS: f64 = 3.3e-4;

/// Number of samples in a mean, which the estimator makes at 100 Hz.
const TOGETHER: usize = 8;

/// The sum of the squares of the roll angle in means of samples.
fn squares(rows: &[(f64, f64)]) -> f64 {
    let sums = rows.chunks_exact(TOGETHER).map(|mean| mean.iter().map(|(_, y)| y).sum::<f64>());
    sums.map(|sum| sum.powi(2) / TOGETHER as f64).sum()
}

/// Standard deviation √(Σ (y − ȳ)²/n).
fn spread(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let n = values.clone().map(|_| 1.0).sum::<f64>();
    let mean = values.clone().sum::<f64>() / n;
    (values.map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt()
}

#[test]
fn a_gain_alone_scales_the_whole_response() {
    let mut identifier = pushed(GAIN_ALONE, &bent(|_, y| 1.2 * y));
    let fit = ready(identifier.fit());
    assert!((fit.ratio.value / EQ_5_12.dc_gain() - 1.2).abs() < 1.2 * BETWEEN_MEANS);
    // The first sample, and 124 means of eight. The last seven wait for others.
    assert_eq!((fit.rows, fit.misfit, fit.drift_radps.value), (993, 0.0, 0.0));
    // The standard deviation follows from the noise floor and the response's sum of squares, and from 0.3 % of the motion, which
    // hardly counts where nothing is extrapolated.
    let motion = 993.0 * spread(step().iter().map(|(_, y)| *y)).powi(2);
    let factor = motion / squares(&step()[1..]);
    let model = (0.003 * 1.2_f64).powi(2) * motion * factor.powi(2) / (factor.powi(2) + 1e4);
    let sd = (8e-5_f64.powi(2) + model).sqrt() * EQ_5_12.dc_gain() / squares(&step()[1..]).sqrt();
    assert!((fit.ratio.sd / sd - 1.0).abs() < BETWEEN_MEANS, "{} {sd}", fit.ratio.sd);
    assert!((fit.noise_sd_rad - 8e-5).abs() < 1e-18);
    let model = identifier.model().unwrap();
    for (found, known) in model.numerator.iter().zip(EQ_5_12.numerator) {
        assert!((found - 1.2 * known).abs() < 1.2 * BETWEEN_MEANS * known.abs());
    }
    for (found, known) in model.denominator.iter().zip(EQ_5_12.denominator) {
        assert!((found - known).abs() < 1e-9 * known);
    }
}

/// The roll angle of a truck whose input leads the one that is given, by half a second.
#[test]
fn the_lead_of_the_input_is_in_the_model() {
    const LEAD_S: f64 = 0.5;
    let data = step();
    let led: Vec<(f64, f64)> = data
        .windows(3)
        .map(|three| {
            let rising = (three[2].1 - three[0].1) / (2.0 * INTERVAL_S);
            (three[1].0, three[1].1 + LEAD_S * rising)
        })
        .collect();
    let with = |lead_s: f64| {
        let mut identifier = FilteredArx::new(&EQ_5_12, GAIN_ALONE);
        for mean in means(&led, INTERVAL_S) {
            identifier.at_speed(0.0, lead_s);
            identifier.push_mean(&mean);
        }
        ready(identifier.fit())
    };
    let known = with(LEAD_S);
    assert!((known.ratio.value / EQ_5_12.dc_gain() - 1.0).abs() < 3.0 * BETWEEN_MEANS);
    // The angle comes earlier by as much as it grows in half a second: a gain of 4 % more and a residual of 7 % of the angle. The lead
    // without its sixth derivative leaves less than a tenth of that, at the end of the half cosine.
    let unknown = with(0.0);
    assert!(unknown.ratio.value / EQ_5_12.dc_gain() > 1.03 && unknown.noise_sd_rad > 2e-3);
    assert!(known.noise_sd_rad < 0.1 * unknown.noise_sd_rad, "{known:?} {unknown:?}");
}

#[test]
fn the_excitation_is_what_the_input_moves() {
    let data = step();
    let identifier = pushed(GAIN_ALONE, &data);
    let means = data[1..].chunks_exact(TOGETHER);
    let means = means.map(|mean| mean.iter().map(|(u, _)| u).sum::<f64>() / TOGETHER as f64);
    // All but the first sample have the weight of eight.
    let inputs = spread(means.flat_map(|mean| [mean; TOGETHER]).chain([data[0].0]));
    assert!((identifier.excitation_rad() / (inputs * EQ_5_12.dc_gain()) - 1.0).abs() < 1e-9);
    let roll = data[985..993].iter().map(|(_, y)| y).sum::<f64>() / TOGETHER as f64;
    assert!((identifier.expected_roll_rad() / roll - 1.0).abs() < BETWEEN_MEANS);
}

#[test]
fn without_rows_or_without_motion_there_is_no_answer() {
    let few = |rows: usize| match pushed(GAIN_ALONE, &step()[..rows]).fit() {
        Answer::Unexcited(Unexcited::TooFewRows { rows }) => Some(rows),
        _ => None,
    };
    // The first sample, and means of eight.
    assert_eq!((few(16), few(17), few(25)), (Some(9), None, None));
    let still = vec![(0.01, 0.01); 500];
    assert_eq!(pushed(GAIN_ALONE, &still).fit(), Answer::Unexcited(Unexcited::Input));
    let mut cleared = pushed(GAIN_ALONE, &step());
    cleared.clear();
    assert_eq!(cleared.fit(), Answer::Unexcited(Unexcited::TooFewRows { rows: 0 }));
}

/// The prior is a free offset and a drift within 3e-4 rad/s. With a floor of 2e-5 rad the prior
/// hardly affects the drift.
#[test]
fn a_drift_is_told_from_the_turn() {
    let prior = Prior {
        offset_sd_rad: f64::INFINITY,
        drift_sd_radps: 3e-4,
        noise_floor_rad: 2e-5,
        ..GAIN_ALONE
    };
    // What the means miss of 0.042 rad in ten seconds.
    let drift = BETWEEN_MEANS * 0.042 / 10.0;
    let mut identifier = pushed(prior, &bent(|t, y| y + 0.3 + 2e-4 * t));
    let fit = ready(identifier.fit());
    assert!((fit.drift_radps.value - 2e-4).abs() < drift, "{:?}", fit.drift_radps);
    assert!(fit.drift_radps.sd > 2e-8 && fit.drift_radps.sd < 2e-6);
    assert!((fit.ratio.value / EQ_5_12.dc_gain() - 1.0).abs() < BETWEEN_MEANS);
    // Forgetting restarts the time of the drift but does not change its rate.
    identifier.forget(0.5);
    let later = ready(identifier.fit());
    assert!((later.drift_radps.value - 2e-4).abs() < drift);
    assert!((later.ratio.value / EQ_5_12.dc_gain() - 1.0).abs() < BETWEEN_MEANS);
    // Without an unknown for it, the drift changes the gain.
    let held = Prior { drift_sd_radps: 0.0, ..prior };
    let fit = ready(pushed(held, &bent(|t, y| y + 0.3 + 2e-4 * t)).fit());
    assert!(fit.drift_radps.value == 0.0);
    assert!((fit.ratio.value / EQ_5_12.dc_gain() - 1.0).abs() > 1e-3);
}

/// y − β y³: the cubic part at the greatest angle g is −β g², relative to the gain that is fitted
/// without it.
#[test]
fn a_bend_is_measured_at_the_greatest_angle() {
    let greatest = step().iter().map(|(_, y)| y.abs()).fold(0.0, f64::max);
    for bend in [-0.2, 0.2] {
        for sign in [1.0, -1.0] {
            let mut data = bent(|_, y| sign * (y + bend * y * (y / greatest).powi(2)));
            for (u, _) in &mut data {
                *u *= sign;
            }
            let fit = ready(pushed(GAIN_ALONE, &data).fit());
            let gain = fit.ratio.value / EQ_5_12.dc_gain();
            assert!(
                (fit.bend.value - bend / gain).abs() < BETWEEN_MEANS,
                "{:?} {}",
                fit.bend,
                bend / gain
            );
            assert!(fit.bend.sd > 0.0 && fit.bend.sd < 0.1);
        }
    }
    let fit = ready(pushed(GAIN_ALONE, &step()).fit());
    assert!(fit.bend.value.abs() < BETWEEN_MEANS, "{:?}", fit.bend);
}

/// With a roll angle that is late by a second the dynamics adapt, and this adaptation is the
/// misfit.
#[test]
fn a_late_roll_angle_does_not_fit_the_model() {
    let data = rounded_step_response(1000, INTERVAL_S, 3.0);
    let late: Vec<_> =
        (0..1000).map(|k: usize| (data[k].0, data[k.saturating_sub(100)].1)).collect();
    let prior = Prior { dynamics_sd: 0.2, noise_floor_rad: 2e-4, ..GAIN_ALONE };
    let fit = ready(pushed(prior, &late).fit());
    // Calculated by hand: the part of the late roll angle that the nominal response with the best
    // gain does not explain, divided by the standard deviation of the roll angle.
    let (mut yy, mut yr) = (0.0, 0.0);
    for ((_, shown), (_, nominal)) in late.iter().zip(&data) {
        yy += nominal * nominal;
        yr += nominal * shown;
    }
    let left: f64 =
        late.iter().zip(&data).map(|((_, y), (_, g))| (y - yr / yy * g).powi(2)).sum::<f64>() / 1e3;
    let most = left.sqrt() / spread(late.iter().map(|(_, y)| *y));
    assert!(fit.misfit > 0.35 && fit.misfit < most * 1.001, "{} {most}", fit.misfit);
    assert!(ready(pushed(prior, &data).fit()).misfit < 0.02);
}

/// Forgetting halves the weight of the earlier rows, as if their squares were half as large.
#[test]
fn forgetting_halves_the_weight_of_what_was() {
    let data = drive(1401);
    let (first, more) = data.split_at(1001);
    let mut identifier = pushed(GAIN_ALONE, first);
    identifier.forget(0.5);
    let more: Vec<_> = more.iter().map(|&(u, y)| (u, 1.1 * y)).collect();
    let both: Vec<_> = first.iter().chain(&more).copied().collect();
    for mean in &means(&both, INTERVAL_S)[126..] {
        identifier.push_mean(mean);
    }
    let (before, after) = (0.5 * squares(&first[1..]), squares(&data[1001..]));
    let gain = (before + 1.1 * after) / (before + after);
    let fit = ready(identifier.fit());
    assert!((fit.ratio.value / EQ_5_12.dc_gain() - gain).abs() < BETWEEN_MEANS, "{gain}");
    assert_eq!(fit.rows, 1401);
}

/// A row that is not used changes the states of the filters but not the result.
#[test]
fn rows_that_do_not_count_only_move_the_filters() {
    let mut identifier = FilteredArx::new(&EQ_5_12, GAIN_ALONE);
    let data: Vec<_> =
        (0..).zip(step()).map(|(k, (u, y))| (u, if k > 300 { y } else { 9.0 })).collect();
    for (k, mean) in means(&data, INTERVAL_S).into_iter().enumerate() {
        identifier.push_mean(&Mean { is_used: k > 38, ..mean });
    }
    let fit = ready(identifier.fit());
    assert_eq!(fit.rows, 688);
    assert!((fit.ratio.value / EQ_5_12.dc_gain() - 1.0).abs() < BETWEEN_MEANS);
}

/// The estimator's inputs are expected roll angles, so the model is scaled to unit gain.
#[test]
fn made_for_a_model_the_ratio_is_one() {
    let mut identifier = <FilteredArx<_>>::for_model(&EQ_5_12, GAIN_ALONE);
    for mean in means(&step(), INTERVAL_S) {
        identifier.push_mean(&Mean { input: mean.input * EQ_5_12.dc_gain(), ..mean });
    }
    assert!((ready(identifier.fit()).ratio.value - 1.0).abs() < BETWEEN_MEANS);
}

/// Time stamps with jitter: linear interpolation between samples is exact for any interval.
#[test]
fn intervals_may_change_from_row_to_row() {
    let mut identifier = FilteredArx::new(&EQ_5_12, GAIN_ALONE);
    let data = step();
    let mut last = 0;
    for k in (0..1000).filter(|k| k % 3 != 1) {
        let (u, y) = data[k];
        identifier.push(u, y, f64::from(u32::try_from(k - last).unwrap()) * INTERVAL_S, true);
        last = k;
    }
    // A line between two samples of a rounded step is in error by (2h)² ü/8: 4e-5 of it at 3 rad/s.
    assert!((ready(identifier.fit()).ratio.value / EQ_5_12.dc_gain() - 1.0).abs() < 1e-4);
}

/// The mounting of the sensor is not known, so its offset is free. Its drift is a degree per
/// minute.
#[test]
fn the_standard_prior_leaves_the_offset_free() {
    let prior = Prior::<f64>::standard();
    assert!(prior.offset_sd_rad.is_infinite() && prior.offset_sd_rad > 0.0);
    assert!((prior.drift_sd_radps * 60.0 / 1.0_f64.to_radians() - 1.0).abs() < 0.05);
    let plain = ready(pushed(prior, &step()).fit()).ratio;
    let offset = ready(pushed(prior, &bent(|_, y| y + 0.3)).fit()).ratio;
    // Only rounding of numbers near 0.3.
    assert!((plain.value - offset.value).abs() < 1e-9 && plain.sd > 0.0);
}

/// Standard deviation of the ratio's logarithm for noise of 1e-3 rad, from rows of the identifier that are
/// made of the means of so many samples `together`, and its prior of 20 % on the dynamics.
fn log_ratio_sd(input: &[f64], interval_s: f64, together: u8) -> f64 {
    const NOISE_RAD: f64 = 1e-3;
    let count = f64::from(together);
    let scale = EQ_5_12.time_scale_radps();
    let model = EQ_5_12.in_scaled_time(scale);
    let step = StepMatrices::new(&model, count * interval_s * scale);
    let mut plant = Simulation::new(&EQ_5_12, interval_s, 0.0);
    let [mut u, mut y] = [0.0; 2].map(|rest| StateVariableFilter::at_rest(&model, rest));
    let mut triangle = Triangle::<f64, 13>::new();
    for (k, inputs) in input.chunks_exact(together.into()).enumerate() {
        let roll: f64 = inputs.iter().map(|&input| plant.push(input)).sum();
        u.push(&step, inputs.iter().sum::<f64>() / count);
        y.push(&step, roll / count);
        let (u, y) = (u.derivatives(&model), y.derivatives(&model));
        let mut row = [0.0; 13];
        for k in 0..5 {
            (row[k], row[6 + k]) = (-y[k], u[k + 1]);
        }
        let time_s = f64::from(u32::try_from(k).unwrap()) * count * interval_s;
        (row[5], row[11], row[12]) = (model.response(&u), 1.0, time_s / 10.0);
        triangle.push(row.map(|x| x * count.sqrt()), 0.0);
    }
    for k in (0..11).filter(|&k| k != 5) {
        let size =
            if k < 5 { model.denominator[k] } else { model.numerator[k - 5].abs().max(0.17) };
        let mut row = [0.0; 13];
        row[k] = NOISE_RAD / (0.2 * size);
        triangle.push(row, 0.0);
    }
    // The ratio is A0 (1 + γ)/(B0 + δb0), with B0 = 1 in scaled time.
    let mut gradient = [0.0; 13];
    (gradient[0], gradient[5]) = (-1.0, 1.0);
    NOISE_RAD * triangle.variance_of(&gradient, 13).sqrt()
}

/// What means of neighboring samples lose: less than a hundredth of the standard deviation, in slow
/// turns and in the fastest maneuver of the thesis, a lane change of three seconds.
#[test]
fn means_of_neighbors_lose_nearly_no_information() {
    let slow = |t: f64| 0.025 * (1.0 - (core::f64::consts::PI * (t / 4.0).min(1.0)).cos());
    let step = |t: f64| 0.05 / (1.0 + (-5.0 * (t - 1.0)).exp());
    let lane = |t: f64| if t < 3.0 { 0.05 * (core::f64::consts::TAU * t / 3.0).sin() } else { 0.0 };
    for (name, steer) in
        [("turn", &slow as &dyn Fn(f64) -> f64), ("step", &step), ("lane change", &lane)]
    {
        for (rate_hz, together) in
            [(50, 2), (50, 3), (50, 4), (100, 4), (100, 6), (100, 8), (200, 8)]
        {
            let interval_s = 1.0 / f64::from(rate_hz);
            let input: Vec<f64> =
                (0..12 * rate_hz).map(|k| steer(f64::from(k) * interval_s)).collect();
            let loss = log_ratio_sd(&input, interval_s, together)
                / log_ratio_sd(&input, interval_s, 1)
                - 1.0;
            println!("{name} at {rate_hz} Hz: {:.3} % of the standard deviation", 100.0 * loss);
            assert!(loss.abs() < 0.01, "{name} {rate_hz}: {loss}");
        }
    }
}

/// White noise of the input that has a twelfth of the response's variance makes a gain look smaller by as much. It is
/// corrected as the true gain passes it, also where that is far from the model's.
#[test]
fn noise_of_the_input_moves_no_gain() {
    const DRAWS: u32 = 200;
    const NOISE: f64 = 0.04;
    let prior = Prior { noise_floor_rad: 2e-4, ..GAIN_ALONE };
    let input = |k: u32| 0.05 * (1.2 * f64::from(k) * INTERVAL_S).sin();
    let mut random = StdRng::seed_from_u64(7);
    for gain in [0.6, 1.0, 1.6] {
        let [mut sum, mut squares] = [0.0; 2];
        for _ in 0..DRAWS {
            let mut plant = Simulation::new(&EQ_5_12, INTERVAL_S, 0.0);
            let data: Vec<(f64, f64)> = (0..3000)
                .map(|k| {
                    let noise: f64 = random.sample(StandardNormal);
                    // The filters begin at rest at the first input.
                    let noise = if k == 0 { 0.0 } else { NOISE * noise };
                    (input(k) + noise, gain * plant.push(input(k)))
                })
                .collect();
            let ratio = ready(pushed(prior, &data).fit()).ratio;
            let error = ratio.value / (gain * EQ_5_12.dc_gain()) - 1.0;
            sum += error;
            squares += error * error;
        }
        let draws = f64::from(DRAWS);
        let mean = sum / draws;
        let sd = (squares / draws - mean * mean).sqrt();
        println!("gain {gain}: {:.3} % in the mean of {:.3} %", 100.0 * mean, 100.0 * sd);
        assert!(mean.abs() < 3.0 * sd / draws.sqrt(), "{gain}: {mean}");
    }
}
