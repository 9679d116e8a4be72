//! Detects numbers of a vehicle file that contradict each other.

use std::collections::HashSet;

use super::relation::{Relation, Relations, keys, list_of};
use super::tables;
use crate::balance;
use crate::finding::{Finding, Severity};
use crate::load::Load;
use crate::vehicle::{Axle, Vehicle};

/// Findings about related numbers, except those with a number that already has an error.
pub(super) fn findings(v: &Vehicle, known: &[Finding]) -> Vec<Finding> {
    let refused = known.iter().filter(|finding| finding.severity == Severity::Error);
    let bad: HashSet<String> = refused.map(|finding| list_of(&finding.key).to_owned()).collect();
    let sound = bad.is_empty();
    let mut relations = Relations { bad, found: Vec::new() };
    inertias(v, &mut relations);
    heights(v, &mut relations);
    positions(v, &mut relations);
    for (path, axle) in axles(v) {
        widths(&path, axle, &mut relations);
        deflection(&path, axle, v, &mut relations);
    }
    anti_roll(v, &mut relations);
    tables::relations(v, &mut relations);
    if sound {
        loads(v, &mut relations);
    }
    relations.found
}

/// All axles with their paths in the file, tractor first.
pub(super) fn axles(v: &Vehicle) -> Vec<(String, &Axle)> {
    let tractor = v.tractor.axle.iter().map(|a| &a.axle).enumerate();
    let trailer = v.trailer.axle.iter().map(|a| &a.axle).enumerate();
    tractor
        .map(|(i, axle)| (format!("tractor.axle[{i}]"), axle))
        .chain(trailer.map(|(i, axle)| (format!("trailer.axle[{i}]"), axle)))
        .collect()
}

/// Radii of gyration, because the inertia of a body follows from its mass and size.
fn inertias(v: &Vehicle, relations: &mut Relations) {
    let (t, s) = (&v.tractor, &v.trailer.tare);
    let tractor = ("tractor", t.sprung_mass_kg, "sprung_mass_kg");
    let tare = ("trailer.tare", s.sprung_mass_kg, "sprung_mass_kg");
    let mut all = vec![
        (tractor, "roll_inertia_kgm2", Some(t.roll_inertia_kgm2), [0.4, 1.1], [0.2, 2.0]),
        (tractor, "yaw_inertia_kgm2", Some(t.yaw_inertia_kgm2), [1.1, 2.8], [0.5, 5.0]),
        (tractor, "pitch_inertia_kgm2", t.pitch_inertia_kgm2, [1.1, 2.8], [0.5, 5.0]),
        (tare, "roll_inertia_kgm2", Some(s.roll_inertia_kgm2), [0.6, 1.7], [0.3, 3.0]),
        (tare, "yaw_inertia_kgm2", Some(s.yaw_inertia_kgm2), [2.0, 5.5], [0.8, 9.0]),
        (tare, "pitch_inertia_kgm2", s.pitch_inertia_kgm2, [2.0, 5.5], [0.8, 9.0]),
    ];
    let axles = axles(v);
    for (path, axle) in &axles {
        let body = (path.as_str(), axle.unsprung_mass_kg, "unsprung_mass_kg");
        all.push((body, "roll_inertia_kgm2", Some(axle.roll_inertia_kgm2), [0.5, 1.1], [0.2, 2.0]));
    }
    for ((path, mass_kg, mass), key, inertia_kgm2, usual, possible) in all {
        let Some(inertia_kgm2) = inertia_kgm2 else { continue };
        relations.check(Relation {
            key: format!("{path}.{key}"),
            value: inertia_kgm2,
            with: vec![format!("{path}.{mass}")],
            what: "the radius of gyration",
            quantity: (inertia_kgm2 / mass_kg).sqrt(),
            unit: "m",
            usual,
            possible,
        });
    }
}

