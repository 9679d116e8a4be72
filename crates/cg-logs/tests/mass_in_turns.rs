//! The mass and the speed of a height are those of its turns, and not those that the log ends with. Logs of the
//! independent truck, without noise, not calibrated.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{known, vehicle};
use cg_logs::calibrate::{CalibrateOptions, KnownLoad, KnownLog, calibrate};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_logs::log::LogRow;
use cg_vehicle::VehicleError;

const EMPTY_KG: f64 = 8_684.0;
const LADEN_KG: f64 = 23_684.0;

/// The rows of a log.
fn rows_of(name: &str) -> Vec<LogRow> {
    known().iter().find(|one| one.log.starts_with(name)).unwrap().rows()
}

/// The drive with 15 t up to its last straight second, and half a minute of straight driving, of which the last 20 s
/// have another mass.
fn then_with(trailer_mass_kg: f64) -> Vec<LogRow> {
    let mut rows = rows_of("F_drive1");
    let is_straight =
        |second: &[LogRow]| second.iter().all(|row| row.lateral_acceleration_mps2.abs() < 0.1);
    let straight = rows.windows(50).rposition(is_straight).unwrap();
    rows.truncate(straight + 50);
    let last = *rows.last().unwrap();
    rows.extend((1..1500_u32).map(|k| LogRow {
        time_s: last.time_s + 0.02 * f64::from(k),
        trailer_mass_kg: if k < 500 { LADEN_KG } else { trailer_mass_kg },
        ..last
    }));
    rows
}

fn estimate(rows: &[LogRow]) -> LogEstimate {
    let mut estimator =
        LogEstimator::new(&vehicle("kraz.toml"), EstimateOptions::default()).unwrap();
    for row in rows {
        estimator.push(row).unwrap();
    }
    estimator.finish()
}

#[test]
fn a_mass_that_begins_after_the_last_turn_is_not_known_in_it() {
    let mut rows = then_with(LADEN_KG);
    let known = estimate(&rows);
    let last = rows.len() - 1;
    rows[..last].iter_mut().for_each(|row| row.trailer_mass_kg = f64::NAN);
    let late = estimate(&rows);
    rows[last].trailer_mass_kg = f64::NAN;
    let none = estimate(&rows);
    let told = late.messages.join("; ");
    assert!(
        told.contains("trailer mass in the log begins after the last turn: 18684 kg"),
        "{told}"
    );
    // As without any, but for the last row.
    let height_m = [&late, &none].map(|one| one.height_m.unwrap());
    assert!((height_m[0] - height_m[1]).abs() < 1e-6, "{height_m:?}");
    assert_eq!(late.trailer_mass_kg.to_bits(), none.trailer_mass_kg.to_bits());
    let sd_m = [&late, &known].map(|one| one.height_sd_m.unwrap());
    assert!(sd_m[0] > 3.0 * sd_m[1], "{sd_m:?}");
}

#[test]
fn a_speed_that_begins_after_the_last_turn_is_told() {
    let mut rows = then_with(LADEN_KG);
    let last = rows.len() - 1;
    rows[..last].iter_mut().for_each(|row| row.speed_mps = f64::NAN);
    let told = estimate(&rows).messages.join("; ");
    assert!(told.contains("the speed in the log begins after the last turn"), "{told}");
    let mut rows = then_with(LADEN_KG);
    let seldom = rows.iter_mut().enumerate().filter(|(k, _)| k % 100 > 0); // of 50 a second
    seldom.for_each(|(_, row)| row.speed_mps = f64::NAN);
    let told = estimate(&rows).messages.join("; ");
    assert!(!told.contains("speed"), "{told}");
}

#[test]
fn a_height_keeps_the_mass_of_its_turns() {
    let [same, unloaded] = [LADEN_KG, EMPTY_KG].map(|mass_kg| estimate(&then_with(mass_kg)));
    let says =
        |one: &LogEstimate| one.messages.iter().any(|text| text.contains("at the end of the log"));
    assert!(!says(&same) && says(&unloaded), "{:?} {:?}", same.messages, unloaded.messages);
    for one in [&same, &unloaded] {
        assert!((one.trailer_mass_kg / LADEN_KG - 1.0).abs() < 1e-9, "{}", one.trailer_mass_kg);
    }
    let threshold_g = [&same, &unloaded].map(|one| one.static_rollover_threshold_g.unwrap());
    assert!((threshold_g[0] / threshold_g[1] - 1.0).abs() < 1e-9, "{threshold_g:?}");
}

