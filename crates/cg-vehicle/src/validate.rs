//! Physical checks of a vehicle, with the place in the file.

use toml::de::{DeTable, DeValue};

use crate::error::VehicleError;
use crate::validate_tables;
use crate::vehicle::{Axle, Tyre, Vehicle};

/// A value that no vehicle can have, not yet located.
#[derive(Debug)]
pub(crate) struct Invalid {
    path: String,
    value: String,
    remedy: String,
}

impl Invalid {
    pub(crate) fn new(path: &str, value: impl std::fmt::Display, remedy: &str) -> Self {
        Self { path: path.to_owned(), value: value.to_string(), remedy: remedy.to_owned() }
    }

    /// Finds the key's line and column in the text.
    pub(crate) fn located(self, text: &str, file: &str) -> VehicleError {
        let (line, column) = locate(text, &self.path);
        VehicleError::Invalid {
            file: file.to_owned(),
            line,
            column,
            key: self.path,
            value: self.value,
            remedy: self.remedy,
        }
    }
}

/// Line and column (from 1) of the value at `path` (`trailer.axle[1].tyre`), or of its
/// nearest ancestor in the file.
fn locate(text: &str, path: &str) -> (usize, usize) {
    let mut offset = 0;
    if let Ok(root) = DeTable::parse(text) {
        let mut table = Some(root.get_ref());
        for step in path.split('.') {
            let (key, index) = match step.split_once('[') {
                Some((key, rest)) => (key, rest.trim_end_matches(']').parse::<usize>().ok()),
                None => (step, None),
            };
            let Some(entry) = table.and_then(|table| table.get(key)) else { break };
            offset = entry.span().start;
            let mut here = entry.get_ref();
            if let (Some(index), DeValue::Array(items)) = (index, here) {
                let Some(item) = items.get(index) else { break };
                offset = item.span().start;
                here = item.get_ref();
            }
            table = match here {
                DeValue::Table(table) => Some(table),
                _ => None,
            };
        }
    }
    let before = &text[..offset.min(text.len())];
    let line = before.matches('\n').count() + 1;
    let column = before.len() - before.rfind('\n').map_or(0, |i| i + 1) + 1;
    (line, column)
}

const COMMON_AXLE_KEYS: [&str; 15] = [
    "unsprung_mass_kg",
    "roll_inertia_kgm2",
    "center_height_m",
    "roll_center_height_m",
    "spring_spread_m",
    "spring_stiffness_n_per_m",
    "auxiliary_roll_stiffness_nm_per_rad",
    "roll_damping_nms_per_rad",
    "damper_spread_m",
    "spring",
    "roll_steer_rad_per_rad",
    "load_group",
    "spring_free_rise_m",
    "tyre",
    "tyre_positions_m",
];

/// Refuses unknown keys of axles (serde cannot, where a struct is flattened into another).
pub(crate) fn known_axle_keys(text: &str, file: &str) -> Result<(), VehicleError> {
    let root: toml::Table = toml::from_str(text).map_err(|e| VehicleError::syntax(file, &e))?;
    for (unit, own) in
        [("tractor", &["ahead_of_cg_m", "steered"][..]), ("trailer", &["behind_hitch_m"][..])]
    {
        let axles = root.get(unit).and_then(|unit| unit.get("axle")).and_then(|a| a.as_array());
        for (i, axle) in axles.into_iter().flatten().enumerate() {
            for (key, value) in axle.as_table().into_iter().flatten() {
                if !COMMON_AXLE_KEYS.contains(&key.as_str()) && !own.contains(&key.as_str()) {
                    let known: Vec<_> = own.iter().chain(&COMMON_AXLE_KEYS).copied().collect();
                    let remedy = format!("unknown key; expected one of {}", known.join(", "));
                    let path = format!("{unit}.axle[{i}].{key}");
                    return Err(Invalid::new(&path, value, &remedy).located(text, file));
                }
            }
        }
    }
    Ok(())
}

pub(crate) fn positive(path: &str, value: f64) -> Result<(), Invalid> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Invalid::new(path, value, "must be a positive number"))
    }
}

pub(crate) fn not_negative(path: &str, value: f64) -> Result<(), Invalid> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(Invalid::new(path, value, "must not be negative"))
    }
}

