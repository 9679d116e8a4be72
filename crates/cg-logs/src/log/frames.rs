//! Reads the rows of a CAN log: the samples that its frames form, as in `cg run`.

use std::io::{BufReader, Read};

use cg_core::{Quantity, Sample};
use cg_vehicle::scales::Scale;

use crate::can::{
    AscReader, CandumpError, CandumpFault, CandumpReader, Frame, Instant, MASS_SERVES_US, Sampler,
    parse,
};
use crate::unscaled::is_unscaled;

use super::error::{LogError, Place, Position};
use super::options::LogOptions;
use super::signal::{LogRow, Signal};

/// The signals of a sample.
const SAMPLED: [Signal; 16] = [
    Signal::Time,
    Signal::Steer,
    Signal::Roll,
    Signal::RollToGravity,
    Signal::Tilt,
    Signal::AxleTilt,
    Signal::SuspensionRoll,
    Signal::Speed,
    Signal::LateralAcceleration,
    Signal::LateralSpecificForce,
    Signal::TractorSuspensionRoll,
    Signal::TractorLateralSpecificForce,
    Signal::TractorTilt,
    Signal::TractorAxleTilt,
    Signal::YawRate,
    Signal::TrailerMass,
];

/// Converts CAN frames to rows of a log: one row for each sample, as in `cg run`.
#[derive(Clone, Debug)]
pub struct FrameRows {
    sampler: Sampler,
    /// Whether the settings of the truck are unknown. Then steering-wheel angle and axle load
    /// cannot be converted and remain in the row.
    without_truck: bool,
    /// Time of the log minus stream time at the first frame, s. It is constant, so that the time
    /// never decreases.
    origin_s: Option<f64>,
    /// The scale of the last row.
    scale: Option<Scale>,
    /// Whether any value came in a frame.
    hears_bus: bool,
    /// Whether the values were measured at a speed that is not among them.
    speed_is_elsewhere: bool,
}

/// Any speed, m/s, without which there would be no steer angle and no yaw rate.
const SOME_MPS: f64 = 10.0;

impl FrameRows {
    /// A converter without frames.
    pub fn new(options: &LogOptions) -> Self {
        Self {
            sampler: Sampler::new(options.decoder(), options.settings.unwrap_or_default())
                .with_raised(options.raised),
            without_truck: options.settings.is_none(),
            origin_s: None,
            scale: None,
            hears_bus: false,
            speed_is_elsewhere: false,
        }
    }

    /// The same for values that were measured at a speed that is not among them, as those of a table without a column for it.
    #[must_use]
    pub fn with_speed_elsewhere(self, speed_is_elsewhere: bool) -> Self {
        Self { speed_is_elsewhere, ..self }
    }

    /// Adds a frame and returns whether it contains a value that is used. Call
    /// [`next_row`](Self::next_row) afterwards until it returns `None`.
    pub fn push(&mut self, frame: &Frame) -> bool {
        let mut heard = false;
        let instant = self.sampler.push(frame, None, |_| heard = true);
        self.begin(frame.time_us, instant);
        self.hears_bus |= heard;
        heard
    }

    /// Adds a value that was not measured by a CAN frame.
    pub fn push_value(&mut self, quantity: Quantity, time_us: u64, value: f64) {
        if self.speed_is_elsewhere {
            self.sampler.push_value(Quantity::Speed, time_us, SOME_MPS);
        }
        let instant = self.sampler.push_value(quantity, time_us, value);
        self.begin(time_us, instant);
    }

    /// Takes the position of the lift axles that was not measured by a CAN frame; NaN is none.
    pub fn follow_lift_axle(&mut self, value: f64) {
        self.sampler.follow_lift_axle(value);
    }

    fn begin(&mut self, time_us: u64, instant: Instant) {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let seconds = |us: u64| us as f64 * 1e-6;
        self.origin_s.get_or_insert(seconds(time_us) - seconds(instant.stream_us));
    }

    /// The next complete row.
    pub fn next_row(&mut self) -> Option<LogRow> {
        let sample = self.sampler.next_sample()?;
        Some(self.row(&sample))
    }

    /// The next row that still waits for other signals, for the end of a log.
    pub fn rest(&mut self) -> Option<LogRow> {
        let sample = self.sampler.rest()?;
        Some(self.row(&sample))
    }

