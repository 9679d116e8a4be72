//! Counts of implausible and doubtful values; each kind is reported once.

use cg_core::signal::j1939::{Compensation, Slope};
use cg_core::{AlignSettings, Quantity};
use serde::{Deserialize, Serialize};

use crate::place::Position;

/// A counted kind of finding: its count, its first value and the position of this value in a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct FindingCount {
    count: u64,
    first: f64,
    place: Option<Position>,
    reported: bool,
}

impl FindingCount {
    fn add(&mut self, value: f64, place: Option<Position>) -> bool {
        if self.count == 0 {
            (self.first, self.place) = (value, place);
        }
        self.count += 1;
        self.count == 1
    }
}

/// Counts of implausible and doubtful values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    implausible: [FindingCount; Quantity::COUNT],
    degraded: FindingCount,
    faulty: FindingCount,
    compensation_unknown: FindingCount,
    /// Whether there is a finding that has not been reported.
    fresh: bool,
}

impl Tally {
    /// Counts a value that the truck cannot have, with its position in a log.
    pub fn implausible(&mut self, quantity: Quantity, value: f64, place: Option<Position>) {
        if let Some(count) = self.implausible.get_mut(quantity.index()) {
            self.fresh |= count.add(value, place);
        }
    }

    /// Counts what a slope sensor reports about its roll angle.
    pub fn slope(&mut self, slope: Slope, rule: Compensation) {
        if slope.quantity(rule).is_none() {
            self.fresh |= self.faulty.add(0.0, None);
        } else if slope.merit == 1 {
            self.fresh |= self.degraded.add(0.0, None);
        }
        let by_bits = matches!(rule, Compensation::Bits | Compensation::InvertedBits);
        if by_bits && slope.compensation == 3 {
            self.fresh |= self.compensation_unknown.add(0.0, None);
        }
    }

    /// Number of values that the truck cannot have.
    pub fn implausible_values(&self) -> u64 {
        self.implausible.iter().map(|count| count.count).sum()
    }

    /// Number of roll angles that their sensor reports as degraded.
    pub fn degraded_values(&self) -> u64 {
        self.degraded.count
    }

    /// Number of roll angles that their sensor reports as wrong.
    pub fn faulty_values(&self) -> u64 {
        self.faulty.count
    }

    /// The findings that occurred for the first time since the last call, each as signal and
    /// sentence.
    pub fn news(&mut self, settings: &AlignSettings<f64>) -> Vec<(&'static str, String)> {
        if !std::mem::take(&mut self.fresh) {
            return Vec::new();
        }
        let all = self.sentences(settings);
        let reported =
            self.counts_mut().map(|count| std::mem::replace(&mut count.reported, count.count > 0));
        all.into_iter()
            .zip(reported)
            .filter(|(_, reported)| !reported)
            .filter_map(|(found, _)| found)
            .collect()
    }

