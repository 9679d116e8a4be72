//! Compares the tables of tires and springs with each other and with the static loads.

use super::relation::{Relation, Relations};
use crate::tables::Spring;
use crate::vehicle::{AsPrinted, Tyre, Vehicle};

/// Relations that do not depend on the static loads.
pub(super) fn relations(v: &Vehicle, relations: &mut Relations) {
    for (i, tyre) in v.tyre.iter().enumerate() {
        stiffness(&format!("tyre[{i}]"), tyre, relations);
    }
    for (i, one) in v.spring.iter().enumerate() {
        spring(&format!("spring[{i}]"), one, relations);
    }
    for (path, readings) in v.pressure_readings() {
        let (pa, kg) = (readings.gauge_pa, readings.axle_load_kg);
        relations.check(Relation {
            key: format!("{path}.gauge_pa"),
            value: pa[0],
            with: vec![format!("{path}.axle_load_kg")],
            what: "the load per bar",
            quantity: (kg[1] - kg[0]) / (pa[1] - pa[0]) * 1e5,
            unit: "kg",
            usual: [500.0, 3e4],
            possible: [50.0, 3e5],
        });
    }
    if let Some(printed) = &v.as_printed {
        as_printed(v, printed, relations);
    }
}

/// Compares the cornering stiffness with the load, and the aligning stiffness with the cornering
/// stiffness.
fn stiffness(path: &str, tyre: &Tyre, relations: &mut Relations) {
    let (cornering, aligning) =
        (&tyre.cornering_stiffness_n_per_rad, &tyre.aligning_stiffness_nm_per_rad);
    for (j, &load_n) in tyre.load_n.iter().enumerate().filter(|(_, load_n)| **load_n > 0.0) {
        let key = format!("{path}.cornering_stiffness_n_per_rad[{j}]");
        let Some(&stiffness) = cornering.get(j) else { return };
        relations.check(Relation {
            key: key.clone(),
            value: stiffness,
            with: vec![format!("{path}.load_n[{j}]")],
            what: "the cornering stiffness divided by the load",
            quantity: stiffness / load_n,
            unit: "per rad",
            usual: [3.0, 15.0],
            possible: [0.5, 50.0],
        });
        let Some(&moment) = aligning.get(j).filter(|moment| **moment > 0.0) else { continue };
        relations.check(Relation {
            key: format!("{path}.aligning_stiffness_nm_per_rad[{j}]"),
            value: moment,
            with: vec![key],
            what: "the pneumatic trail",
            quantity: moment / stiffness,
            unit: "m",
            usual: [0.004, 0.15],
            possible: [0.0, 0.6],
        });
    }
}

/// The slopes of a measured spring, and its friction.
fn spring(path: &str, spring: &Spring, relations: &mut Relations) {
    let greatest_n = spring.compression_n.last().copied().unwrap_or_default();
    for (key, force) in
        [("compression_n", &spring.compression_n), ("extension_n", &spring.extension_n)]
    {
        let steps = force.windows(2).zip(spring.deflection_m.windows(2)).enumerate();
        for (j, (force, deflection)) in steps {
            relations.check(Relation {
                key: format!("{path}.deflection_m[{}]", j + 1),
                value: deflection[1],
                with: vec![
                    format!("{path}.deflection_m[{j}]"),
                    format!("{path}.{key}[{j}]"),
                    format!("{path}.{key}[{}]", j + 1),
                ],
                what: "the stiffness",
                quantity: (force[1] - force[0]) / (deflection[1] - deflection[0]),
                unit: "N/m",
                usual: [0.0, 1.5e7],
                possible: [0.0, 1e8],
            });
        }
    }
    for (j, (up, down)) in spring.compression_n.iter().zip(&spring.extension_n).enumerate() {
        if *up > 0.1 * greatest_n {
            relations.check(Relation {
                key: format!("{path}.extension_n[{j}]"),
                value: *down,
                with: vec![format!("{path}.compression_n[{j}]")],
                what: "its share of the force under compression",
                quantity: down / up,
                unit: "",
                usual: [0.25, 1.0],
                possible: [-1.0, 1.0],
            });
        }
    }
}

