//! Time histories: the ten responses to a rounded step (Fig. 4.2, appendix C) and the log of section 5.7
//! (Fig. 5.8).
//!
//! Each response is computed three times: by the linear model as printed, by the complete one, and by the
//! nonlinear plant with measured springs and tires, which stands in for the Yaw/Roll program.

use cg_plant::plant::{PlantOptions, PlantSample, YawRollPlant};
use cg_vehicle::error::VehicleError;

use super::baseline::{Baseline, Options};
use super::monte_carlo::{INTERVAL_S, RATE_PER_S, steps};
use super::nonlinear::Known;
use super::printed::Printed;
use super::row::Row;

/// One response of the three.
pub(super) struct History {
    /// Number of the figure in appendix C.
    pub(super) number: usize,
    pub(super) name: String,
    pub(super) unit: &'static str,
    pub(super) as_printed: Vec<f64>,
    pub(super) complete: Vec<f64>,
    pub(super) plant: Vec<f64>,
}

impl History {
    /// The last values, in the order of the fields.
    fn last(&self) -> [f64; 3] {
        [&self.as_printed, &self.complete, &self.plant]
            .map(|values| values.last().copied().unwrap_or(f64::NAN))
    }
}

/// The rounded step and the plant's samples in it.
pub(super) struct Step {
    pub(super) steer: Vec<f64>,
    pub(super) samples: Vec<PlantSample>,
}

/// Drives the nonlinear baseline through the rounded step of section 5.7.
pub(super) fn step(known: &Known<'_>) -> Result<Step, VehicleError> {
    let vehicle = &known.vehicle;
    let speed_mps = vehicle.nominal_speed_mps;
    let amplitude_rad = known.log_steer_rad()?;
    let steps = steps(RATE_PER_S, INTERVAL_S);
    let steer: Vec<f64> = steps.iter().map(|step| amplitude_rad * step).collect();
    let plant = YawRollPlant::new(vehicle, vehicle.reference_load(), &PlantOptions::default())?;
    let mut run = plant.start(speed_mps)?;
    let mut samples = Vec::with_capacity(steer.len());
    for (k, &steer_rad) in steer.iter().enumerate() {
        if k > 0 {
            run.push(steer_rad, speed_mps, INTERVAL_S);
        }
        samples.push(run.sample());
    }
    run.upright()?;
    Ok(Step { steer, samples })
}

/// The ten responses.
pub(super) fn histories(base: &Baseline, step: &Step) -> Vec<History> {
    let (printed, complete) = (&base.as_printed.state_space, &base.complete.state_space);
    let both = printed.responses().into_iter().zip(complete.responses());
    let all = both.enumerate().map(|(k, (of_printed, of_complete))| History {
        number: k + 1,
        as_printed: printed.history(&of_printed, &step.steer, INTERVAL_S),
        complete: complete.history(&of_complete, &step.steer, INTERVAL_S),
        plant: of_plant(&step.samples, k),
        name: of_complete.name,
        unit: of_complete.unit,
    });
    all.collect()
}

/// A response of the plant, in the order of the linear model's.
fn of_plant(samples: &[PlantSample], number: usize) -> Vec<f64> {
    let of = |value: fn(&PlantSample) -> f64| samples.iter().map(value).collect();
    match number {
        0 => lateral_velocity(samples),
        1 => of(|s| s.tractor.yaw_rad),
        2 => of(|s| s.tractor.roll_rad),
        3 => of(|s| s.trailer.yaw_rad),
        4 => of(|s| s.trailer.roll_rad),
        axle => samples.iter().map(|s| s.axles()[axle - 5].roll_rad).collect(),
    }
}

/// Lateral velocity of the tractor's c.g. in its own axes, by central differences of its path.
fn lateral_velocity(samples: &[PlantSample]) -> Vec<f64> {
    let last = samples.len().saturating_sub(1);
    let at = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        let (a, b) = (samples[before].position_m, samples[after].position_m);
        #[allow(clippy::cast_precision_loss)] // one or two
        let time_s = (after - before) as f64 * INTERVAL_S;
        let yaw = |k: usize| samples[k].tractor.yaw_rad;
        let (sin, cos) = libm::sincos(f64::midpoint(yaw(before), yaw(after)));
        (cos * (b[1] - a[1]) - sin * (b[0] - a[0])) / time_s
    };
    (0..samples.len()).map(at).collect()
}

