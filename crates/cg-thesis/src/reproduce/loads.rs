//! Static balance and loads at rest: figures 2.1–2.4, Table 2.9.
//!
//! Each is computed in both directions: eqs. 2.1–2.4 give the load and position of the fifth wheel from
//! the printed loads, and [`static_balance`] gives the loads from the printed masses and positions.

use serde::Deserialize;

use super::baseline::{Baseline, Options};
use super::nonlinear::measured;
use super::printed::{Printed, thesis, values};
use super::row::Row;
use cg_plant::plant::{PlantOptions, YawRollPlant};
use cg_vehicle::balance::{StaticBalance, static_balance};
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Vehicle};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Loads {
    hitch_load_kn: Option<Printed>,
    tractor: Unit,
    trailer: Unit,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unit {
    axle_m: Vec<Printed>,
    hitch_m: Printed,
    unsprung_kn: Vec<Printed>,
    sprung_kn: Printed,
    load_kn: Vec<Printed>,
}

impl Unit {
    /// The load on the fifth wheel that balances the unit's weight (eqs. 2.1 and 2.3).
    fn hitch_load_kn(&self, side: f64) -> f64 {
        let carried: f64 = values(&self.load_kn).iter().sum();
        let weight = self.sprung_kn.value + values(&self.unsprung_kn).iter().sum::<f64>();
        side * (carried - weight)
    }

    /// Position of that load, from the sprung c.g. (eqs. 2.2 and 2.4); `ahead` axles first.
    fn hitch_m(&self, side: f64, ahead: usize) -> f64 {
        let moment: f64 = (0..self.axle_m.len())
            .map(|i| {
                let suspension_kn = self.load_kn[i].value - self.unsprung_kn[i].value;
                suspension_kn * self.axle_m[i].value * if i < ahead { -1.0 } else { 1.0 }
            })
            .sum();
        moment / self.hitch_load_kn(side)
    }
}

/// The baseline with the printed weights and positions.
fn printed_vehicle(vehicle: &Vehicle, loads: &Loads) -> (Vehicle, Load) {
    let mut vehicle = vehicle.clone();
    let kg_per_kn = 1e3 / vehicle.gravity_mps2;
    let (tractor, trailer) = (&mut vehicle.tractor, &mut vehicle.trailer);
    tractor.sprung_mass_kg = loads.tractor.sprung_kn.value * kg_per_kn;
    tractor.hitch_behind_cg_m = loads.tractor.hitch_m.value;
    for (i, axle) in tractor.axle.iter_mut().enumerate() {
        let side = if i == 0 { 1.0 } else { -1.0 };
        axle.ahead_of_cg_m = side * loads.tractor.axle_m[i].value;
        axle.axle.unsprung_mass_kg = loads.tractor.unsprung_kn[i].value * kg_per_kn;
    }
    let cg_m = loads.trailer.hitch_m.value;
    trailer.tare.cg_behind_hitch_m = cg_m;
    trailer.payload.behind_hitch_m = cg_m;
    for (i, axle) in trailer.axle.iter_mut().enumerate() {
        axle.behind_hitch_m = cg_m + loads.trailer.axle_m[i].value;
        axle.axle.unsprung_mass_kg = loads.trailer.unsprung_kn[i].value * kg_per_kn;
    }
    let unsprung_kn: f64 = values(&loads.trailer.unsprung_kn).iter().sum();
    let trailer_mass_kg = (loads.trailer.sprung_kn.value + unsprung_kn) * kg_per_kn;
    (vehicle.clone(), Load { trailer_mass_kg, ..vehicle.reference_load() })
}

const FROM_LOADS: &str =
    "from the printed loads and positions, whose rounding alone explains 0.004 kN or 1 mm";
const FROM_MASSES: &str = "from the printed weights and positions, by the project's static balance";

struct Case {
    loads: Loads,
    balance: StaticBalance,
}

impl Case {
    fn new(base: &Baseline, loads: Loads) -> Result<Self, VehicleError> {
        if loads.tractor.axle_m.len() != 3 || loads.trailer.axle_m.len() != 2 {
            return Err(VehicleError::Model("fixtures/thesis: three axles and two".to_owned()));
        }
        let (vehicle, load) = printed_vehicle(&base.vehicle, &loads);
        let balance = static_balance(&vehicle, load)?;
        Ok(Self { loads, balance })
    }

    fn hitch_load(&self, table: &'static str, equation: &str, ours_kn: f64, note: &str) -> Row {
        let item = format!("fifth-wheel load, kN ({equation})");
        match &self.loads.hitch_load_kn {
            Some(printed) => Row::beside(table, item, printed, ours_kn).noted(note),
            None => Row::ours(table, item, ours_kn, format!("not printed; {note}")),
        }
    }

    fn tractor(&self, table: &'static str) -> Vec<Row> {
        let unit = &self.loads.tractor;
        let hitch_m = unit.hitch_m(1.0, 1);
        let mut rows = vec![
            self.hitch_load(table, "eq. 2.1", unit.hitch_load_kn(1.0), FROM_LOADS),
            Row::beside(table, "X_sc1, m (eq. 2.2)", &unit.hitch_m, hitch_m).noted(FROM_LOADS),
        ];
        rows.extend(self.axles(table, &unit.load_kn, 0));
        rows
    }

    fn trailer(&self, table: &'static str) -> Vec<Row> {
        let unit = &self.loads.trailer;
        let hitch_m = unit.hitch_m(-1.0, 0);
        let solved_kn = self.balance.hitch_load_n / 1e3;
        let mut rows = vec![
            self.hitch_load(table, "eq. 2.3", unit.hitch_load_kn(-1.0), FROM_LOADS),
            Row::beside(table, "X_sc2, m (eq. 2.4)", &unit.hitch_m, hitch_m).noted(FROM_LOADS),
            self.hitch_load(table, "both units", solved_kn, FROM_MASSES),
        ];
        rows.extend(self.axles(table, &unit.load_kn, 3));
        rows
    }

    fn axles(&self, table: &'static str, printed: &[Printed], first: usize) -> Vec<Row> {
        let ours = self.balance.axle_load_n.iter().skip(first);
        let beside = |(i, (printed, load_n)): (usize, (&Printed, &f64))| {
            let item = format!("axle {} load, kN", first + i + 1);
            Row::beside(table, item, printed, load_n / 1e3).noted(FROM_MASSES)
        };
        printed.iter().zip(ours).enumerate().map(beside).collect()
    }
}

pub(super) fn tractor(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Frame {
        appendix_a_in_lb_per_deg: Printed,
        frame_nm_per_deg: Printed,
    }
    const NEWTON_METERS_PER_INCH_POUND: f64 = 0.112_984_829;

    let mut rows = Case::new(base, thesis!("figures_2_1_2_2.toml")?)?.tractor(table);
    let frame: Frame = thesis!("table_2_1.toml")?;
    let stiffness = frame.appendix_a_in_lb_per_deg.value * NEWTON_METERS_PER_INCH_POUND;
    let item = "Table 2.1: torsional stiffness of the frame, N m/deg";
    rows.push(Row::beside(table, item, &frame.frame_nm_per_deg, stiffness));
    Ok(rows)
}

pub(super) fn trailer(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    Ok(Case::new(base, thesis!("figures_2_1_2_2.toml")?)?.trailer(table))
}

pub(super) fn air(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let case = Case::new(base, thesis!("table_2_9.toml")?)?;
    let mut rows = case.tractor(table);
    rows.extend(case.trailer(table));
    Ok(rows)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TruckSim {
    load_n: Vec<Printed>,
    greatest_deviation_percent: Printed,
    greatest_deviation_axle: Printed,
}

/// Left and right loads of the axles of the nonlinear plant, driving straight ahead at 50 km/h.
fn at_rest(vehicle: &Vehicle) -> Result<Vec<[f64; 2]>, VehicleError> {
    let plant = YawRollPlant::new(vehicle, vehicle.reference_load(), &PlantOptions::default())?;
    let sample = plant.start(vehicle.nominal_speed_mps)?.sample();
    Ok(sample.axles().iter().map(|axle| [axle.left_load_n, axle.right_load_n]).collect())
}

/// Fig. 2.3: the loads of a simulation beside those of this project's plant.
pub(super) fn trucksim(
    table: &'static str,
    _: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: TruckSim = thesis!("figure_2_3.toml")?;
    let note = "nonlinear plant with measured springs and tires, straight ahead at 50 km/h";
    let bars = "the bars of the two sides are not printed as numbers";
    let mut rows = Vec::new();
    for (i, (printed, sides)) in printed.load_n.iter().zip(at_rest(&measured()?)?).enumerate() {
        let axle = i + 1;
        let item = format!("axle {axle} load, N");
        rows.push(Row::against(table, item, printed, sides[0] + sides[1], note));
        for (side, load_n) in ["left", "right"].into_iter().zip(sides) {
            rows.push(Row::ours(table, format!("axle {axle}, {side} side, N"), load_n, bars));
        }
    }
    Ok(rows)
}

/// Fig. 2.4: the deviation of both simulations from the specified loads.
pub(super) fn deviations(
    table: &'static str,
    _: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let printed: TruckSim = thesis!("figure_2_3.toml")?;
    let loads: Loads = thesis!("figures_2_1_2_2.toml")?;
    let specified = loads.tractor.load_kn.iter().chain(&loads.trailer.load_kn);
    let own = at_rest(&measured()?)?;
    let mut rows = Vec::new();
    let (mut greatest, mut at) = (0.0_f64, 0.0);
    let mut axle = 0.0;
    for ((printed, specified), own) in printed.load_n.iter().zip(specified).zip(own) {
        axle += 1.0;
        let percent = |load_n: f64| 100.0 * (1e-3 * load_n / specified.value - 1.0);
        let theirs = percent(printed.value);
        let note = "from the loads printed in Fig. 2.3 and Figs. 2.1 and 2.2";
        rows.push(Row::ours(table, format!("axle {axle}, TruckSim, %"), theirs, note));
        let note = "nonlinear plant of this project";
        rows.push(Row::ours(
            table,
            format!("axle {axle}, plant, %"),
            percent(own[0] + own[1]),
            note,
        ));
        if theirs.abs() > greatest {
            (greatest, at) = (theirs.abs(), axle);
        }
    }
    let item = "greatest deviation, %";
    rows.push(Row::beside(table, item, &printed.greatest_deviation_percent, greatest));
    let item = "greatest deviation: axle";
    let row = Row::beside(table, item, &printed.greatest_deviation_axle, at);
    rows.push(row.not_comparable());
    Ok(rows)
}
