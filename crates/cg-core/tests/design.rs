//! Tests of a design: interpolation between its nodes, and validation.

#![allow(clippy::unwrap_used, clippy::float_cmp)] // copied values are unchanged

use crate::common::{PAIR, design, full_design};
use cg_core::truck::design::{MASSES, SPEEDS};
use cg_core::truck::ratio::solve_height;
use cg_core::{Channel, Design, DesignError, Measured, Reduced5};

use DesignError::{NotCovariance, NotFinite, NotIncreasing, NotPositive};

/// Access to one number of a design.
type Place = fn(&mut Design<f64, 2>) -> &mut f64;

/// The numbers that must be positive, with the name that the error contains.
const POSITIVE: [(&str, Place); 13] = [
    ("least_height_m", |d| &mut d.least_height_m),
    ("compensation", |d| &mut d.channels[1].compensation),
    ("spread of a ratio", |d| &mut d.spread[7][5].covariance[0][0]),
    ("spread of a ratio", |d| &mut d.spread[0][3].covariance[1][1]),
    ("rollover half_track_m", |d| &mut d.rollover.half_track_m),
    ("rollover unsprung_mass_kg", |d| &mut d.rollover.unsprung_mass_kg),
    ("rollover unsprung_height_m", |d| &mut d.rollover.unsprung_height_m),
    ("rollover tightest_turn_g", |d| &mut d.rollover.tightest_turn_g),
    ("rollover threshold", |d| &mut d.thresholds[5].threshold_g[1][7]),
    ("nominal_speed_mps", |d| &mut d.nominal_speed_mps),
    ("nominal_trailer_mass_kg", |d| &mut d.nominal_trailer_mass_kg),
    ("trailer_wheelbase_m", |d| &mut d.trailer_wheelbase_m),
    ("gravity_mps2", |d| &mut d.gravity_mps2),
];

/// Numbers on axes, with the name of the axis that the error contains.
const AXES: [(&str, Place); 5] = [
    ("speed_mps", |d| &mut d.speed_mps[7]),
    ("trailer_mass_kg", |d| &mut d.trailer_mass_kg[5]),
    ("least, reference and greatest height_m", |d| &mut d.least_height_m),
    ("least, reference and greatest height_m", |d| &mut d.reference_height_m),
    ("least, reference and greatest height_m", |d| &mut d.greatest_height_m),
];

fn with(place: Place, value: f64) -> Result<(), DesignError> {
    let mut changed = design();
    *place(&mut changed) = value;
    changed.validate()
}

#[test]
fn a_number_that_must_be_positive_is_named() {
    assert_eq!(design().validate(), Ok(()));
    for (name, place) in POSITIVE {
        assert_eq!(with(place, 0.0), Err(NotPositive(name)));
        assert_eq!(with(place, -1.0), Err(NotPositive(name)));
    }
    // The least height is also part of the axis of heights, which is checked first.
    for (name, place) in &POSITIVE[1..] {
        assert_eq!(with(*place, f64::NAN), Err(NotFinite(name)));
        assert_eq!(with(*place, f64::INFINITY), Err(NotFinite(name)));
    }
}

#[test]
fn a_lead_must_be_finite() {
    assert_eq!(with(|d| &mut d.path_lead.ahead_m, f64::NAN), Err(NotFinite("path_lead")));
    let slip: Place = |d| &mut d.path_lead.slip_s2_per_m;
    assert_eq!(with(slip, f64::INFINITY), Err(NotFinite("path_lead")));
    assert_eq!(with(slip, -0.01), Ok(()));
}

