//! Signals that mean nothing without a number of the vehicle file.

use cg_core::{AlignSettings, Quantity};

/// The signals, one of each pair of sides: the others of which one makes it needless, and what is said if
/// its number is not in the vehicle file.
const TABLE: [(Quantity, &[Quantity], &str); 5] = [
    (
        Quantity::SteeringWheel,
        &[Quantity::Steer],
        "there is a steering-wheel angle, but the vehicle file has no steering_ratio: the steer channel is \
         not used",
    ),
    (
        Quantity::LevelLeft,
        &[Quantity::SuspensionRoll, Quantity::AxleTilt],
        "there are levels of the trailer, but the vehicle file has no sensors.level for them: they are not used",
    ),
    (
        Quantity::TractorLevelLeft,
        &[Quantity::TractorSuspensionRoll, Quantity::TractorAxleTilt],
        "there are levels of the tractor, but the vehicle file has no sensors.tractor_level for them: they are \
         not used",
    ),
    (
        Quantity::TrailerSuspensionPressure,
        &[Quantity::TrailerMass, Quantity::TrailerAxleLoad],
        "there is a suspension pressure, but the vehicle file has no trailer.suspension_pressure: the mass is \
         not computed from it",
    ),
    (
        Quantity::DrivePressureLeft,
        &[Quantity::TrailerMass, Quantity::TrailerAxleLoad, Quantity::TrailerSuspensionPressure],
        "there are pressures of the drive axle, but the vehicle file has no sensors.drive_pressure: the mass is \
         not computed from them",
    ),
];

/// Whether the settings lack the number without which this quantity is not used.
pub fn is_unscaled(settings: &AlignSettings<f64>, quantity: Quantity) -> bool {
    match quantity {
        Quantity::SteeringWheel => settings.steering_ratio.is_none(),
        Quantity::LevelLeft | Quantity::LevelRight => settings.suspension_roll_of_level.is_none(),
        Quantity::TractorLevelLeft | Quantity::TractorLevelRight => {
            settings.tractor_suspension_roll_of_level.is_none()
        }
        Quantity::TrailerSuspensionPressure => settings.mass_of_suspension_pressure.is_none(),
        Quantity::DrivePressureLeft | Quantity::DrivePressureRight => {
            settings.mass_of_drive_pressure.is_none()
        }
        _ => false,
    }
}

/// What is said of the quantities that have arrived and are not used for lack of a number. The mass of the
/// trailer may be known without them.
pub fn unscaled(
    settings: &AlignSettings<f64>,
    mass_is_known: bool,
    arrived: impl Fn(Quantity) -> bool,
) -> impl Iterator<Item = (Quantity, &'static str)> {
    let is_told = move |(quantity, others, _): &(Quantity, &[Quantity], _)| {
        let is_scale = others.contains(&Quantity::TrailerMass);
        is_unscaled(settings, *quantity)
            && arrived(*quantity)
            && !(is_scale && mass_is_known)
            && !others.iter().any(|other| arrived(*other))
    };
    TABLE.into_iter().filter(is_told).map(|(quantity, _, text)| (quantity, text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_without_its_number_is_told_unless_another_serves() {
        let told = |settings: &AlignSettings<f64>, mass_is_known, arrived: &[Quantity]| {
            let found = unscaled(settings, mass_is_known, |quantity| arrived.contains(&quantity));
            found.map(|(quantity, _)| quantity).collect::<Vec<_>>()
        };
        let none = AlignSettings::NONE;
        for (quantity, others, text) in TABLE {
            assert_eq!(told(&none, false, &[quantity]), [quantity], "{text}");
            for other in others {
                let both = told(&none, false, &[quantity, *other]);
                assert!(!both.contains(&quantity), "{text}");
            }
        }
        let all = TABLE.map(|(quantity, ..)| quantity);
        assert_eq!(told(&none, true, &all), all[..3]);
        let scaled = AlignSettings {
            steering_ratio: Some(20.0),
            suspension_roll_of_level: Some(1.0),
            tractor_suspension_roll_of_level: Some(1.0),
            mass_of_suspension_pressure: Some([0.0, 0.1]),
            mass_of_drive_pressure: Some([0.0, 0.1]),
            ..none
        };
        assert!(told(&scaled, false, &all).is_empty());
    }
}
