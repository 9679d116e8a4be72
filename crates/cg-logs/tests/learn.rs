//! A truck learns itself from trips with the empty trailer, and from nothing else.
#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common::{calibrated, known, largest, rms, runs_of, vehicle};
use cg_core::{Channel, Measured};
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::learn::{EmptyTrip, Learned, Learner, Taken};
use cg_logs::log::LogRow;
use cg_vehicle::belief::{Belief, Deviations, Parameter};
use cg_vehicle::calibration::{Calibration, Procedure, Run, fit};
use cg_vehicle::design::design_with;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::linear::ratio_line;
use cg_vehicle::sensor_places::Road;
use cg_vehicle::wind::Wind;
use cg_vehicle::{Load, Variant, Vehicle};

const DAY_S: f64 = 86_400.0;

/// What becomes of a log whose rows and options are changed.
fn learned_from(
    name: &str,
    options: EstimateOptions,
    change: impl Fn(&mut LogRow),
) -> (Vec<Taken>, Learned) {
    learned_by(&vehicle("kraz.toml"), name, options, change)
}

fn learned_by(
    truck: &Vehicle,
    name: &str,
    options: EstimateOptions,
    change: impl Fn(&mut LogRow),
) -> (Vec<Taken>, Learned) {
    let known = known().into_iter().find(|known| known.log.starts_with(name)).unwrap();
    let options = options.with_file(truck);
    let mut log = LogEstimator::new(truck, options).unwrap();
    for mut row in known.rows() {
        change(&mut row);
        log.push(&row).unwrap();
    }
    let design = *log.design();
    let mut learner = Learner::new(truck, Variant::Complete, Learned::default());
    let taken = learner.log(log).unwrap();
    (taken, learner.learned(&design))
}

fn plain(name: &str) -> (Vec<Taken>, Learned) {
    learned_from(name, EstimateOptions::default(), |_| {})
}

/// As well as a calibration with the same run does: within 1.0 % rms and 3 % at worst.
#[test]
fn an_empty_trip_makes_the_other_logs_true() {
    let truck = vehicle("kraz.toml");
    let (taken, learned) = plain("A_p00");
    assert_eq!(taken, [Taken::Learned(1)]);
    let design = learned.design(&truck, Variant::Complete, 20.0).unwrap().unwrap();
    let mut errors = Vec::new();
    for known in known().iter().filter(|known| !known.log.starts_with("A_p00")) {
        let estimate = known.estimate(&design, None, EstimateOptions::default());
        let (height_m, [low_m, high_m]) =
            (estimate.height_m.unwrap(), estimate.height_ci95_m.unwrap());
        let truth_m = known.load.cg_height_m;
        println!("{:28} {:+.2} %", known.log, 100.0 * (height_m / truth_m - 1.0));
        assert!((low_m..=high_m).contains(&truth_m), "{}", known.log);
        errors.push(height_m / truth_m - 1.0);
    }
    assert!(rms(&errors) <= 0.01 && largest(&errors) <= 0.03, "{}", rms(&errors));
}

/// With the side of a box body, the trip's ratios are as much less certain as those of the same log in a calibration: by several
/// percent, because the log is one turn.
#[test]
fn a_side_wind_is_in_the_ratios_of_trips_and_of_runs() {
    let plain = vehicle("kraz.toml");
    let mut boxed = plain.clone();
    boxed.wind = Some(Wind { side_area_m2: 36.0, side_height_m: 2.4, speed_mps: 3.0 });
    let place = Channel::LateralAcceleration.index();
    let [without, with] = [plain, boxed].map(|truck| {
        let options = EstimateOptions::default();
        let (_, learned) = learned_by(&truck, "A_p00", options, |_| {});
        let trip = learned.runs(&truck, 20.0)[0].ratio[place].unwrap();
        let known = known().into_iter().find(|known| known.log.starts_with("A_p00")).unwrap();
        let mut log = LogEstimator::new(&truck, options.with_file(&truck)).unwrap();
        for row in known.rows() {
            log.push(&row).unwrap();
        }
        [trip, log.identified().ratio[place].unwrap()].map(|ratio| ratio.sd / ratio.value)
    });
    // What the wind adds to that of the trip, and to that of the run.
    let by_wind = [0, 1].map(|k| (with[k].powi(2) - without[k].powi(2)).sqrt());
    println!("{by_wind:?}");
    assert!(by_wind[1] > 0.02 && by_wind[1] < 0.2, "{by_wind:?}");
    // Both refer to nearly the same speed and height.
    assert!((by_wind[0] / by_wind[1] - 1.0).abs() < 0.1, "{by_wind:?}");
}

