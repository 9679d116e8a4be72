//! What a truck has learned from its trips with the empty trailer, and what it then knows of itself.

use std::fmt;

use cg_core::{CHANNELS, Design, Measured};
use cg_vehicle::belief::{Belief, Covariance};
use cg_vehicle::calibration::{
    Calibration, Fitted, Judgment, Prior, Procedure, Run, RunEntry, fit_from, vehicle_crc32,
};
use cg_vehicle::design::design_with;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};
use serde::{Deserialize, Serialize};

use crate::estimate::date_s;
use crate::malformed::Malformed;
use crate::same_drive::{are_of_one_drive, values};

/// Greatest number of trips that are kept.
const MOST_TRIPS: usize = 12;

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
    /// DC ratios of the empty trailer in the order of [`Channel::ALL`](cg_core::Channel::ALL), with the standard deviation
    /// due to noise, to the bank of the road and to a side wind.
    pub ratio: [Option<Measured<f64>>; CHANNELS],
    /// Number of its maneuvers.
    pub maneuvers: u32,
    /// Where the lift axles were.
    #[serde(default, skip_serializing_if = "LiftAxle::is_down")]
    pub lift_axle: LiftAxle,
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
    /// Date of the calibration on which it rests; none if it rests on the vehicle file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    calibration_date: Option<String>,
    /// The truck to which a text of its own belongs. (A state file says it for all of its content.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    vehicle_crc32: Option<u32>,
    #[serde(skip)]
    before: Option<Before>,
}

/// The calibration on which it rests.
#[derive(Clone, Debug, PartialEq)]
struct Before {
    belief: Belief,
    /// Unix time of the calibration, s.
    date_s: Option<f64>,
    runs: Vec<RunEntry>,
}

impl Before {
    fn new(calibration: &Calibration) -> Self {
        let date_s = date_s(calibration);
        Self { belief: calibration.belief(), date_s, runs: calibration.run.clone() }
    }

    /// Whether a trip is a run of the calibration already. Both were computed from the same drive, one from the rows of its log.
    fn contains(&self, trip: &EmptyTrip) -> bool {
        let is = |run: &RunEntry| {
            let ratios: Vec<f64> = run.channel.iter().map(|entry| entry.ratio).collect();
            are_of_one_drive(&ratios, &values(&trip.ratio))
        };
        self.runs.iter().any(is)
    }
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
                "a trip with the empty trailer contradicts what was known of the truck beyond chance, so heights of loads may be \
                 wrong, too: check the mass and the sensors, or whether tires or springs are new. It counts if the next one \
                 agrees with it and both are possible by the vehicle file and its calibration; if not, calibrate again",
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
    pub(crate) fn is_sound(&self) -> bool {
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
            load: empty(vehicle, self.lift_axle),
            height_sd_m: 0.0,
            trailer_mass_sd_kg: 0.0,
            lift_axle: self.lift_axle,
            speed_mps: self.speed_mps,
            turn_g: None,
            ratio: self.ratio,
            age_s: Some(age_s(now_s, self.date_s)),
        }
    }
}

/// Longest time between two trips, or since a calibration, s: twenty years. What seems longer is a clock that nobody has set, and tells
/// nothing; a truck that changes for so long could have become any other.
const LONGEST_S: f64 = 20.0 * 365.25 * 86_400.0;

/// The time since a date, s; zero if it is not known.
fn age_s(now_s: f64, date_s: f64) -> f64 {
    let age_s = now_s - date_s;
    if (0.0..=LONGEST_S).contains(&age_s) { age_s } else { 0.0 }
}

/// The empty trailer with the lift axles in a position. That of a truck without lift axles is not used: no fit has it.
pub(crate) fn empty(vehicle: &Vehicle, position: LiftAxle) -> Load {
    let present = vehicle.clone().with_lift_axle(position);
    present.map_or_else(|_| vehicle.empty_load(), |present| present.empty_load())
}

impl Learned {
    /// Reads what [`text_of`](Self::text_of) wrote.
    ///
    /// # Errors
    /// [`Malformed`] if the text is something else, or if it contains impossible numbers.
    pub fn parse(text: &str) -> Result<Self, Malformed> {
        let learned: Self = serde_json::from_str(text)
            .map_err(|error| format!("it is not what a truck has learned: {error}"))?;
        if learned.is_sound() { Ok(learned) } else { Err("it contains impossible numbers".into()) }
    }

    /// What a truck has learned, from its [text](Self::text_of).
    ///
    /// # Errors
    /// As [`parse`](Self::parse); also if it is the text of another truck. A text that does not say of which truck it is, that
    /// in a state file, is taken for one of this truck.
    pub fn parse_of(text: &str, vehicle: &Vehicle) -> Result<Self, Malformed> {
        let learned = Self::parse(text)?;
        learned.belongs_to(vehicle)?;
        Ok(learned)
    }

    /// Fails if it says that it is of another truck.
    pub(crate) fn belongs_to(&self, vehicle: &Vehicle) -> Result<(), Malformed> {
        let own = vehicle_crc32(vehicle).map_err(|error| Malformed::from(error.to_string()))?;
        if self.vehicle_crc32.is_none_or(|crc32| crc32 == own) {
            return Ok(());
        }
        Err(format!(
            "this is what another truck than \"{}\" has learned, or its vehicle file has changed since; give what this \
             truck has learned, or nothing",
            vehicle.name
        )
        .into())
    }

    /// It as JSON text, which says of which truck it is.
    ///
    /// # Errors
    /// A number or the vehicle cannot be written. This would be a bug.
    pub fn text_of(&self, vehicle: &Vehicle) -> Result<String, VehicleError> {
        let own = Self { vehicle_crc32: Some(vehicle_crc32(vehicle)?), ..self.clone() };
        serde_json::to_string(&own).map_err(|error| VehicleError::Model(error.to_string()))
    }

