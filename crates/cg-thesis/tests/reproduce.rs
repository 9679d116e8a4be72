//! Every number of the thesis that can be reproduced is reproduced, and the others state why not.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use cg_thesis::reproduce::{Options, Row, table, tables, title};
use cg_vehicle::VehicleError;

/// Enough draws for the statements below, few enough for the debug profile.
const OPTIONS: Options = Options { runs: 400, seed: 7 };

/// Allowed difference from a printed number.
#[derive(Clone, Copy, Debug)]
enum Limit {
    /// `|ours − thesis| / |thesis|` (or as the row's note states).
    Relative(f64),
    /// `|ours − thesis|` in half units of the last printed digit.
    Digits(f64),
}
use Limit::{Digits, Relative};

/// Table, part of the item, limit; the first match counts.
const LIMITS: &[(&str, &str, Limit)] = &[
    // Eight printed loads, each rounded to 0.5 N: 4 N of 140.6 kN are 2.8e-5; the lever arms
    // (0.5 mm of 6.4 m) contribute the same again.
    ("2.1", "fifth-wheel", Relative(6e-5)),
    ("2.2", "fifth-wheel", Relative(6e-5)),
    ("2.1", "X_sc", Digits(1.0)),
    ("2.2", "X_sc", Digits(1.0)),
    ("2.9", "X_sc", Digits(1.0)),
    // Positions of 2.7 m and more, rounded to 0.5 mm.
    ("2.1", "axle", Relative(2e-4)),
    ("2.2", "axle", Relative(2e-4)),
    ("2.9", "axle", Relative(2e-4)),
    // Section 2.4 states 1.22 % relative to ours, which is 1.24 % relative to TruckSim.
    ("2.3", "axle", Relative(0.0125)),
    ("2.3", "greatest", Digits(1.0)),
    // Five digits are printed, but not the vehicle's last digits: at most 4.7e-5, B 2.3e-5.
    ("4.1", "A16", Digits(1.0)),
    ("4.1", "A", Relative(4.8e-5)),
    ("4.1", "B", Relative(2.4e-5)),
    // Poles and zeros to 6e-5 rad/s; the smallest modulus is 1.80 rad/s.
    ("4.2", "pole", Relative(6e-5 / 1.797)),
    ("4.2", "zero", Relative(6e-5 / 2.955)),
    // Three digits each; four of 41 differ by up to 0.06 units more, the rounding of F(s).
    ("5.2", "", Digits(1.12)),
    // Rounding of the printed F(s) changes them by up to 3e-3; eq. 5.12 happens to change by 2.7e-4.
    // Squared errors: the amplitude is derived from order 0, printed to 0.15 %; the other five have a
    // common factor of 1.018.
    ("5.3", "squared error", Relative(0.02)),
    ("5.3", "", Relative(3e-3)),
    ("5.12", "", Relative(2.7e-4)),
    ("5.17", "", Relative(2.4e-5)),
    ("5.19", "", Digits(1.0)),
    // Ours is the ratio of eq. 5.12, from which the printed ones differ by up to 9.4e-4 (for the height
    // 1/1.136 of that).
    ("5.5", "identified", Relative(9.5e-4)),
    ("5.6", "identified", Relative(8.4e-4)),
    ("5.5", "", Digits(1.0)),
    // From the printed ratio or height, to all printed digits.
    ("5.6", "", Digits(1.0)),
    ("5.7", "", Digits(1.0)),
    ("5.8", "A0/B0", Digits(1.0)),
    // Heights to 0.01 in, which is 0.013 percentage points of bias; meters follow from the printed inches.
    ("5.10", "updated R_c, in", Digits(2.0)),
    ("5.10", ", m", Digits(1.0)),
    ("5.10", "bias", Relative(1.3e-4)),
    // Both heights are printed to 0.5 mm: 0.055 percentage points.
    ("5.11", "as printed, m", Digits(1.0)),
    ("5.11", "bias", Relative(5.5e-4)),
    // The claim for the complete model: 0.06 % over the whole range.
    ("5.11", "complete, m", Relative(6e-4)),
];