/// The empty trailer of this truck has 8684 kg. A scale that shows a little less has weighed the empty trailer.
#[test]
fn the_mass_must_be_that_of_the_empty_trailer_within_three_percent() {
    for (share, expected) in [(1.029, 1), (0.997, 1), (0.975, 1), (1.031, 0), (0.96, 0)] {
        let (taken, _) = learned_from("A_p00", EstimateOptions::default(), |row| {
            row.trailer_mass_kg *= share;
        });
        assert_eq!(taken.len(), expected, "{share}");
    }
    for name in ["A_p10", "A_p20_h150", "B_p15", "F_drive1"] {
        let (taken, learned) = plain(name);
        assert!(taken.is_empty() && learned.is_empty(), "{name}: {taken:?}");
    }
}

/// A laden trailer that is said to be empty, and a mass that no signal gives.
#[test]
fn only_a_signal_says_that_the_trailer_is_empty() {
    let empty_kg = vehicle("kraz.toml").empty_trailer_mass_kg();
    let given = EstimateOptions { trailer_mass_kg: Some(empty_kg), ..EstimateOptions::default() };
    for name in ["A_p00", "A_p20_h190"] {
        let (taken, learned) = learned_from(name, given, |_| {});
        assert!(taken.is_empty() && learned.is_empty(), "{name}: {taken:?}");
    }
    // The nominal mass of the file is that of the empty trailer.
    let mut truck = vehicle("kraz.toml");
    truck.trailer.reference_mass_kg = empty_kg;
    let mut log = LogEstimator::new(&truck, EstimateOptions::default()).unwrap();
    for row in known().iter().find(|known| known.log.starts_with("A_p00")).unwrap().rows() {
        log.push(&LogRow { trailer_mass_kg: f64::NAN, ..row }).unwrap();
    }
    let mut learner = Learner::new(&truck, Variant::Complete, Learned::default());
    assert_eq!(learner.log(log).unwrap(), []);
}

/// A wrong sign gives no height; a roundabout changes the ratios by the articulation.
#[test]
fn rejected_and_slow_maneuvers_do_not_count() {
    let usual = EstimateOptions::default;
    let (taken, learned) = learned_from("A_p00", usual(), |row| row.roll_rad = -row.roll_rad);
    assert!(taken.is_empty() && learned.is_empty(), "{taken:?}");
    let (taken, learned) = learned_from("A_p00", usual(), |row| row.speed_mps *= 0.7);
    assert!(taken.is_empty() && learned.is_empty(), "{taken:?}");
}

/// A stiff truck rolls so little that the height of its empty trailer would be impossible. It teaches
/// that it is stiff, unless the bank of the road may be the cause.
#[test]
fn an_impossible_height_teaches_only_where_no_bank_can_cause_it() {
    for (bank_sd_rad, expected) in [(0.0, 1), (0.0005, 0)] {
        let mut truck = vehicle("kraz.toml");
        truck.height.least_m = 1.3;
        truck.road = Some(Road { bank_sd_rad });
        let (taken, _) = learned_by(&truck, "A_p00", EstimateOptions::default(), |row| {
            row.roll_to_gravity_rad = 0.93 * row.roll_rad;
            row.roll_rad = f64::NAN;
        });
        assert_eq!(taken.len(), expected, "{bank_sd_rad}: {taken:?}");
    }
}

/// The trailer is laden but its signal says that it is empty: beyond chance for the vehicle file, so it
/// is not learned, however often.
#[test]
fn a_wrong_signal_is_not_learned() {
    let truck = vehicle("kraz.toml");
    for name in ["A_p10_h170", "A_p20_h220"] {
        let (taken, learned) = learned_from(name, EstimateOptions::default(), |row| {
            row.trailer_mass_kg = truck.empty_trailer_mass_kg();
        });
        assert_eq!((taken, learned.trips()), (vec![Taken::Waiting], 0), "{name}");
    }
    let mut learned = Learned::default();
    let trip = exact(&truck, &deviations(-0.9), 10.0);
    for _ in 0..3 {
        assert_eq!(learned.take(&truck, Variant::Complete, trip.clone()).unwrap(), Taken::Waiting);
    }
    assert!(learned.design(&truck, Variant::Complete, 10.0).unwrap().is_none());
}

