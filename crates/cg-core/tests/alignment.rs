//! Tests of the aligner: how long values are held, interpolated and waited for, and when another
//! device is used.

#![allow(clippy::unwrap_used, clippy::float_cmp)] // values that are passed on are unchanged

use cg_core::signal::align::Taken;
use cg_core::{AlignSettings, Aligner, Quantity};

const ROLL_SENSOR: (u32, u8) = (0xE4, 0);
const BRAKES: (u32, u8) = (0x0B, 0);

fn aligner() -> Aligner<f64> {
    Aligner::new(AlignSettings::NONE)
}

fn lateral(aligner: &mut Aligner<f64>, us: u64, value: f64) -> Taken {
    aligner.push(Quantity::LateralAcceleration, BRAKES, us, value)
}

/// The lateral acceleration of a sample at a time, after all waiting times have passed.
fn at(aligner: &mut Aligner<f64>, us: u64) -> f64 {
    aligner.push(Quantity::Roll, ROLL_SENSOR, us, 0.0);
    aligner.next(us + 200_000).unwrap().lateral_acceleration_mps2
}

#[test]
fn a_value_is_held_for_half_a_second_either_way() {
    for (us, there) in [(1_500_000, true), (1_500_001, false), (500_000, true), (499_999, false)] {
        let mut aligner = aligner();
        lateral(&mut aligner, 1_000_000, 1.5);
        assert_eq!(at(&mut aligner, us) == 1.5, there, "{us}");
    }
}

#[test]
fn a_line_bridges_half_a_second_and_no_more() {
    for (gap_us, expected) in [(400_000, 1.25), (500_000, 1.2), (500_001, 2.0)] {
        let mut aligner = aligner();
        lateral(&mut aligner, 1_000_000, 1.0);
        lateral(&mut aligner, 1_000_000 + gap_us, 2.0);
        let found = at(&mut aligner, 1_100_000);
        assert!((found - expected).abs() < 1e-12, "{gap_us}: {found}");
    }
    // Before both values, the first value of the line is held.
    let mut aligner = aligner();
    lateral(&mut aligner, 1_000_000, 1.0);
    lateral(&mut aligner, 1_100_000, 2.0);
    assert_eq!(at(&mut aligner, 1_100_000), 2.0);
}

#[test]
fn a_roll_angle_waits_for_0_12_seconds() {
    let mut aligner = aligner();
    lateral(&mut aligner, 1_000_000, 1.0);
    aligner.push(Quantity::Roll, ROLL_SENSOR, 1_010_000, 0.0);
    assert!(aligner.next(1_129_999).is_none());
    assert_eq!(aligner.next(1_130_000).unwrap().time_us, 1_010_000);
    // A value at the time of the roll angle itself needs no waiting.
    lateral(&mut aligner, 1_200_000, 1.0);
    aligner.push(Quantity::Roll, ROLL_SENSOR, 1_200_000, 0.0);
    assert!(aligner.next(1_200_000).is_some());
}

#[test]
fn every_input_is_waited_for() {
    let awaited = |quantity: &Quantity| {
        !matches!(quantity, Quantity::Roll | Quantity::Speed) && quantity.serves_us() < u64::MAX
    };
    assert_eq!(Quantity::ALL.into_iter().filter(awaited).count(), Quantity::COUNT - 7);
    for quantity in Quantity::ALL.into_iter().filter(awaited) {
        let mut aligner = aligner();
        aligner.push(quantity, BRAKES, 1000, 0.1);
        while aligner.next(1000).is_some() {} // as long as it is the only roll angle
        aligner.push(Quantity::Roll, ROLL_SENSOR, 2000, 0.0);
        assert!(aligner.next(2000).is_none(), "{quantity:?}");
    }
    let mut aligner = aligner();
    aligner.push(Quantity::Speed, BRAKES, 1000, 10.0);
    aligner.push(Quantity::Roll, ROLL_SENSOR, 2000, 0.0);
    assert!(aligner.next(2000).is_some());
}

#[test]
fn speed_is_held_for_two_and_a_half_seconds_and_a_mass_for_ever() {
    for (us, there) in [(2_500_000, true), (2_500_001, false)] {
        let mut aligner = aligner();
        aligner.push(Quantity::Speed, BRAKES, 0, 12.0);
        aligner.push(Quantity::TrailerMass, BRAKES, 0, 20e3);
        aligner.push(Quantity::YawRate, BRAKES, us, 0.1);
        aligner.push(Quantity::Roll, ROLL_SENSOR, us, 0.0);
        let sample = aligner.next(us).unwrap();
        assert_eq!((sample.speed_mps == 12.0, sample.yaw_rate_radps == 0.1), (there, there));
        assert_eq!(sample.trailer_mass_kg, 20e3);
        assert_eq!(aligner.is_stale(Quantity::Speed, us), !there);
        assert!(!aligner.is_stale(Quantity::TrailerMass, u64::MAX - 1));
        assert_eq!(aligner.age_us(Quantity::Speed, us), Some(us));
        assert_eq!(aligner.age_us(Quantity::Steer, us), None);
    }
}

