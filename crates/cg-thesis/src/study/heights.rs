//! Figs. 2.26, 2.27: peak roll over the c.g. height, under one payload and under five.

use super::data::{Abscissa, Panel, Quantity, Series, Statement, Study, Unit};
use super::drive::{Drive, peak_rolls};
use super::setting::{PEAK_ROLL, Setting, per_meter_deg, scenario};
use crate::verdict::Criterion;
use cg_plant::plant::PlantOptions;
use cg_vehicle::Load;
use cg_vehicle::error::VehicleError;

pub(super) const HEIGHT: Quantity = Quantity {
    name: "cg_height",
    label: "C.g. height of the semitrailer's sprung mass",
    unit: Unit::Meter,
};

const SLOPE_DEG: f64 = 4.1;
/// The slope of Fig. 2.26, degrees per meter.
pub(super) const SLOPE: Criterion =
    Criterion::around(SLOPE_DEG, 0.5, "a tenth of a degree at either end of 0.4 m");

/// The thesis's range.
const HEIGHTS_M: [f64; 9] = [1.85, 1.90, 1.95, 2.00, 2.05, 2.10, 2.15, 2.20, 2.25];

/// Payloads of Fig. 2.27, and the heights of their own c.g. that are possible for a box on the floor.
const PAYLOADS_KG: [f64; 5] = [5_000.0, 10_000.0, 15_000.0, 20_000.0, 25_000.0];
const PAYLOAD_HEIGHTS_M: [f64; 5] = [1.7, 1.85, 2.0, 2.15, 2.3];

/// Resolution of the thesis's tilt sensor.
const TILT_DEG: f64 = 0.05;

/// Fig. 2.26.
pub(super) fn height(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    let points = peak_rolls(
        &HEIGHTS_M,
        &mut lines,
        |height_m| format!("c.g. at {height_m:.2} m"),
        |height_m| base.clone().at_height(height_m),
    )?;
    let series = Series::new(setting.vehicle.name.clone(), 0, points);
    let slope = per_meter_deg(series.slope());
    let (low, high) = ends(&series);
    let thesis = "thesis: 4.1°/m, from our first point";
    let slope_of_thesis = series.printed_slope(thesis, SLOPE_DEG.to_radians());
    let below = (series.at(2.15) - series.at(1.85)).to_degrees() / 0.3;
    Ok(Study {
        name: setting.name,
        finding: format!(
            "The peak roll angle of the semitrailer grows by {slope:.1}° per meter of c.g. height, \
             and faster at greater heights"
        ),
        scenario: lines,
        statements: vec![
            Statement {
                place: "Fig. 2.26",
                thesis: "the peak roll angle grows by about 4.1° per meter from 1.85 to 2.25 m",
                ours: format!("{slope:.2}°/m over the range, {below:.2}°/m up to 2.15 m"),
                measured: slope,
                unit: "°/m",
                criterion: SLOPE,
                because: "the inner springs lose their load near the top of the range",
            },
            Statement {
                place: "Fig. 2.26",
                thesis: "the growth is not linear",
                ours: format!("{low:.2}°/m at the low end, {high:.2}°/m at the high end"),
                measured: high / low,
                unit: "times the first slope at the end",
                criterion: Criterion::between(
                    1.1,
                    5.0,
                    "more than a tenth; a vehicle beyond five times is about to roll over",
                ),
                because: "the vehicle is about to roll over at the top of the range",
            },
        ],
        panels: vec![Panel {
            figure: "2.26",
            title: "Peak roll over c.g. height",
            x: Abscissa::Over(HEIGHT),
            y: PEAK_ROLL,
            series: [Some(series), slope_of_thesis].into_iter().flatten().collect(),
        }],
    })
}

/// Slopes of the first and the last two points, degrees per meter.
fn ends(series: &Series) -> (f64, f64) {
    let slope = |p: &[[f64; 2]]| per_meter_deg((p[1][1] - p[0][1]) / (p[1][0] - p[0][0]));
    let mut pairs = series.points.windows(2);
    let first = pairs.next().map_or(f64::NAN, slope);
    (first, pairs.next_back().map_or(f64::NAN, slope))
}

