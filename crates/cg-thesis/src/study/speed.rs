//! Figs. 2.23, 2.24: both maneuvers at different speeds.

use super::data::{Abscissa, Panel, Quantity, Series, Statement, Study, Unit};
use super::drive::{Course, Drive, LANE_CHANGE, QUARTER, trailer_lateral, trailer_roll};
use super::setting::{PEAK_LATERAL, PEAK_ROLL, Setting, scenario};
use crate::verdict::Criterion;
use cg_vehicle::error::VehicleError;

const SPEED: Quantity = Quantity { name: "speed", label: "Speed", unit: Unit::MeterPerSecond };
const KMH: f64 = 1.0 / 3.6;
/// By how much the lane change rolls more, as the thesis prints it.
const MORE_DEG: f64 = 0.28;

/// Why the peaks of a lane change are others.
const DRIVER: &str = "the thesis describes neither its driver nor the straight road before the gate, and \
                      both decide how fast the driver steers";

/// One maneuver over speed.
struct Sweep {
    name: &'static str,
    course: Course,
    kmh: &'static [f64],
    lateral: Vec<[f64; 2]>,
    roll: Vec<[f64; 2]>,
}

impl Sweep {
    fn drive(&mut self, base: &Drive, lines: &mut Vec<String>) -> Result<(), VehicleError> {
        for &kmh in self.kmh {
            let record = base.clone().along(self.course, kmh * KMH).run()?;
            lines.extend(record.rollover_remark(&format!("{} at {kmh} km/h", self.name)));
            let peaks = record.peak(trailer_lateral).zip(record.peak(trailer_roll));
            if let Some((lateral, roll)) = peaks {
                self.lateral.push([kmh * KMH, lateral]);
                self.roll.push([lateral, roll]);
            }
        }
        // Roll over acceleration is sorted from the least to the greatest acceleration.
        self.roll.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(())
    }
}

/// Figs. 2.23, 2.24.
pub(super) fn study(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    lines.pop();
    lines.push("lane change of 20 m gate length; turn of 90°, 100 m radius".to_owned());
    let mut sweeps = [
        ("lane change", LANE_CHANGE, &[70.0, 80.0, 90.0, 100.0, 110.0, 120.0][..]),
        ("turn", QUARTER, &[46.0, 48.0, 49.0, 50.0, 51.0, 52.0][..]),
    ]
    .map(|(name, course, kmh)| Sweep { name, course, kmh, lateral: vec![], roll: vec![] });
    for sweep in &mut sweeps {
        sweep.drive(&base, &mut lines)?;
    }
    let series = |of: fn(&Sweep) -> &Vec<[f64; 2]>| -> Vec<Series> {
        let each = sweeps.iter().enumerate();
        each.map(|(kind, sweep)| Series::new(sweep.name, kind, of(sweep).clone())).collect()
    };
    let (lateral, roll) = (series(|s| &s.lateral), series(|s| &s.roll));
    let statements = statements(setting, &lateral, &roll);
    let g = setting.vehicle.gravity_mps2;
    let finding = format!(
        "0.2 g is reached at {} in the turn, at {} in the lane change",
        crossing(&lateral[1], 0.2 * g),
        crossing(&lateral[0], 0.2 * g)
    );
    let (lateral, roll) = beside(lateral, roll, g);
    Ok(Study {
        name: setting.name,
        finding,
        scenario: lines,
        statements,
        panels: vec![
            Panel {
                figure: "2.24",
                title: "Peak lateral acceleration over speed",
                x: Abscissa::Over(SPEED),
                y: PEAK_LATERAL,
                series: lateral,
            },
            Panel {
                figure: "2.23",
                title: "Peak roll over peak lateral acceleration",
                x: Abscissa::Over(PEAK_LATERAL),
                y: PEAK_ROLL,
                series: roll,
            },
        ],
    })
}

