//! Figs. 2.5, 2.6: how much each response grows when the payload's c.g. is raised by 200 mm.

use super::data::{Abscissa, Panel, Quantity, Response, Series, Statement, Study, Unit};
use super::drive::{Course, Drive, LANE_SPEED_MPS, QUARTER, Record, TURN_SPEED_MPS};
use super::setting::{Setting, scenario};
use crate::verdict::Criterion;
use cg_plant::plant::PlantSample;
use cg_vehicle::error::VehicleError;

/// Distance by which the payload's c.g. is raised.
const RAISED_M: f64 = 0.2;

type Of = fn(&PlantSample) -> f64;

/// Responses of the two units; those of the axles follow.
const UNITS: [(&str, Of, Unit); 9] = [
    ("semitrailer roll", |s| s.trailer.roll_rad, Unit::Radian),
    ("tractor roll", |s| s.tractor.roll_rad, Unit::Radian),
    ("load transfer ratio", |s| s.load_transfer_ratio, Unit::One),
    (
        "semitrailer lateral acceleration",
        |s| s.trailer.lateral_acceleration_mps2,
        Unit::MeterPerSecondSquared,
    ),
    (
        "tractor lateral acceleration",
        |s| s.tractor.lateral_acceleration_mps2,
        Unit::MeterPerSecondSquared,
    ),
    ("semitrailer yaw rate", |s| s.trailer.yaw_rate_radps, Unit::RadianPerSecond),
    ("tractor yaw rate", |s| s.tractor.yaw_rate_radps, Unit::RadianPerSecond),
    ("articulation", |s| s.articulation_rad, Unit::Radian),
    ("steer", |s| s.steer_rad, Unit::Radian),
];

const AXLES: [&str; 8] = [
    "axle 1 roll",
    "axle 2 roll",
    "axle 3 roll",
    "axle 4 roll",
    "axle 5 roll",
    "axle 6 roll",
    "axle 7 roll",
    "axle 8 roll",
];

const CHANGE: Quantity =
    Quantity { name: "relative_change", label: "Change of the peak", unit: Unit::One };

/// Fig. 2.5: turn.
pub(super) fn steady(setting: &Setting) -> Result<Study, VehicleError> {
    let of = Maneuver {
        figure: "2.5",
        title: "90° turn of 100 m radius at 50 km/h",
        course: QUARTER,
        speed_mps: TURN_SPEED_MPS,
    };
    raised(setting, &of)
}

/// Fig. 2.6: lane change.
pub(super) fn lane_change(setting: &Setting) -> Result<Study, VehicleError> {
    let of = Maneuver {
        figure: "2.6",
        title: "Lane change of 30 m gate length at 100 km/h",
        course: Course::LaneChange { gate_m: 30.0 },
        speed_mps: LANE_SPEED_MPS,
    };
    raised(setting, &of)
}

struct Maneuver {
    figure: &'static str,
    title: &'static str,
    course: Course,
    speed_mps: f64,
}

fn raised(setting: &Setting, maneuver: &Maneuver) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle).along(maneuver.course, maneuver.speed_mps);
    let sprung = base.vehicle.trailer_sprung_mass(base.load)?;
    let by_m = RAISED_M * sprung.payload_kg / sprung.mass_kg;
    let high = base.clone().at_height(base.load.cg_height_m + by_m);
    let mut responses = responses(&base.run()?, &high.run()?)?;
    let change = |r: &Response| r.after / r.before - 1.0;
    responses.sort_by(|a, b| change(b).total_cmp(&change(a)));
    #[allow(clippy::cast_precision_loss)] // a dozen
    let points = responses.iter().enumerate().map(|(k, r)| [k as f64, change(r)]).collect();

    let most = responses[0];
    let statements = vec![most_sensitive(maneuver, &responses), axles_next(maneuver, &responses)];
    let mut scenario_lines = scenario(setting, &base);
    scenario_lines.push(format!(
        "payload c.g. raised by {RAISED_M} m: sprung c.g. {:.3} to {:.3} m",
        base.load.cg_height_m, high.load.cg_height_m
    ));
    Ok(Study {
        name: setting.name,
        finding: format!(
            "With the payload's c.g. 200 mm higher the {} grows most: by {:.0} %",
            most.name,
            100.0 * change(&most)
        ),
        scenario: scenario_lines,
        panels: vec![Panel {
            figure: maneuver.figure,
            title: maneuver.title,
            x: Abscissa::Responses(responses),
            y: CHANGE,
            series: vec![Series::new("payload c.g. 200 mm higher", 0, points)],
        }],
        statements,
    })
}

