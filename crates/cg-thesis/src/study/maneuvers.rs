//! Figs. 2.7–2.15 and 2.17–2.22: turns through different angles, gates of different length.

use std::f64::consts::FRAC_PI_2;

use super::data::{Abscissa, Panel, Quantity, Series, Statement, Study, Unit};
use super::drive::{
    BEFORE_TURN_M, Course, Drive, LANE_SPEED_MPS, RADIUS_M as TURN_RADIUS_M, RUN_IN_M, Record,
    TURN_SPEED_MPS, trailer_lateral, trailer_roll,
};
use super::setting::{PEAK_LATERAL, Setting, scenario};
use crate::verdict::Criterion;
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

/// The turns, with the figures of their path and of their roll angles.
const TURNS: [(f64, &str, &str, &str); 3] = [
    (60.0, "2.8", "Fig. 2.8", "2.11"),
    (90.0, "2.9", "Fig. 2.9", "2.12"),
    (120.0, "2.10", "Fig. 2.10", "2.13"),
];

/// Figs. 2.7–2.15.
pub(super) fn cornering_angle(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    lines.pop();
    lines.push("turns to the left of 100 m radius at 50 km/h".to_owned());
    let (mut runs, mut statements) = (Vec::new(), Vec::new());
    let (mut paths, mut histories) = (Vec::new(), Vec::new());
    for (degrees, path_figure, place, roll_figure) in TURNS {
        let angle_rad = degrees.to_radians();
        let course = Course::Turn { angle_rad };
        let record = base.clone().along(course, TURN_SPEED_MPS).run()?;
        let name = format!("{degrees}°");
        lines.extend(record.rollover_remark(&name));
        let driven = on_course(course, angle_rad, &record, &name);
        if path_figure == "2.9" {
            statements.push(radius(&driven[0]));
            let whole =
                panel("2.7", "The turn of the studies", (ALONG, ASIDE), driven[..1].to_vec());
            paths.insert(0, whole);
        }
        statements.push(heading(place, degrees, &driven[0]));
        paths.push(panel(
            path_figure,
            "Path and the tractor's c.g. on it",
            (ALONG, ASIDE),
            driven.into(),
        ));
        let rolled = rolls(&name, 0, &record).into();
        histories.push(panel(roll_figure, "Roll angles over time", (TIME, ROLL), rolled));
        runs.push((angle_rad, record));
    }
    let (lateral, roll) = (peaks(&runs, LATERAL), peaks(&runs, ROLLS));
    statements.extend(alike(setting, &lateral, &roll));
    let first = |series: &[Series]| series[0].points.first().map_or(f64::NAN, |p| p[1]);
    let finding = format!(
        "The peaks do not depend on the cornering angle: {:.2} g and {:.2}° of semitrailer roll at \
         each of 60°, 90° and 120°",
        first(&lateral) / setting.vehicle.gravity_mps2,
        first(&roll).to_degrees()
    );
    let mut lateral = lateral;
    lateral.push(target(setting, FRAC_PI_2));
    let mut panels = paths;
    panels.extend(histories);
    panels.push(panel("2.14", "Peak lateral acceleration", (ANGLE, PEAK_LATERAL), lateral));
    panels.push(panel("2.15", "Peak roll angle", (ANGLE, PEAK_ROLL), roll));
    Ok(Study { name: setting.name, finding, scenario: lines, statements, panels })
}

/// Number of points on the arc of a turn, and on each straight part beside it.
const ARC: u32 = 60;
const BESIDE: u32 = 15;

/// The center line of a turn and the path of the tractor's c.g. on it.
fn on_course(course: Course, angle_rad: f64, record: &Record, name: &str) -> [Series; 2] {
    let arc_m = TURN_RADIUS_M * angle_rad;
    let path = course.path();
    let step_m = arc_m / f64::from(ARC);
    let at = |k: u32| path.point(BEFORE_TURN_M + step_m * (f64::from(k) - f64::from(BESIDE)));
    let center = (0..=ARC + 2 * BESIDE).map(at).collect();
    let driven = record.samples.iter().step_by(10).map(|s| s.position_m).collect();
    [
        Series::new(format!("center line, {name}"), 0, center),
        Series::new(format!("tractor, {name}"), 1, driven).aside(),
    ]
}