fn heights(v: &Vehicle, relations: &mut Relations) {
    let (height, bed, tare) = (&v.height, &v.trailer.payload, &v.trailer.tare);
    relations.check(Relation {
        key: "height.greatest_m".to_owned(),
        value: height.greatest_m,
        with: keys(&["height.least_m"]),
        what: "the range of heights",
        quantity: height.greatest_m - height.least_m,
        unit: "m",
        usual: [0.5, 3.5],
        possible: [0.0, 6.0],
    });
    for (key, value, what, quantity, usual, possible) in [
        (
            "height.greatest_m",
            height.greatest_m,
            "its height above the floor of the payload",
            height.greatest_m - bed.floor_height_m,
            [0.3, 3.5],
            [0.0, 6.0],
        ),
        (
            "height.least_m",
            height.least_m,
            "its height above the floor of the payload",
            height.least_m - bed.floor_height_m,
            [-1.0, 0.6],
            [-3.0, 2.0],
        ),
    ] {
        let (key, with) = (key.to_owned(), keys(&["trailer.payload.floor_height_m"]));
        relations.check(Relation { key, value, with, what, quantity, unit: "m", usual, possible });
    }
    let sprung_kg = v.trailer.reference_mass_kg - v.trailer_unsprung_mass_kg();
    let share = 1.0 - tare.sprung_mass_kg / sprung_kg;
    if share > 0.1 {
        let reference_m = v.trailer.reference_cg_height_m;
        let payload_m = tare.cg_height_m + (reference_m - tare.cg_height_m) / share;
        relations.check(Relation {
            key: "trailer.reference_cg_height_m".to_owned(),
            value: reference_m,
            with: keys(&[
                "trailer.reference_mass_kg",
                "trailer.tare.sprung_mass_kg",
                "trailer.tare.cg_height_m",
                "trailer.payload.floor_height_m",
            ]),
            what: "the payload's c.g. above its floor",
            quantity: payload_m - bed.floor_height_m,
            unit: "m",
            usual: [0.05, 2.0],
            possible: [-2.5, 6.0],
        });
    }
}

#[allow(clippy::cast_precision_loss)] // a few axles
fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

/// Positions of axles, fifth wheel and bodies along the vehicle.
fn positions(v: &Vehicle, relations: &mut Relations) {
    let tractor = &v.tractor.axle;
    let ahead = |i: usize| format!("tractor.axle[{i}].ahead_of_cg_m");
    let mut meters = |key: String, value, with, what, quantity, usual, possible| {
        relations.check(Relation { key, value, with, what, quantity, unit: "m", usual, possible });
    };
    for (i, axle) in tractor.iter().enumerate() {
        // A second steered axle may be under the c.g.
        let value = axle.ahead_of_cg_m;
        let usual = if i == 0 { [0.3, 3.2] } else { [-8.0, -0.2] };
        let possible = if i == 0 { [-1.0, 6.0] } else { [-12.0, 3.0] };
        let what = "its distance ahead of the tractor's sprung c.g.";
        meters(ahead(i), value, keys(&["tractor.sprung_mass_kg"]), what, value, usual, possible);
    }
    for (i, pair) in tractor.windows(2).enumerate() {
        let (one, two) = (pair[0].ahead_of_cg_m, pair[1].ahead_of_cg_m);
        let wheelbase = pair[0].steered && !pair[1].steered;
        let usual = if wheelbase { [2.2, 7.5] } else { [1.0, 4.0] };
        let what = "the distance between two axles";
        meters(ahead(i + 1), two, vec![ahead(i)], what, one - two, usual, [0.4, 15.0]);
    }
    let driven: Vec<usize> = (0..tractor.len()).filter(|&i| !tractor[i].steered).collect();
    if !driven.is_empty() {
        let hitch_m = v.tractor.hitch_behind_cg_m;
        let middle_m = mean(driven.iter().map(|&i| tractor[i].ahead_of_cg_m));
        let (key, with) = ("tractor.hitch_behind_cg_m", driven.into_iter().map(ahead).collect());
        let what = "the fifth wheel's distance ahead of the driven axles";
        meters(key.to_owned(), hitch_m, with, what, -hitch_m - middle_m, [-0.4, 1.6], [-2.5, 5.0]);
    }
    let trailer = &v.trailer.axle;
    let behind = |i: usize| format!("trailer.axle[{i}].behind_hitch_m");
    for (i, pair) in trailer.windows(2).enumerate() {
        let (one, two) = (pair[0].behind_hitch_m, pair[1].behind_hitch_m);
        let what = "the distance between two axles";
        meters(behind(i + 1), two, vec![behind(i)], what, two - one, [1.0, 4.0], [0.4, 10.0]);
    }
    if trailer.is_empty() {
        return;
    }
    let middle_m = mean(trailer.iter().map(|axle| axle.behind_hitch_m));
    let (tare, bed) = (&v.trailer.tare, &v.trailer.payload);
    for (key, value) in [
        ("trailer.tare.cg_behind_hitch_m", tare.cg_behind_hitch_m),
        ("trailer.payload.behind_hitch_m", bed.behind_hitch_m),
    ] {
        let with = (0..trailer.len()).map(behind).collect();
        let what = "its distance ahead of the middle of the trailer's axles";
        meters(key.to_owned(), value, with, what, middle_m - value, [0.0, 8.0], [-6.0, 25.0]);
    }
    let front_m = bed.behind_hitch_m - 0.5 * bed.length_m;
    let with = keys(&["trailer.payload.behind_hitch_m"]);
    let what = "the payload's front end behind the fifth wheel";
    let key = "trailer.payload.length_m".to_owned();
    meters(key, bed.length_m, with, what, front_m, [-2.0, 8.0], [-6.0, 20.0]);
}

