//! The calibration file: what is read is what was written, for the truck it was written for.
#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;
use crate::common::{runs_of, vehicle};
use cg_vehicle::belief::Deviations;
use cg_vehicle::calibration::{Calibration, Part, Procedure, fit};
use cg_vehicle::files::{sealed, unsealed};
use cg_vehicle::{Variant, Vehicle};

const CHECKSUM: &str = "# crc32 ";

/// A calibration with an empty and a laden run of a truck that differs from its file.
fn calibration(vehicle: &Vehicle) -> Calibration {
    let truth = Deviations::from_fn(|k, _| if k % 3 == 1 { 0.01 } else { -0.02 });
    let runs = runs_of(vehicle, &truth, &[(8_684.0, 1.33, 13.9), (28_684.0, 1.9, 13.9)]);
    let fitted = fit(vehicle, Variant::Complete, Procedure::default(), &runs).unwrap();
    Calibration::new(vehicle, Variant::Complete, &runs, &fitted).unwrap()
}

/// Something that may differ from the vehicle of a calibration.
type Change = fn(&mut Vehicle);

/// The message with which a text is refused.
fn refused(text: &str, vehicle: &Vehicle) -> String {
    let read = Calibration::parse(text, "c.toml", vehicle).map(|_| ());
    let error = read.unwrap_err().to_string();
    assert!(error.starts_with("c.toml: "), "{error}");
    error
}

/// The same file with another line in place of the one that begins so, and with a correct checksum.
fn with_line(text: &str, begins: &str, line: &str) -> String {
    let content = unsealed(text, CHECKSUM).unwrap();
    let old = content.lines().find(|old| old.starts_with(begins)).unwrap();
    assert_ne!(old, line);
    sealed(&content.replacen(old, line, 1), CHECKSUM)
}

/// The same file with another covariance.
fn with_covariance(text: &str, covariance: &[Vec<f64>]) -> String {
    let line = format!("covariance = {covariance:?}").replace("NaN", "nan");
    with_line(text, "covariance = ", &line)
}

#[test]
fn the_file_gives_exactly_the_same_calibration_back() {
    let vehicle = vehicle("kraz.toml");
    for part in [Part::Vehicle, Part::Tractor] {
        let mut calibration = calibration(&vehicle);
        if part == Part::Tractor {
            calibration = calibration.of_tractor(&vehicle).unwrap();
        }
        let text = calibration.to_toml().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.toml");
        std::fs::write(&path, &text).unwrap();
        let read = Calibration::load(&path, &vehicle).unwrap();
        assert_eq!(read, calibration);
        assert_eq!(read.belief(), calibration.belief());
        assert_eq!(read.to_toml().unwrap(), text);
        let head = ["format = \"cg-height calibration\"", "version = 1", "[vehicle_crc32]"];
        let run = ["trailer_mass_kg = 8684.0", "height_m = 1.33", "speed_mps = 13.9"];
        for part in head.iter().chain(&run).chain(&["name = \"steer\"", "unit = \"rad_per_mps2\""])
        {
            assert!(text.contains(part), "{part}");
        }
    }
}

/// Any other digit at any place, as by a slip of the finger or a damaged disk.
#[test]
fn one_edited_digit_is_found() {
    let vehicle = vehicle("kraz.toml");
    let text = calibration(&vehicle).to_toml().unwrap();
    let digits: Vec<usize> =
        text.char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(i, _)| i).collect();
    for &at in digits.iter().step_by(61).chain(digits.last()) {
        let mut edited = text.clone().into_bytes();
        edited[at] = if edited[at] == b'9' { b'8' } else { edited[at] + 1 };
        refused(&String::from_utf8(edited).unwrap(), &vehicle);
    }
    let edited = text.replacen("residual_sd = 0.01", "residual_sd = 0.02", 1);
    assert_ne!(edited, text);
    assert!(refused(&edited, &vehicle).contains("was edited or damaged since it was made"));
}