/// Both figures with what the thesis prints about them.
fn beside(
    mut lateral: Vec<Series>,
    mut roll: Vec<Series>,
    gravity_mps2: f64,
) -> (Vec<Series>, Vec<Series>) {
    for (kind, name, kmh) in [
        (0, "thesis, lane change: 0.2 g at 90 km/h", 90.0),
        (1, "thesis, turn: 0.2 g at 50 km/h", 50.0),
    ] {
        let point = vec![[kmh * KMH, 0.2 * gravity_mps2]];
        lateral.push(Series::new(name, kind, point).printed());
    }
    let above = |p: &[f64; 2]| [p[0], p[1] + MORE_DEG.to_radians()];
    let more = roll[1].points.iter().map(above).collect();
    roll.push(Series::new("thesis, lane change: 0.28° above the turn", 0, more).printed());
    (lateral, roll)
}

/// Speed at which a rising series crosses a level, in km/h.
fn crossing_kmh(series: &Series, level: f64) -> Option<f64> {
    let pair = series.points.windows(2).find(|p| p[0][1] <= level && level < p[1][1])?;
    let share = (level - pair[0][1]) / (pair[1][1] - pair[0][1]);
    Some((pair[0][0] + share * (pair[1][0] - pair[0][0])) / KMH)
}

fn crossing(series: &Series, level: f64) -> String {
    let kmh = |x: f64| format!("{:.0} km/h", x / KMH);
    match (crossing_kmh(series, level), series.points.first(), series.points.last()) {
        (Some(kmh), ..) => format!("{kmh:.0} km/h"),
        (None, Some(first), _) if first[1] > level => format!("less than {}", kmh(first[0])),
        (None, _, Some(last)) => format!("more than {}", kmh(last[0])),
        _ => "no speed".to_owned(),
    }
}

/// Roll in the lane change minus that in the turn at equal lateral acceleration, where both exist.
fn difference_deg(roll: &[Series]) -> Option<(f64, usize)> {
    let (lane, turn) = (&roll[0], &roll[1]);
    let mut differences: Vec<f64> =
        lane.points.iter().map(|p| p[1] - turn.at(p[0])).filter(|d| d.is_finite()).collect();
    differences.extend(turn.points.iter().map(|p| lane.at(p[0]) - p[1]).filter(|d| d.is_finite()));
    #[allow(clippy::cast_precision_loss)] // a dozen
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    (count > 0.0).then(|| (mean.to_degrees(), differences.len()))
}

fn statements(setting: &Setting, lateral: &[Series], roll: &[Series]) -> Vec<Statement> {
    let limit = 0.2 * setting.vehicle.gravity_mps2;
    let (lane, turn) = (&lateral[0], &lateral[1]);
    let reached = crossing_kmh(turn, limit);
    let at_90 = lane.at(90.0 * KMH) / setting.vehicle.gravity_mps2;
    let difference = difference_deg(roll);
    vec![
        Statement {
            place: "Fig. 2.24",
            thesis: "0.2 g is exceeded at a much lower speed in the turn, which must stay below 50 km/h",
            ours: format!("0.2 g at {}", crossing(turn, limit)),
            measured: reached.unwrap_or(f64::NAN),
            unit: "km/h at 0.2 g",
            criterion: Criterion::around(50.0, 1.0, "the thesis's speeds are 1 km/h apart"),
            because: "the semitrailer overshoots by another amount",
        },
        Statement {
            place: "Fig. 2.24",
            thesis: "a lane change reaches 0.2 g at about 90 km/h",
            ours: format!("{at_90:.3} g at 90 km/h, 0.2 g at {}", crossing(lane, limit)),
            measured: crossing_kmh(lane, limit).unwrap_or(f64::NAN),
            unit: "km/h at 0.2 g",
            criterion: Criterion::around(
                90.0,
                5.0,
                "half of the 10 km/h between the thesis's speeds",
            ),
            because: DRIVER,
        },
        Statement {
            place: "Fig. 2.23",
            thesis: "at equal peak lateral acceleration the lane change rolls 0.28° more on average",
            ours: difference.map_or_else(
                || "no lateral acceleration in common".to_owned(),
                |(mean, count)| format!("{mean:+.2}° (mean of {count} points in common)"),
            ),
            measured: difference.map_or(f64::NAN, |(mean, _)| mean),
            unit: "°",
            criterion: Criterion::around(
                MORE_DEG,
                0.05,
                "the resolution of the thesis's tilt sensor",
            ),
            because: DRIVER,
        },
    ]
}
