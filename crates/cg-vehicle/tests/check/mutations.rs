//! Tests with every number of vehicle files changed: multiplied by 0.001 or 1000, negated, zero, huge, or not
//! finite. (`worn-tyres-half.toml` and `-third.toml` are `baseline-tables.toml` but for one number.)

use cg_core::RatioLine;
use cg_vehicle::check;
use cg_vehicle::design::design;
use cg_vehicle::finding::Severity;
use cg_vehicle::linear::ratio_line;
use cg_vehicle::{Variant, Vehicle, VehicleError};
use toml::Value;

use crate::check::{at, list_of, numbers, parsed, table, words};

/// Greatest change of a height by an error in the file that is not reported: half the least
/// uncertainty of a height without calibration (`compensation_sd` of the files, 2 %).
const UNTOLD: f64 = 0.01;

fn mutated(value: &Value) -> Vec<Value> {
    match value {
        Value::Integer(number) => [number * 1000, -number, 0].map(Value::Integer).to_vec(),
        Value::Float(number) => {
            [number * 1e-3, number * 1e3, -number, 0.0, 1e30, f64::NAN, f64::INFINITY]
                .map(Value::Float)
                .to_vec()
        }
        _ => Vec::new(),
    }
}

/// The vehicle without the parameters that the linear model and the design do not use.
fn linear(vehicle: &Vehicle) -> Vehicle {
    let mut vehicle = vehicle.clone();
    vehicle.spring.clear();
    for tyre in &mut vehicle.tyre {
        (tyre.lateral_force, tyre.aligning_moment) = (None, None);
    }
    vehicle
}

/// The lines of the trailer's roll angle. That of the tractor's own roll changes with springs of the
/// front axle that may have any value, so it tells nothing about the file.
fn lines(vehicle: &Vehicle) -> [RatioLine<f64>; 2] {
    let (speed_mps, load) = (vehicle.nominal_speed_mps, vehicle.reference_load());
    let [steer, lateral, ..] = ratio_line(vehicle, Variant::Complete, speed_mps, load).unwrap();
    [steer, lateral]
}

/// The height that follows from a ratio of the model.
fn height_m(line: RatioLine<f64>, ratio: f64) -> f64 {
    (ratio * line.b0 - line.a0) / (line.a1 - ratio * line.b1)
}

/// A refusal names the key. A file that is accepted gives a design, or an error with the least
/// usual keys. A change that affects a height is reported.
fn survey(name: &str) {
    let root = table(name);
    let original = parsed(&root).unwrap().0;
    let (base, reference_m) = (lines(&original), original.reference_load().cg_height_m);
    let mut ways = Vec::new();
    numbers(&Value::Table(root.clone()), &[], &mut ways);
    let mut seen = vec![linear(&original)];
    let (mut refused, mut warned, mut silent) = (0, 0, 0);
    for way in ways {
        let key = words(&way);
        let before = at(&mut root.clone(), &way).clone();
        for value in mutated(&before).into_iter().filter(|value| *value != before) {
            let mut root = root.clone();
            *at(&mut root, &way) = value.clone();
            let case = format!("{name}: {key} = {value}");
            let (vehicle, warnings) = match parsed(&root) {
                Ok(accepted) => accepted,
                Err(error) => {
                    let text = error.to_string();
                    let last = list_of(&key).rsplit('.').next().unwrap();
                    let syntax = matches!(error, VehicleError::Syntax { .. });
                    let named = if syntax { last } else { list_of(&key) };
                    // If an axle leaves its load group, the loads depend on the tires.
                    let named = if last == "load_group" { last } else { named };
                    assert!(text.contains(named), "{case}: {text}");
                    refused += 1;
                    continue;
                }
            };
            assert!(warnings.iter().all(|found| found.severity == Severity::Warning));
            let told = warnings.iter().any(|found| found.to_string().contains(list_of(&key)));
            if told {
                warned += 1;
            } else {
                silent += 1;
                for (line, base) in lines(&vehicle).into_iter().zip(base) {
                    let moved = height_m(line, base.ratio_at(reference_m)) / reference_m - 1.0;
                    assert!(moved.abs() < UNTOLD, "{case}: untold, height {moved:+.4}");
                }
            }
            let model = linear(&vehicle);
            if seen.contains(&model) {
                continue;
            }
            if let Err(error) = design(&vehicle, Variant::Complete) {
                let text = error.to_string();
                let named = !told || text.contains(list_of(&key));
                let ranked = !matches!(error, VehicleError::Model(_));
                assert!(ranked && named, "{case}: {text}");
            }
            seen.push(model);
        }
    }
    println!("{name}: {refused} refused, {warned} warned, {silent} of no consequence");
    assert!(refused > warned && warned > 0);
}

#[test]
fn air() {
    survey("air");
}

#[test]
fn baseline() {
    survey("baseline");
}

#[test]
fn baseline_tables() {
    survey("baseline-tables");
}

#[test]
fn kraz() {
    survey("kraz");
}

/// A whole list in kN, mm or degrees, as people might write it.
#[test]
fn whole_lists_in_another_unit_are_refused_or_warned_of() {
    for name in crate::check::NAMES {
        let root = table(name);
        let mut ways = Vec::new();
        numbers(&Value::Table(root.clone()), &[], &mut ways);
        let mut lists: Vec<_> = ways
            .iter()
            .map(|way| way[..way.len() - 1].to_vec())
            .filter(|way| !way.is_empty())
            .filter(|way| list_of(&words(way)).len() == words(way).len())
            .filter(|way| at(&mut root.clone(), way).is_array())
            .collect();
        lists.dedup_by_key(|way| words(way));
        assert!(lists.len() > 8, "{lists:?}");
        for way in lists {
            let key = words(&way);
            if check::key(&key.replace("[0]", "[i]").replace("[1]", "[i]").replace("[2]", "[i]"))
                .is_none_or(|key| matches!(key.kind, check::Kind::Rows(_)))
            {
                continue;
            }
            for factor in [1e-3, 1e3] {
                let mut root = root.clone();
                for item in at(&mut root, &way).as_array_mut().unwrap() {
                    let number = item
                        .as_float()
                        .or(item.as_integer().map(|n| f64::from(i32::try_from(n).unwrap())))
                        .unwrap();
                    *item = Value::Float(number * factor);
                }
                let told = match parsed(&root) {
                    Ok((_, warnings)) => warnings.iter().map(ToString::to_string).collect(),
                    Err(error) => vec![error.to_string()],
                };
                assert!(told.iter().any(|text| text.contains(&key)), "{name} {key} {factor}");
            }
        }
    }
}
