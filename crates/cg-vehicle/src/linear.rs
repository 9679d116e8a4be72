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

use std::borrow::Cow;

use nalgebra::DVector;

use cg_core::{CHANNELS, Channel, Input, Output, RatioLine};

use crate::as_printed;
use crate::assembly::{Parts, Point, at_hitch, axle_roll_stiffness, complete};
use crate::balance::{StaticBalance, static_balance};
use crate::cornering::{Softer, TURNS_G, mean, softer_in};
use crate::equations::{Equations, Motion, Variant, q, w};
use crate::error::VehicleError;
use crate::load::Load;
use crate::response::StateSpace;
use crate::twisting::Twisting;
use crate::vehicle::{PlacedAxle, Vehicle};

/// A vehicle under a load, with what neither the speed nor the height of the load changes.
#[derive(Clone, Debug)]
pub struct Laden<'a> {
    vehicle: &'a Vehicle,
    pub(crate) load: Load,
    /// For the equations with all terms; the printed ones need none of it.
    supports: Option<Supports<'a>>,
}

#[derive(Clone, Debug)]
struct Supports<'a> {
    /// The vehicle with its springs as they are under the load.
    vehicle: Cow<'a, Vehicle>,
    balance: StaticBalance,
    motion: Motion,
    /// Roll stiffness of each axle's springs in this motion, N m/rad. Measured springs are half of the work of the equations.
    roll_stiffness: Vec<f64>,
}

impl<'a> Supports<'a> {
    fn new(vehicle: Cow<'a, Vehicle>, balance: StaticBalance, motion: Motion) -> Self {
        let roll_stiffness = axle_roll_stiffness(&vehicle, &balance, &motion);
        Self { vehicle, balance, motion, roll_stiffness }
    }

    /// Small motion on the linear springs of the file, also where there are measured ones.
    fn of_linear_springs(vehicle: &'a Vehicle, balance: StaticBalance) -> Self {
        let stiffness = |placed: &PlacedAxle<'_>| placed.suspension_roll_stiffness_nm_per_rad();
        let roll_stiffness = vehicle.axles().iter().map(stiffness).collect();
        Self { vehicle: Cow::Borrowed(vehicle), balance, motion: Motion::SMALL, roll_stiffness }
    }
}

impl<'a> Laden<'a> {
    /// The vehicle under this load, in usual turns. Its height is not used.
    ///
    /// # Errors
    /// [`VehicleError`] if the load is impossible.
    pub fn new(vehicle: &'a Vehicle, variant: Variant, load: Load) -> Result<Self, VehicleError> {
        Self::with_tires(vehicle, variant, load, None)
    }

    /// The same with tires whose factors of the cornering stiffness are known.
    pub(crate) fn with_tires(
        vehicle: &'a Vehicle,
        variant: Variant,
        load: Load,
        cornering: Option<[f64; 3]>,
    ) -> Result<Self, VehicleError> {
        if variant == Variant::AsPrinted {
            return Ok(Self { vehicle, load, supports: None });
        }
        let springs = vehicle.with_springs_at(load)?;
        let balance = static_balance(&springs, load)?;
        let motion = usual_motion(&springs, (load.trailer_mass_kg, &balance), cornering)?;
        Ok(Self { vehicle, load, supports: Some(Supports::new(springs, balance, motion)) })
    }

    /// The same with tires that have the cornering stiffness of the vehicle file: at their static load, without load
    /// transfer, and at the slip for which the file gives it.
    #[must_use]
    pub fn with_tires_of_the_file(self) -> Self {
        let cornering = Motion::SMALL.cornering;
        let motion = self.motion().map(|motion| Motion { cornering, ..motion });
        motion.map_or(self.clone(), |motion| self.moving(motion))
    }

    /// The motion of usual turns; `None` for the printed equations, which have one motion only.
    pub(crate) fn motion(&self) -> Option<Motion> {
        self.supports.as_ref().map(|supports| supports.motion)
    }

    /// The same in another motion.
    pub(crate) fn moving(mut self, motion: Motion) -> Self {
        self.supports =
            self.supports.map(|known| Supports::new(known.vehicle, known.balance, motion));
        self
    }

