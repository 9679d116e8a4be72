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

use cg_core::{CHANNELS, Channel, Input, Output, RatioLine};

use crate::as_printed;
use crate::balance::{StaticBalance, static_balance};
use crate::equations::{Equations, Variant, q, w};
use crate::error::VehicleError;
use crate::load::{Load, SprungMass};
use crate::response::StateSpace;
use crate::twisting::{DAMPING_S, Part, Twisting};
use crate::vehicle::{Hitch, PlacedAxle, Tractor, Vehicle};

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
        let given = vehicle.trailer.frame_torsional_stiffness_nm_per_rad.is_some();
        if variant == Variant::AsPrinted && given && Twisting::of(vehicle).is_some() {
            return Err(VehicleError::Model(
                "the printed model has a rigid frame: remove trailer.frame_torsional_stiffness_nm_per_rad"
                    .to_owned(),
            ));
        }
        let mut equations = match variant {
            Variant::Complete => complete(vehicle, speed_mps, load),
            Variant::AsPrinted => as_printed::equations(vehicle, speed_mps, load),
        }?;
        equations.place_sensors(vehicle);
        Ok(equations)
    }

    /// Sets what the accelerometers and the sensors of suspension roll measure.
    fn place_sensors(&mut self, vehicle: &Vehicle) {
        let (tractor, hitch, sensors) = (&vehicle.tractor, &vehicle.hitch, &vehicle.sensors);
        let (ahead_m, behind_m) = vehicle.accelerometer_positions_m();
        self.gravity_mps2 = vehicle.gravity_mps2;
        let place = &sensors.tractor_accelerometer;
        let mut velocity = DVector::zeros(self.mass.nrows());
        velocity[w::LATERAL] = 1.0;
        let tractor_cg = Point { velocity, on_trailer: false };
        self.units[0].accelerometer = tractor_cg
            .moved(w::YAW_1, ahead_m)
            .moved(w::ROLL_1, tractor.cg_height_m - place.height_m)
            .velocity;
        let place = &sensors.accelerometer;
        let at_hitch = at_hitch(&tractor_cg, tractor, hitch).moved(w::YAW_2, -behind_m);
        let (front, _) = self.on_hitch();
        let share = self.twisting.as_ref().map_or(0.0, |twisting| twisting.accelerometer_share);
        let below_m = hitch.height_m - place.height_m;
        self.units[1].accelerometer = at_hitch
            .moved(w::ROLL_2, (1.0 - share) * below_m)
            .moved(front, share * below_m)
            .velocity;
        for (unit, sensors) in self.units.iter_mut().enumerate() {
            let axles = vehicle.axles_of_unit(unit == 1);
            sensors.axles = axles.into_iter().map(|(number, _)| number).collect();
        }
    }
}

/// The error of a vehicle that tips at once.
pub(crate) const NO_STEADY_TURN: &str = "the model has no steady turn";

/// Column of the yaw rate in [`Equations::steady`], and of the first angle.
const STEADY_YAW_RATE: usize = 1;
const STEADY_ANGLES: usize = 2;

/// All signals in a steady turn as straight lines over the height, from which the DC ratio of any
/// pair of them follows.
///
/// By Cramer's rule each unknown of the steady state is a determinant divided by the same
/// determinant `D`. The height occurs in one row only, so all of them are linear in it. With a frame
/// that twists it occurs in two rows; the lines are then those whose quotient is exact at three heights.
#[derive(Clone, Debug)]
pub struct SteadyLines {
    /// The determinants at the height of the load, above it and, if the frame twists, below: the unknowns
    /// times `D`.
    unknowns: Vec<DVector<f64>>,
    determinant: Vec<f64>,
    equations: Equations,
    cg_height_m: f64,
}

/// For a rigid frame any heights are possible, because the determinants are exactly linear. With half a
/// meter the rounding error is small, and the heights of a frame that twists span the usual ones.
const STEP_M: f64 = 0.5;

