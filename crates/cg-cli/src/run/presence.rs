//! Detection of missing signals.

use cg_core::{AlignSettings, Quantity};
use cg_logs::estimate::Tilts;
use cg_logs::log::Signal;
use cg_logs::unscaled::{is_unscaled, unscaled};

use super::pace::{Cadence, MOTION};

/// Time after the beginning within which every signal should have arrived (a mass is sent once a
/// second).
const BEGUN_US: u64 = 3_000_000;

/// Groups of signals of which one is enough.
const PURPOSES: [&[Quantity]; 5] = [
    &[Quantity::SteeringWheel, Quantity::Steer],
    ROLLS,
    &[Quantity::Speed],
    &[
        Quantity::LateralAcceleration,
        Quantity::YawRate,
        Quantity::LateralSpecificForce,
        Quantity::TractorLateralSpecificForce,
        Quantity::TractorTilt,
    ],
    &[
        Quantity::TrailerMass,
        Quantity::TrailerAxleLoad,
        Quantity::TrailerSuspensionPressure,
        Quantity::DrivePressureLeft,
        Quantity::DrivePressureRight,
    ],
];

/// The signals that give a roll angle.
const ROLLS: &[Quantity] = &[
    Quantity::Roll,
    Quantity::RollToGravity,
    Quantity::Tilt,
    Quantity::SuspensionRoll,
    Quantity::LevelLeft,
    Quantity::TractorSuspensionRoll,
    Quantity::TractorLevelLeft,
];

/// The signals that have been received and those that are expected.
#[derive(Debug, Default)]
pub(crate) struct Presence {
    /// For each group, the signal that is named if none of the group is present.
    expected: [Option<Quantity>; PURPOSES.len()],
    pub(crate) seen: [bool; Quantity::COUNT],
    cadence: [Cadence; Quantity::COUNT],
    /// When the last value came.
    last_us: [u64; Quantity::COUNT],
    since_us: Option<u64>,
    /// Signals that the only address from which they are accepted does not send.
    pub(crate) unheard: Vec<Quantity>,
    settings: AlignSettings<f64>,
    mass_is_given: bool,
    /// The signals of which is told that they are not used.
    told: Vec<Quantity>,
}

impl Presence {
    /// Expects the signals that the truck can use: the steering wheel if there is a steering ratio,
    /// and a mass unless it is given. A mapped signal is expected under its own name.
    pub(crate) fn new(
        settings: &AlignSettings<f64>,
        mass_is_given: bool,
        mapped: &[Quantity],
    ) -> Self {
        let expected = PURPOSES.map(|purpose| {
            let own = mapped.iter().copied().find(|quantity| purpose.contains(quantity));
            let usual = purpose.first().copied().filter(|quantity| match quantity {
                Quantity::SteeringWheel => settings.steering_ratio.is_some(),
                Quantity::TrailerMass => !mass_is_given,
                _ => true,
            });
            own.or(usual)
        });
        Self { expected, settings: *settings, mass_is_given, ..Self::default() }
    }

    /// Registers a value. Returns the interval in seconds if the signal is too slow and this has
    /// not been reported.
    pub(crate) fn received(&mut self, quantity: Quantity, now_us: u64) -> Option<f64> {
        let index = quantity.index();
        if let Some(seen) = self.seen.get_mut(index) {
            *seen = true;
        }
        self.last_us[index] = now_us;
        let cadence = self.cadence.get_mut(index).filter(|_| MOTION.contains(&quantity))?;
        let slow = cadence.push(now_us);
        // Roll angles become samples, and the rate of samples is checked separately.
        slow.filter(|_| !ROLLS.contains(&quantity))
    }

    /// What is to be told, once and after the beginning, of signals that are not used because the vehicle file
    /// does not say what they mean.
    pub(crate) fn unscaled(&mut self, now_us: u64) -> Vec<(&'static str, &'static str)> {
        let since_us = *self.since_us.get_or_insert(now_us);
        if now_us.saturating_sub(since_us) < BEGUN_US {
            return Vec::new();
        }
        let arrived = |quantity: Quantity| self.seen[quantity.index()];
        let found: Vec<_> = unscaled(&self.settings, self.mass_is_given, arrived)
            .filter(|(quantity, _)| !self.told.contains(quantity))
            .collect();
        self.told.extend(found.iter().map(|(quantity, _)| *quantity));
        found.into_iter().map(|(quantity, text)| (Signal::from(quantity).name(), text)).collect()
    }

    /// Which roll angles come from inclinometers. Levels without their number in the vehicle file are not used.
    pub(crate) fn tilts(&self) -> Tilts {
        Tilts::of(|quantity| self.seen[quantity.index()] && !is_unscaled(&self.settings, quantity))
    }

