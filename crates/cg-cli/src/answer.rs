//! The answer for one log.

use cg_logs::estimate::LogEstimate;

use crate::report::trace::Trace;

/// The answer for one log and what is known of it.
pub(crate) struct Answer {
    /// The log's name as given.
    pub(crate) log: String,
    /// The answer.
    pub(crate) estimate: LogEstimate,
    /// Known height, if `--truth` has one.
    pub(crate) known_m: Option<f64>,
    /// Its signals, if there is to be a report.
    pub(crate) trace: Option<Trace>,
}
