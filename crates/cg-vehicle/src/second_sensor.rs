//! Two roll sensors on a frame that twists, each with a column of its own.
//!
//! The front half leans more than the rear half, and the softer the frame, the more they differ. Its
//! stiffness is uncertain, and it moves both sensors in opposite directions. A sum of both roll angles
//! with the right shares therefore does not depend on it. Since both have the same inputs and the same
//! dynamics, that sum is the roll angle of one channel, and its shares are those of the least variance
//! that the two heights of both sensors have together. What each sensor shows alone is a row of the linear
//! model, too, so that the two can be compared ([`slopes`]).

use cg_core::Channel;

use crate::belief::{Belief, Deviations, Parameter, adjusted};
use crate::equations::{Equations, Variant};
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

/// Standard deviations of the frame's stiffness that are possible.
const STIFFNESS_SDS: f64 = 2.0;
/// How much more the roll angles of the two halves can differ in a lane change than in a steady turn: the soft frame of
/// an empty flatbed leans 1.5 times as far at its front as over the axles, and swings 2.8 times as far (independent
/// truck).
const SWING: f64 = 4.0;

/// Least and greatest roll angle of the second sensor over that of the first, empty and laden, in steady turns and lane
/// changes, for a frame as stiff as the vehicle file says it may be. `None` if the log has no second sensor.
///
/// # Errors
/// As [`Equations::new`].
pub fn slopes(vehicle: &Vehicle) -> Result<Option<[f64; 2]>, VehicleError> {
    let Some([first, second]) = vehicle.roll_halves() else { return Ok(None) };
    let frame = Parameter::FrameTorsionalStiffness as usize;
    let sd = Belief::prior(vehicle).covariance[(frame, frame)].sqrt();
    let mut bounds = [1.0_f64; 2];
    for sds in [-STIFFNESS_SDS, 0.0, STIFFNESS_SDS] {
        let mut deviations = Deviations::zeros();
        deviations[frame] = sds * sd;
        let vehicle = adjusted(vehicle, &deviations);
        for load in [vehicle.empty_load(), vehicle.reference_load()] {
            let speed_mps = vehicle.nominal_speed_mps;
            let model =
                Equations::new(&vehicle, Variant::Complete, speed_mps, load)?.state_space()?;
            let at = |half: usize| model.steady(&model.halves_roll[half], 0.0);
            let slope = at(second)? / at(first)?;
            let swings = if slope > 1.0 {
                1.0 + SWING * (slope - 1.0)
            } else {
                1.0 / (1.0 + SWING * (1.0 / slope - 1.0))
            };
            bounds = [bounds[0].min(swings), bounds[1].max(swings)];
        }
    }
    Ok(Some(bounds))
}
