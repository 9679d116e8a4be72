//! The report of `cg estimate --report` and of Python: an HTML page that contains everything and loads nothing from the
//! network.
//!
//! The page is a template with its style, its script and the results as JSON; the script draws the
//! plots. Texts from logs are inserted as text, never as markup.

mod trace;

use chrono::Utc;
use serde::Serialize;
use serde_json::Value;

use crate::estimate::LogEstimate;
use crate::web;

pub use trace::Trace;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Maximum number of points of all logs together: a few hundred KiB, and 1.3 MiB with every signal.
const POINTS: usize = 24_000;
/// Maximum and minimum number of points of one log.
const MOST_POINTS: usize = 240;
const LEAST_POINTS: usize = 24;

/// The number of points of the [`Trace`] of each log, for this number of logs.
pub fn room(logs: usize) -> usize {
    (POINTS / logs.max(1)).clamp(LEAST_POINTS, MOST_POINTS)
}

/// A log of the report.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    log: String,
    #[serde(flatten)]
    estimate: Option<Value>,
    known_height_m: Option<f64>,
    /// The reason why the log could not be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    unreadable: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    signals: Option<Value>,
}

impl Entry {
    /// A log with its result, its height if it is known, and its signals.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn new(
        log: &str,
        estimate: &LogEstimate,
        known_height_m: Option<f64>,
        trace: Option<&Trace>,
    ) -> serde_json::Result<Self> {
        let signals = trace.map(Trace::to_json).transpose()?;
        Self::from_json(log, &serde_json::to_string(estimate)?, known_height_m, signals.as_deref())
    }

    /// The same, with the result and the signals as JSON objects.
    ///
    /// # Errors
    /// If one of them is no JSON.
    pub fn from_json(
        log: &str,
        estimate: &str,
        known_height_m: Option<f64>,
        signals: Option<&str>,
    ) -> serde_json::Result<Self> {
        Ok(Self {
            log: log.to_owned(),
            estimate: Some(serde_json::from_str(estimate)?),
            known_height_m,
            unreadable: None,
            signals: signals.map(serde_json::from_str).transpose()?,
        })
    }

    /// A log that could not be read, with the reason.
    #[must_use]
    pub fn unreadable(log: &str, reason: &str) -> Self {
        Self {
            log: log.to_owned(),
            estimate: None,
            known_height_m: None,
            unreadable: Some(reason.to_owned()),
            signals: None,
        }
    }
}

#[derive(Serialize)]
struct Page<'a> {
    title: String,
    vehicle: &'a str,
    calibration: Option<&'a str>,
    written: String,
    version: &'static str,
    logs: &'a [Entry],
}

/// The page of a batch of logs: the name of the vehicle, the path of its calibration, the logs.
///
/// # Errors
/// If a number is not finite.
pub fn page(
    vehicle: &str,
    calibration: Option<&str>,
    logs: &[Entry],
) -> serde_json::Result<String> {
    let page = Page {
        title: format!("C.g. heights, {vehicle}"),
        vehicle,
        calibration,
        written: Utc::now().format("%Y-%m-%d %H:%M UTC").to_string(),
        version: env!("CARGO_PKG_VERSION"),
        logs,
    };
    // The data contain no `<`, so they cannot end the script element or begin a comment.
    Ok(fill(&serde_json::to_string(&page)?.replace('<', "\\u003c")))
}

fn fill(data: &str) -> String {
    web::fill(
        PAGE,
        &[
            ("{{base}}", web::STYLE),
            ("{{style}}", STYLE),
            ("{{data}}", data),
            ("{{chart}}", web::SCRIPT),
            ("{{script}}", SCRIPT),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_has_each_part_once_and_nothing_from_elsewhere() {
        let page = fill("{\"logs\":[]}");
        web::check(&page);
        assert!(page.contains("{\"logs\":[]}"));
    }

    #[test]
    fn many_logs_share_the_room() {
        assert_eq!((room(1), room(100), room(10_000)), (240, 240, 24));
    }
}