/// The radius of the circle through the ends and the middle of a turn's arc.
fn radius(center: &Series) -> Statement {
    let [first, last] = [BESIDE, BESIDE + ARC].map(|k| k as usize);
    let [a, b, c] = [first, usize::midpoint(first, last), last].map(|k| center.points[k]);
    let side = |p: [f64; 2], q: [f64; 2]| libm::hypot(p[0] - q[0], p[1] - q[1]);
    let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs();
    let radius_m = side(a, b) * side(b, c) * side(c, a) / (4.0 * area);
    Statement {
        place: "Fig. 2.7",
        thesis: "the road of the turning maneuver has a radius of 100 m",
        ours: format!("{radius_m:.1} m through the ends and the middle of the arc"),
        measured: radius_m,
        unit: "m",
        criterion: Criterion::around(100.0, 0.5, "half a unit of the last digit"),
        because: "the path is another one",
    }
}

/// The angle through which a center line turns.
fn heading(place: &'static str, degrees: f64, center: &Series) -> Statement {
    let direction =
        |pair: &[[f64; 2]]| libm::atan2(pair[1][1] - pair[0][1], pair[1][0] - pair[0][0]);
    let ends = center.points.first_chunk::<2>().zip(center.points.last_chunk::<2>());
    let turned = ends.map_or(f64::NAN, |(a, b)| (direction(b) - direction(a)).to_degrees());
    Statement {
        place,
        thesis: "the path turns by the cornering angle",
        ours: format!("by {turned:.1}°, to be {degrees}°"),
        measured: turned,
        unit: "°",
        criterion: Criterion::around(degrees, 0.5, "half a unit of the last digit"),
        because: "the path is another one",
    }
}

/// Figs. 2.14, 2.15.
fn alike(setting: &Setting, lateral: &[Series], roll: &[Series]) -> [Statement; 2] {
    let (by_lateral, by_roll) = (spread(&lateral[0].values()), spread(&roll[0].values()));
    let g = setting.vehicle.gravity_mps2;
    let first = |series: &[Series]| series[0].points.first().map_or(f64::NAN, |p| p[1]);
    let statement = |place, thesis, ours, spread: f64| Statement {
        place,
        thesis,
        ours,
        measured: spread,
        unit: "of the mean, between the greatest and the least",
        criterion: Criterion::between(0.0, 0.01, "the printed bars show two digits"),
        because: "the peak comes after the end of the shortest turn",
    };
    [
        statement(
            "Fig. 2.14",
            "the cornering angle does not change the peak lateral acceleration",
            format!("{:.3} g, spread {:.2} %", first(lateral) / g, 100.0 * by_lateral),
            by_lateral,
        ),
        statement(
            "Fig. 2.15",
            "the cornering angle does not change the peak roll angle of the semitrailer",
            format!("{:.2}°, spread {:.2} %", first(roll).to_degrees(), 100.0 * by_roll),
            by_roll,
        ),
    ]
}

/// The lateral acceleration of both maneuvers that the thesis prints.
fn target(setting: &Setting, at: f64) -> Series {
    let point = vec![[at, 0.2 * setting.vehicle.gravity_mps2]];
    Series::new("thesis: about 0.2 g", 0, point).printed()
}

fn panel(
    figure: &'static str,
    title: &'static str,
    (x, y): (Quantity, Quantity),
    series: Vec<Series>,
) -> Panel {
    Panel { figure, title, x: Abscissa::Over(x), y, series }
}

/// The lane changes, with the figures of their path and of their roll angles.
const GATES: [(f64, &str, &str, &str); 2] =
    [(20.0, "2.17", "Fig. 2.17", "2.19"), (30.0, "2.18", "Fig. 2.18", "2.20")];

