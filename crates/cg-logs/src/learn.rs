//! The truck learns itself from empty driving.
//!
//! The height of the empty trailer is in its papers, so every trip without a load is a calibration
//! run. A trip counts if a signal of the mass says that the trailer is empty. Its ratios become a
//! [`Run`], and all trips together a posterior of the truck's parameters ([`fit()`]).
//!
//! The truck changes between the trips, as a random walk (`cg_vehicle::calibration`): older trips count
//! for less, and the posterior grows wider when no trip comes. A sudden change (new tires, another
//! sensor) contradicts the earlier trips beyond chance. After the second such trip the earlier ones
//! are forgotten.

use std::fmt;

use cg_core::decide::height::Fusion;
use cg_core::{CHANNELS, Channel, Design, HeightError, Maneuver, Measured, RatioLine, Reject};
use cg_vehicle::belief::{Belief, Covariance};
use cg_vehicle::calibration::{Fitted, Judgment, Procedure, Run, fit};
use cg_vehicle::design::design_with;
use cg_vehicle::sensor_places::Road;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};
use serde::{Deserialize, Serialize};

use crate::calibrate::EMPTY_SHARE;
use crate::estimate::LogEstimator;
use crate::malformed::Malformed;

/// Greatest number of trips that are kept.
const MOST_TRIPS: usize = 12;
/// A trip ends at the latest after this time, s: half a day.
const LONGEST_TRIP_S: f64 = 43_200.0;
/// Least speed of a maneuver, m/s. In slower turns the articulation angle changes the ratios.
const LEAST_SPEED_MPS: f64 = 10.0;

/// The ratios of a trip with the empty trailer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EmptyTrip {
    /// Time of its last maneuver, s, usually Unix time.
    pub date_s: f64,
    /// Mean speed of its maneuvers, m/s.
    pub speed_mps: f64,
    /// Mean of the measured trailer mass, kg.
    pub trailer_mass_kg: f64,
    /// DC ratios of the empty trailer in the order of [`Channel::ALL`], with the standard deviation
    /// due to noise and to the bank of the road.
    pub ratio: [Option<Measured<f64>>; CHANNELS],
    /// Number of its maneuvers.
    pub maneuvers: u32,
}

/// What was learned from empty driving.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learned {
    /// The trips, the oldest one first.
    trips: Vec<EmptyTrip>,
    /// A trip that contradicts the others and waits for a second one that agrees with it.
    waiting: Option<EmptyTrip>,
    /// The trip that has not ended.
    open: Option<EmptyTrip>,
}

/// What became of a trip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Taken {
    /// It was learned; this many trips count now.
    Learned(usize),
    /// It contradicts the earlier trips, or the vehicle file, and waits for a second one.
    Waiting,
    /// It and the one before it contradict the earlier trips; this many of them were forgotten.
    Forgotten(usize),
}

impl fmt::Display for Taken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Learned(trips) => write!(f, "learned a trip with the empty trailer; {trips} count"),
            Self::Waiting => f.write_str(
                "a trip with the empty trailer contradicts what was known of the truck beyond chance; \
                 it counts if the next one agrees with it (check the mass and the sensors, or whether \
                 tires or springs are new)",
            ),
            Self::Forgotten(trips) => write!(
                f,
                "two trips with the empty trailer contradict the {trips} earlier ones, which are \
                 forgotten: the truck has changed"
            ),
        }
    }
}

impl EmptyTrip {
    /// Whether every number is in its possible range.
    fn is_sound(&self) -> bool {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let sound = |ratio: &Measured<f64>| positive(ratio.value) && positive(ratio.sd);
        self.date_s.is_finite()
            && positive(self.speed_mps)
            && positive(self.trailer_mass_kg)
            && self.maneuvers > 0
            && self.ratio.iter().flatten().count() > 0
            && self.ratio.iter().flatten().all(sound)
    }

    /// The run of a calibration.
    fn run(&self, vehicle: &Vehicle, now_s: f64) -> Run {
        Run {
            log: format!("empty trip of {} maneuvers", self.maneuvers),
            load: empty(vehicle),
            height_is_known: true,
            trailer_mass_sd_kg: 0.0,
            speed_mps: self.speed_mps,
            ratio: self.ratio,
            age_s: Some((now_s - self.date_s).max(0.0)),
        }
    }
}

/// The empty trailer.
fn empty(vehicle: &Vehicle) -> Load {
    Load {
        trailer_mass_kg: vehicle.empty_trailer_mass_kg(),
        cg_height_m: vehicle.trailer.tare.cg_height_m,
    }
}

