use cg_core::{AlignSettings, CHANNELS, HeightError, Inconsistency, Sample};

use super::*;
use crate::estimate::options::EstimateOptions;
use crate::estimate::trial::{MASS_KG, SPEED_MPS, design, fit, log};
use crate::log::LogRow;

type Found = Result<Measured<f64>, Reject<f64>>;

const ABSENT: Found = Err(Reject::Absent);
const IMPRECISE: Found = Err(Reject::Imprecise { ratio_sd_relative: 0.5 });
const TOO_HIGH: Found = Err(Reject::Height(HeightError::OutOfRange { height_m: 5.0 }));

#[allow(clippy::unnecessary_wraps, reason = "it stands beside reasons why there is none")]
fn height(value: f64, sd: f64) -> Found {
    Ok(Measured { value, sd })
}

/// Options with which nothing has to be said about speed and mass.
fn quiet() -> EstimateOptions {
    EstimateOptions {
        speed_mps: Some(SPEED_MPS),
        trailer_mass_kg: Some(MASS_KG),
        ..EstimateOptions::default()
    }
}

fn only(channel: Channel) -> EstimateOptions {
    EstimateOptions { channel: Some(channel), ..quiet() }
}

/// A log of one maneuver with rows that can be used.
fn one(options: EstimateOptions, heights: [Found; 2]) -> LogEstimator {
    let mut log = log(options, &[heights]);
    log.rows = 1;
    log
}

/// Adds turns in which yaw rate times speed is the reverse of the lateral acceleration.
fn reverse_the_yaw_rate(log: &mut LogEstimator) {
    for k in 0..2000_u64 {
        let mut sample = Sample::absent(k * 10_000);
        sample.lateral_acceleration_mps2 = if k < 1000 { 1.0 } else { -1.0 };
        sample.speed_mps = 10.0;
        sample.yaw_rate_radps = -0.1 * sample.lateral_acceleration_mps2;
        log.sensors.push(&sample, &design());
    }
}

fn near(found: Option<f64>, expected: f64) {
    assert!(found.is_some_and(|found| (found - expected).abs() < 1e-9), "{found:?} {expected}");
}

#[test]
fn heights_that_agree_are_combined() {
    let mut log = one(quiet(), [height(2.0, 0.02), height(2.0, 0.02)]);
    log.maneuvers[0].outcomes[0].fit = Some(fit(Measured { value: 0.4, sd: 0.004 }, 25.0));
    let estimate = log.finish();
    assert_eq!(estimate.status, Verdict::Ok);
    assert_eq!(estimate.channel.as_deref(), Some("combined"));
    assert_eq!(estimate.messages, Vec::<String>::new());
    near(estimate.height_m, 2.0);
    near(estimate.height_sd_m, 0.02);
    near(estimate.height_random_sd_m, 0.02);
    let [low, high] = estimate.height_ci95_m.unwrap();
    near(Some(low), 2.0 - 1.959_964 * 0.02);
    near(Some(high), 2.0 + 1.959_964 * 0.02);
    // The compensation of 2 times 0.1 rad per meter.
    near(estimate.ratio, 0.4);
    near(estimate.ratio_sd, 0.004);
    near(estimate.speed_mps, SPEED_MPS);
    near(estimate.snr_db, 25.0);
    near(estimate.fit_percent, 90.0);
    near(estimate.static_rollover_threshold_g, 0.4);
    let channels: Vec<_> = estimate.channels.iter().map(|one| one.channel.as_str()).collect();
    assert_eq!(channels, ["steer", "lateral-acceleration"]);
    for one in &estimate.channels {
        assert_eq!((one.status, one.reason.as_deref()), (Verdict::Ok, None));
        near(one.height_m, 2.0);
        near(one.height_sd_m, 0.02);
    }
    assert_eq!(estimate.maneuvers.len(), 1);
}

/// A difference of 0.1 m is √50 joint standard deviations, one of 0.05 m √12.5.
#[test]
fn heights_that_differ_are_judged_by_their_uncertainty() {
    let both = |lateral_m| one(quiet(), [height(2.0, 0.01), height(lateral_m, 0.01)]).finish();
    let heights = "steer channel 2.000 ± 0.010 m, lateral-acceleration channel 2.";
    let apart = both(2.1);
    assert_eq!(apart.status, Verdict::Inconsistent);
    assert_eq!(apart.channel.as_deref(), Some("combined"));
    assert_eq!((apart.height_m, apart.speed_mps), (None, None));
    near(apart.channels[1].height_m, 2.1);
    let told = format!("inconsistent: {heights}100 ± 0.010 m: 7 standard deviations apart");
    assert_eq!(apart.messages, [told]);

    let doubtful = both(2.05);
    assert_eq!(doubtful.status, Verdict::Ok);
    assert!(doubtful.messages[0].starts_with(heights), "{:?}", doubtful.messages);
    assert!(doubtful.messages[0].ends_with("3.5 times as wide"), "{:?}", doubtful.messages);
    near(doubtful.height_sd_m, 0.01 * 12.5_f64.sqrt());
}

