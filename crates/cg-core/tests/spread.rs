//! A solution that is spread over samples is that which one sample would have made.

#![allow(clippy::unwrap_used)] // helpers of tests

use std::f64::consts::PI;

use crate::common::{EQ_5_12, Pair, design};
use cg_core::truck::simulation::Simulation;
use cg_core::{Estimator, FilteredArx, Maneuver, Prior, Reject, Sample, Settings};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

/// What comes otherwise than in the drive.
type Change = fn(&mut Sample<f64>);

type Onboard = Pair<f64, FilteredArx<f64>>;

/// A channel is solved in five stages, and the judgment of both comes in a call of its own. A sample does two of these eleven.
const SAMPLES: usize = 6;

/// The estimator of a truck whose dynamics change with the speed.
fn onboard(settings: Settings<f64>) -> Onboard {
    let mut design = design();
    for channel in &mut design.channels {
        for model in &mut channel.models {
            model.speed_slope = model.numerator.map(|a| 0.1 * a)[..5].try_into().unwrap();
        }
    }
    Estimator::new(design, settings, Prior::standard())
}

/// A drive along this steer angle as a function of time, with noise of the roll sensor.
fn drive(seconds: u32, interval_us: u32, steer: impl Fn(f64) -> f64) -> Vec<Sample<f64>> {
    let interval_s = 1e-6 * f64::from(interval_us);
    let mut plant = Simulation::new(&EQ_5_12, interval_s, 0.0);
    let mut noise = StdRng::seed_from_u64(7);
    (0..seconds * 1_000_000 / interval_us)
        .map(|k| {
            let steer_rad = steer(f64::from(k) * interval_s);
            let mut sample = Sample::absent(u64::from(k * interval_us));
            sample.steer_rad = steer_rad;
            sample.roll_rad = plant.push(steer_rad) + noise.random_range(-1e-3..1e-3);
            sample.speed_mps = 13.9;
            sample.lateral_acceleration_mps2 = 34.0 * steer_rad;
            sample.trailer_mass_kg = 30e3;
            sample
        })
        .collect()
}

/// Turns of eight seconds, with six of straight driving between them, which end a maneuver.
fn turns(t: f64) -> f64 {
    let phase = t % 14.0;
    if phase < 8.0 { 0.03 * (PI * phase / 8.0).sin() } else { 0.0 }
}

/// The maneuvers of a drive, each with the place of the sample that gave it.
fn maneuvers(mut onboard: Onboard, samples: &[Sample<f64>]) -> Vec<(usize, Maneuver<f64, 2>)> {
    let mut all = Vec::new();
    for (k, sample) in samples.iter().enumerate() {
        all.extend(onboard.push(sample).unwrap().closed.map(|closed| (k, closed)));
    }
    all.extend(onboard.finish().map(|closed| (samples.len(), closed)));
    all
}

/// Two estimates, of which the second lacks a share of the rows of the first, differ with the variance by which the second one's
/// is greater, which is that share of it. Four standard deviations are certain.
fn agree(a: &Maneuver<f64, 2>, b: &Maneuver<f64, 2>, share: f64) {
    for (a, b) in a.outcomes.iter().zip(&b.outcomes) {
        let (a, b) = (a.height_m.unwrap(), b.height_m.unwrap());
        assert!((a.value - b.value).abs() < 4.0 * share.sqrt() * a.sd, "{share}: {a:?} {b:?}");
    }
}

/// Without gaps, whatever the rate: the first maneuver to the last bit; the others lack the samples of the solution before
/// them.
#[test]
fn maneuvers_come_some_samples_later_and_are_the_same() {
    for (interval_us, rests) in [(10_000, 3), (25_000, 1), (50_000, 1)] {
        let samples = drive(70, interval_us, turns);
        let at_once = maneuvers(onboard(Settings::truck()), &samples);
        let spread = maneuvers(onboard(Settings::truck().spread()), &samples);
        assert_eq!((at_once.len(), spread.len()), (5, 5), "{interval_us}");
        assert_eq!(format!("{:?}", at_once[0].1), format!("{:?}", spread[0].1), "{interval_us}");
        // Of each mean, the sample that completes it only takes the mean, unless it is alone.
        let most = SAMPLES + SAMPLES.div_ceil(rests);
        for ((once, a), (later, b)) in at_once.iter().zip(&spread).take(4) {
            let samples = later - once;
            assert!((SAMPLES..=most).contains(&samples), "{interval_us}: {samples}");
            assert_eq!(a.end_us, b.end_us);
            agree(a, b, f64::from(u32::try_from(most).unwrap() * interval_us) / 14e6);
        }
    }
}