/// A truck whose springs are stiffer by this logarithm.
fn deviations(stiffer: f64) -> Deviations {
    let mut deviations = Deviations::zeros();
    for parameter in [Parameter::TrailerRollStiffness, Parameter::TractorRollStiffness] {
        deviations[parameter as usize] = stiffer;
    }
    deviations
}

fn ratios(truck: &Vehicle, deviations: &Deviations, load: Load) -> [f64; 4] {
    let belief = Belief { mean: *deviations, ..Belief::prior(truck) };
    let lines = ratio_line(&belief.applied_to(truck), Variant::Complete, 18.0, load).unwrap();
    Channel::ALL
        .map(|channel| belief.gain(channel) * lines[channel.index()].ratio_at(load.cg_height_m))
}

/// A trip of a truck that deviates from its file, exact to 0.2 %.
fn exact(truck: &Vehicle, deviations: &Deviations, date_s: f64) -> EmptyTrip {
    let (trailer_mass_kg, cg_height_m) =
        (truck.empty_trailer_mass_kg(), truck.trailer.tare.cg_height_m);
    let ratio = ratios(truck, deviations, Load { trailer_mass_kg, cg_height_m })
        .map(|value| Some(Measured { value, sd: 0.002 * value }));
    let lift_axle = LiftAxle::Down;
    EmptyTrip { date_s, speed_mps: 18.0, trailer_mass_kg, ratio, maneuvers: 5, lift_axle }
}

/// Springs that lose 15 % in a year are followed; a jump by 15 % in a day is a change of the truck.
#[test]
fn wear_is_followed_and_a_sudden_change_forgets_the_earlier_trips() {
    let truck = vehicle("kraz.toml");
    let mut learned = Learned::default();
    let mut take = |stiffer: f64, day: u32| {
        let date_s = f64::from(day) * DAY_S;
        let trip = exact(&truck, &deviations(stiffer), date_s);
        let taken = learned.take(&truck, Variant::Complete, trip).unwrap();
        assert_eq!(learned.contradiction().is_some(), taken == Taken::Waiting, "day {day}");
        taken
    };
    for day in (0..=360).step_by(24) {
        let taken = take(0.85_f64.ln() * f64::from(day) / 365.0, day);
        assert!(matches!(taken, Taken::Learned(1..=12)), "day {day}: {taken:?}");
    }
    let worn = 0.85_f64.ln();
    // One trip may be a mistake.
    assert_eq!(take(worn + 0.15, 361), Taken::Waiting);
    assert_eq!(take(worn, 362), Taken::Learned(12));
    assert_eq!(take(worn + 0.15, 363), Taken::Waiting);
    assert_eq!(take(worn - 0.15, 364), Taken::Waiting);
    assert_eq!(take(worn + 0.15, 365), Taken::Waiting);
    assert_eq!(take(worn + 0.15, 366), Taken::Forgotten(12));
    assert_eq!(take(worn + 0.15, 367), Taken::Learned(3));
    assert_eq!(learned.trips(), 3);
}

/// A clock that begins in 1970 says nothing of what the truck became until today: an impossible trip after it stays impossible.
#[test]
fn a_trip_of_a_clock_that_was_not_set_lets_no_other_one_in() {
    let truck = vehicle("kraz.toml");
    let today = 20_700; // days since 1970
    for first_day in [today - 30, 0] {
        let mut learned = Learned::default();
        let mut take = |stiffer: f64, day: u32| {
            let trip = exact(&truck, &deviations(stiffer), f64::from(day) * DAY_S);
            learned.take(&truck, Variant::Complete, trip).unwrap()
        };
        assert_eq!(take(0.0, first_day), Taken::Learned(1));
        assert_eq!(take(-0.5, today), Taken::Waiting, "{first_day}");
        assert_eq!(take(0.0, today + 1), Taken::Learned(2), "{first_day}");
    }
}