impl SteadyLines {
    /// The steady turns of a vehicle at one speed and load.
    ///
    /// # Errors
    /// As [`Equations::new`]; also if there is no steady turn.
    pub fn new(
        vehicle: &Vehicle,
        variant: Variant,
        speed_mps: f64,
        load: Load,
    ) -> Result<Self, VehicleError> {
        let at = |cg_height_m: f64| {
            let equations =
                Equations::new(vehicle, variant, speed_mps, Load { cg_height_m, ..load })?;
            let (steady, steer) = equations.steady();
            let lu = steady.lu();
            let determinant = lu.determinant();
            let none = || VehicleError::Model(NO_STEADY_TURN.to_owned());
            let unknowns = lu.solve(&steer).ok_or_else(none)? * determinant;
            Ok::<_, VehicleError>((equations, unknowns, determinant))
        };
        let (equations, here, determinant) = at(load.cg_height_m)?;
        let (mut unknowns, mut determinants) = (vec![here], vec![determinant]);
        let others = if equations.twisting.is_some() { &[1.0, -1.0][..] } else { &[1.0] };
        for steps in others {
            let (_, there, determinant) = at(load.cg_height_m + steps * STEP_M)?;
            unknowns.push(there);
            determinants.push(determinant);
        }
        let cg_height_m = load.cg_height_m;
        Ok(Self { unknowns, determinant: determinants, equations, cg_height_m })
    }

    /// The DC ratio of a pair as a function of the height (eq. 5.17), in rad per unit of the input.
    /// It is scaled to `b0 + b1 h = 1` at the height of the load.
    pub fn line(&self, output: Output, input: Input) -> RatioLine<f64> {
        let at = |k| (self.output(output, k), self.input(input, k));
        let ((n0, d0), (n1, d1)) = (at(0), at(1));
        let (a1, b1) = if self.equations.twisting.is_none() {
            ((n1 - n0) / STEP_M / d0, (d1 - d0) / STEP_M / d0)
        } else {
            // (r0 + a x)/(1 + b x) = r1 at x = 1 and r2 at x = −1.
            let (n2, d2) = at(2);
            let (r0, r1, r2) = (n0 / d0, n1 / d1, n2 / d2);
            let b = (r1 + r2 - 2.0 * r0) / (r2 - r1);
            ((r1 * (1.0 + b) - r0) / STEP_M, b / STEP_M)
        };
        RatioLine { a0: n0 / d0 - a1 * self.cg_height_m, a1, b0: 1.0 - b1 * self.cg_height_m, b1 }
    }

    /// The DC ratio of a channel as a function of the height.
    pub fn channel(&self, channel: Channel) -> RatioLine<f64> {
        self.line(channel.output(), channel.input())
    }

    fn output(&self, output: Output, k: usize) -> f64 {
        let angles = self.unknowns[k].rows(STEADY_ANGLES, self.equations.stiffness.ncols());
        let suspension = |unit: usize| {
            angles[q::ROLL_1 + unit] - self.equations.mean_axle_roll(unit).dot(&angles)
        };
        match output {
            Output::Roll => {
                self.equations.trailer_roll(|twisting| twisting.roll_share).dot(&angles)
            }
            Output::TractorSuspensionRoll => suspension(0),
            Output::SuspensionRoll => suspension(1),
        }
    }

    fn input(&self, input: Input, k: usize) -> f64 {
        // In steady state the lateral acceleration is speed times yaw rate.
        let lateral = self.unknowns[k][STEADY_YAW_RATE] * self.equations.speed_mps;
        let angles = self.unknowns[k].rows(STEADY_ANGLES, self.equations.stiffness.ncols());
        let force = |unit: usize| {
            let roll = self.equations.roll_at_force(unit).dot(&angles);
            lateral + self.equations.gravity_mps2 * roll
        };
        match input {
            Input::Steer => self.determinant[k],
            Input::LateralAcceleration => lateral,
            Input::TractorSpecificForce => force(0),
            Input::SpecificForce => force(1),
        }
    }
}