#[test]
fn an_axis_that_does_not_increase_is_named() {
    for (name, place) in AXES {
        assert_eq!(with(place, f64::NAN), Err(NotFinite(name)));
        assert_eq!(with(place, f64::INFINITY), Err(NotFinite(name)));
    }
    assert_eq!(with(AXES[0].1, 24.0), Err(NotIncreasing("speed_mps")));
    assert_eq!(with(AXES[1].1, 31e3), Err(NotIncreasing("trailer_mass_kg")));
    for ((name, place), beside) in AXES[2..].iter().zip([1.973, 3.0, 1.973]) {
        assert_eq!(with(*place, beside), Err(NotIncreasing(name)));
    }
    let axles = "rollover unsprung_mass_kg and least trailer_mass_kg";
    assert_eq!(with(POSITIVE[5].1, 8e3), Err(NotIncreasing(axles)));
}

#[test]
fn a_ratio_line_without_a_positive_ratio_is_refused() {
    let name = "ratio at the reference height";
    for (i, j) in [(0, 0), (SPEEDS - 1, MASSES - 1)] {
        for channel in PAIR {
            let changed = |value: f64| {
                let mut changed = design();
                changed.channels[channel.index()].lines[i][j].a1 = value;
                changed.validate()
            };
            assert_eq!(changed(-1.0), Err(NotPositive(name)));
            assert_eq!(changed(f64::NAN), Err(NotFinite(name)));
        }
    }
}

#[test]
fn an_unstable_model_names_its_channel() {
    for channel in PAIR {
        let mut changed = design();
        changed.channels[channel.index()].models[MASSES - 1].denominator[0] = -1.0;
        assert_eq!(changed.validate(), Err(DesignError::Unstable(channel)));
    }
}

#[test]
fn a_correlation_lies_between_minus_one_and_one() {
    let with = |correlation: f64| {
        let mut changed = design();
        let common = correlation * 0.013 * 0.013;
        (changed.spread[7][5].covariance[0][1], changed.spread[7][5].covariance[1][0]) =
            (common, common);
        changed.validate()
    };
    for value in [-1.0, 0.0, 1.0] {
        assert_eq!(with(value), Ok(()));
    }
    for value in [-1.001, 1.001, f64::NAN] {
        assert_eq!(with(value), Err(NotCovariance));
    }
}

#[test]
fn a_covariance_is_symmetric() {
    for (i, j) in [(0, 1), (1, 0)] {
        let mut changed = design();
        changed.spread[3][2].covariance[i][j] *= 1.001;
        assert_eq!(changed.validate(), Err(NotCovariance));
    }
}

#[test]
fn an_error_says_what_it_wants_of_which_field() {
    assert_eq!(NotFinite("x").to_string(), "x must be a finite number");
    assert_eq!(NotIncreasing("x").to_string(), "x must increase strictly");
    assert_eq!(NotPositive("x").to_string(), "x must be positive");
    assert!(NotCovariance.to_string().contains("symmetric covariance"));
    let unknown = DesignError::NoSuchChannel { index: 7 };
    assert_eq!(unknown.to_string(), "channel 7 is unknown or occurs twice");
    let unstable = DesignError::Unstable(Channel::LateralAcceleration).to_string();
    assert_eq!(unstable, "the reduced model of the lateral-acceleration channel is unstable");
}

#[test]
fn a_channel_has_an_index_a_place_and_a_name() {
    for (index, channel) in Channel::ALL.into_iter().enumerate() {
        assert_eq!(channel.index(), index);
        assert_eq!(design().place(channel), (index < 2).then_some(index));
        assert_eq!(design().channel(index), (index < 2).then_some(channel));
    }
    assert_eq!(format!("{:>7}", Channel::Steer), "  steer");
}

