//! Tests of the combination of the heights of more than two channels.

#![allow(clippy::unwrap_used, clippy::float_cmp, clippy::panic, clippy::cast_precision_loss)] // one height is passed on unchanged; few heights

use cg_core::decide::combined::Heights;
use cg_core::{Combined, Height, Measured, Output};

use Output::{Roll, SuspensionRoll, TractorSuspensionRoll};

const APART: [Output; 3] = [Roll, SuspensionRoll, TractorSuspensionRoll];

/// A height with noise and a systematic part.
fn height(value: f64, random: f64, systematic: f64) -> Height<f64> {
    let height_m = Measured { value, sd: random.hypot(systematic) };
    Height { height_m, random_sd_m: random, maneuvers: 4 }
}

/// Heights whose systematic parts are independent.
fn heights<const C: usize>(found: [Height<f64>; C], outputs: [Output; C]) -> Heights<f64, C> {
    Heights { of_channels: found.map(Some), correlation: [[0.0; C]; C], outputs: outputs.map(Some) }
}

fn agreed<const C: usize>(heights: &Heights<f64, C>) -> Height<f64> {
    let Some(Combined::Agreed(height)) = heights.combined() else { panic!("they agree") };
    height
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}

/// Weights 1/3² : 1/4² : 1/6² = 16 : 9 : 4, and 0.12²/29 for the variance, no matter whether it is
/// noise or not.
#[test]
fn independent_heights_count_by_their_inverse_variance() {
    let mean_m = (16.0 * 1.9 + 9.0 * 2.0 + 4.0 * 1.95) / 29.0;
    let sd_m = 0.12 / 29.0_f64.sqrt();
    let systematic = [height(1.9, 0.0, 0.03), height(2.0, 0.0, 0.04), height(1.95, 0.0, 0.06)];
    let found = agreed(&heights(systematic, APART));
    close(found.height_m.value, mean_m);
    close(found.height_m.sd, sd_m);
    assert_eq!((found.random_sd_m, found.maneuvers), (0.0, 4));
    let noise = [height(1.9, 0.03, 0.0), height(2.0, 0.04, 0.0), height(1.95, 0.06, 0.0)];
    let found = agreed(&heights(noise, APART));
    close(found.height_m.value, mean_m);
    close(found.height_m.sd, sd_m);
    close(found.random_sd_m, sd_m);
}

/// Two channels with the same roll angle have the same noise, so the second adds nothing to the
/// first. The third has a fifth of the weight: 0.02²/(0.02² + 0.04²).
#[test]
fn the_noise_of_a_sensor_is_counted_once() {
    let noise = [height(2.0, 0.02, 0.0), height(2.01, 0.03, 0.0), height(2.05, 0.04, 0.0)];
    let found = agreed(&heights(noise, [Roll, Roll, SuspensionRoll]));
    close(found.height_m.value, 2.01);
    close(found.height_m.sd, 0.02 * 0.04 / 0.002_f64.sqrt());
    close(found.random_sd_m, found.height_m.sd);
    // With another roll angle, the second one counts too.
    assert!(agreed(&heights(noise, APART)).height_m.sd < found.height_m.sd - 1e-3);
}

/// Fully correlated systematic errors do not average out.
#[test]
fn a_common_error_remains() {
    let found = [height(2.0, 0.0, 0.03), height(2.0, 0.0, 0.03), height(2.0, 0.0, 0.03)];
    let heights = Heights { correlation: [[1.0; 3]; 3], ..heights(found, APART) };
    close(agreed(&heights).height_m.sd, 0.03);
}

/// The mean of the first two has half of the variance, 0.00045, so the difference to the third has
/// 0.00135.
#[test]
fn a_third_height_can_contradict_two_that_agree() {
    let beside = |deviations: f64| {
        let third = height(2.0 + deviations * 0.001_35_f64.sqrt(), 0.0, 0.031);
        let two = height(2.0, 0.0, 0.03);
        // 0.031² instead of 0.03² makes the third the last one.
        let variance: f64 = 0.000_45 + 0.031 * 0.031;
        (heights([third, two, two], APART).combined().unwrap(), 0.001_35 / variance)
    };
    let (combined, share) = beside(5.0);
    let Combined::Contradictory { chi_square, freedom } = combined else { panic!("{combined:?}") };
    assert_eq!(freedom, 2);
    close(chi_square, 25.0 * share);
    let (combined, share) = beside(3.5);
    let Combined::Doubtful { height, chi_square, freedom } = combined else {
        panic!("{combined:?}")
    };
    assert_eq!(freedom, 2);
    close(chi_square, 12.25 * share);
    // The standard deviation of the mean of three, wider by √(χ²/2).
    let sd_m = (1.0 / (2.0 / 0.0009 + 1.0 / 0.000_961_f64)).sqrt();
    close(height.height_m.sd, sd_m * (chi_square / 2.0).sqrt());
    assert!(matches!(beside(3.0).0, Combined::Agreed(_)));
}