/// The first trips tell what the truck was, so a change is wear. They must not be dropped.
#[test]
fn of_many_trips_the_first_and_the_last_ones_are_kept() {
    let truck = vehicle("kraz.toml");
    let mut learned = Learned::default();
    for day in 0..60_u32 {
        let trip = exact(&truck, &deviations(0.0), f64::from(day) * DAY_S);
        learned.take(&truck, Variant::Complete, trip).unwrap();
    }
    let ages: Vec<f64> =
        learned.runs(&truck, 59.0 * DAY_S).iter().map(|run| run.age_s.unwrap() / DAY_S).collect();
    println!("{ages:?}");
    assert_eq!((ages.len(), ages[0]), (12, 59.0));
    assert_eq!(ages[9..], [2.0, 1.0, 0.0]);
    assert!(ages.windows(2).all(|pair| pair[0] > pair[1]));
}

/// Over trucks drawn from the prior that wander at the stated rate, the squared error of what is known
/// today of a laden trailer's ratio, divided by its variance, is one; also half a year after the last
/// trip. Without the walk it is several times as large.
#[test]
fn what_is_known_today_holds() {
    use rand::{SeedableRng, rngs::StdRng};
    use rand_distr::{Distribution, StandardNormal};
    let mut truck = vehicle("kraz.toml");
    truck.uncertainty.residual_sd = 0.0; // the ratios below have none
    let prior = Belief::prior(&truck);
    let sd = Deviations::from_fn(|k, _| prior.covariance[(k, k)].sqrt());
    let mut source = StdRng::seed_from_u64(5);
    let mut normal = || -> f64 { StandardNormal.sample(&mut source) };
    let laden = Load { trailer_mass_kg: 25e3, cg_height_m: 1.8 };
    let (trucks, days) = (40_u32, [0.0, 30.0, 180.0, 365.0]);
    let (mut today, mut later, mut narrowed) = ([0.0; 4], [0.0; 4], 0.0);
    for _ in 0..trucks {
        let mut now = prior.drawn(&mut normal);
        let mut learned = Learned::default();
        let mut day_before = 0.0;
        let mut wander = |now: &mut Deviations, days: f64| {
            for parameter in Parameter::ALL.into_iter().filter(|one| one.is_factor()) {
                let k = parameter as usize;
                // In four years as far as the prior reaches.
                now[k] += sd[k] * (days / (4.0 * 365.25)).sqrt() * normal();
            }
        };
        for day in days {
            wander(&mut now, day - day_before);
            day_before = day;
            let trip = exact(&truck, &now, day * DAY_S);
            learned.take(&truck, Variant::Complete, trip).unwrap();
        }
        let squares = |now: &Deviations, sums: &mut [f64; 4], day: f64| -> f64 {
            let found = learned.belief(&truck, Variant::Complete, day * DAY_S).unwrap();
            let Some(belief) = found else { return f64::NAN };
            let covariance =
                belief.ratio_covariance(&truck, Variant::Complete, 18.0, laden).unwrap();
            let (is, expected) = (ratios(&truck, now, laden), ratios(&truck, &belief.mean, laden));
            for k in 0..4 {
                sums[k] +=
                    (is[k] / expected[k]).ln().powi(2) / covariance[k][k] / f64::from(trucks);
            }
            covariance[1][1].sqrt()
        };
        let known = squares(&now, &mut today, 365.0);
        wander(&mut now, 180.0);
        let wider = squares(&now, &mut later, 545.0);
        assert!(wider > 1.1 * known, "{known} {wider}");
        let before = prior.ratio_covariance(&truck, Variant::Complete, 18.0, laden).unwrap();
        narrowed += known / before[1][1].sqrt() / f64::from(trucks);
    }
    println!("today {today:.2?}, later {later:.2?}, narrowed to {narrowed:.2}");
    // χ² with 40 degrees of freedom: below 0.51 and above 1.71 of its mean with 0.2 % each.
    for square in today.into_iter().chain(later) {
        assert!((0.51..=1.71).contains(&square), "{today:?} {later:?}");
    }
    assert!(narrowed < 0.5, "{narrowed}");
}

