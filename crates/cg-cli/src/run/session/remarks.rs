//! What is said of a height after a maneuver.

use std::io::{self, Write};

use cg_core::{Channel, Combined, Maneuver, Outcome, Quantity, Reject};
use cg_logs::estimate::{ByWind, Doubt, RoadPart, Strength, Verdict};

use super::Session;
use crate::run::channels::{self, mass_sd_m};
use crate::run::events::MassSource;

impl<W: Write> Session<W> {
    /// Reports what the user should know, each once.
    pub(super) fn remark(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        self.report_age()?;
        self.report_lean()?;
        self.report_road(maneuver)?;
        self.report_strength()?;
        self.report_wind(maneuver.speed_mps)?;
        self.report_left_out()?;
        self.report_unlikely()?;
        self.report_lift_axle()?;
        self.report_unconfirmed()?;
        if let Some(message) = self.options.unplaced(&maneuver.outcomes) {
            self.options.roll_sensor_is_unplaced = false; // is told
            self.notice("roll_sensor", message)?;
        }
        if let Some(message) = self.unheard.news(self.estimator.design()) {
            self.notice("turns", &message)?;
        }
        if let Some(message) = self.sensors.news() {
            self.notice("signal", &message)?;
        }
        let spikes: Vec<_> = self.preparation.spikes().into_iter().collect();
        self.notice_of_load("signal", &spikes)
    }

    /// Reports something of a load, once for each.
    fn notice_of_load(&mut self, subject: &'static str, messages: &[String]) -> io::Result<()> {
        if messages.is_empty() || !self.told.insert(subject) {
            return Ok(());
        }
        messages.iter().try_for_each(|message| self.notice(subject, message))
    }

    /// Reports that the calibration is old.
    fn report_age(&mut self) -> io::Result<()> {
        let now_s = self.time_s(self.now_us);
        let found = self.options.basis.and_then(|basis| basis.age_message(now_s));
        self.notice_of_load("calibration", found.as_slice())
    }

    /// Reports that the trailer leans in straight driving.
    fn report_lean(&mut self) -> io::Result<()> {
        let mass_kg = self.known.trailer_mass_kg;
        let found = self.leaning.message(self.options.lean, mass_kg);
        self.notice_of_load("lean", found.as_slice())
    }

    /// Reports that the unknown bank of the road makes much of the uncertainty, or hides the height, or that it counts as
    /// flat because nothing else was said.
    fn report_road(&mut self, maneuver: &Maneuver<f64>) -> io::Result<()> {
        let is_hidden =
            |outcome: &Outcome<f64>| matches!(outcome.height_m, Err(Reject::Road { .. }));
        let share = self.known.road_share;
        let hides = self.known.height_m.is_none() && maneuver.outcomes.iter().any(is_hidden);
        // A wrong signal hides it, too, and has a notice of its own.
        if self.wrong_signal().is_some() {
            return Ok(());
        }
        let message = if self.roads.is_unknown(self.options.road) {
            (share.is_some() || hides).then(|| RoadPart::message(share)).flatten()
        } else {
            let feels_bank = self.estimator.best_channel().is_some_and(Channel::feels_bank);
            let turns = self.known.maneuvers;
            feels_bank.then(|| RoadPart::assumed_flat(self.options.road, turns)).flatten()
        };
        self.notice_of_load("road", message.as_slice())
    }

    /// Reports that a turn came near to rolling over, or that the truck braked in turns.
    fn report_strength(&mut self) -> io::Result<()> {
        let messages = self.strength().messages();
        if self.known.height_m.is_none() {
            return Ok(());
        }
        self.notice_of_load("strong_turn", &messages)
    }

    /// Reports that maneuvers contradict the others.
    fn report_left_out(&mut self) -> io::Result<()> {
        let message = self.doubt().and_then(|doubt| doubt.message());
        self.notice_of_load("left_out", message.as_slice())
    }

    /// Reports that nothing shows whether the lateral acceleration contains gravity.
    fn report_unconfirmed(&mut self) -> io::Result<()> {
        let is_used = self.estimator.height(Channel::LateralAcceleration).is_some();
        let seen = |quantity: Quantity| self.seen[quantity.index()];
        let found = self.options.unconfirmed(seen).filter(|_| is_used).map(str::to_owned);
        self.notice_of_load("lateral_acceleration", found.as_slice())
    }

