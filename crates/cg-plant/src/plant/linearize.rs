//! The plant's own linear model: small motion about straight driving, by central differences.

use nalgebra::{DMatrix, DVector};

use super::dynamics::{Control, Probe};
use super::method::Fastest;
use super::state::{AxleCoordinate, Coordinate, FRONT_ROLL, FRONT_ROLL_RATE, ROOM, at};
use super::yaw_roll::YawRollPlant;
use cg_vehicle::error::VehicleError;
use cg_vehicle::matrix::eigenvalues;
use cg_vehicle::response::StateSpace;

/// The states that matter for small motion. The tractor's own yaw angle and position do not matter;
/// the trailer's yaw angle represents the negative articulation. The axles follow, and then the front half
/// of a trailer whose frame twists.
const BODIES: [Coordinate; 14] = [
    Coordinate::TractorHeight,
    Coordinate::TractorPitch,
    Coordinate::TractorRoll,
    Coordinate::TrailerYaw,
    Coordinate::TrailerPitch,
    Coordinate::TrailerRoll,
    Coordinate::LateralVelocity,
    Coordinate::VerticalVelocity,
    Coordinate::TractorYawRate,
    Coordinate::TractorPitchRate,
    Coordinate::TractorRollRate,
    Coordinate::TrailerYawRate,
    Coordinate::TrailerPitchRate,
    Coordinate::TrailerRollRate,
];
const OWN: [AxleCoordinate; 4] = [
    AxleCoordinate::Rise,
    AxleCoordinate::Roll,
    AxleCoordinate::RiseRate,
    AxleCoordinate::RollRate,
];

/// Small enough for the error of the differences (proportional to its square), large enough for
/// rounding.
const SHIFT: f64 = 1e-6;

impl YawRollPlant {
    /// Rates at these places of the state (articulation in place of the trailer's yaw), then lateral
    /// acceleration of the trailer and specific forces of tractor and trailer.
    fn rates_and_felt(&self, x: &[f64; ROOM], control: &Control, places: &[usize]) -> DVector<f64> {
        let (mut rate, mut probe) = ([0.0; ROOM], Probe::default());
        self.parameters.rates(x, control, &mut rate, &mut probe);
        rate[Coordinate::TrailerYaw as usize] -= rate[Coordinate::TractorYaw as usize];
        let rates = places.iter().map(|&i| rate[i]);
        let turn_rad = x[Coordinate::TrailerYaw as usize] - x[Coordinate::TractorYaw as usize];
        let gravity = control.ground.gravity(self.parameters.gravity_mps2, turn_rad);
        let [tractor, trailer] = self.parameters.specific_force_mps2(&probe, &gravity);
        let felt = [self.parameters.lateral_mps2(&probe)[1], tractor, trailer];
        DVector::from_iterator(places.len() + felt.len(), rates.chain(felt))
    }