/// Every number that has to be positive is; every table and name fits.
pub(crate) fn physical(v: &Vehicle) -> Result<(), Invalid> {
    let (t, s) = (&v.tractor, &v.trailer);
    for (path, value) in [
        ("gravity_mps2", v.gravity_mps2),
        ("nominal_speed_mps", v.nominal_speed_mps),
        ("steering_ratio", v.steering_ratio.unwrap_or(1.0)),
        ("height.least_m", v.height.least_m),
        ("hitch.height_m", v.hitch.height_m),
        ("hitch.roll_stiffness_nm_per_rad", v.hitch.roll_stiffness_nm_per_rad),
        ("tractor.sprung_mass_kg", t.sprung_mass_kg),
        ("tractor.cg_height_m", t.cg_height_m),
        ("tractor.roll_inertia_kgm2", t.roll_inertia_kgm2),
        ("tractor.yaw_inertia_kgm2", t.yaw_inertia_kgm2),
        ("tractor.hitch_behind_cg_m", t.hitch_behind_cg_m),
        ("trailer.reference_mass_kg", s.reference_mass_kg),
        ("trailer.reference_cg_height_m", s.reference_cg_height_m),
        ("trailer.tare.sprung_mass_kg", s.tare.sprung_mass_kg),
        ("trailer.tare.cg_behind_hitch_m", s.tare.cg_behind_hitch_m),
        ("trailer.tare.cg_height_m", s.tare.cg_height_m),
        ("trailer.tare.roll_inertia_kgm2", s.tare.roll_inertia_kgm2),
        ("trailer.tare.yaw_inertia_kgm2", s.tare.yaw_inertia_kgm2),
        ("trailer.payload.behind_hitch_m", s.payload.behind_hitch_m),
        ("trailer.payload.floor_height_m", s.payload.floor_height_m),
        ("trailer.payload.length_m", s.payload.length_m),
        ("trailer.payload.width_m", s.payload.width_m),
    ] {
        positive(path, value)?;
    }
    let u = &v.uncertainty;
    for (key, value) in [
        ("roll_stiffness_sd", u.roll_stiffness_sd),
        ("roll_center_height_sd_m", u.roll_center_height_sd_m),
        ("tractor_cg_height_sd_m", u.tractor_cg_height_sd_m),
        ("fifth_wheel_stiffness_sd", u.fifth_wheel_stiffness_sd),
        ("tyre_vertical_stiffness_sd", u.tyre_vertical_stiffness_sd),
        ("cornering_stiffness_sd", u.cornering_stiffness_sd),
        ("steering_gain_sd", u.steering_gain_sd),
        ("lateral_acceleration_gain_sd", u.lateral_acceleration_gain_sd),
        ("compensation_sd", u.compensation_sd),
        ("residual_sd", u.residual_sd),
    ] {
        // One (a factor of e) or a metre: nothing is known, and linearisation ends.
        if !(0.0..=1.0).contains(&value) {
            let remedy = "must lie between 0 (known exactly) and 1 (hardly known)";
            return Err(Invalid::new(&format!("uncertainty.{key}"), value, remedy));
        }
    }
    heights_and_masses(v)?;
    if let Some(readings) = v.trailer.suspension_pressure {
        for (key, [first, second]) in
            [("gauge_pa", readings.gauge_pa), ("axle_load_kg", readings.axle_load_kg)]
        {
            let path = format!("trailer.suspension_pressure.{key}");
            positive(&path, first)?;
            if !(second.is_finite() && second > first) {
                let remedy = "the second reading must be greater than the first";
                return Err(Invalid::new(&path, second, remedy));
            }
        }
    }
    for (i, tyre) in v.tyre.iter().enumerate() {
        tyre_table(&format!("tyre[{i}]"), tyre)?;
    }
    validate_tables::optional(v)?;
    units(v)?;
    as_printed(v)
}

fn heights_and_masses(v: &Vehicle) -> Result<(), Invalid> {
    let (least, greatest) = (v.height.least_m, v.height.greatest_m);
    if !(greatest.is_finite() && greatest > least) {
        return Err(Invalid::new("height.greatest_m", greatest, "must be above height.least_m"));
    }
    let reference = v.trailer.reference_cg_height_m;
    if !(reference > least && reference < greatest) {
        let remedy =
            format!("must lie between height.least_m = {least} and height.greatest_m = {greatest}");
        return Err(Invalid::new("trailer.reference_cg_height_m", reference, &remedy));
    }
    let (mass, empty) = (v.trailer.reference_mass_kg, v.empty_trailer_mass_kg());
    if mass < empty {
        let remedy = format!("must be at least the empty trailer's {empty} kg (tare and axles)");
        return Err(Invalid::new("trailer.reference_mass_kg", mass, &remedy));
    }
    Ok(())
}

