//! Tests of the conditioning: detection of turns, changes of speed, tilt, and absent values.

#![allow(clippy::unwrap_used, clippy::float_cmp)] // values that are passed on are unchanged

use crate::common::{PAIR, design};
use cg_core::decide::condition::Row;
use cg_core::{Conditioner, Design, Sample, SampleError};

/// A conditioner that receives samples at 100 Hz.
struct Road {
    design: Design<f64, 2>,
    conditioner: Conditioner<f64, 2>,
    time_us: u64,
}

impl Road {
    fn of(design: &Design<f64, 2>) -> Self {
        Self { design: *design, conditioner: Conditioner::new(design), time_us: 0 }
    }

    fn new() -> Self {
        Self::of(&design())
    }

    /// The next row, 10 ms after the previous one. It contains only a roll angle, and what `fill`
    /// sets.
    fn row(&mut self, fill: impl Fn(&mut Sample<f64>)) -> Option<Row<f64, 2>> {
        self.time_us += 10_000;
        let mut sample = Sample::absent(self.time_us);
        sample.roll_rad = 0.01;
        fill(&mut sample);
        self.conditioner.push(&self.design, &sample).unwrap()
    }

    /// The last of `rows` rows with the same lateral acceleration.
    fn felt(&mut self, rows: u32, lateral_mps2: f64) -> Row<f64, 2> {
        let mut last = None;
        for _ in 0..rows {
            last = self.row(|sample| sample.lateral_acceleration_mps2 = lateral_mps2);
        }
        last.unwrap()
    }

    /// The number of rows with this lateral acceleration until the turn is detected, or until its
    /// end.
    fn rows_until(&mut self, turning: bool, lateral_mps2: f64) -> u32 {
        (1..1000).find(|_| self.felt(1, lateral_mps2).turning == turning).unwrap()
    }
}

/// Five seconds are twenty time constants of the filter.
#[test]
fn a_turn_begins_above_0_5_and_ends_at_0_3() {
    for sign in [1.0, -1.0] {
        let mut road = Road::new();
        let steps = [
            (0.0, false),
            (0.499, false),
            (0.501, true),
            (0.301, true),
            (0.299, false),
            (0.4, false),
        ];
        for (lateral, turning) in steps {
            assert_eq!(road.felt(500, sign * lateral).turning, turning, "{lateral}");
        }
    }
    assert!(!Road::new().felt(1, 0.5).turning);
    assert!(Road::new().felt(1, 0.51).turning); // the first value is not filtered
}

/// A lag of 0.25 s at 100 Hz leaves (25/26)ⁿ of a step: half of it at n = 17.7, 0.3 of it at n =
/// 30.7.
#[test]
fn lateral_acceleration_is_smoothed_over_a_quarter_of_a_second() {
    let mut road = Road::new();
    road.felt(1, 0.0);
    assert_eq!(road.rows_until(true, 1.0), 18);
    road.felt(500, 1.0);
    assert_eq!(road.rows_until(false, 0.0), 31);
}

#[test]
fn the_linear_model_holds_below_3_5() {
    for (lateral, linear) in [(3.49, true), (3.5, false), (-3.49, true), (-3.51, false)] {
        assert_eq!(Road::new().felt(1, lateral).usable, [linear; 2], "{lateral}");
    }
}

/// Each lag is behind a ramp by slope times time constant, for any interval.
#[test]
fn steer_counts_at_less_than_0_05_of_longitudinal_acceleration() {
    for (slope_mps2, steady) in [(0.0499, true), (-0.0499, true), (0.0501, false), (-0.0501, false)]
    {
        let mut road = Road::new();
        let mut last = None;
        for k in 0..3000 {
            last = road.row(|sample| {
                sample.lateral_acceleration_mps2 = 0.1;
                sample.speed_mps = 15.0 + slope_mps2 * 0.01 * f64::from(k);
            });
        }
        assert_eq!(last.unwrap().usable, [steady, true], "{slope_mps2}");
    }
}

/// A step of 1 m/s in two lags of 1 s at 100 Hz: the acceleration is n/101 (100/101)ⁿ, at least 0.05
/// m/s² from n = 6 to 451.
#[test]
fn a_step_of_speed_is_forgotten_with_its_filter() {
    let mut road = Road::new();
    road.row(|sample| (sample.speed_mps, sample.steer_rad) = (10.0, 0.0));
    let usable = |road: &mut Road| {
        road.row(|sample| (sample.speed_mps, sample.steer_rad) = (11.0, 0.0)).unwrap().usable
    };
    let unsteady: Vec<_> = (1..1000).filter(|_| usable(&mut road) == [false, true]).collect();
    assert_eq!((unsteady.first(), unsteady.last()), (Some(&6), Some(&451)));
    assert_eq!(unsteady.len(), 451 - 5);
}