/// Another device is used when the signal of the first one is stale; for a mass, which never
/// becomes stale, after half a minute.
#[test]
fn another_device_is_listened_to_when_the_first_one_is_dead() {
    for (quantity, gone_us) in [
        (Quantity::LateralAcceleration, 500_000),
        (Quantity::Speed, 2_500_000),
        (Quantity::TrailerMass, 30_000_000),
    ] {
        let mut aligner = aligner();
        assert_eq!(aligner.push(quantity, (1, 0), 1000, 20.0), Taken::Yes);
        let at_us = 1000 + gone_us;
        assert_eq!(aligner.push(quantity, (2, 0), at_us, 20.0), Taken::OtherSource);
        assert_eq!(aligner.push(quantity, (1, 1), at_us, 20.0), Taken::OtherSource);
        assert_eq!(aligner.push(quantity, (2, 0), at_us + 1, 20.0), Taken::Yes, "{quantity:?}");
    }
}

/// Values of two devices are not interpolated.
#[test]
fn two_devices_make_no_line() {
    let mut aligner = aligner();
    aligner.push(Quantity::LateralAcceleration, (1, 1), 1_000_000, 1.0);
    aligner.push(Quantity::LateralAcceleration, (2, 0), 1_100_000, 2.0);
    assert_eq!(at(&mut aligner, 1_050_000), 2.0);
}

#[test]
fn what_is_absent_is_no_news() {
    let mut aligner = aligner();
    assert_eq!(lateral(&mut aligner, 1000, f64::NAN), Taken::Yes);
    assert_eq!(aligner.age_us(Quantity::LateralAcceleration, 1000), None);
}

#[test]
fn a_steer_angle_comes_before_the_wheels() {
    let settings = AlignSettings { steering_ratio: Some(20.0), ..AlignSettings::NONE };
    assert_eq!(settings.steer_rad(0.1, 4.0), 0.1);
    assert_eq!(settings.steer_rad(f64::NAN, 4.0), 0.2);
    assert!(AlignSettings::NONE.steer_rad(f64::NAN, 4.0).is_nan());
}

/// A roll angle with an earlier time, or with the same time as the last one, gives no sample.
#[test]
fn samples_follow_each_other() {
    let mut aligner = aligner();
    for us in [1000, 3000, 2000, 3000, 4000] {
        aligner.push(Quantity::Roll, ROLL_SENSOR, us, 0.0);
    }
    let times: Vec<u64> = (0..).map_while(|_| aligner.next(4000)).map(|s| s.time_us).collect();
    assert_eq!(times, [1000, 3000, 4000]);
}

/// Level sensors 0.8 m apart.
const LEVELS: AlignSettings<f64> =
    AlignSettings { suspension_roll_of_level: Some(1.25), ..AlignSettings::NONE };

/// Sends both levels. The left side rises by 10 mm in 100 ms.
fn levels(aligner: &mut Aligner<f64>, us: u64) {
    #[allow(clippy::cast_precision_loss)]
    let left_m = us as f64 * 1e-7;
    aligner.push(Quantity::LevelLeft, BRAKES, us, left_m);
    aligner.push(Quantity::LevelRight, BRAKES, us, 0.0);
}

#[test]
fn levels_set_the_pace_where_there_is_no_roll_sensor() {
    let mut aligner = Aligner::new(LEVELS);
    for us in [100_000, 200_000, 300_000] {
        levels(&mut aligner, us);
        let sample = aligner.next(us).unwrap();
        #[allow(clippy::cast_precision_loss)]
        let roll_rad = 1.25 * us as f64 * 1e-7;
        assert_eq!(sample.time_us, us);
        assert!((sample.suspension_roll_rad - roll_rad).abs() < 1e-15);
        assert!(aligner.next(us).is_none()); // the right level makes no sample of its own
    }
}

