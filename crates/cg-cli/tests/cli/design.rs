//! `cg design`: the design for firmware equals the one with which the command line estimates.

use std::path::Path;

use cg_core::{Channel, Design};
use cg_vehicle::calibration::Calibration;
use cg_vehicle::design::{design, design_with};
use cg_vehicle::emit::{Language, emit};
use cg_vehicle::{Variant, Vehicle};

use crate::common::{Scratch, cg, kraz};

/// The text after the comment.
fn emitted(arguments: &[&str], output: &str) -> String {
    let run = cg(&[&["design", "-o", output], arguments].concat()).done();
    assert!(run.out.is_empty(), "{run:?}");
    std::fs::read_to_string(output).unwrap()
}

fn narrowed(design: &Design<f64>) -> Design<f32, 2> {
    design.with_channels([Channel::Steer, Channel::LateralAcceleration]).unwrap().cast()
}

#[test]
fn every_language_holds_the_design_that_the_estimator_runs_on() {
    let scratch = Scratch::new();
    let vehicle = Vehicle::load(kraz()).unwrap();
    let ours = narrowed(&design(&vehicle, Variant::Complete).unwrap());
    for (word, language) in [("json", Language::Json), ("rust", Language::Rust), ("c", Language::C)]
    {
        let text = emitted(&["--vehicle", &kraz(), "--emit", word], &scratch.path(word));
        let expected = emit(&ours, language, &[]);
        let body = &expected[expected.find("speed_mps").unwrap()..];
        assert!(text.trim_end().ends_with(body.trim_end()), "{word}: another design");
        for part in ["kraz", "not calibrated", "cg design --vehicle", "--model complete --emit"] {
            assert!(text.contains(part), "{word}: no {part:?}");
        }
    }
}

#[test]
fn a_calibration_goes_in_and_is_named() {
    let scratch = Scratch::new();
    let calibration = scratch.path("truck.toml");
    let log = crate::common::fixture("logs/A_p20_h190_v50_L.csv");
    let run = format!("{log}=1.90");
    cg(&["calibrate", "--vehicle", &kraz(), "--run", &run, "-o", &calibration]).done();
    let base = ["--vehicle", &kraz(), "--calibration", &calibration, "--emit", "rust"];
    let text = emitted(&base, &scratch.path("truck.rs"));
    let vehicle = Vehicle::load(kraz()).unwrap();
    let belief = Calibration::load(Path::new(&calibration), &vehicle).unwrap().belief();
    let ours = narrowed(&design_with(&vehicle, Variant::Complete, &belief).unwrap());
    let expected = emit(&ours, Language::Rust, &[]);
    assert!(text.ends_with(expected.trim_start()), "another design");
    assert!(text.contains(&format!("calibrated by {calibration}")), "{text}");
}

/// The firmware's copy of the design must be renewed when the model changes.
#[test]
fn the_firmware_runs_on_the_design_of_today() {
    let scratch = Scratch::new();
    let text = emitted(&["--vehicle", &kraz(), "--emit", "rust"], &scratch.path("truck.rs"));
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../cg-core/examples/kraz/design.rs");
    let kept = std::fs::read_to_string(path).unwrap();
    let numbers = |text: &str| -> Vec<f32> {
        let body = &text[text.find("speed_mps").unwrap()..];
        body.split(|c: char| !(c.is_alphanumeric() || "+-._".contains(c)))
            .filter_map(|word| word.parse().ok())
            .collect()
    };
    let (now, kept) = (numbers(&text), numbers(&kept));
    assert!(now.len() > 600 && now.len() == kept.len(), "{} {}", now.len(), kept.len());
    for (now, kept) in now.iter().zip(&kept) {
        // Another processor may sum in another order, which gives 1e-9 in double precision and at
        // most one unit in the last place of single precision (6e-8 to 1.2e-7). Ten units for small
        // differences of large terms.
        assert!(
            (now - kept).abs() <= 1.2e-6 * now.abs(),
            "{now} {kept}: see crates/cg-core/examples/kraz/design.rs"
        );
    }
}

#[test]
fn what_cannot_be_written_leaves_nothing() {
    let scratch = Scratch::new();
    let target = scratch.path("missing/truck.rs");
    cg(&["design", "--vehicle", &kraz(), "--emit", "rust", "-o", &target])
        .refused(&["missing/truck.rs", "check the folder"]);
    cg(&["design", "--vehicle", &kraz(), "-o", &scratch.path("a")]).refused(&["--emit"]);
    assert!(scratch.names().is_empty());
}
