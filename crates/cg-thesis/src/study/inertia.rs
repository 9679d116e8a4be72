//! Fig. 2.25: payloads of different shape, but equal mass and height.

use super::data::{Abscissa, Panel, Quantity, Series, Statement, Study, Unit};
use super::drive::{
    Course, Drive, LANE_CHANGE, LANE_SPEED_MPS, QUARTER, TURN_SPEED_MPS, trailer_roll,
};
use super::setting::{PEAK_ROLL, Setting, scenario};
use crate::verdict::Criterion;
use cg_vehicle::Vehicle;
use cg_vehicle::error::VehicleError;

const INERTIA: Quantity = Quantity {
    name: "payload_roll_inertia",
    label: "Roll inertia of the payload about its own c.g.",
    unit: Unit::KilogramSquareMeter,
};

/// The thesis's range of the payload's own roll inertia, in steps.
const PAYLOAD_KGM2: [f64; 6] = [10_000.0, 12_300.0, 14_600.0, 16_900.0, 19_200.0, 21_500.0];

/// A vehicle whose payload has the same height and mass, but a width that gives the requested roll
/// inertia; and the roll inertia of the sprung mass.
fn shaped(vehicle: &Vehicle, payload_kgm2: f64) -> Result<(Vehicle, f64), VehicleError> {
    let load = vehicle.reference_load();
    let mut point = vehicle.clone();
    // The same box without width: this is the part of the inertia that does not depend on the width.
    point.trailer.payload.width_m = 0.0;
    let plate = point.trailer_sprung_mass(load)?;
    let (tare, share) = (&vehicle.trailer.tare, plate.payload_kg / plate.mass_kg);
    let above_tare_m = (load.cg_height_m - tare.cg_height_m) / share.max(0.2);
    let of_tare =
        tare.roll_inertia_kgm2 + tare.sprung_mass_kg * share * above_tare_m * above_tare_m;
    let of_width = payload_kgm2 - (plate.roll_inertia_kgm2 - of_tare);
    point.trailer.payload.width_m = (12.0 * of_width.max(0.0) / plate.payload_kg).sqrt();
    let whole = point.trailer_sprung_mass(load)?.roll_inertia_kgm2;
    Ok((point, whole))
}

/// Fig. 2.25.
pub(super) fn study(setting: &Setting) -> Result<Study, VehicleError> {
    let base = Drive::turn(&setting.vehicle);
    let mut lines = scenario(setting, &base);
    lines.pop();
    lines.push(
        "turn of 90°, 100 m radius at 50 km/h; lane change of 20 m gate at 100 km/h".to_owned(),
    );
    let whole = |payload_kgm2| Ok::<_, VehicleError>(shaped(&setting.vehicle, payload_kgm2)?.1);
    let (least, most) = (PAYLOAD_KGM2[0], PAYLOAD_KGM2[PAYLOAD_KGM2.len() - 1]);
    lines.push(format!(
        "payload's own roll inertia varied through its width, {least:.0} to {most:.0} kg m²; that of \
         the sprung mass {:.0} to {:.0}",
        whole(least)?,
        whole(most)?
    ));
    let maneuvers: [(&str, Course, f64); 2] =
        [("turn", QUARTER, TURN_SPEED_MPS), ("lane change", LANE_CHANGE, LANE_SPEED_MPS)];
    let mut series = Vec::new();
    for (kind, (name, course, speed_mps)) in maneuvers.into_iter().enumerate() {
        let mut points = Vec::new();
        for payload_kgm2 in PAYLOAD_KGM2 {
            let (vehicle, _) = shaped(&setting.vehicle, payload_kgm2)?;
            let record = Drive::turn(&vehicle).along(course, speed_mps).run()?;
            lines.extend(record.rollover_remark(&format!("{name}, {payload_kgm2:.0} kg m²")));
            points.extend(record.peak(trailer_roll).map(|peak| [payload_kgm2, peak]));
        }
        series.push(Series::new(name, kind, points));
    }
    let change = |series: &Series| match (series.points.first(), series.points.last()) {
        (Some(a), Some(b)) => 100.0 * (b[1] / a[1] - 1.0),
        _ => f64::NAN,
    };
    let (turn, lane) = (change(&series[0]), change(&series[1]));
    Ok(Study {
        name: setting.name,
        finding: format!(
            "Over the shapes of the payload, the peak roll changes by {turn:+.1} % in the turn and by \
             {lane:+.1} % in the lane change"
        ),
        scenario: lines,
        statements: statements(turn, lane).to_vec(),
        panels: vec![Panel {
            figure: "2.25",
            title: "Peak roll over roll inertia",
            x: Abscissa::Over(INERTIA),
            y: PEAK_ROLL,
            series,
        }],
    })
}

/// A change of the peak roll that is rather none, in %.
const INSENSITIVE: Criterion =
    Criterion::between(-2.0, 2.0, "0.05° of 2.6°: the resolution of the thesis's tilt sensor");

/// What the thesis says of the change of the peak roll, in %, in the turn and in the lane change.
fn statements(turn: f64, lane: f64) -> [Statement; 2] {
    [
        Statement {
            place: "Fig. 2.25",
            thesis: "the peak in the turn is rather insensitive to roll inertia",
            ours: format!("{turn:+.2} % over the range"),
            measured: turn,
            unit: "%",
            criterion: INSENSITIVE,
            because: "the turn is not steady at its peak",
        },
        Statement {
            place: "Fig. 2.25",
            thesis: "the peak in the lane change is considerably sensitive",
            ours: format!("{lane:+.2} % over the range"),
            measured: lane,
            unit: "%",
            criterion: Criterion::between(
                INSENSITIVE.greatest,
                25.0,
                "more than is insensitive, and less than the part of the inertia in the sprung mass's",
            ),
            because: "the lane change is too slow for the roll mode",
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_gives_the_inertia_asked_for_and_no_other_mass() {
        let text = include_str!("../../fixtures/vehicles/baseline-tables.toml");
        let vehicle = Vehicle::parse(text, "baseline-tables.toml").unwrap();
        let load = vehicle.reference_load();
        let ranges = [10_000.0, 21_500.0].map(|kgm2| shaped(&vehicle, kgm2).unwrap());
        // The payload's own inertia differs by 11 500; everything else except the yaw inertia is equal.
        assert!((ranges[1].1 - ranges[0].1 - 11_500.0).abs() < 1e-6);
        let before = vehicle.trailer_sprung_mass(load).unwrap();
        for (vehicle, _) in &ranges {
            let after = vehicle.trailer_sprung_mass(load).unwrap();
            assert!((after.mass_kg - before.mass_kg).abs() < 1e-9);
            assert!((after.pitch_inertia_kgm2 - before.pitch_inertia_kgm2).abs() < 1e-6);
        }
    }
}
