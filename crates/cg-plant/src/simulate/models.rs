//! Runs the linear and the reduced model through a scenario.

use std::collections::{BTreeMap, BTreeSet};

use cg_core::truck::friction::FrictionState;
use cg_core::truck::simulation::Simulation as ReducedSimulation;
use cg_core::{Channel, Friction};

use super::scenario::{Motion, Scenario};
use crate::maneuver::Histories;
use cg_vehicle::equations::Equations;
use cg_vehicle::error::VehicleError;
use cg_vehicle::friction::roll_friction;
use cg_vehicle::lean::Standing;
use cg_vehicle::reduction::reduce;
use cg_vehicle::response::StateSpace;
use cg_vehicle::{Variant, Vehicle};
use nalgebra::DVector;

/// For a changing speed there is one model for each 0.1 m/s, which is at most 1 % of the gain at 20 m/s.
const SPEED_STEP_MPS: f64 = 0.1;

/// The models of a scenario, ready to start.
pub(super) struct Models {
    at: BTreeMap<i64, (StateSpace, cg_vehicle::system::Simulation)>,
    reduced: Option<Reduced>,
    interval_s: f64,
    friction: Friction<f64>,
    has_tractor_yaw: bool,
    /// The roll angles straight ahead.
    standing: Standing,
}

/// The roll angle of springs with friction, from that of a linear model.
struct Held {
    friction: Friction<f64>,
    state: FrictionState<f64>,
    roll_rad: f64,
}

impl Held {
    /// The roll angle that the estimator takes for that of the linear model. What friction and bends change
    /// is a third of the motion at most, so ten rounds leave 1e-5 of a change.
    fn push(&mut self, linear_rad: f64) -> f64 {
        let before = self.state;
        for _ in 0..10 {
            self.state = before;
            let held_rad = self.state.push(&self.friction, self.roll_rad, 0.0);
            self.roll_rad +=
                linear_rad - self.state.free_rad(&self.friction, self.roll_rad, held_rad);
        }
        self.roll_rad
    }
}

/// The reduced model of roll; the other quantities are steady-state values.
struct Reduced {
    simulation: ReducedSimulation<f64>,
    /// Roll angles of the trailer's halves over that of its sensors.
    halves: [f64; 2],
    lateral_gain: f64,
    yaw_gain: f64,
}

/// Roll angles of the trailer's halves in a steady turn over that of its sensors.
fn halves(model: &StateSpace) -> Result<[f64; 2], VehicleError> {
    let roll = model.steady(&model.trailer_roll, 0.0)?;
    let [front, rear] = model.halves_roll.each_ref().map(|half| model.steady(half, 0.0));
    Ok([front? / roll, rear? / roll])
}

/// Which model.
#[allow(clippy::cast_possible_truncation)] // a speed below 60 m/s
fn step_of(speed_mps: f64) -> i64 {
    (speed_mps / SPEED_STEP_MPS).round() as i64
}

impl Models {
    /// Every model that the speeds of a scenario need.
    pub(super) fn new(
        vehicle: &Vehicle,
        scenario: &Scenario,
        histories: &Histories,
        samples: u64,
    ) -> Result<Self, VehicleError> {
        let interval_s = 1.0 / scenario.rate_hz;
        let model = |speed_mps| {
            Equations::new(vehicle, scenario.variant, speed_mps, scenario.load)?.state_space()
        };
        let mut at = BTreeMap::new();
        let mut insert = |speed_mps: f64| -> Result<(), VehicleError> {
            let model = model(speed_mps)?;
            let simulation = model.simulation(interval_s);
            at.insert(step_of(speed_mps), (model, simulation));
            Ok(())
        };
        if histories.changes_speed() {
            #[allow(clippy::cast_precision_loss)]
            let steps: BTreeSet<i64> =
                (0..samples).map(|k| step_of(histories.speed_mps(k as f64 * interval_s))).collect();
            #[allow(clippy::cast_precision_loss)]
            steps.iter().try_for_each(|step| insert(*step as f64 * SPEED_STEP_MPS))?;
        } else {
            insert(scenario.speed_mps)?;
        }
        let reduced = match scenario.plant {
            super::scenario::Plant::Reduced => {
                let model = model(scenario.speed_mps)?;
                Some(Reduced {
                    simulation: ReducedSimulation::new(
                        &reduce(&model, &[])?.of_channels[Channel::Steer.index()],
                        interval_s,
                        0.0,
                    ),
                    halves: halves(&model)?,
                    lateral_gain: model.lateral_gain()?,
                    yaw_gain: model.steady(&model.trailer_yaw_rate, 0.0)?, // the tractor's is the same
                })
            }
            _ => None,
        };
        let friction = match scenario.variant {
            Variant::Complete => roll_friction(vehicle, scenario.load)?[Channel::Steer.index()],
            Variant::AsPrinted => Friction::NONE,
        };
        let left_m = scenario.payload_left_m;
        let standing = if left_m.abs() > 0.0 {
            Standing::of(vehicle, scenario.load, left_m)?
        } else {
            Standing::default()
        };
        let has_tractor_yaw = vehicle.sensors.yaw_rate_on_tractor().unwrap_or(false);
        Ok(Self { at, reduced, interval_s, friction, has_tractor_yaw, standing })
    }