/// A design whose tables are exact: the ratio lines are cubic in speed and mass, everything else is
/// linear.
#[allow(clippy::cast_precision_loss)]
fn lawful() -> Design<f64, 2> {
    let mut design = design();
    for (i, speed) in design.speed_mps.into_iter().enumerate() {
        for (j, mass) in design.trailer_mass_kg.into_iter().enumerate() {
            for channel in PAIR {
                let line = &mut design.channels[channel.index()].lines[i][j];
                let factor = cubic(channel, speed, mass);
                (line.a0, line.a1) = (line.a0 * factor, line.a1 * factor);
            }
            design.spread[i][j].covariance = covariance(speed, mass);
        }
    }
    for (j, mass) in design.trailer_mass_kg.into_iter().enumerate() {
        for channel in &mut design.channels {
            channel.models[j].numerator[1] = 1e-3 * mass;
            channel.models[j].denominator[4] *= 1.0 + 1e-6 * mass;
        }
        design.thresholds[j].threshold_g = [[1e-5 * mass; 8]; 2];
    }
    design.validate().unwrap();
    design
}

/// All channels have their own lines, models and covariances.
fn distinct() -> Design<f64> {
    let mut design = full_design();
    for i in 0..4_u8 {
        let channel = &mut design.channels[usize::from(i)];
        channel.lines[2][3].a0 += f64::from(i);
        channel.models[1].numerator[2] += f64::from(i);
        channel.compensation += f64::from(i);
        for j in 0..4 {
            let common = if i == j { 1e-3 } else { 0.0 };
            let product = f64::from((i + 1) * (j + 1));
            design.spread[4][5].covariance[usize::from(i)][usize::from(j)] =
                common + 1e-4 * product;
        }
    }
    design.validate().unwrap();
    design
}

/// Covariances 1e-4 · 4 · 4 + 1e-3, 1e-4 · 4 · 2 and 1e-4 · 2 · 2 + 1e-3.
#[test]
fn a_chip_has_the_chosen_channels_in_the_chosen_order() {
    let design = distinct();
    let chosen = design.with_channels([Channel::Tractor, Channel::LateralAcceleration]).unwrap();
    assert_eq!(chosen.validate(), Ok(()));
    assert_eq!(chosen.channels, [design.channels[3], design.channels[1]]);
    assert_eq!([chosen.channels[0].index, chosen.channels[1].index], [3, 1]);
    let found = chosen.spread[4][5].covariance;
    let expected = [[2.6e-3, 8e-4], [8e-4, 1.4e-3]];
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    }
    assert_eq!(chosen.place(Channel::Tractor), Some(0));
    assert_eq!((chosen.place(Channel::Steer), chosen.channel(2)), (None, None));
    let line = |design: &Design<f64, 2>| design.line(Channel::Tractor, 14.0, 25e3);
    assert_eq!(line(&chosen), design.line(Channel::Tractor, 14.0, 25e3));
    assert_eq!(chosen.line(Channel::Steer, 14.0, 25e3), None);
    assert_eq!(chosen.compensation(Channel::Tractor), design.channels[3].compensation);
    assert_eq!(chosen.rollover, design.rollover);
    assert_eq!(design.with_channels(Channel::ALL), Some(design));
    assert_eq!(chosen.with_channels([Channel::Steer]), None);
    assert_eq!(chosen.with_channels([Channel::Tractor, Channel::Suspension]), None);
}

#[test]
fn a_channel_that_is_unknown_or_occurs_twice_is_refused() {
    for index in [0, 4, u32::MAX] {
        let mut changed = design();
        changed.channels[1].index = index;
        assert_eq!(changed.validate(), Err(DesignError::NoSuchChannel { index }));
    }
    let twice = full_design().with_channels([Channel::Steer, Channel::Steer]).unwrap();
    assert_eq!(twice.validate(), Err(DesignError::NoSuchChannel { index: 0 }));
}

