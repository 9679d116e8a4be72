//! `cg model` compared with the printed numbers.

use serde_json::Value;

use crate::common::{Scratch, baseline, cg, fixture, kraz};
use crate::output::keys;

fn model(vehicle: &str, more: &[&str]) -> Value {
    cg(&[&["model", "--vehicle", vehicle, "--format", "json"][..], more].concat()).done().answer()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn the_json_object_has_the_keys_of_the_contract() {
    for (vehicle, variant) in
        [(baseline(), "complete"), (baseline(), "as-printed"), (kraz(), "complete")]
    {
        let model = model(&vehicle, &["--model", variant]);
        let found = keys(&model);
        for key in [
            "numerator",
            "denominator",
            "poles",
            "zeros",
            "gain",
            "dc_gain",
            "ratio",
            "reduced",
            "responses",
            "static_balance",
        ] {
            assert!(found.contains(&key), "{key}");
        }
        assert_eq!(keys(&model["ratio"]), ["a0", "a1", "b0", "b1"]);
        for key in ["order", "numerator", "denominator"] {
            assert!(!model["reduced"][key].is_null(), "{key}");
        }
        let [full, reduced] = [&model, &model["reduced"]].map(|m| numbers(&m["denominator"]));
        assert_eq!([full[0].to_bits(), reduced[0].to_bits()], [1.0_f64.to_bits(); 2]);
        assert_eq!(model["poles"].as_array().unwrap().len(), full.len() - 1);
        assert_eq!(model["reduced"]["order"], reduced.len() - 1);
        for root in model["poles"].as_array().unwrap() {
            assert_eq!(numbers(root).len(), 2);
        }
    }
}

#[test]
fn the_dc_gain_is_the_same_from_polynomials_line_and_reduced_model() {
    for vehicle in [baseline(), kraz()] {
        let model = model(&vehicle, &[]);
        let dc_gain = model["dc_gain"].as_f64().unwrap();
        let last = |m: &Value, key: &str| *numbers(&m[key]).last().unwrap();
        let line = |key: &str| model["ratio"][key].as_f64().unwrap();
        let h = model["height_m"].as_f64().unwrap();
        for other in [
            last(&model, "numerator") / last(&model, "denominator"),
            last(&model["reduced"], "numerator") / last(&model["reduced"], "denominator"),
            (line("a1") * h + line("a0")) / (line("b1") * h + line("b0")),
        ] {
            // The product of 18 poles of up to 1e2 rad/s, each with a relative error of about
            // 1e-12.
            assert!((other / dc_gain - 1.0).abs() < 1e-9, "{other} {dc_gain}");
        }
    }
}

#[test]
fn the_printed_model_gives_table_4_1_and_equation_5_17() {
    let model = model(&baseline(), &["--model", "as-printed"]);
    let line = |key: &str| model["ratio"][key].as_f64().unwrap();
    // Heights are printed in inches.
    for (what, ours, printed) in [
        ("A0/B0 at h = 0", line("a0") / line("b0"), 0.011_837_4),
        ("a1/a0 per meter", line("a1") / line("a0"), 0.519_32 / 0.0254),
        ("b1/b0 per meter", line("b1") / line("b0"), -1.775_489_4e-3 / 0.0254),
    ] {
        // Five to eight digits are printed.
        assert!((ours / printed - 1.0).abs() < 1e-4, "{what}: {ours} {printed}");
    }
    for (what, key, printed) in [("A0", "numerator", 4.5839e25), ("B0", "denominator", 8.0754e25)] {
        // In the thesis, the steer angle is positive to the right, so its A0 is negative. Five
        // digits.
        let ours = *numbers(&model[key]).last().unwrap();
        assert!((ours / printed - 1.0).abs() < 1e-4, "{what}: {ours:e} {printed:e}");
    }
}

#[test]
fn the_static_loads_carry_the_whole_truck() {
    let model = model(&kraz(), &[]);
    let loads_n: f64 = numbers(&model["static_balance"]["axle_load_n"]).iter().sum();
    // Sprung mass and axles of the tractor, and the semitrailer as weighed, times the file's
    // gravity.
    let weight_n = (10_000.0 + 996.0 + 2.0 * 1226.0 + 18_684.0) * 9.81;
    assert!((loads_n / weight_n - 1.0).abs() < 1e-9, "{loads_n} {weight_n}");
}

#[test]
fn the_table_names_poles_ratio_and_loads() {
    let run = cg(&["model", "--vehicle", &baseline()]).done();
    for part in ["DC gain", "Poles", "Zeros", "a0", "Reduced to order 5", "fifth wheel"] {
        assert!(run.out.contains(part), "{part}");
    }
}

/// Three runs of the second multibody truck give a function of order 3 from the steer angle.
#[test]
fn a_calibrated_truck_has_its_compensated_models() {
    let scratch = Scratch::new();
    let (file, vehicle) = (scratch.path("c.toml"), fixture("vehicles/euro.toml"));
    let [empty, half, laden] = [
        ("A_p00_v50_L", "1.27483,6318.23"),
        ("A_p16_h170_v50_L", "1.70859,22318.23"),
        ("A_p24_h200_v50_L", "2.00067,30318.23"),
    ]
    .map(|(log, load)| format!("{}={load}", fixture(&format!("euro/{log}.csv.gz"))));
    let run = cg(&[
        "calibrate",
        "--vehicle",
        &vehicle,
        "--run",
        &empty,
        "--run",
        &half,
        "--run",
        &laden,
        "--output",
        &file,
    ])
    .done();
    assert!(run.out.contains("steer: F(s) of order 3"), "{}", run.out);
    assert!(run.out.contains("lateral-acceleration: F(s) of order 0; no function"), "{}", run.out);
    let calibrated = model(&vehicle, &["--calibration", &file]);
    let plain = model(&vehicle, &[]);
    assert!(plain.get("compensated").is_none());
    assert_ne!(plain["dc_gain"], calibrated["dc_gain"]);
    let compensated = calibrated["compensated"].as_array().unwrap();
    let orders: Vec<_> = compensated.iter().map(|one| one["order"].as_u64().unwrap()).collect();
    assert_eq!(orders, [3, 0, 0, 0]);
    for (one, order) in compensated.iter().zip([3, 0, 0, 0]) {
        for (part, length) in [("function", 1 + order), ("product", 6 + order), ("reduced", 6)] {
            let [numerator, denominator] =
                ["numerator", "denominator"].map(|key| numbers(&one[part][key]));
            assert_eq!(denominator.len(), length, "{part}");
            let (Some(a0), Some(b0)) = (numerator.last(), denominator.last()) else { panic!() };
            assert!((a0 / b0 - 1.0).abs() < 1e-9, "{part}: {a0} {b0}");
        }
        let [change, left] =
            ["change_percent", "reduction_error_percent"].map(|key| one[key].as_f64().unwrap());
        assert!(if order == 0 { change == 0.0 && left < 1e-9 } else { left < 0.5 * change });
    }
    let table = cg(&["model", "--vehicle", &vehicle, "--calibration", &file]).done();
    assert!(table.out.contains("Compensated steer: F(s) of order 3"), "{}", table.out);
    cg(&["model", "--vehicle", &kraz(), "--calibration", &file])
        .refused(&["belongs to the vehicle"]);
}
