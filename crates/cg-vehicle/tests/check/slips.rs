//! Tests of typical mistakes in vehicle files, and of impossible vehicles.

use cg_vehicle::design::design;
use cg_vehicle::guide::{TruckKind, template};
use cg_vehicle::{Variant, Vehicle, VehicleError};

use crate::check::text;

/// A vehicle file in which some text is replaced.
fn changed(name: &str, pairs: &[(&str, &str)]) -> String {
    pairs.iter().fold(text(name), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

#[track_caller]
fn refused(name: &str, pairs: &[(&str, &str)], parts: &[&str]) {
    let error = Vehicle::parse(&changed(name, pairs), "truck.toml").unwrap_err();
    assert!(matches!(error, VehicleError::Invalid { .. }), "{error}");
    for part in parts {
        assert!(error.to_string().contains(part), "no {part:?} in {error}");
    }
}

#[track_caller]
fn warned(name: &str, pairs: &[(&str, &str)], parts: &[&str]) -> Vehicle {
    let (vehicle, warnings) = Vehicle::check(&changed(name, pairs), "truck.toml").unwrap();
    let told: Vec<String> = warnings.iter().map(|found| found.in_file("truck.toml")).collect();
    for part in parts {
        assert!(told.iter().any(|text| text.contains(part)), "no {part:?} in {told:?}");
    }
    vehicle
}

#[test]
fn numbers_in_another_unit_are_told_with_that_unit() {
    refused(
        "kraz",
        &[("spring_stiffness_n_per_m = 710611.5", "spring_stiffness_n_per_m = 710.6115")],
        &[
            "trailer.axle[0].spring_stiffness_n_per_m = 710.6115: is impossible",
            "(usual: 80000 to 4000000 N/m); 710.6115 kN/m would be usual",
            "trailer.axle[2].spring_stiffness_n_per_m",
        ],
    );
    let mm = ["spring_spread_m = 1300: ", "(usual: 0.5 to 1.5 m); 1300 mm would be usual"];
    refused("kraz", &[("spring_spread_m = 1.458", "spring_spread_m = 1300")], &mm);
    let tonnes = ["tractor.sprung_mass_kg = 5.9: ", "5.9 t would be usual, but the key is in kg"];
    refused("baseline", &[("sprung_mass_kg = 5345.646233765785", "sprung_mass_kg = 5.9")], &tonnes);
    let floor = ["trailer.payload.floor_height_m = 1e30: ", "usual: 0.6 to 1.7 m"];
    refused("air", &[("floor_height_m = 1.37", "floor_height_m = 1e30")], &floor);
    let degrees = ["hitch.lash_rad = 2: ", "2 degrees would be usual"];
    refused("air", &[("lash_rad = 0.0349", "lash_rad = 2.0")], &degrees);
    let share = ["uncertainty.roll_stiffness_sd = 10: ", "usual: 0.01 to 0.4"];
    refused("kraz", &[("roll_stiffness_sd = 0.10", "roll_stiffness_sd = 10")], &share);
}

#[test]
fn tyre_loads_in_kn_are_refused() {
    let loads = "load_n = [0, 5000.0, 10000.0, 15000.0, 20000.0, 25000.0, 30000.0, 35000.0, \
                 40000.0, 45000.0, 50000.0, 60000.0]";
    let kilo = "load_n = [0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 60]";
    refused(
        "kraz",
        &[(loads, kilo)],
        &["tyre[0].load_n[", "tyre[1].load_n[", "5 kN would be usual"],
    );
}

#[test]
fn an_axle_above_the_radius_of_its_tyre_is_refused_with_both_keys() {
    refused(
        "kraz",
        &[("center_height_m = 0.507", "center_height_m = 0.56")],
        &["trailer.axle[1].center_height_m = 0.56: the deflection of its tire is -0.024 m, with \
             tyre[1].unloaded_radius_m (usual: 0.003 to 0.09 m)"],
    );
    // Without a radius, the axle is compared with other axles that have the same tires.
    let from = "center_height_m = 0.508\nroll_center_height_m = 0.8382";
    let to = "center_height_m = 0.608\nroll_center_height_m = 0.8382";
    let text = text("baseline").replacen(from, to, 1);
    let warnings = Vehicle::check(&text, "truck.toml").unwrap().1;
    let told: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    let part = "with tractor.axle[1].center_height_m (usual: -0.05 to 0.05 m)";
    assert!(told.iter().any(|text| text.contains(part)), "{told:?}");
}

#[test]
fn all_findings_are_told_at_once_with_their_places_errors_first() {
    let text = changed(
        "kraz",
        &[
            ("height_m = 1.397", "height_m = 1.7"),
            ("floor_height_m = 1.27", "floor_height_m = 1270"),
            ("tyre = \"trailer\"", "tyre = \"trailr\""),
            ("sprung_mass_kg = 10000.0", "sprung_mass_kg = 10.0"),
        ],
    );
    let error = Vehicle::parse(&text, "truck.toml").unwrap_err().to_string();
    let lines: Vec<&str> = error.lines().collect();
    assert_eq!(lines.len(), 6, "{error}");
    let keys = ["tractor.sprung_mass_kg", "trailer.payload.floor_height_m", "trailer.axle[0].tyre"];
    for (line, key) in lines.iter().zip(keys) {
        let place = line.split(": ").next().unwrap();
        let number: usize = place.split(':').nth(1).unwrap().parse().unwrap();
        let name = key.rsplit('.').next().unwrap();
        assert!(text.lines().nth(number - 1).unwrap().starts_with(name), "{line}");
        assert!(line.contains(&format!(": {key} = ")), "{line} {key}");
    }
    assert!(lines[5].contains("warning: hitch.height_m = 1.7: is unusually large"), "{error}");
}

#[test]
fn bodies_of_impossible_size_are_refused_with_mass_and_inertia() {
    let inertia = ("roll_inertia_kgm2 = 3441.0", "roll_inertia_kgm2 = 90000.0");
    let parts =
        ["tractor.roll_inertia_kgm2 = 90000: the radius of gyration is 3 m", "sprung_mass_kg"];
    refused("kraz", &[inertia], &parts);
    let inertia = ("roll_inertia_kgm2 = 3441.0", "roll_inertia_kgm2 = 11500.0");
    // A radius of 1.07 m is usual; 1.3 m, with a lighter tractor, is not.
    let lighter = ("sprung_mass_kg = 10000.0", "sprung_mass_kg = 6800.0");
    warned("kraz", &[inertia, lighter], &["tractor.roll_inertia_kgm2 = 11500: the radius"]);
}

#[test]
fn axles_out_of_order_and_loads_beyond_the_tyres_are_told() {
    let parts = ["trailer.axle[1].behind_hitch_m = 6.2: must lie behind trailer.axle[0]"];
    refused("kraz", &[("behind_hitch_m = 7.59", "behind_hitch_m = 6.2")], &parts);
    let heavy = ("reference_mass_kg = 18684.0", "reference_mass_kg = 90000.0");
    let parts =
        ["trailer.reference_mass_kg = 90000: is unusually large", "the static load divided by it"];
    warned("kraz", &[heavy], &parts);
    let tipping = ("\nbehind_hitch_m = 5.96", "\nbehind_hitch_m = 9.5");
    warned("kraz", &[tipping], &["trailer.payload.behind_hitch_m = 9.5: its distance ahead"]);
}

#[test]
fn names_are_one_line_and_their_own() {
    refused(
        "kraz",
        &[("name = \"kraz\"", "name = \"a\\nb\"")],
        &["name = \"a\\nb\": must be one line"],
    );
    let twice = ("name = \"trailer\"", "name = \"tractor\"");
    refused("kraz", &[twice], &["tyre[1].name = \"tractor\": another [[tyre]] has this name"]);
}

/// Soft springs under a high load, and a fifth wheel that is too soft: each number is possible, but
/// the vehicle tips over.
#[test]
fn a_vehicle_that_falls_over_says_which_keys_are_unusual() {
    let pairs = [
        ("spring_stiffness_n_per_m = 710611.5", "spring_stiffness_n_per_m = 25000.0"),
        ("roll_stiffness_nm_per_rad = 1.0e10", "roll_stiffness_nm_per_rad = 1.0e5"),
        ("reference_cg_height_m = 1.70", "reference_cg_height_m = 2.8"),
    ];
    let parts = ["warning: trailer.axle[2].spring_stiffness_n_per_m = 25000: is unusually small"];
    let vehicle = warned("kraz", &pairs, &parts);
    let error = design(&vehicle, Variant::Complete).unwrap_err();
    assert!(matches!(error, VehicleError::Unusable { .. }), "{error}");
    let ranked = "least usual values in the vehicle file: trailer.axle[";
    let named = "].spring_stiffness_n_per_m = 25000 (usual: 80000 to 4000000 N/m), ";
    let text = error.to_string();
    assert!(text.contains(ranked) && text.contains(named), "{text}");
}

/// The width of springs is full and that of tires half, which is easily confused.
#[test]
fn springs_at_half_their_distance_are_told() {
    let template = template(TruckKind::SixByFourThreeAxle);
    let halved = template.replace("spring_spread_m = 1.2", "spring_spread_m = 0.6");
    let (vehicle, _) = Vehicle::check(&halved, "truck.toml").unwrap();
    let text = design(&vehicle, Variant::Complete).unwrap_err().to_string();
    let hint = "trailer.axle[0].spring_spread_m = 0.6 is small beside tyre_positions_m: it is the full \
                distance between the left and the right spring, so if you gave half of it, write 1.2; least";
    assert!(text.contains(hint), "{text}");
    // Not of springs at a usual distance.
    let soft = template
        .replace("spring_stiffness_n_per_m = 700000.0", "spring_stiffness_n_per_m = 150000.0");
    let (vehicle, _) = Vehicle::check(&soft, "truck.toml").unwrap();
    let text = design(&vehicle, Variant::Complete).unwrap_err().to_string();
    assert!(!text.contains("spring_spread_m"), "{text}");
}

#[test]
fn a_trailer_that_lifts_the_tractor_when_empty_is_refused_with_its_keys() {
    let pairs = [("cg_behind_hitch_m = 5.96", "cg_behind_hitch_m = 16.0")];
    let parts = ["the axle's load, empty, is -", "trailer.tare.cg_behind_hitch_m"];
    refused("kraz", &pairs, &parts);
}
