//! Fig. 2.26 with every reading of the printed fifth wheel: which of them gives the printed slope.
//!
//! Appendix A prints the stiffness of the fifth wheel and of the frame and a lash of ±3°, and says that
//! both are combined; the figure with the combined curve has no numbers.

use super::data::{Abscissa, Panel, Series, Statement, Study};
use super::drive::{Drive, peak_rolls};
use super::heights::{HEIGHT, SLOPE};
use super::setting::{PEAK_ROLL, Setting, per_meter_deg, scenario};
use cg_vehicle::error::VehicleError;

const HEIGHTS_M: [f64; 5] = [1.85, 1.95, 2.05, 2.15, 2.25];

/// Fifth wheel and frame of appendix A, N m/rad: 999 999.88 and 40 000 in-lb/deg, and both in series.
const WHEEL: f64 = 6_473_553.0;
const FRAME: f64 = 258_942.0;
const SERIES: f64 = 248_985.0;
/// A separation moment that makes the lash a free play from the start.
const AT_ONCE_NM: f64 = 2_000.0;
const LASH_RAD: f64 = 0.05236;

/// A reading: stiffness, lash, and the separation moment if it is not that of the vehicle file.
struct Reading {
    name: &'static str,
    stiffness_nm_per_rad: f64,
    lash_rad: f64,
    separation_nm: Option<f64>,
}

const fn reading(
    name: &'static str,
    stiffness_nm_per_rad: f64,
    lash_rad: f64,
    separation_nm: Option<f64>,
) -> Reading {
    Reading { name, stiffness_nm_per_rad, lash_rad, separation_nm }
}

const READINGS: [Reading; 8] = [
    reading("in series, lash after separation", SERIES, LASH_RAD, None),
    reading("in series for each side", 2.0 * SERIES, LASH_RAD, None),
    reading("fifth wheel alone", WHEEL, LASH_RAD, None),
    reading("frame alone", FRAME, LASH_RAD, None),
    reading("in series, free play of ±3°", SERIES, LASH_RAD, Some(AT_ONCE_NM)),
    reading("in series, free play of ±1.5°", SERIES, 0.5 * LASH_RAD, Some(AT_ONCE_NM)),
    reading("each side, free play of ±1.5°", 2.0 * SERIES, 0.5 * LASH_RAD, Some(AT_ONCE_NM)),
    reading("fifth wheel alone, free play of ±3°", WHEEL, LASH_RAD, Some(AT_ONCE_NM)),
];

/// Fig. 2.26 for every reading.
pub(super) fn study(setting: &Setting) -> Result<Study, VehicleError> {
    let mut lines = scenario(setting, &Drive::turn(&setting.vehicle));
    let (mut series, mut statements) = (Vec::new(), Vec::new());
    for (kind, reading) in READINGS.iter().enumerate() {
        let mut vehicle = setting.vehicle.clone();
        vehicle.hitch.roll_stiffness_nm_per_rad = reading.stiffness_nm_per_rad;
        vehicle.hitch.lash_rad = reading.lash_rad;
        vehicle.hitch.separation_moment_nm =
            reading.separation_nm.or(vehicle.hitch.separation_moment_nm);
        let base = Drive::turn(&vehicle);
        let name = |height_m: f64| format!("{}, c.g. at {height_m:.2} m", reading.name);
        let points =
            peak_rolls(&HEIGHTS_M, &mut lines, name, |height_m| base.clone().at_height(height_m))?;
        let one = Series::new(reading.name, kind, points);
        let slope = per_meter_deg(one.slope());
        let below = per_meter_deg((one.at(2.15) - one.at(1.85)) / 0.3);
        statements.push(Statement {
            place: "Fig. 2.26",
            thesis: reading.name,
            ours: format!("{slope:.2}°/m over the range, {below:.2}°/m up to 2.15 m"),
            measured: slope,
            unit: "°/m",
            criterion: SLOPE,
            because: "this reading is not the thesis's, or its other inputs are not those printed",
        });
        series.push(if kind < 6 { one } else { one.aside() });
    }
    let found = statements.iter().filter(|s| s.criterion.judge(s.measured).is_same()).count();
    Ok(Study {
        name: setting.name,
        finding: format!(
            "{found} of {} readings of the fifth wheel give the printed slope of 4.1° per meter",
            READINGS.len()
        ),
        scenario: lines,
        statements,
        panels: vec![Panel {
            figure: "2.26",
            title: "Peak roll over c.g. height, readings of the fifth wheel",
            x: Abscissa::Over(HEIGHT),
            y: PEAK_ROLL,
            series,
        }],
    })
}