/// The analytic DC ratio of every channel as a function of the height, in the order of
/// [`Channel::ALL`]. See [`SteadyLines`].
///
/// # Errors
/// As [`SteadyLines::new`].
pub fn ratio_line(
    vehicle: &Vehicle,
    variant: Variant,
    speed_mps: f64,
    load: Load,
) -> Result<[RatioLine<f64>; CHANNELS], VehicleError> {
    let steady = SteadyLines::new(vehicle, variant, speed_mps, load)?;
    Ok(Channel::ALL.map(|channel| steady.channel(channel)))
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

/// The fifth wheel, about which the trailer moves.
fn at_hitch(tractor_cg: &Point, tractor: &Tractor, hitch: &Hitch) -> Point {
    let mut point = tractor_cg
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
    let mut cg = at_hitch.moved(w::YAW_2, -sprung.cg_behind_hitch_m);
    for (part, body) in parts.iter().zip(bodies) {
        let own = at_hitch.moved(w::YAW_2, -part.cg_behind_hitch_m).moved(body, below_m);
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

fn complete(vehicle: &Vehicle, speed_mps: f64, load: Load) -> Result<Equations, VehicleError> {
    let vehicle = &*vehicle.with_springs_at(load)?;
    let sprung = vehicle.trailer_sprung_mass(load)?;
    let balance = static_balance(vehicle, load)?;
    let axles = vehicle.axles();
    let usual_rad = usual_roll_rad(vehicle, load.trailer_mass_kg)?;
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
    let trailer_cg = add_trailer(&mut e, &at_hitch, &sprung, vehicle);
    // The axles' body: the trailer, or its rear half.
    let on_axles = at_hitch
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
    e.stiffness[(w::ROLL_1, q::ROLL_1)] += balance.hitch_load_n * tractor_above_m;
    e.stiffness[(w::ROLL_2, q::ROLL_2)] -= balance.hitch_load_n * trailer_above_m;
    for (i, placed) in axles.iter().enumerate() {
        let cg = if placed.on_trailer { &on_axles } else { &tractor_cg };
        let (ahead_m, cg_height_m) = if placed.on_trailer {
            (sprung.cg_behind_hitch_m - placed.position_m, sprung.cg_height_m)
        } else {
            (placed.position_m, tractor.cg_height_m)
        };
        let (total_n, amplitude_rad) =
            (balance.axle_load_n[i], usual_rad[usize::from(placed.on_trailer)]);
        let load = AxleLoad {
            total_n,
            sprung_n: total_n - placed.axle.unsprung_mass_kg * vehicle.gravity_mps2,
            roll_stiffness: vehicle.roll_stiffness(placed, total_n, amplitude_rad, 1.0),
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

/// Lateral acceleration of usual turns, g.
const USUAL_TURN_G: f64 = 0.1;
/// The least amplitude at which a measured spring is linearized: a tenth of a degree.
const LEAST_ROLL_RAD: f64 = 0.0017;

/// Amplitudes of the suspension roll of tractor and trailer in a usual turn at which measured springs
/// are linearized; zero without such springs. They are those of the linear springs of the file and
/// of a load at its reference height, so the ratio lines over the height stay straight.
pub(crate) fn usual_roll_rad(
    vehicle: &Vehicle,
    trailer_mass_kg: f64,
) -> Result<[f64; 2], VehicleError> {
    if !vehicle.has_measured_springs() {
        return Ok([0.0; 2]);
    }
    let mut linear = vehicle.clone();
    linear.spring.clear();
    let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
    let lines = SteadyLines::new(&linear, Variant::Complete, vehicle.nominal_speed_mps, load)?;
    Ok([Output::TractorSuspensionRoll, Output::SuspensionRoll].map(|output| {
        let ratio = lines.line(output, Input::LateralAcceleration).ratio_at(load.cg_height_m);
        (ratio.abs() * USUAL_TURN_G * vehicle.gravity_mps2).max(LEAST_ROLL_RAD)
    }))
}

struct AxleLoad {
    total_n: f64,
    sprung_n: f64,
    /// Between body and axle.
    roll_stiffness: f64,
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

/// The linear model at one speed and load, with its DC ratios and static loads.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LinearModel {
    /// State-space form.
    pub state_space: StateSpace,
    /// DC ratios over the height, in the order of [`Channel::ALL`].
    pub ratio: [RatioLine<f64>; CHANNELS],
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
