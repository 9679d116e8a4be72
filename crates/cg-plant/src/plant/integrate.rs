//! Two methods of order four: Adams-Bashforth-Moulton needs two evaluations per step, Runge-Kutta
//! four. Runge-Kutta starts the other method, and replaces it where something moves too fast for it
//! (a joint that is a hard spring).

use std::borrow::Cow;

use super::dynamics::{Control, Probe};
use super::ground::Ground;
use super::method::Method;
use super::sample::PlantSample;
use super::state::{Coordinate, FRONT_ROLL, ROOM, State};
use super::yaw_roll::YawRollPlant;
use cg_vehicle::error::VehicleError;
use serde::{Deserialize, Serialize};

/// Roll angle at which the run stops, because no vehicle recovers from it.
const ROLLED_OVER_RAD: f64 = 0.6;

/// State of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// The vehicle is on its wheels.
    Running,
    /// A sprung mass rolled beyond 0.6 rad (or the motion diverged) at this time.
    RolledOver {
        /// When.
        time_s: f64,
    },
}

/// A simulation run that starts from straight driving. After a rollover it does not move any more.
#[derive(Clone, Debug)]
pub struct Simulation<'a> {
    plant: Cow<'a, YawRollPlant>,
    /// The present state.
    pub state: State,
    control: Control,
    time_s: f64,
    progress: Progress,
    probe: Box<Probe>,
    past: Past,
}

/// What changes while a run drives: a run of the same plant goes on from it, to the last bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    time_s: f64,
    rolled_over_s: Option<f64>,
    control: Control,
    state: Vec<f64>,
    /// Distance of the rates in time, and those that are valid.
    step_s: f64,
    rates: Vec<Vec<f64>>,
}

/// Rates at the present step and the three steps before it, equally spaced.
#[derive(Clone, Debug)]
struct Past {
    step_s: f64,
    /// How many of them are valid.
    known: usize,
    /// The newest first.
    rates: [[f64; ROOM]; 4],
}

impl Past {
    fn new() -> Self {
        Self { step_s: 0.0, known: 0, rates: [[0.0; ROOM]; 4] }
    }
}

impl YawRollPlant {
    /// A run that starts from straight driving at a speed. On a banked road its first steer angle is
    /// the one that keeps the vehicle straight.
    ///
    /// # Errors
    /// If the vehicle cannot drive straight there.
    pub fn start(&self, speed_mps: f64) -> Result<Simulation<'_>, VehicleError> {
        Simulation::new(Cow::Borrowed(self), speed_mps)
    }

    /// The same run, which owns its plant.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn into_run(self, speed_mps: f64) -> Result<Simulation<'static>, VehicleError> {
        Simulation::new(Cow::Owned(self), speed_mps)
    }

    /// The number of steps of equal length that an interval has: at least one, and none is longer than
    /// [`step_s`](Self::step_s). At walking pace a run divides each of them further.
    pub fn steps(&self, interval_s: f64) -> u32 {
        // Rounding of a log's times must not add a step.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let steps = (interval_s / self.step_s() - 1e-9).ceil().max(1.0) as u32;
        steps
    }
}

impl<'a> Simulation<'a> {
    fn new(plant: Cow<'a, YawRollPlant>, speed_mps: f64) -> Result<Self, VehicleError> {
        if !(speed_mps.is_finite() && speed_mps > 0.0) {
            return Err(VehicleError::Model(format!("speed {speed_mps} m/s must be positive")));
        }
        let rest = plant.settled(speed_mps)?;
        let control = Control {
            steer_rad: rest.steer_rad,
            speed_mps,
            acceleration_mps2: 0.0,
            ground: plant.ground,
            wind_mps: plant.wind_mps,
        };
        Ok(Self {
            plant,
            state: rest.state,
            control,
            time_s: 0.0,
            progress: Progress::Running,
            probe: Box::default(),
            past: Past::new(),
        })
    }

