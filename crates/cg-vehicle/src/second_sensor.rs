//! Two roll sensors on a frame that twists, each with a column of its own.
//!
//! The front half leans more than the rear half, and the softer the frame, the more they differ. Its
//! stiffness is uncertain, and it moves both sensors in opposite directions. A sum of both roll angles
//! with the right shares therefore does not depend on it. Since both have the same inputs and the same
//! dynamics, that sum is the roll angle of one channel, and its shares are those of the least variance
//! that the two heights of both sensors have together.

use cg_core::Channel;

use crate::belief::Belief;
use crate::error::VehicleError;
use crate::influence::influences;
use crate::load::Load;
use crate::twisting::Twisting;
use crate::vehicle::Vehicle;

/// Steps between no share and the whole.
const STEPS: u8 = 20;

/// What a share of the second sensor does to the height.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SecondShare {
    /// Share of the second sensor in the roll angle.
    pub share: f64,
    /// Standard deviation of the height, relative, before a calibration: of the empty trailer and of the
    /// reference load, in the channel of the lateral acceleration.
    pub height_sd: [f64; 2],
}

impl SecondShare {
    /// What a share does.
    ///
    /// # Errors
    /// As [`influences`].
    pub fn of(vehicle: &Vehicle, share: f64) -> Result<Self, VehicleError> {
        let mut vehicle = vehicle.clone();
        vehicle.sensors.roll.second_share = Some(share);
        let belief = Belief::prior(&vehicle);
        let empty = vehicle.empty_load();
        let height_sd = |load: Load| {
            let all = influences(&vehicle, &belief, vehicle.nominal_speed_mps, load)?;
            Ok::<_, VehicleError>(all.height_sd[Channel::LateralAcceleration.index()])
        };
        Ok(Self { share, height_sd: [height_sd(empty)?, height_sd(vehicle.reference_load())?] })
    }

    /// The share with which the heights of empty trailer and reference load are the least uncertain, as
    /// the mean of their variances; `None` if the vehicle does not have two roll sensors on a frame that
    /// twists.
    ///
    /// # Errors
    /// As [`influences`].
    pub fn best(vehicle: &Vehicle) -> Result<Option<Self>, VehicleError> {
        if vehicle.sensors.roll.second_behind_hitch_m.is_none() || Twisting::of(vehicle).is_none() {
            return Ok(None);
        }
        let mut best: Option<Self> = None;
        for step in 0..=STEPS {
            let found = Self::of(vehicle, f64::from(step) / f64::from(STEPS))?;
            if best.is_none_or(|best| found.square() < best.square()) {
                best = Some(found);
            }
        }
        Ok(best)
    }

    fn square(&self) -> f64 {
        self.height_sd.iter().map(|sd| sd * sd).sum()
    }
}