    /// The yaw rate that the sensor shows, as a row on the state.
    fn yaw_rate<'a>(&self, model: &'a StateSpace) -> &'a DVector<f64> {
        if self.has_tractor_yaw { &model.tractor_yaw_rate } else { &model.trailer_yaw_rate }
    }

    /// Runs from rest, sample by sample.
    pub(super) fn run<E>(
        &self,
        histories: &Histories,
        samples: u64,
        mut write: impl FnMut(f64, Motion) -> Result<(), E>,
    ) -> Result<(), E> {
        let standing = self.standing;
        let mut write = |time_s, mut motion: Motion| {
            motion.roll_rad += standing.roll_rad;
            for (half, stands) in motion.halves_roll_rad.iter_mut().zip(standing.halves_roll_rad) {
                *half += stands;
            }
            write(time_s, motion)
        };
        let mut reduced = self.reduced.as_ref().map(|reduced| reduced.simulation);
        let mut at = step_of(histories.speed_mps(0.0));
        let friction = self.friction;
        let mut held = Held { friction, state: FrictionState::at_rest(0.0), roll_rad: 0.0 };
        let mut linear = self.at.get(&at).map(|(_, simulation)| simulation.clone());
        for k in 0..samples {
            #[allow(clippy::cast_precision_loss)]
            let time_s = k as f64 * self.interval_s;
            let steer_rad = histories.steer_rad(time_s);
            let speed_mps = histories.speed_mps(time_s);
            let still = Motion { steer_rad, speed_mps, ..Motion::default() };
            if let (Some(model), Some(run)) = (&self.reduced, &mut reduced) {
                let roll_rad = if k > 0 { run.push(steer_rad) } else { 0.0 };
                let roll_rad = held.push(roll_rad);
                let motion = Motion {
                    roll_rad,
                    halves_roll_rad: model.halves.map(|half| half * roll_rad),
                    lateral_acceleration_mps2: model.lateral_gain * steer_rad,
                    yaw_rate_radps: model.yaw_gain * steer_rad,
                    ..still
                };
                write(time_s, motion)?;
                continue;
            }
            let now = step_of(speed_mps);
            // The states are physical: they continue in the model of the new speed.
            if now != at
                && let (Some((_, next)), Some(run)) = (self.at.get(&now), &mut linear)
            {
                run.continue_as(next);
                at = now;
            }
            let (Some((model, _)), Some(run)) = (self.at.get(&at), &mut linear) else { break };
            if k > 0 {
                run.push(steer_rad);
            }
            let linear_rad = model.trailer_roll.dot(&run.state);
            let roll_rad = held.push(linear_rad);
            // The friction of the springs holds the body, and with it both halves.
            let held_rad = roll_rad - linear_rad;
            let motion = Motion {
                roll_rad,
                halves_roll_rad: model
                    .halves_roll
                    .each_ref()
                    .map(|half| half.dot(&run.state) + held_rad),
                lateral_acceleration_mps2: model.lateral_acceleration.dot(&run.state)
                    + model.lateral_feedthrough * steer_rad,
                yaw_rate_radps: self.yaw_rate(model).dot(&run.state),
                ..still
            };
            write(time_s, motion)?;
        }
        Ok(())
    }
}