    /// Lets another wind blow from now on, with this velocity in the axes of the way at the start: forward, to the left.
    pub fn blow(&mut self, wind_mps: [f64; 2]) {
        self.control.wind_mps = wind_mps;
    }

    /// Advances by an interval, to a steer angle and speed at its end; both are interpolated linearly.
    pub fn push(&mut self, steer_rad: f64, speed_mps: f64, interval_s: f64) -> Progress {
        let ground = self.control.ground;
        self.push_on(steer_rad, speed_mps, &ground, interval_s)
    }

    /// The same on a road that changes linearly to that at the end of the interval. The rates at which
    /// the road itself rolls and pitches are neglected.
    pub fn push_on(
        &mut self,
        steer_rad: f64,
        speed_mps: f64,
        ground: &Ground,
        interval_s: f64,
    ) -> Progress {
        let acceleration_mps2 = (speed_mps - self.control.speed_mps) / interval_s;
        let from = Control { acceleration_mps2, ..self.control };
        let wind_mps = self.control.wind_mps;
        let to = Control { steer_rad, speed_mps, acceleration_mps2, ground: *ground, wind_mps };
        let parts = self.plant.parts(speed_mps.min(self.control.speed_mps));
        let steps = self.plant.steps(interval_s).saturating_mul(parts);
        let h = interval_s / f64::from(steps);
        // Differences due to rounding of a log's times are ignored.
        if (h - self.past.step_s).abs() > 1e-6 * h {
            self.past = Past { step_s: h, ..Past::new() };
        }
        let start_s = self.time_s;
        for k in 0..steps {
            if self.progress != Progress::Running {
                return self.progress;
            }
            let at = |share: f64| between(&from, &to, (f64::from(k) + share) / f64::from(steps));
            let controls = [at(0.0), at(0.5), at(1.0)];
            let plant = &*self.plant;
            self.state = match plant.method {
                Method::Adams => {
                    plant.adams(&self.state, &controls, &mut self.past, &mut self.probe)
                }
                Method::RungeKutta => plant.runge_kutta(&self.state, &controls, h, &mut self.probe),
            };
            self.control = at(1.0);
            self.time_s = start_s + f64::from(k + 1) * h;
            self.judge();
        }
        self.progress
    }

    fn judge(&mut self) {
        let upright =
            [Coordinate::TractorRoll as usize, Coordinate::TrailerRoll as usize, FRONT_ROLL]
                .into_iter()
                .all(|i| self.state.x[i].abs() <= ROLLED_OVER_RAD);
        if !upright {
            self.progress = Progress::RolledOver { time_s: self.time_s };
        }
    }

    /// Steer angle, speed and road at present.
    pub fn control(&self) -> &Control {
        &self.control
    }

    /// The plant.
    pub fn plant(&self) -> &YawRollPlant {
        &self.plant
    }

    /// Step of the integration.
    pub fn step_s(&self) -> f64 {
        self.plant.step_s()
    }

    /// Time since the start.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// The state of the run.
    pub fn progress(&self) -> Progress {
        self.progress
    }

    /// The present values of the vehicle.
    pub fn sample(&self) -> PlantSample {
        self.plant.sample(&self.state, &self.control)
    }

    /// What has changed since the start.
    pub fn moment(&self) -> Moment {
        let count = self.state.len();
        let rates = self.past.rates.iter().take(self.past.known);
        Moment {
            time_s: self.time_s,
            rolled_over_s: match self.progress {
                Progress::Running => None,
                Progress::RolledOver { time_s } => Some(time_s),
            },
            control: self.control,
            state: self.state.x[..count].to_vec(),
            step_s: self.past.step_s,
            rates: rates.map(|rates| rates[..count].to_vec()).collect(),
        }
    }

