//! The simulator: what it holds, and what can be seen of a state.

use super::body::Attitude;
use super::dynamics::{Control, Parameters, Probe};
use super::equilibrium::{Rest, settle};
use super::ground::Ground;
use super::method::{Fastest, Method};
use super::options::PlantOptions;
use super::sample::PlantSample;
use super::setup;
use super::state::{AxleCoordinate, Coordinate, FRONT_ROLL, ROOM, State};
use super::tyre::LEAST_SPEED_MPS;
use super::vector::Vector;
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Vehicle};

/// The simulator: one vehicle under one load on one road.
#[derive(Clone, Debug)]
pub struct YawRollPlant {
    pub(super) parameters: Parameters,
    pub(super) design: State,
    pub(super) steered: Vec<bool>,
    pub(super) ground: Ground,
    pub(super) wind_mps: [f64; 2],
    pub(super) step_s: f64,
    pub(super) method: Method,
    /// Below this speed, steps are shorter.
    slow_mps: f64,
}

/// Damping ratio that a hard fifth wheel gets. Without any, [`Method::Adams`] would let its motion grow.
const HARD_DAMPING: f64 = 0.2;

impl YawRollPlant {
    /// Prepares a vehicle under a load.
    ///
    /// # Errors
    /// [`VehicleError`] if the load is impossible, if there are too many axles or tires, or if the
    /// fastest mode of the vehicle is too fast for any step.
    pub fn new(
        vehicle: &Vehicle,
        load: Load,
        options: &PlantOptions,
    ) -> Result<Self, VehicleError> {
        let (parameters, design) = setup::parameters(vehicle, load, options)?;
        let steered = vehicle.axles().iter().map(|axle| axle.steered).collect();
        let PlantOptions { bank_rad, grade_rad, wind_mps, step_s, .. } = *options;
        let ground = Ground { bank_rad, grade_rad, ..Ground::default() };
        let method = Method::RungeKutta;
        let slow_mps = 0.0;
        let mut plant =
            Self { parameters, design, steered, ground, wind_mps, step_s, method, slow_mps };
        if options.design_load.is_some() {
            plant.lift_to(load.cg_height_m, vehicle.nominal_speed_mps)?;
        }
        let fastest = plant.slowed(vehicle.nominal_speed_mps, step_s)?;
        (plant.method, plant.step_s) = Method::for_mode(fastest, step_s)?;
        let slowly_radps = plant.fastest(LEAST_SPEED_MPS)?.radps;
        plant.slow_mps = plant.method.slow_mps(plant.step_s, slowly_radps, LEAST_SPEED_MPS);
        Ok(plant)
    }

    /// Slows the motion of a hard fifth wheel, which is the fastest of a truck, by an apparent inertia and a damping of its angle, if
    /// that takes fewer evaluations. Returns the fastest motion that is left.
    ///
    /// Such an angle is some 1e-5 rad. At a tenth of the frequency that is left, the inertia changes it by 1 %, the damping by
    /// [4 %](HARD_DAMPING), and nothing that is steady feels either.
    fn slowed(&mut self, speed_mps: f64, step_s: f64) -> Result<Fastest, VehicleError> {
        let fastest = self.fastest(speed_mps)?;
        let wanted_radps = Method::followed_radps(step_s);
        let given = self.parameters.hitch.clone();
        // Plates that part move freely by their lash, which an inertia would change.
        if !(fastest.radps > wanted_radps) || given.separation_nm.is_finite() {
            return Ok(fastest);
        }
        let stiffness = given.stiffness_nm_per_rad;
        let softness = |radps: f64| 1.0 / (radps * radps);
        self.parameters.hitch_inertia_kgm2 =
            stiffness * (softness(wanted_radps) - softness(fastest.radps));
        let damping = 2.0 * HARD_DAMPING * stiffness / wanted_radps;
        self.parameters.hitch.damping_nms_per_rad = given.damping_nms_per_rad.max(damping);
        let slower = self.fastest(speed_mps)?;
        if Method::evaluations(slower, step_s) < Method::evaluations(fastest, step_s) {
            return Ok(slower);
        }
        // Something else is as fast.
        self.parameters.hitch_inertia_kgm2 = 0.0;
        self.parameters.hitch = given;
        Ok(fastest)
    }

