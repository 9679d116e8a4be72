//! Peak values in two maneuvers: a lane change by the driver, and one sine of steer.

use std::f64::consts::TAU;

use super::transfer::Transfer;
use crate::plant::{Driver, DriverSettings, Path, PlantSample, Progress, YawRollPlant};
use cg_vehicle::error::VehicleError;

/// Width of a lane (eq. 2.5).
pub const LANE_WIDTH_M: f64 = 3.65;
/// Start of the gate (eq. 2.5).
pub const GATE_START_M: f64 = 15.0;

/// The greatest values of a maneuver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Peaks {
    /// Lateral acceleration of the tractor's sprung c.g.
    pub tractor_mps2: f64,
    /// The same of the trailer.
    pub trailer_mps2: f64,
    /// Roll rate of the trailer.
    pub trailer_roll_rate_radps: f64,
    /// Load transfer, signed.
    pub transfer: Transfer,
    /// Time of the rollover, if there was one; the other values then end there.
    pub rolled_over_s: Option<f64>,
}

impl Peaks {
    fn see(&mut self, sample: &PlantSample) {
        let greater = |a: f64, b: f64| a.max(b.abs());
        self.tractor_mps2 = greater(self.tractor_mps2, sample.tractor.lateral_acceleration_mps2);
        self.trailer_mps2 = greater(self.trailer_mps2, sample.trailer.lateral_acceleration_mps2);
        let rate = sample.trailer.roll_rate_radps;
        self.trailer_roll_rate_radps = greater(self.trailer_roll_rate_radps, rate);
        self.transfer = self.transfer.worse(Transfer::of(sample));
    }

    /// Rearward amplification: the trailer's greatest lateral acceleration divided by the tractor's.
    pub fn rearward_amplification(&self) -> Option<f64> {
        (self.tractor_mps2 > 0.0).then(|| self.trailer_mps2 / self.tractor_mps2)
    }
}

/// A lane change to the left over a gate length, by the preview driver.
///
/// # Errors
/// If the vehicle cannot drive straight at this speed.
pub fn lane_change(
    plant: &YawRollPlant,
    speed_mps: f64,
    gate_m: f64,
) -> Result<Peaks, VehicleError> {
    let mut run = plant.start(speed_mps)?;
    let path = Path::lane_change(GATE_START_M, gate_m, LANE_WIDTH_M);
    let mut driver = Driver::new(plant, path, speed_mps, DriverSettings::default())?;
    let mut peaks = Peaks::default();
    // Through the gate, and five seconds for the trailer to come to rest.
    let end_s = (GATE_START_M + gate_m) / speed_mps + 5.0;
    while run.time_s() < end_s {
        if let Progress::RolledOver { time_s } = driver.drive(&mut run) {
            peaks.rolled_over_s = Some(time_s);
            break;
        }
        peaks.see(&run.sample());
    }
    Ok(peaks)
}

/// One full sine of steer.
///
/// # Errors
/// If the vehicle cannot drive straight at this speed.
pub fn one_sine(
    plant: &YawRollPlant,
    speed_mps: f64,
    amplitude_rad: f64,
    frequency_hz: f64,
) -> Result<Peaks, VehicleError> {
    let mut run = plant.start(speed_mps)?;
    let mut peaks = Peaks::default();
    let sine_s = 1.0 / frequency_hz;
    while run.time_s() < sine_s + 3.0 {
        let time_s = run.time_s() + plant.step_s();
        let unit = if time_s < sine_s { libm::sin(TAU * frequency_hz * time_s) } else { 0.0 };
        let progress = run.push(amplitude_rad * unit, speed_mps, plant.step_s());
        if let Progress::RolledOver { time_s } = progress {
            peaks.rolled_over_s = Some(time_s);
            break;
        }
        peaks.see(&run.sample());
    }
    Ok(peaks)
}
