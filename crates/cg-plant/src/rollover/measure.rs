//! All measures of a vehicle under a load, each with its unit and one sentence of explanation.

use std::f64::consts::TAU;

use super::curve::Curve;
use super::decay::{PULSE_WHEEL_RAD, after_pulse, damping_ratio};
use super::maneuver::{Peaks, lane_change, one_sine};
use super::offtracking::{
    HIGH_SPEED_MPS, HIGH_SPEED_RADIUS_M, LOW_SPEED_RADIUS_M, high_speed_m, low_speed_m,
};
use super::ramp::{Ramp, RampEnd};
use super::small::{rearward_amplification, to_tractor_lateral_acceleration, yaw_damping_ratio};
use super::time::TimeToRollover;
use super::transfer::GRAVITY_MPS2;
use super::tripped::RigidTrailer;
use crate::plant::{PlantOptions, YawRollPlant};
use cg_vehicle::equations::Equations;
use cg_vehicle::error::VehicleError;
use cg_vehicle::response::StateSpace;
use cg_vehicle::steady_turn::{
    on_board, side_pull_ratio, steady_turn_threshold_g, tilt_table_ratio,
};
use cg_vehicle::{Load, Variant, Vehicle};

/// Rate of the slow ramp: a lag of the roll angle of one second costs 0.01 g.
const SLOW_GPS: f64 = 0.01;
/// Rate of the ramp for the time to rollover: into a bend within a few seconds.
const FAST_GPS: f64 = 0.1;
/// Speed and frequency of the rearward amplification: 88 km/h, 0.4 Hz.
const AMPLIFICATION_MPS: f64 = 88.0 / 3.6;
const AMPLIFICATION_HZ: f64 = 0.4;
/// The tractor's lateral acceleration in that sine, as in the published tests.
const AMPLIFICATION_G: f64 = 0.15;
/// Used if the vehicle file has no steering ratio.
const USUAL_STEERING_RATIO: f64 = 20.0;

/// Options of the measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolloverOptions {
    /// Speed of the ramps and of the lane change; measures that are defined at a speed keep it.
    pub speed_mps: f64,
    /// Lateral acceleration at which the load transfer is computed, in g.
    pub lateral_acceleration_g: f64,
    /// Gate length of the lane change (eq. 2.5).
    pub gate_m: f64,
    /// Distance of the payload's c.g. to the left of the middle, for the measures of the nonlinear plant.
    pub payload_left_m: f64,
    /// The curve for which a speed is advised, if there is one.
    pub curve: Option<Curve>,
}

impl RolloverOptions {
    /// The defaults: the vehicle's nominal speed, 0.15 g, a gate of 20 m, the payload in the middle.
    pub fn of(vehicle: &Vehicle) -> Self {
        Self {
            speed_mps: vehicle.nominal_speed_mps,
            lateral_acceleration_g: 0.15,
            gate_m: 20.0,
            payload_left_m: 0.0,
            curve: None,
        }
    }
}

/// A measure.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Measure {
    /// Name, with the unit at its end.
    pub name: &'static str,
    /// Value, if there is one.
    pub value: Option<f64>,
    /// Unit; `-` for a ratio.
    pub unit: &'static str,
    /// Meaning, in one sentence.
    pub meaning: String,
}

/// All measures of a vehicle under a load.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RolloverMeasures {
    /// The measures.
    pub measures: Vec<Measure>,
    /// Rearward amplification of the linear model at 88 km/h: `(frequency in Hz, ratio)`.
    pub rearward_amplification: Vec<(f64, f64)>,
}

impl RolloverMeasures {
    /// The value of the measure of this name, if there is one.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.measures.iter().find(|measure| measure.name == name)?.value
    }

    fn add(&mut self, name: &'static str, unit: &'static str, value: Option<f64>, meaning: String) {
        self.measures.push(Measure { name, value, unit, meaning });
    }
}

/// Vehicle, load and plant, with models at other speeds.
struct Subject<'a> {
    vehicle: &'a Vehicle,
    load: Load,
    plant: YawRollPlant,
    options: RolloverOptions,
}