/// Printed numbers that need not agree.
fn cannot_agree(row: &Row) -> bool {
    row.is_misprint() || row.note.as_ref().is_some_and(|note| note.contains("cannot be reproduced"))
}

fn check(row: &Row) {
    let name = format!("{}: {}", row.table, row.item);
    let (Some(thesis), Some(ours), Some(error)) = (row.thesis, row.ours, row.relative_error) else {
        assert!(row.note.is_some(), "{name}: no error and no note");
        return;
    };
    if cannot_agree(row) {
        return;
    }
    let limit =
        LIMITS.iter().find(|(table, part, _)| *table == row.table && row.item.contains(part));
    let Some((_, _, limit)) = limit else { panic!("{name}: no limit") };
    let (found, allowed) = match limit {
        Relative(allowed) => (error.abs(), *allowed),
        // Decimal ties are not exact in binary: a part in 1e9.
        Digits(allowed) => ((ours - thesis).abs() / row.rounding.unwrap(), allowed * (1.0 + 1e-9)),
    };
    assert!(found <= allowed, "{name}: thesis {thesis}, ours {ours}: {found:e} > {limit:?}");
}

#[test]
fn every_printed_number_is_met_to_its_limit() {
    for name in tables() {
        let rows = table(name, &OPTIONS).unwrap();
        assert!(!rows.is_empty(), "{name}");
        for row in &rows {
            assert_eq!(row.table, *name);
            check(row);
        }
    }
    for (name, part, _) in LIMITS {
        let rows = table(name, &OPTIONS).unwrap();
        assert!(rows.iter().any(|row| row.item.contains(part)), "limit without row: {name} {part}");
    }
}

#[test]
fn every_number_is_finite_and_what_is_missing_has_a_note() {
    for name in tables() {
        for row in table(name, &OPTIONS).unwrap() {
            let numbers = [row.thesis, row.ours, row.relative_error, row.rounding];
            assert!(numbers.iter().flatten().all(|number| number.is_finite()), "{row:?}");
            if row.thesis.is_none() || row.ours.is_none() {
                assert!(row.note.is_some(), "{row:?}");
            }
        }
    }
}

fn ours(rows: &[Row], item: &str) -> f64 {
    let row = rows.iter().find(|row| row.item == item);
    row.unwrap_or_else(|| panic!("no row {item}")).ours.unwrap()
}

/// The corrections of misprints follow from the thesis's own numbers.
#[test]
fn misprints_are_marked_and_ours_is_what_was_meant() {
    let mut found = 0;
    for name in tables() {
        found += table(name, &OPTIONS).unwrap().iter().filter(|row| row.is_misprint()).count();
    }
    let known = [
        ("2.1", "Table 2.1: torsional stiffness of the frame, N m/deg", 4519.0, 0.5),
        ("2.3", "greatest deviation: axle", 1.0, 1e-9),
        ("4.2", "gain", 0.069_107, 0.5e-6),
        ("5.7", "10 dB: h, m", 1.950, 0.5e-3),
        ("5.10", "-30 %: bias, updated R_c, %", -0.27, 0.5e-2),
        ("5.11", "true 2.210 m: h, as printed, m", 2.330, 0.5e-3),
        ("5.11", "true 2.210 m: h, complete, m", 2.210, 6e-4 * 2.210),
    ];
    assert_eq!(found, known.len());
    for (name, item, meant, half_unit) in known {
        let ours = ours(&table(name, &OPTIONS).unwrap(), item);
        assert!((ours - meant).abs() <= half_unit, "{name} {item}: {ours}");
    }
}

#[test]
fn thirty_seven_of_41_products_have_all_printed_digits() {
    let rows = table("5.2", &OPTIONS).unwrap();
    let agree = rows.iter().filter(|row| row.agrees() == Some(true)).count();
    assert_eq!((agree, rows.len()), (37, 41));
}