    /// The same with the tires of turns of one lateral acceleration, g, in place of usual turns. As in those, they are
    /// those of a load at its reference height.
    ///
    /// # Errors
    /// As [`SteadyLines::new`].
    pub fn in_turn(self, lateral_g: f64) -> Result<Self, VehicleError> {
        let mut usual = self.clone();
        usual.load.cg_height_m = self.vehicle.reference_load().cg_height_m;
        let [softer] = usual.softer_in([lateral_g])?;
        let motion = self.motion().map(|mut motion| {
            for (factor, by) in motion.cornering.iter_mut().zip(softer) {
                *factor *= libm::exp(by);
            }
            motion
        });
        Ok(motion.map_or(self.clone(), |motion| self.moving(motion)))
    }

    /// How much [softer](crate::cornering) the tires are in turns of some lateral accelerations, g, than those of this
    /// model.
    ///
    /// # Errors
    /// As [`SteadyLines::new`].
    pub(crate) fn softer_in<const N: usize>(
        &self,
        turns_g: [f64; N],
    ) -> Result<[Softer; N], VehicleError> {
        let Some(Supports { vehicle, balance, motion, .. }) = &self.supports else {
            return Ok([Softer::default(); N]);
        };
        let rolls = SteadyLines::at_speed(self, USUAL_SPEED_MPS)?.axle_rolls();
        let of_file = softer_in(vehicle, (&balance.axle_load_n, &rolls), turns_g);
        Ok(of_file.map(|softer| {
            std::array::from_fn(|group| softer[group] - libm::log(motion.cornering[group]))
        }))
    }

    /// The equations of motion at a speed and a height of the load.
    ///
    /// # Errors
    /// As [`Equations::new`].
    fn equations(&self, speed_mps: f64, cg_height_m: f64) -> Result<Equations, VehicleError> {
        let mut equations = self.without_sensors(speed_mps, cg_height_m)?;
        equations.place_sensors(self.vehicle);
        Ok(equations)
    }

    /// The same without the places of sensors.
    fn without_sensors(&self, speed_mps: f64, cg_height_m: f64) -> Result<Equations, VehicleError> {
        if !(speed_mps.is_finite() && speed_mps > 0.0) {
            return Err(VehicleError::Model(format!("speed {speed_mps} m/s must be positive")));
        }
        let load = Load { cg_height_m, ..self.load };
        match &self.supports {
            Some(Supports { vehicle, balance, motion, roll_stiffness }) => {
                let sprung = vehicle.trailer_sprung_mass(load)?;
                let parts = Parts { vehicle, sprung, balance, motion: *motion, roll_stiffness };
                Ok(complete(&parts, speed_mps))
            }
            None => printed(self.vehicle, speed_mps, load),
        }
    }
}