/// Springs, dampers and tires across an axle.
fn widths(path: &str, axle: &Axle, relations: &mut Relations) {
    let tyres = format!("{path}.tyre_positions_m");
    let inner_m = axle.tyre_positions_m.iter().copied().fold(f64::INFINITY, f64::min);
    let spreads = [
        ("spring_spread_m", Some(axle.spring_spread_m), [0.02, 0.8]),
        ("damper_spread_m", axle.damper_spread_m, [-0.3, 0.9]),
    ];
    for (key, spread_m, usual) in spreads {
        let Some(spread_m) = spread_m else { continue };
        relations.check(Relation {
            key: format!("{path}.{key}"),
            value: spread_m,
            with: vec![tyres.clone()],
            what: "the distance from half of it to the inner tire",
            quantity: inner_m - 0.5 * spread_m,
            unit: "m",
            usual,
            possible: [-1.5, 2.0],
        });
    }
    if let [one, two] = axle.tyre_positions_m[..] {
        relations.check(Relation {
            key: format!("{tyres}[1]"),
            value: two,
            with: vec![format!("{tyres}[0]")],
            what: "the distance between dual tires",
            quantity: (two - one).abs(),
            unit: "m",
            usual: [0.25, 0.45],
            possible: [0.15, 1.0],
        });
    }
}

/// Compares the height of an axle's center with the radius of its tires, or with the other axles
/// that have the same tires.
fn deflection(path: &str, axle: &Axle, v: &Vehicle, relations: &mut Relations) {
    let Some((i, tyre)) = v.tyre.iter().enumerate().find(|(_, tyre)| tyre.name == axle.tyre) else {
        return;
    };
    let (key, center_m) = (format!("{path}.center_height_m"), axle.center_height_m);
    if let Some(radius_m) = tyre.unloaded_radius_m {
        relations.check(Relation {
            key,
            value: center_m,
            with: vec![format!("tyre[{i}].unloaded_radius_m")],
            what: "the deflection of its tire",
            quantity: radius_m - center_m,
            unit: "m",
            usual: [0.003, 0.09],
            // The center of a wheel is never higher than the tire's radius; 3 mm allow for rounded
            // numbers.
            possible: [-0.003, 0.25],
        });
        return;
    }
    let others = axles(v);
    let Some((other, first)) = others.iter().find(|(_, other)| other.tyre == axle.tyre) else {
        return;
    };
    if other != path {
        relations.check(Relation {
            key,
            value: center_m,
            with: vec![format!("{other}.center_height_m")],
            what: "its height above that of an axle with the same tires",
            quantity: center_m - first.center_height_m,
            unit: "m",
            usual: [-0.05, 0.05],
            possible: [-0.3, 0.3],
        });
    }
}

