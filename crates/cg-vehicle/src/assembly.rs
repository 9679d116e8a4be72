//! The equations of motion with all terms, put together from bodies, axles and the fifth wheel.

use nalgebra::{DMatrix, DVector};

use crate::balance::StaticBalance;
use crate::cornering::group;
use crate::equations::{Equations, Motion, q, w};
use crate::load::SprungMass;
use crate::twisting::{DAMPING_S, Part, Twisting};
use crate::vehicle::{Hitch, PlacedAxle, Tractor, Vehicle};

/// What the equations take from a vehicle under a load.
pub(crate) struct Parts<'a> {
    /// The vehicle with its springs as they are under the load.
    pub(crate) vehicle: &'a Vehicle,
    pub(crate) sprung: SprungMass,
    pub(crate) balance: &'a StaticBalance,
    pub(crate) motion: Motion,
    /// [`axle_roll_stiffness`] in this motion.
    pub(crate) roll_stiffness: &'a [f64],
}

/// Roll stiffness of each axle's springs under its load, in a motion, N m/rad.
pub(crate) fn axle_roll_stiffness(
    vehicle: &Vehicle,
    balance: &StaticBalance,
    motion: &Motion,
) -> Vec<f64> {
    let axles = vehicle.axles();
    let of_axles = axles.iter().zip(&balance.axle_load_n).map(|(placed, &load_n)| {
        let unit = usize::from(placed.on_trailer);
        let (amplitude_rad, friction) = (motion.amplitude_rad[unit], motion.friction[unit]);
        motion.stiffness[unit] * vehicle.roll_stiffness(placed, load_n, amplitude_rad, friction)
    });
    of_axles.collect()
}

/// The equations with all terms.
pub(crate) fn complete(parts: &Parts<'_>, speed_mps: f64) -> Equations {
    let Parts { vehicle, sprung, balance, motion, roll_stiffness } = parts;
    let axles = vehicle.axles();
    let mut e = Equations::zeros(axles.len(), Twisting::of(vehicle), speed_mps);
    let (tractor, hitch) = (&vehicle.tractor, &vehicle.hitch);
    // A point z above a c.g. moves to the left by −z φ̇; a point x ahead of it by +x r.
    let tractor_above_m = tractor.cg_height_m - hitch.height_m;
    let trailer_above_m = sprung.cg_height_m - hitch.height_m;
    let mut velocity = DVector::zeros(e.mass.nrows());
    velocity[w::LATERAL] = 1.0;
    let tractor_cg = Point { velocity, on_trailer: false };
    let at_hitch = at_hitch(&tractor_cg, tractor, hitch);

    add_mass(&mut e, tractor.sprung_mass_kg, &tractor_cg);
    let trailer_cg = add_trailer(&mut e, &at_hitch, sprung, vehicle);
    // The axles' body: the trailer, or its rear half.
    let on_axles = at_hitch
        .clone()
        .moved(w::YAW_2, -sprung.cg_behind_hitch_m)
        .moved(w::ROLL_2, hitch.height_m - sprung.cg_height_m);
    for (index, inertia) in
        [(w::YAW_1, tractor.yaw_inertia_kgm2), (w::ROLL_1, tractor.roll_inertia_kgm2)]
    {
        e.mass[(index, index)] += inertia;
    }
    // The fifth wheel: roll spring, and its vertical force above or below each sprung c.g.
    let k5 = hitch.roll_stiffness_nm_per_rad;
    e.hitch_roll_stiffness = k5;
    (e.articulated, e.trailer_kg) = (motion.articulated, sprung.mass_kg);
    e.stiffness[(w::ROLL_1, q::ROLL_1)] += balance.hitch_load_n * tractor_above_m;
    e.stiffness[(w::ROLL_2, q::ROLL_2)] -= balance.hitch_load_n * trailer_above_m;
    for (i, placed) in axles.iter().enumerate() {
        let cg = if placed.on_trailer { &on_axles } else { &tractor_cg };
        let (ahead_m, cg_height_m) = if placed.on_trailer {
            (sprung.cg_behind_hitch_m - placed.position_m, sprung.cg_height_m)
        } else {
            (placed.position_m, tractor.cg_height_m)
        };
        let total_n = balance.axle_load_n[i];
        let load = AxleLoad {
            total_n,
            sprung_n: total_n - placed.axle.unsprung_mass_kg * vehicle.gravity_mps2,
            roll_stiffness: roll_stiffness[i],
            softer: motion.cornering[group(placed)],
        };
        add_axle(&mut e, i, placed, cg, (ahead_m, cg_height_m), &load);
    }
    e.lateral_rate.copy_from(&trailer_cg.velocity);
    // d/dt of the lateral velocity in the rotating frame: U r1 for both units, because the
    // trailer's lateral velocity already contains the articulation rate.
    e.lateral_bias[w::YAW_1] = speed_mps;
    e
}

