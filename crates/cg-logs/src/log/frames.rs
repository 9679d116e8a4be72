//! The rows of a CAN log: each sample that its frames make, as `cg run` would take it.

use std::io::{BufReader, Read};

use cg_core::{Quantity, Sample};

use crate::can::{CandumpError, CandumpFault, CandumpReader, Frame, Instant, Sampler, parse};

use super::error::{LogError, Place, Position};
use super::options::LogOptions;
use super::signal::{LogRow, Signal};

/// What a sample holds.
const SAMPLED: [Signal; 8] = [
    Signal::Time,
    Signal::Steer,
    Signal::Roll,
    Signal::Tilt,
    Signal::Speed,
    Signal::LateralAcceleration,
    Signal::YawRate,
    Signal::TrailerMass,
];

/// Frames to rows of a log: each sample that they make, as `cg run` takes it.
#[derive(Clone, Debug)]
pub struct FrameRows {
    sampler: Sampler,
    /// Without the truck, steering wheel and load say nothing yet: they stay in the row.
    without_truck: bool,
    /// Time of the log less stream time, s; of the first frame, so that time never goes back.
    origin_s: Option<f64>,
}

impl FrameRows {
    /// Before the first frame.
    pub fn new(options: &LogOptions) -> Self {
        Self {
            sampler: Sampler::new(options.decoder(), options.settings.unwrap_or_default()),
            without_truck: options.settings.is_none(),
            origin_s: None,
        }
    }

    /// Takes in a frame; whether it holds a value that counts. Then ask for [rows](Self::next_row).
    pub fn push(&mut self, frame: &Frame) -> bool {
        let mut heard = false;
        let instant = self.sampler.push(frame, None, |_| heard = true);
        self.begin(frame.time_us, instant);
        heard
    }

    /// Takes in a value that was measured elsewhere than in a frame.
    pub fn push_value(&mut self, quantity: Quantity, time_us: u64, value: f64) {
        let instant = self.sampler.push_value(quantity, time_us, value);
        self.begin(time_us, instant);
    }

    fn begin(&mut self, time_us: u64, instant: Instant) {
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let seconds = |us: u64| us as f64 * 1e-6;
        self.origin_s.get_or_insert(seconds(time_us) - seconds(instant.stream_us));
    }

    /// The next row that is complete.
    pub fn next_row(&mut self) -> Option<LogRow> {
        let sample = self.sampler.next_sample()?;
        Some(self.row(&sample))
    }

    /// The next row that still waits for other signals, at the end of a log.
    pub fn rest(&mut self) -> Option<LogRow> {
        let sample = self.sampler.rest()?;
        Some(self.row(&sample))
    }

    fn row(&self, sample: &Sample<f64>) -> LogRow {
        #[allow(clippy::cast_precision_loss)]
        let time_s = self.origin_s.unwrap_or(0.0) + sample.time_us as f64 * 1e-6;
        let row = LogRow::of_sample(time_s, sample);
        if !self.without_truck {
            return row;
        }
        LogRow::from_values(Signal::ALL.map(|signal| match signal.quantity() {
            // As in a sample: without a speed no angle says how fast the truck turns.
            Some(Quantity::SteeringWheel) if sample.speed_mps.is_nan() => f64::NAN,
            Some(quantity) if !SAMPLED.contains(&signal) => {
                self.sampler.value(quantity, sample.time_us)
            }
            _ => row.get(signal),
        }))
    }

    /// The signals that rows may have.
    pub fn signals(&self) -> Vec<Signal> {
        let may = |signal: &Signal| self.without_truck || SAMPLED.contains(signal);
        Signal::ALL.into_iter().filter(may).collect()
    }

    /// What was doubted so far, for people.
    pub fn remarks(&self) -> Vec<String> {
        self.sampler.remarks()
    }
}

pub(super) struct Frames {
    file: Box<str>,
    reader: CandumpReader<BufReader<Box<dyn Read + Send>>>,
    rows: FrameRows,
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
        Self {
            file: file.into(),
            reader: CandumpReader::new(BufReader::new(stream), options.can.bus.clone()),
            rows: FrameRows::new(options),
            over: false,
        }
    }

    pub(super) fn signals(&self) -> Vec<Signal> {
        self.rows.signals()
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
            let row = if self.over { self.rows.rest() } else { self.rows.next_row() };
            if let Some(row) = row {
                *values = Signal::ALL.map(|signal| row.get(signal));
                return Ok(true);
            }
            if self.over {
                return Ok(false);
            }
            match self.reader.next_frame() {
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
        remarks.extend(self.rows.remarks());
        remarks
    }
}