/// Also where the ratios of the runs do not change: measured springs beyond the load of the runs, what
/// is uncertain, the places of sensors that the runs do not have.
#[test]
fn a_calibration_of_another_vehicle_is_refused() {
    let vehicle = vehicle("kraz.toml");
    let text = calibration(&vehicle).to_toml().unwrap();
    let changes: [(&str, Change); 8] = [
        ("(trailer)", |v| v.trailer.axle[0].axle.spring_stiffness_n_per_m *= 1.01),
        ("(trailer)", |v| v.trailer.payload.width_m += 0.1),
        ("(uncertainty)", |v| v.uncertainty.roll_stiffness_sd *= 2.0),
        ("(tractor)", |v| v.tractor.yaw_inertia_kgm2 *= 1.01),
        ("(hitch, tyre)", |v| {
            v.hitch.lash_rad += 0.001;
            v.tyre[0].relaxation_length_m += 0.1;
        }),
        ("(sensors)", |v| v.sensors.accelerometer.height_m += 0.1),
        ("(steering_ratio)", |v| v.steering_ratio = Some(25.0)),
        ("(gravity_mps2)", |v| v.gravity_mps2 = 9.80),
    ];
    for (part, change) in changes {
        let mut other = vehicle.clone();
        change(&mut other);
        let error = refused(&text, &other);
        assert!(error.contains("the vehicle file has changed since this calibration"), "{error}");
        assert!(error.contains(part) && error.contains("run cg calibrate again"), "{error}");
    }
    let error = refused(&text, &common::vehicle("baseline.toml"));
    assert!(error.contains("belongs to the vehicle \"kraz\""), "{error}");

    // What does not change the truck.
    let mut same = vehicle.clone();
    same.height.greatest_m += 0.1;
    same.nominal_speed_mps += 1.0;
    let changed = Vehicle::parse(CHANGED, "v.toml").unwrap();
    (same.road, same.sensors.mass) = (changed.road, changed.sensors.mass);
    assert!(same.road.is_some() && same.sensors.mass.is_some());
    Calibration::parse(&text, "c.toml", &same).unwrap();
}

/// The vehicle file with a comment, a road and the exactness of its masses.
const CHANGED: &str = concat!(
    include_str!("../../../fixtures/vehicles/kraz.toml"),
    "\n# A comment.\n[road]\nbank_sd_rad = 0.0\n[sensors.mass]\nweighed_sd_kg = 20.0\n"
);

#[test]
fn a_calibration_of_the_tractor_needs_the_same_tractor() {
    let vehicle = vehicle("kraz.toml");
    let text = calibration(&vehicle).of_tractor(&vehicle).unwrap().to_toml().unwrap();
    let mut other = vehicle.clone();
    other.name = "with another trailer".to_owned();
    other.trailer.axle[0].axle.spring_stiffness_n_per_m *= 1.3;
    other.uncertainty.roll_stiffness_sd *= 2.0;
    other.sensors.accelerometer.height_m += 0.1;
    Calibration::parse(&text, "c.toml", &other).unwrap();
    // The gain of the steer angle is that of this steering ratio.
    other.steering_ratio = Some(25.0);
    let error = refused(&text, &other);
    assert!(error.contains("another tractor") && error.contains("(steering_ratio)"), "{error}");
}

#[test]
fn other_versions_and_other_files_are_refused() {
    let vehicle = vehicle("kraz.toml");
    let text = calibration(&vehicle).to_toml().unwrap();
    // A later version may have other keys.
    let newer = with_line(&text, "version = 1", "version = 2\nnew_key = 1");
    let error = refused(&newer, &vehicle);
    assert!(error.contains("of version 2, but this program reads version 1"), "{error}");
    assert!(error.contains("run cg calibrate again"), "{error}");
    // Calibrations had neither format nor version at first.
    let older = with_line(&with_line(&text, "version", ""), "format", "");
    for other in [&older, include_str!("../../../fixtures/vehicles/kraz.toml")] {
        let error = refused(other, &vehicle);
        assert!(error.contains("an older version of cg; run cg calibrate again"), "{error}");
    }
}

/// All pairs of three parameters may have a correlation of −0.9, but not all three: the least eigenvalue
/// of the correlations is 1 − 2·0.9.
#[test]
fn a_covariance_with_a_negative_eigenvalue_is_refused() {
    let vehicle = vehicle("kraz.toml");
    let calibration = calibration(&vehicle);
    let text = calibration.to_toml().unwrap();
    let correlated = |correlation: f64| {
        let mut covariance = calibration.covariance.clone();
        let sd = [0, 1, 4].map(|k| (k, covariance[k][k].sqrt()));
        for (k, row) in covariance.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let of = |at| sd.iter().find(|(one, _)| *one == at).map(|(_, sd)| sd);
                match (of(j), of(k)) {
                    (Some(a), Some(b)) if j != k => *entry = correlation * a * b,
                    (None, None) => {}
                    _ if j != k => *entry = 0.0,
                    _ => {}
                }
            }
        }
        with_covariance(&text, &covariance)
    };
    Calibration::parse(&correlated(-0.4), "c.toml", &vehicle).unwrap();
    let error = refused(&correlated(-0.9), &vehicle);
    assert!(error.contains("not symmetric and positive semidefinite"), "{error}");
    let mut skew = calibration.covariance.clone();
    skew[0][3] += 1e-6;
    let error = refused(&with_covariance(&text, &skew), &vehicle);
    assert!(error.contains("not symmetric"), "{error}");
}

