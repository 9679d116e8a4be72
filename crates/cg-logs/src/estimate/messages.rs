//! Messages that explain a height or its absence.

use cg_core::{Channel, Height, Inconsistency, Maneuver, Measured, Quantity, Reject};

use super::diagnosis::Evidence;
use super::intake::LogEstimator;
use super::reason::reason;
use super::road::RoadPart;
use crate::unscaled::unscaled;

/// Drift of the roll sensor above which it is reported: a third of a degree per minute.
const DRIFT_RADPS: f64 = 1e-4;

impl LogEstimator {
    /// The reason why there is no height.
    pub(super) fn rejection(&self, shown: Channel) -> String {
        if self.rows == self.absent_rows {
            return "rejected: no row has a roll angle and an input".to_owned();
        }
        let of_channel = |maneuver: &Maneuver<f64>| maneuver.outcomes[shown.index()].height_m;
        let of_load = self.of_load().iter();
        let rejects: Vec<_> = of_load.filter_map(|maneuver| of_channel(maneuver).err()).collect();
        let last = rejects.last().map(|reject| reason(&self.design, reject));
        let had_height = || self.maneuvers.iter().any(|maneuver| of_channel(maneuver).is_ok());
        if let Some((moved_s, _)) = self.lift.moved().filter(|_| had_height()) {
            let why = last.map(|last| format!(" ({last})")).unwrap_or_default();
            return format!(
                "rejected: no turn has given a height since the lift axle moved at {moved_s:.0} s{why}; for that of before, give \
                 the log until then"
            );
        }
        match last {
            None => "rejected: unexcited, the log contains no turn (at least 0.5 m/s² of lateral \
                     acceleration); record a drive with turns"
                .to_owned(),
            Some(last) => {
                let or_else =
                    [self.or_lighter(rejects.last()), self.or_ahead(shown, rejects.last())];
                format!("rejected: {last}{}", or_else.concat())
            }
        }
    }

    /// What else a roll angle that comes after its input may be, if that is a yaw rate.
    fn or_ahead(&self, shown: Channel, last: Option<&Reject<f64>>) -> String {
        // It also seems to stand still where it turns round, while the expected one still moves.
        let is_late = matches!(
            last,
            Some(Reject::Inconsistent(
                Inconsistency::Misfit { .. } | Inconsistency::Standstill { .. }
            ))
        );
        let by_yaw = shown == Channel::LateralAcceleration
            && self.seen.has(Quantity::YawRate)
            && !self.seen.has(Quantity::LateralAcceleration);
        let of_file = self.options.prepares.is_some_and(|truck| truck.yaw_on_tractor.is_some());
        let is_trailers = !self.preparation.has_tractor_yaw && !of_file;
        let told = is_late && by_yaw && is_trailers;
        let text = "; or the yaw rate is that of the tractor: give it a column yaw_rate_on_tractor with 1, or [sensors.yaw_rate] \
                    on_tractor = true in the vehicle file";
        if told { text.to_owned() } else { String::new() }
    }

    /// What else a roll angle that seems to stand still may be if no mass is known.
    fn or_lighter(&self, last: Option<&Reject<f64>>) -> String {
        let still = matches!(last, Some(Reject::Inconsistent(Inconsistency::Standstill { .. })));
        if !still || self.is_mass_known() {
            return String::new();
        }
        let used_kg = self.turns_mass_kg();
        format!(
            "; or the trailer is much lighter than {used_kg:.0} kg, which counts because its mass is not known: give \
             ⟨trailer_mass_kg⟩"
        )
    }

    pub(super) fn messages(&self) -> Vec<String> {
        let basis = self.options.basis;
        let doubt = basis.and_then(|basis| basis.judgment.message());
        let mut messages: Vec<String> =
            doubt.into_iter().chain(self.sensors.signals.clock()).collect();
        messages.extend(basis.and_then(|basis| basis.age_message(self.origin_s?)));
        // The bank of a road changes roll angles and suspension rolls just as slowly.
        let mut of_roll =
            Channel::ALL.into_iter().filter(|one| one.feels_bank() && !self.is_on_road());
        if let Some(drift) = of_roll.find_map(|channel| self.drift(channel)) {
            let beyond = match self.options.side_wind {
                Some(side) if side.is_stated => {
                    "is in the interval as far as [wind] in the vehicle file says how strong it is"
                }
                _ => {
                    "is not in the interval, because the vehicle file has no [wind] or says that it is calm"
                }
            };
            messages.push(format!(
                "the roll angle drifts by {drift:.1} degrees per minute: its sensor does, or a side wind comes from another \
                 side after a turn; a constant drift was removed from each maneuver, and what a wind does beyond that {beyond}"
            ));
        }
        if self.more_maneuvers > 0 {
            messages.push(format!(
                "{} more maneuvers were used for the height but are not listed",
                self.more_maneuvers
            ));
        }
        messages.extend(self.lift.messages());
        messages.extend(self.turns_messages());
        messages.extend(self.sensors.coarse());
        messages.extend(self.seized());
        messages.extend(self.unscaled());
        messages.extend(self.rolls.places(&self.settings, self.options.second_roll_slopes));
        let mut unplaced = self.maneuvers.iter().map(|one| self.options.unplaced(&one.outcomes));
        messages.extend(unplaced.find_map(|found| found).map(str::to_owned));
        messages.extend(self.leaning.message(self.options.lean, self.turns_mass_kg()));
        messages.extend(self.changed());
        messages.extend(self.preparation.spikes());
        if self.absent_rows > 0 {
            messages.push(format!(
                "{} of {} rows have no roll angle or no input and were left out",
                self.absent_rows, self.rows
            ));
        }
        messages
    }