#[test]
fn a_row_wants_a_roll_angle_and_an_input() {
    let mut road = Road::new();
    assert!(road.row(|_| {}).is_none());
    assert!(road.row(|sample| sample.steer_rad = 0.0).is_some());
    assert!(road.row(|sample| sample.lateral_acceleration_mps2 = 0.0).is_some());
    assert!(road.row(|sample| sample.yaw_rate_radps = 0.0).is_some());
    let blind = |sample: &mut Sample<f64>| {
        (sample.roll_rad, sample.steer_rad) = (f64::NAN, 0.0);
    };
    assert!(road.row(blind).is_none());
    // An inclinometer requires a lateral acceleration.
    let tilted = |sample: &mut Sample<f64>| {
        blind(sample);
        sample.tilt_rad = 0.1;
    };
    assert!(road.row(tilted).is_none());
}

#[test]
fn an_inclinometer_shows_roll_and_lateral_acceleration() {
    let mut road = Road::new();
    let tilted = |sample: &mut Sample<f64>| {
        (sample.roll_rad, sample.tilt_rad) = (f64::NAN, 0.25);
        sample.lateral_acceleration_mps2 = 1.962;
    };
    let row = road.row(tilted).unwrap();
    assert!((row.measured_rad[0] - 0.05).abs() < 1e-15); // 0.25 − 1.962/9.81
    let both = |sample: &mut Sample<f64>| {
        tilted(sample);
        sample.roll_rad = 0.07;
    };
    assert_eq!(road.row(both).unwrap().measured_rad[0], 0.07);
    let turned = |sample: &mut Sample<f64>| {
        tilted(sample);
        sample.lateral_acceleration_mps2 = f64::NAN;
        (sample.yaw_rate_radps, sample.speed_mps) = (0.1962, 10.0);
    };
    assert!((road.row(turned).unwrap().measured_rad[0] - 0.05).abs() < 1e-15);
}

#[test]
fn yaw_rate_times_speed_stands_in_for_lateral_acceleration() {
    let mut road = Road::new();
    let turned =
        |sample: &mut Sample<f64>| (sample.yaw_rate_radps, sample.speed_mps) = (-0.1, 12.0);
    assert!((road.row(turned).unwrap().lateral_acceleration_mps2 + 1.2).abs() < 1e-15);
    // The last known speed is used; a measured lateral acceleration has priority.
    let row = road.row(|sample| sample.yaw_rate_radps = 0.05).unwrap();
    assert!((row.lateral_acceleration_mps2 - 0.6).abs() < 1e-15);
    let row = road.row(|sample| {
        (sample.yaw_rate_radps, sample.lateral_acceleration_mps2) = (0.05, 0.7);
    });
    assert_eq!(row.unwrap().lateral_acceleration_mps2, 0.7);
    // Before the first speed, the nominal speed is used.
    let row = Road::new().row(|sample| sample.yaw_rate_radps = 0.1).unwrap();
    assert!((row.lateral_acceleration_mps2 - 1.39).abs() < 1e-15);
}

/// A design whose ratios are those of the plain design, multiplied by mass and speed relative to the
/// nominal values; those to the lateral acceleration are divided by the square of the speed.
fn scheduled() -> Design<f64, 2> {
    let mut design = design();
    for (i, speed) in design.speed_mps.into_iter().enumerate() {
        for (j, mass) in design.trailer_mass_kg.into_iter().enumerate() {
            let (speed, mass) = (speed / 13.9, mass / 31.3e3);
            let factors = [speed * mass, mass / (speed * speed)];
            for (channel, factor) in design.channels.iter_mut().zip(factors) {
                let line = &mut channel.lines[i][j];
                (line.a0, line.a1) = (line.a0 * factor, line.a1 * factor);
            }
        }
    }
    design
}

/// Expected roll angle of both channels divided by the ratio of the plain design.
fn factors(row: &Row<f64, 2>) -> [f64; 2] {
    let plain = design();
    PAIR.map(|channel| {
        let design = &plain.channels[channel.index()];
        let ratio = design.lines[0][0].ratio_at(plain.reference_height_m) * design.compensation;
        row.expected_rad[channel.index()] / ratio
    })
}