/// A run is calibrated with the mass of its turns, and a log of two loads is refused.
#[test]
fn a_run_has_the_mass_of_its_turns() {
    let vehicle = vehicle("kraz.toml");
    let run = |rows: Vec<LogRow>, load: KnownLoad| {
        let logs = [KnownLog { log: "the.csv".to_owned(), load }];
        calibrate::<VehicleError>(&vehicle, CalibrateOptions::default(), &logs, |_, estimator| {
            for row in &rows {
                estimator.push(row).unwrap();
            }
            Ok(())
        })
    };
    let laden = KnownLoad::exact(1.55, None);
    let found = run(then_with(EMPTY_KG), laden).unwrap();
    assert!((found.run[0].trailer_mass_kg / LADEN_KG - 1.0).abs() < 1e-9);
    let told = run(then_with(EMPTY_KG), KnownLoad::Empty).unwrap_err().to_string();
    assert!(told.contains("the mass in the log is 23684 kg"), "{told}");
    let mut two = rows_of("A_p20_h190");
    let pause_s = two.last().unwrap().time_s + 100.0;
    two.extend(
        rows_of("A_p10_h170").iter().map(|row| LogRow { time_s: row.time_s + pause_s, ..*row }),
    );
    let told = run(two, laden).unwrap_err().to_string();
    assert!(told.contains("but a run has one load"), "{told}");
}

/// A log of 20 t; two minutes later one of 10 t, straight on for `straight_s` before its turn.
fn two_loads(straight_s: f64) -> Vec<LogRow> {
    let mut rows = rows_of("A_p20_h190");
    let (pause_s, next) = (rows.last().unwrap().time_s + 120.0, rows_of("A_p10_h170"));
    let step_s = next[1].time_s - next[0].time_s;
    let straight = (0..).map(|k| step_s * f64::from(k)).take_while(|s| *s < straight_s);
    rows.extend(straight.map(|s| LogRow { time_s: pause_s + s, ..next[0] }));
    let later_s = pause_s + straight_s - next[0].time_s;
    rows.extend(next.iter().map(|row| LogRow { time_s: row.time_s + later_s, ..*row }));
    rows
}

/// A mass that stands only where it changes is that of the load from then on, however long the truck drives before it turns.
#[test]
fn a_new_mass_after_a_pause_is_not_that_of_the_load_before() {
    for straight_s in [10.0, 60.0] {
        let mut rows = two_loads(straight_s);
        let known = estimate(&rows);
        let mut last_kg = f64::NAN;
        for row in &mut rows {
            let mass_kg = std::mem::replace(&mut row.trailer_mass_kg, f64::NAN);
            if mass_kg.to_bits() != last_kg.to_bits() {
                (row.trailer_mass_kg, last_kg) = (mass_kg, mass_kg);
            }
        }
        let found = estimate(&rows);
        let told = found.messages.join("; ");
        assert!(told.contains("the load changed before") && !told.contains("one before"), "{told}");
        let sd_m = [&found, &known].map(|one| one.height_sd_m.unwrap());
        assert!((sd_m[0] / sd_m[1] - 1.0).abs() < 0.01, "{sd_m:?}");
    }
}

/// A mass that comes after the first turns is no other load: they had that of the vehicle file and are left out.
#[test]
fn a_mass_that_comes_late_is_no_other_load() {
    let mut rows = rows_of("F_drive1");
    let middle_s = rows[rows.len() / 2].time_s;
    let early = rows.iter_mut().filter(|row| row.time_s < middle_s);
    early.for_each(|row| row.trailer_mass_kg = f64::NAN);
    let found = estimate(&rows);
    let told = found.messages.join("; ");
    assert!(told.contains("without a trailer mass, are left out"), "{told}");
    assert!(!told.contains("the load changed"), "{told}");
    assert!(found.height_m.is_some());
    let logs = [KnownLog { log: "the.csv".to_owned(), load: KnownLoad::exact(1.55, None) }];
    let vehicle = vehicle("kraz.toml");
    let run = calibrate::<VehicleError>(&vehicle, CalibrateOptions::default(), &logs, |_, one| {
        rows.iter().try_for_each(|row| one.push(row).map(drop)).unwrap();
        Ok(())
    });
    assert!((run.unwrap().run[0].trailer_mass_kg / LADEN_KG - 1.0).abs() < 1e-9);
}
