//! The truck learns itself from empty driving.
//!
//! The height of the empty trailer is in its papers, so every trip without a load is a calibration
//! run. A trip counts if a signal of the mass says that the trailer is empty. Its ratios become a
//! [`Run`](cg_vehicle::calibration::Run), and all trips together a posterior of the truck's parameters ([`fit()`](cg_vehicle::calibration::fit())).
//!
//! The truck changes between the trips, as a random walk (`cg_vehicle::calibration`): older trips count
//! for less, and the posterior grows wider when no trip comes. A sudden change (new tires, another
//! sensor) contradicts the earlier trips beyond chance. After the second such trip the earlier ones
//! are forgotten.
//!
//! What was known before is the vehicle file, or a calibration of the truck ([`Learned::on`]), which the
//! trips then move.

use cg_core::decide::height::Fusion;
use cg_core::{CHANNELS, Channel, Design, HeightError, Maneuver, Measured, RatioLine, Reject};
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::sensor_places::Road;
use cg_vehicle::side_wind::SideWind;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

use crate::estimate::{EMPTY_SHARE, Ended, Gusts, LogEstimator};
use crate::learned::empty;

pub use crate::learned::{EmptyTrip, Learned, Taken};

/// A trip ends at the latest after this time, s: half a day.
const LONGEST_TRIP_S: f64 = 43_200.0;
/// Least speed of a maneuver, m/s. In slower turns the articulation angle changes the ratios.
const LEAST_SPEED_MPS: f64 = 10.0;

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
    gusts: Gusts,
}

/// Recognizes trips with the empty trailer and learns from them.
#[derive(Clone, Debug)]
pub struct Learner {
    vehicle: Vehicle,
    variant: Variant,
    learned: Learned,
    open: Option<Open>,
    lift_axle: LiftAxle,
    /// The empty trailer with the lift axles there.
    empty: Load,
}

impl Learner {
    /// A learner that goes on from what was learned.
    pub fn new(vehicle: &Vehicle, variant: Variant, learned: Learned) -> Self {
        let (vehicle, empty) = (vehicle.clone(), vehicle.empty_load());
        Self { vehicle, variant, learned, open: None, lift_axle: LiftAxle::Down, empty }
    }

    /// Where the lift axles are for the next maneuvers; if they have moved, the trip must have [ended](Self::finish).
    pub fn set_lift_axle(&mut self, position: LiftAxle) {
        if position != self.lift_axle {
            (self.lift_axle, self.empty) = (position, empty(&self.vehicle, position));
        }
    }

    /// What was learned, with the trip that has not ended, for the state file.
    pub fn learned(&self, design: &Design<f64>) -> Learned {
        self.learned.with_open(self.open.as_ref().and_then(|open| self.trip(open, design)))
    }

    /// Takes a maneuver. One with a load, or after a long trip, ends the trip.
    ///
    /// # Errors
    /// As [`Learned::take`].
    pub fn maneuver(
        &mut self,
        design: &Design<f64>,
        maneuver: &Maneuver<f64>,
        ended: Ended,
    ) -> Result<Option<Taken>, VehicleError> {
        let empty_kg = self.empty.trailer_mass_kg;
        let is_empty =
            ended.is_weighed && (maneuver.trailer_mass_kg / empty_kg - 1.0).abs() <= EMPTY_SHARE;
        let is_long =
            |open: &Open| !((open.first_s..=open.first_s + LONGEST_TRIP_S).contains(&ended.time_s));
        let taken = if !is_empty || self.open.as_ref().is_some_and(is_long) {
            self.finish(design)?
        } else {
            None
        };
        if is_empty {
            self.add(design, maneuver, ended);
        }
        Ok(taken)
    }

    /// Takes all maneuvers of a log and ends the trip. Returns what became of the trips in it.
    ///
    /// # Errors
    /// As [`Learned::take`].
    pub fn log(&mut self, log: LogEstimator) -> Result<Vec<Taken>, VehicleError> {
        let design = *log.design();
        let mut taken = Vec::new();
        if log.lift_doubt().is_some() {
            return Ok(taken); // the empty trailer may be another one
        }
        self.set_lift_axle(log.lift_axle());
        for (maneuver, ended) in log.maneuvers() {
            taken.extend(self.maneuver(&design, &maneuver, ended)?);
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

    fn add(&mut self, design: &Design<f64>, maneuver: &Maneuver<f64>, ended: Ended) {
        let &Maneuver { speed_mps, trailer_mass_kg, .. } = maneuver;
        if !(speed_mps >= LEAST_SPEED_MPS) {
            return;
        }
        let height_m = self.empty.cg_height_m;
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
            first_s: ended.time_s,
            last_s: ended.time_s,
            speed_mps: 0.0,
            trailer_mass_kg: 0.0,
            maneuvers: 0,
            relative: [Fusion::new(); CHANNELS],
            gusts: Gusts::default(),
        });
        open.last_s = ended.time_s;
        open.maneuvers += 1;
        open.gusts.push(ended.gust);
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
        let load = self.empty;
        let side = (SideWind::of(&self.vehicle).unwrap_or_default(), design);
        let turn = [open.speed_mps, load.trailer_mass_kg, load.cg_height_m];
        let ratio = Channel::ALL.map(|channel| {
            let relative = open.relative[channel.index()].height()?.height_m;
            let line = design.line(channel, open.speed_mps, load.trailer_mass_kg)?;
            let expected =
                line.ratio_at(load.cg_height_m) * design.channels[channel.index()].compensation;
            let by_wind = open.gusts.in_ratio(side, channel, turn).within();
            let sd = libm::hypot(relative.sd, by_wind * relative.value);
            Some(Measured { value: expected * relative.value, sd: expected.abs() * sd })
        });
        let trip = EmptyTrip {
            date_s: open.last_s,
            speed_mps: open.speed_mps,
            trailer_mass_kg: open.trailer_mass_kg,
            ratio,
            maneuvers: open.maneuvers,
            lift_axle: self.lift_axle,
        };
        trip.is_sound().then_some(trip)
    }
}
