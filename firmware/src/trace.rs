//! A hash of every bit of every answer.

use cg_core::{Height, HeightError, Inconsistency, Measured, SampleError, Status, Step, Unexcited};
use cg_core::{Outcome, Reject};

use crate::{CHANNELS, Maneuver};

/// FNV-1a, 64 bits, over 32-bit words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trace(pub u64);

impl Default for Trace {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Trace {
    #[inline(never)] // one copy in the image
    fn word(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    fn long(&mut self, value: u64) {
        #[allow(clippy::cast_possible_truncation)] // halves
        for half in [value as u32, (value >> 32) as u32] {
            self.word(half);
        }
    }

    /// Adds a number.
    pub fn number(&mut self, value: f32) {
        // All NaNs count as equal, because their bits depend on the hardware.
        self.word(if value.is_nan() { f32::NAN.to_bits() } else { value.to_bits() });
    }

    fn measured(&mut self, measured: Measured<f32>) {
        self.number(measured.value);
        self.number(measured.sd);
    }

    /// Adds the answer to a sample.
    pub fn step(&mut self, step: &Result<Step<f32, CHANNELS>, SampleError>) {
        let Ok(step) = step else { return self.word(9) };
        self.word(match step.status {
            Status::Absent => 1,
            Status::Straight => 2,
            Status::Turning => 3,
        });
        if let Some(closed) = &step.closed {
            self.maneuver(closed);
        }
    }

    /// Adds a maneuver.
    pub fn maneuver(&mut self, closed: &Maneuver) {
        self.long(closed.start_us);
        self.long(closed.end_us);
        for value in [closed.speed_mps, closed.trailer_mass_kg] {
            self.number(value);
        }
        for value in closed.correlation.as_flattened() {
            self.number(*value);
        }
        for outcome in &closed.outcomes {
            self.outcome(outcome);
        }
    }

    fn outcome(&mut self, outcome: &Outcome<f32>) {
        if let Some(fit) = &outcome.fit {
            for measured in [fit.ratio, fit.drift_radps, fit.bend] {
                self.measured(measured);
            }
            for value in [fit.noise_sd_rad, fit.snr_db, fit.fit_percent, fit.misfit] {
                self.number(value);
            }
            self.word(fit.rows);
        }
        match outcome.height_m {
            Ok(height) => self.measured(height),
            Err(reject) => self.reject(reject),
        }
        self.number(outcome.systematic_sd_m);
        self.number(outcome.road_sd_m);
    }

    fn reject(&mut self, reject: Reject<f32>) {
        let (kind, values) = match reject {
            Reject::Absent => (1, [0.0; 2]),
            Reject::Unexcited(Unexcited::Input) => (2, [0.0; 2]),
            Reject::Unexcited(_) => (3, [0.0; 2]),
            Reject::Imprecise { ratio_sd_relative } => (4, [ratio_sd_relative, 0.0]),
            Reject::OutsideDesign { speed_mps, trailer_mass_kg } => {
                (5, [speed_mps, trailer_mass_kg])
            }
            Reject::Height(HeightError::OutOfRange { height_m }) => (6, [height_m, 0.0]),
            Reject::Height(_) => (7, [0.0; 2]),
            Reject::Inconsistent(Inconsistency::Misfit { share }) => (8, [share, 0.0]),
            Reject::Inconsistent(Inconsistency::Standstill { roll_rad }) => (9, [roll_rad, 0.0]),
            Reject::Inconsistent(Inconsistency::Bent { share }) => (10, [share, 0.0]),
            _ => (11, [0.0; 2]),
        };
        self.word(kind);
        for value in values {
            self.number(value);
        }
    }

    /// Adds a fused height.
    pub fn height(&mut self, height: Option<Height<f32>>) {
        match height {
            None => self.word(0),
            Some(height) => {
                self.measured(height.height_m);
                self.number(height.random_sd_m);
                self.word(height.maneuvers);
            }
        }
    }
}
