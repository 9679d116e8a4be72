//! Static balance: axle and fifth-wheel loads (eqs. 2.1–2.4, 2.6).
//!
//! Each unit is a rigid body on its supports. The axles of one load group are one support and share
//! its load equally. The frames of tractor and trailer are connected at the fifth wheel. If the
//! tractor has two supports (front and rear) and the trailer one, the loads follow from forces and
//! moments alone. With more supports they also depend on the stiffness of springs and tires. The
//! same linear system covers both cases.

use cg_core::AlignSettings;
use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;
use crate::load::{Load, SprungMass};
use crate::sensor_places::{LevelSensors, SuspensionPressure};
use crate::vehicle::{PlacedAxle, Vehicle};

/// Static loads of a vehicle.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StaticBalance {
    /// Vertical load of each axle on the road, tractor first.
    pub axle_load_n: Vec<f64>,
    /// Vertical load of the trailer on the fifth wheel.
    pub hitch_load_n: f64,
    /// Remaining moment about the c.g. of the units, which is due to rounding only.
    pub residual_nm: f64,
}

/// Least share of the sprung mass that is payload. The c.g. of a smaller payload does not follow from that
/// of the trailer, whose error it multiplies by more than five.
pub(crate) const LEAST_SHARE: f64 = 0.2;

/// Height of the payload's own c.g. above that of the tare, m, if this is the height of the c.g. of both
/// above it and the payload this share of their mass; a smaller share counts as the
/// [least](LEAST_SHARE).
pub(crate) fn payload_above_tare_m(both_above_tare_m: f64, share: f64) -> f64 {
    both_above_tare_m / share.max(LEAST_SHARE)
}

impl Vehicle {
    /// The load of a trailer of this mass whose payload has the c.g. of the reference payload.
    pub fn usual_load(&self, trailer_mass_kg: f64) -> Load {
        let (tare, reference) = (&self.trailer.tare, self.reference_load());
        let share = |mass_kg: f64| {
            let payload_kg = (mass_kg - self.empty_trailer_mass_kg()).max(0.0);
            payload_kg / (tare.sprung_mass_kg + payload_kg)
        };
        let above_tare_m = payload_above_tare_m(
            reference.cg_height_m - tare.cg_height_m,
            share(reference.trailer_mass_kg),
        );
        let cg_height_m = tare.cg_height_m + share(trailer_mass_kg) * above_tare_m;
        Load { trailer_mass_kg, cg_height_m }
    }

    /// Tare and payload as one body. The payload is the box that gives the mass and the height of
    /// the load; the height of the box follows from its c.g. (limited to 0.6–2.4 m).
    ///
    /// # Errors
    /// [`VehicleError::Load`] if the mass is below that of the empty trailer.
    pub fn trailer_sprung_mass(&self, load: Load) -> Result<SprungMass, VehicleError> {
        let (tare, bed) = (&self.trailer.tare, &self.trailer.payload);
        let mass_kg = load.trailer_mass_kg - self.trailer_unsprung_mass_kg();
        // Because of weighing errors and rounding, half a percent below empty still counts as
        // empty.
        if mass_kg < tare.sprung_mass_kg - 0.005 * load.trailer_mass_kg {
            return Err(VehicleError::Load {
                trailer_mass_kg: load.trailer_mass_kg,
                empty_mass_kg: self.empty_trailer_mass_kg(),
            });
        }
        let payload_kg = (mass_kg - tare.sprung_mass_kg).max(0.0);
        let share = payload_kg / (tare.sprung_mass_kg + payload_kg);
        let cg_behind_hitch_m =
            tare.cg_behind_hitch_m + share * (bed.behind_hitch_m - tare.cg_behind_hitch_m);
        let above_tare_m = payload_above_tare_m(load.cg_height_m - tare.cg_height_m, share);
        let above_floor_m = tare.cg_height_m + above_tare_m - bed.floor_height_m;
        let box_height_m = (2.0 * above_floor_m).clamp(0.6, 2.4);
        let square = |x: f64| x * x;
        let reduced_mass_kg = tare.sprung_mass_kg * share;
        let along_m = bed.behind_hitch_m - tare.cg_behind_hitch_m;
        Ok(SprungMass {
            mass_kg,
            payload_kg,
            cg_behind_hitch_m,
            cg_height_m: load.cg_height_m,
            roll_inertia_kgm2: tare.roll_inertia_kgm2
                + payload_kg * (square(bed.width_m) + square(box_height_m)) / 12.0
                + reduced_mass_kg * square(above_tare_m),
            yaw_inertia_kgm2: tare.yaw_inertia_kgm2
                + payload_kg * (square(bed.width_m) + square(bed.length_m)) / 12.0
                + reduced_mass_kg * square(along_m),
            pitch_inertia_kgm2: tare.pitch_inertia_kgm2.unwrap_or(tare.yaw_inertia_kgm2)
                + payload_kg * (square(bed.length_m) + square(box_height_m)) / 12.0
                + reduced_mass_kg * (square(along_m) + square(above_tare_m)),
        })
    }

