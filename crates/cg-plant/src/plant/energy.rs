//! Energy of the plant, and the test of its conservation, which reveals any wrong sign in the
//! equations.

use super::axle::Pose;
use super::body::{Attitude, Motion, Sprung};
use super::dynamics::{Control, Parameters, Probe};
use super::front::Front;
use super::hitch::{Side, couple};
use super::options::PlantOptions;
use super::state::{AxleCoordinate as A, Coordinate as C, FRONT_ROLL, FRONT_ROLL_RATE, State, at};
use super::suspension::Law;
use super::vector::{Vector, cross, sin_cos, turned};
use super::yaw_roll::YawRollPlant;
use cg_vehicle::Vehicle;

fn square(v: Vector) -> f64 {
    v.iter().map(|x| x * x).sum()
}

/// Kinetic and potential energy of a sprung mass.
fn sprung(p: &Parameters, motion: &Motion, height_m: f64, body: &Sprung) -> f64 {
    let a = &motion.attitude;
    let rho = a.outward(body.cg);
    let (velocity, _) = motion.point(rho);
    let [yaw, pitch, roll] = motion.rates;
    // Angular velocity in body axes.
    let omega = [
        roll - yaw * a.sin_pitch,
        pitch * a.cos_roll + yaw * a.cos_pitch * a.sin_roll,
        yaw * a.cos_pitch * a.cos_roll - pitch * a.sin_roll,
    ];
    let spin: f64 = (0..3).map(|k| body.inertia_kgm2[k] * omega[k] * omega[k]).sum();
    0.5 * body.mass_kg * square(velocity)
        + 0.5 * spin
        + body.mass_kg * p.gravity_mps2 * (height_m + rho[2])
}

/// Kinetic and potential energy of an axle, its tires and its springs.
fn axle(p: &Parameters, state: &State, i: usize, motion: &Motion, height_m: f64) -> f64 {
    let axle = &p.axles[i];
    let own = [A::Rise, A::Roll, A::RiseRate, A::RollRate].map(|c| state.x[at(i, c)]);
    let body = if axle.on_trailer { C::TrailerRoll } else { C::TractorRoll };
    let pose = Pose::new(own, state.get(body), motion);
    let rho = motion.attitude.outward(axle.roll_center);
    let k = [0.0, -pose.sin, pose.cos];
    let omega = [pose.roll_rate, 0.0, motion.rates[0]];
    let (at_center, _) = motion.point(rho);
    let turning = cross(omega, k);
    let velocity =
        [0, 1, 2].map(|j| at_center[j] - pose.rise_rate * k[j] - pose.rise_m * turning[j]);
    let spin = square([pose.roll_rate, motion.rates[0] * pose.cos, 0.0]);
    let center_m = height_m + rho[2] - pose.rise_m * pose.cos;
    let mut energy = 0.5 * axle.mass_kg * square(velocity)
        + 0.5 * axle.inertia_kgm2 * spin
        + axle.mass_kg * p.gravity_mps2 * center_m;
    let tyres = &axle.tyres;
    for y in tyres.positions_m[..tyres.per_side].iter().flat_map(|y| [*y, -*y]) {
        let length = (center_m + y * pose.sin) / pose.cos;
        let deflection = (tyres.unloaded_radius_m - length).max(0.0);
        energy += 0.5 * tyres.stiffness_n_per_m * deflection * deflection;
    }
    let Law::Linear { preload_n, stiffness_n_per_m } = p.groups[axle.group].law else {
        panic!("linear springs")
    };
    for [x, _] in axle.compression(&pose) {
        energy += preload_n * x + 0.5 * stiffness_n_per_m * x * x;
    }
    let lean = state.get(body) - own[1];
    energy
        + 0.5 * axle.auxiliary_nm_per_rad * lean * lean
        + 0.5 * tyres.overturning_nm_per_rad * own[1] * own[1]
}

