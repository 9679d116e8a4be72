//! The lift axles: with them in another position, the truck is another one with the same load.

use std::io::{self, Write};
use std::mem::swap;

use cg_logs::estimate::{
    Leaning, LeftOut, Rated, RoadPart, SinceStop, StrongTurns, Truck, Unheard, Windward,
};
use cg_vehicle::lift::LiftAxle;

use super::Session;
use crate::run::events::{Event, Result as Known};

const LOWERED: &str =
    "the lift axle was lowered: the heights so far are those with it raised and were discarded";
const RAISED: &str =
    "the lift axle was raised: the heights so far are those with it down and were discarded";

impl<W: Write> Session<W> {
    /// Takes the position of the lift axles: 0 down, 1 raised, NaN if nothing says it. If they have moved, the heights so far are
    /// those of the truck before.
    pub(crate) fn follow_lift_axle(&mut self, value: f64) -> io::Result<()> {
        let has_heights = self.known.height_m.is_some();
        let now_s = Self::stream_s(self.now_us);
        let Some(position) = self.lift.hear(value, now_s, has_heights) else { return Ok(()) };
        if let Some(maneuver) = self.estimator.finish() {
            self.maneuver(&maneuver)?;
        }
        self.learn(None)?;
        let had_height = self.known.height_m.is_some();
        if let Some(there) = self.lift.set(position) {
            self.exchange(there);
        }
        self.begin_again();
        if had_height {
            let message = match position {
                LiftAxle::Down => LOWERED,
                LiftAxle::Raised => RAISED,
            };
            self.write_event(&Event::LoadChanged { message })?;
        } else {
            self.notice("lift_axle", &format!("the lift axle is {position}"))?;
        }
        self.save()
    }

    /// Begins with the lift axles where they were before a restart. Whether they can be there.
    pub(super) fn resume(&mut self, position: LiftAxle) -> bool {
        if let Some(there) = self.lift.set(position) {
            self.exchange(there);
        }
        position == self.lift.position()
    }

    /// Goes on with the truck as it is there, without any height.
    fn exchange(&mut self, mut there: Box<Truck>) {
        let design = std::mem::replace(&mut there.design, *self.estimator.design());
        swap(&mut there.settings, &mut self.settings);
        swap(&mut there.options, &mut self.options);
        self.lift.leave(there, (0.0, 0));
        if let Some(learning) = &mut self.learning {
            learning.set_lift_axle(self.lift.position());
        }
        self.weighing.scales = self.options.scales;
        let mass_kg = self.trailer_mass_kg.or(self.weighed_kg);
        self.estimator = self.estimator.become_other((&design, &self.options), mass_kg);
    }

    /// Forgets what belongs to the truck before, but its mass.
    fn begin_again(&mut self) {
        self.known = Known::new(None, None, (self.known.trailer_mass_kg, self.mass_source));
        self.load_since_s = Some(self.time_s(self.now_us));
        self.sensors.close(true);
        (self.leaning, self.strong) = (Leaning::default(), StrongTurns::default());
        (self.rated, self.left_out) = (Rated::default(), LeftOut::default());
        self.windward = Windward::default();
        (self.unheard, self.stop) = (Unheard::default(), SinceStop::default());
        (self.hidden_kg, self.roads) = (None, RoadPart::default());
        self.kept_beside_m = 0.0;
        self.told.clear();
    }
}