    /// Reports that nothing says where the lift axles are, or that the vehicle file has none.
    fn report_lift_axle(&mut self) -> io::Result<()> {
        let doubt = self.lift.doubt().filter(|_| self.known.height_m.is_some());
        // Of one load there may be several.
        match doubt.filter(|doubt| self.told.insert(doubt)) {
            Some(doubt) => self.notice("lift_axle", doubt),
            None => Ok(()),
        }
    }

    /// Reports that a height is unusual for a load, and that a trailer that is empty by its mass has another one than it should.
    fn report_unlikely(&mut self) -> io::Result<()> {
        let mass_kg = self.known.trailer_mass_kg;
        let unlike = |height_m| self.options.unlike_load(mass_kg, height_m);
        let found = self.known.height_m.map(unlike).unwrap_or_default();
        self.notice_of_load("height", &found)?;
        let is_weighed = matches!(self.mass_source, MassSource::Signal | MassSource::Given);
        let found = self.known.measured_m.filter(|_| is_weighed);
        let message = found.and_then(|height| self.options.unlike_empty(mass_kg, height));
        self.notice_of_load("empty", message.as_slice())
    }

    /// What the left-out maneuvers of the load say of its height.
    fn doubt(&self) -> Option<Doubt> {
        let (channel, height_m) = (self.estimator.best_channel()?, self.known.height_m?);
        Some(self.left_out.doubt(channel, (height_m, self.known.maneuvers)))
    }

    /// What the turns of the load came to. While the channels contradict each other there is no height, but what they came
    /// to is to be kept.
    pub(super) fn strength(&self) -> Strength {
        let design = self.estimator.design();
        let height_m = self.known.height_m.unwrap_or(design.reference_height_m);
        let of_channel = |channel| self.strong.strength(design, (channel, height_m));
        self.estimator.best_channel().map_or_else(Strength::default, of_channel)
    }

    /// Standard deviation of the height, m, due to that of the trailer mass, to a part of the load that came or went, to strong
    /// turns, to a load beside the middle, to maneuvers that were left out, to the gains of inclinometers, to the noise of a roll
    /// rate and to a side wind, which the estimator does not know.
    pub(super) fn host_sd_m(&self) -> f64 {
        let known = &self.known;
        let Some(height_m) = known.height_m else { return 0.0 };
        let mass_kg = [known.trailer_mass_kg, known.trailer_mass_sd_kg];
        let speed_mps = self.turns_mps();
        let by_mass_m = mass_sd_m(&self.estimator, speed_mps, mass_kg, height_m);
        let by_lean = self.leaning.height_sd(self.options.lean, known.trailer_mass_kg);
        let by_turns = libm::hypot(self.strength().sd, by_lean);
        let by_wind_m = self.by_wind(speed_mps).within();
        [by_turns * height_m, self.beside_sd_m(), by_wind_m, self.part_sd_m()]
            .into_iter()
            .fold(by_mass_m, libm::hypot)
    }

    /// The part of it by maneuvers that were left out, the gains of inclinometers and the noise of a roll rate, at least that before
    /// a restart with the same load: of its turns nothing else is known now.
    pub(super) fn beside_sd_m(&self) -> f64 {
        let Some(height_m) = self.known.height_m else { return self.kept_beside_m };
        let left_out_m = self.doubt().map_or(0.0, |doubt| doubt.sd_m);
        let (design, turn) =
            (self.estimator.design(), [self.turns_mps(), self.known.trailer_mass_kg]);
        let by_sensors_m = self.estimator.best_channel().map_or(0.0, |channel| {
            let height = (channel, height_m);
            let by_tilts_m = self.tilts.height_sd_m(design, height, turn);
            libm::hypot(by_tilts_m, self.rated.height_sd_m(design, height, turn))
        });
        libm::hypot(left_out_m, by_sensors_m).max(self.kept_beside_m)
    }

    /// The speed of the turns, m/s: at the present one, of a truck that stands, the design says nothing.
    fn turns_mps(&self) -> f64 {
        let nominal_mps = self.estimator.design().nominal_speed_mps;
        if self.height_mps.is_finite() { self.height_mps } else { nominal_mps }
    }

