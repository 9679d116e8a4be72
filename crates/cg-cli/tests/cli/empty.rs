//! A trailer that is empty by its mass has the height that is in its papers.

use crate::common::{Scratch, cg, estimate, fixture};
use crate::run::{events, lines};

const TARE_KG: &str = "6318";
const TURN: [&str; 6] = ["--plant", "nonlinear", "--maneuver", "rounded-step", "--snr-db", "30"];

/// The vehicle file without the first axle of the trailer.
fn lifted(truck: &str) -> String {
    let axles: Vec<&str> = truck.split("[[trailer.axle]]").collect();
    let [head, _, other, last] = axles[..] else { panic!("three axles") };
    [head, other, last].join("[[trailer.axle]]")
}

/// What `cg estimate` and `cg run` say of an empty trailer or a laden one on a truck, if the vehicle file is `euro.toml`.
fn told(truck: &str, [mass_kg, height_m]: [&str; 2]) -> [bool; 2] {
    let (scratch, vehicle) = (Scratch::new(), fixture("vehicles/euro.toml"));
    let truck = scratch.file("truck.toml", truck);
    let load = ["--trailer-mass-kg", mass_kg, "--height-m", height_m];
    let log = scratch.simulate("log.csv", &truck, &[&TURN[..], &load].concat());
    let estimate = estimate(&log, &vehicle, &[]).done();
    let run = lines(&cg(&["run", "--csv", &log, "--vehicle", &vehicle]).done());
    let is_told = |text: &str| text.contains("by its mass the trailer is empty");
    let notices = events(&run, "notice");
    let notices = notices.iter().filter(|notice| notice["subject"] == "empty");
    let live: Vec<String> = notices.map(ToString::to_string).collect();
    assert!(live.iter().all(|notice| is_told(notice)));
    [is_told(&estimate.out), !live.is_empty()]
}

/// Without one of its three axles on the ground, the trailer rolls by a third more.
#[test]
fn an_empty_trailer_with_a_lifted_axle_is_told() {
    let truck = std::fs::read_to_string(fixture("vehicles/euro.toml")).unwrap();
    let lifted = lifted(&truck);
    assert_eq!(told(&lifted, [TARE_KG, "1.275"]), [true; 2]);
    assert_eq!(told(&truck, [TARE_KG, "1.275"]), [false; 2]);
    // Of a load nobody knows the height.
    assert_eq!(told(&lifted, ["10000", "1.5"]), [false; 2]);
}

/// One such run alone contradicts nothing beyond chance, but the truck would be taken for one of soft springs.
#[test]
fn a_calibration_run_with_a_lifted_axle_is_told() {
    let (scratch, vehicle) = (Scratch::new(), fixture("vehicles/euro.toml"));
    let truck = std::fs::read_to_string(&vehicle).unwrap();
    for (truck, is_told) in [(lifted(&truck), true), (truck, false)] {
        let truck = scratch.file("truck.toml", truck);
        let load = ["--trailer-mass-kg", TARE_KG, "--height-m", "1.275", "--force"];
        let log = scratch.simulate("log.csv", &truck, &[&TURN[..], &load].concat());
        let run = format!("{log}=empty");
        let of = ["--vehicle", &vehicle, "--run", &run, "-o", &scratch.path("c.toml"), "--force"];
        let calibrate = cg(&[&["calibrate"], &of[..]].concat()).done();
        assert_eq!(calibrate.out.contains("check that no axle was lifted"), is_told);
    }
}