#[test]
fn inputs_are_scaled_by_what_speed_and_mass_make_of_them() {
    let mut road = Road::of(&scheduled());
    let mut inputs = |speed_mps: f64, mass_kg: f64| {
        let row = road.row(|sample| {
            (sample.steer_rad, sample.lateral_acceleration_mps2) = (0.1, 2.0);
            (sample.speed_mps, sample.trailer_mass_kg) = (speed_mps, mass_kg);
        });
        row.unwrap()
    };
    let (nan, nominal, heavy) = (f64::NAN, 1.0, 35.0 / 31.3);
    for (speed, mass, of_speed, of_mass) in [
        (nan, nan, nominal, nominal),
        (13.9, 31.3e3, nominal, nominal),
        (20.0, nan, 20.0 / 13.9, nominal),
        (nan, 35e3, 20.0 / 13.9, heavy), // the last speed remains
        (10.0, 0.0, 10.0 / 13.9, heavy), // a scale that shows zero has not measured
        (nan, -1.0, 10.0 / 13.9, heavy),
        (90.0, nan, 10.0 / 13.9, heavy), // no truck is this fast
    ] {
        let row = inputs(speed, mass);
        let [steer, lateral] = factors(&row);
        assert!((steer - 0.1 * of_mass * of_speed).abs() < 1e-13, "{speed} {mass}: {steer}");
        assert!(
            (lateral - 2.0 * of_mass / (of_speed * of_speed)).abs() < 1e-12,
            "{speed} {mass}: {lateral}"
        );
    }
    let row = inputs(nan, nan);
    assert_eq!((row.speed_mps, row.trailer_mass_kg), (10.0, 35e3));
}

/// The gains are kept as functions of the speed within an interval of the axis and at one mass. Both
/// change here, in turn and together, also to a speed or mass between two nodes and back.
#[test]
fn gains_are_those_of_the_ratio_lines_wherever_speed_and_mass_go() {
    let design = scheduled();
    let mut road = Road::of(&design);
    for k in 0..300_u32 {
        let speed_mps = 2.0 + f64::from(k * 5 % 57) * 0.5; // 2 to 30 m/s, nodes among them
        let mass_kg = 8e3 + f64::from(k / 3 * 13 % 33) * 1e3; // 8 to 40 t
        let row = road.row(|sample| {
            (sample.steer_rad, sample.lateral_acceleration_mps2) = (1.0, 1.0);
            (sample.speed_mps, sample.trailer_mass_kg) = (speed_mps, mass_kg);
        });
        for (channel, found) in PAIR.into_iter().zip(row.unwrap().expected_rad) {
            let line = design.line(channel, speed_mps, mass_kg).unwrap();
            let known = line.ratio_at(design.reference_height_m) * design.compensation(channel);
            // A dozen roundings of terms up to the greatest node, which is 225 times the least.
            assert!((found / known - 1.0).abs() < 1e-12, "{speed_mps} {mass_kg} {channel}");
        }
    }
}

#[test]
fn beyond_the_axes_nothing_is_expected_and_nothing_usable() {
    let mut road = Road::new();
    let turn = |speed_mps: f64| {
        move |sample: &mut Sample<f64>| {
            (sample.steer_rad, sample.lateral_acceleration_mps2) = (0.02, 1.0);
            sample.speed_mps = speed_mps;
        }
    };
    assert!(road.row(turn(30.0)).unwrap().usable[1]);
    let row = road.row(turn(30.1)).unwrap();
    assert!(row.expected_rad.iter().all(|expected| expected.is_nan()));
    assert_eq!((row.usable, row.turning), ([false; 2], true));
    // The steer angle cannot show the end of the turn either, so the state remains.
    let row = road.row(|sample| sample.steer_rad = 0.0).unwrap();
    assert!(row.turning && row.lateral_acceleration_mps2.is_nan());
}

/// In this design, a steady steer angle of 1 rad gives 34 m/s².
#[test]
fn steer_tells_of_a_turn_where_lateral_acceleration_is_absent() {
    let mut road = Road::new();
    let row = road.row(|sample| sample.steer_rad = 0.02).unwrap();
    assert!((row.lateral_acceleration_mps2 - 0.68).abs() < 1e-13 && row.turning);
    assert!(row.expected_rad[1].is_nan() && row.expected_rad[0] > 0.0);
}

#[test]
fn what_cannot_be_is_absent() {
    let mut road = Road::new();
    for wrong in [31.0, f64::NAN, f64::NEG_INFINITY] {
        let row = road.row(|sample| {
            (sample.steer_rad, sample.lateral_acceleration_mps2) = (0.0, wrong);
        });
        assert_eq!(row.unwrap().lateral_acceleration_mps2, 0.0);
    }
}

#[test]
fn time_that_does_not_increase_is_refused_and_named() {
    let mut road = Road::new();
    road.felt(3, 0.0);
    for time_us in [30_000, 29_999, 0] {
        let refused = road.conditioner.push(&road.design, &Sample::absent(time_us)).unwrap_err();
        assert_eq!(refused, SampleError::TimeOrder { previous_us: 30_000, time_us });
        let text = format!("time stamp {time_us} µs does not follow 30000 µs");
        assert_eq!(refused.to_string(), text);
    }
    assert!(road.row(|sample| sample.steer_rad = 0.0).is_some());
}
