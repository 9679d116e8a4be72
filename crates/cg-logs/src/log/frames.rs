//! The rows of a CAN log: each sample that its frames make, as `cg run` would take it.

use std::io::{BufReader, Read};

use crate::can::{
    CandumpError, CandumpFault, CandumpReader, Decoder, Frame, Sampler, named, parse,
};

use super::error::{LogError, Place, Position};
use super::options::LogOptions;
use super::signal::{LogRow, Signal};

/// What a CAN log may have.
const SIGNALS: [Signal; 8] = [
    Signal::Time,
    Signal::Steer,
    Signal::Roll,
    Signal::Tilt,
    Signal::Speed,
    Signal::LateralAcceleration,
    Signal::YawRate,
    Signal::TrailerMass,
];

pub(super) struct Frames {
    file: Box<str>,
    reader: CandumpReader<BufReader<Box<dyn Read + Send>>>,
    sampler: Sampler,
    /// Time of the log less stream time, s; of the first frame, so that time never goes back.
    origin_s: Option<f64>,
    over: bool,
}

/// Whether a log that begins so is one of candump: one of its first lines is a frame's.
pub(super) fn is_candump(head: &[u8]) -> bool {
    const LINES: usize = 5;
    let text = String::from_utf8_lossy(head);
    text.lines()
        .filter(|line| !line.trim().is_empty())
        .take(LINES)
        .any(|line| matches!(parse(line), Ok(Some(_)) | Err(CandumpError::NoTime)))
}

impl Frames {
    pub(super) fn new(file: &str, stream: Box<dyn Read + Send>, options: &LogOptions) -> Self {
        let can = &options.can;
        let flipped = options.flip.iter().filter_map(|signal| named(signal.name()).ok()).collect();
        let decoder = Decoder::new(can.mapped.clone(), can.filters.clone(), flipped)
            .with_compensation(can.compensation);
        Self {
            file: file.into(),
            reader: CandumpReader::new(BufReader::new(stream), can.bus.clone()),
            sampler: Sampler::new(decoder, options.settings.unwrap_or_default()),
            origin_s: None,
            over: false,
        }
    }

    pub(super) fn signals() -> Vec<Signal> {
        SIGNALS.to_vec()
    }

    pub(super) fn position(&self) -> Position {
        Position::Line(self.reader.line())
    }

    pub(super) fn place(&self) -> Place {
        Place { file: self.file.clone(), position: self.position() }
    }

    /// Reads the next sample into `values`. `false` at the end.
    pub(super) fn read(&mut self, values: &mut [f64; Signal::COUNT]) -> Result<bool, LogError> {
        loop {
            let sample = if self.over { self.sampler.rest() } else { self.sampler.next_sample() };
            if let Some(sample) = sample {
                #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
                let time_s = self.origin_s.unwrap_or(0.0) + sample.time_us as f64 * 1e-6;
                let row = LogRow {
                    time_s,
                    steer_rad: sample.steer_rad,
                    roll_rad: sample.roll_rad,
                    tilt_rad: sample.tilt_rad,
                    speed_mps: sample.speed_mps,
                    lateral_acceleration_mps2: sample.lateral_acceleration_mps2,
                    yaw_rate_radps: sample.yaw_rate_radps,
                    trailer_mass_kg: sample.trailer_mass_kg,
                    ..LogRow::ABSENT
                };
                *values = Signal::ALL.map(|signal| row.get(signal));
                return Ok(true);
            }
            if self.over {
                return Ok(false);
            }
            match self.reader.next_frame() {
                Ok(Some(frame)) => self.take(&frame),
                Ok(None) => self.over = true,
                Err(source) => {
                    self.over = true;
                    return Err(self.fail(source));
                }
            }
        }
    }

    fn take(&mut self, frame: &Frame) {
        let instant = self.sampler.push(frame, None, |_| {});
        #[allow(clippy::cast_precision_loss)]
        let seconds = |us: u64| us as f64 * 1e-6;
        self.origin_s.get_or_insert(seconds(frame.time_us) - seconds(instant.stream_us));
    }

    /// The file's name, since the fault says the line.
    fn fail(&self, source: CandumpFault) -> LogError {
        let place = Place { file: self.file.clone(), position: Position::File };
        LogError::Candump { place, source }
    }

    /// That no frame has made a row, and what may be behind it.
    pub(super) fn no_rows(&self) -> LogError {
        let place = Place { file: self.file.clone(), position: Position::File };
        let remarks = self.remarks().into_iter().fold(String::new(), |all, one| all + "; " + &one);
        LogError::NoSamples { place, frames: self.reader.frames(), remarks: remarks.into() }
    }

    pub(super) fn remarks(&self) -> Vec<String> {
        let mut remarks = self.reader.remarks();
        remarks.extend(self.sampler.remarks());
        remarks
    }
}