/// At 6.5 m/s (half of 5 to 8) and 16 t (a fifth of 15 to 20), for covariances of 1, 2, 3 and 4
/// times the same one: 0.5 (0.8 · 1 + 0.2 · 2) + 0.5 (0.8 · 3 + 0.2 · 4) = 2.2.
#[test]
fn a_spread_between_four_corners_is_their_weighted_mean() {
    let mut design = full_design();
    for (i, j, times) in [(1, 1, 1.0), (1, 2, 2.0), (2, 1, 3.0), (2, 2, 4.0)] {
        let corner = &mut design.spread[i][j].covariance;
        *corner = corner.map(|row| row.map(|entry| entry * times));
    }
    let spread = design.spread(6.5, 16e3).unwrap();
    for place in 0..4 {
        assert!((spread.sd(place) - 0.013 * 2.2_f64.sqrt()).abs() < 1e-15);
        assert!((spread.correlation(0, place) - if place == 0 { 1.0 } else { 0.5 }).abs() < 1e-12);
    }
    assert_eq!((spread.sd(4), spread.correlation(0, 4)), (0.0, 0.0));
}

fn covariance(speed_mps: f64, mass_kg: f64) -> [[f64; 2]; 2] {
    let common = 1e-6 * speed_mps - 1e-10 * mass_kg;
    [[1e-5 * speed_mps, common], [common, 1e-9 * mass_kg]]
}

/// Cubic in the mass, and in the speed for the steer angle or in 1/U² for the lateral acceleration.
fn cubic(channel: Channel, speed_mps: f64, mass_kg: f64) -> f64 {
    let v = match channel {
        Channel::Steer => speed_mps / 30.0,
        _ => (2.0 / speed_mps).powi(2),
    };
    let m = mass_kg / 40e3;
    (1.0 + v - 0.5 * v * v + 0.3 * v * v * v) * (2.0 - m + 0.4 * m * m - 0.1 * m * m * m)
}

/// Points inside every cell and at its corners.
fn places() -> impl Iterator<Item = (f64, f64)> {
    let speeds = [2.0, 3.1, 5.0, 7.7, 9.5, 13.9, 16.0, 20.0, 29.0, 30.0];
    let masses = [8e3, 9e3, 15e3, 19e3, 24e3, 31.3e3, 40e3];
    speeds.into_iter().flat_map(move |speed| masses.map(|mass| (speed, mass)))
}

const OUTSIDE: [(f64, f64); 6] = [
    (1.99, 20e3),
    (30.01, 20e3),
    (10.0, 7.9e3),
    (10.0, 40.1e3),
    (f64::NAN, 20e3),
    (10.0, f64::NAN),
];

#[test]
fn ratio_lines_are_cubic_in_speed_or_curvature_and_mass() {
    let (design, plain) = (lawful(), design());
    for channel in PAIR {
        let flat = plain.channels[channel.index()].lines[0][0];
        for (speed, mass) in places() {
            let line = design.line(channel, speed, mass).unwrap();
            // Rounding of weights of order one: some tens of ε.
            let expected = flat.ratio_at(2.2) * cubic(channel, speed, mass);
            assert!((line.ratio_at(2.2) / expected - 1.0).abs() < 1e-13, "{speed} {mass}");
        }
        assert!(OUTSIDE.iter().all(|&(speed, mass)| design.line(channel, speed, mass).is_none()));
    }
}

#[test]
fn the_spread_is_linear_in_speed_and_mass() {
    let design = lawful();
    for (speed, mass) in places() {
        let spread = design.spread(speed, mass).unwrap();
        let law = covariance(speed, mass);
        let pairs = spread.covariance.into_iter().flatten().zip(law.into_iter().flatten());
        for (found, law) in pairs {
            assert!((found - law).abs() < 1e-18, "{speed} {mass}: {found} {law}");
        }
        let [[steer, common], [_, lateral]] = law;
        assert!((spread.sd(0) - steer.sqrt()).abs() < 1e-15);
        assert!((spread.sd(1) - lateral.sqrt()).abs() < 1e-15);
        let correlation = common / (steer * lateral).sqrt();
        assert!((spread.correlation(0, 1) - correlation).abs() < 1e-12);
    }
    assert!(OUTSIDE.iter().all(|&(speed, mass)| design.spread(speed, mass).is_none()));
}