    /// Goes on from a moment of a run of the same plant.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if the moment is of a plant with other axles. The run remains as it is.
    pub fn go_on_from(&mut self, moment: &Moment) -> Result<(), VehicleError> {
        let count = self.state.len();
        let mut past = Past { step_s: moment.step_s, known: moment.rates.len(), ..Past::new() };
        let fits = |values: &Vec<f64>| values.len() == count;
        if !(fits(&moment.state) && moment.rates.iter().all(fits) && past.known <= past.rates.len())
        {
            return Err(VehicleError::Model(
                "the moment is one of another vehicle: its number of axles is another one"
                    .to_owned(),
            ));
        }
        for (rates, kept) in past.rates.iter_mut().zip(&moment.rates) {
            rates[..count].copy_from_slice(kept);
        }
        self.state.x[..count].copy_from_slice(&moment.state);
        self.past = past;
        self.control = moment.control;
        self.time_s = moment.time_s;
        self.progress = match moment.rolled_over_s {
            None => Progress::Running,
            Some(time_s) => Progress::RolledOver { time_s },
        };
        Ok(())
    }

    /// Returns an error after the vehicle has rolled over.
    ///
    /// # Errors
    /// [`VehicleError::Model`] with the time.
    pub fn upright(&self) -> Result<(), VehicleError> {
        match self.progress {
            Progress::Running => Ok(()),
            Progress::RolledOver { time_s } => Err(VehicleError::Model(format!(
                "the vehicle rolled over at {time_s:.2} s; use less steer, a lower speed or a lower load"
            ))),
        }
    }
}

fn between(from: &Control, to: &Control, share: f64) -> Control {
    let line = |a: f64, b: f64| a + share * (b - a);
    Control {
        steer_rad: line(from.steer_rad, to.steer_rad),
        speed_mps: line(from.speed_mps, to.speed_mps),
        acceleration_mps2: to.acceleration_mps2,
        ground: from.ground.towards(&to.ground, share),
        wind_mps: to.wind_mps,
    }
}

impl YawRollPlant {
    /// One step: predicted from the past rates, corrected with the rates at the predicted state.
    fn adams(
        &self,
        state: &State,
        controls: &[Control; 3],
        past: &mut Past,
        probe: &mut Probe,
    ) -> State {
        let p = &self.parameters;
        let (n, h) = (state.len(), past.step_s);
        if past.known == 0 {
            p.rates(&state.x, &controls[0], &mut past.rates[0], probe);
            past.known = 1;
        }
        let mut next = *state;
        if past.known < past.rates.len() {
            next = self.runge_kutta(state, controls, h, probe);
            past.known += 1;
        } else {
            let [now, one, two, three] = &past.rates;
            for i in 0..n {
                let ahead = 55.0 * now[i] - 59.0 * one[i] + 37.0 * two[i] - 9.0 * three[i];
                next.x[i] += h / 24.0 * ahead;
            }
            let mut found = [0.0; ROOM];
            p.rates(&next.x, &controls[2], &mut found, probe);
            for i in 0..n {
                let mended = 9.0 * found[i] + 19.0 * now[i] - 5.0 * one[i] + two[i];
                next.x[i] = state.x[i] + h / 24.0 * mended;
            }
        }
        past.rates.rotate_right(1);
        p.rates(&next.x, &controls[2], &mut past.rates[0], probe);
        next
    }

    /// One Runge-Kutta step of length `h`, with the inputs at its start, middle and end.
    pub(super) fn runge_kutta(
        &self,
        state: &State,
        controls: &[Control; 3],
        h: f64,
        probe: &mut Probe,
    ) -> State {
        let n = state.len();
        let p = &self.parameters;
        let mut k = [0.0; ROOM];
        let mut at = *state;
        let mut next = *state;
        p.rates(&state.x, &controls[0], &mut k, probe);
        for (weight, reach, control) in
            [(1.0 / 6.0, 0.5, 1), (1.0 / 3.0, 0.5, 1), (1.0 / 3.0, 1.0, 2)]
        {
            for i in 0..n {
                next.x[i] += weight * h * k[i];
                at.x[i] = state.x[i] + reach * h * k[i];
            }
            p.rates(&at.x, &controls[control], &mut k, probe);
        }
        for i in 0..n {
            next.x[i] += h / 6.0 * k[i];
        }
        next
    }
}
