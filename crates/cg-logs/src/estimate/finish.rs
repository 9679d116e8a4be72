//! The end of a log: the combined result of all its maneuvers.

use cg_core::{CHANNELS, Channel, Combined, Height, Measured};
use cg_core::{Maneuver, Reject};

use super::answer::{ChannelEstimate, LogEstimate, ManeuverEstimate, Verdict};
use super::intake::{Identified, LogEstimator};
use super::leaning::threshold_g;
use super::options::interval_95;
use super::reason::reason;
use super::road::RoadPart;
use super::tight;

/// Value of [`LogEstimate::channel`] if several channels were used.
const COMBINED: &str = "combined";

/// The result of all channels together.
struct Together {
    height: Option<Height<f64>>,
    verdict: Verdict,
    /// A message on the agreement of the channels.
    remark: Option<String>,
}

impl LogEstimator {
    /// Ends the log and returns its result.
    pub fn finish(mut self) -> LogEstimate {
        self.end();
        let channel = self.options.channel.or_else(|| self.engine.best_channel());
        // If no channel has a height, the reason comes from a channel whose signal is present.
        let there = |one: &Channel| self.last_reject(*one).is_some_and(|why| why != Reject::Absent);
        let with_signal = || Channel::ALL.into_iter().rev().find(there);
        let shown = channel.or_else(with_signal).unwrap_or(Channel::LateralAcceleration);
        let mut estimate = self.empty_estimate(shown, channel);
        estimate.messages = self.messages();
        let together = self.together();
        estimate.status = together.verdict;
        if self.options.channel.is_none() && self.is_combined() {
            estimate.channel = Some(COMBINED.to_owned());
        }
        // The most important messages come first.
        let mut first: Vec<String> = together.remark.into_iter().collect();
        match together.verdict {
            Verdict::Ok => {
                let unheard = self.unheard.message(&self.design);
                first.extend(unheard.or_else(|| self.left_out()));
            }
            Verdict::Rejected => first.push(self.rejection(shown)),
            Verdict::Inconsistent => {}
        }
        first.extend(self.road(shown, together.height.as_ref()));
        if shown.feels_bank() {
            first.extend(self.scattered());
        }
        let causes = if first.is_empty() { Vec::new() } else { self.likely_causes() };
        if !causes.is_empty() {
            first.push(format!("likely cause: {}", causes.join("; or ")));
        }
        estimate.messages.splice(0..0, first);
        let best = self.best_maneuver(shown);
        if let (Some(fused), Some(best)) = (together.height, best) {
            estimate.messages.extend(self.assumed_flat(shown, &fused));
            estimate.messages.extend(self.entry.message());
            estimate.messages.extend(self.unconfirmed().map(str::to_owned));
            self.answer(&mut estimate, shown, &fused, &best);
        }
        estimate
    }

    /// Height and verdict of the requested channels.
    fn together(&self) -> Together {
        let plain = |height: Option<Height<f64>>| Together {
            height,
            verdict: if height.is_some() { Verdict::Ok } else { Verdict::Rejected },
            remark: None,
        };
        let inconsistent = |remark: String| Together {
            height: None,
            verdict: Verdict::Inconsistent,
            remark: Some(format!("inconsistent: {remark}")),
        };
        if let Some(remark) = self.wrong_chassis() {
            return inconsistent(remark);
        }
        let signals = self.wrong_signal();
        if let Some(channel) = self.options.channel {
            return Together { remark: signals, ..plain(self.engine.height(channel)) };
        }
        let combined = self.engine.combined();
        if let (Some(remark), Some(_)) = (&signals, combined) {
            return inconsistent(remark.clone());
        }
        match combined {
            Some(Combined::Doubtful { height, chi_square, .. }) => Together {
                remark: Some(format!(
                    "{}: they differ by more than their uncertainty explains; the interval was \
                     made {:.1} times as wide",
                    self.heights(),
                    chi_square.sqrt()
                )),
                ..plain(Some(height))
            },
            Some(Combined::Contradictory { chi_square, .. }) => inconsistent(format!(
                "{}: {:.0} standard deviations apart",
                self.heights(),
                chi_square.sqrt()
            )),
            Some(Combined::Impossible) => inconsistent(self.impossible()),
            other => Together { remark: signals, ..plain(other.and_then(|all| all.height())) },
        }
    }

    /// What is wrong with the signals of a chassis pair that gave a height.
    fn wrong_chassis(&self) -> Option<String> {
        let is_used = |one: Channel| {
            self.options.channel.is_none_or(|only| only == one) && self.engine.height(one).is_some()
        };
        let gravity_mps2 = self.design.gravity_mps2;
        self.sensors.wrong_chassis((gravity_mps2, false), self.options.road, is_used)
    }

