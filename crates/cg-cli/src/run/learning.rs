//! Learning from empty driving ([`cg_logs::learn`]): what is learned is used from the next start on.

use cg_core::{Design, Maneuver};
use cg_logs::estimate::{Ended, EstimateOptions, Truck};
use cg_logs::learn::{Learned, Learner, Taken};
use cg_vehicle::belief::Belief;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::{Variant, Vehicle, VehicleError};

/// The learner of a session with a state file.
pub(crate) struct Learning {
    learner: Learner,
    /// Whether it learns; otherwise it only keeps what was learned before.
    on: bool,
}

/// What is to be told.
#[derive(Debug, PartialEq)]
pub(crate) enum Told {
    /// What was learned, and the number of trips that count.
    Learned(usize, String),
    /// A reason why something is not learned.
    Problem(String),
}

impl Learning {
    /// What was learned, for the state file.
    pub(crate) fn learned(&self, design: &Design<f64>) -> Learned {
        self.learner.learned(design)
    }

    /// The lift axles have moved, and the trip has ended.
    pub(crate) fn set_lift_axle(&mut self, position: LiftAxle) {
        self.learner.set_lift_axle(position);
    }

    /// Learns from a maneuver if the trailer is empty. Without a maneuver, the trip ends.
    pub(crate) fn push(
        &mut self,
        design: &Design<f64>,
        maneuver: Option<(&Maneuver<f64>, Ended)>,
    ) -> Option<Told> {
        if !self.on {
            return None;
        }
        let taken = match maneuver {
            Some((maneuver, ended)) => self.learner.maneuver(design, maneuver, ended),
            None => self.learner.finish(design),
        };
        told(taken, self.learner.learned(design).trips())
    }
}

fn told(taken: Result<Option<Taken>, VehicleError>, trips: usize) -> Option<Told> {
    match taken {
        Ok(taken) => taken.map(|taken| Told::Learned(trips, taken.to_string())),
        Err(error) => Some(Told::Problem(format!("a trip cannot be learned: {error}"))),
    }
}

/// What is known of the truck, if it gives a design in every position of its lift axles.
fn usable(
    (vehicle, variant): (&Vehicle, Variant),
    belief: Option<Belief>,
) -> Result<Option<Belief>, VehicleError> {
    if let Some(belief) = &belief {
        let options = EstimateOptions { variant, ..EstimateOptions::default() };
        Truck::positions(vehicle, belief, options)?;
    }
    Ok(belief)
}

/// What the truck starts with.
pub(crate) struct Start {
    /// What is known of the truck, if it has learned anything.
    pub(crate) belief: Option<Belief>,
    pub(crate) learning: Learning,
    /// Number of trips in the design, and the time of the newest, s.
    pub(crate) trips_in_use: (usize, Option<f64>),
    pub(crate) told: Vec<Told>,
}

impl Start {
    /// What was learned until the time `now_s`; nothing is used of it if `on` is false.
    pub(crate) fn new(
        (vehicle, variant): (&Vehicle, Variant),
        (mut learned, now_s): (Learned, f64),
        on: bool,
    ) -> Self {
        let (mut messages, mut known) = (Vec::new(), None);
        if on {
            let resumed = learned.resume(vehicle, variant);
            let trips = learned.trips();
            messages.extend(told(resumed, trips));
            messages.extend(learned.contradiction().map(|told| Told::Problem(told.to_owned())));
            let found = learned.belief(vehicle, variant, now_s);
            match found.and_then(|found| usable((vehicle, variant), found)) {
                Ok(found) => known = found,
                Err(error) => {
                    let message = format!("what was learned cannot be used: {error}");
                    messages.push(Told::Problem(message));
                }
            }
            if known.is_some() {
                let date = learned.calibration_date();
                let basis = date.map(|date| format!(", on top of its calibration of {date}"));
                let message = format!(
                    "the truck is taken as it has learned itself from its trips with the empty \
                     trailer{}",
                    basis.unwrap_or_default()
                );
                messages.push(Told::Learned(trips, message));
            }
        }
        Self {
            trips_in_use: if known.is_some() {
                (learned.trips(), learned.newest_s())
            } else {
                (0, None)
            },
            belief: known,
            learning: Learning { learner: Learner::new(vehicle, variant, learned), on },
            told: messages,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cg_core::{CHANNELS, Measured};
    use cg_logs::learn::EmptyTrip;
    use cg_vehicle::belief::Parameter;

    fn kraz() -> Vehicle {
        Vehicle::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml"))
            .unwrap()
    }

    /// The heights of the laden trips after it may be wrong. Without learning nothing is known of it.
    #[test]
    fn an_empty_trip_that_contradicts_is_told_at_every_start() {
        let (vehicle, mut learned) = (kraz(), Learned::default());
        let mut ratio = [None; CHANNELS];
        ratio[0] = Some(Measured { value: 1.0, sd: 1e-3 }); // five times that of the file
        let trip = EmptyTrip {
            date_s: 0.0,
            speed_mps: vehicle.nominal_speed_mps,
            trailer_mass_kg: vehicle.empty_trailer_mass_kg(),
            ratio,
            maneuvers: 1,
            lift_axle: LiftAxle::Down,
        };
        assert_eq!(learned.take(&vehicle, Variant::Complete, trip).unwrap(), Taken::Waiting);
        let tells = |learned: &Learned, on: bool| {
            let start = Start::new((&vehicle, Variant::Complete), (learned.clone(), 0.0), on);
            let is_it =
                |told: &Told| matches!(told, Told::Problem(text) if text.contains("the last trip"));
            start.told.iter().any(is_it)
        };
        assert!(tells(&learned, true) && tells(&learned, true));
        assert!(!tells(&learned, false) && !tells(&Learned::default(), true));
    }

    /// A truck whose drive tires have a tenth of their stiffness has no steady turn.
    #[test]
    fn what_gives_no_design_is_told_and_not_used() {
        let vehicle = kraz();
        let mut belief = Belief::prior(&vehicle);
        assert!(usable((&vehicle, Variant::Complete), Some(belief.clone())).unwrap().is_some());
        assert!(usable((&vehicle, Variant::Complete), None).unwrap().is_none());
        belief.mean[Parameter::DriveCorneringStiffness as usize] = 0.1_f64.ln();
        assert!(usable((&vehicle, Variant::Complete), Some(belief)).is_err());
    }
}
