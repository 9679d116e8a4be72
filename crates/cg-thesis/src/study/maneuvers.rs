//! Figs. 2.11–2.15 and 2.17–2.22: turns through different angles, gates of different length.

use super::data::{Abscissa, Panel, Quantity, Series, Statement, Study, Unit};
use super::drive::{
    Course, Drive, LANE_SPEED_MPS, RUN_IN_M, Record, TURN_SPEED_MPS, trailer_lateral, trailer_roll,
};
use super::setting::{PEAK_LATERAL, Setting, scenario};
use cg_plant::plant::PlantSample;
use cg_vehicle::error::VehicleError;

const TIME: Quantity = Quantity { name: "time", label: "Time", unit: Unit::Second };
const ROLL: Quantity = Quantity { name: "roll", label: "Roll angle", unit: Unit::Radian };
const ANGLE: Quantity =
    Quantity { name: "cornering_angle", label: "Cornering angle", unit: Unit::Radian };
const GATE: Quantity = Quantity { name: "gate_length", label: "Gate length", unit: Unit::Meter };
const ALONG: Quantity =
    Quantity { name: "along_road", label: "Distance along the road", unit: Unit::Meter };
const ASIDE: Quantity =
    Quantity { name: "to_left", label: "Distance to the left", unit: Unit::Meter };

/// Peak roll of either unit.
const PEAK_ROLL: Quantity =
    Quantity { name: "peak_roll", label: "Peak roll angle", unit: Unit::Radian };

/// The units; the flag marks the secondary series.
const UNITS: [(&str, bool); 2] = [("semitrailer", false), ("tractor", true)];

fn rolls(name: &str, kind: usize, record: &Record) -> [Series; 2] {
    let tractor = |s: &PlantSample| s.tractor.roll_rad;
    [
        Series::new(format!("semitrailer, {name}"), kind, record.history(trailer_roll)),
        Series::new(format!("tractor, {name}"), kind, record.history(tractor)).aside(),
    ]
}

/// Peaks of both units over a parameter.
fn peaks(runs: &[(f64, Record)], of: [fn(&PlantSample) -> f64; 2]) -> Vec<Series> {
    let both = UNITS.into_iter().zip(of).enumerate();
    both.map(|(kind, ((name, aside), of))| {
        let peak = |(value, record): &(f64, Record)| Some([*value, record.peak(of)?]);
        let series = Series::new(name, kind, runs.iter().filter_map(peak).collect());
        if aside { series.aside() } else { series }
    })
    .collect()
}

const LATERAL: [fn(&PlantSample) -> f64; 2] =
    [trailer_lateral, |s| s.tractor.lateral_acceleration_mps2];
const ROLLS: [fn(&PlantSample) -> f64; 2] = [trailer_roll, |s| s.tractor.roll_rad];

/// Spread of values divided by their mean.
fn spread(values: &[f64]) -> f64 {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    2.0 * (most - least) / (most + least)
}

/// Figs. 2.11–2.15.
pub(super) fn cornering_angle(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    lines.pop();
    lines.push("turns to the left of 100 m radius at 50 km/h".to_owned());
    let (mut runs, mut histories) = (Vec::new(), Vec::new());
    for (kind, degrees) in [60.0_f64, 90.0, 120.0].into_iter().enumerate() {
        let angle_rad = degrees.to_radians();
        let record = base.clone().along(Course::Turn { angle_rad }, TURN_SPEED_MPS).run()?;
        lines.extend(record.rollover_remark(&format!("{degrees}°")));
        histories.extend(rolls(&format!("{degrees}°"), kind, &record));
        runs.push((angle_rad, record));
    }
    let (lateral, roll) = (peaks(&runs, LATERAL), peaks(&runs, ROLLS));
    let (by_lateral, by_roll) = (spread(&lateral[0].values()), spread(&roll[0].values()));
    let g = setting.vehicle.gravity_mps2;
    let first = |series: &[Series]| series[0].points.first().map_or(f64::NAN, |p| p[1]);
    let statement = |place, thesis, ours, spread: f64| Statement {
        place,
        thesis,
        ours,
        // The printed bars show two digits.
        agrees: spread < 0.01,
    };
    Ok(Study {
        name: setting.name,
        finding: format!(
            "The peaks do not depend on the cornering angle: {:.2} g and {:.2}° of semitrailer roll at \
             each of 60°, 90° and 120°",
            first(&lateral) / g,
            first(&roll).to_degrees()
        ),
        scenario: lines,
        statements: vec![
            statement(
                "Fig. 2.14",
                "the cornering angle does not change the peak lateral acceleration",
                format!("{:.3} g, spread {:.2} %", first(&lateral) / g, 100.0 * by_lateral),
                by_lateral,
            ),
            statement(
                "Fig. 2.15",
                "the cornering angle does not change the peak roll angle of the semitrailer",
                format!("{:.2}°, spread {:.2} %", first(&roll).to_degrees(), 100.0 * by_roll),
                by_roll,
            ),
        ],
        panels: vec![
            panel("2.11-2.13", "Roll angles over time", (TIME, ROLL), histories),
            panel("2.14", "Peak lateral acceleration", (ANGLE, PEAK_LATERAL), lateral),
            panel("2.15", "Peak roll angle", (ANGLE, PEAK_ROLL), roll),
        ],
    })
}