impl Subject<'_> {
    fn model(&self, speed_mps: f64) -> Result<StateSpace, VehicleError> {
        Equations::new(self.vehicle, Variant::Complete, speed_mps, self.load)?.state_space()
    }

    /// Steady-state lateral acceleration of the linear model, m/s² per radian of steer.
    fn gain(&self, speed_mps: f64) -> Result<f64, VehicleError> {
        let model = self.model(speed_mps)?;
        model.lateral_gain()
    }

    fn ramp(&self, rate_gps: f64) -> Result<Ramp, VehicleError> {
        let speed_mps = self.options.speed_mps;
        Ramp::drive(&self.plant, speed_mps, self.gain(speed_mps)?, rate_gps * GRAVITY_MPS2)
    }
}

/// Computes every measure. This simulates some minutes of driving in about a second.
///
/// # Errors
/// [`VehicleError`] if the load is impossible or the vehicle cannot drive straight.
pub fn measures(
    vehicle: &Vehicle,
    load: Load,
    options: &RolloverOptions,
) -> Result<RolloverMeasures, VehicleError> {
    let plant_options =
        PlantOptions { payload_left_m: options.payload_left_m, ..PlantOptions::default() };
    let plant = YawRollPlant::new(vehicle, load, &plant_options)?;
    let subject = Subject { vehicle, load, plant, options: *options };
    let mut all = RolloverMeasures { measures: Vec::new(), rearward_amplification: Vec::new() };
    statics(&subject, &mut all)?;
    lane(&subject, &mut all)?;
    amplification(&subject, &mut all)?;
    damping(&subject, &mut all)?;
    offtracking(&subject, &mut all)?;
    if let Some(curve) = options.curve {
        all.add("curve_speed_mps", "m/s", curve.speed_mps(vehicle, load)?, curve.meaning());
    }
    Ok(all)
}

fn statics(subject: &Subject<'_>, all: &mut RolloverMeasures) -> Result<(), VehicleError> {
    let options = &subject.options;
    let on_board = on_board(subject.vehicle, subject.load, options.speed_mps)?;
    all.add(
        "static_stability_factor_g",
        "g",
        Some(on_board.static_stability_factor_g),
        "Half the trailer's effective track divided by the height of its whole c.g.: the threshold \
         of a rigid vehicle."
            .into(),
    );
    let ramp = subject.ramp(SLOW_GPS)?;
    let greatest_g = ramp.greatest_mps2() / GRAVITY_MPS2;
    let rolled = ramp.end == RampEnd::RolledOver;
    all.add(
        "static_rollover_threshold_g",
        "g",
        rolled.then_some(greatest_g),
        if rolled {
            format!(
                "Greatest lateral acceleration of the trailer that the nonlinear plant sustains in a \
                 slow steer ramp to the left at {:.0} km/h: beyond it the vehicle tips.",
                3.6 * options.speed_mps
            )
        } else {
            format!("None: the vehicle slides at {greatest_g:.2} g before it rolls over.")
        },
    );
    let (speed_mps, gravity_mps2) = (options.speed_mps, subject.vehicle.gravity_mps2);
    let steady = steady_turn_threshold_g(subject.vehicle, subject.load, speed_mps)?;
    all.add(
        "static_rollover_threshold_steady_turn_g",
        "g",
        Some(steady * gravity_mps2 / GRAVITY_MPS2),
        format!(
            "The same from the balance of a steady turn at {:.0} km/h, axle by axle, with the payload in \
             the middle; if the tires slide before, where they slide.",
            3.6 * speed_mps
        ),
    );
    all.add(
        "static_rollover_threshold_on_board_g",
        "g",
        Some(on_board.static_rollover_threshold_g.value),
        format!(
            "The same as the on-board estimator computes it from the height and {:.0} km/h, from \
             steady turns at 40 and 90 km/h and from the tightest turn.",
            3.6 * speed_mps
        ),
    );
    at_rest(subject, (on_board.static_stability_factor_g, steady), all)?;
    transfers(&ramp, options.lateral_acceleration_g, all);
    times(subject, greatest_g * GRAVITY_MPS2, all)
}

/// The tests of a vehicle at rest, and the threshold relative to that of a rigid trailer.
fn at_rest(
    subject: &Subject<'_>,
    (rigid, steady): (f64, f64),
    all: &mut RolloverMeasures,
) -> Result<(), VehicleError> {
    all.add(
        "compliance_factor",
        "-",
        Some(steady / rigid),
        "What springs, tires and fifth wheel leave of the threshold of a rigid vehicle: threshold in the \
         steady turn divided by the static stability factor."
            .into(),
    );
    all.add(
        "side_pull_ratio",
        "-",
        Some(side_pull_ratio(subject.vehicle, subject.load)?),
        "Greatest force that pulls the vehicle at rest sideways, in proportion to its masses, divided by \
         its weight."
            .into(),
    );
    all.add(
        "tilt_table_ratio",
        "-",
        Some(tilt_table_ratio(subject.vehicle, subject.load)?),
        "Tangent of the angle at which the vehicle tips on a tilting table.".into(),
    );
    Ok(())
}

