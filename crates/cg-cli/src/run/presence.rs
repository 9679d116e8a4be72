//! Which signals are there.

use cg_core::{AlignSettings, Quantity};
use cg_logs::log::Signal;

use super::pace::{Cadence, MOTION};

/// So long after the beginning every signal should have come (a weight once a second).
const BEGUN_US: u64 = 3_000_000;

/// Signals that serve one purpose: any of them is enough.
const PURPOSES: [&[Quantity]; 5] = [
    &[Quantity::SteeringWheel, Quantity::Steer],
    &[Quantity::Roll, Quantity::Tilt],
    &[Quantity::Speed],
    &[Quantity::LateralAcceleration, Quantity::YawRate],
    &[Quantity::TrailerMass, Quantity::TrailerAxleLoad, Quantity::TrailerSuspensionPressure],
];

/// What has been seen, and what should be.
#[derive(Debug, Default)]
pub(crate) struct Presence {
    /// For each purpose the signal that is named if there is none.
    expected: [Option<Quantity>; PURPOSES.len()],
    seen: [bool; Quantity::COUNT],
    cadence: [Cadence; Quantity::COUNT],
    since_us: Option<u64>,
}

impl Presence {
    /// Expects what the truck can use: the steering wheel with a steering ratio, a weight unless
    /// the mass is given. A signal that is mapped is expected by its own name.
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
        Self { expected, ..Self::default() }
    }

    /// A value has come; what is to be told of its rate.
    pub(crate) fn saw(&mut self, quantity: Quantity, now_us: u64) -> Option<f64> {
        let index = quantity.index();
        if let Some(seen) = self.seen.get_mut(index) {
            *seen = true;
        }
        let cadence = self.cadence.get_mut(index).filter(|_| MOTION.contains(&quantity))?;
        let slow = cadence.push(now_us);
        // Roll angles make the samples, whose rate is looked after by themselves.
        slow.filter(|_| !matches!(quantity, Quantity::Roll | Quantity::Tilt))
    }

    /// Names of the signals that are missing: gone, too slow, or never seen.
    pub(crate) fn missing(
        &mut self,
        now_us: u64,
        is_stale: impl Fn(Quantity) -> bool,
    ) -> Vec<&'static str> {
        let since_us = *self.since_us.get_or_insert(now_us);
        let begun = now_us.saturating_sub(since_us) >= BEGUN_US;
        let seen = |quantity: &Quantity| self.seen.get(quantity.index()) == Some(&true);
        let never = |wanted: Quantity| {
            PURPOSES
                .iter()
                .zip(self.expected)
                .any(|(purpose, expected)| expected == Some(wanted) && !purpose.iter().any(seen))
        };
        let late = |quantity: Quantity| self.cadence.get(quantity.index()).is_some_and(|c| c.late);
        let missing = |quantity: &Quantity| {
            is_stale(*quantity) || late(*quantity) || (begun && never(*quantity))
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
            for quantity in seen {
                presence.saw(*quantity, 0);
            }
            assert!(presence.missing(0, |_| false).is_empty());
            presence.missing(BEGUN_US, |_| false)
        };
        let all = ["steering_wheel", "roll", "speed", "lateral_acceleration", "trailer_mass"];
        assert_eq!(missing(&ratio, false, &[], &[]), all);
        assert_eq!(missing(&AlignSettings::NONE, true, &[], &[]), all[1..4]);
        // Others serve the same purpose; a mapped one is expected by its name.
        let seen = [Quantity::Tilt, Quantity::YawRate, Quantity::TrailerAxleLoad, Quantity::Steer];
        assert_eq!(missing(&ratio, false, &[], &seen), ["speed"]);
        assert_eq!(missing(&ratio, true, &[Quantity::Tilt], &[])[1], "tilt");
    }

    /// A signal of one value a second is missing, and not missing and back with every value.
    #[test]
    fn a_slow_signal_is_missing_steadily() {
        let mut presence = Presence::new(&AlignSettings::NONE, true, &[]);
        let told: Vec<f64> =
            (0..10_u64).filter_map(|k| presence.saw(Quantity::YawRate, k * 1_000_000)).collect();
        assert_eq!(told, [1.0]);
        assert_eq!(presence.missing(9_000_001, |_| false), ["yaw_rate"]);
        presence.saw(Quantity::YawRate, 9_100_000);
        assert!(presence.missing(9_100_000, |_| false).is_empty());
    }
}
