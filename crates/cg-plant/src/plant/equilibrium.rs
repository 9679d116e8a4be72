//! Straight driving at constant speed: the position in which nothing accelerates.
//!
//! Newton's method on height, pitch and roll of the bodies (and of the front half of a twisting trailer), on rise and roll of the axles, and on
//! lateral velocity, articulation and steer angle, which balance the vehicle on a banked road.
//! Measured springs rest midway between their curves.

use nalgebra::{DMatrix, DVector};

use super::dynamics::{Control, Parameters, Probe};
use super::state::{AxleCoordinate, Coordinate, FRONT_ROLL, FRONT_ROLL_RATE, ROOM, State};
use cg_vehicle::error::VehicleError;

/// A state of rest and the steer angle that maintains it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    pub(super) state: State,
    pub(super) steer_rad: f64,
}

/// Accelerations (m/s², rad/s²) due to rounding: forces of 1e5 N to 1e-16 on 500 kg, with a margin.
const ROUNDING: f64 = 1e-10;
/// Full steps that may lead away from rest, because a spring's curve has a bend between here and there.
const LEAPS: u32 = 5;
const BODIES: [Coordinate; 7] = [
    Coordinate::TractorHeight,
    Coordinate::TractorPitch,
    Coordinate::TractorRoll,
    Coordinate::TrailerPitch,
    Coordinate::TrailerRoll,
    Coordinate::LateralVelocity,
    Coordinate::TrailerYaw,
];
const OWN: [AxleCoordinate; 2] = [AxleCoordinate::Rise, AxleCoordinate::Roll];

impl Rest {
    fn unknowns(&self, parameters: &Parameters) -> DVector<f64> {
        let bodies = BODIES.map(|c| self.state.get(c));
        let own = (0..parameters.axles.len()).flat_map(|i| OWN.map(|c| self.state.axle(i, c)));
        let front = parameters.front.is_some().then_some(self.state.x[FRONT_ROLL]);
        let values = bodies.into_iter().chain([self.steer_rad]).chain(own).chain(front);
        DVector::from_vec(values.collect())
    }

    fn with(&self, parameters: &Parameters, unknowns: &DVector<f64>) -> Self {
        let axles = parameters.axles.len();
        let mut rest = *self;
        for (k, c) in BODIES.into_iter().enumerate() {
            rest.state.set(c, unknowns[k]);
        }
        rest.steer_rad = unknowns[BODIES.len()];
        for i in 0..axles {
            for (k, c) in OWN.into_iter().enumerate() {
                rest.state.set_axle(i, c, unknowns[BODIES.len() + 1 + 2 * i + k]);
            }
        }
        if parameters.front.is_some() {
            rest.state.x[FRONT_ROLL] = unknowns[BODIES.len() + 1 + 2 * axles];
        }
        rest
    }

    /// Sets the states without an equation of their own (springs and lagged slip) to rest.
    fn relaxed(mut self, parameters: &Parameters, control: &Control) -> Self {
        let compressions = parameters.compressions(&self.state);
        for (group, x) in parameters.groups.iter().zip(compressions) {
            let (i, law) = (group.first_axle, &group.law);
            self.state.set_axle(i, AxleCoordinate::LeftSpring, law.resting_n(x[0]));
            self.state.set_axle(i, AxleCoordinate::RightSpring, law.resting_n(x[1]));
        }
        if parameters.axles.iter().any(|axle| axle.tyres.relaxation_length_m > 0.0) {
            let mut probe = Probe::default();
            let control = Control { steer_rad: self.steer_rad, ..*control };
            parameters.rates(&self.state.x, &control, &mut [0.0; ROOM], &mut probe);
            for i in 0..parameters.axles.len() {
                self.state.set_axle(i, AxleCoordinate::Slip, probe.contacts[i].slip_rad);
            }
        }
        self
    }
}

/// Accelerations of a relaxed state.
fn accelerations(parameters: &Parameters, rest: &Rest, control: &Control) -> DVector<f64> {
    let mut rate = [0.0; ROOM];
    let control = Control { steer_rad: rest.steer_rad, ..*control };
    parameters.rates(&rest.state.x, &control, &mut rate, &mut Probe::default());
    let first = Coordinate::LateralVelocity as usize;
    let bodies = rate[first..=Coordinate::TrailerRollRate as usize].iter().copied();
    let own = (0..parameters.axles.len()).flat_map(|i| {
        [AxleCoordinate::RiseRate, AxleCoordinate::RollRate].map(|c| rate[super::state::at(i, c)])
    });
    let front = parameters.front.is_some().then_some(rate[FRONT_ROLL_RATE]);
    DVector::from_vec(bodies.chain(own).chain(front).collect())
}

/// Finds straight driving at the speed and on the bank of `control`, starting from a position near it.
///
/// # Errors
/// If there is none: the vehicle tips over, or slides off the banked road.
pub(super) fn settle(
    parameters: &Parameters,
    start: &State,
    control: &Control,
) -> Result<Rest, VehicleError> {
    let mut rest = Rest { state: *start, steer_rad: 0.0 }.relaxed(parameters, control);
    let mut residual = accelerations(parameters, &rest, control);
    let mut leaps = LEAPS;
    for _ in 0..50 {
        if residual.amax() < ROUNDING {
            return Ok(rest);
        }
        let unknowns = rest.unknowns(parameters);
        let n = unknowns.len();
        let mut jacobian = DMatrix::zeros(n, n);
        let moved = |unknowns: &DVector<f64>| {
            let rest = rest.with(parameters, unknowns).relaxed(parameters, control);
            let residual = accelerations(parameters, &rest, control);
            (rest, residual)
        };
        for k in 0..n {
            let mut shifted = unknowns.clone();
            let h = 1e-7;
            shifted[k] += h;
            jacobian.set_column(k, &((moved(&shifted).1 - &residual) / h));
        }
        let Some(step) = jacobian.lu().solve(&residual) else { break };
        let is_better = |(_, left): &(Rest, DVector<f64>)| left.norm() < residual.norm();
        let full = moved(&(&unknowns - &step));
        let halves = std::iter::successors(Some(0.5), |share| Some(0.5 * share)).take(10);
        let mut shorter = halves.map(|share| moved(&(&unknowns - &step * share)));
        let next = if is_better(&full) { Some(full.clone()) } else { shorter.find(is_better) };
        (rest, residual) = match next {
            Some(better) => better,
            None if leaps > 0 => {
                leaps -= 1;
                full
            }
            None => break,
        };
    }
    // Rounding may stop the descent slightly above its estimate.
    if residual.amax() < 1e3 * ROUNDING {
        return Ok(rest);
    }
    Err(VehicleError::Model(format!(
        "no straight running at {:.1} m/s: {:.3} m/s² (or rad/s²) remain; the bank or the \
         payload's lateral offset may be too much for this vehicle",
        control.speed_mps,
        residual.amax()
    )))
}