/// Load transfer at a lateral acceleration of the slow ramp.
fn transfers(ramp: &Ramp, at_g: f64, all: &mut RolloverMeasures) {
    let transfer = ramp.transfer_at(at_g * GRAVITY_MPS2);
    all.add(
        "load_transfer_ratio",
        "-",
        transfer.map(|transfer| transfer.load_transfer_ratio),
        format!(
            "Share of the wheel loads of all axles that has moved to the outer side at {at_g} g."
        ),
    );
    all.add(
        "roll_safety_factor",
        "-",
        transfer.map(|transfer| transfer.roll_safety_factor),
        format!(
            "The same at {at_g} g without the steered axle: one when every other inner wheel has \
             left the road."
        ),
    );
}

fn times(
    subject: &Subject<'_>,
    threshold_mps2: f64,
    all: &mut RolloverMeasures,
) -> Result<(), VehicleError> {
    let ramp = subject.ramp(FAST_GPS)?;
    let time = TimeToRollover::half_way(&ramp, threshold_mps2);
    all.add(
        "time_to_rollover_predicted_s",
        "s",
        time.map(|time| time.predicted_s),
        format!(
            "In a ramp of {FAST_GPS} g/s, at half the threshold: time to the threshold at the \
             present rate of the lateral acceleration."
        ),
    );
    all.add(
        "time_to_rollover_simulated_s",
        "s",
        time.map(|time| time.simulated_s),
        "From the same instant until the last inner wheel that is not steered leaves the road."
            .into(),
    );
    Ok(())
}

fn lane(subject: &Subject<'_>, all: &mut RolloverMeasures) -> Result<(), VehicleError> {
    let RolloverOptions { speed_mps, gate_m, .. } = subject.options;
    let peaks = lane_change(&subject.plant, speed_mps, gate_m)?;
    let whole = peaks.rolled_over_s.is_none();
    let of = |value: fn(&Peaks) -> f64| whole.then(|| value(&peaks));
    let maneuver = if let Some(time_s) = peaks.rolled_over_s {
        format!("none: it rolled over after {time_s:.1} s of a lane change over {gate_m} m")
    } else {
        format!("in a lane change over {gate_m} m")
    };
    all.add(
        "lane_change_lateral_acceleration_g",
        "g",
        of(|peaks| peaks.trailer_mps2 / GRAVITY_MPS2),
        format!("Greatest lateral acceleration of the trailer, {maneuver}."),
    );
    all.add(
        "lane_change_load_transfer_ratio",
        "-",
        of(|peaks| peaks.transfer.load_transfer_ratio.abs()),
        format!("Greatest load transfer ratio, {maneuver}."),
    );
    all.add(
        "lane_change_roll_safety_factor",
        "-",
        of(|peaks| peaks.transfer.roll_safety_factor.abs()),
        format!("Greatest roll safety factor, {maneuver}."),
    );
    all.add(
        "lane_change_rearward_amplification",
        "-",
        peaks.rearward_amplification().filter(|_| whole),
        format!(
            "Greatest lateral acceleration of the trailer divided by that of the tractor, {maneuver}."
        ),
    );
    tripped(subject, (&peaks, &maneuver), all)
}

/// Measures of the trailer as a rigid body that turns about its outer wheels.
fn tripped(
    subject: &Subject<'_>,
    (peaks, maneuver): (&Peaks, &str),
    all: &mut RolloverMeasures,
) -> Result<(), VehicleError> {
    let trailer = RigidTrailer::of(subject.vehicle, subject.load)?;
    let whole = peaks.rolled_over_s.is_none();
    all.add(
        "rollover_prevention_energy_reserve_kj",
        "kJ",
        whole.then(|| 1e-3 * trailer.energy_reserve_j(peaks.trailer_roll_rate_radps)),
        format!(
            "Least energy that is missing to tip the trailer over its outer wheels, after that of its roll \
             rate, {maneuver}; {:.1} kJ at rest.",
            1e-3 * trailer.energy_reserve_j(0.0)
        ),
    );
    all.add(
        "critical_sliding_velocity_mps",
        "m/s",
        Some(trailer.critical_sliding_velocity_mps()),
        "Least lateral velocity at which a curb tips the trailer, as a rigid body without the tractor."
            .into(),
    );
    all.add(
        "rollover_prevention_metric",
        "-",
        Some(trailer.prevention_metric()),
        "Share of the energy of sliding that such an impact does not turn into rotation.".into(),
    );
    Ok(())
}