fn printed(vehicle: &Vehicle, speed_mps: f64, load: Load) -> Result<Equations, VehicleError> {
    let given = vehicle.trailer.frame_torsional_stiffness_nm_per_rad.is_some();
    if given && Twisting::of(vehicle).is_some() {
        return Err(VehicleError::Model(
            "the printed model has a rigid frame: remove trailer.frame_torsional_stiffness_nm_per_rad"
                .to_owned(),
        ));
    }
    as_printed::equations(vehicle, speed_mps, load)
}

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
        Self::of(&Laden::new(vehicle, variant, load)?, speed_mps)
    }

    /// The equations of motion of a vehicle under a load.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of(laden: &Laden<'_>, speed_mps: f64) -> Result<Self, VehicleError> {
        laden.equations(speed_mps, laden.load.cg_height_m)
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
            .clone()
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
        Self::at_speed(&Laden::new(vehicle, variant, load)?, speed_mps)
    }

    /// The steady turns at one speed.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn at_speed(laden: &Laden<'_>, speed_mps: f64) -> Result<Self, VehicleError> {
        let load = laden.load;
        let solved = |equations: &Equations| {
            let (steady, steer) = equations.steady();
            let lu = steady.lu();
            let determinant = lu.determinant();
            let none = || VehicleError::Model(NO_STEADY_TURN.to_owned());
            let unknowns = lu.solve(&steer).ok_or_else(none)? * determinant;
            Ok::<_, VehicleError>((unknowns, determinant))
        };
        let equations = laden.equations(speed_mps, load.cg_height_m)?;
        let (here, determinant) = solved(&equations)?;
        let (mut unknowns, mut determinants) = (vec![here], vec![determinant]);
        let others = if equations.twisting.is_some() { &[1.0, -1.0][..] } else { &[1.0] };
        for steps in others {
            let height_m = load.cg_height_m + steps * STEP_M;
            let (there, determinant) = solved(&laden.without_sensors(speed_mps, height_m)?)?;
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

    /// Roll angle of each axle per lateral acceleration at the height of the load, rad/(m/s²).
    fn axle_rolls(&self) -> Vec<f64> {
        let lateral = self.input(Input::LateralAcceleration, 0);
        let angles = self.unknowns[0].rows(STEADY_ANGLES, self.equations.stiffness.ncols());
        angles.iter().skip(q::AXLE).map(|angle| angle / lateral).collect()
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
        let of_unit = [lateral, self.equations.articulated.circle * lateral];
        let force = |unit: usize| {
            let roll = self.equations.roll_at_force(unit).dot(&angles);
            of_unit[unit] + self.equations.gravity_mps2 * roll
        };
        match input {
            Input::Steer => self.determinant[k],
            Input::LateralAcceleration => of_unit[1],
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
    ratio_line_at(&Laden::new(vehicle, variant, load)?, speed_mps)
}

/// The same for a vehicle under a load, at one of several speeds.
///
/// # Errors
/// As [`SteadyLines::new`].
pub fn ratio_line_at(
    laden: &Laden<'_>,
    speed_mps: f64,
) -> Result<[RatioLine<f64>; CHANNELS], VehicleError> {
    let steady = SteadyLines::at_speed(laden, speed_mps)?;
    Ok(Channel::ALL.map(|channel| steady.channel(channel)))
}

/// Specific force of usual turns, g: about that of a lateral acceleration of 0.1 g. The roll angle in a turn of a
/// given lateral acceleration would be very great near a load that tips the truck.
const USUAL_TURN_G: f64 = 0.12;
/// Speed of usual turns (50 km/h), on which the roll angles per lateral acceleration hardly depend.
const USUAL_SPEED_MPS: f64 = 13.889;
/// The least amplitude at which a measured spring is linearized: a tenth of a degree.
const LEAST_ROLL_RAD: f64 = 0.0017;

/// The motion of a usual turn with a trailer of this mass, which gives these static loads: the amplitudes at which measured
/// springs are linearized, and how much softer tires are in it, unless that is known. It is that of the linear springs of the
/// file and of a load at its reference height, so the ratio lines over the height stay straight.
pub(crate) fn usual_motion(
    vehicle: &Vehicle,
    (trailer_mass_kg, balance): (f64, &StaticBalance),
    cornering: Option<[f64; 3]>,
) -> Result<Motion, VehicleError> {
    let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
    let supports = Some(Supports::of_linear_springs(vehicle, balance.clone()));
    let laden = Laden { vehicle, load, supports };
    let mut motion = Motion::SMALL;
    motion.cornering = match cornering {
        Some(known) => known,
        None => mean(&laden.softer_in(TURNS_G)?).map(libm::exp),
    };
    if vehicle.has_measured_springs() {
        let lines = SteadyLines::at_speed(&laden, USUAL_SPEED_MPS)?;
        motion.amplitude_rad = [Channel::Tractor, Channel::Suspension].map(|pair| {
            let ratio = lines.channel(pair).ratio_at(load.cg_height_m);
            (ratio.abs() * USUAL_TURN_G * vehicle.gravity_mps2).max(LEAST_ROLL_RAD)
        });
    }
    Ok(motion)
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
        let model = || Self::of(&Laden::new(vehicle, variant, load)?, speed_mps);
        model().map_err(|error| error.of_vehicle(vehicle))
    }

    /// Builds the model of a vehicle under a load.
    ///
    /// # Errors
    /// As [`Equations::new`].
    pub fn of(laden: &Laden<'_>, speed_mps: f64) -> Result<Self, VehicleError> {
        Ok(Self {
            state_space: Equations::of(laden, speed_mps)?.state_space()?,
            ratio: ratio_line_at(laden, speed_mps)?,
            balance: static_balance(laden.vehicle, laden.load)?,
        })
    }
}
