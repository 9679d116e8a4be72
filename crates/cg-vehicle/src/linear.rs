//! The linear yaw/roll model of a tractor-semitrailer at constant speed (chapters 3 and 4).
//!
//! Degrees of freedom: lateral velocity of the tractor, yaw of both units, roll of both sprung
//! masses, and roll of each axle about the roll center of its suspension. Signs follow ISO 8855.
//!
//! ```text
//!     w = (v, r1, r2, φ̇1, φ̇2, φ̇u…)      velocities
//!     q = (ψ1 − ψ2, φ1, φ2, φu…)          articulation and roll angles
//!     M ẇ + C w + K q = b δ
//! ```
//!
//! * [`Variant::Complete`] (default) is derived from virtual power. Each body has its own mass and
//!   c.g. inertia, tire forces act at the road, and the lateral and vertical force of the fifth
//!   wheel acts about each sprung c.g.
//! * [`Variant::AsPrinted`] is appendix B of the thesis with its misprints corrected. It lumps each
//!   unit's mass for the lateral motion, counts `m Xc²` twice in yaw, and neglects the force of the
//!   fifth wheel in the roll equations. It is kept because it reproduces the thesis's results.
//!
//! In the steady-state equations the height of the trailer's c.g. occurs in one row only (trailer
//! roll), and linearly. [`ratio_line`] is therefore exact.

use nalgebra::DVector;

use cg_core::RatioLine;

use crate::as_printed;
use crate::balance::{StaticBalance, static_balance};
use crate::equations::{Equations, Variant, q, w};
use crate::error::VehicleError;
use crate::load::Load;
use crate::response::StateSpace;
use crate::vehicle::{PlacedAxle, Vehicle};

impl Equations {
    /// The equations of motion of a vehicle.
    ///
    /// # Errors
    /// [`VehicleError`] if the load is impossible, or if the printed model is not known for this
    /// load.
    pub fn new(
        vehicle: &Vehicle,
        variant: Variant,
        speed_mps: f64,
        load: Load,
    ) -> Result<Self, VehicleError> {
        if !(speed_mps.is_finite() && speed_mps > 0.0) {
            return Err(VehicleError::Model(format!("speed {speed_mps} m/s must be positive")));
        }
        match variant {
            Variant::Complete => complete(vehicle, speed_mps, load),
            Variant::AsPrinted => as_printed::equations(vehicle, speed_mps, load),
        }
    }
}

/// Columns of [`Equations::steady`].
const STEADY_YAW_RATE: usize = 1;
const STEADY_TRAILER_ROLL: usize = 2 + q::ROLL_2;

/// `(N_φ, N_r, D)` of Cramer's rule: the numerators of trailer roll and yaw rate, and the
/// denominator.
fn determinants(equations: &Equations) -> (f64, f64, f64) {
    let s = equations.steady();
    let replaced = |column: usize| {
        let mut s = s.clone();
        s.set_column(column, &equations.steer);
        s.determinant()
    };
    (replaced(STEADY_TRAILER_ROLL), replaced(STEADY_YAW_RATE), s.determinant())
}

/// The analytic DC ratios as functions of the height (eq. 5.17): roll per steer angle (rad/rad),
/// and roll per lateral acceleration (rad per m/s²). Both are scaled to `b0 + b1 h = 1` at the
/// height of `load`.
///
/// # Errors
/// As [`Equations::new`].
pub fn ratio_line(
    vehicle: &Vehicle,
    variant: Variant,
    speed_mps: f64,
    load: Load,
) -> Result<[RatioLine<f64>; 2], VehicleError> {
    let at = |cg_height_m: f64| {
        Equations::new(vehicle, variant, speed_mps, Load { cg_height_m, ..load })
            .map(|equations| determinants(&equations))
    };
    // Any two heights are possible, because both determinants are exactly linear. With half a meter
    // the rounding error is small.
    let step_m = 0.5;
    let here = at(load.cg_height_m)?;
    let above = at(load.cg_height_m + step_m)?;
    let line = |numerator: (f64, f64), denominator: (f64, f64)| {
        let scale = denominator.0;
        let (a1, b1) = (
            (numerator.1 - numerator.0) / step_m / scale,
            (denominator.1 - denominator.0) / step_m / scale,
        );
        RatioLine {
            a0: numerator.0 / scale - a1 * load.cg_height_m,
            a1,
            b0: 1.0 - b1 * load.cg_height_m,
            b1,
        }
    };
    let roll = (here.0, above.0);
    // In steady state the lateral acceleration is speed times yaw rate.
    let lateral = (here.1 * speed_mps, above.1 * speed_mps);
    Ok([line(roll, (here.2, above.2)), line(roll, lateral)])
}

/// Lateral velocity of a point as a row on `w`, and whether it is on the trailer.
#[derive(Clone)]
struct Point {
    velocity: DVector<f64>,
    on_trailer: bool,
}

impl Point {
    fn moved(&self, index: usize, arm_m: f64) -> Self {
        let mut point = self.clone();
        point.velocity[index] += arm_m;
        point
    }
}