    /// Settings that convert the values of sensors to those of a sample.
    pub fn align_settings(&self) -> AlignSettings<f64> {
        let mass_of_axle_load = self.mass_of_axle_load().ok();
        let (sensors, readings) = (&self.sensors, self.trailer.suspension_pressure);
        let drive = sensors.drive_pressure;
        let through = |([empty_kg, slope], readings): ([f64; 2], SuspensionPressure)| {
            let SuspensionPressure { gauge_pa, axle_load_kg } = readings;
            let per_pa = (axle_load_kg[1] - axle_load_kg[0]) / (gauge_pa[1] - gauge_pa[0]);
            let at_zero_kg = axle_load_kg[0] - per_pa * gauge_pa[0];
            [empty_kg + slope * at_zero_kg, slope * per_pa]
        };
        AlignSettings {
            steering_ratio: self.steering_ratio,
            mass_of_axle_load,
            mass_of_suspension_pressure: mass_of_axle_load.zip(readings).map(through),
            mass_of_drive_pressure: self.mass_of_drive_load().ok().zip(drive).map(through),
            mass_range_kg: Some(self.trailer_mass_range_kg()),
            suspension_roll_of_level: sensors.level.as_ref().map(LevelSensors::roll_per_difference),
            tractor_suspension_roll_of_level: sensors
                .tractor_level
                .as_ref()
                .map(LevelSensors::roll_per_difference),
            second_roll_share: sensors.roll.second_share,
            roll_is_mean_of_two: sensors.roll.is_mean_of_two(),
        }
    }

    /// The masses that a scale on this trailer can show: from 10 % below empty, because of the
    /// error of axle scales, to 25 % above the greatest mass of the [design](crate::design).
    fn trailer_mass_range_kg(&self) -> [f64; 2] {
        [0.9 * self.empty_trailer_mass_kg(), 1.25 * greatest_mass_kg(self)]
    }

    /// Trailer mass (sprung mass and axles) as a function of the load of the trailer's axles on the
    /// road, both in kg: the mass at zero axle load, and its slope. The function is linear because
    /// the position of the payload is fixed.
    ///
    /// # Errors
    /// As [`static_balance`].
    pub fn mass_of_axle_load(&self) -> Result<[f64; 2], VehicleError> {
        self.mass_of_load(|axle| axle.on_trailer)
    }

    /// The same as a function of the load of the tractor's drive axles on the road.
    ///
    /// # Errors
    /// As [`static_balance`].
    pub fn mass_of_drive_load(&self) -> Result<[f64; 2], VehicleError> {
        self.mass_of_load(|axle| !axle.on_trailer && !axle.steered)
    }