    fn row(&mut self, sample: &Sample<f64>) -> LogRow {
        self.scale = self.sampler.scale(sample.time_us);
        #[allow(clippy::cast_precision_loss)]
        let time_s = self.origin_s.unwrap_or(0.0) + sample.time_us as f64 * 1e-6;
        let lift_axle = self.sampler.take_lift_axle();
        let mut row = LogRow { lift_axle, ..LogRow::of_sample(time_s, sample) };
        self.show_places(&mut row);
        if self.speed_is_elsewhere {
            row.speed_mps = f64::NAN;
        }
        // Whoever reads the row without the frames has nothing else that says how exact its mass is.
        // A device that knows no mass may send zero, which is none, and not an exact one.
        let has_mass = row.trailer_mass_kg > 0.0;
        let is_bare = self.without_truck && self.hears_bus && has_mass;
        if let Some(scale) = self.scale.filter(|_| is_bare) {
            let sd_kg = scale.usual_sd_kg(row.trailer_mass_kg);
            row.trailer_mass_sd_kg = sd_kg.unwrap_or(f64::NAN);
        }
        let is_old = |us: u64| sample.time_us.saturating_sub(us) > MASS_SERVES_US;
        if self.sampler.weighed_us(sample.time_us).is_some_and(is_old) {
            row.trailer_mass_kg = f64::NAN;
        }
        self.show_inclinometers(&mut row, sample.time_us);
        if self.sampler.shares_roll() {
            // The sample has the roll angle of both sensors together, so that of each in the row may be it.
            row.second_roll_rad = row.roll_rad;
        }
        let settings = self.sampler.settings();
        // What is not used stands in the row too, so that it can be told.
        let is_raw = |quantity| self.without_truck || is_unscaled(settings, quantity);
        LogRow::from_values(Signal::ALL.map(|signal| match signal.quantity() {
            // As in a sample: without a speed, the steering-wheel angle does not determine the
            // lateral acceleration.
            Some(Quantity::SteeringWheel) if self.without_truck && sample.speed_mps.is_nan() => {
                f64::NAN
            }
            Some(quantity) if !SAMPLED.contains(&signal) && is_raw(quantity) => {
                self.sampler.value(quantity, sample.time_us)
            }
            _ => row.get(signal),
        }))
    }

    /// Two inclinometers take the place of the suspension roll that follows from them, because whoever reads the row must
    /// know that it depends on their gains.
    fn show_inclinometers(&self, row: &mut LogRow, stream_us: u64) {
        let axle_rad = |quantity| self.sampler.value(quantity, stream_us);
        row.axle_tilt_rad = axle_rad(Quantity::AxleTilt);
        row.tractor_axle_tilt_rad = axle_rad(Quantity::TractorAxleTilt);
        for (suspension_rad, by_tilts_rad) in [
            (&mut row.suspension_roll_rad, row.tilt_rad - row.axle_tilt_rad),
            (
                &mut row.tractor_suspension_roll_rad,
                row.tractor_tilt_rad - row.tractor_axle_tilt_rad,
            ),
        ] {
            if suspension_rad.to_bits() == by_tilts_rad.to_bits() {
                *suspension_rad = f64::NAN;
            }
        }
    }

    /// A yaw rate of VDC2 is that of the tractor, and so is the acceleration of its path.
    fn show_places(&self, row: &mut LogRow) {
        let decoder = self.sampler.decoder();
        for (is_on_tractor, value, shown) in [
            (decoder.has_tractor_yaw(), row.yaw_rate_radps, &mut row.yaw_rate_on_tractor),
            (
                decoder.has_tractor_acceleration(),
                row.lateral_acceleration_mps2,
                &mut row.lateral_acceleration_on_tractor,
            ),
        ] {
            if self.hears_bus && is_on_tractor && !value.is_nan() {
                *shown = 1.0;
            }
        }
    }

    /// The scale on the bus from which the trailer mass in the last row follows.
    pub fn scale(&self) -> Option<Scale> {
        self.scale
    }

    /// The signals that rows can contain.
    pub fn signals(&self) -> Vec<Signal> {
        let is_mapped =
            |one: &Signal| *one == Signal::LiftAxle && self.sampler.decoder().maps_lift_axle();
        let may = |one: &Signal| self.without_truck || SAMPLED.contains(one) || is_mapped(one);
        Signal::ALL.into_iter().filter(may).collect()
    }

