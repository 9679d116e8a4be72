//! Tests that the table of keys agrees with the structure of the vehicle.

use cg_vehicle::VehicleError;
use cg_vehicle::check::{Key, Kind, Range, TABLES, key};
use toml::{Table, Value};

use crate::check::{numbers, parsed, table, words};

/// A file that contains every table.
fn complete() -> Table {
    let mut root = table("baseline-tables");
    let printed = table("baseline").remove("as_printed").unwrap();
    root.insert("as_printed".to_owned(), printed);
    let readings = "gauge_pa = [1e5, 4e5]\naxle_load_kg = [6e3, 2e4]".parse().unwrap();
    let trailer = root.get_mut("trailer").unwrap().as_table_mut().unwrap();
    trailer.insert("suspension_pressure".to_owned(), Value::Table(readings));
    let sensors = "[roll]\nbehind_hitch_m = 7.0\nsecond_behind_hitch_m = 0.5\n[accelerometer]\nheight_m = 1.1\n[tractor_accelerometer]\nheight_m = 0.9\n\
                   [level]\nspread_m = 1.0\n[tractor_level]\nspread_m = 0.9\n\
                   [drive_pressure]\ngauge_pa = [1e5, 4e5]\naxle_load_kg = [5e3, 1.8e4]\n\
                   [yaw_rate]\non_tractor = true\n[mass]\nweighed_sd_kg = 20.0";
    root.insert("sensors".to_owned(), Value::Table(sensors.parse().unwrap()));
    root.insert("road".to_owned(), Value::Table("bank_sd_rad = 0.02".parse().unwrap()));
    let side = "side_area_m2 = 36.0\nside_height_m = 2.4".parse().unwrap();
    root.insert("wind".to_owned(), Value::Table(side));
    root
}

/// The first table of the file at a path of the table of keys.
fn first<'a>(root: &'a mut Table, path: &str) -> &'a mut Table {
    path.split('.').filter(|step| !step.is_empty()).fold(root, |table, step| {
        let name = step.trim_end_matches("[i]");
        let entry = table.get_mut(name).unwrap_or_else(|| panic!("no {path}"));
        if step == name { entry.as_table_mut() } else { entry[0].as_table_mut() }.unwrap()
    })
}

/// A value in the middle of the usual range.
fn usual(key: &Key) -> Value {
    let middle = |range: Range| {
        let [low, high] = range.usual;
        Value::Float(if low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) })
    };
    match key.kind {
        Kind::Number(range) => middle(range),
        Kind::Whole => Value::Integer(7),
        Kind::Flag => Value::Boolean(true),
        _ => panic!("{} is in no file", key.name),
    }
}

#[test]
fn every_key_of_the_table_is_read_and_only_the_required_ones_must_be_there() {
    for entry in TABLES {
        for path in entry.paths {
            for key in entry.keys {
                let case = format!("{path}.{}", key.name);
                let mut root = complete();
                let place = first(&mut root, path);
                let value = place.entry(key.name).or_insert_with(|| usual(key)).clone();
                let vehicle = parsed(&root).unwrap_or_else(|error| panic!("{case}: {error}")).0;
                let mut written = Table::try_from(&vehicle).unwrap();
                let written = first(&mut written, path).get(key.name);
                let same = match value {
                    // Compared as text, because a whole number is read as a float.
                    Value::Integer(n) => written.is_some_and(|w| {
                        *w == value || *w == Value::Float(f64::from(i32::try_from(n).unwrap()))
                    }),
                    _ => written.is_some(),
                };
                assert!(same, "{case}: {value} {written:?}");
                first(&mut root, path).remove(key.name);
                let missing = matches!(parsed(&root), Err(VehicleError::Syntax { .. }));
                assert_eq!(missing, key.required, "{case}");
            }
        }
    }
}

#[test]
fn every_number_that_is_read_is_in_the_table() {
    let vehicle = parsed(&complete()).unwrap().0;
    let root = Table::try_from(&vehicle).unwrap();
    let mut ways = Vec::new();
    numbers(&Value::Table(root.clone()), &[], &mut ways);
    assert!(ways.len() > 200);
    for way in ways {
        let mut end = way.len();
        while matches!(way[end - 1], crate::check::Step::Index(_)) {
            end -= 1;
        }
        let digits = |c: char| c.is_ascii_digit();
        let place: String = words(&way[..end])
            .split('[')
            .enumerate()
            .map(|(i, part)| {
                if i == 0 {
                    part.to_owned()
                } else {
                    format!("[i{}", part.trim_start_matches(digits))
                }
            })
            .collect();
        let known = key(&place).unwrap_or_else(|| panic!("{place} is not in the table"));
        assert!(known.range().is_some() || known.kind == Kind::Whole, "{place}");
    }
}

#[test]
fn every_key_says_what_it_means_and_its_ranges_hold_each_other() {
    for entry in TABLES {
        assert!(!entry.meaning.is_empty());
        for key in entry.keys {
            assert!(!key.meaning.is_empty(), "{}", key.name);
            let Some(range) = key.range() else { continue };
            let ([least, greatest], [low, high]) = (range.possible, range.usual);
            assert!(least <= low && low < high && high <= greatest, "{}", key.name);
            assert!(range.also.is_none_or(|(also, _)| range.is_possible(also)), "{}", key.name);
            // A factor of 1000 leaves the usual range from any value in it.
            assert!(low <= 0.0 || high / low < 1000.0, "{}", key.name);
            assert!(range.distance(low) <= 1.0 + 1e-9 && range.distance(high * 1.01) > 1.0);
        }
    }
}
