//! The text of a vehicle file with other values of some keys.

use toml::{Table, Value};

use crate::error::VehicleError;

/// The text of a vehicle file with other values, each with the path of its key, such as
/// `trailer.axle[0].spring_spread_m`. A key that is not in the file is added, and a table replaces
/// the keys that it contains. The result is not checked yet.
///
/// # Errors
/// [`VehicleError`] if the text is not TOML, or if a path leads through a value or to an entry that
/// a list does not have.
///
/// ```
/// use cg_vehicle::Vehicle;
/// use cg_vehicle::guide::{TruckKind, changed, template};
///
/// let text = template(TruckKind::FourByTwoThreeAxle);
/// let text = changed(&text, "truck", [("trailer.tare.sprung_mass_kg".into(), 4800.0.into())])?;
/// assert_eq!(Vehicle::parse(&text, "truck")?.trailer.tare.sprung_mass_kg, 4800.0);
/// # Ok::<(), cg_vehicle::VehicleError>(())
/// ```
pub fn changed(
    text: &str,
    file: &str,
    changes: impl IntoIterator<Item = (String, Value)>,
) -> Result<String, VehicleError> {
    let root: Table = toml::from_str(text).map_err(|error| VehicleError::syntax(file, &error))?;
    let mut root = Value::Table(root);
    for (path, value) in changes {
        let wrong = || VehicleError::Model(format!("{path}: a vehicle file has no such key"));
        merge(place(&mut root, &path).ok_or_else(wrong)?, value);
    }
    toml::to_string(&root).map_err(|error| VehicleError::Model(error.to_string()))
}

/// The value at a path, which is made if only its last key is missing or tables above it.
fn place<'a>(root: &'a mut Value, path: &str) -> Option<&'a mut Value> {
    let mut value = root;
    for step in path.split('.') {
        let mut parts = step.split('[');
        let name = parts.next()?;
        let table = value.as_table_mut()?;
        value = table.entry(name).or_insert_with(|| Value::Table(Table::new()));
        for index in parts {
            let index: usize = index.strip_suffix(']')?.parse().ok()?;
            value = value.as_array_mut()?.get_mut(index)?;
        }
    }
    Some(value)
}

/// Replaces a value; a table keeps the keys that the new one does not have.
fn merge(old: &mut Value, new: Value) {
    match (old, new) {
        (Value::Table(old), Value::Table(new)) => {
            for (key, value) in new {
                merge(old.entry(key).or_insert_with(|| Value::Table(Table::new())), value);
            }
        }
        (old, new) => *old = new,
    }
}
