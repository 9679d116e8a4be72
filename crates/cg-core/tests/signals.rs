//! Tests of the signals of a row: which sensor each of them comes from.

#![allow(clippy::unwrap_used, clippy::float_cmp)] // values that are passed on are unchanged

use crate::common::{full_design, narrow};
use cg_core::decide::condition::Row;
use cg_core::{Channel, Conditioner, Sample};

const STEER: usize = Channel::Steer.index();
const LATERAL: usize = Channel::LateralAcceleration.index();
const SUSPENSION: usize = Channel::Suspension.index();
const TRACTOR: usize = Channel::Tractor.index();

/// The first row of a truck with all channels whose sample contains only what `fill` sets.
fn row(fill: impl Fn(&mut Sample<f64>)) -> Option<Row<f64>> {
    let design = full_design();
    let mut sample = Sample::absent(1000);
    fill(&mut sample);
    Conditioner::new(&design).push(&design, &sample).unwrap()
}

/// Expected roll angle per unit of the input of a channel.
fn gain(channel: usize) -> f64 {
    let design = full_design();
    let of = &design.channels[channel];
    of.lines[0][0].ratio_at(design.reference_height_m) * of.compensation
}

/// The input of a channel in a row.
fn input(row: &Row<f64>, channel: usize) -> f64 {
    row.expected_rad[channel] / gain(channel)
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-14, "{found} {expected}");
}

/// Relative to the road, then relative to gravity, then `(f − a_y)/g` = 0.25 − 1.962/9.81 = 0.05.
#[test]
fn the_roll_angle_is_the_best_that_a_sensor_shows() {
    for (roll_rad, roll_to_gravity_rad, measured_rad, to_gravity) in [
        (0.03, 0.04, 0.03, false),
        (0.03, f64::NAN, 0.03, false),
        (f64::NAN, 0.04, 0.04, true),
        (f64::NAN, f64::NAN, 0.05, true),
    ] {
        let row = row(|sample| {
            (sample.roll_rad, sample.roll_to_gravity_rad) = (roll_rad, roll_to_gravity_rad);
            (sample.tilt_rad, sample.lateral_acceleration_mps2) = (0.25, 1.962);
        })
        .unwrap();
        close(row.measured_rad[STEER], measured_rad);
        assert_eq!(row.measured_rad[LATERAL], row.measured_rad[STEER]);
        assert_eq!(row.to_gravity, to_gravity);
        close(input(&row, LATERAL), 1.962);
    }
}

/// An accelerometer has priority over the tilt, f = 9.81 · 0.2 = 1.962.
#[test]
fn the_specific_force_is_measured_or_the_tilt_times_g() {
    for (force_mps2, tilt_rad, expected_mps2) in
        [(1.5, 0.2, 1.5), (1.5, f64::NAN, 1.5), (f64::NAN, 0.2, 1.962)]
    {
        let row = row(|sample| {
            sample.suspension_roll_rad = 0.02;
            (sample.lateral_specific_force_mps2, sample.tilt_rad) = (force_mps2, tilt_rad);
            sample.tractor_suspension_roll_rad = 0.01;
            sample.tractor_lateral_specific_force_mps2 = force_mps2;
            sample.tractor_tilt_rad = tilt_rad;
        })
        .unwrap();
        close(input(&row, SUSPENSION), expected_mps2);
        close(input(&row, TRACTOR), expected_mps2);
        assert_eq!([row.measured_rad[SUSPENSION], row.measured_rad[TRACTOR]], [0.02, 0.01]);
    }
}

/// The measured value, then yaw rate times speed, then f − g (φ + β) = 1.5 − 9.81 · 0.05 = 1.0095.
#[test]
fn the_lateral_acceleration_is_the_best_that_follows() {
    for (measured_mps2, yaw_rate_radps, expected_mps2) in
        [(0.7, 0.06, 0.7), (f64::NAN, 0.06, 0.6), (f64::NAN, f64::NAN, 1.0095)]
    {
        let row = row(|sample| {
            (sample.roll_to_gravity_rad, sample.lateral_specific_force_mps2) = (0.05, 1.5);
            sample.lateral_acceleration_mps2 = measured_mps2;
            (sample.yaw_rate_radps, sample.speed_mps) = (yaw_rate_radps, 10.0);
        })
        .unwrap();
        close(input(&row, LATERAL), expected_mps2);
        assert_eq!(row.measured_rad[LATERAL], 0.05);
        close(row.lateral_acceleration_mps2, expected_mps2);
        close(input(&row, SUSPENSION), 1.5);
    }
}

/// Relative to the road, the roll angle does not remove the gravity from the specific force.
#[test]
fn a_roll_angle_to_the_road_gives_no_lateral_acceleration() {
    let row = row(|sample| {
        (sample.roll_rad, sample.lateral_specific_force_mps2) = (0.05, 1.5);
        sample.suspension_roll_rad = 0.04;
    });
    let row = row.unwrap();
    assert!(row.expected_rad[LATERAL].is_nan() && row.expected_rad[SUSPENSION] > 0.0);
    assert!(!row.to_gravity);
}

#[test]
fn the_tractor_alone_gives_a_row() {
    let row = row(|sample| {
        sample.tractor_suspension_roll_rad = 0.015;
        sample.tractor_lateral_specific_force_mps2 = 1.2;
    })
    .unwrap();
    assert_eq!(row.measured_rad[TRACTOR], 0.015);
    close(input(&row, TRACTOR), 1.2);
    for other in [STEER, LATERAL, SUSPENSION] {
        assert!(row.measured_rad[other].is_nan() && row.expected_rad[other].is_nan());
    }
    // There is no roll angle of the trailer, so none contains a bank.
    assert!(!row.to_gravity);
}