/// Total energy, for linear springs and axles without load groups.
fn energy_j(p: &Parameters, state: &State) -> f64 {
    let value = |c| state.get(c);
    let turn_rad = value(C::TrailerYaw) - value(C::TractorYaw);
    let turn = sin_cos(turn_rad);
    let tractor = Motion::new(
        Attitude::new(value(C::TractorPitch), value(C::TractorRoll)),
        [value(C::TractorYawRate), value(C::TractorPitchRate), value(C::TractorRollRate)],
        [0.0, value(C::LateralVelocity), value(C::VerticalVelocity)],
        [0.0; 3],
    );
    let hitch = tractor.attitude.outward(p.hitch_arm);
    let trailer = Motion::new(
        Attitude::new(value(C::TrailerPitch), value(C::TrailerRoll)),
        [value(C::TrailerYawRate), value(C::TrailerPitchRate), value(C::TrailerRollRate)],
        turned(tractor.point(hitch).0, turn),
        [0.0; 3],
    );
    let heights = [value(C::TractorHeight), value(C::TractorHeight) + hitch[2]];
    let mut energy =
        sprung(p, &tractor, heights[0], &p.tractor) + sprung(p, &trailer, heights[1], &p.trailer);
    let mut on_hitch = trailer;
    if let Some(front) = &p.front {
        let motion = Front::motion(&state.x, value(C::TrailerPitch), &trailer);
        let twist_rad = state.x[FRONT_ROLL] - value(C::TrailerRoll);
        energy += sprung(p, &motion, heights[1], &front.half);
        energy += 0.5 * front.stiffness_nm_per_rad * twist_rad * twist_rad;
        on_hitch = motion;
    }
    for (i, a) in p.axles.iter().enumerate() {
        let unit = usize::from(a.on_trailer);
        energy += axle(p, state, i, [&tractor, &trailer][unit], heights[unit]);
    }
    // The fifth wheel: its angle from the vertical of the one unit in the heading of the other.
    let roll_of = if p.front.is_some() { FRONT_ROLL } else { C::TrailerRoll as usize };
    let angle = if p.hitch.tilts_on_tractor {
        let k = turned(on_hitch.attitude.outward([0.0, 0.0, 1.0]), (-turn.0, turn.1));
        libm::atan2(-k[1], k[2]) - value(C::TractorRoll)
    } else {
        let k = turned(tractor.attitude.outward([0.0, 0.0, 1.0]), turn);
        libm::atan2(-k[1], k[2]) - state.x[roll_of]
    };
    let side = Side::new(&on_hitch, state.x[roll_of]);
    let coupling = couple(&p.hitch, &Side::new(&tractor, value(C::TractorRoll)), &side, turn);
    let rate: f64 = (0..3)
        .map(|i| {
            coupling.by_tractor[i] * tractor.rates[i] + coupling.by_trailer[i] * on_hitch.rates[i]
        })
        .sum();
    energy
        + 0.5 * p.hitch.stiffness_nm_per_rad * angle * angle
        + 0.5 * p.hitch_inertia_kgm2 * rate * rate
}

/// The vehicle of the file without lateral tire forces, dampers and load groups. The c.g. of its trailer is
/// this far to the left: it does not rest there, but falls. Its frame may twist, and its fifth wheel tilts about
/// an axis of one of the units, with an apparent inertia.
fn conservative(
    file: &str,
    cg_left_m: f64,
    frame_nm_per_rad: Option<f64>,
    (tilts_on_tractor, hitch_inertia_kgm2): (bool, f64),
) -> YawRollPlant {
    let path = format!("{}/../../fixtures/vehicles/{file}", env!("CARGO_MANIFEST_DIR"));
    let mut vehicle = Vehicle::load(path).unwrap();
    for tyre in &mut vehicle.tyre {
        tyre.cornering_stiffness_n_per_rad.fill(0.0);
        tyre.aligning_stiffness_nm_per_rad.fill(0.0);
        tyre.unloaded_radius_m = Some(tyre.unloaded_radius_m.unwrap_or(0.53));
        tyre.lateral_force = None;
        tyre.aligning_moment = None;
        tyre.vertical_damping_ns_per_m = 0.0;
    }
    let tractor = vehicle.tractor.axle.iter_mut().map(|a| &mut a.axle);
    for axle in tractor.chain(vehicle.trailer.axle.iter_mut().map(|a| &mut a.axle)) {
        axle.roll_damping_nms_per_rad = 0.0;
        axle.auxiliary_roll_stiffness_nm_per_rad += 1e4;
        axle.load_group = None;
        axle.spring = None;
    }
    vehicle.hitch.roll_stiffness_nm_per_rad = vehicle.hitch.roll_stiffness_nm_per_rad.min(1e6);
    vehicle.hitch.tilts_on_tractor = Some(tilts_on_tractor);
    vehicle.trailer.frame_torsional_stiffness_nm_per_rad = frame_nm_per_rad;
    let (load, options) = (vehicle.reference_load(), PlantOptions::default());
    let mut plant = YawRollPlant::new(&vehicle, load, &options).unwrap();
    plant.parameters.trailer.cg[1] = cg_left_m;
    plant.parameters.hitch_inertia_kgm2 = hitch_inertia_kgm2;
    if let Some(front) = &mut plant.parameters.front {
        front.half.cg[1] = cg_left_m;
        front.damping_nms_per_rad = 0.0;
    }
    plant
}