/// Table 5.4 shows other coefficients for each rate; exact data return eq. 5.12 for all. The shift form
/// has condition numbers up to 1e13, which times 2e-16 is 2e-3.
#[test]
fn noise_free_identification_returns_the_model_that_made_the_data() {
    let original = table("5.12", &OPTIONS).unwrap();
    let identified = table("5.4", &OPTIONS).unwrap();
    assert_eq!(identified.len(), 6 * original.len());
    for row in identified {
        let (_, name) = row.item.split_once(": ").unwrap();
        let known = original.iter().find(|row| row.item == name).unwrap().thesis.unwrap();
        let ours = row.ours.unwrap();
        assert!((ours / known - 1.0).abs() <= 2e-3, "{}: {ours} {known}", row.item);
    }
    // The DC ratio is far better determined than the coefficients.
    for row in table("5.6.3", &Options { runs: 1, seed: 1 }).unwrap() {
        if row.item.contains("no noise") {
            assert!(row.ours.unwrap().abs() <= 1e-5, "{row:?}");
        }
    }
}

/// The gains of the Yaw/Roll program and of both models, computed independently of this crate: one
/// unit of the fourth digit. The gains of the program follow from heights printed to 0.5 mm, which is
/// 3e-4 of gain at the steepest point.
#[test]
fn gains_over_the_range_of_heights() {
    let rows = table("5.11", &OPTIONS).unwrap();
    let gains = [
        ("1.854", [0.7610, 0.5291, 0.7655]),
        ("1.905", [0.7972, 0.5455, 0.8014]),
        ("1.973", [0.8454, 0.5676, 0.8503]),
        ("2.007", [0.8699, 0.5788, 0.8751]),
        ("2.057", [0.9064, 0.5953, 0.9121]),
        ("2.108", [0.9454, 0.6122, 0.9505]),
        ("2.159", [0.9849, 0.6293, 0.9896]),
        ("2.210", [1.0245, 0.6466, 1.0294]),
    ];
    for (height, known) in gains {
        let names = [("Yaw/Roll gain", 3e-4), ("gain, as printed", 1e-4), ("gain, complete", 1e-4)];
        for ((name, limit), known) in names.into_iter().zip(known) {
            let ours = ours(&rows, &format!("true {height} m: {name}"));
            assert!((ours - known).abs() <= limit, "{height} {name}: {ours} {known}");
        }
    }
    assert!((ours(&rows, "R_c, complete") - 0.994).abs() <= 0.5e-3);
    assert!((ours(&rows, "R_c, as printed") - 1.489).abs() <= 0.5e-3 + 1e-4);
}

/// Bias and RMSE of the height at each noise level, compared with an independent study of at least 200
/// draws (each RMSE scatters by 1/√(2N) of itself, each bias by its standard deviation over √N; three
/// sigma of both together); the bounds to their three known digits.
#[test]
fn the_source_s_identification_is_biased_and_its_bound_is_known() {
    let rows = table("5.7", &OPTIONS).unwrap();
    let (theirs, mine) = (1.0 / 200.0, 1.0 / f64::from(OPTIONS.runs));
    let three_sigma = 3.0 * (theirs + mine).sqrt();
    for (snr_db, bias, rmse, bound, gain) in [
        (30, -0.50, 0.55, 0.289, 0.196),
        (25, -0.63, 0.74, 0.514, 0.349),
        (20, -0.96, 1.16, 0.915, 0.621),
        (15, -1.22, 1.67, 1.63, 1.10),
        (10, -1.31, 2.38, 2.89, 1.96),
        (5, -1.24, 3.73, 5.14, 3.49),
    ] {
        let at = |what: &str| ours(&rows, &format!("{snr_db} dB: {what}, %"));
        let scatter = f64::sqrt(rmse * rmse - bias * bias);
        let off = (at("ARX bias") - bias).abs();
        assert!(off <= three_sigma * scatter + 0.005, "{snr_db} dB: bias off by {off}");
        let off = (at("ARX RMSE") - rmse).abs();
        assert!(off <= three_sigma / f64::sqrt(2.0) * rmse, "{snr_db} dB: RMSE off by {off}");
        for (found, known) in [(at("bound"), bound), (at("bound, gain only"), gain)] {
            // Three digits are known of the reference.
            assert!((found / known - 1.0_f64).abs() <= 5e-3, "{snr_db} dB: {found} {known}");
        }
    }
}