/// Lateral velocity of a point as a row on `w`, and whether it is on the trailer.
#[derive(Clone)]
pub(crate) struct Point {
    pub(crate) velocity: DVector<f64>,
    pub(crate) on_trailer: bool,
}

impl Point {
    /// The point so far ahead of, or below, this one, about the axis of a yaw or roll rate.
    pub(crate) fn moved(mut self, index: usize, arm_m: f64) -> Self {
        self.velocity[index] += arm_m;
        self
    }
}

/// The fifth wheel, about which the trailer moves.
pub(crate) fn at_hitch(tractor_cg: &Point, tractor: &Tractor, hitch: &Hitch) -> Point {
    let mut point = tractor_cg
        .clone()
        .moved(w::YAW_1, -tractor.hitch_behind_cg_m)
        .moved(w::ROLL_1, tractor.cg_height_m - hitch.height_m);
    point.on_trailer = true;
    point
}

/// Adds the trailer's sprung mass in its parts: the whole, or two halves and the frame between them.
/// Returns the lateral velocity of its c.g.
fn add_trailer(
    e: &mut Equations,
    at_hitch: &Point,
    sprung: &SprungMass,
    vehicle: &Vehicle,
) -> Point {
    let below_m = vehicle.hitch.height_m - sprung.cg_height_m;
    let (front, front_angle) = e.on_hitch();
    let twisting = e.twisting.clone();
    let parts = match twisting {
        Some(_) => Part::halves(sprung, vehicle.trailer.payload.length_m).to_vec(),
        None => vec![Part::whole(sprung)],
    };
    let bodies = [front, w::ROLL_2];
    let mut cg = at_hitch.clone().moved(w::YAW_2, -sprung.cg_behind_hitch_m);
    for (part, body) in parts.iter().zip(bodies) {
        let own = at_hitch.clone().moved(w::YAW_2, -part.cg_behind_hitch_m).moved(body, below_m);
        add_mass(e, part.mass_kg, &own);
        e.mass[(w::YAW_2, w::YAW_2)] += part.yaw_inertia_kgm2;
        e.mass[(body, body)] += part.roll_inertia_kgm2;
        cg = cg.moved(body, part.mass_kg / sprung.mass_kg * below_m);
    }
    let Some(twisting) = twisting else { return cg };
    // The loads of fifth wheel and axles carry both halves; the front half's weight is on its own.
    let lifted_nm = 0.5 * sprung.mass_kg * vehicle.gravity_mps2 * below_m;
    e.stiffness[(front, front_angle)] += lifted_nm;
    e.stiffness[(w::ROLL_2, q::ROLL_2)] -= lifted_nm;
    for (angles, matrix, spring) in [
        ([front_angle, q::ROLL_2], &mut e.stiffness, twisting.stiffness_nm_per_rad),
        (bodies, &mut e.damping, DAMPING_S * twisting.stiffness_nm_per_rad),
    ] {
        for i in 0..2 {
            matrix[(bodies[i], angles[i])] += spring;
            matrix[(bodies[i], angles[1 - i])] -= spring;
        }
    }
    cg
}

