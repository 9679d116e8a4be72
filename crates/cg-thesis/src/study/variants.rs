//! Figs. 2.30, 2.31: other suspensions, other tires.

use super::data::{Abscissa, Panel, Series, Statement, Study};
use super::drive::{Drive, peak_rolls};
use super::heights::{HEIGHT, bent};
use super::setting::{PEAK_ROLL, Setting, per_meter_deg, scenario};
use crate::verdict::Criterion;
use cg_vehicle::Vehicle;
use cg_vehicle::error::VehicleError;

/// The thesis's range.
const HEIGHTS_M: [f64; 5] = [1.85, 1.95, 2.05, 2.15, 2.25];

/// Vertical stiffness of the tires of Table 2.6, to which those of Fig. 2.31 are related, N/m.
const NEW_N_PER_M: f64 = 788_070.8;
const TREADS: [(&str, f64); 2] =
    [("1/2 tread", 864_250.9 / NEW_N_PER_M), ("1/3 tread", 874_408.3 / NEW_N_PER_M)];

/// Peak roll of several vehicles over the c.g. height.
fn over_height(
    vehicles: &[(String, Vehicle)],
    lines: &mut Vec<String>,
) -> Result<Vec<Series>, VehicleError> {
    let each = vehicles.iter().enumerate();
    each.map(|(kind, (name, vehicle))| {
        let base = Drive::turn(vehicle);
        let name_at = |height_m: f64| format!("{name}, c.g. at {height_m:.2} m");
        let points =
            peak_rolls(&HEIGHTS_M, lines, name_at, |height_m| base.clone().at_height(height_m))?;
        Ok(Series::new(name.clone(), kind, points))
    })
    .collect()
}

fn panel(figure: &'static str, title: &'static str, series: Vec<Series>) -> Vec<Panel> {
    vec![Panel { figure, title, x: Abscissa::Over(HEIGHT), y: PEAK_ROLL, series }]
}

