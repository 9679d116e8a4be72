//! One run of the nonlinear plant along a path with the preview driver, and its peaks.

use cg_plant::plant::{
    Driver, DriverSettings, Path, PlantOptions, PlantSample, Progress, YawRollPlant,
};
use cg_vehicle::error::VehicleError;
use cg_vehicle::{Load, Vehicle};

/// Speed of the thesis's turns, m/s.
pub(super) const TURN_SPEED_MPS: f64 = 50.0 / 3.6;
/// Default speed of its lane changes, m/s.
pub(super) const LANE_SPEED_MPS: f64 = 100.0 / 3.6;
/// The turn of most studies.
pub(super) const QUARTER: Course = Course::Turn { angle_rad: std::f64::consts::FRAC_PI_2 };
/// The lane change of most studies.
pub(super) const LANE_CHANGE: Course = Course::LaneChange { gate_m: 20.0 };

/// Straight driving before the origin of eq. 2.5, so that the gate comes into the driver's preview of
/// 1.5 s.
pub(super) const RUN_IN_M: f64 = 60.0;
/// Straight driving before a turn, before a gate (eq. 2.5), and radius of the turns.
pub(super) const BEFORE_TURN_M: f64 = 40.0;
const BEFORE_GATE_M: f64 = RUN_IN_M + 15.0;
pub(super) const RADIUS_M: f64 = 100.0;
/// Width of a lane (eq. 2.5).
const LANE_M: f64 = 3.65;
/// Sampling interval.
const INTERVAL_S: f64 = 0.01;

/// The path that the driver follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// Turn to the left of 100 m radius.
    Turn { angle_rad: f64 },
    /// Lane change to the left of 3.65 m width.
    LaneChange { gate_m: f64 },
}

impl Course {
    pub(super) fn path(self) -> Path {
        match self {
            Self::Turn { angle_rad } => Path::turn(BEFORE_TURN_M, RADIUS_M, angle_rad),
            Self::LaneChange { gate_m } => Path::lane_change(BEFORE_GATE_M, gate_m, LANE_M),
        }
    }

    /// Duration of the course and some seconds more, until the roll angle has settled.
    fn duration_s(self, speed_mps: f64) -> f64 {
        match self {
            Self::Turn { angle_rad } => (BEFORE_TURN_M + RADIUS_M * angle_rad) / speed_mps + 3.0,
            Self::LaneChange { gate_m } => (BEFORE_GATE_M + gate_m) / speed_mps + 5.0,
        }
    }
}

/// The scenario of a run.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    pub(super) vehicle: Vehicle,
    pub(super) load: Load,
    pub(super) options: PlantOptions,
    pub(super) course: Course,
    pub(super) speed_mps: f64,
}

impl Drive {
    /// A quarter turn at 50 km/h under the reference load.
    pub(super) fn turn(vehicle: &Vehicle) -> Self {
        Self {
            vehicle: vehicle.clone(),
            load: vehicle.reference_load(),
            options: PlantOptions::default(),
            course: QUARTER,
            speed_mps: TURN_SPEED_MPS,
        }
    }

    /// Another course at another speed.
    pub(super) fn along(mut self, course: Course, speed_mps: f64) -> Self {
        (self.course, self.speed_mps) = (course, speed_mps);
        self
    }

    /// Another height of the trailer's sprung c.g.
    pub(super) fn at_height(mut self, cg_height_m: f64) -> Self {
        self.load.cg_height_m = cg_height_m;
        self
    }

    /// Maneuver and speed as one line of text.
    pub(super) fn description(&self) -> String {
        let kmh = 3.6 * self.speed_mps;
        match self.course {
            Course::Turn { angle_rad } => format!(
                "turn to the left of {:.0}°, {RADIUS_M} m radius, at {kmh:.0} km/h",
                angle_rad.to_degrees()
            ),
            Course::LaneChange { gate_m } => format!(
                "lane change to the left, {LANE_M} m wide, {gate_m} m long, at {kmh:.0} km/h"
            ),
        }
    }

    /// Drives the course.
    ///
    /// # Errors
    /// If the vehicle, the load or the driver is invalid.
    pub(super) fn run(&self) -> Result<Record, VehicleError> {
        let plant = YawRollPlant::new(&self.vehicle, self.load, &self.options)?;
        let mut run = plant.start(self.speed_mps)?;
        let settings = DriverSettings::default();
        let mut driver = Driver::new(&plant, self.course.path(), self.speed_mps, settings)?;
        let mut record = Record { samples: vec![run.sample()], rolled_over_s: None };
        // A step is at most the sampling interval, so rounding gives at least one step.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let steps = (INTERVAL_S / plant.step_s()).round().max(1.0) as usize;
        while run.time_s() < self.course.duration_s(self.speed_mps) {
            for _ in 0..steps {
                driver.drive(&mut run);
            }
            if let Progress::RolledOver { time_s } = run.progress() {
                record.rolled_over_s = Some(time_s);
                break;
            }
            record.samples.push(run.sample());
        }
        Ok(record)
    }
}

/// The samples of a run, every 10 ms.
#[derive(Clone, Debug)]
pub(super) struct Record {
    pub(super) samples: Vec<PlantSample>,
    pub(super) rolled_over_s: Option<f64>,
}

impl Record {
    /// Greatest magnitude; `None` if the vehicle rolled over.
    pub(super) fn peak(&self, of: impl Fn(&PlantSample) -> f64) -> Option<f64> {
        let upright = self.rolled_over_s.is_none();
        upright.then(|| self.samples.iter().map(|s| of(s).abs()).fold(0.0, f64::max))
    }

    /// Greatest value, positive to the outside of a left turn.
    pub(super) fn greatest(&self, of: impl Fn(&PlantSample) -> f64) -> Option<f64> {
        let upright = self.rolled_over_s.is_none();
        upright.then(|| self.samples.iter().map(of).fold(f64::NEG_INFINITY, f64::max))
    }

    /// A rollover as a line of the scenario.
    pub(super) fn rollover_remark(&self, name: &str) -> Option<String> {
        self.rolled_over_s.map(|time_s| format!("{name}: rolled over at {time_s:.1} s (no point)"))
    }

    /// Time history, every 40 ms.
    pub(super) fn history(&self, of: impl Fn(&PlantSample) -> f64) -> Vec<[f64; 2]> {
        #[allow(clippy::cast_precision_loss)] // thousands
        let point = |(k, s)| [k as f64 * INTERVAL_S, of(s)];
        self.samples.iter().enumerate().step_by(4).map(point).collect()
    }
}

/// Roll angle of the semitrailer.
pub(super) fn trailer_roll(sample: &PlantSample) -> f64 {
    sample.trailer.roll_rad
}

/// Lateral acceleration of the semitrailer.
pub(super) fn trailer_lateral(sample: &PlantSample) -> f64 {
    sample.trailer.lateral_acceleration_mps2
}

/// Peaks of the semitrailer's roll over a parameter. Each rollover is added to `remarks` instead, with the
/// name from `name`.
pub(super) fn peak_rolls(
    values: &[f64],
    remarks: &mut Vec<String>,
    name: impl Fn(f64) -> String,
    drive: impl Fn(f64) -> Drive,
) -> Result<Vec<[f64; 2]>, VehicleError> {
    let mut points = Vec::new();
    for &value in values {
        let record = drive(value).run()?;
        points.extend(record.greatest(trailer_roll).map(|peak| [value, peak]));
        remarks.extend(record.rollover_remark(&name(value)));
    }
    Ok(points)
}