fn units(v: &Vehicle) -> Result<(), Invalid> {
    if !v.tractor.axle.iter().any(|a| a.steered) {
        return Err(Invalid::new(
            "tractor.axle",
            v.tractor.axle.len(),
            "one axle must have steered = true",
        ));
    }
    if v.trailer.axle.is_empty() {
        return Err(Invalid::new("trailer.axle", 0, "the trailer needs at least one axle"));
    }
    for (i, a) in v.tractor.axle.iter().enumerate() {
        let path = format!("tractor.axle[{i}]");
        if !a.ahead_of_cg_m.is_finite() {
            return Err(Invalid::new(
                &format!("{path}.ahead_of_cg_m"),
                a.ahead_of_cg_m,
                "must be finite",
            ));
        }
        axle(&path, &a.axle, v)?;
    }
    for (i, a) in v.trailer.axle.iter().enumerate() {
        let path = format!("trailer.axle[{i}]");
        positive(&format!("{path}.behind_hitch_m"), a.behind_hitch_m)?;
        axle(&path, &a.axle, v)?;
    }
    Ok(())
}

fn axle(path: &str, a: &Axle, v: &Vehicle) -> Result<(), Invalid> {
    for (key, value) in [
        ("unsprung_mass_kg", a.unsprung_mass_kg),
        ("roll_inertia_kgm2", a.roll_inertia_kgm2),
        ("center_height_m", a.center_height_m),
        ("roll_center_height_m", a.roll_center_height_m),
        ("spring_spread_m", a.spring_spread_m),
        ("spring_stiffness_n_per_m", a.spring_stiffness_n_per_m),
    ] {
        positive(&format!("{path}.{key}"), value)?;
    }
    for (key, value) in [
        ("auxiliary_roll_stiffness_nm_per_rad", a.auxiliary_roll_stiffness_nm_per_rad),
        ("roll_damping_nms_per_rad", a.roll_damping_nms_per_rad),
        ("spring_free_rise_m", a.spring_free_rise_m),
    ] {
        not_negative(&format!("{path}.{key}"), value)?;
    }
    if !v.tyre.iter().any(|tyre| tyre.name == a.tyre) {
        let names: Vec<_> = v.tyre.iter().map(|tyre| tyre.name.as_str()).collect();
        let remedy = format!("no [[tyre]] has this name; there are: {}", names.join(", "));
        return Err(Invalid::new(&format!("{path}.tyre"), &a.tyre, &remedy));
    }
    if a.tyre_positions_m.is_empty() {
        return Err(Invalid::new(
            &format!("{path}.tyre_positions_m"),
            "[]",
            "needs one entry (single tyres) or two (dual)",
        ));
    }
    for (j, &position) in a.tyre_positions_m.iter().enumerate() {
        positive(&format!("{path}.tyre_positions_m[{j}]"), position)?;
    }
    validate_tables::axle(path, a, v)
}

fn tyre_table(path: &str, tyre: &Tyre) -> Result<(), Invalid> {
    positive(&format!("{path}.vertical_stiffness_n_per_m"), tyre.vertical_stiffness_n_per_m)?;
    positive(&format!("{path}.unloaded_radius_m"), tyre.unloaded_radius_m.unwrap_or(1.0))?;
    not_negative(
        &format!("{path}.overturning_stiffness_nm_per_rad"),
        tyre.overturning_stiffness_nm_per_rad,
    )?;
    let loads = &tyre.load_n;
    if loads.len() < 2 || !loads.windows(2).all(|pair| pair[0] < pair[1]) {
        return Err(Invalid::new(
            &format!("{path}.load_n"),
            format!("{loads:?}"),
            "needs two or more strictly increasing loads",
        ));
    }
    for (key, table) in [
        ("cornering_stiffness_n_per_rad", &tyre.cornering_stiffness_n_per_rad),
        ("aligning_stiffness_nm_per_rad", &tyre.aligning_stiffness_nm_per_rad),
    ] {
        if table.len() != loads.len() {
            let remedy = format!("needs one value per load: {}", loads.len());
            return Err(Invalid::new(
                &format!("{path}.{key}"),
                format!("{} values", table.len()),
                &remedy,
            ));
        }
        for (j, &value) in table.iter().enumerate() {
            not_negative(&format!("{path}.{key}[{j}]"), value)?;
        }
    }
    Ok(())
}

fn as_printed(v: &Vehicle) -> Result<(), Invalid> {
    let Some(printed) = &v.as_printed else { return Ok(()) };
    let axles = v.tractor.axle.len() + v.trailer.axle.len();
    for (key, values) in
        [("axle_load_n", &printed.axle_load_n), ("unsprung_weight_n", &printed.unsprung_weight_n)]
    {
        if values.len() != axles {
            let remedy = format!("needs one value per axle: {axles}");
            return Err(Invalid::new(
                &format!("as_printed.{key}"),
                format!("{} values", values.len()),
                &remedy,
            ));
        }
    }
    Ok(())
}