#[test]
fn one_channel_is_enough() {
    let estimate = one(quiet(), [height(2.0, 0.02), ABSENT]).finish();
    assert_eq!(estimate.status, Verdict::Ok);
    assert_eq!(estimate.channel.as_deref(), Some("steer"));
    assert_eq!(estimate.messages, Vec::<String>::new());
    let lateral = &estimate.channels[1];
    assert_eq!(lateral.status, Verdict::Rejected);
    assert_eq!(lateral.reason.as_deref(), Some("the signal is absent"));
    assert_eq!((lateral.height_m, lateral.height_sd_m), (None, None));
}

/// The channel that was left out, its likely cause, and then what the log lacks.
#[test]
fn the_most_important_messages_come_first() {
    let mut log = one(EstimateOptions::default(), [height(2.0, 0.02), TOO_HIGH]);
    for (k, ratio) in [0.4, -0.04].into_iter().enumerate() {
        let ratio = Measured { value: ratio, sd: 0.001 };
        log.maneuvers[0].outcomes[k].fit = Some(fit(ratio, 25.0));
    }
    let estimate = log.finish();
    assert_eq!(estimate.status, Verdict::Ok);
    let begins = [
        "lateral-acceleration channel left out: height 5.00 m",
        "likely cause: the lateral acceleration is reversed",
        "no speed in the log",
        "no trailer mass in the log",
    ];
    assert_eq!(estimate.messages.len(), begins.len(), "{:?}", estimate.messages);
    for (message, begin) in estimate.messages.iter().zip(begins) {
        assert!(message.starts_with(begin), "{message}");
    }
}

/// Without a remark there is no search for causes, whatever the ratios are.
#[test]
fn an_answer_without_a_remark_has_no_cause() {
    let mut log = one(quiet(), [height(2.0, 0.02), ABSENT]);
    log.maneuvers[0].outcomes[0].fit = Some(fit(Measured { value: -0.4, sd: 0.001 }, 25.0));
    assert_eq!(log.finish().messages, Vec::<String>::new());
}

#[test]
fn signals_that_contradict_each_other_give_no_combined_height() {
    let (good, close) = ([height(2.0, 0.02), height(2.0, 0.02)], height(2.05, 0.01));
    for heights in [good, [good[0], ABSENT], [height(2.0, 0.01), close]] {
        let mut log = one(quiet(), heights);
        reverse_the_yaw_rate(&mut log);
        let estimate = log.finish();
        assert_eq!(estimate.status, Verdict::Inconsistent);
        assert_eq!(estimate.height_m, None);
        let told = &estimate.messages[0];
        assert!(told.starts_with("inconsistent: the lateral acceleration is -1.00"), "{told}");
    }
}

#[test]
fn a_requested_channel_has_a_height_with_a_remark() {
    let mut log = one(only(Channel::Steer), [height(2.0, 0.02), height(2.5, 0.02)]);
    reverse_the_yaw_rate(&mut log);
    let estimate = log.finish();
    assert_eq!(estimate.status, Verdict::Ok);
    assert_eq!(estimate.channel.as_deref(), Some("steer"));
    near(estimate.height_m, 2.0);
    assert_eq!(estimate.messages.len(), 1);
    assert!(estimate.messages[0].starts_with("the lateral acceleration is -1.00 times"));
    let channels: Vec<_> = estimate.channels.iter().map(|one| one.channel.as_str()).collect();
    assert_eq!(channels, ["steer"]);
    let other = one(only(Channel::LateralAcceleration), [height(2.0, 0.02), height(2.5, 0.02)]);
    let other = other.finish();
    near(other.height_m, 2.5);
    near(other.ratio, 2.0 * 0.01 * 2.5);
    assert_eq!(other.channels[0].channel, "lateral-acceleration");
    assert_eq!(other.channels.len(), 1);
}

#[test]
fn without_a_height_the_remark_stands_before_the_reason() {
    let mut log = one(quiet(), [ABSENT, IMPRECISE]);
    reverse_the_yaw_rate(&mut log);
    let estimate = log.finish();
    assert_eq!((estimate.status, estimate.channel.as_deref()), (Verdict::Rejected, None));
    assert_eq!(estimate.messages.len(), 2, "{:?}", estimate.messages);
    assert!(estimate.messages[0].starts_with("the lateral acceleration is -1.00 times"));
    assert_eq!(estimate.messages[1], "rejected: the ratio is uncertain by 50 %");
}