    /// Moves the trailer's c.g. in its body so that it rests at this height.
    fn lift_to(&mut self, height_m: f64, speed_mps: f64) -> Result<(), VehicleError> {
        for _ in 0..5 {
            let state = self.settled(speed_mps)?.state;
            let lift_m = height_m - self.trailer_cg_height_m(&state);
            let p = &mut self.parameters;
            p.trailer.cg[2] += lift_m;
            p.front.iter_mut().for_each(|front| front.half.cg[2] += lift_m);
        }
        Ok(())
    }

    /// Straight driving at a speed.
    pub(super) fn settled(&self, speed_mps: f64) -> Result<Rest, VehicleError> {
        let Self { ground, wind_mps, .. } = *self;
        let control = Control { speed_mps, ground, wind_mps, ..Control::default() };
        settle(&self.parameters, &self.design, &control)
    }

    /// Height of the trailer's sprung c.g. above the road in a state.
    pub fn trailer_cg_height_m(&self, state: &State) -> f64 {
        let attitude = |pitch, roll| Attitude::new(state.get(pitch), state.get(roll));
        let tractor = attitude(Coordinate::TractorPitch, Coordinate::TractorRoll);
        let trailer = attitude(Coordinate::TrailerPitch, Coordinate::TrailerRoll);
        let mut above_m = trailer.outward(self.parameters.trailer.cg)[2];
        if let Some(front) = &self.parameters.front {
            let own = Attitude::new(state.get(Coordinate::TrailerPitch), state.x[FRONT_ROLL]);
            above_m += front.mass_share * (own.outward(front.half.cg)[2] - above_m);
        }
        state.get(Coordinate::TractorHeight)
            + tractor.outward(self.parameters.hitch_arm)[2]
            + above_m
    }

    /// Position of an axle's center, seen from above, along and to the left of the first heading.
    pub fn axle_position_m(&self, state: &State, axle: usize) -> [f64; 2] {
        let position = [state.get(Coordinate::PositionX), state.get(Coordinate::PositionY)];
        let Some(seen) = self.parameters.axles.get(axle) else { return position };
        let attitude = |pitch, roll| Attitude::new(state.get(pitch), state.get(roll));
        let turned = |from: [f64; 2], by: Vector, yaw: Coordinate| {
            let (sin, cos) = libm::sincos(state.get(yaw));
            [from[0] + cos * by[0] - sin * by[1], from[1] + sin * by[0] + cos * by[1]]
        };
        let tractor = attitude(Coordinate::TractorPitch, Coordinate::TractorRoll);
        // From the roll center down the axle's own vertical.
        let down_m = state.axle(axle, AxleCoordinate::Rise);
        let aside_m = down_m * libm::sin(state.axle(axle, AxleCoordinate::Roll));
        let center = |attitude: &Attitude| {
            let [x, y, z] = attitude.outward(seen.roll_center);
            [x, y + aside_m, z]
        };
        if !seen.on_trailer {
            return turned(position, center(&tractor), Coordinate::TractorYaw);
        }
        let trailer = attitude(Coordinate::TrailerPitch, Coordinate::TrailerRoll);
        let arm = tractor.outward(self.parameters.hitch_arm);
        let hitch = turned(position, arm, Coordinate::TractorYaw);
        turned(hitch, center(&trailer), Coordinate::TrailerYaw)
    }

    /// The outputs at a state under given inputs.
    pub fn sample(&self, state: &State, control: &Control) -> PlantSample {
        let mut probe = Probe::default();
        self.parameters.rates(&state.x, control, &mut [0.0; ROOM], &mut probe);
        PlantSample::new(state, control, (&probe, &self.parameters), &self.steered)
    }

    /// Step of the integration, where the speed is not so low that the tires need a shorter one.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// The number of parts into which a step at a speed is divided: twice as many at half the speed, so that a run whose speed
    /// changes a little keeps its step.
    pub(super) fn parts(&self, speed_mps: f64) -> u32 {
        let (mut parts, mut enough_mps) = (1, self.slow_mps);
        while enough_mps > speed_mps.max(LEAST_SPEED_MPS) {
            (parts, enough_mps) = (2 * parts, 0.5 * enough_mps);
        }
        parts
    }
}