    /// What is wrong with any other signal.
    fn wrong_signal(&self) -> Option<String> {
        let rolls = self.rolls.contradiction(&self.settings, self.options.second_roll_slopes);
        let signals = rolls.or_else(|| self.sensors.lost_values());
        signals.or_else(|| self.sensors.disagreement(self.design.gravity_mps2, false))
    }

    /// Whether several channels have a height.
    fn is_combined(&self) -> bool {
        Channel::ALL.iter().filter(|&&channel| self.engine.height(channel).is_some()).count() > 1
    }

    /// The maneuver with the least noise in a channel.
    fn best_maneuver(&self, channel: Channel) -> Option<Maneuver<f64>> {
        let noise_m =
            |maneuver: &Maneuver<f64>| Some(maneuver.outcomes[channel.index()].height_m.ok()?.sd);
        let best = |all: &[Maneuver<f64>]| {
            all.iter()
                .filter_map(|maneuver| Some((*maneuver, noise_m(maneuver)?)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
        };
        // Several turns since a stop can show another load together, and only the last of them counts as its first.
        let found = best(self.of_load()).or_else(|| best(&self.maneuvers));
        found.map(|(maneuver, _)| maneuver)
    }

    /// The result with height, ratio, speed and rollover threshold.
    fn answer(
        &self,
        estimate: &mut LogEstimate,
        channel: Channel,
        fused: &Height<f64>,
        best: &Maneuver<f64>,
    ) {
        let height = fused.height_m.value;
        let speed = self.mean_speed_mps(&[channel]);
        let by_mass_m = speed.map_or(0.0, |speed_mps| self.mass_sd_m(height, speed_mps, best));
        let strength = self.strong.strength(&self.design, (channel, height));
        let doubt = self.left_out.doubt(channel, (height, fused.maneuvers));
        let lean_sd = self.leaning.height_sd(self.options.lean, self.turns_mass_kg());
        let turn = [speed.unwrap_or(best.speed_mps), best.trailer_mass_kg];
        let by_tilts_m = self.seen.tilts().height_sd_m(&self.design, (channel, height), turn);
        let by_rate_m = self.rated.height_sd_m(&self.design, (channel, height), turn);
        let side = (self.options.side_wind, &self.design);
        let by_wind = self.windward.in_height(side, (channel, height), turn);
        let by_turns_m = [strength.sd * height, lean_sd * height];
        let windless_m = [by_mass_m, doubt.sd_m, by_tilts_m, by_rate_m]
            .into_iter()
            .chain(by_turns_m)
            .fold(fused.height_m.sd, libm::hypot);
        let sd = libm::hypot(windless_m, by_wind.within());
        estimate.messages.extend(by_wind.message(windless_m));
        estimate.messages.extend(strength.messages());
        estimate.messages.extend(doubt.message());
        estimate.height_m = Some(height);
        estimate.height_sd_m = Some(sd);
        estimate.height_random_sd_m = Some(fused.random_sd_m);
        estimate.road_share = Some(RoadPart::of(self.of_load()).share(channel, fused));
        estimate.height_ci95_m = Some(interval_95(Measured { value: height, sd }));
        let fit = best.outcomes[channel.index()].fit;
        estimate.snr_db = fit.map(|fit| fit.snr_db);
        estimate.fit_percent = fit.map(|fit| fit.fit_percent);
        estimate.speed_mps = speed;
        let Some(speed_mps) = estimate.speed_mps else { return };
        if let Some(ratio) = self.ratio_of(channel, fused, speed_mps, best.trailer_mass_kg) {
            estimate.ratio = Some(ratio.value);
            estimate.ratio_sd = Some(ratio.sd);
        }
        self.set_threshold(
            estimate,
            Measured { value: height, sd },
            [best.trailer_mass_kg, speed_mps],
        );
        estimate.messages.extend(self.options.unlike_load(best.trailer_mass_kg, height));
        if self.is_mass_known() {
            let (mass_kg, found) = (self.turns_mass_kg(), Measured { value: height, sd });
            estimate.messages.extend(self.options.unlike_empty(mass_kg, found));
        }
    }

    /// Sets the rollover threshold of a height, m, at a trailer mass, kg, and a speed, m/s.
    fn set_threshold(
        &self,
        estimate: &mut LogEstimate,
        height: Measured<f64>,
        [trailer_mass_kg, speed_mps]: [f64; 2],
    ) {
        let beside_m = self.leaning.beside_m(self.options.lean, trailer_mass_kg).unwrap_or(0.0);
        let turn = [trailer_mass_kg, speed_mps];
        let found_g = threshold_g(&self.design, height, turn, beside_m);
        estimate.static_rollover_threshold_g = found_g.map(|found_g| found_g.value);
        estimate.static_rollover_threshold_ci95_g = found_g.map(interval_95);
    }

    /// Standard deviation of the height due to that of the trailer mass, m.
    fn mass_sd_m(&self, height_m: f64, speed_mps: f64, best: &Maneuver<f64>) -> f64 {
        let used = |channel: &Channel| self.engine.height(*channel).is_some();
        let mass = [best.trailer_mass_kg, self.mass_sd_kg(best.trailer_mass_kg)];
        self.design.mass_sd_m(Channel::ALL.into_iter().filter(used), speed_mps, mass, height_m)
    }

    /// Mean speed of the maneuvers that gave a height in one of these channels, m/s.
    pub(super) fn mean_speed_mps(&self, channels: &[Channel]) -> Option<f64> {
        let speeds: Vec<f64> = self
            .of_load()
            .iter()
            .filter(|maneuver| {
                channels.iter().any(|channel| maneuver.outcomes[channel.index()].height_m.is_ok())
            })
            .map(|maneuver| maneuver.speed_mps)
            .collect();
        #[allow(clippy::cast_precision_loss)] // a count
        let n = speeds.len() as f64;
        (n > 0.0).then(|| speeds.iter().sum::<f64>() / n)
    }

    /// The DC ratio that corresponds to a height, with its standard deviation due to noise.
    fn ratio_of(
        &self,
        channel: Channel,
        height: &Height<f64>,
        speed_mps: f64,
        trailer_mass_kg: f64,
    ) -> Option<Measured<f64>> {
        let line = self.design.line(channel, speed_mps, trailer_mass_kg)?;
        let compensation = self.design.channels[channel.index()].compensation;
        let h = height.height_m.value;
        let slope = (line.ratio_at(h + 0.01) - line.ratio_at(h - 0.01)) / 0.02;
        let sd = (compensation * slope * height.random_sd_m).abs();
        Some(Measured { value: compensation * line.ratio_at(h), sd })
    }

    /// What is identified beside the ratios.
    fn without_ratios(&self, mass_kg: f64) -> Identified {
        let messages = self.messages();
        let wrong = self.wrong_signal();
        // Of one channel alone, as in an estimate, it does not decide, because it may be a signal of another one.
        let (decides, told) =
            if self.options.channel.is_none() { (wrong, None) } else { (None, wrong) };
        Identified {
            speed_mps: self.mean_speed_mps(&Channel::ALL).unwrap_or(f64::NAN),
            turn_g: self.strong.usual_g(self.design.gravity_mps2),
            trailer_mass_kg: mass_kg,
            trailer_mass_sd_kg: self.mass_sd_kg(mass_kg),
            trailer_mass_is_known: self.is_mass_known(),
            logged_mass_kg: self.logged_kg(),
            lift_axle: self.lift.position(),
            lift_moved_s: self.lift.moved().map(|(moved_s, _)| moved_s),
            lift_contradiction: self.lift.contradiction(),
            lift_unknown: self.lift.unknown(),
            load_since_s: self.load_since_s(),
            ratio: [None; CHANNELS],
            is_assumed_flat: self.options.road.is_none() && !self.is_on_road(),
            turns: Vec::new(),
            turns_sd: [0.0; CHANNELS],
            wrong_signal: self.wrong_chassis().or(decides),
            notes: told.into_iter().chain(messages.iter().cloned()).collect(),
            messages,
        }
    }

    /// Ends the log and returns its DC ratios, also if the heights are impossible. The ratios are
    /// fused over the maneuvers and refer to the mean speed and trailer mass in the result.
    pub fn identified(mut self) -> Identified {
        self.end();
        let mass_kg = self.turns_mass_kg();
        let mut identified = self.without_ratios(mass_kg);
        let Together { verdict, remark, .. } = self.together();
        if verdict != Verdict::Rejected {
            identified.messages.splice(0..0, remark);
        }
        for channel in self.reported_channels() {
            let Some(height) = self.engine.height(channel) else { continue };
            let doubt = self.left_out.doubt(channel, (height.height_m.value, height.maneuvers));
            let random_sd_m = libm::hypot(height.random_sd_m, doubt.sd_m);
            let doubted = Height { random_sd_m, ..height };
            // Heights do not depend on speed, so both ratios can refer to one speed.
            let ratio = self.ratio_of(channel, &doubted, identified.speed_mps, mass_kg);
            let strength = self.strong.strength(&self.design, (channel, height.height_m.value));
            let lean_sd = self.leaning.height_sd(self.options.lean, mass_kg);
            let articulated_sd = self.strong.articulated_sd(&self.design, channel);
            let turns_sd = libm::hypot(strength.sd, articulated_sd);
            identified.turns_sd[channel.index()] = turns_sd;
            let by_turns = libm::hypot(turns_sd, lean_sd);
            let turn = [identified.speed_mps, mass_kg, height.height_m.value];
            let side = (self.options.side_wind, &self.design);
            let by_wind = self.windward.of_load().in_ratio(side, channel, turn);
            let by_turns = libm::hypot(by_turns, by_wind.within());
            let relative_sd = libm::hypot(by_turns, self.rated.ratio_sd(channel));
            identified.ratio[channel.index()] = ratio.map(|ratio| Measured {
                sd: libm::hypot(ratio.sd, relative_sd * ratio.value),
                ..ratio
            });
            let mut told = strength.messages();
            told.extend(tight::told(articulated_sd));
            told.retain(|told| !identified.turns.contains(told));
            identified.turns.extend_from_slice(&told);
            told.extend(doubt.message());
            told.retain(|told| !identified.messages.contains(told));
            identified.messages.append(&mut told);
        }
        identified.messages.extend(self.rejections());
        let by_road = |one: &Channel| matches!(self.last_reject(*one), Some(Reject::Road { .. }));
        let hidden = Channel::ALL.into_iter().find(by_road);
        if let Some(channel) = hidden.filter(|_| identified.ratio.iter().all(Option::is_none)) {
            identified.messages.extend(self.road(channel, None));
        }
        identified
    }

    /// Why channels have no height, each reason once.
    fn rejections(&self) -> impl Iterator<Item = String> {
        let mut found: Vec<(String, Vec<String>)> = Vec::new();
        let mut channels = self.reported_channels();
        channels.retain(|&channel| self.engine.height(channel).is_none());
        for channel in channels {
            let why = self.rejection(channel);
            match found.iter_mut().find(|(known, _)| *known == why) {
                Some((_, names)) => names.push(channel.to_string()),
                None => found.push((why, vec![channel.to_string()])),
            }
        }
        found.into_iter().map(|(why, names)| {
            let plural = if names.len() > 1 { "s" } else { "" };
            format!("{} channel{plural}: {why}", names.join(", "))
        })
    }

    /// The result without a height.
    fn empty_estimate(&self, shown: Channel, channel: Option<Channel>) -> LogEstimate {
        let origin_s = self.origin_s.unwrap_or(0.0);
        LogEstimate {
            status: Verdict::Rejected,
            height_m: None,
            height_sd_m: None,
            height_random_sd_m: None,
            height_ci95_m: None,
            ratio: None,
            ratio_sd: None,
            method: self.options.method,
            channel: channel.map(|channel| channel.to_string()),
            speed_mps: None,
            trailer_mass_kg: self.turns_mass_kg(),
            lift_axle: self.lift.of_truck(),
            snr_db: None,
            fit_percent: None,
            static_rollover_threshold_g: None,
            static_rollover_threshold_ci95_g: None,
            road_share: None,
            channels: self
                .reported_channels()
                .into_iter()
                .map(|channel| self.alone(channel))
                .collect(),
            maneuvers: self
                .maneuvers
                .iter()
                .map(|maneuver| {
                    let outcome = &maneuver.outcomes[shown.index()];
                    let why = outcome.height_m.err().map(|why| reason(&self.design, &why));
                    let one = ManeuverEstimate::new(maneuver, outcome, origin_s);
                    ManeuverEstimate { reason: why, ..one }
                })
                .collect(),
            messages: Vec::new(),
        }
    }

    /// The channels of the result: the requested one, or the two of the roll angle and those others
    /// whose signals are present.
    fn reported_channels(&self) -> Vec<Channel> {
        if let Some(channel) = self.options.channel {
            return vec![channel];
        }
        let there = |channel: &Channel| {
            channel.feels_bank()
                || self.engine.height(*channel).is_some()
                || self.last_reject(*channel).is_some_and(|reject| reject != Reject::Absent)
        };
        Channel::ALL.into_iter().filter(there).collect()
    }

    /// The result of one channel alone.
    fn alone(&self, channel: Channel) -> ChannelEstimate {
        let height = self.engine.height(channel);
        let why = || match self.last_reject(channel) {
            Some(reject) => reason(&self.design, &reject),
            None => "no maneuver".to_owned(),
        };
        ChannelEstimate {
            channel: channel.to_string(),
            height_m: height.map(|height| height.height_m.value),
            height_sd_m: height.map(|height| height.height_m.sd),
            status: if height.is_some() { Verdict::Ok } else { Verdict::Rejected },
            reason: height.is_none().then(why),
        }
    }

    /// The reason why the last maneuver without a height in this channel has none.
    pub(super) fn last_reject(&self, channel: Channel) -> Option<Reject<f64>> {
        let mut outcomes = self.maneuvers.iter().rev().map(|one| one.outcomes[channel.index()]);
        outcomes.find_map(|outcome| outcome.height_m.err())
    }
}

#[cfg(test)]
mod tests;
