//! Figs. 2.28, 2.29: lateral and longitudinal shift of the payload.

use super::data::{Abscissa, Panel, Quantity, Series, Statement, Study, Unit};
use super::drive::{Drive, peak_rolls, trailer_roll};
use super::setting::{PEAK_ROLL, Setting, per_meter_deg, scenario};
use crate::verdict::Criterion;
use cg_plant::plant::YawRollPlant;
use cg_vehicle::error::VehicleError;

const OUTWARD: Quantity = Quantity {
    name: "payload_to_right",
    label: "Payload's c.g. to the right (outside of the turn)",
    unit: Unit::Meter,
};
const REARWARD: Quantity = Quantity {
    name: "payload_rearward",
    label: "Rearward shift of the payload's c.g.",
    unit: Unit::Meter,
};

const LATERAL_M: [f64; 9] = [-0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4];
const LONGITUDINAL_M: [f64; 11] = [-0.5, -0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5];

fn place(shift_m: f64, where_to: &str) -> String {
    format!("payload {:+.0} mm {where_to}", 1000.0 * shift_m)
}

fn beside(base: &Drive, right_m: f64) -> Drive {
    let mut drive = base.clone();
    drive.options.payload_left_m = -right_m;
    drive
}

/// Fig. 2.28.
pub(super) fn lateral(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    let turn = peak_rolls(
        &LATERAL_M,
        &mut lines,
        |right_m| place(right_m, "to the right"),
        |right_m| beside(&base, right_m),
    )?;
    let mut straight = Vec::new();
    for right_m in LATERAL_M {
        let drive = beside(&base, right_m);
        let plant = YawRollPlant::new(&drive.vehicle, drive.load, &drive.options)?;
        straight.push([right_m, trailer_roll(&plant.start(drive.speed_mps)?.sample())]);
    }
    let straight = Series::new("straight road", 0, straight);
    let turn = Series::new("90° turn, peak", 1, turn);
    let between = turn.points.iter().map(|p| [p[0], p[1] - straight.at(p[0])]).collect();
    let between = Series::new("difference", 2, between).aside();
    let slope = per_meter_deg((straight.at(0.2) - straight.at(-0.2)) / 0.4) / 10.0;
    let before = match turn.points.last() {
        Some(last) if last[0] < 0.39 => format!("; rollover beyond {:.0} mm", 1000.0 * last[0]),
        _ => String::new(),
    };
    Ok(Study {
        name: setting.name,
        finding: format!(
            "Each 100 mm of lateral shift rolls the semitrailer by {slope:.1}° on a straight road, and \
             by more with a shift to the outside of a turn{before}"
        ),
        scenario: lines,
        statements: lateral_statements(&straight, &turn, &between),
        panels: vec![Panel {
            figure: "2.28",
            title: "Roll over lateral shift of the payload",
            x: Abscissa::Over(OUTWARD),
            y: Quantity {
                name: "trailer_roll",
                label: "Roll angle of the semitrailer",
                unit: Unit::Radian,
            },
            series: vec![turn, straight, between],
        }],
    })
}

/// The least and the greatest of a series within a range.
fn bounds(series: &Series, from: f64, to: f64) -> (f64, f64) {
    let within = series.points.iter().filter(|p| from - 1e-9 <= p[0] && p[0] <= to + 1e-9);
    within.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), p| {
        (least.min(p[1]), most.max(p[1]))
    })
}

fn lateral_statements(straight: &Series, turn: &Series, between: &Series) -> Vec<Statement> {
    let slope = |series: &Series, from: f64, to: f64| {
        per_meter_deg((series.at(to) - series.at(from)) / (to - from)) / 10.0
    };
    let on_straight = slope(straight, -0.2, 0.2);
    let (inside, outside) = (slope(turn, -0.2, 0.0), slope(turn, 0.0, 0.2));
    let rising = |s: &Series| s.points.windows(2).all(|p| p[0][1] < p[1][1]);
    let farther =
        |a: f64, b: f64| if (b - 1.0).abs() > (a - 1.0).abs() || a == 0.0 { b } else { a };
    vec![
        Statement {
            place: "Fig. 2.28",
            thesis: "the roll angle is very sensitive to lateral shift",
            ours: format!(
                "{on_straight:.2}° per 100 mm straight ahead, as much as {:.0} mm of c.g. height \
                 at 4.1°/m",
                on_straight / 4.1e-3
            ),
            measured: if rising(straight) && rising(turn) { on_straight } else { 0.0 },
            unit: "° per 100 mm",
            criterion: Criterion::between(
                0.3,
                2.0,
                "six times what the thesis's tilt sensor resolves, and no rollover within 100 mm",
            ),
            because: "the roll angle does not grow with the shift everywhere",
        },
        Statement {
            place: "Fig. 2.28",
            thesis: "the peak in the turn is asymmetric",
            ours: format!(
                "{inside:.2}° per 100 mm to the inside, {outside:.2}° to the outside (±200 mm)"
            ),
            measured: outside / inside,
            unit: "times the slope to the inside",
            criterion: Criterion::between(1.1, 3.0, "more than a tenth, short of a rollover"),
            because: "both sides are alike, or the vehicle is about to roll over",
        },
        Statement {
            place: "Fig. 2.28",
            thesis: "the roll angle changes similarly straight ahead and in the turn",
            ours: format!(
                "{on_straight:.2}° per 100 mm straight ahead; in the turn {inside:.2}° to the inside, \
                 {outside:.2}° to the outside, where the inner springs lose their load"
            ),
            measured: [inside, outside]
                .map(|slope| slope / on_straight)
                .into_iter()
                .fold(0.0, farther),
            unit: "times the slope straight ahead, within ±200 mm",
            criterion: Criterion::between(0.75, 1.25, "roughly the same: a quarter"),
            because: "the inner springs lose their load with a shift to the outside of a turn",
        },
        constant(between),
    ]
}

