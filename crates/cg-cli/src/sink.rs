//! Output of results as a table, JSON Lines or CSV on standard output.

use std::io::Write;

use cg_core::Channel;
use cg_logs::estimate::{LogEstimate, QUANTILE_95, Verdict};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use serde::Serialize;

use crate::answer::Answer;
use crate::args::Format;

pub(crate) fn write(format: Format, answers: &[Answer]) -> anyhow::Result<()> {
    if answers.is_empty() {
        return Ok(()); // no log could be read, which has been reported
    }
    match format {
        Format::Table => table(answers),
        Format::Json => json(answers),
        Format::Csv => csv(answers),
    }
}

/// One object of the JSON Lines output.
#[derive(Serialize)]
struct Line<'a> {
    log: &'a str,
    #[serde(flatten)]
    estimate: &'a LogEstimate,
    #[serde(skip_serializing_if = "Option::is_none")]
    known_height_m: Option<f64>,
}

fn json(answers: &[Answer]) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    for answer in answers {
        let line =
            Line { log: &answer.log, estimate: &answer.estimate, known_height_m: answer.known_m };
        // The line is formatted first, so that it is written completely or not at all.
        writeln!(out, "{}", serde_json::to_string(&line)?)?;
    }
    Ok(())
}

/// The columns of the CSV output.
const COLUMNS: [&str; 29] = [
    "log",
    "status",
    "height_m",
    "height_sd_m",
    "height_ci95_low_m",
    "height_ci95_high_m",
    "ratio",
    "ratio_sd",
    "method",
    "channel",
    "speed_mps",
    "trailer_mass_kg",
    "snr_db",
    "fit_percent",
    "static_rollover_threshold_g",
    "maneuvers",
    "known_height_m",
    "messages",
    "steer_height_m",
    "steer_height_sd_m",
    "lateral_acceleration_height_m",
    "lateral_acceleration_height_sd_m",
    "suspension_height_m",
    "suspension_height_sd_m",
    "tractor_height_m",
    "tractor_height_sd_m",
    "static_rollover_threshold_ci95_low_g",
    "static_rollover_threshold_ci95_high_g",
    "lift_axle",
];

fn csv(answers: &[Answer]) -> anyhow::Result<()> {
    let mut out = csv::Writer::from_writer(std::io::stdout().lock());
    out.write_record(COLUMNS)?;
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for answer in answers {
        let e = &answer.estimate;
        let alone =
            |channel: Channel| e.channels.iter().find(|alone| alone.channel == channel.to_string());
        let mut record = vec![
            answer.log.clone(),
            status(e).to_owned(),
            number(e.height_m),
            number(e.height_sd_m),
            number(e.height_ci95_m.map(|interval| interval[0])),
            number(e.height_ci95_m.map(|interval| interval[1])),
            number(e.ratio),
            number(e.ratio_sd),
            format!("{:?}", e.method).to_lowercase(),
            e.channel.clone().unwrap_or_default(),
            number(e.speed_mps),
            e.trailer_mass_kg.to_string(),
            number(e.snr_db),
            number(e.fit_percent),
            number(e.static_rollover_threshold_g),
            e.maneuvers.len().to_string(),
            number(answer.known_m),
            e.messages.join("; "),
        ];
        for alone in Channel::ALL.map(alone) {
            record.push(number(alone.and_then(|alone| alone.height_m)));
            record.push(number(alone.and_then(|alone| alone.height_sd_m)));
        }
        for end in 0..2 {
            record.push(number(e.static_rollover_threshold_ci95_g.map(|interval| interval[end])));
        }
        record.push(e.lift_axle.map_or_else(String::new, |position| position.to_string()));
        out.write_record(record)?;
    }
    out.flush()?;
    Ok(())
}

fn status(estimate: &LogEstimate) -> &'static str {
    match estimate.status {
        Verdict::Ok => "ok",
        Verdict::Rejected => "rejected",
        Verdict::Inconsistent => "inconsistent",
    }
}

fn table(answers: &[Answer]) -> anyhow::Result<()> {
    let with_truth = answers.iter().any(|answer| answer.known_m.is_some());
    let mut table = Table::new();
    table.load_preset(NOTHING);
    let mut header = vec!["log", "height", "95 % interval", "rollover at", "channel", "maneuvers"];
    if with_truth {
        header.extend(["known", "error"]);
    }
    table.set_header(header);
    for answer in answers {
        table.add_row(row(answer, with_truth));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", table.trim_fmt())?;
    for answer in answers {
        for message in &answer.estimate.messages {
            writeln!(out, "{}: {message}", answer.log)?;
        }
    }
    Ok(())
}

fn row(answer: &Answer, with_truth: bool) -> Vec<String> {
    let e = &answer.estimate;
    let good = e.maneuvers.iter().filter(|m| m.status == Verdict::Ok).count();
    let mut row = vec![answer.log.clone()];
    match (e.height_m, e.height_sd_m, e.height_ci95_m) {
        (Some(height), Some(sd), Some([low, high])) => {
            row.push(format!("{height:.3} ± {sd:.3} m"));
            row.push(format!("{low:.2} to {high:.2} m"));
        }
        _ => row.extend([status(e).to_owned(), String::new()]),
    }
    let threshold = e.static_rollover_threshold_g.zip(e.static_rollover_threshold_ci95_g);
    row.push(threshold.map_or_else(String::new, |(g, [low, _])| {
        format!("{g:.2} ± {:.2} g", (g - low) / QUANTILE_95)
    }));
    row.push(e.channel.clone().unwrap_or_default());
    row.push(format!("{good} of {}", e.maneuvers.len()));
    if with_truth {
        row.push(answer.known_m.map_or_else(String::new, |known| format!("{known:.3} m")));
        let error = e.height_m.zip(answer.known_m).map(|(h, known)| 100.0 * (h / known - 1.0));
        row.push(error.map_or_else(String::new, |error| format!("{error:+.1} %")));
    }
    row
}
