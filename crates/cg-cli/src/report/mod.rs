//! `cg estimate --report`: an HTML page that contains everything and loads nothing from the
//! network.
//!
//! The page is a template with its style, its script and the results as JSON; the script draws the
//! plots. Texts from logs are inserted as text, never as markup.

pub(crate) mod trace;

use std::path::Path;

use cg_logs::estimate::LogEstimate;
use cg_logs::output::{Draft, Target};
use chrono::Utc;
use serde::Serialize;

use crate::answer::Answer;
use crate::web;

pub(crate) use trace::Trace;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Maximum number of points of all logs together: a few hundred KiB, and 1.3 MiB with every signal.
const POINTS: usize = 24_000;
/// Maximum and minimum number of points of one log.
const MOST_POINTS: usize = 240;
const LEAST_POINTS: usize = 24;

/// The number of points of each log, for this number of logs.
pub(crate) fn room(logs: usize) -> usize {
    (POINTS / logs.max(1)).clamp(LEAST_POINTS, MOST_POINTS)
}

/// The data of the batch.
pub(crate) struct About<'a> {
    pub(crate) vehicle: &'a str,
    pub(crate) calibration: Option<&'a Path>,
    /// Logs that could not be read, with the reason.
    pub(crate) unreadable: &'a [(String, String)],
}

#[derive(Serialize)]
struct Page<'a> {
    title: String,
    vehicle: &'a str,
    calibration: Option<String>,
    written: String,
    version: &'static str,
    logs: Vec<Log<'a>>,
}

#[derive(Serialize)]
#[allow(clippy::struct_field_names)] // `log` is its key in every output
struct Log<'a> {
    log: &'a str,
    #[serde(flatten)]
    estimate: Option<&'a LogEstimate>,
    known_height_m: Option<f64>,
    /// The reason why the log could not be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    unreadable: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    signals: Option<trace::Signals>,
}

/// Writes a draft of the page; [`Draft::publish`] gives it its name.
pub(crate) fn write(
    target: &Target,
    about: &About,
    answers: &[Answer],
) -> anyhow::Result<Option<Draft>> {
    let read = answers.iter().map(|answer| Log {
        log: &answer.log,
        estimate: Some(&answer.estimate),
        known_height_m: answer.known_m,
        unreadable: None,
        signals: answer.trace.as_ref().map(Trace::signals),
    });
    let unread = about.unreadable.iter().map(|(log, why)| Log {
        log,
        estimate: None,
        known_height_m: None,
        unreadable: Some(why),
        signals: None,
    });
    let page = Page {
        title: format!("C.g. heights, {}", about.vehicle),
        vehicle: about.vehicle,
        calibration: about.calibration.map(|path| path.display().to_string()),
        written: Utc::now().format("%Y-%m-%d %H:%M UTC").to_string(),
        version: env!("CARGO_PKG_VERSION"),
        logs: read.chain(unread).collect(),
    };
    // The data contain no `<`, so they cannot end the script element or begin a comment.
    let data = serde_json::to_string(&page)?.replace('<', "\\u003c");
    Ok(target.write(&fill(&data))?)
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