/// The difference between turn and straight road.
fn constant(between: &Series) -> Statement {
    let degrees = |(least, most): (f64, f64)| (least.to_degrees(), most.to_degrees());
    let inner = degrees(bounds(between, -0.3, 0.0));
    let outer = degrees(bounds(between, 0.0, 0.4));
    let all = degrees(bounds(between, -0.4, 0.4));
    let reached_mm = 1000.0 * between.points.last().map_or(f64::NAN, |p| p[0]);
    Statement {
        place: "Fig. 2.28",
        thesis: "the difference between both varies little",
        ours: format!(
            "{:.2} to {:.2}° up to 300 mm to the inside, {:.2}° at 400 mm; to the outside up to \
             {:.2}° at {reached_mm:.0} mm",
            inner.0,
            inner.1,
            between.at(-0.4).to_degrees(),
            outer.1
        ),
        measured: (all.1 - all.0) / inner.0,
        unit: "of the difference at the inside, between the greatest and the least",
        criterion: Criterion::between(0.0, 0.25, "nearly constant: a quarter"),
        because: "one side's springs lose their load: in the turn with a shift to the outside, which \
                  ends in a rollover, and straight ahead with 400 mm to the inside",
    }
}

/// Fig. 2.29.
pub(super) fn longitudinal(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    let points = peak_rolls(
        &LONGITUDINAL_M,
        &mut lines,
        |behind_m| place(behind_m, "rearward"),
        |behind_m| {
            let mut drive = base.clone();
            drive.options.payload_behind_m = behind_m;
            drive.options.design_load = Some(base.load);
            drive
        },
    )?;
    let series = Series::new(setting.vehicle.name.clone(), 0, points);
    let values = series.values();
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = series.points.iter().min_by(|a, b| a[1].total_cmp(&b[1]));
    let [at_m, least] = least.copied().unwrap_or([f64::NAN; 2]);
    let spread_deg = (most - least).to_degrees();
    let share = (most - least) / series.at(0.0);
    Ok(Study {
        name: setting.name,
        finding: format!(
            "A shift of half a meter forward or rearward changes the peak roll by at most \
             {spread_deg:.3}°, {:.1} % of it",
            100.0 * share
        ),
        scenario: lines,
        statements: longitudinal_statements([spread_deg, share, least, at_m]).to_vec(),
        panels: vec![Panel {
            figure: "2.29",
            title: "Peak roll over longitudinal shift of the payload",
            x: Abscissa::Over(REARWARD),
            y: PEAK_ROLL,
            series: vec![series],
        }],
    })
}

/// The spread of the peaks in degrees and as a share, the least one, and its place.
fn longitudinal_statements([spread_deg, share, least, at_m]: [f64; 4]) -> [Statement; 2] {
    [
        Statement {
            place: "Fig. 2.29",
            thesis: "the roll angle is not sensitive to longitudinal shift",
            ours: format!("{spread_deg:.3}° between the greatest and the least peak over ±500 mm"),
            measured: share,
            unit: "of the peak, between the greatest and the least",
            criterion: Criterion::between(
                0.0,
                0.02,
                "0.05° of 2.6°: what the thesis's tilt sensor resolves",
            ),
            because: "axles that carry more roll more",
        },
        Statement {
            place: "Fig. 2.29",
            thesis: "the least roll is close to the position of the tare's c.g.",
            ours: format!("least roll {:.3}° at {:+.0} mm", least.to_degrees(), 1000.0 * at_m),
            measured: at_m,
            unit: "m behind the tare's c.g.",
            criterion: Criterion::around(0.0, 0.25, "\"close\": half of the shifts"),
            because: "the axle loads differ from the thesis's",
        },
    ]
}