impl Learned {
    /// Reads what [`to_text`](Self::to_text) wrote.
    ///
    /// # Errors
    /// [`Malformed`] if the text is something else, or if it contains impossible numbers.
    pub fn parse(text: &str) -> Result<Self, Malformed> {
        let learned: Self = serde_json::from_str(text)
            .map_err(|error| format!("it is not what a truck has learned: {error}"))?;
        if learned.is_sound() { Ok(learned) } else { Err("it contains impossible numbers".into()) }
    }

    /// It as JSON text.
    ///
    /// # Errors
    /// A number cannot be written. This would be a bug.
    pub fn to_text(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self)
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.trips.is_empty() && self.waiting.is_none() && self.open.is_none()
    }

    /// Number of trips that count.
    pub fn trips(&self) -> usize {
        self.trips.len()
    }

    /// Time of the newest trip that counts, s.
    pub fn newest_s(&self) -> Option<f64> {
        self.trips.last().map(|trip| trip.date_s)
    }

    /// Whether every number is in its possible range.
    pub fn is_sound(&self) -> bool {
        let mut all = self.trips.iter().chain(&self.waiting).chain(&self.open);
        self.trips.len() <= MOST_TRIPS && all.all(EmptyTrip::is_sound)
    }

    /// The trips as runs of a calibration at the time `now_s`.
    pub fn runs(&self, vehicle: &Vehicle, now_s: f64) -> Vec<Run> {
        self.trips.iter().map(|trip| trip.run(vehicle, now_s)).collect()
    }

    /// What is known of the truck at the time `now_s`, s; `None` without trips. The uncertainty due to
    /// its changes since the last trip is contained.
    ///
    /// # Errors
    /// As [`fit()`].
    pub fn belief(
        &self,
        vehicle: &Vehicle,
        variant: Variant,
        now_s: f64,
    ) -> Result<Option<Belief>, VehicleError> {
        if self.trips.is_empty() {
            return Ok(None);
        }
        let fitted = fitted(vehicle, variant, &self.trips, now_s)?;
        let birge = fitted.judgment().birge();
        let covariance =
            Covariance::from_fn(|i, j| birge * birge * fitted.belief.covariance[(i, j)]);
        let residual_sd = birge * fitted.belief.residual_sd;
        Ok(Some(Belief { covariance, residual_sd, ..fitted.belief }))
    }

    /// The design of the truck that [`belief`](Self::belief) describes; `None` without trips.
    ///
    /// # Errors
    /// As [`fit()`] and [`design_with`].
    pub fn design(
        &self,
        vehicle: &Vehicle,
        variant: Variant,
        now_s: f64,
    ) -> Result<Option<Design<f64>>, VehicleError> {
        let belief = self.belief(vehicle, variant, now_s)?;
        belief.map(|belief| design_with(vehicle, variant, &belief)).transpose()
    }

    /// Ends a trip that had not ended when this was saved.
    ///
    /// # Errors
    /// As [`take`](Self::take).
    pub fn resume(
        &mut self,
        vehicle: &Vehicle,
        variant: Variant,
    ) -> Result<Option<Taken>, VehicleError> {
        self.open.take().map(|trip| self.take(vehicle, variant, trip)).transpose()
    }

    /// Adds a trip, if it is possible for the truck of the earlier ones and for the vehicle file.
    ///
    /// # Errors
    /// As [`fit()`].
    pub fn take(
        &mut self,
        vehicle: &Vehicle,
        variant: Variant,
        trip: EmptyTrip,
    ) -> Result<Taken, VehicleError> {
        let now_s = trip.date_s;
        let fitted = |trips: &[EmptyTrip]| fitted(vehicle, variant, trips, now_s);
        let mut with_it = self.trips.clone();
        with_it.push(trip.clone());
        if follows(&fitted, &self.trips, &with_it)? {
            self.waiting = None;
            self.keep(with_it);
            return Ok(Taken::Learned(self.trips.len()));
        }
        let Some(first) = self.waiting.replace(trip.clone()) else { return Ok(Taken::Waiting) };
        let both = [first, trip];
        // Without the second condition a wrong signal of the mass would be learned.
        let agree = follows(&fitted, &both[..1], &both)? && !is_impossible(&fitted(&both)?);
        if self.trips.is_empty() || !agree {
            return Ok(Taken::Waiting);
        }
        self.waiting = None;
        let forgotten = std::mem::replace(&mut self.trips, both.to_vec());
        Ok(Taken::Forgotten(forgotten.len()))
    }

    /// Keeps the first trips, which tell what does not change, and the last ones. Between them those
    /// remain whose distances grow with their age.
    fn keep(&mut self, mut trips: Vec<EmptyTrip>) {
        while trips.len() > MOST_TRIPS {
            let now_s = trips.last().map_or(0.0, |trip| trip.date_s);
            let gap = |k: &usize| {
                let [before_s, at_s, after_s] = [k - 1, *k, k + 1].map(|k| trips[k].date_s);
                (after_s - before_s) / (now_s - at_s)
            };
            let between = 1..trips.len() - 1;
            let dense = between.min_by(|a, b| gap(a).total_cmp(&gap(b)));
            trips.remove(dense.unwrap_or(0));
        }
        self.trips = trips;
    }
}

