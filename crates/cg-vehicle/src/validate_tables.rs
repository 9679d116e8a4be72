//! Checks of what only the nonlinear plant reads.

use crate::tables::Spring;
use crate::validate::{Invalid, not_negative, positive};
use crate::vehicle::{Axle, Tyre, Vehicle};

/// Numbers of hitch and bodies, springs, tyres.
pub(crate) fn optional(v: &Vehicle) -> Result<(), Invalid> {
    for (path, value) in [
        ("hitch.separation_moment_nm", v.hitch.separation_moment_nm.unwrap_or(1.0)),
        ("tractor.pitch_inertia_kgm2", v.tractor.pitch_inertia_kgm2.unwrap_or(1.0)),
        ("trailer.tare.pitch_inertia_kgm2", v.trailer.tare.pitch_inertia_kgm2.unwrap_or(1.0)),
    ] {
        positive(path, value)?;
    }
    not_negative("hitch.roll_damping_nms_per_rad", v.hitch.roll_damping_nms_per_rad)?;
    not_negative("hitch.lash_rad", v.hitch.lash_rad)?;
    if v.hitch.lash_rad > 0.0 && v.hitch.separation_moment_nm.is_none() {
        let remedy = "needs separation_moment_nm: the plates are free only once they have parted";
        return Err(Invalid::new("hitch.lash_rad", v.hitch.lash_rad, remedy));
    }
    for (i, one) in v.spring.iter().enumerate() {
        spring(&format!("spring[{i}]"), one)?;
    }
    for (i, tyre) in v.tyre.iter().enumerate() {
        tyre_tables(&format!("tyre[{i}]"), tyre)?;
    }
    Ok(())
}

/// The optional keys of an axle.
pub(crate) fn axle(path: &str, a: &Axle, v: &Vehicle) -> Result<(), Invalid> {
    positive(&format!("{path}.damper_spread_m"), a.damper_spread_m.unwrap_or(1.0))?;
    let steer = a.roll_steer_rad_per_rad;
    if !(steer.abs() < 1.0) {
        let remedy = "must lie between -1 and 1 (usual: 0 to 0.3)";
        return Err(Invalid::new(&format!("{path}.roll_steer_rad_per_rad"), steer, remedy));
    }
    let Some(name) = &a.spring else { return Ok(()) };
    if v.spring.iter().any(|spring| spring.name == *name) {
        return Ok(());
    }
    let names: Vec<_> = v.spring.iter().map(|spring| spring.name.as_str()).collect();
    let remedy = format!("no [[spring]] has this name; there are: {}", names.join(", "));
    Err(Invalid::new(&format!("{path}.spring"), name, &remedy))
}

fn increasing(path: &str, values: &[f64]) -> Result<(), Invalid> {
    let finite = values.iter().all(|value| value.is_finite());
    if values.len() < 2 || !finite || !values.windows(2).all(|pair| pair[0] < pair[1]) {
        let remedy = "needs two or more strictly increasing numbers";
        return Err(Invalid::new(path, format!("{values:?}"), remedy));
    }
    Ok(())
}

fn spring(path: &str, spring: &Spring) -> Result<(), Invalid> {
    positive(&format!("{path}.friction_deflection_m"), spring.friction_deflection_m)?;
    increasing(&format!("{path}.deflection_m"), &spring.deflection_m)?;
    for (key, force) in
        [("compression_n", &spring.compression_n), ("extension_n", &spring.extension_n)]
    {
        let path = format!("{path}.{key}");
        if force.len() != spring.deflection_m.len() {
            let remedy = format!("needs one force per deflection: {}", spring.deflection_m.len());
            return Err(Invalid::new(&path, format!("{} values", force.len()), &remedy));
        }
        if let Some(j) = force.windows(2).position(|pair| !(pair[0] <= pair[1])) {
            let remedy = "must not fall with deflection";
            return Err(Invalid::new(&format!("{path}[{}]", j + 1), force[j + 1], remedy));
        }
        if force[0] >= force[force.len() - 1] || !force.iter().all(|f| f.is_finite()) {
            return Err(Invalid::new(&path, format!("{force:?}"), "must rise with deflection"));
        }
    }
    let pairs = spring.compression_n.iter().zip(&spring.extension_n);
    if let Some(j) = pairs.clone().position(|(up, down)| down > up) {
        let remedy = format!("must not exceed compression_n[{j}] = {}", spring.compression_n[j]);
        let path = format!("{path}.extension_n[{j}]");
        return Err(Invalid::new(&path, spring.extension_n[j], &remedy));
    }
    Ok(())
}

fn tyre_tables(path: &str, tyre: &Tyre) -> Result<(), Invalid> {
    not_negative(&format!("{path}.relaxation_length_m"), tyre.relaxation_length_m)?;
    not_negative(&format!("{path}.vertical_damping_ns_per_m"), tyre.vertical_damping_ns_per_m)?;
    if let Some(t) = &tyre.lateral_force {
        let path = format!("{path}.lateral_force");
        table(&path, "coefficient", &t.slip_rad, &t.load_n, &t.coefficient)?;
        for (i, row) in t.coefficient.iter().enumerate() {
            for (j, &value) in row.iter().enumerate() {
                not_negative(&format!("{path}.coefficient[{i}][{j}]"), value)?;
            }
        }
    }
    if let Some(t) = &tyre.aligning_moment {
        let path = format!("{path}.aligning_moment");
        table(&path, "moment_nm", &t.slip_rad, &t.load_n, &t.moment_nm)?;
    }
    Ok(())
}

fn table(
    path: &str,
    key: &str,
    slip_rad: &[f64],
    load_n: &[f64],
    rows: &[Vec<f64>],
) -> Result<(), Invalid> {
    increasing(&format!("{path}.slip_rad"), slip_rad)?;
    increasing(&format!("{path}.load_n"), load_n)?;
    positive(&format!("{path}.slip_rad[0]"), slip_rad[0])?;
    positive(&format!("{path}.load_n[0]"), load_n[0])?;
    if rows.len() != slip_rad.len() {
        let remedy = format!("needs one row per slip angle: {}", slip_rad.len());
        let path = format!("{path}.{key}");
        return Err(Invalid::new(&path, format!("{} rows", rows.len()), &remedy));
    }
    for (i, row) in rows.iter().enumerate() {
        let path = format!("{path}.{key}[{i}]");
        if row.len() != load_n.len() {
            let remedy = format!("needs one value per load: {}", load_n.len());
            return Err(Invalid::new(&path, format!("{} values", row.len()), &remedy));
        }
        if !row.iter().all(|value| value.is_finite()) {
            return Err(Invalid::new(&path, format!("{row:?}"), "must be finite"));
        }
    }
    Ok(())
}
