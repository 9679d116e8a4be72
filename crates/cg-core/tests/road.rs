//! Tests of what the bank of the road does to the heights, and of trucks with all channels.

#![allow(clippy::unwrap_used, clippy::float_cmp)] // without a bank, the numbers are the same

use crate::common;
use std::array::from_fn;

use crate::common::told::{ROLL_RAD, Road, Says};
use crate::common::{PAIR, design_with};
use cg_core::{
    Articulation, Channel, Combined, Estimator, Inconsistency, Maneuver, Outcome, Reject, Sample,
    Settings,
};

/// Standard deviation of the bank of public roads.
const BANK_RAD: f64 = 0.02;
const HEIGHT_M: f64 = 1.973;

fn truck<const C: usize>(channels: [Channel; C], settings: Settings<f64>) -> Road<C> {
    let mut road = Road::on(Estimator::new(design_with(channels), settings, Says::WELL));
    road.speed_mps = 20.0;
    road
}

/// One turn of ten seconds with a constant lateral acceleration.
fn turn<const C: usize>(mut road: Road<C>) -> Maneuver<f64, C> {
    road.hold(1000, ROLL_RAD);
    road.finish()
}

/// Public roads, on which a ratio may be uncertain by any amount.
fn public() -> Settings<f64> {
    let mut settings = Settings::truck();
    settings.road_sd_relative = f64::INFINITY;
    settings
}

fn flat() -> Settings<f64> {
    Settings::truck().on_road(0.0)
}

/// Roll angle per m/s² at the reference height, without the compensation.
fn roll_per_mps2() -> f64 {
    common::design().channels[1].lines[0][0].ratio_at(HEIGHT_M)
}

/// What a bank of one standard deviation does to a ratio: `g β / a_y`, and relative to gravity
/// `(1 + 1/(g R))` times that.
fn bank_share(to_gravity: bool) -> f64 {
    let lateral_mps2 = ROLL_RAD / (roll_per_mps2() * 1.489_6);
    let relative_to_road = 9.81 * BANK_RAD / lateral_mps2;
    if to_gravity {
        relative_to_road * (1.0 + 1.0 / (9.81 * roll_per_mps2()))
    } else {
        relative_to_road
    }
}

/// Meters of height per relative change of the ratio.
fn meters_per_share() -> f64 {
    let line = common::design().channels[0].lines[0][0];
    let slope = (line.ratio_at(HEIGHT_M + 1e-4) - line.ratio_at(HEIGHT_M - 1e-4)) / 2e-4;
    line.ratio_at(HEIGHT_M) / slope
}

/// The ratio has 1 % of noise and 1.3 % of model. Half of the variance of the bank belongs to the
/// curve, the other half to all curves.
fn check(outcome: &Outcome<f64>, bank: f64) {
    check_road(outcome, bank, [bank / 2.0_f64.sqrt(); 2]);
}

/// Road twist of the trailer's and of the tractor's suspension on public roads.
const TWIST_RAD: [f64; 2] = [0.0004, 0.0008];

/// What road twist does to the ratio of a suspension.
fn twist_share(outcome: &Outcome<f64>, twist_rad: f64) -> f64 {
    let lateral_mps2 = ROLL_RAD / (roll_per_mps2() * 1.489_6);
    let force_mps2 = lateral_mps2 * (1.0 + 9.81 * roll_per_mps2());
    twist_rad / (outcome.fit.unwrap().ratio.value * force_mps2)
}

/// The parts of the road that all curves have in common, and the rest.
fn check_road(outcome: &Outcome<f64>, bank: f64, [common, own]: [f64; 2]) {
    let random_m = 0.01_f64.hypot(own) * meters_per_share();
    let systematic_m = 0.013_f64.hypot(common) * meters_per_share();
    let height = outcome.height_m.unwrap();
    assert!((height.value - HEIGHT_M).abs() < 1e-9, "{height:?}");
    assert!((height.sd / random_m - 1.0).abs() < 1e-3, "{height:?} {random_m}");
    assert!((outcome.systematic_sd_m / systematic_m - 1.0).abs() < 1e-3, "{outcome:?}");
    assert!((outcome.road_sd_m - bank * meters_per_share()).abs() < 1e-3, "{outcome:?}");
}

#[test]
fn a_roll_angle_relative_to_gravity_contains_the_bank_of_the_road() {
    let mut road = truck(PAIR, public());
    road.to_gravity = true;
    for outcome in turn(road).outcomes {
        check(&outcome, bank_share(true));
    }
}

