//! `Vehicle`: the vehicle file, and the designs made from it.

use std::path::PathBuf;
use std::sync::OnceLock;

use cg_core::Design;
use cg_vehicle::design::design;
use cg_vehicle::{Variant, VehicleError};
use pyo3::prelude::*;

use crate::error::vehicle_error;

/// A tractor-semitrailer, read from a vehicle file (TOML) with `Vehicle.load`.
///
/// It never changes, and may be used from several threads. What the estimator needs of it is
/// computed once, by the first estimate.
#[pyclass(frozen, module = "cgheight")]
pub(crate) struct Vehicle {
    pub(crate) inner: cg_vehicle::Vehicle,
    complete: OnceLock<Design<f64>>,
    as_printed: OnceLock<Design<f64>>,
}

impl Vehicle {
    /// The design for one set of equations: computed on first use.
    pub(crate) fn design(&self, variant: Variant) -> Result<&Design<f64>, VehicleError> {
        let cell = match variant {
            Variant::Complete => &self.complete,
            Variant::AsPrinted => &self.as_printed,
        };
        if let Some(known) = cell.get() {
            return Ok(known);
        }
        let computed = design(&self.inner, variant)?;
        Ok(cell.get_or_init(|| computed))
    }
}

#[pymethods]
impl Vehicle {
    /// Read and check a vehicle file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The vehicle file (TOML, SI units).
    ///
    /// Raises
    /// ------
    /// FileNotFoundError
    ///     There is no such file.
    /// ValueError
    ///     The file is not that of a vehicle; the message names line, column, key and remedy.
    #[staticmethod]
    #[pyo3(signature = (path, /))]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let inner = py.detach(|| cg_vehicle::Vehicle::load(&path)).map_err(vehicle_error)?;
        Ok(Self { inner, complete: OnceLock::new(), as_printed: OnceLock::new() })
    }

    /// Name of the vehicle, str.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Speed taken when nothing else is said, m/s.
    #[getter]
    fn nominal_speed_mps(&self) -> f64 {
        self.inner.nominal_speed_mps
    }

    /// Mass of the whole semitrailer (sprung mass and axles) when nothing else is said, kg.
    #[getter]
    fn reference_trailer_mass_kg(&self) -> f64 {
        self.inner.trailer.reference_mass_kg
    }

    /// Height of the trailer's sprung c.g. above ground when nothing else is said, m.
    #[getter]
    fn reference_height_m(&self) -> f64 {
        self.inner.trailer.reference_cg_height_m
    }

    fn __repr__(&self) -> String {
        let trailer = &self.inner.trailer;
        format!(
            "Vehicle({:?}, {:.2} m/s, trailer {:.0} kg, c.g. height {:.3} m)",
            self.inner.name,
            self.inner.nominal_speed_mps,
            trailer.reference_mass_kg,
            trailer.reference_cg_height_m
        )
    }
}