    fn mass_of_load(
        &self,
        wanted: impl Fn(&PlacedAxle<'_>) -> bool,
    ) -> Result<[f64; 2], VehicleError> {
        let reference = self.reference_load();
        let axles = self.axles();
        let axle_load_kg = |trailer_mass_kg: f64| -> Result<f64, VehicleError> {
            let balance = static_balance(self, Load { trailer_mass_kg, ..reference })?;
            let loads = axles.iter().zip(&balance.axle_load_n).filter(|(axle, _)| wanted(axle));
            Ok(loads.map(|(_, load_n)| load_n).sum::<f64>() / self.gravity_mps2)
        };
        let empty_kg = self.empty_trailer_mass_kg();
        let laden_kg = empty_kg + 0.5 * reference.trailer_mass_kg;
        let (light, heavy) = (axle_load_kg(empty_kg)?, axle_load_kg(laden_kg)?);
        let slope = (laden_kg - empty_kg) / (heavy - light);
        Ok([empty_kg - slope * light, slope])
    }
}

/// Greatest payload of the design's mass axis.
const GREATEST_PAYLOAD_KG: f64 = 34_000.0;

/// The greatest trailer mass of a design.
pub(crate) fn greatest_mass_kg(vehicle: &Vehicle) -> f64 {
    let empty_kg = vehicle.empty_trailer_mass_kg();
    (empty_kg + GREATEST_PAYLOAD_KG).max(vehicle.trailer.reference_mass_kg * 1.1)
}

/// Deflection of the tires of an axle under its load. The height of the axle's center is that of
/// the unloaded tire plus `rise_m`, minus `compliance_m_per_n` times the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Give {
    pub(crate) compliance_m_per_n: f64,
    pub(crate) rise_m: f64,
}

impl Give {
    /// The deflection with all tires of an axle on the road.
    fn upright(placed: &PlacedAxle<'_>) -> Self {
        let tyres_n_per_m = placed.tyres() * placed.tyre.vertical_stiffness_n_per_m;
        Self { compliance_m_per_n: 1.0 / tyres_n_per_m, rise_m: 0.0 }
    }
}

/// A group of axles that shares its load equally.
struct Support {
    on_trailer: bool,
    /// Ahead of the fifth wheel (tractor) or behind it (trailer).
    position_m: f64,
    axles: Vec<usize>,
    /// Deflection of the frame per newton of load on the suspension.
    compliance_m_per_n: f64,
    /// Height of the frame at this support without load.
    free_height_m: f64,
}

