//! A truck with its lift axles down and raised, and which of both it is in a log.
//!
//! With the lift axles in another position, the truck is another one with the same load: it has another design, other scales
//! and another lean. The estimator therefore begins again.

use cg_core::{AlignSettings, Design};
use cg_vehicle::belief::Belief;
use cg_vehicle::design::design_with;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::{Variant, Vehicle, VehicleError};
use serde::{Deserialize, Serialize};

use super::options::EstimateOptions;

const UNKNOWN: &str = "the trailer has a lift axle, and nothing says whether it is raised, so it counts as down; if it was raised, the \
                       height is 12 to 41 % too great, which the interval does not contain: record lift_axle_raised (0 or 1), or \
                       give ⟨lift_axle⟩";
const KEPT: &str = "the lift axle was raised before the restart, and nothing has said since where it is; if it is down now, the height is a \
                    tenth to a third too low, which the interval does not contain: give a signal of lift_axle, or ⟨lift_axle⟩";
const GIVEN: &str = "the lift axle was given as raised, but the log says that it is down: one of them is wrong, and if that is the given \
                     one, the height is a tenth to a third too low";
const NONE: &str = "the log says that a lift axle is raised, but it was given as down or the vehicle file has none, and the height is then \
                    12 to 41 % too great: give lift_m to the [[trailer.axle]] that is one";

/// What an estimator uses of a truck with its lift axles in one position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truck {
    /// Its design.
    pub design: Design<f64>,
    /// How the values of its sensors become those of a sample.
    pub settings: AlignSettings<f64>,
    /// The options, with what follows from its file.
    pub options: EstimateOptions,
}

impl Truck {
    /// A vehicle with its lift axles in one position, its design, and the options of an estimate.
    pub fn new(vehicle: &Vehicle, design: &Design<f64>, options: EstimateOptions) -> Self {
        let (settings, options) = (vehicle.align_settings(), options.with_file(vehicle));
        Self { design: *design, settings, options }
    }

    /// A truck whose parameters have this distribution, with its lift axles where the options say; if they do not say it, down,
    /// and the same truck with them raised if it has any.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle gives no usable design, or if a lift axle is to be raised that it has not.
    pub fn positions(
        vehicle: &Vehicle,
        belief: &Belief,
        options: EstimateOptions,
    ) -> Result<(Self, Option<Self>), VehicleError> {
        let truck = |vehicle: &Vehicle| -> Result<Self, VehicleError> {
            Ok(Self::new(vehicle, &design_with(vehicle, options.variant, belief)?, options))
        };
        // The printed equations are those of one load on all axles.
        let is_open = options.lift_axle.is_none() && options.variant == Variant::Complete;
        let raised = if is_open { vehicle.raised()? } else { None };
        let present = vehicle.clone().with_lift_axle(options.lift_axle.unwrap_or_default())?;
        Ok((truck(&present)?, raised.as_ref().map(truck).transpose()?))
    }
}

/// The lift axles of a truck.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lift {
    /// The truck with them in the other position; none without lift axles, or with a given position.
    other: Option<Box<Truck>>,
    position: LiftAxle,
    /// The last position that a signal said.
    heard: Option<LiftAxle>,
    /// When they moved after maneuvers, s, and the number of these.
    moved: Option<(f64, usize)>,
}

impl Lift {
    /// The lift axles of a truck in a given position, or down if it is not given. `raised` is the truck with them
    /// raised, if they may be.
    pub fn new(given: Option<LiftAxle>, raised: Option<Truck>) -> Self {
        let other = raised.filter(|_| given.is_none()).map(Box::new);
        Self { other, position: given.unwrap_or_default(), heard: None, moved: None }
    }

    /// Where they are.
    pub fn position(&self) -> LiftAxle {
        self.position
    }

    /// When they moved after maneuvers, s, and the number of these.
    pub fn moved(&self) -> Option<(f64, usize)> {
        self.moved
    }

    /// Takes the value of the signal. If they have moved, the truck with them there is returned; [`leave`](Self::leave) that of
    /// before in its place.
    pub fn follow(&mut self, value: f64) -> Option<Box<Truck>> {
        let position = LiftAxle::of_value(value)?;
        self.heard = Some(position);
        self.resume(position)
    }

    /// The same for a position that was kept over a restart.
    pub fn resume(&mut self, position: LiftAxle) -> Option<Box<Truck>> {
        let there = self.other.take_if(|_| position != self.position)?;
        self.position = position;
        Some(there)
    }

    /// Keeps the truck of before; `moved` is the time, s, and the number of maneuvers so far.
    pub fn leave(&mut self, before: Box<Truck>, moved: (f64, usize)) {
        self.other = Some(before);
        self.moved = Some(moved).filter(|(_, maneuvers)| *maneuvers > 0);
    }

    /// What is not known of their position, contradicts it, or has changed.
    pub fn messages(&self) -> impl Iterator<Item = String> {
        let moved = self.moved.map(|(moved_s, _)| {
            let how = match self.position {
                LiftAxle::Down => "lowered",
                LiftAxle::Raised => "raised",
            };
            format!("the lift axle was {how} at {moved_s:.0} s: the height is that since then")
        });
        self.doubt().map(str::to_owned).into_iter().chain(moved)
    }

    /// What is not known of their position, or contradicts it.
    pub fn doubt(&self) -> Option<&'static str> {
        match (&self.other, self.heard) {
            (Some(_), None) => Some(if self.position.is_down() { UNKNOWN } else { KEPT }),
            (None, Some(LiftAxle::Raised)) if self.position == LiftAxle::Down => Some(NONE),
            (None, Some(LiftAxle::Down)) if self.position == LiftAxle::Raised => Some(GIVEN),
            _ => None,
        }
    }
}