#[test]
fn the_reason_comes_from_a_channel_whose_signal_is_present() {
    let design = design();
    let range = format!("{:.2} to {:.2} m", design.least_height_m, design.greatest_height_m);
    let too_high = format!(
        "height 5.00 m is outside the physical range ({range} by [height] in the vehicle file)"
    );
    for (heights, reason) in [
        ([ABSENT, IMPRECISE], "the ratio is uncertain by 50 %"),
        ([IMPRECISE, ABSENT], "the ratio is uncertain by 50 %"),
        ([IMPRECISE, TOO_HIGH], too_high.as_str()),
        ([ABSENT, ABSENT], "the signal is absent"),
    ] {
        let estimate = one(quiet(), heights).finish();
        assert_eq!(estimate.status, Verdict::Rejected);
        assert_eq!(estimate.messages, [format!("rejected: {reason}")]);
        assert_eq!(estimate.maneuvers[0].reason.as_deref(), Some(reason));
    }
    let mut empty = log(quiet(), &[]);
    empty.rows = 1;
    let estimate = empty.finish();
    assert!(estimate.messages[0].starts_with("rejected: unexcited"), "{:?}", estimate.messages);
    assert_eq!(estimate.channels[0].reason.as_deref(), Some("no maneuver"));
}

/// An empty trailer hardly rolls beside what the nominal load would.
#[test]
fn a_roll_angle_that_stands_still_may_be_that_of_a_lighter_trailer() {
    let still = Err(Reject::Inconsistent(Inconsistency::Standstill { roll_rad: 0.005 }));
    for (trailer_mass_kg, is_told) in [(None, true), (Some(20_000.0), false)] {
        let options = EstimateOptions { trailer_mass_kg, ..quiet() };
        let told = one(options, [still, ABSENT]).finish().messages;
        let lighter = |message: &String| message.contains("; or the trailer is much lighter than ");
        assert_eq!(told.iter().any(lighter), is_told, "{told:?}");
    }
}

#[test]
fn the_reason_is_that_of_the_last_maneuver_without_a_height() {
    let good = height(2.0, 0.02);
    let log = log(quiet(), &[[TOO_HIGH, ABSENT], [IMPRECISE, good], [good, good]]);
    assert_eq!(log.last_reject(Channel::Steer), IMPRECISE.err());
    assert_eq!(log.last_reject(Channel::LateralAcceleration), Some(Reject::Absent));
}

/// Signal-to-noise ratio and fit are those of the maneuver with the least noise.
#[test]
fn the_best_maneuver_has_the_least_noise() {
    let noisy = [height(2.0, 0.05), ABSENT];
    let mut log = log(quiet(), &[noisy, [height(2.0, 0.02), ABSENT], noisy, [ABSENT, ABSENT]]);
    for (maneuver, snr_db) in log.maneuvers.iter_mut().zip([10.0, 20.0, 30.0, 40.0]) {
        maneuver.outcomes[0].fit = Some(fit(Measured { value: 0.4, sd: 0.004 }, snr_db));
    }
    near(log.finish().snr_db, 20.0);
}

#[test]
fn the_speed_is_the_mean_of_the_maneuvers_with_a_height() {
    let good = height(2.0, 0.02);
    let mut log = log(quiet(), &[[good, ABSENT], [good, good], [ABSENT, good], [ABSENT, ABSENT]]);
    for (maneuver, speed_mps) in log.maneuvers.iter_mut().zip([10.0, 14.0, 24.0, 5.0]) {
        maneuver.speed_mps = speed_mps;
    }
    near(log.mean_speed_mps(&[Channel::Steer]), 12.0);
    near(log.mean_speed_mps(&[Channel::LateralAcceleration]), 19.0);
    near(log.mean_speed_mps(&Channel::ALL), 16.0);
    assert_eq!(one(quiet(), [ABSENT, ABSENT]).mean_speed_mps(&Channel::ALL), None);
}

#[test]
fn ratios_are_given_although_the_heights_contradict_each_other() {
    let identified = one(quiet(), [height(2.0, 0.01), height(2.1, 0.01)]).identified();
    let [steer, lateral, ..] = identified.ratio.map(|ratio| ratio.unwrap_or(Measured::exact(0.0)));
    near(Some(steer.value), 2.0 * 0.1 * 2.0);
    near(Some(steer.sd), 2.0 * 0.1 * 0.01);
    near(Some(lateral.value), 2.0 * 0.01 * 2.1);
    near(Some(identified.speed_mps), SPEED_MPS);
    assert_eq!(identified.messages.len(), 1, "{:?}", identified.messages);
    assert!(identified.messages[0].starts_with("inconsistent: steer channel 2.000"));
}