/// Neighboring axles that are not steered are similar: either both or none of them have an
/// anti-roll bar.
fn anti_roll(v: &Vehicle, relations: &mut Relations) {
    let driven = v.tractor.axle.iter().filter(|axle| !axle.steered).count();
    let all = axles(v);
    let (tractor, trailer) = all.split_at(v.tractor.axle.len());
    let alike = [&tractor[tractor.len() - driven..], trailer];
    for pair in alike.into_iter().flat_map(|axles| axles.windows(2)) {
        let [(before, one), (path, two)] = pair else { continue };
        let key = "auxiliary_roll_stiffness_nm_per_rad";
        let value = two.auxiliary_roll_stiffness_nm_per_rad;
        let other = one.auxiliary_roll_stiffness_nm_per_rad;
        let (less, more) = (value.min(other), value.max(other));
        relations.check(Relation {
            key: format!("{path}.{key}"),
            value,
            with: vec![format!("{before}.{key}")],
            what: "the smaller value divided by the greater one",
            quantity: if more > 0.0 { less / more } else { 1.0 },
            unit: "",
            usual: [0.1, 1.0],
            possible: [0.0, 1.0],
        });
    }
}

/// The springs of one unit lift its frame by similar heights; otherwise the loads of its axles
/// would differ greatly.
fn free_rises(v: &Vehicle, relations: &mut Relations) {
    if !balance::depends_on_stiffness(v) {
        return;
    }
    for pair in axles(v).windows(2) {
        let [(before, one), (path, two)] = pair else { continue };
        if before.split('.').next() != path.split('.').next() {
            continue;
        }
        relations.check(Relation {
            key: format!("{path}.spring_free_rise_m"),
            value: two.spring_free_rise_m,
            with: vec![format!("{before}.spring_free_rise_m")],
            what: "the difference between two axles",
            quantity: two.spring_free_rise_m - one.spring_free_rise_m,
            unit: "m",
            usual: [-0.05, 0.05],
            possible: [-0.8, 0.8],
        });
    }
}

/// Static loads of axles, fifth wheel, tires and springs, for the empty trailer and at the
/// reference load.
fn loads(v: &Vehicle, relations: &mut Relations) {
    if let Err((key, value, problem)) = balance::determined(v) {
        relations.found.push(Finding::error(key, value, problem));
        return;
    }
    free_rises(v, relations);
    let reference = v.reference_load();
    let empty = Load { trailer_mass_kg: v.empty_trailer_mass_kg(), ..reference };
    let with = keys(&[
        "tractor.sprung_mass_kg",
        "tractor.hitch_behind_cg_m",
        "trailer.reference_mass_kg",
        "trailer.tare.cg_behind_hitch_m",
        "trailer.payload.behind_hitch_m",
    ]);
    for (load, axle, fifth_wheel, usual_axle_n, usual_hitch_n) in [
        (
            empty,
            "the axle's load, empty,",
            "the fifth wheel's load, empty,",
            [4e3, 1.2e5],
            [0.0, 1.5e5],
        ),
        (reference, "the axle's load", "the fifth wheel's load", [8e3, 1.4e5], [5e3, 2.5e5]),
    ] {
        let Ok(balance) = balance::solved(v, load) else { continue };
        for (i, (placed, &load_n)) in v.axles().iter().zip(&balance.axle_load_n).enumerate() {
            let key = if placed.on_trailer {
                format!("trailer.axle[{}].behind_hitch_m", i - v.tractor.axle.len())
            } else {
                format!("tractor.axle[{i}].ahead_of_cg_m")
            };
            relations.check(Relation {
                key,
                value: placed.position_m,
                with: with.clone(),
                what: axle,
                quantity: load_n,
                unit: "N",
                usual: usual_axle_n,
                possible: [1.0, 5e5],
            });
        }
        relations.check(Relation {
            key: "tractor.hitch_behind_cg_m".to_owned(),
            value: v.tractor.hitch_behind_cg_m,
            with: with.clone(),
            what: fifth_wheel,
            quantity: balance.hitch_load_n,
            unit: "N",
            usual: usual_hitch_n,
            possible: [-1e5, 1e6],
        });
        if load == reference && balance.axle_load_n.iter().all(|load_n| *load_n > 0.0) {
            tables::loaded(v, &balance.axle_load_n, relations);
        }
    }
}
