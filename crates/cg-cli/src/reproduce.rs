//! `cg reproduce`: the thesis's tables with the printed and the recomputed values.

use std::io::Write;

use anyhow::Context;
use cg_output::Files;
use cg_thesis::catalog::{Kind, catalog};
use cg_thesis::reproduce::{Options, Row, figure_names, figures, table, tables, title};
use cg_thesis::verdict::Verdict;
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ContentArrangement, Table};

use crate::args::ModelFormat;
use crate::cli::ReproduceArgs;
use crate::flags::with_flags;
use crate::outcome::Outcome;
use crate::study::write_all;

pub(crate) fn run(arguments: &ReproduceArgs, files: Files) -> anyhow::Result<Outcome> {
    let options = Options { runs: arguments.runs, seed: arguments.seed };
    if let Some(folder) = &arguments.figures {
        let compute = || Ok(figures(&options)?);
        for name in write_all(figure_names(), folder, files, compute)? {
            writeln!(std::io::stdout(), "written: {name}")
                .context("standard output: cannot be written")?;
        }
        return Ok(Outcome::Done);
    }
    if arguments.list {
        return list(arguments.format, &options);
    }
    let names = match &arguments.table {
        Some(name) => &[name.as_str()][..],
        None => tables(),
    };
    let mut out = std::io::stdout().lock();
    for (i, name) in names.iter().enumerate() {
        let rows = table(name, &options)?;
        match arguments.format {
            ModelFormat::Json => json(&mut out, &rows)?,
            ModelFormat::Table => {
                if i > 0 {
                    writeln!(out).context("standard output: cannot be written")?;
                }
                print(&mut out, title(name)?, &rows)
                    .context("standard output: cannot be written")?;
            }
        }
    }
    Ok(Outcome::Done)
}

/// Width of the printed list in characters.
const WIDTH: u16 = 150;

/// Prints every table and figure of the thesis with its verdict.
fn list(format: ModelFormat, options: &Options) -> anyhow::Result<Outcome> {
    let mut entries = catalog(options)?;
    for entry in &mut entries {
        entry.command = with_flags(&entry.command);
    }
    let mut out = std::io::stdout().lock();
    let written = match format {
        ModelFormat::Json => {
            entries.iter().try_for_each(|entry| writeln!(out, "{}", serde_json::json!(entry)))
        }
        ModelFormat::Table => {
            let mut table = Table::new();
            table.load_preset(NOTHING);
            table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
            table.set_header(["", "subject", "verdict", "shown by"]);
            for entry in &entries {
                let kind = if entry.kind == Kind::Table { "Table" } else { "Fig." };
                let because = match entry.verdict {
                    Verdict::Same => format!("same: {}", entry.because),
                    verdict => format!("{verdict} because: {}", entry.because),
                };
                let number = format!("{kind} {}", entry.number);
                table.add_row([number, entry.subject.clone(), because, entry.command.clone()]);
            }
            writeln!(out, "{}", table.trim_fmt())
        }
    };
    written.context("standard output: cannot be written")?;
    Ok(Outcome::Done)
}

fn json(out: &mut impl Write, rows: &[Row]) -> anyhow::Result<()> {
    for row in rows {
        // The line is formatted first, so that it is written completely or not at all.
        writeln!(out, "{}", serde_json::to_string(row)?)
            .context("standard output: cannot be written")?;
    }
    Ok(())
}

/// Prints the title, one line for each number, and each reason and note once below.
fn print(out: &mut impl Write, title: &str, rows: &[Row]) -> std::io::Result<()> {
    let (mut notes, mut reasons): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    let mut table = Table::new();
    table.load_preset(NOTHING);
    table.set_header(["", "thesis", "ours", "difference", "the same within", "verdict", "note"]);
    for row in rows {
        let note = row.note.as_deref().map_or_else(String::new, |note| {
            let known = notes.iter().position(|other| *other == note);
            let number = known.unwrap_or_else(|| {
                notes.push(note);
                notes.len() - 1
            });
            format!("[{}]", number + 1)
        });
        let within = match (row.criterion, row.criterion_reason) {
            (Some(half_width), Some(reason)) => {
                let known = reasons.iter().position(|other| *other == reason);
                let number = known.unwrap_or_else(|| {
                    reasons.push(reason);
                    reasons.len() - 1
                });
                format!("{half_width:.1e} ({})", letter(number))
            }
            _ => String::new(),
        };
        table.add_row([
            row.item.clone(),
            row.thesis.map_or_else(String::new, |value| digits(value, row.rounding, 0)),
            row.ours.map_or_else(|| "–".to_owned(), |value| digits(value, row.rounding, 1)),
            row.relative_error.map_or_else(String::new, difference),
            within,
            row.verdict.to_string(),
            note,
        ]);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    writeln!(out, "{title}")?;
    writeln!(out, "{}", table.trim_fmt())?;
    for (k, reason) in reasons.iter().enumerate() {
        writeln!(out, " ({}) {reason}", letter(k))?;
    }
    for (k, note) in notes.iter().enumerate() {
        writeln!(out, " [{}] {note}", k + 1)?;
    }
    Ok(())
}

/// The letter of a reason: there are few.
fn letter(number: usize) -> char {
    ('a'..='z').nth(number).unwrap_or('z')
}

/// A relative difference in percent, with enough decimals to show it.
fn difference(relative: f64) -> String {
    let percent = 100.0 * relative;
    if percent.abs() < 0.000_05 { "0.0000 %".to_owned() } else { format!("{percent:+.4} %") }
}

/// A number with the digits that the thesis prints plus `more`; five digits if it prints none.
fn digits(value: f64, rounding: Option<f64>, more: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = power_of_ten(value.abs());
    // Decimal place of the last digit: −2 for hundredths.
    let last = match rounding {
        None => magnitude - 4,
        // A recomputed value may be so small that this decimal place shows nothing.
        Some(rounding) if more > 0 && value.abs() > rounding => {
            (power_of_ten(2.5 * rounding) - more).min(magnitude - 3)
        }
        Some(rounding) => power_of_ten(2.5 * rounding) - more,
    };
    if (-4..6).contains(&magnitude) {
        let decimals = usize::try_from(-last).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        let decimals = usize::try_from(magnitude - last).unwrap_or(0);
        format!("{value:.decimals$e}")
    }
}

#[allow(clippy::cast_possible_truncation)] // the exponent of a finite number
fn power_of_ten(value: f64) -> i32 {
    libm::log10(value).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_of_the_source_and_ours_one_more() {
        for (value, rounding, more, text) in [
            (77.69, Some(0.005), 0, "77.69"),
            (77.6949, Some(0.005), 1, "77.695"),
            (-4.5839e25, Some(0.5e21), 0, "-4.5839e25"),
            (-4.58396e25, Some(0.5e21), 1, "-4.58396e25"),
            (9.7715e-5, Some(0.5e-9), 0, "9.7715e-5"),
            (7028.0, Some(0.5), 0, "7028"),
            (0.0, Some(0.05), 1, "0"),
            (0.567_648, None, 1, "0.56765"),
            (1234.56, None, 1, "1234.6"),
        ] {
            assert_eq!(digits(value, rounding, more), text);
        }
    }
}