/// Adds the inertia of a mass at a point: `m j (jᵀẇ + U r)`.
fn add_mass(e: &mut Equations, mass_kg: f64, point: &Point) {
    let j = &point.velocity;
    add_products(&mut e.mass, j, |i, k| mass_kg * j[i] * j[k]);
    let mut column = e.damping.column_mut(w::YAW_1);
    column += mass_kg * e.speed_mps * j;
}

/// Adds a product to each entry of the columns that the point moves: a few, and without a matrix for the sum.
fn add_products(
    matrix: &mut DMatrix<f64>,
    velocity: &DVector<f64>,
    product: impl Fn(usize, usize) -> f64,
) {
    for (k, mut column) in matrix.column_iter_mut().enumerate() {
        if velocity[k].abs() > 0.0 {
            column.iter_mut().enumerate().for_each(|(i, entry)| *entry += product(i, k));
        }
    }
}

struct AxleLoad {
    total_n: f64,
    sprung_n: f64,
    /// Between body and axle.
    roll_stiffness: f64,
    /// Factor of the tires' cornering stiffness.
    softer: f64,
}

fn add_axle(
    e: &mut Equations,
    i: usize,
    placed: &PlacedAxle<'_>,
    cg: &Point,
    (ahead_m, cg_height_m): (f64, f64),
    load: &AxleLoad,
) {
    let axle = placed.axle;
    let unit = usize::from(cg.on_trailer);
    let (yaw, body, own) = (w::YAW_1 + unit, w::ROLL_1 + unit, w::AXLE + i);
    let (body_angle, own_angle) = (q::ROLL_1 + unit, q::AXLE + i);
    let below_cg_m = cg_height_m - axle.roll_center_height_m;
    let above_axle_m = axle.roll_center_height_m - axle.center_height_m;
    let roll_center = cg.clone().moved(yaw, ahead_m).moved(body, below_cg_m);
    let contact = roll_center.clone().moved(own, axle.roll_center_height_m).velocity;

    add_mass(e, axle.unsprung_mass_kg, &roll_center.moved(own, above_axle_m));
    e.mass[(own, own)] += axle.roll_inertia_kgm2;
    e.mass[(yaw, yaw)] += axle.roll_inertia_kgm2;

    // Tires: the slip angle is α = (velocity at the road)/U − δ (plus the articulation for the
    // trailer). The force at the road is −C α, the aligning moment +M α.
    let (cornering, aligning) = placed.tyre.stiffness_at(load.total_n / placed.tyres());
    let mut force = -placed.tyres() * load.softer * cornering * &contact;
    force[yaw] += placed.tyres() * aligning;
    let speed_mps = e.speed_mps;
    add_products(&mut e.damping, &contact, |i, k| -(force[i] * contact[k] / speed_mps));
    if cg.on_trailer {
        let mut column = e.stiffness.column_mut(q::ARTICULATION);
        column -= &force;
    }
    if placed.steered {
        e.steer -= &force;
    }

    // Springs and dampers. The static loads act on lever arms that grow with the roll angle
    // (second-order geometry of the roll center that slides along the axle; see the potential in
    // docs/model.md).
    let spring = load.roll_stiffness;
    let tyres = placed.tyre_roll_stiffness_nm_per_rad();
    e.stiffness[(body, body_angle)] += spring - load.sprung_n * below_cg_m;
    e.stiffness[(body, own_angle)] -= spring;
    e.stiffness[(own, body_angle)] -= spring;
    e.stiffness[(own, own_angle)] +=
        spring + tyres - load.total_n * axle.center_height_m - load.sprung_n * above_axle_m;
    let damper = axle.roll_damping_nms_per_rad;
    e.damping[(body, body)] += damper;
    e.damping[(body, own)] -= damper;
    e.damping[(own, body)] -= damper;
    e.damping[(own, own)] += damper;
}