/// Numbers that TOML allows and a truck does not, with a correct checksum.
#[test]
fn impossible_numbers_are_refused() {
    let vehicle = vehicle("kraz.toml");
    let calibration = calibration(&vehicle);
    let text = calibration.to_toml().unwrap();
    for number in ["nan", "inf", "-1.0", "1e300"] {
        for key in ["chi_square", "residual_sd", "sd", "prior_sd", "height_m", "ratio", "ratio_sd"]
        {
            let error = refused(
                &with_line(&text, &format!("{key} = "), &format!("{key} = {number}")),
                &vehicle,
            );
            assert!(error.contains(key) || key.ends_with("sd"), "{key} {number}: {error}");
        }
        let begins = "value = ";
        refused(&with_line(&text, begins, &format!("{begins}{number}")), &vehicle);
    }
    for number in [f64::NAN, f64::INFINITY, 1e300, -0.01] {
        let mut covariance = calibration.covariance.clone();
        covariance[2][2] = number;
        let error = refused(&with_covariance(&text, &covariance), &vehicle);
        assert!(error.contains("variance of"), "{number}: {error}");
    }
    // Symmetric, and none of them on the diagonal.
    for number in [f64::NAN, f64::INFINITY] {
        let mut covariance = calibration.covariance.clone();
        (covariance[2][5], covariance[5][2]) = (number, number);
        refused(&with_covariance(&text, &covariance), &vehicle);
    }
    refused(&with_line(&text, "unit = \"factor\"", "unit = \"m\""), &vehicle);
    refused(&with_line(&text, "unit = \"rad_per_rad\"", "unit = \"rad_per_mps2\""), &vehicle);
}

/// The compensation functions of the channels are read as they were written, and impossible ones are
/// refused. Files without them are valid.
#[test]
fn compensation_functions_are_read_and_checked() {
    let vehicle = vehicle("kraz.toml");
    let plain = calibration(&vehicle).to_toml().unwrap();
    assert_eq!(Calibration::parse(&plain, "c.toml", &vehicle).unwrap().shape, []);
    let with = |shape: &str| {
        let content = unsealed(&plain, CHECKSUM).unwrap();
        sealed(&format!("{content}\n[[shape]]\n{shape}\n"), CHECKSUM)
    };
    let function = |order: usize, numerator: &str, denominator: &str| {
        format!(
            "name = \"steer\"\norder = {order}\nnumerator = {numerator}\n\
             denominator = {denominator}\nruns = 2\nbefore_percent = 2.0\nafter_percent = 1.0"
        )
    };
    let good = function(1, "[0.8, 4.0]", "[1.0, 4.0]");
    let read = Calibration::parse(&with(&good), "c.toml", &vehicle).unwrap();
    let shapes = read.belief().shapes;
    let steer = shapes[0].clone().unwrap();
    assert_eq!((steer.numerator, steer.denominator), (vec![4.0, 0.8], vec![4.0, 1.0]));
    assert!(shapes[1..].iter().all(Option::is_none));
    assert_eq!(read.to_toml().unwrap(), {
        let again = Calibration::parse(&read.to_toml().unwrap(), "c.toml", &vehicle).unwrap();
        again.to_toml().unwrap()
    });
    let order_0 = Calibration::parse(&with(&function(0, "[1.0]", "[1.0]")), "c.toml", &vehicle);
    assert!(order_0.unwrap().belief().shapes[0].is_none());
    let twice = format!("{good}\n[[shape]]\n{good}");
    for (shape, message) in [
        (function(1, "[0.8, 4.0]", "[1.0, -4.0]"), "is not stable"),
        (function(1, "[-0.8, 4.0]", "[1.0, 4.0]"), "is not stable"),
        (function(1, "[0.8, 4.1]", "[1.0, 4.0]"), "one at s = 0"),
        (function(1, "[0.8, 4.0]", "[2.0, 4.0]"), "is not stable"),
        (function(1, "[0.8, nan]", "[1.0, 4.0]"), "is not stable"),
        (function(1, "[1.0]", "[1.0, 4.0]"), "one coefficient more"),
        (function(4, "[1.0, 4.0]", "[1.0, 4.0]"), "an order of at most 3"),
        (good.replace("steer", "roll"), "shape: "),
        (good.replace("before_percent = 2.0", "before_percent = -1.0"), "percentage of steer"),
        (twice, "two entries"),
    ] {
        let error = refused(&with(&shape), &vehicle);
        assert!(error.contains(message), "{error}");
    }
}