    /// Names of the signals that are missing: lost, too slow, or never received.
    pub(crate) fn missing(&mut self, now_us: u64) -> Vec<&'static str> {
        let since_us = *self.since_us.get_or_insert(now_us);
        let begun = now_us.saturating_sub(since_us) >= BEGUN_US;
        let seen = |quantity: &Quantity| self.seen.get(quantity.index()) == Some(&true);
        let never = |wanted: Quantity| {
            PURPOSES
                .iter()
                .zip(self.expected)
                .any(|(purpose, expected)| expected == Some(wanted) && !purpose.iter().any(seen))
        };
        let stale = |quantity: Quantity| {
            let age_us = now_us.saturating_sub(self.last_us[quantity.index()]);
            seen(&quantity) && age_us > quantity.serves_us()
        };
        let late = |quantity: Quantity| self.cadence.get(quantity.index()).is_some_and(|c| c.late);
        let missing = |quantity: &Quantity| {
            let is_unheard = self.unheard.contains(quantity);
            is_unheard || stale(*quantity) || late(*quantity) || (begun && never(*quantity))
        };
        Quantity::ALL.into_iter().filter(missing).map(|q| Signal::from(q).name()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_never_seen_is_named_after_a_while() {
        let ratio = AlignSettings { steering_ratio: Some(20.0), ..AlignSettings::NONE };
        let missing = |settings, given, mapped: &[Quantity], seen: &[Quantity]| {
            let mut presence = Presence::new(settings, given, mapped);
            for now_us in (0..=BEGUN_US).step_by(250_000) {
                for quantity in seen {
                    presence.received(*quantity, now_us);
                }
                let found = presence.missing(now_us);
                if now_us == BEGUN_US {
                    return found;
                }
                assert!(found.is_empty(), "{found:?}");
            }
            unreachable!("the steps end at the time")
        };
        let all = ["steering_wheel", "roll", "speed", "lateral_acceleration", "trailer_mass"];
        assert_eq!(missing(&ratio, false, &[], &[]), all);
        assert_eq!(missing(&AlignSettings::NONE, true, &[], &[]), all[1..4]);
        // Other signals of the same group are enough; a mapped signal is expected under its name.
        let seen = [Quantity::Tilt, Quantity::YawRate, Quantity::TrailerAxleLoad, Quantity::Steer];
        assert_eq!(missing(&ratio, false, &[], &seen), ["speed"]);
        assert_eq!(missing(&ratio, true, &[Quantity::Tilt], &[])[1], "tilt");
    }

    /// A signal with one value per second is missing all the time, not only between its values.
    #[test]
    fn a_slow_signal_is_missing_steadily() {
        let mut presence = Presence::new(&AlignSettings::NONE, true, &[]);
        let reported: Vec<f64> = (0..10_u64)
            .filter_map(|k| presence.received(Quantity::YawRate, k * 1_000_000))
            .collect();
        assert_eq!(reported, [1.0]);
        assert_eq!(presence.missing(9_000_001), ["yaw_rate"]);
        presence.received(Quantity::YawRate, 9_100_000);
        assert!(presence.missing(9_100_000).is_empty());
    }

    /// Three seconds after the first look, not after time zero.
    #[test]
    fn a_signal_has_three_seconds_to_arrive() {
        let mut presence = Presence::new(&AlignSettings::NONE, true, &[Quantity::Speed]);
        presence.expected = [None, None, Some(Quantity::Speed), None, None];
        for (now_us, missing) in [(60_000_000, false), (62_999_999, false), (63_000_000, true)] {
            assert_eq!(presence.missing(now_us).len(), usize::from(missing), "{now_us}");
        }
        presence.received(Quantity::Speed, 63_000_000);
        assert!(presence.missing(63_000_000).is_empty());
    }

    #[test]
    fn a_lost_signal_is_missing_at_once() {
        let mut presence = Presence::new(&AlignSettings::NONE, true, &[]);
        presence.received(Quantity::Tilt, 0);
        assert!(presence.missing(500_000).is_empty());
        assert_eq!(presence.missing(500_001), ["tilt"]);
        // The first value after a gap is late, the next one is not.
        presence.received(Quantity::Tilt, 550_000);
        presence.received(Quantity::Tilt, 600_000);
        assert!(presence.missing(600_000).is_empty());
    }

    /// Levels that are not used hide no inclinometers.
    #[test]
    fn a_suspension_roll_is_that_of_inclinometers_if_levels_lack_their_number() {
        let of_tilts = [Quantity::Tilt, Quantity::AxleTilt];
        let with_number =
            AlignSettings { suspension_roll_of_level: Some(1.0), ..AlignSettings::NONE };
        for (settings, used) in
            [(AlignSettings::NONE, &of_tilts[..]), (with_number, &[Quantity::Tilt])]
        {
            let mut presence = Presence::new(&settings, true, &[]);
            for quantity in of_tilts.into_iter().chain([Quantity::LevelLeft, Quantity::LevelRight])
            {
                presence.received(quantity, 0);
            }
            assert_eq!(
                presence.tilts(),
                Tilts::of(|quantity| used.contains(&quantity)),
                "{used:?}"
            );
        }
    }

    /// The rate of roll angles is that of the samples, and speed and mass may change slowly.
    #[test]
    fn only_inputs_are_told_to_be_slow() {
        for (quantity, reported, late) in [
            (Quantity::Steer, true, true),
            (Quantity::LateralAcceleration, true, true),
            (Quantity::Roll, false, true),
            (Quantity::Tilt, false, true),
            (Quantity::Speed, false, false),
            (Quantity::TrailerMass, false, false),
        ] {
            let mut presence = Presence::new(&AlignSettings::NONE, true, &[]);
            let steps: Vec<f64> =
                (0..6_u64).filter_map(|k| presence.received(quantity, k * 700_000)).collect();
            assert_eq!(steps, vec![0.7; usize::from(reported)], "{quantity}");
            assert_eq!(presence.missing(0).len(), usize::from(late), "{quantity}");
        }
    }
}