/// A long turn is cut after forty seconds. The samples of the solution are missing in the next part.
#[test]
fn a_turn_goes_on_while_it_is_solved() {
    let samples = drive(130, 10_000, |t| 0.03 * (t / 3.0).sin());
    let at_once = maneuvers(onboard(Settings::truck()), &samples);
    let spread = maneuvers(onboard(Settings::truck().spread()), &samples);
    assert_eq!((at_once.len(), spread.len()), (4, 4));
    for ((_, a), (_, b)) in at_once.iter().zip(&spread).take(3) {
        agree(a, b, 8.0 / 4000.0);
    }
}

/// The first sample after which a maneuver is being solved, and the estimator with it.
fn solving(samples: &[Sample<f64>]) -> (Onboard, usize) {
    let first = maneuvers(onboard(Settings::truck()), samples)[0].0;
    let mut estimator = onboard(Settings::truck().spread());
    for sample in &samples[..=first] {
        assert!(estimator.push(sample).unwrap().closed.is_none());
    }
    (estimator, first + 1)
}

/// Gaps, missing and impossible values, another mass, another speed, another road, and the end of the drive.
#[test]
fn nothing_that_comes_meanwhile_changes_the_solution() {
    let samples = drive(30, 10_000, turns);
    let (estimator, next) = solving(&samples);
    let mut at_once = onboard(Settings::truck());
    let closed = samples[..next].iter().filter_map(|one| at_once.push(one).unwrap().closed);
    let expected = format!("{:?}", closed.last().unwrap());
    let changes: [(&str, Change); 8] = [
        ("nothing", |_| {}),
        ("a gap", |sample| sample.time_us += 3_000_000),
        ("no roll angle", |sample| sample.roll_rad = f64::NAN),
        ("no input", |sample| {
            (sample.steer_rad, sample.lateral_acceleration_mps2) = (f64::NAN, f64::NAN);
        }),
        ("impossible values", |sample| (sample.roll_rad, sample.steer_rad) = (1e9, -1e9)),
        ("another mass", |sample| sample.trailer_mass_kg = 12e3),
        ("another speed", |sample| sample.speed_mps = 3.0),
        ("a turn", |sample| (sample.steer_rad, sample.lateral_acceleration_mps2) = (0.1, 3.4)),
    ];
    for (what, change) in changes {
        let mut estimator = estimator;
        let mut later = samples[next..].iter().copied();
        let found = later.find_map(|mut sample| {
            change(&mut sample);
            estimator.push(&sample).unwrap().closed
        });
        assert_eq!(format!("{:?}", found.unwrap()), expected, "{what}");
        assert!(samples.len() - next - later.len() < 12, "{what}");
        // It goes on as a drive does after such a change.
        for sample in later {
            let _ = estimator.push(&sample);
        }
        assert!(estimator.finish().is_some(), "{what}");
    }
    let mut ended = estimator;
    assert_eq!(format!("{:?}", ended.finish().unwrap()), expected);
    assert!(ended.finish().is_none());
}

/// A channel whose input begins with the first sample of the solution is absent from the maneuver.
#[test]
fn a_channel_that_comes_meanwhile_is_not_of_the_maneuver() {
    let mut samples = drive(30, 50_000, turns);
    let first = maneuvers(onboard(Settings::truck()), &samples)[0].0;
    for sample in &mut samples[..=first] {
        sample.lateral_acceleration_mps2 = f64::NAN;
    }
    let at_once = maneuvers(onboard(Settings::truck()), &samples);
    let spread = maneuvers(onboard(Settings::truck().spread()), &samples);
    assert_eq!(at_once[0].0, first);
    assert_eq!(at_once[0].1.outcomes[1].height_m, Err(Reject::Absent));
    assert_eq!(format!("{:?}", at_once[0].1), format!("{:?}", spread[0].1));
}

/// The mass that ends a maneuver, because it lasts, is that of the next one.
#[test]
fn another_mass_is_used_after_the_solution() {
    let mut samples = drive(60, 10_000, |t| 0.03 * (t / 3.0).sin());
    for sample in &mut samples[1500..] {
        sample.trailer_mass_kg = 20e3;
        sample.time_us += 1_000_000; // a gap, in which it was loaded
    }
    let at_once = maneuvers(onboard(Settings::truck()), &samples);
    let spread = maneuvers(onboard(Settings::truck().spread()), &samples);
    assert!((14_950_000..15_000_000).contains(&at_once[0].1.end_us), "{}", at_once[0].1.end_us);
    assert_eq!(format!("{:?}", at_once[0].1), format!("{:?}", spread[0].1));
    let masses: Vec<f64> = spread.iter().map(|(_, one)| one.trailer_mass_kg).collect();
    // The last four of 1500 samples have the mass of the next one, 10 t less.
    assert!((masses[0] - 30e3).abs() < 27.0 && (masses[1] - 20e3).abs() < 1.0, "{masses:?}");
}
