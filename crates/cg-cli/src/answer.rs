//! The result for one log.

use cg_logs::estimate::LogEstimate;
use cg_logs::report::Trace;

/// The result for one log with its known height and its signals.
pub(crate) struct Answer {
    /// Name of the log as given.
    pub(crate) log: String,
    /// The result.
    pub(crate) estimate: LogEstimate,
    /// Known height, if the file of `--truth` contains it.
    pub(crate) known_m: Option<f64>,
    /// Signals of the log, if a report is written.
    pub(crate) trace: Option<Trace>,
}