#[test]
fn on_a_flat_road_gravity_is_as_good_as_the_road() {
    let mut to_gravity = truck(PAIR, flat());
    to_gravity.to_gravity = true;
    let found = turn(to_gravity);
    // A roll angle relative to the road comes from a test track, if it is the only one.
    for settings in [flat(), Settings::truck()] {
        let to_road = turn(truck(PAIR, settings));
        assert!(found.to_gravity && !to_road.to_gravity);
        assert_eq!(found.outcomes, to_road.outcomes);
        assert_eq!(found.correlation, to_road.correlation);
    }
    assert_eq!(found.correlation, [[1.0, 0.5], [0.5, 1.0]]);
    found.outcomes.iter().for_each(|outcome| check(outcome, 0.0));
}

/// A truck with other sensors is on a road, so its roll angle feels the bank, though it does not
/// contain it.
#[test]
fn a_channel_that_does_not_feel_the_bank_shows_that_there_is_a_road() {
    let [steer, lateral, suspension, tractor] =
        turn(truck(Channel::ALL, Settings::truck())).outcomes;
    check(&steer, bank_share(false));
    check(&lateral, bank_share(false));
    for (outcome, twist_rad) in [suspension, tractor].iter().zip(TWIST_RAD) {
        check_road(outcome, 0.0, [twist_share(outcome, twist_rad) / 2.0_f64.sqrt(); 2]);
    }
    // The same truck whose other sensors do not send.
    let mut silent = truck(Channel::ALL, Settings::truck());
    (silent.heights_m[2], silent.heights_m[3]) = (f64::NAN, f64::NAN);
    let [steer, lateral, suspension, tractor] = turn(silent).outcomes;
    check(&steer, 0.0);
    check(&lateral, 0.0);
    assert_eq!([suspension, tractor].map(|outcome| outcome.height_m), [Err(Reject::Absent); 2]);
}

#[test]
fn the_suspension_gives_the_same_height_on_every_road() {
    let [.., suspension, tractor] = turn(truck(Channel::ALL, flat())).outcomes;
    let mut road = truck(Channel::ALL, public());
    road.to_gravity = true;
    let [steer, _, banked_suspension, banked_tractor] = turn(road).outcomes;
    for (banked, flat) in [(banked_suspension, suspension), (banked_tractor, tractor)] {
        assert_eq!(banked.height_m.unwrap().value, flat.height_m.unwrap().value);
        assert_eq!(banked.road_sd_m, 0.0);
    }
    // Twist is of banked roads.
    check(&suspension, 0.0);
    check(&tractor, 0.0);
    check(&steer, bank_share(true));
}

/// At 6 m/s the trailer stands at an angle of 0.36 rad to the tractor. What that takes from each ratio is
/// given back, and its uncertainty is common to all turns.
#[test]
fn a_tight_turn_is_corrected_in_each_channel_and_widens_its_interval() {
    let lateral_mps2 = ROLL_RAD / (roll_per_mps2() * 1.489_6);
    let beyond = (7.6 * lateral_mps2 / 36.0).powi(2) - 0.0125;
    assert!(beyond > 0.05);
    let shares = [(-0.3, 0.3), (0.0, 0.2), (0.0, 0.1), (-0.4, 0.4)];
    let mut design = design_with(Channel::ALL);
    for (channel, (mean, sd)) in design.channels.iter_mut().zip(shares) {
        channel.articulation = Articulation { mean, sd };
    }
    let mut road = Road::on(Estimator::new(design, flat(), Says::WELL));
    road.speed_mps = 6.0;
    for (outcome, (mean, sd)) in turn(road).outcomes.iter().zip(shares) {
        let height = outcome.height_m.unwrap();
        let back_m = -mean * beyond * meters_per_share();
        // The ratio is a quotient of two lines; its second order counts as much as the square.
        assert!((height.value - HEIGHT_M - back_m).abs() < 1e-9 + back_m * back_m, "{height:?}");
        let systematic_m = 0.013_f64.hypot((sd - mean * beyond) * beyond) * meters_per_share();
        let slack = 1e-3 - 2.0 * mean * beyond;
        assert!((outcome.systematic_sd_m / systematic_m - 1.0).abs() < slack, "{outcome:?}");
    }
}

/// An interval of several times the height tells nothing, so there is none.
#[test]
fn a_bank_that_hides_the_height_is_the_reason_for_none() {
    let mut road = truck(PAIR, Settings::truck());
    road.to_gravity = true;
    for outcome in turn(road).outcomes {
        let Err(Reject::Road { ratio_sd_relative }) = outcome.height_m else {
            panic!("{outcome:?}")
        };
        assert!(
            (ratio_sd_relative / bank_share(true) - 1.0).abs() < 1e-9 && ratio_sd_relative > 0.5
        );
    }
}