fn panel(
    figure: &'static str,
    title: &'static str,
    (x, y): (Quantity, Quantity),
    series: Vec<Series>,
) -> Panel {
    Panel { figure, title, x: Abscissa::Over(x), y, series }
}

/// Figs. 2.17–2.22.
pub(super) fn gate_length(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    lines.pop();
    lines.push("lane changes of 3.65 m to the left at 100 km/h".to_owned());
    let (mut runs, mut histories, mut paths) = (Vec::new(), Vec::new(), Vec::new());
    for (kind, gate_m) in [20.0_f64, 30.0].into_iter().enumerate() {
        let course = Course::LaneChange { gate_m };
        let drive = base.clone().along(course, LANE_SPEED_MPS);
        let record = drive.run()?;
        let name = format!("{gate_m} m");
        lines.extend(record.rollover_remark(&name));
        histories.extend(rolls(&name, kind, &record));
        let path = course.path();
        let on_road = |[x, y]: [f64; 2]| [x - RUN_IN_M, y];
        let points = (0..=80).map(|k| on_road(path.point(RUN_IN_M + f64::from(k)))).collect();
        paths.push(Series::new(format!("path, {name}"), kind, points));
        let driven = record.samples.iter().map(|s| on_road(s.position_m));
        let near = driven.filter(|[x, _]| (0.0..=80.0).contains(x)).collect();
        paths.push(Series::new(format!("tractor, {name}"), kind, near).aside());
        runs.push((gate_m, record));
    }
    let (lateral, roll) = (peaks(&runs, LATERAL), peaks(&runs, ROLLS));
    Ok(Study {
        name: setting.name,
        finding: gate_finding(setting, &lateral, &roll),
        scenario: lines,
        statements: gate_statements(setting, &lateral, &roll),
        panels: vec![
            Panel {
                figure: "2.17-2.18",
                title: "Paths and the tractor's c.g. on them",
                x: Abscissa::Over(ALONG),
                y: ASIDE,
                series: paths,
            },
            Panel {
                figure: "2.19-2.20",
                title: "Roll angles over time",
                x: Abscissa::Over(TIME),
                y: ROLL,
                series: histories,
            },
            Panel {
                figure: "2.21",
                title: "Peak lateral acceleration",
                x: Abscissa::Over(GATE),
                y: PEAK_LATERAL,
                series: lateral,
            },
            Panel {
                figure: "2.22",
                title: "Peak roll angle",
                x: Abscissa::Over(GATE),
                y: PEAK_ROLL,
                series: roll,
            },
        ],
    })
}

/// The semitrailer's peaks at 20 and 30 m, in g and degrees.
fn gate_peaks(setting: &Setting, lateral: &[Series], roll: &[Series]) -> [f64; 4] {
    let g = setting.vehicle.gravity_mps2;
    let at = |series: &[Series], gate_m: f64| series[0].at(gate_m);
    [
        at(lateral, 20.0) / g,
        at(lateral, 30.0) / g,
        at(roll, 20.0).to_degrees(),
        at(roll, 30.0).to_degrees(),
    ]
}

fn gate_finding(setting: &Setting, lateral: &[Series], roll: &[Series]) -> String {
    let [short_g, long_g, short_deg, long_deg] = gate_peaks(setting, lateral, roll);
    format!(
        "The shorter gate has higher peaks: {short_g:.3} g and {short_deg:.2}° of semitrailer roll \
         compared with {long_g:.3} g and {long_deg:.2}°"
    )
}

fn gate_statements(setting: &Setting, lateral: &[Series], roll: &[Series]) -> Vec<Statement> {
    let [short_g, long_g, short_deg, long_deg] = gate_peaks(setting, lateral, roll);
    vec![
        Statement {
            place: "Fig. 2.21",
            thesis: "a gate of 20 m gives a lateral acceleration of about 0.2 g",
            ours: format!("{short_g:.3} g (30 m: {long_g:.3} g)"),
            agrees: (short_g - 0.2).abs() < 0.02,
        },
        Statement {
            place: "Fig. 2.22",
            thesis: "a shorter gate makes the semitrailer roll more",
            ours: format!("{short_deg:.2}° at 20 m, {long_deg:.2}° at 30 m"),
            agrees: short_deg > long_deg,
        },
    ]
}
