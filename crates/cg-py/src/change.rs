//! Values of Python for keys of a vehicle file.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt, PyList, PyMapping, PyString, PyTuple};
use toml::{Table, Value};

use crate::error::value_error;

/// Keys with their new values, such as `trailer.axle[0].spring_spread_m`.
pub(crate) fn changes(
    paths: Option<&Bound<'_, PyMapping>>,
    keys: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<(String, Value)>> {
    let mut all = Vec::new();
    let items = [paths.map(PyMappingMethods::items), keys.map(|keys| Ok(keys.items()))];
    for item in items.into_iter().flatten().collect::<PyResult<Vec<_>>>()?.iter().flatten() {
        let (path, new): (String, Bound<'_, PyAny>) = item.extract()?;
        let new = value(&path, &new)?;
        all.push((path, new));
    }
    Ok(all)
}

/// A value of a vehicle file; `path` is its key in messages.
fn value(path: &str, new: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(flag) = new.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(text) = new.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if new.is_instance_of::<PyInt>() {
        return Ok(Value::Integer(new.extract()?));
    }
    if let Ok(table) = new.cast::<PyMapping>() {
        let mut entries = Table::new();
        for (key, new) in changes(Some(table), None)? {
            entries.insert(key, new);
        }
        return Ok(Value::Table(entries));
    }
    if new.is_instance_of::<PyList>() || new.is_instance_of::<PyTuple>() {
        let items = new.try_iter()?.map(|item| value(path, &item?));
        return items.collect::<PyResult<_>>().map(Value::Array);
    }
    // Also the floats of numpy.
    new.extract().map(Value::Float).map_err(|_| {
        let text = new.repr().map_or_else(|_| String::new(), |text| text.to_string());
        value_error(format!(
            "{path} is {text}: a key of a vehicle file has a number, text, True or False, or a \
             list or dict of these"
        ))
    })
}