#[test]
fn of_a_channel_without_a_ratio_the_reason_is_given() {
    let mut log = one(quiet(), [height(2.0, 0.01), IMPRECISE]);
    log.absent_rows = 2; // any message of the log
    let identified = log.identified();
    assert!(identified.ratio[0].is_some() && identified.ratio[1].is_none());
    let [rows, reason] = &identified.messages[..] else { panic!("{:?}", identified.messages) };
    assert!(rows.starts_with("2 of 1 rows"), "{rows}");
    assert_eq!(reason, "lateral-acceleration channel: rejected: the ratio is uncertain by 50 %");
}

/// Without a height in any channel the contradiction of the signals is not the point.
#[test]
fn ratios_of_a_rejected_log_have_no_remark() {
    let mut log = one(quiet(), [ABSENT, IMPRECISE]);
    reverse_the_yaw_rate(&mut log);
    let identified = log.identified();
    assert_eq!(identified.ratio, [None; CHANNELS]);
    assert!(identified.speed_mps.is_nan());
    assert_eq!(identified.messages.len(), 2, "{:?}", identified.messages);
    assert!(identified.messages[0].starts_with("steer channel: rejected"));
    assert!(identified.messages[1].starts_with("lateral-acceleration channel: rejected"));
}

/// Channels that have no height for the same reason share its sentence.
#[test]
fn a_reason_of_several_channels_is_told_once() {
    let messages = one(quiet(), [IMPRECISE, IMPRECISE]).identified().messages;
    let expected = "steer, lateral-acceleration channels: rejected: the ratio is uncertain by 50 %";
    assert_eq!(messages, [expected]);
}

#[test]
fn a_mass_from_the_log_or_the_options_is_known() {
    let known = |options, seen: bool| {
        let mut log = one(options, [ABSENT, ABSENT]);
        if seen {
            log.seen.mass_kg = Some(MASS_KG);
            log.seen.weighed.weigh(0, [MASS_KG; 2], 15.0);
        }
        log.identified().trailer_mass_is_known
    };
    assert!(!known(EstimateOptions::default(), false));
    assert!(known(EstimateOptions::default(), true));
    assert!(known(quiet(), false));
}

/// What is said of the speed.
fn of_speed(log: &LogEstimator) -> Vec<String> {
    log.turns_messages().into_iter().filter(|text| text.contains("speed")).collect()
}

/// 100 s, of which the first ten have a speed, which holds for 2.5 s more: 874 rows of 1000 have none.
#[test]
fn rows_whose_speed_is_too_old_are_told() {
    let rows = |steer_rad: f64, speed_s: f64| {
        let mut log =
            LogEstimator::from_design(&design(), AlignSettings::NONE, EstimateOptions::default());
        for k in 0..1000 {
            let time_s = 0.1 * f64::from(k);
            let speed_mps = if time_s < speed_s { SPEED_MPS } else { f64::NAN };
            let row = LogRow { time_s, steer_rad, roll_rad: 0.01, speed_mps, ..LogRow::ABSENT };
            log.push(&row).unwrap();
        }
        log.end();
        log
    };
    let log = rows(0.01, 10.05);
    assert_eq!(log.absent_rows, 874);
    let told = of_speed(&log);
    let begin =
        "874 of 1000 rows, the first at 13 s, have no speed, nor have the 2500 ms before them: ";
    assert!(told.len() == 1 && told[0].starts_with(begin), "{told:?}");
    assert_eq!(of_speed(&rows(0.01, 200.0)), Vec::<String>::new());
    // On a bus a steer angle without a speed is absent.
    let told = of_speed(&rows(f64::NAN, -1.0));
    assert!(
        told.len() == 1 && told[0].contains("is only used with a speed on the bus"),
        "{told:?}"
    );
    let told = of_speed(&rows(0.01, -1.0));
    assert!(told.len() == 1 && told[0].contains("from the vehicle file is used"), "{told:?}");
}

/// The second of two turns has a speed.
#[test]
fn turns_before_the_first_speed_are_told() {
    let mut log = log(EstimateOptions::default(), &[[height(2.0, 0.02), ABSENT]; 2]);
    let first_us = log.maneuvers[0].end_us;
    log.maneuvers[1].end_us += 50_000_000;
    log.rows = 1;
    for (since_us, is_told) in [(first_us, false), (first_us + 1, true)] {
        log.seen.speed_since_us = Some(since_us);
        let told = of_speed(&log);
        assert_eq!(
            told.iter().any(|text| text.contains("in turns before it")),
            is_told,
            "{told:?}"
        );
    }
    log.options.speed_mps = Some(SPEED_MPS);
    assert_eq!(of_speed(&log), Vec::<String>::new());
}