/// The height that a channel found, with its standard deviation due to noise, and that due to the bank
/// of the road. A height outside the possible range counts too: it is that of the empty trailer, so the
/// truck differs. Its uncertainty by the bank is not known, so the bank must not be in it.
fn identified(
    maneuver: &Maneuver<f64>,
    (channel, line): (Channel, &RatioLine<f64>),
    road: Option<Road>,
) -> Option<(Measured<f64>, f64)> {
    let outcome = &maneuver.outcomes[channel.index()];
    let height_m = match outcome.height_m {
        Ok(found) => return Some((found, outcome.road_sd_m)),
        Err(Reject::Height(HeightError::OutOfRange { height_m })) => height_m,
        Err(_) => return None,
    };
    let without_bank = |one: Channel| !one.feels_bank();
    let has_fit = |one: Channel| maneuver.outcomes[one.index()].fit.is_some();
    let bank_free = || Channel::ALL.into_iter().any(|one| without_bank(one) && has_fit(one));
    let banked = match road {
        Some(road) => road.bank_sd_rad > 0.0,
        None => maneuver.to_gravity || bank_free(),
    };
    let fit = outcome.fit.filter(|_| without_bank(channel) || !banked)?;
    let sd_m = (fit.ratio.sd / fit.ratio.value / line.relative_slope_at(height_m)).abs();
    (line.ratio_at(height_m) > 0.0).then_some((Measured { value: height_m, sd: sd_m }, 0.0))
}

fn fitted(
    vehicle: &Vehicle,
    variant: Variant,
    trips: &[EmptyTrip],
    now_s: f64,
) -> Result<Fitted, VehicleError> {
    let runs: Vec<Run> = trips.iter().map(|trip| trip.run(vehicle, now_s)).collect();
    fit(vehicle, variant, Procedure::MaximumAPosteriori, &runs)
}

fn is_impossible(fitted: &Fitted) -> bool {
    matches!(fitted.judgment(), Judgment::Contradictory { .. })
}

/// Whether trips are possible for the truck of those of them that came before.
fn follows(
    fitted: &impl Fn(&[EmptyTrip]) -> Result<Fitted, VehicleError>,
    before: &[EmptyTrip],
    all: &[EmptyTrip],
) -> Result<bool, VehicleError> {
    let after = match fitted(all) {
        Err(VehicleError::Unsettled) => return Ok(false),
        after => after?,
    };
    if before.is_empty() {
        return Ok(!is_impossible(&after));
    }
    let before = match fitted(before) {
        Err(VehicleError::Unsettled) => return Ok(false),
        before => before?,
    };
    Ok(!matches!(after.judgment_after(&before), Judgment::Contradictory { .. }))
}

/// The maneuvers of a trip that has not ended.
#[derive(Clone, Debug)]
struct Open {
    first_s: f64,
    last_s: f64,
    speed_mps: f64,
    trailer_mass_kg: f64,
    maneuvers: u32,
    /// Identified ratios divided by those of the design for the empty trailer. The systematic part is
    /// the bank of the road.
    relative: [Fusion<f64>; CHANNELS],
}

/// Recognizes trips with the empty trailer and learns from them.
#[derive(Clone, Debug)]
pub struct Learner {
    vehicle: Vehicle,
    variant: Variant,
    learned: Learned,
    open: Option<Open>,
}

impl Learner {
    /// A learner that goes on from what was learned.
    pub fn new(vehicle: &Vehicle, variant: Variant, learned: Learned) -> Self {
        Self { vehicle: vehicle.clone(), variant, learned, open: None }
    }

    /// What was learned, with the trip that has not ended, for the state file.
    pub fn learned(&self, design: &Design<f64>) -> Learned {
        let open = self.open.as_ref().and_then(|open| self.trip(open, design));
        Learned { open, ..self.learned.clone() }
    }