    /// All findings so far, as text for the user.
    pub fn remarks(&self) -> Vec<String> {
        self.sampler.remarks()
    }
}

type Bytes = BufReader<Box<dyn Read + Send>>;

/// A log of frames in one of the text formats.
enum Source {
    Candump(CandumpReader<Bytes>),
    Asc(AscReader<Bytes>),
}

pub(super) struct Frames {
    file: Box<str>,
    source: Source,
    rows: FrameRows,
    over: bool,
}

/// Whether a log with this beginning is in the format ASC.
pub(super) fn is_asc(head: &[u8]) -> bool {
    crate::can::is_asc(&String::from_utf8_lossy(head))
}

/// Whether a log with this beginning is a candump log: one of its first lines is a frame.
pub(super) fn is_candump(head: &[u8]) -> bool {
    const LINES: usize = 5;
    let text = String::from_utf8_lossy(head);
    text.lines()
        .filter(|line| !line.trim().is_empty())
        .take(LINES)
        .any(|line| matches!(parse(line), Ok(Some(_)) | Err(CandumpError::NoTime)))
}

impl Frames {
    pub(super) fn new(
        file: &str,
        stream: Box<dyn Read + Send>,
        asc: bool,
        options: &LogOptions,
    ) -> Self {
        let (bytes, bus) = (BufReader::new(stream), options.can.bus.clone());
        Self {
            file: file.into(),
            source: if asc {
                Source::Asc(AscReader::new(bytes, bus))
            } else {
                Source::Candump(CandumpReader::new(bytes, bus))
            },
            rows: FrameRows::new(options),
            over: false,
        }
    }

    pub(super) fn signals(&self) -> Vec<Signal> {
        self.rows.signals()
    }

    pub(super) fn scale(&self) -> Option<Scale> {
        self.rows.scale()
    }

    pub(super) fn position(&self) -> Position {
        Position::Line(match &self.source {
            Source::Candump(reader) => reader.line(),
            Source::Asc(reader) => reader.line(),
        })
    }

    pub(super) fn place(&self) -> Place {
        Place { file: self.file.clone(), position: self.position() }
    }

    /// Reads the next sample into `values`. Returns `false` at the end.
    pub(super) fn read(&mut self, values: &mut [f64; Signal::COUNT]) -> Result<bool, LogError> {
        loop {
            let row = if self.over { self.rows.rest() } else { self.rows.next_row() };
            if let Some(row) = row {
                *values = Signal::ALL.map(|signal| row.get(signal));
                return Ok(true);
            }
            if self.over {
                return Ok(false);
            }
            let frame = match &mut self.source {
                Source::Candump(reader) => reader.next_frame(),
                Source::Asc(reader) => reader.next_frame(),
            };
            match frame {
                Ok(Some(frame)) => {
                    self.rows.push(&frame);
                }
                Ok(None) => self.over = true,
                Err(source) => {
                    self.over = true;
                    return Err(self.fail(source));
                }
            }
        }
    }

    /// The error with the name of the file; `source` contains the line.
    fn fail(&self, source: CandumpFault) -> LogError {
        let place = Place { file: self.file.clone(), position: Position::File };
        LogError::Candump { place, source }
    }

    /// The error for a log whose frames gave no row, with possible causes.
    pub(super) fn no_rows(&self) -> LogError {
        let place = Place { file: self.file.clone(), position: Position::File };
        let remarks = self.remarks().into_iter().fold(String::new(), |all, one| all + "; " + &one);
        let frames = match &self.source {
            Source::Candump(reader) => reader.frames(),
            Source::Asc(reader) => reader.frames(),
        };
        LogError::NoSamples { place, frames, remarks: remarks.into() }
    }