/// The model's variance is 0.013² with a correlation of one half. The common part of the bank is
/// the same in both channels that feel it.
#[test]
fn channels_that_feel_the_bank_have_it_in_common() {
    let bank = bank_share(false) / 2.0_f64.sqrt();
    let (model, both) = (0.013 * 0.013, 0.013 * 0.013 + bank * bank);
    let same = (0.5 * model + bank * bank) / both;
    let maneuver = turn(truck(Channel::ALL, Settings::truck()));
    let [.., suspension, tractor] = &maneuver.outcomes;
    // Twist is of one channel.
    let twisted = |outcome, twist_rad| model + twist_share(outcome, twist_rad).powi(2) / 2.0;
    let [trailer_rad, tractor_rad] = TWIST_RAD;
    let of = [both, both, twisted(suspension, trailer_rad), twisted(tractor, tractor_rad)];
    let expected: [[f64; 4]; 4] = from_fn(|i| {
        from_fn(|j| match (i, j) {
            _ if i == j => 1.0,
            (0 | 1, 0 | 1) => same,
            _ => 0.5 * model / (of[i] * of[j]).sqrt(),
        })
    });
    let found = maneuver.correlation;
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

/// The roll angle grows to [`ROLL_RAD`], and the sensors with an end stop there.
fn ramp(mut road: Road<4>, rows: u32, roll_end_rad: f64) -> [Option<Reject<f64>>; 4] {
    road.hold(100, 0.0);
    for k in 0..=rows {
        let roll_rad = ROLL_RAD * f64::from(k) / f64::from(rows);
        road.row(roll_rad.min(roll_end_rad), roll_rad);
    }
    road.finish().outcomes.map(|outcome| outcome.height_m.err())
}

#[test]
fn a_sensor_at_its_end_costs_the_channels_with_its_roll_angle() {
    let mut road = truck(Channel::ALL, flat());
    road.suspension_end_rad = 0.02;
    // A channel with lags needs a slower turn, in which its lags do not hide the end.
    let [steer, lateral, suspension, tractor] = ramp(road, 1200, f64::INFINITY);
    assert_eq!([steer, lateral, tractor], [None; 3]);
    let Some(Reject::Inconsistent(Inconsistency::Standstill { roll_rad })) = suspension else {
        panic!("{suspension:?}")
    };
    assert!((roll_rad - 0.02).abs() < 5e-4, "{roll_rad}");
    let at = |roll_rad| Some(Reject::Inconsistent(Inconsistency::Standstill { roll_rad }));
    let road = truck(Channel::ALL, flat());
    assert_eq!(ramp(road, 400, 0.015), [at(0.015), at(0.015), None, None]);
}

#[test]
fn a_bend_of_the_suspension_leaves_the_roll_angle_in_use() {
    let mut says = Says::<4>::WELL;
    says.bend[2].value = -1.5;
    let road = Road::on(Estimator::new(common::full_design(), flat(), says));
    let [steer, lateral, suspension, tractor] = turn(road).outcomes;
    let bent = Reject::Inconsistent(Inconsistency::Bent { share: 1.5 });
    assert_eq!(suspension.height_m, Err(bent));
    assert!([steer, lateral, tractor].iter().all(|outcome| outcome.height_m.is_ok()));
}

/// On a flat road the suspension and the roll angle must agree. On a public road, the bank explains
/// the difference, and the suspension has nearly all of the weight.
#[test]
fn a_suspension_that_contradicts_the_roll_angle_is_told() {
    let combined = |settings, heights_m| {
        let mut road = truck(Channel::ALL, settings);
        road.to_gravity = true;
        road.maneuver(heights_m);
        road.estimator.combined().unwrap()
    };
    let apart = [1.7, 1.7, 2.2, 2.2];
    assert!(matches!(combined(flat(), apart), Combined::Contradictory { .. }));
    assert!(matches!(combined(flat(), [1.7; 4]), Combined::Agreed(_)));
    let Combined::Agreed(height) = combined(Settings::truck(), apart) else { panic!("a bank") };
    assert!((height.height_m.value - 2.2).abs() < 0.02, "{height:?}");
}

/// No row shows a lateral acceleration, and the design does not have its channel. It is then taken from
/// the expected roll angle with 0.2 rad per g, which is less than what most loads have, so the bank
/// counts for more.
#[test]
fn without_a_lateral_acceleration_the_bank_counts_more() {
    let channels = [Channel::Steer, Channel::Suspension];
    let ratio = common::design().channels[0].lines[0][0].ratio_at(HEIGHT_M) * 1.489_6;
    let steer_rad = ROLL_RAD / ratio;
    let mut estimator = truck(channels, public().on_road(BANK_RAD)).estimator;
    for k in 0..1000_u64 {
        let sample = Sample {
            steer_rad,
            roll_rad: ROLL_RAD,
            speed_mps: 14.0,
            trailer_mass_kg: 31.3e3,
            ..Sample::absent(k * 10_000)
        };
        estimator.push(&sample).unwrap();
    }
    let found = estimator.finish().unwrap();
    check(&found.outcomes[0], BANK_RAD / (ROLL_RAD / 0.2));
    assert!(found.correlation.iter().flatten().all(|entry| entry.abs() <= 1.0));
    assert!(estimator.combined_height().unwrap().height_m.sd.is_finite());
}