/// A truck whose springs are stiffer than in its file, calibrated with a load, makes an empty trip: it is
/// then known as if both were runs of one calibration. The older the calibration is, the less.
#[test]
fn a_trip_moves_a_calibration_as_another_run_does() {
    let truck = vehicle("kraz.toml");
    let deviations = deviations(0.08);
    let runs = runs_of(&truck, &deviations, &[(28_684.0, 1.9, 13.9)]);
    let fitted =
        |runs: &[Run]| fit(&truck, Variant::Complete, Procedure::MaximumAPosteriori, runs).unwrap();
    let first = fitted(&runs);
    let mut calibration = Calibration::new(&truck, Variant::Complete, &runs, &first).unwrap();
    let trip = exact(&truck, &deviations, 365.25 * DAY_S);
    let moved = |calibration: &Calibration| {
        let mut learned = Learned::default().on(Some(calibration));
        let taken = learned.take(&truck, Variant::Complete, trip.clone()).unwrap();
        assert_eq!(taken, Taken::Learned(1));
        learned.belief(&truck, Variant::Complete, trip.date_s).unwrap().unwrap()
    };
    let without_age = moved(&calibration);
    let mut of_file = Learned::default();
    of_file.take(&truck, Variant::Complete, trip.clone()).unwrap();
    let together = fitted(&[&runs[..], &of_file.runs(&truck, trip.date_s)].concat());
    let sd = |belief: &Belief, k: usize| belief.covariance[(k, k)].sqrt();
    for parameter in Parameter::ALL {
        let k = parameter as usize;
        let (one, both) = (sd(&without_age, k), sd(&together.belief, k));
        let apart = without_age.mean[k] - together.belief.mean[k];
        // The difference is where the ratios were linearized.
        assert!((one - both).abs() <= 0.02 * both, "{parameter:?} {one} {both}");
        assert!(apart.abs() <= 0.05 * both, "{parameter:?} {apart} {both}");
    }
    let stiffness = Parameter::TrailerRollStiffness as usize;
    assert!(sd(&without_age, stiffness) < 0.95 * sd(&first.belief, stiffness));
    calibration.date = "1970-01-01T00:00:00Z".to_owned(); // a year before the trip
    assert!(sd(&moved(&calibration), stiffness) > 1.01 * sd(&without_age, stiffness));
    // What contradicts the calibration waits, although the vehicle file allows it.
    let mut learned = Learned::default().on(Some(&calibration));
    let other = exact(&truck, &self::deviations(-0.15), 30.0 * DAY_S);
    assert_eq!(learned.take(&truck, Variant::Complete, other.clone()).unwrap(), Taken::Waiting);
    assert_eq!(of_file.take(&truck, Variant::Complete, other).unwrap(), Taken::Waiting);
    // A trip that the calibration contains does not count again.
    let contained = of_file.runs(&truck, trip.date_s);
    let calibration =
        Calibration::new(&truck, Variant::Complete, &contained, &fitted(&contained)).unwrap();
    let learned = of_file.on(Some(&calibration));
    assert!(learned.belief(&truck, Variant::Complete, trip.date_s).unwrap().is_none());
}

/// Calibrated on 20 t, the independent truck differs on its empty trip by as much as its residual allows.
#[test]
fn an_independent_truck_learns_on_top_of_its_calibration() {
    let truck = vehicle("kraz.toml");
    let all = known();
    let pick = |name: &str| all.iter().find(|known| known.log.starts_with(name)).unwrap();
    let calibration = calibrated(&truck, &[pick("A_p20_h190")]);
    let (_, of_file) = plain("A_p00");
    let learned = of_file.on(Some(&calibration));
    let design = learned.design(&truck, Variant::Complete, 16.99).unwrap().unwrap();
    let before = design_with(&truck, Variant::Complete, &calibration.belief()).unwrap();
    let (mut errors, mut narrower) = (Vec::new(), 0.0);
    let others = ["A_p10", "A_p20_h150", "A_p20_h220", "B_p15", "C_p15", "D_p15", "E_p15"];
    for name in others {
        let known = pick(name);
        let [with, without] =
            [&design, &before].map(|one| known.estimate(one, None, EstimateOptions::default()));
        let error = with.height_m.unwrap() / known.load.cg_height_m - 1.0;
        println!("{name} {:+.2} %", 100.0 * error);
        errors.push(error);
        narrower += with.height_sd_m.unwrap() / without.height_sd_m.unwrap() / 7.0;
    }
    println!("{:.2} % rms, narrowed to {narrower:.2}", 100.0 * rms(&errors));
    assert!(rms(&errors) <= 0.01 && largest(&errors) <= 0.02 && narrower < 0.95, "{errors:?}");
}