    /// That the roll angle stood still or was bent in some maneuvers, although others gave a height. The bank of a road does the
    /// same to a channel, which does not matter if another one gave the height.
    fn seized(&self) -> Option<String> {
        let is_of_sensor = |reject: &Reject<f64>| match reject {
            Reject::Inconsistent(found) => !matches!(found, Inconsistency::Misfit { .. }),
            _ => false,
        };
        let reason = |maneuver: &Maneuver<f64>| {
            let has_height = maneuver.outcomes.iter().any(|one| one.height_m.is_ok());
            let mut rejects = maneuver.outcomes.iter().filter_map(|one| one.height_m.err());
            rejects.find(is_of_sensor).filter(|_| !has_height)
        };
        let reasons: Vec<_> = self.maneuvers.iter().filter_map(reason).collect();
        let is_used = Channel::ALL.into_iter().any(|one| self.engine.height(one).is_some());
        reasons.last().filter(|_| is_used).map(|last| {
            format!(
                "{} of {} maneuvers were left out, and the others may suffer from the same fault: {last}",
                reasons.len(),
                self.maneuvers.len()
            )
        })
    }

    /// Signals that are not used because the vehicle file does not say what they mean.
    fn unscaled(&self) -> impl Iterator<Item = String> {
        let mass_is_known = self.seen.mass_kg.is_some() || self.options.trailer_mass_kg.is_some();
        let found = unscaled(&self.settings, mass_is_known, |one| self.seen.unscaled[one.index()]);
        found.map(|(_, text)| text.to_owned())
    }

    /// What the bank of the road does to the result, if it is not known and matters.
    pub(super) fn road(&self, shown: Channel, fused: Option<&Height<f64>>) -> Option<String> {
        if !self.is_on_road() || !shown.feels_bank() {
            return None;
        }
        RoadPart::message(fused.map(|fused| RoadPart::of(self.of_load()).share(shown, fused)))
    }

    /// That nothing says whether the roads of a height are flat, if it matters.
    pub(super) fn assumed_flat(&self, shown: Channel, fused: &Height<f64>) -> Option<String> {
        if self.is_on_road() || !shown.feels_bank() || self.scattered().is_some() {
            return None;
        }
        RoadPart::assumed_flat(self.options.road, fused.maneuvers)
    }

