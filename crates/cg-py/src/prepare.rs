//! `prepare`: tables whose rows are no samples yet.

use cg_core::Quantity;
use cg_logs::log::{LogOptions, LogRow, Plausibility, Preparation, Rasters, Signal};
use cg_vehicle::Variant;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{in_python, value_error, vehicle_error};
use crate::log::table;
use crate::options::word;
use crate::reading::log_options;
use crate::signals::{ROLL_GAIN_SD, any_columns, borrowed, columns};
use crate::vehicle::Vehicle;

/// What a table needs before its rows are samples: channels of different rasters are aligned, and a roll
/// rate becomes a roll angle. Values that the vehicle cannot have are absent then. Returns the table and
/// remarks about it, or nothing if its rows are samples. `apart`: whether the channels are known to have
/// time stamps of their own.
#[pyfunction]
#[pyo3(signature = (signals, vehicle, apart, /))]
pub(crate) fn prepare<'py>(
    py: Python<'py>,
    signals: &Bound<'py, PyDict>,
    vehicle: Option<&Bound<'py, Vehicle>>,
    apart: bool,
) -> PyResult<Option<(Bound<'py, PyDict>, Vec<String>)>> {
    let arrays = borrowed(signals)?;
    // What is only looked at may lack an input.
    let columns = if vehicle.is_some() { columns(&arrays) } else { any_columns(&arrays) }?;
    let settings = vehicle.map(|vehicle| vehicle.get().inner.align_settings());
    let mut plausibility = settings.map(Plausibility::new);
    let quantities = columns.quantities();
    let row = |index: usize, plausibility: &mut Option<Plausibility>| match plausibility {
        Some(plausibility) => columns.believed(index, &quantities, plausibility),
        None => columns.checked(index),
    };
    let mut looking = plausibility.clone();
    let rasters = if apart {
        Rasters::apart()
    } else {
        Rasters::of((0..columns.rows()).map_while(|index| row(index, &mut looking).ok()))
    };
    let options = match vehicle.map(Bound::get) {
        Some(vehicle) => {
            let variant = Variant::Complete; // scales are those of any
            LogOptions::default().of_vehicle(&vehicle.file, vehicle.lift_axle, variant)
        }
        None => Ok(LogOptions::default()),
    };
    let options = options.map_err(vehicle_error)?;
    let Some(mut preparation) = Preparation::of(&columns.signals(), &rasters, &options) else {
        return Ok(None);
    };
    let mut prepare = || -> Result<Vec<LogRow>, String> {
        for index in 0..columns.rows() {
            preparation.push(index as u64, row(index, &mut plausibility)?);
        }
        preparation.finish();
        Ok(std::iter::from_fn(|| preparation.next_row()).map(|(_, row)| row).collect())
    };
    let rows = py.detach(&mut prepare).map_err(value_error)?;
    let doubts = plausibility.iter().flat_map(Plausibility::remarks);
    let remarks = preparation.remarks().into_iter().chain(doubts);
    let remarks = remarks.map(|remark| in_python(&remark)).collect();
    let table = table(py, &rows)?;
    // For an estimate; a table that is only looked at has signals alone.
    if vehicle.is_some() && rows.iter().any(|row| row.roll_gain_sd > 0.0) {
        let gains = rows.iter().map(|row| row.roll_gain_sd);
        table.set_item(ROLL_GAIN_SD, PyArray1::from_iter(py, gains))?;
    }
    Ok(Some((table, remarks)))
}

/// The SI column of a signal, and what values of a measured channel are multiplied by to be in its unit.
#[pyfunction]
#[pyo3(signature = (signal, name, unit, flip, /))]
pub(crate) fn channel_factor(
    signal: &str,
    name: &str,
    unit: &str,
    flip: Vec<String>,
) -> PyResult<(&'static str, f64)> {
    let quantity: Quantity = word("signals", signal)?;
    let dimension = quantity.dimension();
    let unit = dimension.spelled(unit).ok_or_else(|| {
        let known: Vec<&str> = dimension.units().iter().map(|unit| unit.suffix).collect();
        value_error(format!(
            "{name} has the unit {unit:?}: give one of {}, such as \"{name}[{}]\"",
            known.join(", "),
            known[1]
        ))
    })?;
    let flipped = log_options(&[], &flip)?.flip.contains(&Signal::from(quantity));
    let factor = unit.times / unit.per;
    Ok((Signal::from(quantity).column(), if flipped { -factor } else { factor }))
}