#[test]
fn thresholds_are_linear_in_mass() {
    let design = lawful();
    for (_, mass) in places() {
        let rollover = design.rollover(Measured::exact(2.0), mass, 20.0).unwrap();
        let found = rollover.static_rollover_threshold_g.value;
        assert!((found - 1e-5 * mass).abs() < 1e-14, "{mass}: {found}");
    }
    for mass in [7.9e3, 40.1e3, f64::NAN] {
        assert!(design.rollover(Measured::exact(2.0), mass, 20.0).is_none());
    }
}

/// The thresholds extend over the heights of the design: the first is for the least height, the
/// last for the greatest.
#[test]
fn thresholds_run_from_the_least_to_the_greatest_height() {
    let design = design();
    let at = |height_m: f64| {
        let rollover = design.rollover(Measured::exact(height_m), 20e3, 20.0).unwrap();
        rollover.static_rollover_threshold_g.value
    };
    assert!((at(1.0) - 0.6).abs() < 1e-14 && (at(3.0) - 0.26).abs() < 1e-14);
}

#[test]
fn models_are_blended_in_mass_and_held_beyond_the_axis() {
    let mut design = lawful();
    design.channels[1].models = design.channels[1].models.map(|mut model| {
        model.numerator[5] = 7.0;
        model
    });
    for channel in PAIR {
        for (_, mass) in places().chain([(0.0, 5e3), (0.0, 60e3)]) {
            let model = design.model(channel.index(), mass).unwrap();
            let within = mass.clamp(8e3, 40e3);
            assert!((model.numerator[1] - 1e-3 * within).abs() < 1e-12, "{mass}");
            let law = 5.8858 * (1.0 + 1e-6 * within);
            assert!((model.denominator[4] - law).abs() < 1e-13, "{mass}");
            assert_eq!(model.numerator[5] == 7.0, channel == Channel::LateralAcceleration);
        }
    }
}

/// Most interpolated models between (s² + s/2 + 1)(s² + s/2 + 4)(s + 2) and (s² + s/2 + 16)(s² +
/// s/2 + 25)(s + 2) are unstable, although both models are stable.
#[test]
fn where_a_blend_is_unstable_the_nearer_model_serves() {
    let mut design = design();
    let low = [8.0, 9.0, 13.0, 7.25, 3.0];
    let high = [800.0, 441.0, 103.0, 43.25, 3.0];
    for (model, denominator) in design.channels[0].models[2..].iter_mut().zip([low, high]) {
        model.denominator = denominator;
    }
    let (light, heavy): (Reduced5<f64>, _) =
        (design.channels[0].models[2], design.channels[0].models[3]);
    for share in [0.3, 0.49, 0.51, 0.7] {
        assert!(!light.blend(&heavy, share).is_stable());
        let nearer = if share < 0.5 { light } else { heavy };
        assert_eq!(design.model(0, 20e3 + share * 5e3), Some(nearer), "{share}");
    }
    assert_eq!(design.model(0, 20e3), Some(light));
    assert_eq!(design.model(0, 25e3), Some(heavy));
    assert_eq!(design.model(2, 25e3), None);
}

#[test]
fn a_design_in_single_precision_is_the_same_design() {
    let design = lawful();
    assert_eq!(design.cast::<f64>(), design);
    let narrow = design.cast::<f32>();
    assert_eq!(narrow.gravity_mps2, 9.81_f32);
    // After the conversion to single precision, nothing more is lost.
    assert_eq!(narrow.cast::<f64>().cast::<f32>(), narrow);
}