/// Smallest and greatest distance of a series from another, degrees.
fn apart_deg(series: &Series, other: &Series) -> (f64, f64) {
    let apart: Vec<f64> =
        series.points.iter().map(|p| (p[1] - other.at(p[0])).to_degrees()).collect();
    let least = apart.iter().copied().fold(f64::INFINITY, f64::min);
    (least, apart.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

/// Two slopes over the whole range are about the same.
const SAME_SLOPE: Criterion = Criterion::between(0.9, 1.1, "about the same: a tenth");

/// Slope up to 2.15 m, where no fifth wheel has separated yet.
fn slope_deg(series: &Series) -> f64 {
    per_meter_deg((series.at(2.15) - series.at(1.85)) / 0.3)
}

/// The vehicle with air suspensions that differs from `base` in nothing else: with the printed roll steer
/// and fifth wheel, if `base` has roll steer.
fn air_beside(base: &Vehicle) -> Result<Vehicle, VehicleError> {
    let steers = base.axles().iter().any(|placed| placed.axle.roll_steer_rad_per_rad != 0.0);
    let (text, name) = if steers {
        (
            include_str!("../../fixtures/vehicles/air-printed.toml"),
            "fixtures/vehicles/air-printed.toml",
        )
    } else {
        (include_str!("../../fixtures/vehicles/air.toml"), "fixtures/vehicles/air.toml")
    };
    Vehicle::parse(text, name)
}

/// Fig. 2.30.
pub(super) fn suspension(setting: &Setting) -> Result<Study, VehicleError> {
    let base = &setting.vehicle;
    let air = air_beside(base)?;
    let mut lines = scenario(setting, &Drive::turn(base));
    let vehicles = [("baseline".to_owned(), base.clone()), ("air suspension".to_owned(), air)];
    let series = over_height(&vehicles, &mut lines)?;
    let (least, most) = apart_deg(&series[1], &series[0]);
    let [leaf_slope, air_slope] = [slope_deg(&series[0]), slope_deg(&series[1])];
    let bends = [&series[0], &series[1]].map(bend_deg);
    Ok(Study {
        name: setting.name,
        finding: format!(
            "Air suspensions roll {least:.1} to {most:.1}° more than leaf springs; the slope over the c.g. \
             height is {air_slope:.1}° per meter (leaf springs: {leaf_slope:.1}°)"
        ),
        scenario: lines,
        statements: vec![
            Statement {
                place: "Fig. 2.30",
                thesis: "air suspensions give a larger roll angle",
                ours: format!("{least:+.2} to {most:+.2}° over the range"),
                measured: least,
                unit: "° more, at least",
                criterion: Criterion::between(
                    0.05,
                    2.0,
                    "more than the thesis's tilt sensor resolves, and no rollover",
                ),
                because: "the leaf springs roll more near their rollover",
            },
            Statement {
                place: "Fig. 2.30",
                thesis: "the slope over the c.g. height is about the same",
                ours: format!(
                    "{air_slope:.2}°/m (baseline: {leaf_slope:.2}) up to 2.15 m, {:.2}°/m \
                     ({:.2}) over the range",
                    per_meter_deg(series[1].slope()),
                    per_meter_deg(series[0].slope())
                ),
                measured: series[1].slope() / series[0].slope(),
                unit: "times the baseline's slope over the range",
                criterion: SAME_SLOPE,
                because: "the inner springs of the baseline lose their load near the top of the range",
            },
            Statement {
                place: "Fig. 2.30",
                thesis: "with air suspensions the relationship is nearly linear",
                ours: format!(
                    "the slope changes by {:+.2}°/m over the range, that of the baseline by {:+.2}",
                    bends[1], bends[0]
                ),
                measured: bent(&series[1]),
                unit: "of the rise, from the chord",
                criterion: Criterion::between(0.0, 0.1, "nearly linear: a tenth of the rise"),
                because: "the inner springs lose their load",
            },
        ],
        panels: panel("2.30", "Peak roll over c.g. height, two suspensions", series),
    })
}

/// Slope of the last pair of points minus that of the first, degrees per meter.
fn bend_deg(series: &Series) -> f64 {
    let slope = |p: &[[f64; 2]]| per_meter_deg((p[1][1] - p[0][1]) / (p[1][0] - p[0][0]));
    let slopes: Vec<f64> = series.points.windows(2).map(slope).collect();
    slopes.first().zip(slopes.last()).map_or(f64::NAN, |(first, last)| last - first)
}

/// Fig. 2.31.
pub(super) fn tyres(setting: &Setting) -> Result<Study, VehicleError> {
    let base = &setting.vehicle;
    let mut lines = scenario(setting, &Drive::turn(base));
    let mut vehicles = vec![("new".to_owned(), base.clone())];
    for (name, stiffer) in TREADS {
        let mut worn = base.clone();
        for tyre in &mut worn.tyre {
            tyre.vertical_stiffness_n_per_m *= stiffer;
        }
        lines.push(format!("{name}: vertical tire stiffness +{:.1} %", 100.0 * (stiffer - 1.0)));
        vehicles.push((name.to_owned(), worn));
    }
    let series = over_height(&vehicles, &mut lines)?;
    let less: Vec<(f64, f64)> = series.iter().map(|s| apart_deg(s, &series[0])).collect();
    let slopes: Vec<f64> = series.iter().map(slope_deg).collect();
    let whole = series.iter().map(|s| s.slope() / series[0].slope());
    let size = |ratio: &f64| libm::log(*ratio).abs();
    let farthest = whole.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(f64::NAN);
    Ok(Study {
        name: setting.name,
        finding: format!(
            "Worn tires, which are {:.0} % stiffer, reduce the peak roll by {:.2} to {:.2}° and do not \
             change its slope over the c.g. height",
            100.0 * (TREADS[1].1 - 1.0),
            -less[2].1,
            -less[2].0
        ),
        scenario: lines,
        statements: vec![
            Statement {
                place: "Fig. 2.31",
                thesis: "stiffer tires roll less",
                ours: format!(
                    "1/2 tread {:+.2} to {:+.2}°, 1/3 tread {:+.2} to {:+.2}°",
                    less[1].1, less[1].0, less[2].1, less[2].0
                ),
                measured: less[1].1.max(less[2].1),
                unit: "°, the smallest difference",
                criterion: Criterion::between(
                    -0.5,
                    -0.01,
                    "less by more than a line is thick, and by no more than a fifth of the peak",
                ),
                because: "stiffer tires do not reduce the roll at every height",
            },
            Statement {
                place: "Fig. 2.31",
                thesis: "the slope over the c.g. height does not vary",
                ours: format!(
                    "{:.2} (new), {:.2} (1/2), {:.2}°/m (1/3 tread) up to 2.15 m; {farthest:.2} times \
                     the slope of new tires over the range",
                    slopes[0], slopes[1], slopes[2]
                ),
                measured: farthest,
                unit: "times the slope with new tires over the range",
                criterion: SAME_SLOPE,
                because: "the inner springs lose their load near the top of the range, with new tires first",
            },
        ],
        panels: panel("2.31", "Peak roll over c.g. height, three treads", series),
    })
}