/// Fig. 2.27.
pub(super) fn payload_height(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    lines.push(format!(
        "payload's own c.g. at {:.2} to {:.2} m; springs and tires are those of the reference load",
        PAYLOAD_HEIGHTS_M[0],
        PAYLOAD_HEIGHTS_M[PAYLOAD_HEIGHTS_M.len() - 1]
    ));
    let vehicle = &setting.vehicle;
    let tare = &vehicle.trailer.tare;
    let mut series = Vec::new();
    for (kind, payload_kg) in PAYLOADS_KG.into_iter().enumerate() {
        let share = payload_kg / (payload_kg + tare.sprung_mass_kg);
        // Eq. 2.6.
        let heights =
            PAYLOAD_HEIGHTS_M.map(|own_m| tare.cg_height_m + share * (own_m - tare.cg_height_m));
        let tonnes = payload_kg / 1000.0;
        let name = |height_m: f64| format!("{tonnes} t, c.g. at {height_m:.2} m");
        let points = peak_rolls(&heights, &mut lines, name, |cg_height_m| {
            let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
            let mut drive = base.clone();
            drive.load = Load { trailer_mass_kg, cg_height_m };
            let design_load = Some(vehicle.reference_load());
            drive.options = PlantOptions { design_load, ..PlantOptions::default() };
            drive
        })?;
        series.push(Series::new(format!("{tonnes} t"), kind, points));
    }
    let slopes: Vec<f64> = series.iter().map(|s| per_meter_deg(s.slope())).collect();
    let (least, most) = (slopes[0], slopes[slopes.len() - 1]);
    let statements = payload_statements(&series, &slopes);
    let thesis = "thesis, 5 t: 0.83°/m, from our first point";
    series.extend(series[0].printed_slope(thesis, 0.83_f64.to_radians()));
    Ok(Study {
        name: setting.name,
        finding: format!(
            "The height of a light payload has a small effect: {least:.1}° per meter with 5 t, \
             {most:.1}° with 25 t"
        ),
        scenario: lines,
        statements,
        panels: vec![Panel {
            figure: "2.27",
            title: "Peak roll over c.g. height with five payloads",
            x: Abscissa::Over(HEIGHT),
            y: PEAK_ROLL,
            series,
        }],
    })
}

fn payload_statements(series: &[Series], slopes: &[f64]) -> Vec<Statement> {
    let listed: Vec<String> = slopes.iter().map(|slope| format!("{slope:.2}")).collect();
    let bend = series.iter().map(bent).fold(0.0, f64::max);
    vec![
        Statement {
            place: "Fig. 2.27",
            thesis: "roll is quasi-linear in the c.g. height with each payload",
            ours: format!("greatest distance from the chord: {:.0} % of the rise", 100.0 * bend),
            measured: bend,
            unit: "of the rise, from the chord",
            criterion: Criterion::between(0.0, 0.1, "quasi-linear: a tenth of the rise"),
            because: "inner springs lose their load with the heaviest payloads",
        },
        Statement {
            place: "Fig. 2.27",
            thesis: "a lighter payload has a lower slope",
            ours: format!("{} °/m with 5 to 25 t", listed.join(", ")),
            measured: slopes.windows(2).map(|p| p[1] / p[0]).fold(f64::INFINITY, f64::min),
            unit: "times the slope of the next lighter payload, at least",
            criterion: Criterion::between(
                1.05,
                2.0,
                "noticeably more, and less than the payload, which doubles at most",
            ),
            because: "inner springs lose their load with the heaviest payloads",
        },
        Statement {
            place: "Fig. 2.27",
            thesis: "0.83°/m with 5 t: a tilt sensor of 0.05° resolves ±60 mm",
            ours: format!("{:.2}°/m: ±{:.0} mm", slopes[0], 1000.0 * TILT_DEG / slopes[0]),
            measured: slopes[0],
            unit: "°/m",
            criterion: Criterion::between(0.77, 0.91, "±60 mm has one digit: 55 to 65 mm"),
            because: "the suspensions have another roll stiffness at a light load",
        },
    ]
}

/// Greatest distance from the chord, divided by the rise.
pub(super) fn bent(series: &Series) -> f64 {
    let Some(first) = series.points.first() else { return f64::NAN };
    let slope = series.slope();
    let chord = |p: &[f64; 2]| (p[1] - first[1] - slope * (p[0] - first[0])).abs();
    let rise = series.points.last().map_or(f64::NAN, |last| last[1] - first[1]);
    series.points.iter().map(chord).fold(0.0, f64::max) / rise
}

#[cfg(test)]
mod tests {
    use super::*;
    use cg_vehicle::Vehicle;

    /// Least force of the inner springs and least load of the inner wheels of drive and trailer axles in
    /// the turn, kN.
    fn least_kn(vehicle: &Vehicle, height_m: f64) -> [f64; 2] {
        let record = Drive::turn(vehicle).at_height(height_m).run().unwrap();
        let axles = record.samples.iter().flat_map(cg_plant::plant::PlantSample::axles);
        let others = axles.filter(|axle| !axle.is_steered);
        others.fold([f64::INFINITY; 2], |[spring, wheel], axle| {
            [spring.min(1e-3 * axle.left_spring_n), wheel.min(1e-3 * axle.left_load_n)]
        })
    }

    #[test]
    fn the_printed_vehicle_rolls_more_when_an_inner_spring_has_lost_its_load() {
        let vehicle = Vehicle::parse(
            include_str!("../../fixtures/vehicles/baseline-printed.toml"),
            "baseline-printed.toml",
        )
        .unwrap();
        let [low, high] = [2.15, 2.25].map(|height_m| least_kn(&vehicle, height_m));
        // All springs and wheels carry at 2.15 m; at 2.25 m a spring does not, and its wheels still do.
        assert!(low[0] > 0.0 && low[1] > 0.0, "{low:?}");
        assert!(high[0] < 0.0 && high[1] > 0.0, "{high:?}");
    }
}