fn responses(low: &Record, high: &Record) -> Result<Vec<Response>, VehicleError> {
    let fell = || VehicleError::Model("the vehicle rolled over: nothing to compare".to_owned());
    let mut found = Vec::new();
    for (name, of, unit) in UNITS {
        let (before, after) = (low.peak(of), high.peak(of));
        let (before, after) = before.zip(after).ok_or_else(fell)?;
        found.push(Response { name, before, after, unit });
    }
    let axles = low.samples.first().map_or(0, |s| s.axles().len());
    for (i, name) in AXLES.into_iter().take(axles).enumerate() {
        let of = |s: &PlantSample| s.axles()[i].roll_rad;
        let (before, after) = low.peak(of).zip(high.peak(of)).ok_or_else(fell)?;
        found.push(Response { name, before, after, unit: Unit::Radian });
    }
    Ok(found)
}

/// One response is ahead of another.
const NEXT: Criterion = Criterion::between(
    1.0,
    2.0,
    "more than the next one, and of its size: body and axles roll together",
);

/// The most sensitive response, by relative change (the order of `responses`) and, among roll angles, in
/// degrees.
fn most_sensitive(maneuver: &Maneuver, responses: &[Response]) -> Statement {
    let degrees = |r: &Response| (r.after - r.before).to_degrees();
    let mut rolls: Vec<&Response> = responses.iter().filter(|r| r.name.ends_with("roll")).collect();
    rolls.sort_by(|a, b| degrees(b).total_cmp(&degrees(a)));
    let first: Vec<String> = responses
        .iter()
        .take(3)
        .map(|r| format!("{} {:+.1} %", r.name, 100.0 * (r.after / r.before - 1.0)))
        .collect();
    let angles: Vec<String> =
        rolls.iter().take(2).map(|r| format!("{} {:+.2}°", r.name, degrees(r))).collect();
    // The least factor by which it is ahead of the others, in percent and in degrees.
    let own = |r: &&Response| r.name == UNITS[0].0;
    let factor = |of: &dyn Fn(&Response) -> f64, all: &[&Response]| {
        let others = all.iter().filter(|r| !own(r)).map(|r| of(r));
        let ours = all.iter().find(|r| own(r)).map_or(f64::NAN, |r| of(r));
        ours / others.fold(f64::NEG_INFINITY, f64::max)
    };
    let every: Vec<&Response> = responses.iter().collect();
    let change = |r: &Response| r.after / r.before - 1.0;
    let ahead = factor(&change, &every).min(factor(&degrees, &rolls));
    Statement {
        place: if maneuver.figure == "2.5" { "Fig. 2.5" } else { "Fig. 2.6" },
        thesis: "the semitrailer's roll angle is the most sensitive response",
        ours: format!("relative: {}; in degrees: {}", first.join(", "), angles.join(", ")),
        measured: ahead,
        unit: "times the next response, in percent or in degrees",
        criterion: NEXT,
        because: "another response grows more",
    }
}

fn axles_next(maneuver: &Maneuver, responses: &[Response]) -> Statement {
    let change = |r: &Response| r.after / r.before - 1.0;
    let others: Vec<&Response> = responses.iter().filter(|r| r.name != UNITS[0].0).collect();
    let last: Vec<&&Response> =
        others.iter().filter(|r| r.name == "axle 4 roll" || r.name == "axle 5 roll").collect();
    let listed: Vec<String> =
        others.iter().take(4).map(|r| format!("{} {:+.1} %", r.name, 100.0 * change(r))).collect();
    let rest = others.iter().filter(|r| !last.iter().any(|l| l.name == r.name));
    let least = last.iter().map(|r| change(r)).fold(f64::INFINITY, f64::min);
    let greatest = rest.map(|r| change(r)).fold(f64::NEG_INFINITY, f64::max);
    Statement {
        place: if maneuver.figure == "2.5" { "Fig. 2.5" } else { "Fig. 2.6" },
        thesis: "the roll angles of the trailer's axles follow",
        ours: format!("next: {}", listed.join(", ")),
        measured: least / greatest,
        unit: "times the next response",
        criterion: NEXT,
        because: "the roll angles of other axles grow more",
    }
}
