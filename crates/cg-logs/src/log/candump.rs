//! The writer of CAN logs: rows as J1939 frames in the format of `candump -L`.
//!
//! ```text
//!     (12.340000) can0 18F0090B#7E7DFF007D807DFF
//! ```
//!
//! | group | signals | every |
//! |---|---|---|
//! | VDC2 | steering-wheel angle, yaw rate, specific force of the tractor | row |
//! | SSI2 (roll sensor, compensated) or SSI (inclinometer, not compensated) | roll relative to gravity, or tilt | row |
//! | ASC3 | levels of the tractor's drive axle | 100 ms |
//! | ASC4 | bellows pressures of the tractor's drive axle | 100 ms |
//! | CCVS1 | speed | 100 ms |
//! | VW | mass of the trailer | 1 s |
//! | EBS22 | load of the trailer's axles | 1 s |
//!
//! On a flat road the roll angle relative to the road is the one relative to gravity, so a row
//! without the latter is written with the former. J1939 has no groups for the trailer's suspension
//! roll, levels, specific force and suspension pressure, so they are not written (a DBC file can
//! describe such signals). The time stamps of frames are not negative: a log that begins before its time zero is written from
//! the whole second before its first row on.

use std::fmt::Write as _;
use std::io::{BufWriter, Write};

use cg_core::signal::j1939::{
    BELLOWS_REAR_LEFT, BELLOWS_REAR_RIGHT, LATERAL_ACCELERATION, LEVEL_REAR_LEFT, LEVEL_REAR_RIGHT,
    NOT_AVAILABLE, ROLL, ROLL_FINE, SPEED, STEERING_WHEEL_ANGLE, Signal, TRAILER_AXLE_LOAD,
    TRAILER_MASS, YAW_RATE,
};

use cg_output::{Draft, Target};

use super::error::{LogError, Place, Position};
use super::signal::{LogRow, Signal as Column};

/// Source addresses: brake system, roll sensor, engine, trailer.
const BRAKES: u8 = 0x0B;
const ROLL_SENSOR: u8 = 0xE4;
const ENGINE: u8 = 0x00;
const TRAILER: u8 = 0xC8;
const AIR_SUSPENSION: u8 = 0x2F;
/// Cycle times of levels, speed and mass, microseconds.
const LEVEL_CYCLE_US: u64 = 100_000;
const SPEED_CYCLE_US: u64 = 100_000;
const WEIGHT_CYCLE_US: u64 = 1_000_000;

/// Writes a candump log. Like the CSV writer, it leaves a complete file or none.
pub struct CandumpWriter {
    sink: BufWriter<Box<dyn Write + Send>>,
    draft: Option<Draft>,
    file: Box<str>,
    steering_ratio: f64,
    line: String,
    lines: u64,
    next_speed_us: u64,
    next_weight_us: u64,
    next_level_us: u64,
    out_of_range: u64,
    /// The time from which the time stamps count, s.
    origin_s: Option<f64>,
}

/// The signals of a log that are written; the others have no J1939 signal.
const WRITTEN: [Column; 15] = [
    Column::Time,
    Column::Steer,
    Column::SteeringWheel,
    Column::Roll,
    Column::RollToGravity,
    Column::Tilt,
    Column::Speed,
    Column::TractorLateralSpecificForce,
    Column::TractorLevelLeft,
    Column::TractorLevelRight,
    Column::YawRate,
    Column::TrailerMass,
    Column::TrailerAxleLoad,
    Column::DrivePressureLeft,
    Column::DrivePressureRight,
];