/// Compares the static loads (all axles, the tractor's first) with tires and springs.
pub(super) fn loaded(v: &Vehicle, axle_load_n: &[f64], relations: &mut Relations) {
    for (k, (placed, &load_n)) in v.axles().iter().zip(axle_load_n).enumerate() {
        let tractor = v.tractor.axle.len();
        let path = if placed.on_trailer {
            format!("trailer.axle[{}]", k - tractor)
        } else {
            format!("tractor.axle[{k}]")
        };
        let sprung_n = load_n - placed.axle.unsprung_mass_kg * v.gravity_mps2;
        relations.check(Relation {
            key: format!("{path}.spring_stiffness_n_per_m"),
            value: placed.axle.spring_stiffness_n_per_m,
            with: vec!["trailer.reference_mass_kg".to_owned()],
            what: "the static load divided by the stiffness of its springs",
            quantity: sprung_n / (2.0 * placed.axle.spring_stiffness_n_per_m),
            unit: "m",
            usual: [0.002, 0.4],
            possible: [-0.1, 3.0],
        });
        let Some(i) = v.tyre.iter().position(|tyre| tyre.name == placed.axle.tyre) else {
            continue;
        };
        tyre(&format!("tyre[{i}]"), placed.tyre, load_n / placed.tyres(), relations);
    }
}

/// The deflection of a tire under its static load, and the range of loads in its tables.
fn tyre(path: &str, tyre: &Tyre, load_n: f64, relations: &mut Relations) {
    let stiffness = tyre.vertical_stiffness_n_per_m;
    let reference = || vec!["trailer.reference_mass_kg".to_owned()];
    relations.check(Relation {
        key: format!("{path}.vertical_stiffness_n_per_m"),
        value: stiffness,
        with: reference(),
        what: "the static deflection",
        quantity: load_n / stiffness,
        unit: "m",
        usual: [0.005, 0.08],
        possible: [0.0, 0.4],
    });
    let mut lists = vec![("load_n", &tyre.load_n)];
    if let Some(table) = &tyre.lateral_force {
        lists.push(("lateral_force.load_n", &table.load_n));
    }
    if let Some(table) = &tyre.aligning_moment {
        lists.push(("aligning_moment.load_n", &table.load_n));
    }
    for (key, loads) in lists {
        let (Some(&least_n), Some(&greatest_n)) = (loads.first(), loads.last()) else { continue };
        let end = loads.len() - 1;
        for (j, value, what, quantity, usual, possible) in [
            (
                end,
                greatest_n,
                "the static load divided by it",
                load_n / greatest_n,
                [0.05, 1.05],
                [0.0, 10.0],
            ),
            (
                0,
                least_n,
                "its share of the static load",
                least_n / load_n,
                [0.0, 1.0],
                [0.0, 100.0],
            ),
        ] {
            let key = format!("{path}.{key}[{j}]");
            let (with, unit) = (reference(), "");
            relations.check(Relation { key, value, with, what, quantity, unit, usual, possible });
        }
    }
}

/// Compares the parameters of the printed model with the rest of the file.
fn as_printed(v: &Vehicle, printed: &AsPrinted, relations: &mut Relations) {
    let (t, g) = (&v.tractor, v.gravity_mps2);
    let unsprung_kg: f64 = t.axle.iter().map(|axle| axle.axle.unsprung_mass_kg).sum();
    let trailer_kg = v.trailer.reference_mass_kg;
    let sprung_above_m = v.trailer.reference_cg_height_m - v.hitch.height_m;
    let axles = v.axles();
    let first_m = axles.first().map_or(f64::NAN, |placed| placed.axle.center_height_m);
    let mut shares = vec![
        ("tractor_mass_kg".to_owned(), printed.tractor_mass_kg, t.sprung_mass_kg + unsprung_kg),
        ("trailer_mass_kg".to_owned(), printed.trailer_mass_kg, trailer_kg),
        ("wheel_radius_m".to_owned(), printed.wheel_radius_m, first_m),
        (
            "trailer_sprung_cg_above_hitch_m".to_owned(),
            printed.trailer_sprung_cg_above_hitch_m,
            sprung_above_m,
        ),
    ];
    for (i, (placed, &weight_n)) in axles.iter().zip(&printed.unsprung_weight_n).enumerate() {
        let key = format!("unsprung_weight_n[{i}]");
        shares.push((key, weight_n, placed.axle.unsprung_mass_kg * g));
    }
    for (key, value, expected) in shares {
        relations.check(Relation {
            key: format!("as_printed.{key}"),
            value,
            with: Vec::new(),
            what: "its ratio to the value that follows from the rest of the file",
            quantity: value / expected,
            unit: "",
            usual: [0.95, 1.05],
            possible: [-1e3, 1e3],
        });
    }
}