    pub(super) fn remarks(&self) -> Vec<String> {
        let mut remarks = match &self.source {
            Source::Candump(reader) => reader.remarks(),
            Source::Asc(reader) => reader.remarks(),
        };
        remarks.extend(self.rows.remarks());
        remarks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::can::{MappedSignal, Vdc2};
    use crate::log::{CanOptions, Signal};
    use cg_core::AlignSettings;
    use cg_core::signal::j1939;

    /// The rows of a turn on a bus with these values.
    fn row(values: &[(Quantity, f64)]) -> LogRow {
        let settings = Some(AlignSettings::NONE);
        let mut rows = FrameRows::new(&LogOptions { settings, ..LogOptions::default() });
        for place in 0..20_u32 {
            for (quantity, value) in values {
                rows.push_value(*quantity, u64::from(place) * 20_000, *value);
            }
        }
        std::iter::from_fn(|| rows.next_row()).last().unwrap()
    }

    /// The suspension roll of two inclinometers is that of an estimator, which learns where it comes from; a measured one
    /// stays.
    #[test]
    fn inclinometers_stand_in_the_row_in_place_of_the_suspension_roll_that_follows_from_them() {
        const FORCE: (Quantity, f64) = (Quantity::LateralSpecificForce, 1.5);
        let tilts = [(Quantity::Tilt, 0.18), (Quantity::AxleTilt, 0.16), FORCE];
        let by_tilts = row(&tilts);
        let [tilt, axle, suspension] = [Signal::Tilt, Signal::AxleTilt, Signal::SuspensionRoll]
            .map(|signal| by_tilts.get(signal));
        assert!((tilt - 0.18).abs() < 1e-12 && (axle - 0.16).abs() < 1e-12, "{by_tilts:?}");
        assert!(suspension.is_nan(), "{by_tilts:?}");
        let sample = by_tilts.sample(0, &AlignSettings::NONE);
        assert!((sample.suspension_roll_rad - 0.02).abs() < 1e-12, "{sample:?}");
        let measured = row(&[&tilts[..], &[(Quantity::SuspensionRoll, 0.021)]].concat());
        assert!((measured.suspension_roll_rad - 0.021).abs() < 1e-12, "{measured:?}");
        let tractor = row(&[
            (Quantity::TractorTilt, 0.18),
            (Quantity::TractorAxleTilt, 0.15),
            (Quantity::TractorLateralSpecificForce, 1.5),
        ]);
        assert!(tractor.tractor_suspension_roll_rad.is_nan(), "{tractor:?}");
        assert!((tractor.tractor_axle_tilt_rad - 0.15).abs() < 1e-12, "{tractor:?}");
    }

    /// VDC2 has the yaw rate of the tractor, and if it compensates gravity the acceleration of its path. A mapped signal is what
    /// its quantity says, that of the trailer, and so is a value that was in no frame.
    #[test]
    fn the_motion_of_vdc2_is_that_of_the_tractor() {
        let mut data = [0xFF; 8];
        j1939::YAW_RATE.encode(0.1, &mut data);
        j1939::LATERAL_ACCELERATION.encode(1.0, &mut data);
        let frame = Frame::new(0, j1939::YAW_RATE.identifier(0x0B), true, &data).unwrap();
        let map = ["yaw_rate=VDC2.YawRate".parse().unwrap()];
        let dbc = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/can/j1939.dbc");
        let mapped = MappedSignal::load(dbc.as_ref(), &map).unwrap();
        let can = |mapped, vdc2| CanOptions { mapped, vdc2, ..CanOptions::default() };
        // What the row of a roll angle says of it.
        let place = |rows: &mut FrameRows| {
            rows.push_value(Quantity::Speed, 0, 15.0);
            rows.push_value(Quantity::Roll, 0, 0.01);
            let row = rows.rest().unwrap();
            assert!(row.yaw_rate_radps > 0.0);
            [row.yaw_rate_on_tractor, row.lateral_acceleration_on_tractor].map(|on| on > 0.0)
        };
        for (mapped, vdc2, are_of_tractor) in [
            (Vec::new(), Vdc2::SpecificForce, [true, false]),
            (Vec::new(), Vdc2::Acceleration, [true, true]),
            (mapped, Vdc2::Acceleration, [false, true]),
        ] {
            let can = can(mapped, vdc2);
            let mut rows = FrameRows::new(&LogOptions { can, ..LogOptions::default() });
            assert!(rows.push(&frame));
            assert_eq!(place(&mut rows), are_of_tractor);
        }
        let mut rows = FrameRows::new(&LogOptions::default());
        rows.push_value(Quantity::YawRate, 0, 0.1);
        assert_eq!(place(&mut rows), [false; 2]);
    }
}