/// The height changes by what two masses give for one ratio, more on the side of less mass. A mass beyond
/// the axis is not believed.
#[test]
fn a_heavier_trailer_needs_less_height_for_the_same_roll() {
    let mut design = design();
    let masses_kg = design.trailer_mass_kg;
    for row in design.channels.iter_mut().flat_map(|channel| &mut channel.lines) {
        for (line, mass_kg) in row.iter_mut().zip(masses_kg) {
            line.a0 *= mass_kg / 20e3;
            line.a1 *= mass_kg / 20e3;
        }
    }
    let (speed_mps, mass_kg, height_m) = (12.0, 22e3, 1.8);
    for channel in [Channel::Steer, Channel::LateralAcceleration] {
        let line = |mass_kg: f64| design.line(channel, speed_mps, mass_kg).unwrap();
        let ratio = Measured::exact(line(mass_kg).ratio_at(height_m));
        let height =
            |mass_kg| solve_height(&line(mass_kg), ratio, Measured::exact(1.0), 0.0).unwrap().value;
        let expected = (height(mass_kg - 2e3) - height_m) / 2.0;
        let sd = |sd_kg| {
            let mass = [mass_kg, sd_kg];
            design.mass_sd_m([channel].into_iter(), speed_mps, mass, height_m)
        };
        assert!((sd(1e3) / expected - 1.0).abs() < 1e-9, "{channel}: {} {expected}", sd(1e3));
        assert!(expected > (height_m - height(mass_kg + 2e3)) / 2.0);
        // An exact mass adds nothing at any height, however the solution is rounded.
        for step in 0..1000 {
            let height_m = 0.5 + 0.003 * f64::from(step);
            let sd_m = design.mass_sd_m([channel].into_iter(), speed_mps, [mass_kg, 0.0], height_m);
            assert!(sd_m < 1e-12, "{channel} {height_m}: {sd_m}");
        }
        // A trailer of 8 t would have to be higher than any is.
        assert!(!(height_m..design.greatest_height_m).contains(&height(masses_kg[0])));
        assert_eq!(sd(1e6), (design.greatest_height_m - height_m) / 2.0);
        let outside = design.mass_sd_m([channel].into_iter(), speed_mps, [60e3, 1e3], height_m);
        assert_eq!(outside, 0.0);
    }
}

/// A trailer of 20 t, of which 12 t are above the lightest mass of the design, whose c.g. is as high as the static
/// stability factor says: a payload 0.05 m beside the middle moves the c.g. by 0.03 m.
#[test]
fn the_threshold_is_uncertain_by_model_and_place_of_the_load() {
    let design = design();
    let at = |design: &Design<f64, 2>, sd: f64| {
        design.rollover(Measured { value: 2.0, sd }, 20e3, 20.0).unwrap()
    };
    let found = at(&design, 0.0);
    let threshold_g = found.static_rollover_threshold_g.value;
    let cg_m = design.rollover.half_track_m / found.static_stability_factor_g;
    assert!(threshold_g < 0.5);
    // At 20 m/s `1/U⁴` has 5.8 % of the way from 90 to 40 km/h behind it, and 0.6 % of the threshold are uncertain there.
    let [slow, here, fast] = [40.0, 72.0, 90.0_f64].map(|kmh| kmh.powi(-4));
    let by_turn = 0.006 * (here - fast) / (slow - fast);
    let expected = f64::hypot((0.015 + by_turn) * threshold_g, 0.03 / cg_m);
    assert!((found.static_rollover_threshold_g.sd / expected - 1.0).abs() < 1e-12);
    assert!((design.earlier_g(&found, 20e3, -0.1) + 0.06 / cg_m).abs() < 1e-12);
    // The height adds its own: the slope between 1.98 and 2.02 m, times its standard deviation.
    let sds = [0.1, 0.2].map(|sd| at(&design, sd).static_rollover_threshold_g.sd);
    let by_height = sds.map(|sd| (sd * sd - expected * expected).sqrt());
    assert!((by_height[1] / by_height[0] - 2.0).abs() < 1e-9 && by_height[0] > 0.0);
    for (beside_m, is_possible) in
        [(0.0, true), (-0.01, false), (f64::NAN, false), (f64::INFINITY, false)]
    {
        let valid = with(|d| &mut d.rollover.payload_beside_sd_m, beside_m);
        assert_eq!(valid.is_ok(), is_possible, "{beside_m} {valid:?}");
    }
}
