//! The steer angle grows slowly until the vehicle rolls over or slides.
//!
//! **Reference.** Static rollover threshold: Ervin and others, UMTRI-86; the thesis, 1.2.2.

use super::transfer::{GRAVITY_MPS2, Transfer};
use crate::plant::{Progress, YawRollPlant};
use cg_vehicle::error::VehicleError;

/// Interval of the samples.
const INTERVAL_S: f64 = 0.01;
/// Number of samples in half a second.
const MEAN_POINTS: usize = 50;
/// Lateral acceleration that the linear model would have at the end; no truck reaches it.
const END_G: f64 = 2.0;
/// Below this share of their greatest values, lateral acceleration and roll have finally decreased.
const FALLEN: f64 = 0.9;

/// A decrease counts only beyond this lateral acceleration: at first the trailer may swing out.
const FALLING_G: f64 = 0.1;

fn has_fallen(lateral_mps2: f64, greatest_mps2: f64) -> bool {
    greatest_mps2 > FALLING_G * GRAVITY_MPS2 && lateral_mps2 < FALLEN * greatest_mps2
}

/// An instant of a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RampPoint {
    /// Time.
    pub time_s: f64,
    /// Lateral acceleration of the trailer's sprung c.g.
    pub lateral_acceleration_mps2: f64,
    /// Load transfer.
    pub transfer: Transfer,
}

/// How a ramp ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RampEnd {
    /// The vehicle rolled over.
    RolledOver,
    /// It slid out of the turn: its tires cannot carry the force that would roll it over.
    Slid,
}

/// A ramp of steer to its end.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Ramp {
    /// Instants, 10 ms apart, up to the end.
    pub points: Vec<RampPoint>,
    /// How it ended.
    pub end: RampEnd,
    /// Lateral acceleration at which the left wheels of each axle left the road, tractor first.
    pub lift_mps2: Vec<Option<f64>>,
}

impl Ramp {
    /// Drives a ramp to the left at constant speed. `rate_mps3` is the rate of the lateral
    /// acceleration that a linear vehicle with this gain (m/s² per radian) would have.
    ///
    /// # Errors
    /// If the vehicle cannot drive straight, or a number is invalid.
    pub fn drive(
        plant: &YawRollPlant,
        speed_mps: f64,
        gain_mps2_per_rad: f64,
        rate_mps3: f64,
    ) -> Result<Self, VehicleError> {
        let steer_rate_radps = rate_mps3 / gain_mps2_per_rad;
        if !(steer_rate_radps.is_finite() && steer_rate_radps > 0.0) {
            return Err(VehicleError::Model(format!(
                "ramp: {rate_mps3} m/s³ at a gain of {gain_mps2_per_rad} m/s² per radian: the \
                 vehicle must answer to the left when it is steered to the left"
            )));
        }
        let mut run = plant.start(speed_mps)?;
        let mut ramp = Self { points: Vec::new(), end: RampEnd::Slid, lift_mps2: Vec::new() };
        let end_s = END_G * GRAVITY_MPS2 / rate_mps3;
        let (mut greatest_mps2, mut greatest_roll_rad) = (0.0_f64, 0.0_f64);
        let mut ticks = 0.0;
        while run.time_s() < end_s {
            ticks += 1.0;
            let steer_rad = steer_rate_radps * ticks * INTERVAL_S;
            if run.push(steer_rad, speed_mps, INTERVAL_S) != Progress::Running {
                ramp.end = RampEnd::RolledOver;
                break;
            }
            let sample = run.sample();
            let lateral_mps2 = sample.trailer.lateral_acceleration_mps2;
            let transfer = Transfer::of(&sample);
            ramp.lift_mps2.resize(sample.axles().len(), None);
            for (lift, axle) in ramp.lift_mps2.iter_mut().zip(sample.axles()) {
                if lift.is_none() && axle.left_lifted() {
                    *lift = Some(lateral_mps2);
                }
            }
            ramp.points.push(RampPoint {
                time_s: run.time_s(),
                lateral_acceleration_mps2: lateral_mps2,
                transfer,
            });
            greatest_mps2 = greatest_mps2.max(lateral_mps2);
            greatest_roll_rad = greatest_roll_rad.max(sample.trailer.roll_rad);
            // During a rollover the c.g. also accelerates inward, but the roll angle grows.
            if has_fallen(lateral_mps2, greatest_mps2)
                && sample.trailer.roll_rad < FALLEN * greatest_roll_rad
            {
                break;
            }
        }
        Ok(ramp)
    }

    /// Greatest lateral acceleration of the trailer, as a mean over half a second: the rollover
    /// threshold, if it rolled over. Axles that have left the road oscillate at 4 Hz and more, and the
    /// mean keeps less than a sixth of that. Values after the mean has decreased are not counted: they
    /// come from the motion of the c.g. while the trailer tips.
    pub fn greatest_mps2(&self) -> f64 {
        let mut greatest_mps2 = 0.0_f64;
        for points in self.points.windows(MEAN_POINTS) {
            let sum: f64 = points.iter().map(|point| point.lateral_acceleration_mps2).sum();
            #[allow(clippy::cast_precision_loss)] // fifty
            let mean_mps2 = sum / MEAN_POINTS as f64;
            if has_fallen(mean_mps2, greatest_mps2) {
                break;
            }
            greatest_mps2 = greatest_mps2.max(mean_mps2);
        }
        greatest_mps2
    }

    /// Load transfer when the lateral acceleration first is this great.
    pub fn transfer_at(&self, lateral_acceleration_mps2: f64) -> Option<Transfer> {
        let i = self
            .points
            .iter()
            .position(|point| point.lateral_acceleration_mps2 >= lateral_acceleration_mps2)?;
        Some(self.points[i].transfer)
    }

    /// Time at which the load of the inner wheels, without the steered ones, became zero.
    pub fn lifted_s(&self) -> Option<f64> {
        let gone = |point: &&RampPoint| point.transfer.roll_safety_factor >= 1.0 - 1e-9;
        self.points.iter().find(gone).map(|point| point.time_s)
    }
}
