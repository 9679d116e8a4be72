//! What the truck learns from empty driving.

use std::io::{self, Write};

use cg_core::Maneuver;
use cg_logs::estimate::Ended;

use super::Session;
use crate::run::events::Event;
use crate::run::learning::{Start, Told};

impl<W: Write> Session<W> {
    /// Begins to learn from empty driving.
    pub(crate) fn begin(&mut self, start: Start) -> io::Result<()> {
        let mut learning = start.learning;
        learning.set_lift_axle(self.lift.position());
        self.learning = Some(learning);
        start.told.into_iter().try_for_each(|told| self.tell(told))
    }

    /// Learns from a maneuver, or ends the trip.
    pub(super) fn learn(&mut self, maneuver: Option<(&Maneuver<f64>, Ended)>) -> io::Result<()> {
        let design = self.estimator.design();
        // Otherwise the empty trailer may be another one.
        let maneuver = maneuver.filter(|_| self.lift.doubt().is_none());
        let told = self.learning.as_mut().and_then(|one| one.push(design, maneuver));
        told.map_or(Ok(()), |told| self.tell(told))
    }

    fn tell(&mut self, told: Told) -> io::Result<()> {
        match told {
            Told::Learned(trips, message) => self.write_event(&Event::Learned { trips, message }),
            Told::Problem(message) => self.notice("learning", &message),
        }
    }
}