    /// The same on top of a calibration, or of the vehicle file without one. Trips that the calibration
    /// contains do not count again.
    #[must_use]
    pub fn on(self, calibration: Option<&Calibration>) -> Self {
        Self {
            calibration_date: calibration.map(|calibration| calibration.date.clone()),
            before: calibration.map(Before::new),
            ..self
        }
    }

    /// The same with a trip that has not ended; without one, that of before a restart stays until it is learned.
    pub(crate) fn with_open(&self, open: Option<EmptyTrip>) -> Self {
        Self { open: open.or_else(|| self.open.clone()), ..self.clone() }
    }

    /// Date of the calibration on which it rests; `None` if it rests on the vehicle file.
    pub fn calibration_date(&self) -> Option<&str> {
        self.calibration_date.as_deref()
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.trips.is_empty() && self.waiting.is_none() && self.open.is_none()
    }

    /// What is to be said at the beginning of a trip if the last empty one contradicts what is known of the truck.
    pub fn contradiction(&self) -> Option<&'static str> {
        self.waiting.as_ref().map(|_| {
            "the last trip with the empty trailer contradicts what is known of the truck, so heights of loads may be wrong beyond \
             their intervals: check the mass and the sensors; if tires, springs or sensors are new, calibrate again"
        })
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

    /// What is known of the truck at the time `now_s`, s; `None` without trips beyond those of the
    /// calibration on which it rests. The uncertainty due to
    /// its changes since the last trip is contained.
    ///
    /// # Errors
    /// As [`fit_from`].
    pub fn belief(
        &self,
        vehicle: &Vehicle,
        variant: Variant,
        now_s: f64,
    ) -> Result<Option<Belief>, VehicleError> {
        let Some(fitted) = self.fitted((vehicle, variant), &self.trips, now_s)? else {
            return Ok(None);
        };
        let birge = fitted.judgment().birge();
        let covariance =
            Covariance::from_fn(|i, j| birge * birge * fitted.belief.covariance[(i, j)]);
        let residual_sd = birge * fitted.belief.residual_sd;
        Ok(Some(Belief { covariance, residual_sd, ..fitted.belief }))
    }

    /// The design of the truck that [`belief`](Self::belief) describes; `None` without trips.
    ///
    /// # Errors
    /// As [`fit_from`] and [`design_with`].
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
    /// As [`fit_from`].
    pub fn take(
        &mut self,
        vehicle: &Vehicle,
        variant: Variant,
        trip: EmptyTrip,
    ) -> Result<Taken, VehicleError> {
        let now_s = trip.date_s;
        let fitted = |trips: &[EmptyTrip]| self.fitted((vehicle, variant), trips, now_s);
        let mut with_it = self.trips.clone();
        with_it.push(trip.clone());
        if follows(&fitted, &self.trips, &with_it)? {
            self.waiting = None;
            self.keep(with_it);
            return Ok(Taken::Learned(self.trips.len()));
        }
        let Some(first) = self.waiting.clone() else {
            self.waiting = Some(trip);
            return Ok(Taken::Waiting);
        };
        let both = [first, trip.clone()];
        // Without the second condition a wrong signal of the mass would be learned.
        let agree = follows(&fitted, &both[..1], &both)?
            && !fitted(&both)?.is_some_and(|both| is_impossible(&both));
        self.waiting = Some(trip);
        if self.trips.is_empty() || !agree {
            return Ok(Taken::Waiting);
        }
        self.waiting = None;
        let forgotten = std::mem::replace(&mut self.trips, both.to_vec());
        Ok(Taken::Forgotten(forgotten.len()))
    }

    /// The truck of these trips; `None` if there is none beyond those of the calibration.
    fn fitted(
        &self,
        (vehicle, variant): (&Vehicle, Variant),
        trips: &[EmptyTrip],
        now_s: f64,
    ) -> Result<Option<Fitted>, VehicleError> {
        let counted = trips.iter().filter(|trip| {
            let again = |before: &Before| before.contains(trip);
            !self.before.as_ref().is_some_and(again)
        });
        let runs: Vec<Run> = counted.map(|trip| trip.run(vehicle, now_s)).collect();
        if runs.is_empty() {
            return Ok(None);
        }
        let date_s = self.before.as_ref().and_then(|before| before.date_s);
        let belief = match &self.before {
            None => Belief::prior(vehicle),
            Some(before) => before.belief.clone(),
        };
        // Time stamps from another origin than that of the calibration tell no age.
        let prior = Prior { belief, age_s: date_s.map_or(0.0, |date_s| age_s(now_s, date_s)) };
        fit_from((vehicle, variant), Procedure::MaximumAPosteriori, &prior, &runs).map(Some)
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

fn is_impossible(fitted: &Fitted) -> bool {
    matches!(fitted.judgment(), Judgment::Contradictory { .. })
}

/// Whether trips are possible for the truck of those of them that came before.
fn follows(
    fitted: &impl Fn(&[EmptyTrip]) -> Result<Option<Fitted>, VehicleError>,
    before: &[EmptyTrip],
    all: &[EmptyTrip],
) -> Result<bool, VehicleError> {
    let [after, before] = match (fitted(all), fitted(before)) {
        (Err(VehicleError::Unsettled), _) | (_, Err(VehicleError::Unsettled)) => return Ok(false),
        (after, before) => [after?, before?],
    };
    Ok(match (after, before) {
        (None, _) => true,
        (Some(after), None) => !is_impossible(&after),
        (Some(after), Some(before)) => {
            !matches!(after.judgment_after(&before), Judgment::Contradictory { .. })
        }
    })
}
