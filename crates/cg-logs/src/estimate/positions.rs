//! A truck with its lift axles down and raised, and which of both it is in a log.
//!
//! With the lift axles in another position, the truck is another one with the same load: it has another design, other scales
//! and another lean. The estimator therefore begins again.

use cg_core::{AlignSettings, Design};
use cg_vehicle::belief::Belief;
use cg_vehicle::design::design_with;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::{Vehicle, VehicleError};
use serde::{Deserialize, Serialize};

use super::options::EstimateOptions;
use crate::lift_signal::LiftSignal;

const UNKNOWN: &str = "the trailer has a lift axle, and nothing says whether it is raised, so it counts as down; if it was raised, the \
                       height is too great (12 to 41 % with one of two or three axles raised), which the interval does not contain, and \
                       nothing is learned: record lift_axle_raised (0 or 1), or give ⟨lift_axle⟩";
const KEPT: &str = "the lift axle was raised before the restart, and nothing has said since where it is; if it is down now, the height is a \
                    tenth to a third too low, which the interval does not contain, and nothing is learned: give a signal of \
                    lift_axle, or ⟨lift_axle⟩";
const LATE: &str = "turns ended before anything said where the lift axle was, and they count as those after; if it has moved, the height is 10 \
                    to 41 % wrong, which the interval does not contain, and nothing is learned";
const STOPPED: &str = "the signal of the lift axle has stopped, and the axle counts as it was then; if it has moved since, the height is 10 to \
                       41 % wrong, which the interval does not contain, and nothing is learned";
const GIVEN_RAISED: &str = "the lift axle was given as raised, but the log says that it is down, at least at times: one of them is wrong, and if \
                            the given one is, the height is a tenth to a third too low";
const GIVEN_DOWN: &str = "the lift axle was given as down, but the log says that a lift axle is raised, at least at times: one of them is wrong, and \
                          if the given one is, the height is 12 to 41 % too great";
const NONE: &str = "the log says that a lift axle is raised, but the vehicle file has none (or the printed equations are used, which know \
                    none), and the height is then 12 to 41 % too great: give lift_m to the [[trailer.axle]] that is one";

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
        let (present, raised) = vehicle.in_positions(options.lift_axle, options.variant)?;
        let raised =
            raised.as_ref().map(truck).transpose().map_err(|error| {
                VehicleError::Model(format!("with its lift axles raised: {error}"))
            })?;
        Ok((truck(&present)?, raised))
    }
}

/// The lift axles of a truck.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lift {
    /// The truck with them in the other position; none without lift axles, or with a given position.
    other: Option<Box<Truck>>,
    position: LiftAxle,
    is_given: bool,
    signal: LiftSignal,
    /// Whether the signal had stopped before a turn ended, and has not come again.
    has_stopped: bool,
    /// Whether it had said nothing before a turn ended.
    was_late: bool,
    /// When they moved after maneuvers, s, and the number of these.
    moved: Option<(f64, usize)>,
}

impl Lift {
    /// The lift axles of a truck in a given position, or down if it is not given. `raised` is the truck with them
    /// raised, if they may be.
    pub fn new(given: Option<LiftAxle>, raised: Option<Truck>) -> Self {
        let other = raised.filter(|_| given.is_none()).map(Box::new);
        let (position, is_given) = (given.unwrap_or_default(), given.is_some());
        Self { other, position, is_given, ..Self::default() }
    }

    /// Where they are.
    pub fn position(&self) -> LiftAxle {
        self.position
    }

    /// Where they are, of a truck that has any.
    pub fn of_truck(&self) -> Option<LiftAxle> {
        (self.is_given || self.other.is_some()).then_some(self.position)
    }

    /// When they moved after maneuvers, s, and the number of these.
    pub fn moved(&self) -> Option<(f64, usize)> {
        self.moved
    }

    /// Takes the value of the signal, NaN if there is none, at a time, s. If they have moved, the position to which they are to be
    /// [set](Self::set) is returned, after which nothing of the truck before is asked for. `has_heights` is whether a move discards
    /// any.
    #[inline]
    pub fn hear(&mut self, value: f64, now_s: f64, has_heights: bool) -> Option<LiftAxle> {
        let at_once = self.other.is_some() && !has_heights;
        let position = self.signal.push(value, now_s, at_once)?;
        self.has_stopped &= value.is_nan();
        (self.other.is_some() && position != self.position).then_some(position)
    }

    /// Sets the position. If it is another one, the truck with them there is returned; [`leave`](Self::leave) that of before in
    /// its place.
    pub fn set(&mut self, position: LiftAxle) -> Option<Box<Truck>> {
        let there = self.other.take_if(|_| position != self.position)?;
        self.position = position;
        Some(there)
    }

    /// Keeps the truck of before; `moved` is the time, s, and the number of maneuvers so far.
    pub fn leave(&mut self, before: Box<Truck>, moved: (f64, usize)) {
        (self.other, self.has_stopped, self.was_late) = (Some(before), false, false);
        self.moved = Some(moved).filter(|(_, maneuvers)| *maneuvers > 0);
    }

    /// Takes the end of a turn, s.
    pub fn turn(&mut self, end_s: f64) {
        self.has_stopped |= self.signal.has_stopped(end_s);
        self.was_late |= self.signal.position().is_none();
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
        self.contradiction().or_else(|| self.unknown())
    }

    /// That the signal says another position than the given one, or one that the truck cannot have.
    pub fn contradiction(&self) -> Option<&'static str> {
        let is_contradicted = self.other.is_none() && self.signal.has_said(self.position.other());
        is_contradicted.then_some(match self.position {
            LiftAxle::Raised => GIVEN_RAISED,
            LiftAxle::Down if self.is_given => GIVEN_DOWN,
            LiftAxle::Down => NONE,
        })
    }

    /// That nothing says where they are, or nothing any more.
    pub fn unknown(&self) -> Option<&'static str> {
        self.other.as_ref()?;
        match (self.signal.position(), self.position) {
            (None, LiftAxle::Down) => Some(UNKNOWN),
            (None, LiftAxle::Raised) => Some(KEPT),
            (Some(_), _) if self.has_stopped => Some(STOPPED),
            (Some(_), _) => self.was_late.then_some(LATE),
        }
    }
}