fn drift_j(plant: &YawRollPlant, step_s: f64) -> (f64, f64) {
    let mut state = plant.design;
    let begin = energy_j(&plant.parameters, &state);
    for (c, rate) in [
        (C::LateralVelocity, 0.5),
        (C::VerticalVelocity, 0.1),
        (C::TractorYawRate, 0.3),
        (C::TractorPitchRate, 0.05),
        (C::TractorRollRate, 0.15),
        (C::TrailerYawRate, -0.2),
        (C::TrailerPitchRate, 0.03),
        (C::TrailerRollRate, 0.2),
    ] {
        // Half of what lifts the lightest wheel, because RK4 is not accurate over the kink of a lift.
        state.set(c, 0.5 * rate);
    }
    if plant.parameters.front.is_some() {
        state.x[FRONT_ROLL_RATE] = -0.1;
    }
    let start = energy_j(&plant.parameters, &state);
    let (still, mut probe) = ([Control::default(); 3], Probe::default());
    let mut time_s = 0.0;
    let mut worst = 0.0_f64;
    while time_s < 2.0 {
        state = plant.runge_kutta(&state, &still, step_s, &mut probe);
        time_s += step_s;
        let seen = &probe.contacts[..plant.parameters.axles.len()];
        assert!(seen.iter().all(|axle| axle.left_n > 0.0 && axle.right_n > 0.0));
        worst = worst.max((energy_j(&plant.parameters, &state) - start).abs());
    }
    (worst, start - begin)
}

/// Any wrong sign or missing term changes the energy by joules. The integration method itself loses
/// `(ω h)⁶/72` of each mode's energy per step: 2⁵ times less over the same time for half the step.
/// The fastest mode has ω = 95 rad/s and loses 2e-5 of its energy in 2000 steps of 1 ms. It and the
/// few modes like it contain some percent of the total energy.
#[test]
fn energy_stays_without_dampers_and_lateral_tyre_forces() {
    for (file, cg_left_m, frame_nm_per_rad, hitch) in [
        ("baseline.toml", 0.0, None, (true, 0.0)),
        ("baseline.toml", 0.0, None, (false, 0.0)),
        ("kraz.toml", 0.0, None, (true, 0.0)),
        ("baseline.toml", 0.05, None, (true, 0.0)),
        ("kraz.toml", 0.0, Some(6e5), (true, 0.0)),
        ("euro.toml", 0.05, Some(3e6), (true, 0.0)),
        ("euro.toml", 0.05, Some(3e6), (false, 0.0)),
        ("kraz.toml", 0.05, None, (true, 5e4)),
        ("kraz.toml", 0.0, None, (false, 5e4)),
        ("euro.toml", 0.05, Some(3e6), (true, 5e4)),
        ("euro.toml", 0.05, Some(3e6), (false, 5e4)),
    ] {
        let plant = conservative(file, cg_left_m, frame_nm_per_rad, hitch);
        let (coarse, put_in) = drift_j(&plant, 2e-3);
        let (fine, _) = drift_j(&plant, 1e-3);
        println!(
            "{file}: {put_in:.0} J put in; drift {coarse:.2e} J at 2 ms, {fine:.2e} J at 1 ms"
        );
        assert!(fine < 4e-7 * put_in, "{file}: {fine}");
        let ratio = coarse / fine;
        assert!((ratio - 32.0).abs() < 4.0, "{file}: {ratio}");
    }
}
