//! Units of measured quantities: their names and their conversion to SI.

/// A unit with `SI = value * times / per`. The conversion is exact for SI units and is rounded once
/// for decimal units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Suffix of column names, such as `deg`.
    pub suffix: &'static str,
    /// Spellings in files and text, the usual one first, such as `°` and `deg`.
    pub spellings: &'static [&'static str],
    /// Numerator of the size in SI units.
    pub times: f64,
    /// Denominator of the size in SI units.
    pub per: f64,
}

const fn unit(
    suffix: &'static str,
    spellings: &'static [&'static str],
    times: f64,
    per: f64,
) -> Unit {
    Unit { suffix, spellings, times, per }
}

/// Radians in a degree.
const RAD_PER_DEG: f64 = core::f64::consts::PI / 180.0;

/// Degree.
pub const DEG: Unit = unit("deg", &["°", "deg", "degree", "degrees"], RAD_PER_DEG, 1.0);
/// Degree per second.
pub const DEGPS: Unit = unit("degps", &["°/s", "deg/s", "deg/sec", "dps"], RAD_PER_DEG, 1.0);
/// Kilometer per hour.
pub const KMH: Unit = unit("kmh", &["km/h", "kph"], 1.0, 3.6);
/// Standard gravity, exact by definition (CGPM 1901).
pub const G: Unit = unit("g", &["g"], 9.806_65, 1.0);
/// Metric ton.
pub const TONNE: Unit = unit("t", &["t", "Mg"], 1e3, 1.0);

/// A physical dimension, which determines the possible units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Time, s.
    Time,
    /// Angle, rad.
    Angle,
    /// Angular rate, rad/s.
    AngularRate,
    /// Speed, m/s.
    Speed,
    /// Acceleration, m/s².
    Acceleration,
    /// Mass, kg.
    Mass,
    /// Pressure, Pa.
    Pressure,
    /// Length, m.
    Length,
    /// Whether a part is raised: 0 or 1.
    Position,
    /// Whether a sensor is on the tractor: 0 or 1.
    Place,
}

impl Dimension {
    /// The units of this dimension: the SI unit first, then the one that is most common in files of
    /// other programs.
    pub const fn units(self) -> &'static [Unit] {
        match self {
            Self::Time => {
                const {
                    &[
                        unit("s", &["s", "sec", "seconds"], 1.0, 1.0),
                        unit("ms", &["ms", "msec"], 1.0, 1e3),
                        // The micro sign and the Greek letter.
                        unit("us", &["us", "\u{b5}s", "\u{3bc}s"], 1.0, 1e6),
                        unit("ns", &["ns"], 1.0, 1e9),
                        // The points in time of spreadsheets.
                        unit("days", &["d", "days"], 86_400.0, 1.0),
                    ]
                }
            }
            Self::Angle => {
                const { &[unit("rad", &["rad"], 1.0, 1.0), DEG, unit("mrad", &["mrad"], 1.0, 1e3)] }
            }
            Self::AngularRate => {
                const {
                    &[
                        unit("radps", &["rad/s"], 1.0, 1.0),
                        DEGPS,
                        unit("mradps", &["mrad/s"], 1.0, 1e3),
                    ]
                }
            }
            Self::Speed => {
                const { &[unit("mps", &["m/s"], 1.0, 1.0), KMH, unit("mph", &["mph"], 0.447_04, 1.0)] }
            }
            Self::Acceleration => {
                const { &[unit("mps2", &["m/s²", "m/s2", "m/s^2", "m/s/s"], 1.0, 1.0), G] }
            }
            Self::Mass => {
                const { &[unit("kg", &["kg"], 1.0, 1.0), TONNE, unit("lb", &["lb"], 0.453_592_37, 1.0)] }
            }
            Self::Pressure => {
                const {
                    &[
                        unit("pa", &["Pa"], 1.0, 1.0),
                        unit("kpa", &["kPa"], 1e3, 1.0),
                        unit("bar", &["bar"], 1e5, 1.0),
                        unit("psi", &["psi"], 6894.757, 1.0),
                    ]
                }
            }
            Self::Position => const { &[unit("raised", &["raised"], 1.0, 1.0)] },
            Self::Place => const { &[unit("tractor", &["tractor"], 1.0, 1.0)] },
            Self::Length => const { &[unit("m", &["m"], 1.0, 1.0), unit("mm", &["mm"], 1.0, 1e3)] },
        }
    }

    /// The SI unit.
    pub const fn si(self) -> Unit {
        self.units()[0]
    }

    /// The unit with this column suffix; `None` if the dimension has no such unit.
    pub fn unit(self, suffix: &str) -> Option<Unit> {
        self.units().iter().copied().find(|unit| unit.suffix == suffix)
    }

    /// The unit with this spelling or suffix, upper or lower case; `None` if the dimension has no
    /// such unit.
    pub fn spelled(self, text: &str) -> Option<Unit> {
        let text = text.trim();
        let is = |unit: &&Unit| {
            let mut names = unit.spellings.iter().chain([&unit.suffix]);
            names.any(|name| name.eq_ignore_ascii_case(text))
        };
        self.units().iter().find(is).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Dimension; 10] = [
        Dimension::Time,
        Dimension::Angle,
        Dimension::AngularRate,
        Dimension::Speed,
        Dimension::Acceleration,
        Dimension::Mass,
        Dimension::Pressure,
        Dimension::Length,
        Dimension::Position,
        Dimension::Place,
    ];

    #[test]
    fn a_unit_is_found_by_its_names_and_si_is_one() {
        for dimension in ALL {
            assert!((dimension.si().times - 1.0).abs() + (dimension.si().per - 1.0).abs() == 0.0);
            for unit in dimension.units() {
                assert_eq!(dimension.unit(unit.suffix), Some(*unit));
                for name in unit.spellings {
                    assert_eq!(dimension.spelled(name), Some(*unit), "{name}");
                }
            }
            assert_eq!((dimension.unit("furlong"), dimension.spelled("")), (None, None));
        }
        assert_eq!(Dimension::Angle.spelled(" DEG "), Some(DEG));
        assert_eq!(Dimension::Speed.spelled("deg"), None);
    }

    /// Known sizes: 90 km/h = 25 m/s, 180 degrees = π, standard gravity, metric ton.
    #[test]
    fn sizes_are_those_of_the_definitions() {
        let si = |unit: Unit, value: f64| value * unit.times / unit.per;
        for (unit, value, known) in [
            (KMH, 90.0, 25.0),
            (DEG, 180.0, core::f64::consts::PI),
            (DEGPS, 180.0, core::f64::consts::PI),
            (G, 1.0, 9.806_65),
            (TONNE, 25.0, 25e3),
        ] {
            assert!((si(unit, value) - known).abs() <= f64::EPSILON * known, "{}", unit.suffix);
        }
    }
}