/// Whichever of them is wrong: by 0.5 m where two have 0.03 m, by 1.2 m where one has 0.2 m.
#[test]
fn every_height_is_compared() {
    for (wrong, by_m) in [(0, 0.5), (1, 0.5), (2, 1.2)] {
        let mut found = [height(2.0, 0.0, 0.03), height(2.001, 0.0, 0.031), height(2.0, 0.0, 0.2)];
        assert!(matches!(heights(found, APART).combined(), Some(Combined::Agreed(_))));
        found[wrong].height_m.value += by_m;
        let combined = heights(found, APART).combined();
        assert!(matches!(combined, Some(Combined::Contradictory { .. })), "{wrong} {combined:?}");
    }
}

#[test]
fn the_order_of_the_channels_does_not_matter() {
    let found = [height(1.95, 0.01, 0.03), height(2.0, 0.02, 0.05), height(1.9, 0.03, 0.02)];
    let outputs = [Roll, Roll, SuspensionRoll];
    let correlation = [[1.0, 0.5, 0.2], [0.5, 1.0, -0.3], [0.2, -0.3, 1.0]];
    let combined = |order: [usize; 3]| {
        let heights = heights(order.map(|k| found[k]), order.map(|k| outputs[k]));
        agreed(&Heights { correlation: order.map(|i| order.map(|j| correlation[i][j])), ..heights })
    };
    let first = combined([0, 1, 2]);
    for order in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let other = combined(order);
        close(other.height_m.value, first.height_m.value);
        close(other.height_m.sd, first.height_m.sd);
        close(other.random_sd_m, first.random_sd_m);
    }
}

/// The limits of χ² for every number of heights: the last one is this far from the mean of the
/// others, which are equal.
#[test]
fn the_limits_are_those_of_the_degrees_of_freedom() {
    fn beside<const C: usize>(chi_square: f64) -> Combined<f64> {
        let others = C as f64 - 1.0;
        let far_m = (chi_square * 0.03 * 0.03 * (1.0 / others + 1.0)).sqrt();
        let mut found = [height(2.0, 0.0, 0.03); C];
        // A little less accurate, so that it is compared last.
        found[0] = height(2.0 + far_m, 0.0, 0.03 + 1e-9);
        heights(found, [Roll; C]).combined().unwrap()
    }
    fn check<const C: usize>(doubtful: f64, contradiction: f64) {
        let freedom = u32::try_from(C).unwrap() - 1;
        assert!(matches!(beside::<C>(doubtful - 1e-3), Combined::Agreed(_)));
        for chi in [doubtful + 1e-3, contradiction - 1e-3] {
            let found = beside::<C>(chi);
            assert!(matches!(found, Combined::Doubtful { freedom: f, .. } if f == freedom));
        }
        let found = beside::<C>(contradiction + 1e-3);
        assert!(matches!(found, Combined::Contradictory { freedom: f, .. } if f == freedom));
    }
    check::<2>(6.635, 15.137);
    check::<3>(9.210, 18.421);
    check::<4>(11.345, 21.108);
}

/// χ² of independent heights is `Σ (h − mean)²/σ²`, whichever of them is compared first. The
/// greatest of its two steps would depend on the order.
#[test]
fn the_verdict_does_not_depend_on_the_order_of_comparison() {
    let values = [1.95, 2.0, 2.09];
    let mean = values.iter().sum::<f64>() / 3.0;
    let known = values.iter().map(|h| (h - mean) * (h - mean) / (0.03 * 0.03)).sum::<f64>();
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        // The standard deviations differ so little that they only set the order.
        let found = [0, 1, 2].map(|k| height(values[order[k]], 0.0, 0.03 + 1e-10 * k as f64));
        let combined = heights(found, APART).combined();
        let Some(Combined::Doubtful { chi_square, freedom: 2, .. }) = combined else {
            panic!("{combined:?}")
        };
        assert!((chi_square - known).abs() < 1e-6, "{order:?} {chi_square} {known}");
    }
}

/// Only the correlation of the channels that have a height counts.
#[test]
fn absent_channels_have_no_part() {
    let (a, b) = (height(2.0, 0.02, 0.03), height(2.05, 0.01, 0.04));
    let outputs = [Roll, Roll, SuspensionRoll, TractorSuspensionRoll].map(Some);
    let mut correlation = [[0.9; 4]; 4];
    (correlation[1][3], correlation[3][1]) = (0.5, 0.5);
    let combined = |of_channels| Heights { of_channels, correlation, outputs }.combined();
    let two = Heights {
        correlation: [[1.0, 0.5], [0.5, 1.0]],
        ..heights([a, b], [Roll, SuspensionRoll])
    };
    assert_eq!(combined([None, Some(a), None, Some(b)]), two.combined());
    assert_eq!(combined([None; 4]), None);
    for place in 0..4 {
        let mut alone = [None; 4];
        alone[place] = Some(a);
        let Some(Combined::Agreed(found)) = combined(alone) else { panic!("alone") };
        assert_eq!((found.height_m.value, found.maneuvers), (2.0, 4));
        close(found.height_m.sd, a.height_m.sd);
        close(found.random_sd_m, 0.02);
    }
}