/// Figs. 2.17–2.22.
pub(super) fn gate_length(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    lines.pop();
    lines.push("lane changes of 3.65 m to the left at 100 km/h".to_owned());
    let (mut runs, mut statements) = (Vec::new(), Vec::new());
    let (mut paths, mut histories) = (Vec::new(), Vec::new());
    for (gate_m, path_figure, place, roll_figure) in GATES {
        let course = Course::LaneChange { gate_m };
        let record = base.clone().along(course, LANE_SPEED_MPS).run()?;
        let name = format!("{gate_m} m");
        lines.extend(record.rollover_remark(&name));
        let path = course.path();
        let on_road = |[x, y]: [f64; 2]| [x - RUN_IN_M, y];
        let points =
            (0..=800).map(|k| on_road(path.point(RUN_IN_M + 0.1 * f64::from(k)))).collect();
        let center = Series::new(format!("path, {name}"), 0, points);
        statements.push(gate(place, gate_m, &center));
        let driven = record.samples.iter().map(|s| on_road(s.position_m));
        let near = driven.filter(|[x, _]| (0.0..=80.0).contains(x)).collect();
        let near = Series::new(format!("tractor, {name}"), 1, near).aside();
        let title = "Path and the tractor's c.g. on it";
        paths.push(panel(path_figure, title, (ALONG, ASIDE), vec![center, near]));
        let rolled = rolls(&name, 0, &record).into();
        histories.push(panel(roll_figure, "Roll angles over time", (TIME, ROLL), rolled));
        runs.push((gate_m, record));
    }
    let (mut lateral, roll) = (peaks(&runs, LATERAL), peaks(&runs, ROLLS));
    statements.extend(gate_statements(setting, &lateral, &roll));
    let finding = gate_finding(setting, &lateral, &roll);
    lateral.push(target(setting, 20.0));
    let mut panels = paths;
    panels.extend(histories);
    panels.push(panel("2.21", "Peak lateral acceleration", (GATE, PEAK_LATERAL), lateral));
    panels.push(panel("2.22", "Peak roll angle", (GATE, PEAK_ROLL), roll));
    Ok(Study { name: setting.name, finding, scenario: lines, statements, panels })
}

/// The length over which a path changes the lane (eq. 2.5): from 0.1 % of the lane's width to 99.9 %,
/// which a sine does within 96 % of the gate.
fn gate(place: &'static str, gate_m: f64, center: &Series) -> Statement {
    let width_m = center.points.last().map_or(f64::NAN, |p| p[1]);
    let reached = |share: f64| {
        let point = center.points.iter().find(|p| p[1] >= share * width_m);
        point.map_or(f64::NAN, |p| p[0])
    };
    let length_m = (reached(0.999) - reached(0.001)) / 0.96;
    Statement {
        place,
        thesis: "the path of eq. 2.5 changes the lane by 3.65 m within the gate",
        ours: format!("{width_m:.2} m within {length_m:.1} m, to be {gate_m} m"),
        measured: if (width_m - 3.65).abs() < 5e-3 { length_m } else { f64::NAN },
        unit: "m",
        criterion: Criterion::around(gate_m, 0.5, "half a unit of the last digit"),
        because: "the path is another one",
    }
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
            measured: short_g,
            unit: "g",
            criterion: Criterion::around(0.2, 0.02, "\"about\": a tenth"),
            because: "the driver model of the thesis's program is not described",
        },
        Statement {
            place: "Fig. 2.22",
            thesis: "a shorter gate makes the semitrailer roll more",
            ours: format!("{short_deg:.2}° at 20 m, {long_deg:.2}° at 30 m"),
            measured: short_deg / long_deg,
            unit: "times the roll of the longer gate",
            criterion: Criterion::between(
                1.01,
                2.25,
                "more, and no more than the lateral acceleration of the path, which is (30/20)²",
            ),
            because: "the driver cuts the shorter gate",
        },
    ]
}
