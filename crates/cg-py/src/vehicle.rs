//! `Vehicle`: the vehicle file, its optional calibration, and the designs computed from it.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cg_core::Design;
use cg_logs::estimate::{Basis, EstimateOptions, LogEstimator, RoadChoice, Truck};
use cg_logs::learn::Learned;
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::Calibration;
use cg_vehicle::design::design_with;
use cg_vehicle::files;
use cg_vehicle::guide::{TruckKind, changed, template};
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::sensor_places::Road;
use cg_vehicle::{Variant, VehicleError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::change::changes;
use crate::error::{value_error, vehicle_error, warn};
use crate::options::word;

/// A vehicle with its lift axles raised, and its design.
type Raised = (cg_vehicle::Vehicle, Design<f64>);

/// A tractor-semitrailer, read from a vehicle file (TOML) with `Vehicle.load`.
///
/// A vehicle is immutable and can be used from several threads. The first estimate computes what
/// the estimator needs; later estimates use it again.
#[pyclass(frozen, module = "cgheight")]
pub(crate) struct Vehicle {
    /// The vehicle with its lift axles where they are.
    pub(crate) inner: cg_vehicle::Vehicle,
    /// The vehicle of the file, with its lift axles down.
    pub(crate) file: cg_vehicle::Vehicle,
    /// Where the lift axles are, if that is given.
    pub(crate) lift_axle: Option<LiftAxle>,
    /// Text and name of the vehicle file, which are pickled.
    source: (String, String),
    calibration: Option<Calibration>,
    complete: OnceLock<Design<f64>>,
    as_printed: OnceLock<Design<f64>>,
    raised: OnceLock<Option<Box<Raised>>>,
}

impl Vehicle {
    fn new(
        file: cg_vehicle::Vehicle,
        source: (String, String),
        calibration: Option<Calibration>,
    ) -> Self {
        Self {
            inner: file.clone(),
            file,
            lift_axle: None,
            source,
            calibration,
            complete: OnceLock::new(),
            as_printed: OnceLock::new(),
            raised: OnceLock::new(),
        }
    }

    /// The same vehicle with its lift axles in a position.
    fn lifted(self, position: Option<LiftAxle>) -> Result<Self, VehicleError> {
        let inner = self.file.clone().with_lift_axle(position.unwrap_or_default())?;
        Ok(Self { inner, lift_axle: position, ..self })
    }

    /// Checks the text of a vehicle file and warns of unusual values; `label` is the name of the text in
    /// messages.
    fn checked(py: Python<'_>, text: String, label: &str, file: String) -> PyResult<Self> {
        let (inner, warnings) = cg_vehicle::Vehicle::check(&text, label).map_err(vehicle_error)?;
        for warning in warnings {
            warn(py, &warning.in_file(label))?;
        }
        Ok(Self::new(inner, (text, file), None))
    }

    /// The same vehicle on roads whose bank has this standard deviation, rad.
    fn with_road(&self, bank_sd_rad: Option<f64>) -> Result<Self, VehicleError> {
        let mut file = self.file.clone();
        file.road = bank_sd_rad.map(|bank_sd_rad| Road { bank_sd_rad }).or(file.road);
        Self::new(file, self.source.clone(), self.calibration.clone()).lifted(self.lift_axle)
    }

    /// The path of the vehicle file.
    pub(crate) fn path(&self) -> &Path {
        Path::new(&self.source.1)
    }

    /// The estimator for logs of the vehicle.
    pub(crate) fn estimator(&self, options: EstimateOptions) -> Result<LogEstimator, VehicleError> {
        self.estimator_of(None, options)
    }

    /// The same with what the truck has learned.
    pub(crate) fn estimator_of(
        &self,
        learned: Option<&Belief>,
        options: EstimateOptions,
    ) -> Result<LogEstimator, VehicleError> {
        let basis = |calibration| Basis::of(calibration).with_trips(learned.is_some());
        let basis = self.calibration.as_ref().map(basis);
        let options = EstimateOptions { basis, lift_axle: self.lift_axle, ..options };
        if let Some(belief) = learned {
            return LogEstimator::of_truck(&self.file, belief, options);
        }
        let truck = |vehicle, design| Truck::new(vehicle, design, options);
        let raised = self.raised_design(options.variant)?;
        let raised = raised.map(|(vehicle, design)| truck(vehicle, design));
        let present = truck(&self.inner, self.design(options.variant)?);
        Ok(LogEstimator::of_positions(&present, raised))
    }

    /// The vehicle with its lift axles raised, and its design, if nothing but a log says where they are.
    fn raised_design(&self, variant: Variant) -> Result<Option<&Raised>, VehicleError> {
        if variant == Variant::AsPrinted {
            return Ok(None); // is not kept
        }
        if let Some(known) = self.raised.get() {
            return Ok(known.as_deref());
        }
        let design = |raised: cg_vehicle::Vehicle| -> Result<_, VehicleError> {
            let design = design_with(&raised, variant, &self.belief(variant)?)?;
            Ok(Box::new((raised, design)))
        };
        let (_, raised) = self.file.in_positions(self.lift_axle, variant)?;
        let computed = raised.map(design).transpose()?;
        Ok(self.raised.get_or_init(|| computed).as_deref())
    }

    /// The vehicle and its design with its lift axles where a log says, if nothing else does.
    pub(crate) fn at(
        &self,
        said: Option<LiftAxle>,
        variant: Variant,
    ) -> Result<(&cg_vehicle::Vehicle, &Design<f64>), VehicleError> {
        match self.raised_design(variant)?.filter(|_| said == Some(LiftAxle::Raised)) {
            Some((vehicle, design)) => Ok((vehicle, design)),
            None => Ok((&self.inner, self.design(variant)?)),
        }
    }

    fn belief(&self, variant: Variant) -> Result<Belief, VehicleError> {
        Ok(self.posterior(variant)?.unwrap_or_else(|| Belief::prior(&self.file)))
    }

    /// What the truck has learned, from its text, on top of its calibration.
    pub(crate) fn learned(&self, text: Option<&str>) -> PyResult<Learned> {
        let learned = text.map(|text| Learned::parse_of(text, &self.file)).transpose();
        let learned = learned.map_err(|error| value_error(format!("learned: {error}")))?;
        Ok(learned.unwrap_or_default().on(self.calibration.as_ref()))
    }

    /// What the calibration says, if there is one.
    pub(crate) fn posterior(&self, variant: Variant) -> Result<Option<Belief>, VehicleError> {
        match &self.calibration {
            Some(calibration) if calibration.model != variant => Err(VehicleError::Model(
                "the calibration is for the other model: give that model".to_owned(),
            )),
            calibration => Ok(calibration.as_ref().map(Calibration::belief)),
        }
    }

    /// The design for one set of equations, which is computed on first use.
    pub(crate) fn design(&self, variant: Variant) -> Result<&Design<f64>, VehicleError> {
        let cell = match variant {
            Variant::Complete => &self.complete,
            Variant::AsPrinted => &self.as_printed,
        };
        if let Some(known) = cell.get() {
            return Ok(known);
        }
        let computed = design_with(&self.inner, variant, &self.belief(variant)?)?;
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
    /// Returns
    /// -------
    /// Vehicle
    ///
    /// Raises
    /// ------
    /// FileNotFoundError
    ///     There is no such file.
    /// ValueError
    ///     The file is not a valid vehicle file; for each error, the message gives the line, the
    ///     column, the key and a remedy.
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     A value is unusual; there is one warning for each such value.
    #[staticmethod]
    #[pyo3(signature = (path, /))]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let file = path.display().to_string();
        let text = py
            .detach(|| files::read_text(&path, files::VEHICLE_BYTES))
            .map_err(|source| vehicle_error(VehicleError::Read { file: file.clone(), source }))?;
        Self::checked(py, text, &file.clone(), file)
    }

    /// Return a vehicle with typical values, which are to be replaced by those of your truck.
    ///
    /// Parameters
    /// ----------
    /// kind : str
    ///     "4x2-3axle", "6x4-2axle" or "6x4-3axle": the axles of the tractor and of the semitrailer.
    ///
    /// Returns
    /// -------
    /// Vehicle
    ///     `toml` is its file, with a comment for every key.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is no such kind.
    #[staticmethod]
    #[pyo3(name = "template", signature = (kind, /))]
    fn of_kind(py: Python<'_>, kind: &str) -> PyResult<Self> {
        let text = template(word::<TruckKind>("kind", kind)?);
        let file = format!("template {kind}");
        Self::checked(py, text, &file.clone(), file)
    }

    /// Return the same vehicle with other values in its file.
    ///
    /// Parameters
    /// ----------
    /// changes : mapping, optional
    ///     Keys of the vehicle file with their new values, such as
    ///     ``{"trailer.axle[0].spring_spread_m": 1.3}``; `docs/vehicle.md` lists all keys. A dict
    ///     changes the keys that it contains.
    /// **keys
    ///     The same for keys and tables at the top of the file: ``trailer={"reference_mass_kg": 3e4}``.
    ///
    /// Returns
    /// -------
    /// Vehicle
    ///     A new vehicle without a calibration, which belongs to the old one; this one does not
    ///     change.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is no such key, or the changed file is not a valid vehicle file.
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     A value is unusual; there is one warning for each such value.
    #[pyo3(signature = (changes=None, /, **keys))]
    fn with_(
        &self,
        py: Python<'_>,
        changes: Option<&Bound<'_, PyMapping>>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let (text, file) = &self.source;
        let road = self.inner.road.map(|road| ("road.bank_sd_rad".into(), road.bank_sd_rad.into()));
        let all = road.into_iter().chain(self::changes(changes, keys)?);
        let text = changed(text, file, all).map_err(vehicle_error)?;
        let changed = Self::checked(py, text, &format!("{file} with changes"), file.clone())?;
        changed.lifted(self.lift_axle).map_err(vehicle_error)
    }

    /// Text of the vehicle file, str.
    #[getter]
    fn toml(&self) -> &str {
        &self.source.0
    }

    /// Return the same vehicle with a calibration.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     A calibration file, from `cgheight.calibrate` or `cg calibrate`.
    ///
    /// Returns
    /// -------
    /// Vehicle
    ///     A new vehicle; this one does not change.
    ///
    /// Raises
    /// ------
    /// FileNotFoundError
    ///     There is no such file.
    /// ValueError
    ///     The file is not a calibration, or it belongs to another vehicle or to another version of
    ///     the vehicle file.
    #[pyo3(signature = (path, /))]
    fn calibrated(&self, py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let calibration =
            py.detach(|| Calibration::load(&path, &self.file)).map_err(vehicle_error)?;
        let calibrated = Self::new(self.file.clone(), self.source.clone(), Some(calibration));
        calibrated.lifted(self.lift_axle).map_err(vehicle_error)
    }

    /// Return the same vehicle on other roads.
    ///
    /// A roll angle relative to gravity contains the bank of the road, so the bank is part of the
    /// uncertainty of its height.
    ///
    /// Parameters
    /// ----------
    /// road : str or float
    ///     "flat" (test track), "public", or the standard deviation of the bank in curves, rad.
    ///
    /// Returns
    /// -------
    /// Vehicle
    ///     A new vehicle; this one does not change.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     `road` is none of these.
    #[pyo3(signature = (road, /))]
    fn on_road(&self, road: &Bound<'_, PyAny>) -> PyResult<Self> {
        let text = road.str()?.to_string();
        let choice: RoadChoice =
            text.parse().map_err(|error| value_error(format!("road is {text:?}: {error}")))?;
        self.with_road(Some(choice.bank_sd_rad)).map_err(vehicle_error)
    }

    /// Return the same vehicle with its lift axles in a position.
    ///
    /// Without it, the signal ``lift_axle_raised`` of a log says where they are; a log without it is one with them down. A
    /// raised axle belongs to the sprung mass, so that the heights of the vehicle are lower.
    ///
    /// Parameters
    /// ----------
    /// position : str
    ///     "down" or "raised".
    ///
    /// Returns
    /// -------
    /// Vehicle
    ///     A new vehicle; this one does not change.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There is no such position, or the vehicle has no lift axle (``lift_m`` of an axle).
    #[pyo3(signature = (position, /))]
    fn with_lift_axle(&self, position: &str) -> PyResult<Self> {
        let position = word::<LiftAxle>("position", position)?;
        let same = Self::new(self.file.clone(), self.source.clone(), self.calibration.clone());
        same.lifted(Some(position)).map_err(vehicle_error)
    }

    /// Where the lift axles are: "down", "raised", or None if only a log says it.
    #[getter]
    fn lift_axle(&self) -> Option<String> {
        self.lift_axle.map(|position| position.to_string())
    }

    /// Whether the vehicle has a calibration, bool.
    #[getter]
    fn is_calibrated(&self) -> bool {
        self.calibration.is_some()
    }

    /// Name of the vehicle, str.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Speed that is used if no other is given, m/s.
    #[getter]
    fn nominal_speed_mps(&self) -> f64 {
        self.inner.nominal_speed_mps
    }

    /// Mass of the whole semitrailer (sprung mass and axles) that is used if no other is given, kg.
    #[getter]
    fn reference_trailer_mass_kg(&self) -> f64 {
        self.inner.trailer.reference_mass_kg
    }

    /// Height of the trailer's sprung c.g. above ground that is used if no other is given, m.
    #[getter]
    fn reference_height_m(&self) -> f64 {
        self.inner.trailer.reference_cg_height_m
    }

    /// Mass of the semitrailer without payload, kg.
    #[getter]
    fn empty_trailer_mass_kg(&self) -> f64 {
        self.inner.empty_trailer_mass_kg()
    }

    /// Steering-wheel angle divided by road-wheel angle, or None if the file has no ratio.
    #[getter]
    fn steering_ratio(&self) -> Option<f64> {
        self.inner.steering_ratio
    }

    /// Range of c.g. heights that the file allows (lowest, highest), m.
    #[getter]
    fn height_range_m(&self) -> (f64, f64) {
        (self.inner.height.least_m, self.inner.height.greatest_m)
    }

    /// Pickles the texts of the files, from which any process can restore the vehicle.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Restored)> {
        let restore = slf.py().import("cgheight._native")?.getattr("restore_vehicle")?;
        let this = slf.get();
        let calibration = this.calibration.as_ref().map(Calibration::to_toml).transpose();
        let (text, file) = this.source.clone();
        let bank_sd_rad = this.inner.road.map(|road| road.bank_sd_rad);
        let calibration = calibration.map_err(vehicle_error)?;
        Ok((restore, (text, file, calibration, bank_sd_rad, this.lift_axle())))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("cgheight._show")?.call_method1("vehicle", (slf,))
    }

    fn __repr__(&self) -> String {
        let trailer = &self.inner.trailer;
        format!(
            "Vehicle({:?}, {:.2} m/s, trailer {:.0} kg, c.g. height {:.3} m{})",
            self.inner.name,
            self.inner.nominal_speed_mps,
            trailer.reference_mass_kg,
            trailer.reference_cg_height_m,
            if self.calibration.is_some() { ", calibrated" } else { "" }
        )
    }
}

/// Text and name of a vehicle file, the text of a calibration, roads and the position of the lift axles.
type Restored = (String, String, Option<String>, Option<f64>, Option<String>);

/// Return a vehicle from the text of its file, the text of its calibration, the bank of its roads
/// (rad) and the position of its lift axles, if it has them.
#[pyfunction]
#[pyo3(signature = (text, file, calibration, bank_sd_rad, lift_axle, /))]
pub(crate) fn restore_vehicle(
    text: String,
    file: String,
    calibration: Option<String>,
    bank_sd_rad: Option<f64>,
    lift_axle: Option<String>,
) -> PyResult<Vehicle> {
    let inner = cg_vehicle::Vehicle::parse(&text, &file).map_err(vehicle_error)?;
    let calibration = calibration
        .map(|calibration| Calibration::parse(&calibration, "calibration", &inner))
        .transpose()
        .map_err(vehicle_error)?;
    let position = lift_axle.map(|text| word::<LiftAxle>("lift_axle", &text)).transpose()?;
    let on_road = Vehicle::new(inner, (text, file), calibration).with_road(bank_sd_rad);
    on_road.and_then(|vehicle| vehicle.lifted(position)).map_err(vehicle_error)
}