fn complete(vehicle: &Vehicle, speed_mps: f64, load: Load) -> Result<Equations, VehicleError> {
    let sprung = vehicle.trailer_sprung_mass(load)?;
    let balance = static_balance(vehicle, load)?;
    let axles = vehicle.axles();
    let mut e = Equations::zeros(axles.len(), speed_mps);
    let (tractor, hitch) = (&vehicle.tractor, &vehicle.hitch);
    // A point z above a c.g. moves to the left by −z φ̇; a point x ahead of it by +x r.
    let tractor_above_m = tractor.cg_height_m - hitch.height_m;
    let trailer_above_m = sprung.cg_height_m - hitch.height_m;
    let mut velocity = DVector::zeros(e.mass.nrows());
    velocity[w::LATERAL] = 1.0;
    let tractor_cg = Point { velocity, on_trailer: false };
    let at_hitch =
        tractor_cg.moved(w::YAW_1, -tractor.hitch_behind_cg_m).moved(w::ROLL_1, tractor_above_m);
    let mut trailer_cg =
        at_hitch.moved(w::YAW_2, -sprung.cg_behind_hitch_m).moved(w::ROLL_2, -trailer_above_m);
    trailer_cg.on_trailer = true;

    add_mass(&mut e, tractor.sprung_mass_kg, &tractor_cg);
    add_mass(&mut e, sprung.mass_kg, &trailer_cg);
    for (index, inertia) in [
        (w::YAW_1, tractor.yaw_inertia_kgm2),
        (w::YAW_2, sprung.yaw_inertia_kgm2),
        (w::ROLL_1, tractor.roll_inertia_kgm2),
        (w::ROLL_2, sprung.roll_inertia_kgm2),
    ] {
        e.mass[(index, index)] += inertia;
    }
    // The fifth wheel: roll spring, and its vertical force above or below each sprung c.g.
    let k5 = hitch.roll_stiffness_nm_per_rad;
    e.stiffness[(w::ROLL_1, q::ROLL_1)] += k5 + balance.hitch_load_n * tractor_above_m;
    e.stiffness[(w::ROLL_2, q::ROLL_2)] += k5 - balance.hitch_load_n * trailer_above_m;
    e.stiffness[(w::ROLL_1, q::ROLL_2)] -= k5;
    e.stiffness[(w::ROLL_2, q::ROLL_1)] -= k5;
    for (i, placed) in axles.iter().enumerate() {
        let cg = if placed.on_trailer { &trailer_cg } else { &tractor_cg };
        let (ahead_m, cg_height_m) = if placed.on_trailer {
            (sprung.cg_behind_hitch_m - placed.position_m, sprung.cg_height_m)
        } else {
            (placed.position_m, tractor.cg_height_m)
        };
        let load = AxleLoad {
            total_n: balance.axle_load_n[i],
            sprung_n: balance.axle_load_n[i] - placed.axle.unsprung_mass_kg * vehicle.gravity_mps2,
        };
        add_axle(&mut e, i, placed, cg, (ahead_m, cg_height_m), &load);
    }
    e.lateral_rate.copy_from(&trailer_cg.velocity);
    // d/dt of the lateral velocity in the rotating frame: U r1 for both units, because the
    // trailer's lateral velocity already contains the articulation rate.
    e.lateral_bias[w::YAW_1] = speed_mps;
    Ok(e)
}

/// Adds the inertia of a mass at a point: `m j (jᵀẇ + U r)`.
fn add_mass(e: &mut Equations, mass_kg: f64, point: &Point) {
    let j = &point.velocity;
    e.mass += mass_kg * j * j.transpose();
    let mut column = e.damping.column_mut(w::YAW_1);
    column += mass_kg * e.speed_mps * j;
}

struct AxleLoad {
    total_n: f64,
    sprung_n: f64,
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
    let roll_center = cg.moved(yaw, ahead_m).moved(body, below_cg_m);
    let contact = roll_center.moved(own, axle.roll_center_height_m).velocity;

    add_mass(e, axle.unsprung_mass_kg, &roll_center.moved(own, above_axle_m));
    e.mass[(own, own)] += axle.roll_inertia_kgm2;
    e.mass[(yaw, yaw)] += axle.roll_inertia_kgm2;

    // Tires: the slip angle is α = (velocity at the road)/U − δ (plus the articulation for the
    // trailer). The force at the road is −C α, the aligning moment +M α.
    let (cornering, aligning) = placed.tyre.stiffness_at(load.total_n / placed.tyres());
    let mut force = -placed.tyres() * cornering * &contact;
    force[yaw] += placed.tyres() * aligning;
    e.damping -= &force * contact.transpose() / e.speed_mps;
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
    let spring = placed.suspension_roll_stiffness_nm_per_rad();
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

/// The linear model at one speed and load, with its DC ratios and static loads.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LinearModel {
    /// State-space form.
    pub state_space: StateSpace,
    /// DC ratios over the height, in the order of `cg_core::Channel::ALL`.
    pub ratio: [RatioLine<f64>; 2],
    /// Static loads.
    pub balance: StaticBalance,
}

impl LinearModel {
    /// Builds the model of a vehicle.
    ///
    /// # Errors
    /// As [`Equations::new`].
    pub fn new(
        vehicle: &Vehicle,
        variant: Variant,
        speed_mps: f64,
        load: Load,
    ) -> Result<Self, VehicleError> {
        let model = || {
            Ok(Self {
                state_space: Equations::new(vehicle, variant, speed_mps, load)?.state_space()?,
                ratio: ratio_line(vehicle, variant, speed_mps, load)?,
                balance: static_balance(vehicle, load)?,
            })
        };
        model().map_err(|error: VehicleError| error.of_vehicle(vehicle))
    }
}
