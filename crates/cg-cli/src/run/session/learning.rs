//! Learning from empty driving ([`cg_logs::learn`]): what is learned is used from the next start on.

use std::io::{self, Write};

use cg_core::{Design, Maneuver};
use cg_logs::learn::{Learned, Learner, Taken};
use cg_vehicle::{Variant, Vehicle, VehicleError};

use super::Session;
use crate::run::events::Event;

/// The learner of a session with a state file.
pub(crate) struct Learning {
    learner: Learner,
    /// Whether it learns; otherwise it only keeps what was learned before.
    on: bool,
}

/// What the truck starts with.
pub(crate) struct Start {
    /// The design with what was learned.
    pub(crate) design: Design<f64>,
    learning: Option<Learning>,
    trips: usize,
    /// What became of a trip that had not ended.
    resumed: Result<Option<Taken>, VehicleError>,
    message: Option<String>,
}

impl Start {
    /// A calibrated truck does not learn; this is told if nothing was said of `--learn`.
    pub(crate) fn calibrated(design: Design<f64>, told: bool) -> Self {
        let message = told.then(|| {
            "the truck does not learn itself, because --calibration is given; --learn off omits this \
             message"
                .to_owned()
        });
        Self { design, learning: None, trips: 0, resumed: Ok(None), message }
    }

    /// The design with what was learned at the time `now_s`, or the one without if `on` is false.
    pub(crate) fn new(
        (vehicle, variant): (&Vehicle, Variant),
        design: Design<f64>,
        (mut learned, now_s): (Learned, f64),
        on: bool,
    ) -> Self {
        let resumed = if on { learned.resume(vehicle, variant) } else { Ok(None) };
        let known = if on { learned.design(vehicle, variant, now_s) } else { Ok(None) };
        let trips = learned.trips();
        let learning = Some(Learning { learner: Learner::new(vehicle, variant, learned), on });
        let (design, trips, message) = match known {
            Ok(Some(known)) => (known, trips, None),
            Ok(None) => (design, 0, None),
            Err(error) => (design, 0, Some(format!("what was learned cannot be used: {error}"))),
        };
        Self { design, learning, trips, resumed, message }
    }

    /// Hands the learning over to the session and tells what was learned.
    pub(crate) fn tell<W: Write>(self, session: &mut Session<W>) -> io::Result<()> {
        session.learning = self.learning;
        session.tell_learned(self.resumed)?;
        if self.trips > 0 {
            let message =
                "the truck is taken as it has learned itself from trips with the empty trailer";
            session.write_event(Event::Learned { trips: self.trips, message })?;
        }
        self.message.map_or(Ok(()), |message| session.notice("learning", &message))
    }
}

impl<W: Write> Session<W> {
    /// What was learned, for the state file.
    pub(super) fn learned(&self) -> Learned {
        let design = self.estimator.design();
        self.learning.as_ref().map_or_else(Learned::default, |one| one.learner.learned(design))
    }

    /// Learns from a maneuver if the trailer is empty.
    pub(super) fn learn(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        let weighed = self.weighed_us.is_some_and(|since_us| since_us <= maneuver.start_us);
        let end_s = self.time_s(maneuver.end_us);
        let design = *self.estimator.design();
        let taken = match &mut self.learning {
            Some(Learning { learner, on: true }) => {
                learner.maneuver(&design, maneuver, (end_s, weighed))
            }
            _ => Ok(None),
        };
        self.tell_learned(taken)
    }

    /// Ends the trip with the empty trailer, if there is one.
    pub(super) fn end_trip(&mut self) -> io::Result<()> {
        let design = *self.estimator.design();
        let taken = match &mut self.learning {
            Some(Learning { learner, on: true }) => learner.finish(&design),
            _ => Ok(None),
        };
        self.tell_learned(taken)
    }

    /// Writes what became of a trip.
    fn tell_learned(&mut self, taken: Result<Option<Taken>, VehicleError>) -> io::Result<()> {
        match taken {
            Ok(None) => Ok(()),
            Ok(Some(taken)) => {
                let trips = self.learned().trips();
                self.write_event(Event::Learned { trips, message: &taken.to_string() })
            }
            Err(error) => self.notice("learning", &format!("a trip cannot be learned: {error}")),
        }
    }
}