impl CandumpWriter {
    /// Begins a log. `steering_ratio` (steering-wheel angle divided by road-wheel angle) converts
    /// road-wheel angles.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn create(target: &Target, steering_ratio: f64) -> Result<Self, LogError> {
        let file: Box<str> = target.path().display().to_string().into();
        let fail = |source| {
            let place = Place { file: file.clone(), position: Position::File };
            LogError::Write { place, source }
        };
        let (draft, sink) = target.open().map_err(fail)?;
        Ok(Self {
            sink: BufWriter::new(Box::new(sink)),
            draft,
            file,
            steering_ratio,
            line: String::new(),
            lines: 0,
            next_speed_us: 0,
            next_weight_us: 0,
            next_level_us: 0,
            out_of_range: 0,
            origin_s: None,
        })
    }

    /// Whether frames contain a signal. The steer angle needs a steering ratio.
    pub fn writes(&self, signal: Column) -> bool {
        let is_convertible = signal != Column::Steer || self.steering_ratio.is_finite();
        WRITTEN.contains(&signal) && is_convertible
    }

    /// Writes one row as frames. Absent signals are "not available"; a group without signals is not
    /// written.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_row(&mut self, row: &LogRow) -> Result<(), LogError> {
        let origin_s = *self.origin_s.get_or_insert(row.time_s.floor().min(0.0));
        // These times are not negative, and the number of microseconds is far below 2^64.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let time_us = ((row.time_s - origin_s) * 1e6).round() as u64;
        let wheel_rad = if row.steering_wheel_rad.is_nan() {
            row.steer_rad * self.steering_ratio
        } else {
            row.steering_wheel_rad
        };
        let vdc2 = [
            (STEERING_WHEEL_ANGLE, wheel_rad),
            (YAW_RATE, row.yaw_rate_radps),
            (LATERAL_ACCELERATION, row.tractor_lateral_specific_force_mps2),
        ];
        self.frame(time_us, BRAKES, &vdc2)?;
        let roll_rad =
            if row.roll_to_gravity_rad.is_nan() { row.roll_rad } else { row.roll_to_gravity_rad };
        self.frame(time_us, ROLL_SENSOR, &[(ROLL_FINE, roll_rad)])?;
        self.frame(time_us, ROLL_SENSOR, &[(ROLL, row.tilt_rad)])?;
        if time_us >= self.next_level_us {
            let asc3 = [
                (LEVEL_REAR_LEFT, row.tractor_level_left_m),
                (LEVEL_REAR_RIGHT, row.tractor_level_right_m),
            ];
            let asc4 = [
                (BELLOWS_REAR_LEFT, row.drive_pressure_left_pa),
                (BELLOWS_REAR_RIGHT, row.drive_pressure_right_pa),
            ];
            if asc3.iter().chain(&asc4).any(|(_, value)| value.is_finite()) {
                self.next_level_us = time_us + LEVEL_CYCLE_US;
            }
            self.frame(time_us, AIR_SUSPENSION, &asc3)?;
            self.frame(time_us, AIR_SUSPENSION, &asc4)?;
        }
        if time_us >= self.next_speed_us && row.speed_mps.is_finite() {
            self.next_speed_us = time_us + SPEED_CYCLE_US;
            self.frame(time_us, ENGINE, &[(SPEED, row.speed_mps)])?;
        }
        let weighed = row.trailer_mass_kg.is_finite() || row.trailer_axle_load_kg.is_finite();
        if time_us >= self.next_weight_us && weighed {
            self.next_weight_us = time_us + WEIGHT_CYCLE_US;
            self.frame(time_us, TRAILER, &[(TRAILER_MASS, row.trailer_mass_kg)])?;
            self.frame(time_us, TRAILER, &[(TRAILER_AXLE_LOAD, row.trailer_axle_load_kg)])?;
        }
        Ok(())
    }

    /// Number of values so far that are outside the range of their J1939 signal. They are written
    /// as "not available".
    pub fn out_of_range(&self) -> u64 {
        self.out_of_range
    }

    /// Ends the log and gives the file its name.
    ///
    /// # Errors
    /// The file cannot be written or renamed. It is then removed.
    pub fn finish(mut self) -> Result<(), LogError> {
        let place = self.place();
        let fail = |source| LogError::Write { place: place.clone(), source };
        self.sink.flush().map_err(fail)?;
        drop(self.sink);
        self.draft.map_or(Ok(()), Draft::publish).map_err(fail)
    }

    fn place(&self) -> Place {
        Place { file: self.file.clone(), position: Position::Line(self.lines + 1) }
    }

    /// Writes one frame with signals of one group.
    fn frame(
        &mut self,
        time_us: u64,
        source: u8,
        signals: &[(Signal, f64)],
    ) -> Result<(), LogError> {
        let Some((first, _)) = signals.first() else { return Ok(()) };
        if signals.iter().all(|(_, value)| value.is_nan()) {
            return Ok(());
        }
        let mut data = NOT_AVAILABLE;
        for (signal, value) in signals {
            signal.set_compensated(*signal == ROLL_FINE, &mut data);
            if !signal.encode(*value, &mut data) && !value.is_nan() {
                self.out_of_range += 1;
            }
        }
        let (seconds, micros) = (time_us / 1_000_000, time_us % 1_000_000);
        self.line.clear();
        // Writing to a string cannot fail.
        let _ = write!(self.line, "({seconds}.{micros:06}) can0 {:08X}#", first.identifier(source));
        for byte in data {
            let _ = write!(self.line, "{byte:02X}");
        }
        self.line.push('\n');
        match self.sink.write_all(self.line.as_bytes()) {
            Ok(()) => {
                self.lines += 1;
                Ok(())
            }
            Err(error) => Err(LogError::Write { place: self.place(), source: error }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cg_output::{Files, Kind};

    fn writer(path: &std::path::Path) -> CandumpWriter {
        let target = Files::new(false).writes("path", path, Kind::Frames).unwrap();
        CandumpWriter::create(&target, 20.0).unwrap()
    }

    #[test]
    fn rows_become_frames_at_their_cycles() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("drive.log");
        let mut writer = writer(&path);
        for k in 0..11 {
            writer
                .write_row(&LogRow {
                    time_s: 0.01 * f64::from(k),
                    steer_rad: 0.01,
                    roll_rad: 0.02,
                    speed_mps: 13.9,
                    trailer_mass_kg: 25_000.0,
                    ..LogRow::ABSENT
                })
                .unwrap();
        }
        assert_eq!(writer.out_of_range(), 0);
        writer.finish().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let lines = |group: &str| text.lines().filter(|line| line.contains(group)).count();
        assert_eq!(lines("18F0090B#"), 11);
        assert_eq!(lines("0CF029E4#"), 11);
        assert_eq!((lines("18FEF100#"), lines("18FEEAC8#")), (2, 1));
        // 0.2 rad at the wheel is raw 32332 = 0x7E4C; yaw rate and acceleration are absent.
        assert_eq!(text.lines().next(), Some("(0.000000) can0 18F0090B#4C7EFFFFFFFFFFFF"));
    }

    #[test]
    fn the_load_of_the_axles_is_sent_where_the_mass_is_not_known() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("drive.log");
        let mut writer = writer(&path);
        let row = LogRow { time_s: 0.0, trailer_axle_load_kg: 18_000.0, ..LogRow::ABSENT };
        writer.write_row(&row).unwrap();
        writer.finish().unwrap();
        // 9000 steps of 2 kg are 0x2328, low byte first.
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text, "(0.000000) can0 18FEC4C8#FFFFFFFF2823FFFF\n");
    }

    #[test]
    fn a_log_that_begins_before_time_zero_keeps_its_intervals() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("early.log");
        let mut writer = writer(&path);
        for time_s in [-1.25, -0.5, 0.25] {
            writer.write_row(&LogRow { time_s, roll_rad: 0.0, ..LogRow::ABSENT }).unwrap();
        }
        writer.finish().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let times: Vec<&str> = text.lines().map(|line| &line[..10]).collect();
        assert_eq!(times, ["(0.750000)", "(1.500000)", "(2.250000)"]);
    }

    /// Each signal alone is in the file if it is among those that are written.
    #[test]
    fn signals_that_are_written_are_in_the_file() {
        let folder = tempfile::tempdir().unwrap();
        for signal in Column::ALL.into_iter().filter(|signal| *signal != Column::Time) {
            let path = folder.path().join(format!("{}.log", signal.name()));
            let mut writer = writer(&path);
            let is_written = writer.writes(signal);
            let value = |column| match column {
                Column::Time => 0.0,
                column if column == signal => 0.1,
                _ => f64::NAN,
            };
            writer.write_row(&LogRow::from_values(Column::ALL.map(value))).unwrap();
            writer.finish().unwrap();
            let is_there = !std::fs::read_to_string(&path).unwrap().is_empty();
            assert_eq!(is_there, is_written, "{}", signal.name());
        }
    }

    #[test]
    fn what_no_signal_can_hold_is_counted_and_absent() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = writer(&folder.path().join("a.log"));
        writer.write_row(&LogRow { time_s: 0.0, speed_mps: 500.0, ..LogRow::ABSENT }).unwrap();
        assert_eq!(writer.out_of_range(), 1);
    }
}