/// A number of the text with its rounding.
fn stated(value: f64, rounding: f64) -> Printed {
    Printed { value, rounding, misprint: None }
}

/// Fig. 4.2 and appendix C: the values after ten seconds, and how far the complete model is from the
/// plant on the way.
pub(super) fn steady_values(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let known = Known::new(base)?;
    let step = step(&known)?;
    let all = histories(base, &step);
    let note = "the thesis prints no numbers of the curves; ours are the values after 10 s of the rounded \
                step of 0.19 g, in ISO 8855 signs; `cg reproduce` draws them as figures";
    let mut rows = trailer_roll(table, base, &all[4]);
    for history in &all {
        let item =
            |what: &str| format!("C.{} {}, {}, {what}", history.number, history.name, history.unit);
        let names = ["as printed", "complete", "nonlinear plant"];
        for (name, value) in names.into_iter().zip(history.last()) {
            rows.push(Row::ours(table, item(name), value, note));
        }
        let peak = history.plant.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let pairs = history.complete.iter().zip(&history.plant);
        let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let item = format!("C.{} {}, complete from plant, % of peak", history.number, history.name);
        rows.push(Row::ours(table, item, 100.0 * apart / peak, note));
    }
    Ok(rows)
}

/// Fig. 4.2: the analytical response is lower than that of the Yaw/Roll program, by eq. 5.19.
fn trailer_roll(table: &'static str, base: &Baseline, roll: &History) -> Vec<Row> {
    let [as_printed, _, plant] = roll.last();
    let height_m = base.vehicle.trailer.reference_cg_height_m;
    let [low, high] = [&base.as_printed, &base.complete].map(|m| m.ratio[0].ratio_at(height_m));
    let printed = stated(1.4894, 0.5e-4);
    let reason = "the F(0) of orders 3 to 6 in Table 5.1 differ by 0.0046";
    let beside = |what: &str, ours: f64, note: &str| {
        let item = format!("4.2 trailer roll, {what} divided by as printed");
        Row::against(table, item, &printed, ours, note).within(0.0046, reason)
    };
    vec![
        beside(
            "complete model",
            high / low,
            "eq. 5.19 is the Yaw/Roll program divided by as printed",
        ),
        beside(
            "nonlinear plant",
            plant / as_printed,
            "eq. 5.19 is the Yaw/Roll program divided by as printed; at 0.19 g",
        ),
    ]
}

/// Fig. 5.8: nearly 0.2 g, steady after about 5 s.
pub(super) fn log(
    table: &'static str,
    base: &Baseline,
    _: &Options,
) -> Result<Vec<Row>, VehicleError> {
    let step = step(&Known::new(base)?)?;
    let gravity_mps2 = base.vehicle.gravity_mps2;
    let lateral: Vec<f64> =
        step.samples.iter().map(|s| s.trailer.lateral_acceleration_mps2 / gravity_mps2).collect();
    let roll: Vec<f64> = step.samples.iter().map(|s| s.trailer.roll_rad).collect();
    let peak = lateral.iter().copied().fold(0.0, f64::max);
    let note = "nonlinear plant with measured springs and tires; the thesis prints neither the steer \
                angle nor the rate of the step";
    let about = "\"close to\": a tenth";
    let rows = vec![
        Row::against(table, "peak lateral acceleration, g", &stated(0.2, 0.05), peak, note)
            .within(0.02, about),
        Row::against(
            table,
            "roll angle within 5 % of its last value after, s",
            &stated(5.0, 0.5),
            settled_s(&roll),
            note,
        )
        .within(1.0, "\"approximately\": one second"),
    ];
    Ok(rows)
}

/// The time after which a signal stays within 5 % of its last value.
fn settled_s(values: &[f64]) -> f64 {
    let last = values.last().copied().unwrap_or(f64::NAN);
    let outside = values.iter().rposition(|value| (value / last - 1.0).abs() > 0.05);
    #[allow(clippy::cast_precision_loss)] // some hundreds
    outside.map_or(0.0, |k| (k + 1) as f64 * INTERVAL_S)
}