/// The axles of each load group; an axle without one is a group of its own.
pub fn load_groups(axles: &[PlacedAxle<'_>]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (i, placed) in axles.iter().enumerate() {
        let group = groups.iter_mut().find(|members| {
            let first = &axles[members[0]];
            placed.axle.load_group.is_some()
                && first.axle.load_group == placed.axle.load_group
                && first.on_trailer == placed.on_trailer
        });
        match group {
            Some(members) => members.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups
}

fn supports(vehicle: &Vehicle, axles: &[PlacedAxle<'_>], gives: &[Give]) -> Vec<Support> {
    let support = |members: Vec<usize>| Support {
        on_trailer: axles[members[0]].on_trailer,
        position_m: 0.0,
        axles: members,
        compliance_m_per_n: 0.0,
        free_height_m: 0.0,
    };
    let mut supports: Vec<Support> = load_groups(axles).into_iter().map(support).collect();
    for support in &mut supports {
        // The values of a group are means over its axles, each of which carries 1/n of the load.
        #[allow(clippy::cast_precision_loss)]
        let n = support.axles.len() as f64;
        for &i in &support.axles {
            let (placed, give) = (&axles[i], &gives[i]);
            let springs_n_per_m = 2.0 * placed.axle.spring_stiffness_n_per_m;
            let weight_n = placed.axle.unsprung_mass_kg * vehicle.gravity_mps2;
            let position_m = if placed.on_trailer {
                placed.position_m
            } else {
                placed.position_m + vehicle.tractor.hitch_behind_cg_m
            };
            support.position_m += position_m / n;
            support.compliance_m_per_n +=
                (1.0 / springs_n_per_m + give.compliance_m_per_n) / (n * n);
            support.free_height_m += (placed.tyre.unloaded_radius_m.unwrap_or(0.0)
                + placed.axle.spring_free_rise_m
                + give.rise_m
                - weight_n * give.compliance_m_per_n)
                / n;
        }
    }
    supports
}

/// The static loads for a load of the trailer.
///
/// # Errors
/// [`VehicleError`] if the vehicle tips (an axle or the fifth wheel lifts), if the mass is below
/// empty, or if the loads depend on stiffness and a tire has no `unloaded_radius_m`.
pub fn static_balance(vehicle: &Vehicle, load: Load) -> Result<StaticBalance, VehicleError> {
    let gives = upright(vehicle);
    determined(vehicle).map_err(|(_, _, problem)| VehicleError::Model(problem))?;
    balance_on(vehicle, load, &gives)
}

/// The deflections with all tires of all axles on the road.
fn upright(vehicle: &Vehicle) -> Vec<Give> {
    vehicle.axles().iter().map(Give::upright).collect()
}

/// The static loads when some tires have left the road, of a vehicle that is [`determined`].
pub(crate) fn balance_on(
    vehicle: &Vehicle,
    load: Load,
    gives: &[Give],
) -> Result<StaticBalance, VehicleError> {
    let balance = solved_on(vehicle, load, gives)?;
    let tractor = vehicle.tractor.axle.len();
    if let Some(i) = balance.axle_load_n.iter().position(|&force| force.is_nan() || force <= 0.0) {
        let axle = if i < tractor {
            format!("tractor.axle[{i}]")
        } else {
            format!("trailer.axle[{}]", i - tractor)
        };
        return Err(VehicleError::Model(format!(
            "static balance: {axle} carries {:.0} N, so the vehicle tips over its other axles; \
             check the axles' ahead_of_cg_m and behind_hitch_m, tractor.hitch_behind_cg_m, \
             trailer.tare.cg_behind_hitch_m, trailer.payload.behind_hitch_m and the masses",
            balance.axle_load_n[i]
        )));
    }
    Ok(balance)
}

/// The static loads, including those with which an axle lifts.
pub(crate) fn solved(vehicle: &Vehicle, load: Load) -> Result<StaticBalance, VehicleError> {
    solved_on(vehicle, load, &upright(vehicle))
}

fn solved_on(vehicle: &Vehicle, load: Load, gives: &[Give]) -> Result<StaticBalance, VehicleError> {
    let axles = vehicle.axles();
    let sprung = vehicle.trailer_sprung_mass(load)?;
    let supports = supports(vehicle, &axles, gives);
    let solution = solve(vehicle, &sprung, &supports)?;

    let g = vehicle.gravity_mps2;
    let mut axle_load_n = vec![0.0; axles.len()];
    for (support, force_n) in supports.iter().zip(solution.iter()) {
        #[allow(clippy::cast_precision_loss)]
        let n = support.axles.len() as f64;
        for &i in &support.axles {
            axle_load_n[i] = force_n / n + axles[i].axle.unsprung_mass_kg * g;
        }
    }
    let hitch_load_n = solution[supports.len()];
    let moment_nm: f64 = supports
        .iter()
        .zip(solution.iter())
        .filter(|(support, _)| support.on_trailer)
        .map(|(support, force_n)| support.position_m * force_n)
        .sum();
    let residual_nm = moment_nm - sprung.mass_kg * g * sprung.cg_behind_hitch_m;
    Ok(StaticBalance { axle_load_n, hitch_load_n, residual_nm })
}

/// Whether the static loads do not follow from forces and moments alone.
pub(crate) fn depends_on_stiffness(vehicle: &Vehicle) -> bool {
    let supports = supports(vehicle, &vehicle.axles(), &upright(vehicle));
    let on_trailer = supports.iter().filter(|support| support.on_trailer).count();
    !(on_trailer == 1 && supports.len() == 3)
}

/// Whether the file contains enough for the static loads; otherwise the key, its value and the
/// problem.
pub(crate) fn determined(vehicle: &Vehicle) -> Result<(), (String, String, String)> {
    let axles = vehicle.axles();
    let supports = supports(vehicle, &axles, &upright(vehicle));
    if supports.iter().filter(|support| !support.on_trailer).count() < 2 {
        return Err((
            "tractor.axle".to_owned(),
            vehicle.tractor.axle.len().to_string(),
            "static balance: the tractor needs at least two axles (or load groups)".to_owned(),
        ));
    }
    if let Some(i) = axles.iter().position(|placed| placed.axle.leveled)
        && depends_on_stiffness(vehicle)
    {
        let tractor = vehicle.tractor.axle.len();
        let (unit, i) = if i < tractor { ("tractor", i) } else { ("trailer", i - tractor) };
        return Err((
            format!("{unit}.axle[{i}].leveled"),
            "true".to_owned(),
            "static balance: leveled axles of a unit have the same pressure; give axles that share \
             their load a load_group"
                .to_owned(),
        ));
    }
    let missing = vehicle.tyre.iter().enumerate().find(|(_, tyre)| {
        tyre.unloaded_radius_m.is_none() && axles.iter().any(|placed| placed.tyre == *tyre)
    });
    match missing {
        Some((i, tyre)) if depends_on_stiffness(vehicle) => Err((
            format!("tyre[{i}].unloaded_radius_m"),
            "(missing)".to_owned(),
            format!(
                "static balance: with this many axles the loads depend on stiffness; give tire \
                 \"{}\" its unloaded_radius_m, or axles that share their load a load_group",
                tyre.name
            ),
        )),
        _ => Ok(()),
    }
}

/// Suspension force of each support and the hitch load, N.
fn solve(
    vehicle: &Vehicle,
    sprung: &SprungMass,
    supports: &[Support],
) -> Result<DVector<f64>, VehicleError> {
    // Unknowns: support forces F, hitch load H (on the tractor, downwards), height z of the frame
    // at the hitch, slope of each frame (rise per meter of distance from the hitch).
    let n = supports.len();
    let (hitch, height, slope) = (n, n + 1, n + 2);
    let mut a = DMatrix::zeros(n + 4, n + 4);
    let mut b = DVector::zeros(n + 4);
    let g = vehicle.gravity_mps2;
    // A force of 1 MN is weighted like a deflection of 1 m, so that the system is well scaled.
    let scale_n = 1e6;
    for (i, support) in supports.iter().enumerate() {
        // z + slope · position + compliance · F = free height
        a[(i, height)] = 1.0;
        a[(i, slope + usize::from(support.on_trailer))] = support.position_m;
        a[(i, i)] = support.compliance_m_per_n * scale_n;
        b[i] = support.free_height_m;
        let unit = n + 2 * usize::from(support.on_trailer);
        a[(unit, i)] = 1.0;
        a[(unit + 1, i)] = support.position_m;
    }
    // Forces and moments about the hitch (eqs. 2.1–2.4).
    a[(n, hitch)] = -1.0;
    b[n] = vehicle.tractor.sprung_mass_kg * g / scale_n;
    b[n + 1] = b[n] * vehicle.tractor.hitch_behind_cg_m;
    a[(n + 2, hitch)] = 1.0;
    b[n + 2] = sprung.mass_kg * g / scale_n;
    b[n + 3] = b[n + 2] * sprung.cg_behind_hitch_m;
    let solution = a.lu().solve(&b).filter(|x| x.iter().all(|value| value.is_finite()));
    solution.map(|x| x * scale_n).ok_or_else(|| {
        VehicleError::Model("static balance: two supports of one unit coincide".to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For any payload, because the balance is linear in it.
    #[test]
    fn axle_loads_tell_the_mass() {
        for name in ["kraz", "baseline"] {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
            let vehicle = Vehicle::load(format!("{folder}/{name}.toml")).unwrap();
            let [empty, slope] = vehicle.mass_of_axle_load().unwrap();
            for payload_kg in [0.0, 3e3, 12e3, 25e3] {
                let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
                let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
                let balance = static_balance(&vehicle, load).unwrap();
                let on_axles_n = trailer_mass_kg * vehicle.gravity_mps2 - balance.hitch_load_n;
                let found = empty + slope * on_axles_n / vehicle.gravity_mps2;
                assert!((found / trailer_mass_kg - 1.0).abs() < 1e-9, "{name} {found}");
            }
        }
    }
}