    /// That nothing shows whether the lateral acceleration of the height contains gravity.
    pub(super) fn unconfirmed(&self) -> Option<&'static str> {
        let channel = Channel::LateralAcceleration;
        let is_used = self.options.channel.is_none_or(|only| only == channel)
            && self.engine.height(channel).is_some();
        self.options.unconfirmed(|one| self.seen.has(one)).filter(|_| is_used)
    }

    /// Whether the bank of the road is unknown and changes a roll angle of the log.
    pub(super) fn is_on_road(&self) -> bool {
        RoadPart::of(self.of_load()).is_unknown(self.options.road)
    }

    /// The heights of all channels in words.
    pub(super) fn heights(&self) -> String {
        let text = |channel: Channel| {
            let height = self.engine.height(channel)?.height_m;
            Some(format!("{channel} channel {:.3} ± {:.3} m", height.value, height.sd))
        };
        Channel::ALL.into_iter().filter_map(text).collect::<Vec<_>>().join(", ")
    }

    /// The reason why the height of one channel is not used.
    pub(super) fn impossible(&self) -> String {
        let of =
            |one: Channel| Some((one, self.last_reject(one).filter(|why| *why != Reject::Absent)?));
        let mut without = Channel::ALL.into_iter().filter(|&one| self.engine.height(one).is_none());
        let reject = without.find_map(of);
        let why = reject
            .map(|(one, reject)| format!("{one} channel: {}; ", reason(&self.design, &reject)))
            .unwrap_or_default();
        format!("{why}{}, which is wrong too if the roll angle is wrong", self.heights())
    }

    /// The channel that gave no height although its signal is present, and the reason.
    pub(super) fn left_out(&self) -> Option<String> {
        if self.options.channel.is_some() {
            return None;
        }
        let channel = Channel::ALL.into_iter().find(|&one| self.engine.height(one).is_none())?;
        let reject = self.last_reject(channel).filter(|reject| *reject != Reject::Absent)?;
        Some(format!("{channel} channel left out: {}", reason(&self.design, &reject)))
    }

    /// Likely causes of a contradiction, in words.
    pub(super) fn likely_causes(&self) -> Vec<String> {
        let mut reversed = [Channel::Suspension, Channel::Tractor]
            .into_iter()
            .filter_map(|one| self.reversed(one));
        if let Some(cause) = reversed.next() {
            return vec![cause];
        }
        if self.is_on_road() {
            return Vec::new(); // a bank explains as much as any fault
        }
        if self.scatter().is_some_and(|found| found.is_wide) {
            return vec![
                "the road is banked: name a roll angle relative to gravity roll_to_gravity_rad, and leave out \
                 ⟨road flat⟩"
                    .to_owned(),
            ];
        }
        let speed_mps = self.mean_speed_mps_of_fits();
        let evidence = Evidence {
            design: &self.design,
            steering_ratio: self.settings.steering_ratio,
            ratio: [Channel::Steer, Channel::LateralAcceleration]
                .map(|channel| self.pooled_ratio(channel, speed_mps)),
            speed_mps,
            trailer_mass_kg: self.turns_mass_kg(),
        };
        let mut causes = evidence.likely_causes();
        if self.sensors.signals.confirms_lateral(self.design.gravity_mps2) {
            causes.retain(|cause| !cause.is_of_lateral());
            if causes.is_empty() {
                causes.extend(evidence.gain());
            }
        }
        causes.iter().map(ToString::to_string).collect()
    }

    fn mean_speed_mps_of_fits(&self) -> f64 {
        let fitted =
            self.maneuvers.iter().filter(|one| one.outcomes.iter().any(|o| o.fit.is_some()));
        let (sum, n) = fitted.fold((0.0, 0.0), |(sum, n), one| (sum + one.speed_mps, n + 1.0));
        sum / n
    }

    /// The DC ratio of a channel at a speed, divided by the compensation, from all identified
    /// maneuvers. It includes maneuvers whose height is impossible.
    fn pooled_ratio(&self, channel: Channel, speed_mps: f64) -> Option<Measured<f64>> {
        let reference_m = self.design.reference_height_m;
        let at = |speed_mps, mass_kg| {
            Some(self.design.line(channel, speed_mps, mass_kg)?.ratio_at(reference_m))
        };
        let (mut weight, mut sum) = (0.0, 0.0);
        for maneuver in &self.maneuvers {
            let outcome = maneuver.outcomes[channel.index()];
            let believed = matches!(outcome.height_m, Ok(_) | Err(Reject::Height(_)));
            let Some(fit) = outcome.fit.filter(|_| believed) else { continue };
            let Some(usual) = at(maneuver.speed_mps, maneuver.trailer_mass_kg) else { continue };
            let one = usual * usual / (fit.ratio.sd * fit.ratio.sd);
            weight += one;
            sum += one * fit.ratio.value / usual;
        }
        let usual = at(speed_mps, self.turns_mass_kg())? / self.design.compensation(channel);
        (weight > 0.0).then(|| Measured { value: sum / weight * usual, sd: usual / weight.sqrt() })
    }

    /// The drift of the roll sensor if most maneuvers show one, degrees per minute.
    fn drift(&self, channel: Channel) -> Option<f64> {
        let fits: Vec<_> = self
            .maneuvers
            .iter()
            .filter_map(|maneuver| maneuver.outcomes[channel.index()].fit)
            .filter(|fit| fit.drift_radps.sd > 0.0)
            .collect();
        let sure = |drift: &Measured<f64>| {
            drift.value.abs() > DRIFT_RADPS && drift.value.abs() > 3.0 * drift.sd
        };
        let drifting = fits.iter().filter(|fit| sure(&fit.drift_radps)).count();
        if drifting * 2 <= fits.len() {
            return None;
        }
        #[allow(clippy::cast_precision_loss)] // a count
        let mean = fits.iter().map(|fit| fit.drift_radps.value).sum::<f64>() / fits.len() as f64;
        Some(mean.to_degrees() * 60.0)
    }
}