/// The project's identifier has no such bias (allowed: three standard errors and 0.3 RMSE), and its RMSE
/// is between the bounds for a known and for an unknown shape, within three sigma of its own scatter.
#[test]
fn the_product_s_identifier_is_nearly_unbiased_and_between_the_bounds() {
    let runs = f64::from(OPTIONS.runs);
    let rows = table("5.7", &OPTIONS).unwrap();
    for snr_db in [30, 25, 20, 15, 10, 5] {
        let at = |what: &str| ours(&rows, &format!("{snr_db} dB: {what}, %"));
        let (bias, rmse) = (at("filtered bias").abs(), at("filtered RMSE"));
        assert!(bias <= (0.3 + 3.0 / runs.sqrt()) * rmse, "{snr_db} dB: {bias} {rmse}");
        let scatter = 3.0 / (2.0 * runs).sqrt();
        assert!(rmse >= at("bound, gain only") * (1.0 - scatter), "{snr_db} dB: {rmse}");
        assert!(rmse <= at("bound") * (1.0 + scatter), "{snr_db} dB: {rmse}");
    }
}

/// The single draws of Table 5.9 hide the bias of shift-form ARX, which exists at every order and noise
/// level: it is more than three of its standard errors, and always negative.
#[test]
fn no_order_removes_the_bias() {
    let runs = f64::from(OPTIONS.runs);
    let rows = table("5.9", &OPTIONS).unwrap();
    for order in 1..=5 {
        for snr_db in [30, 25, 20, 15, 10, 5] {
            let at = |what: &str| ours(&rows, &format!("order {order}, {snr_db} dB: {what}, %"));
            let (bias, rmse) = (at("ARX bias"), at("ARX RMSE"));
            let standard_error = ((rmse * rmse - bias * bias) / runs).sqrt();
            assert!(bias < -3.0 * standard_error, "{order} {snr_db}: {bias} ± {standard_error}");
        }
    }
    for snr_db in [30, 25, 20, 15, 10, 5] {
        let at = |what: &str| ours(&rows, &format!("any order, {snr_db} dB: {what}, %"));
        let (bias, rmse) = (at("filtered bias").abs(), at("filtered RMSE"));
        assert!(bias <= (0.3 + 3.0 / runs.sqrt()) * rmse, "{snr_db} dB: {bias} {rmse}");
    }
}

#[test]
fn the_same_seed_gives_the_same_rows_and_another_does_not() {
    let few = Options { runs: 20, seed: 3 };
    let rows = |options| table("5.7", &options).unwrap();
    assert_eq!(rows(few), rows(few));
    assert_ne!(rows(few), rows(Options { seed: 4, ..few }));
}

#[test]
fn names_are_found_however_the_source_calls_them() {
    for (name, found) in [
        ("Table 5.11", "5.11"),
        ("eq. (5.12)", "5.12"),
        ("Eq 5.17", "5.17"),
        ("Fig. 2.1", "2.1"),
        ("c", "C"),
        ("Appendix C", "C"),
        ("section 5.6.1", "5.6.3"),
    ] {
        assert_eq!(title(name).unwrap(), title(found).unwrap(), "{name}");
    }
    for name in ["", "9.9", "5", "5.111", "table"] {
        let Err(error) = table(name, &OPTIONS) else { panic!("{name}") };
        assert!(matches!(error, VehicleError::UnknownTable { .. }), "{name}");
        assert!(error.to_string().contains("5.10, 5.11, C"), "{error}");
    }
}

#[test]
fn no_runs_are_refused() {
    assert!(table("5.9", &Options { runs: 0, seed: 1 }).is_err());
}

#[test]
fn a_row_has_exactly_the_keys_of_the_contract() {
    for row in table("5.1", &OPTIONS).unwrap() {
        let value = serde_json::to_value(&row).unwrap();
        let mut keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
        keys.sort_unstable();
        assert_eq!(keys, ["item", "note", "ours", "relative_error", "table", "thesis"]);
    }
}