/// A roll angle and the input of another one are no pair.
#[test]
fn a_row_needs_an_output_with_its_own_input() {
    let fills: [fn(&mut Sample<f64>); 6] = [
        |sample| sample.roll_rad = 0.02,
        |sample| sample.suspension_roll_rad = 0.02,
        |sample| sample.tractor_suspension_roll_rad = 0.02,
        |sample| {
            (sample.suspension_roll_rad, sample.tractor_lateral_specific_force_mps2) = (0.02, 1.0);
        },
        |sample| {
            (sample.tractor_suspension_roll_rad, sample.lateral_acceleration_mps2) = (0.02, 1.0);
        },
        |sample| (sample.steer_rad, sample.lateral_specific_force_mps2) = (0.02, 1.0),
    ];
    for (k, fill) in fills.into_iter().enumerate() {
        assert_eq!(row(fill), None, "{k}");
    }
}

/// Steady-state steering gives 34 m/s² per rad in this design. A specific force contains gravity:
/// `a_y = f/(1 + g R)`.
#[test]
fn the_felt_acceleration_follows_from_the_steer_angle_or_a_force() {
    let expect = |steer_rad: f64, force_mps2: f64, expected_mps2: f64| {
        let row = row(|sample| {
            sample.steer_rad = steer_rad;
            sample.tractor_suspension_roll_rad = 0.01;
            sample.tractor_lateral_specific_force_mps2 = 1.5;
            (sample.suspension_roll_rad, sample.lateral_specific_force_mps2) = (0.01, force_mps2);
        });
        let found = row.unwrap().lateral_acceleration_mps2;
        assert!((found - expected_mps2).abs() < 1e-12, "{found} {expected_mps2}");
    };
    let share = 1.0 + 9.81 * gain(LATERAL);
    assert!(share > 1.2); // so that gravity counts
    expect(0.02, 2.0, 0.68);
    expect(f64::NAN, 2.0, 2.0 / share);
    expect(f64::NAN, f64::NAN, 1.5 / share);
}

/// Without the channel of the lateral acceleration, the roll angle per m/s² is not known.
#[test]
fn a_design_without_the_lateral_channel_feels_the_whole_force() {
    let design = full_design().with_channels([Channel::Tractor]).unwrap();
    let mut sample = Sample::absent(1000);
    sample.tractor_suspension_roll_rad = 0.01;
    sample.tractor_lateral_specific_force_mps2 = 1.5;
    sample.roll_rad = 0.01; // which no channel of the design explains
    let row = Conditioner::new(&design).push(&design, &sample).unwrap().unwrap();
    assert_eq!(row.lateral_acceleration_mps2, 1.5);
    assert_eq!((row.measured_rad, row.usable, row.turning), ([0.01], [true], true));
}

/// A steer angle alone tells a turn, too: its expected roll angle at 0.2 rad per g.
#[test]
fn a_design_with_the_steer_channel_alone_knows_turns() {
    let full = full_design();
    let design = full.with_channels([Channel::Steer]).unwrap();
    let mut sample = Sample::absent(1000);
    (sample.steer_rad, sample.roll_rad, sample.speed_mps) = (0.1, 0.04, 12.0);
    let row = Conditioner::new(&design).push(&design, &sample).unwrap().unwrap();
    let [expected_rad] = row.expected_rad;
    let lateral_mps2 = expected_rad / 0.2 * design.gravity_mps2;
    assert!((row.lateral_acceleration_mps2 / lateral_mps2 - 1.0).abs() < 1e-12, "{row:?}");
    assert!(row.turning && lateral_mps2 > 0.5, "{row:?}");
    let exact = Conditioner::new(&full).push(&full, &sample).unwrap().unwrap();
    assert!(exact.lateral_acceleration_mps2 > 0.0 && exact.turning);
}

/// At a longitudinal acceleration of 1 m/s², only the steer angle is not used.
#[test]
fn a_change_of_speed_costs_the_steer_channel_only() {
    let design = full_design();
    let mut conditioner = Conditioner::new(&design);
    let mut last = None;
    for k in 1..=1000_u32 {
        let mut sample = Sample::absent(u64::from(k) * 10_000);
        sample.roll_rad = 0.01;
        (sample.steer_rad, sample.lateral_acceleration_mps2) = (0.001, 0.1);
        sample.speed_mps = 10.0 + 0.01 * f64::from(k);
        last = conditioner.push(&design, &sample).unwrap();
    }
    assert_eq!(last.unwrap().usable, [false, true, true, true]);
}

/// Limits of the quantities apply to all fields.
#[test]
fn what_a_sensor_cannot_show_is_absent_in_every_field() {
    let design = full_design().cast::<f32>();
    let mut sample = Sample::absent(1000);
    (sample.roll_to_gravity_rad, sample.suspension_roll_rad) = (1.01, -1.01);
    (sample.tractor_suspension_roll_rad, sample.tractor_tilt_rad) = (f32::INFINITY, 1.51);
    sample.lateral_specific_force_mps2 = narrow(-30.1);
    sample.tractor_lateral_specific_force_mps2 = 1e30;
    (sample.steer_rad, sample.lateral_acceleration_mps2) = (0.0, 0.0);
    assert_eq!(Conditioner::new(&design).push(&design, &sample), Ok(None));
    let checked = sample.checked();
    assert!(
        [
            checked.roll_to_gravity_rad,
            checked.suspension_roll_rad,
            checked.tractor_suspension_roll_rad,
            checked.tractor_tilt_rad,
            checked.lateral_specific_force_mps2,
            checked.tractor_lateral_specific_force_mps2,
        ]
        .iter()
        .all(|value| value.is_nan())
    );
}