#[test]
fn levels_are_interpolated_to_the_times_of_a_roll_angle() {
    let mut aligner = Aligner::new(LEVELS);
    levels(&mut aligner, 100_000);
    assert_eq!(aligner.next(100_000).unwrap().time_us, 100_000); // no roll angle so far
    for us in [120_000, 170_000, 220_000] {
        aligner.push(Quantity::RollToGravity, ROLL_SENSOR, us, 0.05);
        assert!(aligner.next(us).is_none(), "{us}"); // waits for the levels
    }
    levels(&mut aligner, 200_000);
    for (us, roll_rad) in [(120_000, 0.015), (170_000, 0.021_25)] {
        let sample = aligner.next(220_000).unwrap();
        assert_eq!((sample.time_us, sample.roll_to_gravity_rad), (us, 0.05));
        assert!((sample.suspension_roll_rad - roll_rad).abs() < 1e-15, "{sample:?}");
    }
    // The third angle waits for the next levels. The levels themselves give no sample.
    assert!(aligner.next(220_000).is_none());
    levels(&mut aligner, 300_000);
    assert_eq!(aligner.next(300_000).unwrap().time_us, 220_000);
    assert!(aligner.next(u64::MAX).is_none());
}

/// The first of the list that is alive sets the pace: a roll angle counts as lost after half a
/// second.
#[test]
fn the_best_roll_angle_that_is_alive_sets_the_pace() {
    let order = [
        Quantity::Roll,
        Quantity::RollToGravity,
        Quantity::Tilt,
        Quantity::SuspensionRoll,
        Quantity::LevelLeft,
        Quantity::TractorSuspensionRoll,
        Quantity::TractorLevelLeft,
        Quantity::TractorTilt,
    ];
    for pair in order.windows(2) {
        let mut aligner = aligner();
        aligner.push(pair[0], ROLL_SENSOR, 1_000_000, 0.1);
        aligner.push(pair[1], BRAKES, 1_500_000, 0.1);
        assert_eq!(aligner.next(2_000_000).map(|s| s.time_us), Some(1_000_000), "{pair:?}");
        assert_eq!(aligner.next(2_000_000), None, "{pair:?}");
        aligner.push(pair[1], BRAKES, 1_500_001, 0.1);
        assert_eq!(aligner.next(2_000_000).map(|s| s.time_us), Some(1_500_001), "{pair:?}");
    }
    for quantity in Quantity::ALL.into_iter().filter(|quantity| !order.contains(quantity)) {
        let mut aligner = aligner();
        aligner.push(quantity, BRAKES, 1_000_000, 0.1);
        assert_eq!(aligner.next(2_000_000), None, "{quantity:?}");
    }
}

/// A track holds the time between two values in 24 bits, 16.8 s. Without its limit, 16.877216 s
/// would look like 0.1 s.
#[test]
fn a_value_after_a_long_silence_makes_no_line() {
    for gap_us in [20_000_000, (1 << 24) + 100_000] {
        let mut aligner = aligner();
        lateral(&mut aligner, 1_000_000, 1.0);
        lateral(&mut aligner, 1_000_000 + gap_us, 2.0);
        assert_eq!(at(&mut aligner, 950_000 + gap_us), 2.0, "{gap_us}");
        let mut silent = self::aligner();
        lateral(&mut silent, 1_000_000, 1.0);
        lateral(&mut silent, 1_000_000 + gap_us, 2.0);
        assert!(at(&mut silent, 10_000_000).is_nan(), "{gap_us}");
    }
}

/// A level that arrives every 0.4 s, which is later than samples wait, delays each by 0.12 s and no
/// more. When it no longer arrives at all, nothing is delayed after half a second.
#[test]
fn a_late_level_delays_samples_by_no_more_than_the_waiting_time() {
    let mut aligner = aligner();
    let (mut samples, mut delayed, mut greatest_us) = (0, 0, 0);
    for us in (1000_u64..4_000_000).step_by(1000) {
        if us % 400_000 == 1000 && us < 2_000_000 {
            aligner.push(Quantity::LevelLeft, BRAKES, us, 0.1);
        }
        if us % 10_000 == 5000 {
            aligner.push(Quantity::Roll, ROLL_SENSOR, us, 0.01);
        }
        while let Some(sample) = aligner.next(us) {
            let delay_us = us - sample.time_us;
            assert!(us < 2_300_000 || delay_us == 0, "{us} {delay_us}");
            samples += 1;
            delayed += u32::from(delay_us > 0);
            greatest_us = greatest_us.max(delay_us);
        }
    }
    // The first level comes before the first roll angle and makes a sample of its own.
    assert_eq!((samples, greatest_us), (1 + 400, 120_000));
    assert!(delayed > 100, "{delayed}");
}
