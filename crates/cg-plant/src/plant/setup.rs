//! From the vehicle file and a load to parameters whose static position is known.
//!
//! Heights in the file, and the height of the load, are heights at rest: unloaded tire radii and
//! spring preloads follow from the static loads, so the given position is an equilibrium. With a
//! separate design load, the file's heights hold under that load, and the body settles under any
//! other load.

use super::axle::Axle;
use super::body::Sprung;
use super::dynamics::Parameters;
use super::front::Front;
use super::options::{Characteristics, PlantOptions};
use super::state::{AxleCoordinate, Coordinate, MAX_AXLES, State};
use super::suspension::{Group, Law};
use super::tyre::{PER_SIDE, Tyres};
use super::vector::Vector;
use cg_vehicle::balance::{load_groups, static_balance};
use cg_vehicle::characteristics::FifthWheel;
use cg_vehicle::characteristics::Grip;
use cg_vehicle::error::VehicleError;
use cg_vehicle::twisting::{DAMPING_S, Part, Twisting};
use cg_vehicle::vehicle::PlacedAxle;
use cg_vehicle::{Load, Vehicle};

fn model(message: String) -> VehicleError {
    VehicleError::Model(message)
}

/// Parameters, and the position in which the design load rests.
pub(super) fn parameters(
    vehicle: &Vehicle,
    load: Load,
    options: &PlantOptions,
) -> Result<(Parameters, State), VehicleError> {
    let design_load = options.design_load.unwrap_or(load);
    let vehicle = &*vehicle.with_springs_at(design_load)?;
    let placed = vehicle.axles();
    check(vehicle, &placed, options)?;
    let balance = static_balance(vehicle, design_load)?;
    let g = vehicle.gravity_mps2;
    let sprung_n: Vec<f64> = placed
        .iter()
        .zip(&balance.axle_load_n)
        .map(|(placed, load_n)| load_n - placed.axle.unsprung_mass_kg * g)
        .collect();
    let members = load_groups(&placed);
    let groups = members
        .iter()
        .map(|axles| group(vehicle, &placed, axles, &sprung_n, options.springs))
        .collect::<Result<Vec<_>, _>>()?;
    let axles: Vec<Axle> = placed
        .iter()
        .enumerate()
        .map(|(i, p)| axle(vehicle, p, balance.axle_load_n[i], (i, &members)))
        .collect();
    let linear_tyres = options.tyres == Characteristics::Linear;
    let kinds = vehicle.tyre.iter().map(|tyre| Grip::new(tyre, linear_tyres)).collect();

    let mut state = State::zeros(axles.len());
    state.set(Coordinate::TractorHeight, vehicle.tractor.cg_height_m);
    for (i, axle) in axles.iter().enumerate() {
        state.set_axle(i, AxleCoordinate::Rise, axle.rise_m);
    }
    let (tractor, hitch) = (&vehicle.tractor, &vehicle.hitch);
    let (trailer, front) = trailer(vehicle, load, options)?;
    let parameters = Parameters {
        tractor: Sprung {
            mass_kg: tractor.sprung_mass_kg,
            inertia_kgm2: [
                tractor.roll_inertia_kgm2,
                tractor.pitch_inertia_kgm2.unwrap_or(tractor.yaw_inertia_kgm2),
                tractor.yaw_inertia_kgm2,
            ],
            cg: [0.0; 3],
        },
        trailer,
        front,
        hitch_arm: [-tractor.hitch_behind_cg_m, 0.0, hitch.height_m - tractor.cg_height_m],
        hitch: FifthWheel::of(hitch),
        hitch_inertia_kgm2: 0.0,
        axles,
        groups,
        kinds,
        gravity_mps2: g,
        accelerometers: accelerometers(vehicle),
        side: vehicle.wind.map(|wind| (wind, side_middle(vehicle, wind.side_height_m))),
    };
    Ok((parameters, state))
}

/// Places of the accelerometers from the c.g. of the tractor and from the fifth wheel.
fn accelerometers(vehicle: &Vehicle) -> [Vector; 2] {
    let places = &vehicle.sensors;
    let (ahead_m, behind_m) = vehicle.accelerometer_positions_m();
    [
        [ahead_m, 0.0, places.tractor_accelerometer.height_m - vehicle.tractor.cg_height_m],
        [-behind_m, 0.0, places.accelerometer.height_m - vehicle.hitch.height_m],
    ]
}