    /// All findings with their counts.
    pub fn remarks(&self, settings: &AlignSettings<f64>) -> Vec<String> {
        let counted = |(finding, count): (Option<(&'static str, String)>, FindingCount)| {
            finding
                .map(|(signal, sentence)| format!("{signal}: {sentence} ({} in all)", count.count))
        };
        self.sentences(settings).into_iter().zip(self.counts()).filter_map(counted).collect()
    }

    fn counts(&self) -> [FindingCount; Quantity::COUNT + 3] {
        let mut counts = [FindingCount::default(); Quantity::COUNT + 3];
        counts[..Quantity::COUNT].copy_from_slice(&self.implausible);
        counts[Quantity::COUNT..].copy_from_slice(&[
            self.degraded,
            self.faulty,
            self.compensation_unknown,
        ]);
        counts
    }

    fn counts_mut(&mut self) -> impl Iterator<Item = &mut FindingCount> {
        let slope = [&mut self.degraded, &mut self.faulty, &mut self.compensation_unknown];
        self.implausible.iter_mut().chain(slope)
    }

    /// The sentences of the findings in the order of the counts.
    fn sentences(&self, settings: &AlignSettings<f64>) -> Vec<Option<(&'static str, String)>> {
        let mut all: Vec<_> = Quantity::ALL
            .into_iter()
            .zip(&self.implausible)
            .map(|(quantity, count)| {
                let name = quantity.name();
                let place = match count.place {
                    Some(Position::Line(line)) => format!("line {line}: "),
                    Some(Position::Row(row)) => format!("row {row}: "),
                    Some(Position::File) | None => String::new(),
                };
                let sentence = implausible(quantity, count.first, settings);
                (count.count > 0).then(|| (name, place + &sentence))
            })
            .collect();
        let roll = Quantity::Roll.name();
        for (count, sentence) in [
            (self.degraded, "the slope sensor reports a degraded roll angle; the angle is used"),
            (
                self.faulty,
                "the slope sensor reports an error of its roll angle or its compensation; such \
                 values count as absent",
            ),
            (
                self.compensation_unknown,
                "the slope sensor does not report whether it compensates its angle for the \
                 vehicle's accelerations; it is treated as an inclinometer, which does not; if it \
                 does, give ⟨roll_compensated yes⟩",
            ),
        ] {
            all.push((count.count > 0).then(|| (roll, sentence.to_owned())));
        }
        all
    }
}

/// The sentence about a value that a quantity cannot have.
fn implausible(quantity: Quantity, value: f64, settings: &AlignSettings<f64>) -> String {
    let column = quantity.column();
    let [least, greatest] = quantity.limits();
    // Very large numbers are shown with an exponent to avoid hundreds of digits.
    let shown = if value.abs() < 1e9 { value.to_string() } else { format!("{value:e}") };
    let mass_kg = settings.mass_kg(quantity, value);
    match settings.mass_range_kg {
        Some([least_kg, greatest_kg]) if mass_kg.is_finite() => {
            let means = match quantity {
                Quantity::TrailerMass => String::new(),
                _ => format!(" means a trailer of {mass_kg:.0} kg, which"),
            };
            format!(
                "{column} {shown}{means} is impossible (the vehicle file allows {least_kg:.0} to \
                 {greatest_kg:.0} kg); such values count as absent"
            )
        }
        _ => format!(
            "{column} {shown} is impossible (possible: {least} to {greatest}); such values count \
             as absent; check the sensor and the unit"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_thing_is_told_once_and_counted() {
        let settings =
            AlignSettings { mass_range_kg: Some([5000.0, 50_000.0]), ..AlignSettings::NONE };
        let mut tally = Tally::default();
        assert!(tally.news(&settings).is_empty());
        for value in [0.0, 4.0] {
            tally.implausible(Quantity::TrailerMass, value, None);
        }
        let news = tally.news(&settings);
        assert_eq!(news.len(), 1);
        assert_eq!(news[0].0, "trailer_mass");
        assert!(
            news[0].1.starts_with(
                "trailer_mass_kg 0 is impossible (the vehicle file allows 5000 to 50000 kg)"
            ),
            "{news:?}"
        );
        tally.implausible(Quantity::TrailerMass, 0.0, None);
        tally.implausible(Quantity::Roll, 1e308, Some(Position::Line(7)));
        assert_eq!(tally.news(&settings)[0].0, "roll");
        assert!(tally.news(&settings).is_empty());
        assert_eq!(tally.implausible_values(), 4);
        let remarks = tally.remarks(&settings);
        assert!(
            remarks[0].starts_with("roll: line 7: roll_rad 1")
                && remarks[0].contains("possible: -1 to 1")
        );
        assert!(remarks[1].ends_with("(3 in all)"), "{remarks:?}");
    }

    #[test]
    fn a_slope_sensor_in_doubt_is_told() {
        let mut tally = Tally::default();
        for (compensation, merit) in [(0, 0), (0, 3), (0, 1), (3, 1), (0, 2), (2, 0)] {
            tally.slope(Slope { compensation, merit }, Compensation::Bits);
        }
        assert_eq!((tally.degraded_values(), tally.faulty_values()), (2, 2));
        assert_eq!(tally.news(&AlignSettings::NONE).len(), 3);
        let mut given = Tally::default();
        given.slope(Slope { compensation: 3, merit: 3 }, Compensation::On);
        assert_eq!(given, Tally::default());
    }
}