    /// Takes a maneuver that ended at the time `end_s`, s. `weighed` tells whether its mass is from a
    /// signal. A maneuver with a load, or after a long trip, ends the trip.
    ///
    /// # Errors
    /// As [`Learned::take`].
    pub fn maneuver(
        &mut self,
        design: &Design<f64>,
        maneuver: &Maneuver<f64>,
        (end_s, weighed): (f64, bool),
    ) -> Result<Option<Taken>, VehicleError> {
        let empty_kg = self.vehicle.empty_trailer_mass_kg();
        let is_empty = weighed && (maneuver.trailer_mass_kg / empty_kg - 1.0).abs() <= EMPTY_SHARE;
        let is_long =
            |open: &Open| !((open.first_s..=open.first_s + LONGEST_TRIP_S).contains(&end_s));
        let ended = if !is_empty || self.open.as_ref().is_some_and(is_long) {
            self.finish(design)?
        } else {
            None
        };
        if is_empty {
            self.add(design, maneuver, end_s);
        }
        Ok(ended)
    }

    /// Takes all maneuvers of a log and ends the trip. Returns what became of the trips in it.
    ///
    /// # Errors
    /// As [`Learned::take`].
    pub fn log(&mut self, log: LogEstimator) -> Result<Vec<Taken>, VehicleError> {
        let design = *log.design();
        let mut taken = Vec::new();
        for (maneuver, end_s, weighed) in log.maneuvers() {
            taken.extend(self.maneuver(&design, &maneuver, (end_s, weighed))?);
        }
        taken.extend(self.finish(&design)?);
        Ok(taken)
    }

    /// Ends the trip.
    ///
    /// # Errors
    /// As [`Learned::take`].
    pub fn finish(&mut self, design: &Design<f64>) -> Result<Option<Taken>, VehicleError> {
        let trip = self.open.take().and_then(|open| self.trip(&open, design));
        trip.map(|trip| self.learned.take(&self.vehicle, self.variant, trip)).transpose()
    }

    fn add(&mut self, design: &Design<f64>, maneuver: &Maneuver<f64>, end_s: f64) {
        let &Maneuver { speed_mps, trailer_mass_kg, .. } = maneuver;
        if !(speed_mps >= LEAST_SPEED_MPS) {
            return;
        }
        let height_m = empty(&self.vehicle).cg_height_m;
        let relative: [_; CHANNELS] = Channel::ALL.map(|channel| {
            let line = design.line(channel, speed_mps, trailer_mass_kg)?;
            let (found, road_sd_m) = identified(maneuver, (channel, &line), self.vehicle.road)?;
            let expected = line.ratio_at(height_m);
            let value = line.ratio_at(found.value) / expected;
            let sd = |sd_m: f64| (value * line.relative_slope_at(found.value) * sd_m).abs();
            let ratio = Measured { value, sd: sd(found.sd) };
            Some((ratio, sd(road_sd_m)))
        });
        if relative.iter().all(Option::is_none) {
            return;
        }
        let open = self.open.get_or_insert(Open {
            first_s: end_s,
            last_s: end_s,
            speed_mps: 0.0,
            trailer_mass_kg: 0.0,
            maneuvers: 0,
            relative: [Fusion::new(); CHANNELS],
        });
        open.last_s = end_s;
        open.maneuvers += 1;
        let share = 1.0 / f64::from(open.maneuvers);
        open.speed_mps += share * (speed_mps - open.speed_mps);
        open.trailer_mass_kg += share * (trailer_mass_kg - open.trailer_mass_kg);
        for (fusion, found) in open.relative.iter_mut().zip(relative) {
            if let Some((ratio, road_sd)) = found {
                fusion.push(ratio, road_sd);
            }
        }
    }

    /// The ratios of the maneuvers at their mean speed.
    fn trip(&self, open: &Open, design: &Design<f64>) -> Option<EmptyTrip> {
        let load = empty(&self.vehicle);
        let ratio = Channel::ALL.map(|channel| {
            let relative = open.relative[channel.index()].height()?.height_m;
            let line = design.line(channel, open.speed_mps, load.trailer_mass_kg)?;
            let expected =
                line.ratio_at(load.cg_height_m) * design.channels[channel.index()].compensation;
            Some(Measured { value: expected * relative.value, sd: expected.abs() * relative.sd })
        });
        let trip = EmptyTrip {
            date_s: open.last_s,
            speed_mps: open.speed_mps,
            trailer_mass_kg: open.trailer_mass_kg,
            ratio,
            maneuvers: open.maneuvers,
        };
        trip.is_sound().then_some(trip)
    }
}