fn check(
    vehicle: &Vehicle,
    placed: &[PlacedAxle<'_>],
    options: &PlantOptions,
) -> Result<(), VehicleError> {
    if placed.len() > MAX_AXLES {
        return Err(model(format!(
            "the nonlinear plant has room for {MAX_AXLES} axles, \"{}\" has {}",
            vehicle.name,
            placed.len()
        )));
    }
    if let Some(i) = placed.iter().position(|p| p.axle.tyre_positions_m.len() > PER_SIDE) {
        return Err(model(format!(
            "axle {} has {} tires per side; the nonlinear plant supports single and dual tires",
            i + 1,
            placed[i].axle.tyre_positions_m.len()
        )));
    }
    if !(options.step_s.is_finite() && options.step_s > 0.0) {
        return Err(model(format!("step {} s must be positive", options.step_s)));
    }
    for (name, angle_rad) in [("bank", options.bank_rad), ("grade", options.grade_rad)] {
        if !(angle_rad.abs() < 0.5) {
            return Err(model(format!("a road {name} of {angle_rad} rad is not possible")));
        }
    }
    if !options.payload_behind_m.is_finite() {
        return Err(model("the position of the payload must be finite".to_owned()));
    }
    check_payload_left(vehicle, options.payload_left_m)
}

/// Whether a payload can have its c.g. this far to the left of the middle.
pub(crate) fn check_payload_left(vehicle: &Vehicle, left_m: f64) -> Result<(), VehicleError> {
    let half_m = 0.5 * vehicle.trailer.payload.width_m;
    if !(left_m.abs() <= half_m) {
        return Err(model(format!(
            "⟨payload_left_m⟩ {left_m} must lie between {} and {half_m}, half the width of the payload",
            -half_m
        )));
    }
    Ok(())
}

fn group(
    vehicle: &Vehicle,
    placed: &[PlacedAxle<'_>],
    axles: &[usize],
    sprung_n: &[f64],
    springs: Characteristics,
) -> Result<Group, VehicleError> {
    // A handful of axles: exact.
    #[allow(clippy::cast_precision_loss)]
    let n = axles.len() as f64;
    let mean = |value: &dyn Fn(usize) -> f64| axles.iter().map(|&i| value(i)).sum::<f64>() / n;
    let preload_n = 0.5 * mean(&|i| sprung_n[i]);
    let first = &placed[axles[0]].axle.spring;
    if axles.iter().any(|&i| placed[i].axle.spring != *first) {
        return Err(model(format!(
            "axles {} and {} share their load but name different springs",
            axles[0] + 1,
            axles[axles.len() - 1] + 1
        )));
    }
    let measured = vehicle.spring_of(placed[axles[0]].axle);
    let law = match measured.filter(|_| springs == Characteristics::Measured) {
        Some(spring) => Law::measured(spring, preload_n)?,
        None => Law::Linear {
            preload_n,
            stiffness_n_per_m: mean(&|i| placed[i].axle.spring_stiffness_n_per_m),
        },
    };
    Ok(Group { law, first_axle: axles[0] })
}

fn axle(
    vehicle: &Vehicle,
    placed: &PlacedAxle<'_>,
    load_n: f64,
    (i, members): (usize, &[Vec<usize>]),
) -> Axle {
    let a = placed.axle;
    let group = members.iter().position(|axles| axles.contains(&i)).unwrap_or(0);
    #[allow(clippy::cast_precision_loss)]
    let share = 1.0 / members[group].len() as f64;
    let unit_height_m =
        if placed.on_trailer { vehicle.hitch.height_m } else { vehicle.tractor.cg_height_m };
    let ahead_m = if placed.on_trailer { -placed.position_m } else { placed.position_m };
    let half_damper_m = 0.5 * a.damper_spread_m.unwrap_or(a.spring_spread_m);
    let mut positions_m = [0.0; PER_SIDE];
    for (to, from) in positions_m.iter_mut().zip(&a.tyre_positions_m) {
        *to = *from;
    }
    let tyre = placed.tyre;
    let tyres_n_per_m = placed.tyres() * tyre.vertical_stiffness_n_per_m;
    Axle {
        on_trailer: placed.on_trailer,
        roll_center: [ahead_m, 0.0, a.roll_center_height_m - unit_height_m],
        mass_kg: a.unsprung_mass_kg,
        inertia_kgm2: a.roll_inertia_kgm2,
        rise_m: a.roll_center_height_m - a.center_height_m,
        half_spread_m: 0.5 * a.spring_spread_m,
        auxiliary_nm_per_rad: a.auxiliary_roll_stiffness_nm_per_rad,
        bounce_damping_ns_per_m: a.roll_damping_nms_per_rad / (half_damper_m * half_damper_m),
        roll_damping_nms_per_rad: a.roll_damping_nms_per_rad,
        roll_steer: a.roll_steer_rad_per_rad,
        steered: f64::from(u8::from(placed.steered)),
        group,
        share,
        tyres: Tyres {
            kind: vehicle.tyre.iter().position(|t| t.name == tyre.name).unwrap_or(0),
            positions_m,
            per_side: a.tyre_positions_m.len(),
            stiffness_n_per_m: tyre.vertical_stiffness_n_per_m,
            damping_ns_per_m: tyre.vertical_damping_ns_per_m,
            overturning_nm_per_rad: placed.tyres() * tyre.overturning_stiffness_nm_per_rad,
            unloaded_radius_m: a.center_height_m + load_n / tyres_n_per_m,
            relaxation_length_m: tyre.relaxation_length_m,
        },
    }
}

/// The middle of the side of the trailer's body from the fifth wheel: that of the box of the payload.
fn side_middle(vehicle: &Vehicle, height_m: f64) -> Vector {
    [-vehicle.trailer.payload.behind_hitch_m, 0.0, height_m - vehicle.hitch.height_m]
}

/// The trailer's sprung mass, or its rear half and its front half if its frame twists.
fn trailer(
    vehicle: &Vehicle,
    load: Load,
    options: &PlantOptions,
) -> Result<(Sprung, Option<Front>), VehicleError> {
    let mut sprung = vehicle.trailer_sprung_mass(load)?;
    let share = sprung.payload_kg / sprung.mass_kg;
    let left_m = share * options.payload_left_m;
    // Parallel-axis term of a payload that is not at the tare's c.g.; products of inertia are left out.
    let apart_kg = share * (sprung.mass_kg - sprung.payload_kg);
    let beside = apart_kg * options.payload_left_m * options.payload_left_m;
    let place = &vehicle.trailer;
    let along_m = place.payload.behind_hitch_m - place.tare.cg_behind_hitch_m;
    let apart_m = along_m + options.payload_behind_m;
    let along = apart_kg * (apart_m * apart_m - along_m * along_m);
    sprung.cg_behind_hitch_m += share * options.payload_behind_m;
    sprung.roll_inertia_kgm2 += beside;
    sprung.pitch_inertia_kgm2 += along;
    sprung.yaw_inertia_kgm2 = sprung.yaw_inertia_kgm2 + beside + along;
    let above_m = sprung.cg_height_m - vehicle.hitch.height_m;
    let body = |part: &Part| Sprung {
        mass_kg: part.mass_kg,
        inertia_kgm2: [part.roll_inertia_kgm2, part.pitch_inertia_kgm2, part.yaw_inertia_kgm2],
        cg: [-part.cg_behind_hitch_m, left_m, above_m],
    };
    let Some(twisting) = Twisting::of(vehicle) else {
        return Ok((body(&Part::whole(&sprung)), None));
    };
    let [front, rear] = Part::halves(&sprung, place.payload.length_m);
    let frame = Front {
        half: body(&front),
        mass_share: front.mass_kg / sprung.mass_kg,
        stiffness_nm_per_rad: twisting.stiffness_nm_per_rad,
        damping_nms_per_rad: DAMPING_S * twisting.stiffness_nm_per_rad,
        roll_share: twisting.roll_share,
        accelerometer_share: twisting.accelerometer_share,
    };
    Ok((body(&rear), Some(frame)))
}