fn amplification(subject: &Subject<'_>, all: &mut RolloverMeasures) -> Result<(), VehicleError> {
    let (speed_mps, hz) = (AMPLIFICATION_MPS, AMPLIFICATION_HZ);
    let model = subject.model(speed_mps)?;
    let gain = to_tractor_lateral_acceleration(&model, speed_mps).magnitude(TAU * hz)?;
    let peaks = one_sine(&subject.plant, speed_mps, AMPLIFICATION_G * GRAVITY_MPS2 / gain, hz)?;
    all.add(
        "rearward_amplification",
        "-",
        peaks.rearward_amplification().filter(|_| peaks.rolled_over_s.is_none()),
        format!(
            "The same in one sine of steer, {hz} Hz, 88 km/h, {AMPLIFICATION_G} g at the tractor."
        ),
    );
    all.add(
        "rearward_amplification_linear",
        "-",
        Some(rearward_amplification(&model, speed_mps, hz)?),
        format!("The linear model's steady-state response to sines of {hz} Hz at 88 km/h."),
    );
    for step in 1..=20 {
        let frequency_hz = 0.05 * f64::from(step);
        let ratio = rearward_amplification(&model, speed_mps, frequency_hz)?;
        all.rearward_amplification.push((frequency_hz, ratio));
    }
    let worst = all.rearward_amplification.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
    all.add(
        "rearward_amplification_greatest",
        "-",
        worst.map(|(_, ratio)| ratio),
        format!(
            "The greatest value of it up to 1 Hz, at {:.2} Hz.",
            worst.map_or(f64::NAN, |(frequency_hz, _)| frequency_hz)
        ),
    );
    Ok(())
}

fn damping(subject: &Subject<'_>, all: &mut RolloverMeasures) -> Result<(), VehicleError> {
    let model = subject.model(HIGH_SPEED_MPS)?;
    all.add(
        "yaw_damping_ratio",
        "-",
        yaw_damping_ratio(&model)?,
        "Least damping ratio of the linear model's modes that are mostly lateral and yaw motion, \
         at 100 km/h; one if none oscillates."
            .into(),
    );
    let ratio = subject.vehicle.steering_ratio;
    let amplitude_rad = PULSE_WHEEL_RAD / ratio.unwrap_or(USUAL_STEERING_RATIO);
    let samples = after_pulse(&subject.plant, HIGH_SPEED_MPS, amplitude_rad)?;
    let assumed = if ratio.is_some() { "" } else { " (steering ratio of 20 assumed)" };
    all.add(
        "pulse_damping_ratio",
        "-",
        damping_ratio(&samples),
        format!(
            "Logarithmic decrement of the trailer's lateral acceleration after a pulse of 80 \
             degrees at the steering wheel at 100 km/h{assumed}; none if it decays in one swing."
        ),
    );
    Ok(())
}

fn offtracking(subject: &Subject<'_>, all: &mut RolloverMeasures) -> Result<(), VehicleError> {
    let model = subject.model(HIGH_SPEED_MPS)?;
    let yaw_gain = model.steady(&model.tractor_yaw_rate, 0.0)?;
    let high = high_speed_m(&subject.plant, HIGH_SPEED_MPS, HIGH_SPEED_RADIUS_M, yaw_gain);
    all.add(
        "high_speed_offtracking_m",
        "m",
        high.as_ref().ok().copied(),
        match &high {
            Ok(_) => "Distance of the last axle outside the path of the first one in a steady \
                      turn of 393 m at 100 km/h."
                .into(),
            Err(error) => format!("None in a turn of 393 m at 100 km/h: {error}."),
        },
    );
    all.add(
        "low_speed_offtracking_m",
        "m",
        Some(low_speed_m(subject.vehicle, LOW_SPEED_RADIUS_M)?),
        format!(
            "Distance of the trailer's axles inside the path of the steered axle in a turn of 90 \
             degrees on {LOW_SPEED_RADIUS_M} m without slip."
        ),
    );
    Ok(())
}