    /// The state-space model of small motion about straight driving at a speed.
    ///
    /// It is meant for linear springs: the force of a measured spring has no derivative at rest, and
    /// its friction holds it there. The angle of a hard fifth wheel moves as slowly as in a run, which changes nothing else.
    ///
    /// # Errors
    /// If the vehicle cannot drive straight.
    pub fn linearized(&self, speed_mps: f64) -> Result<StateSpace, VehicleError> {
        let rest = self.settled(speed_mps)?;
        let places = self.places();
        let n = places.len();
        let trailer_yaw = 3;
        let look = |index: usize, shift: f64, steer_rad: f64| {
            let mut x = rest.state.x;
            if index < ROOM {
                x[index] += shift;
            }
            let control =
                Control { steer_rad, speed_mps, ground: self.ground, ..Control::default() };
            self.rates_and_felt(&x, &control, &places)
        };
        let slope = |index: usize, steer: f64| {
            let ahead = look(index, SHIFT, rest.steer_rad + steer);
            (ahead - look(index, -SHIFT, rest.steer_rad - steer)) / (2.0 * SHIFT)
        };
        let mut all = DMatrix::zeros(n + 3, n);
        for (k, &index) in places.iter().enumerate() {
            all.set_column(k, &slope(index, 0.0));
        }
        let by_steer = slope(ROOM, SHIFT);
        let row = |k: usize, sign: f64| {
            let mut row = DVector::zeros(n);
            row[k] = sign;
            row
        };
        let body = |c: Coordinate| row(BODIES.iter().position(|b| *b == c).unwrap_or(0), 1.0);
        let axles = self.parameters.axles.len();
        let own = self.own().count();
        let axle_roll: Vec<_> = (0..axles).map(|i| row(BODIES.len() + own * i + 1, 1.0)).collect();
        let suspension_roll = |on_trailer: bool| {
            let roll = if on_trailer { Coordinate::TrailerRoll } else { Coordinate::TractorRoll };
            let own: Vec<_> = (0..axles)
                .filter(|&i| self.parameters.axles[i].on_trailer == on_trailer && !self.steered[i])
                .map(|i| &axle_roll[i])
                .collect();
            #[allow(clippy::cast_precision_loss)] // a number of axles
            let share = 1.0 / own.len().max(1) as f64;
            own.iter().fold(body(roll), |rest, axle| rest - *axle * share)
        };
        Ok(StateSpace {
            suspension_roll: [false, true].map(suspension_roll),
            specific_force: [1, 2].map(|k| (all.row(n + k).transpose(), by_steer[n + k])),
            trailer_roll: self.with_front_roll(body(Coordinate::TrailerRoll), None),
            halves_roll: [1.0, 0.0]
                .map(|share| self.with_front_roll(body(Coordinate::TrailerRoll), Some(share))),
            tractor_roll: body(Coordinate::TractorRoll),
            trailer_yaw_rate: body(Coordinate::TrailerYawRate),
            tractor_yaw_rate: body(Coordinate::TractorYawRate),
            articulation: row(trailer_yaw, -1.0),
            tractor_lateral_velocity: body(Coordinate::LateralVelocity),
            axle_roll,
            lateral_acceleration: all.row(n).transpose(),
            lateral_feedthrough: by_steer[n],
            a: all.rows(0, n).into_owned(),
            b: by_steer.rows(0, n).into_owned(),
        })
    }

    /// The roll angle with a share of the front half's, from that of the rear half; by default at the sensors
    /// of the trailer.
    fn with_front_roll(&self, mut rear: DVector<f64>, share: Option<f64>) -> DVector<f64> {
        if let Some(front) = &self.parameters.front {
            let share = share.unwrap_or(front.roll_share);
            // The front half is last: its roll and its rate.
            let own = rear.len() - 2;
            rear *= 1.0 - share;
            rear[own] = share;
        }
        rear
    }

    /// The fastest motion, without the friction of measured springs.
    pub(super) fn fastest(&self, speed_mps: f64) -> Result<Fastest, VehicleError> {
        Ok(Fastest::of(&eigenvalues(&self.linearized(speed_mps)?.a)?))
    }

    /// The states of an axle that matter; the lagged slip only for tires with a lag.
    fn own(&self) -> impl Iterator<Item = AxleCoordinate> + Clone {
        let lags = self.parameters.axles.iter().all(|axle| axle.tyres.relaxation_length_m > 0.0);
        OWN.into_iter().chain(lags.then_some(AxleCoordinate::Slip))
    }

    /// Indices of the states that matter.
    fn places(&self) -> Vec<usize> {
        let p = &self.parameters;
        let bodies = BODIES.into_iter().map(|c| c as usize);
        let axles = (0..p.axles.len()).flat_map(|i| self.own().map(move |c| at(i, c)));
        let front = p.front.iter().flat_map(|_| [FRONT_ROLL, FRONT_ROLL_RATE]);
        bodies.chain(axles).chain(front).collect()
    }
}