    /// The part of a side wind in the height, m, at a speed, m/s.
    fn by_wind(&self, speed_mps: f64) -> ByWind {
        let known = &self.known;
        let best = known.height_m.zip(self.estimator.best_channel());
        let side = (self.options.side_wind, self.estimator.design());
        best.map_or_else(ByWind::default, |(height_m, channel)| {
            let turn = [speed_mps, known.trailer_mass_kg];
            self.windward.in_height(side, (channel, height_m), turn)
        })
    }

    /// Reports that a side wind makes a large part of the interval, or that it does not contain one.
    fn report_wind(&mut self, speed_mps: f64) -> io::Result<()> {
        let by_wind = self.by_wind(speed_mps);
        let found = self.known.height_sd_m.and_then(|sd_m| {
            let rest = sd_m * sd_m - by_wind.within() * by_wind.within();
            by_wind.message(rest.max(0.0).sqrt())
        });
        self.notice_of_load("wind", found.as_slice())
    }

    /// The share of the unknown bank of the road in the variance of the height.
    pub(super) fn road_share(&self) -> Option<f64> {
        let height = self.combined()?.height()?;
        Some(self.roads.share(self.estimator.best_channel()?, &height))
    }

    /// The height of all channels; none can be right if a signal is not what it should be.
    pub(super) fn combined(&self) -> Option<Combined<f64>> {
        let wrong = self.wrong_signal().map(|_| Combined::Impossible);
        wrong.or_else(|| self.estimator.combined())
    }

    /// What is said of channels that contradict each other.
    pub(super) fn contradiction(&self) -> String {
        let seen = |quantity: Quantity| self.seen[quantity.index()];
        // Those of the chassis may have no sensors, and a roll angle may come from an inclinometer.
        let has_signals = |channel: Channel| match channel {
            Channel::Steer => seen(Quantity::Steer) || seen(Quantity::SteeringWheel),
            Channel::LateralAcceleration => true,
            _ => false,
        };
        let mass_kg = self.known.trailer_mass_kg;
        let or_mass = match self.mass_source {
            MassSource::Kept => format!(
                ", or another load: the trailer mass of {mass_kg:.0} kg is from before the restart, and no signal \
                 has given one since"
            ),
            MassSource::Nominal => format!(
                ", or another load: the trailer mass of {mass_kg:.0} kg is from the vehicle file, and no signal gives \
                 one"
            ),
            MassSource::Given | MassSource::Signal => String::new(),
        };
        let heights = channels::heights(&self.estimator, has_signals);
        format!("inconsistent, so there is no height: {heights}; check the sensors{or_mass}")
    }

    /// Hides the height while the signals of turns contradict each other, and shows it again when they agree.
    pub(super) fn judge_signals(&mut self) -> io::Result<()> {
        self.sensors.forget_faults();
        let before = self.known.status;
        let is_wrong = self.wrong_signal().is_some();
        if is_wrong == (before == Verdict::Inconsistent) {
            return Ok(());
        }
        self.update(self.known.trailer_mass_kg);
        self.compare(before)
    }

    /// What is wrong with levels or a specific force from which there is a height, with any signal that has zeros for missing
    /// samples or is cut off, or with signals that contradict each other in turns.
    pub(super) fn wrong_signal(&self) -> Option<String> {
        let found = self.wrong_text()?;
        Some(format!("inconsistent, so there is no height: {found}"))
    }

    /// The same without what follows from it; after a restart, what was wrong before.
    pub(super) fn wrong_text(&self) -> Option<String> {
        let is_used = |channel: Channel| self.estimator.height(channel).is_some();
        let gravity_mps2 = self.estimator.design().gravity_mps2;
        let of_chassis =
            self.sensors.wrong_chassis((gravity_mps2, true), self.options.road, is_used);
        let lost = || self.sensors.lost_values().filter(|_| self.estimator.combined().is_some());
        let disagreement = || self.sensors.disagreement(gravity_mps2, true);
        let found = of_chassis.or_else(lost).or_else(disagreement);
        found.or_else(|| self.wrong_before.clone())
    }
}
