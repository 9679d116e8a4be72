//! Options from Python for reading logs and frames.

use std::path::PathBuf;

use cg_core::signal::j1939::Compensation;
use cg_logs::can::{MappedSignal, SignalMap, Vdc2};
use cg_logs::log::{CanOptions, LogOptions, UnknownSignal};
use pyo3::prelude::*;

use crate::error::{dbc_error, option_error, value_error};
use crate::options::{text, word};

/// Options from `columns` as text (`roll=MyName[deg]`) and `flip` as names of signals (`roll`).
pub(crate) fn log_options(columns: &[String], flip: &[String]) -> PyResult<LogOptions> {
    let columns = columns.iter().map(|text| text.parse()).collect::<Result<_, _>>();
    let flip = flip.iter().map(|text| text.parse()).collect::<Result<_, UnknownSignal>>();
    Ok(LogOptions {
        columns: columns.map_err(option_error)?,
        flip: flip.map_err(|error| value_error(format!("flip: {error}")))?,
        ..LogOptions::default()
    })
}

/// The rules for decoding frames, as Python passes them: a dict with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    dbc: Option<PathBuf>,
    signals: Vec<String>,
    flip: Vec<String>,
    #[pyo3(from_py_with = text)]
    roll_compensated: String,
    #[pyo3(from_py_with = text)]
    vdc2: String,
    bus: Option<String>,
}

impl Reading {
    pub(crate) fn options(&self) -> PyResult<LogOptions> {
        let compensation: Compensation = word("roll_compensated", &self.roll_compensated)?;
        let vdc2: Vdc2 = word("vdc2", &self.vdc2)?;
        let maps: Vec<SignalMap> = self
            .signals
            .iter()
            .map(|text| text.parse().map_err(|error| value_error(format!("signals: {error}"))))
            .collect::<PyResult<_>>()?;
        let mapped = match &self.dbc {
            Some(path) => MappedSignal::load(path, &maps).map_err(dbc_error)?,
            None => Vec::new(),
        };
        let can = CanOptions {
            mapped,
            compensation,
            vdc2,
            bus: self.bus.clone(),
            ..CanOptions::default()
        };
        Ok(LogOptions { can, ..log_options(&[], &self.flip)? })
    }
}
