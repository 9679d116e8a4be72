//! Every numbered table and figure of chapters 2 to 5 and of appendix C, with one verdict each.
//!
//! The list is data (`fixtures/thesis/captions.toml`); the verdicts are those of the rows of
//! [`reproduce`](crate::reproduce) and of the statements of [`study`](mod@crate::study). A table or figure
//! is the same if all its numbers are. Studies run with the thesis's printed inputs, and once more with the
//! measured file of this project where the two differ.

use std::collections::BTreeMap;

use cg_vehicle::Vehicle;
use cg_vehicle::error::VehicleError;
use serde::{Deserialize, Serialize};

use crate::reproduce::{Options, Row, table};
use crate::study::{Statement, Study, study};
use crate::verdict::Verdict;

/// Whether a caption belongs to a table or to a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A numbered table.
    Table,
    /// A numbered figure.
    Figure,
}

/// A table or figure of the thesis and its verdict. Field names are the keys of the JSON output.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Entry {
    /// Table or figure.
    pub kind: Kind,
    /// Its number.
    pub number: String,
    /// Its subject.
    pub subject: String,
    /// Whether it is reproduced.
    pub verdict: Verdict,
    /// Why it differs or cannot be computed; how many numbers agree, if it is the same.
    pub because: String,
    /// The command that shows it; empty if nothing is computed.
    pub command: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Captions {
    caption: Vec<Caption>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Caption {
    kind: Kind,
    number: String,
    subject: String,
    reproduce: Option<String>,
    study: Option<String>,
    because: Option<String>,
}

/// What was computed so far, so that each table and study is computed once.
struct Computed<'a> {
    options: &'a Options,
    printed_inputs: Vehicle,
    tables: BTreeMap<String, Vec<Row>>,
    studies: BTreeMap<String, [Study; 2]>,
}

/// All tables and figures with their verdicts; takes about half a minute.
///
/// # Errors
/// [`VehicleError`] if a table or study cannot be computed.
pub fn catalog(options: &Options) -> Result<Vec<Entry>, VehicleError> {
    let name = "fixtures/thesis/captions.toml";
    let captions: Captions = toml::from_str(include_str!("../fixtures/thesis/captions.toml"))
        .map_err(|source| VehicleError::syntax(name, &source))?;
    let printed_inputs = Vehicle::parse(
        include_str!("../fixtures/vehicles/baseline-printed.toml"),
        "fixtures/vehicles/baseline-printed.toml",
    )?;
    let (tables, studies) = (BTreeMap::new(), BTreeMap::new());
    let mut computed = Computed { options, printed_inputs, tables, studies };
    captions.caption.into_iter().map(|caption| computed.entry(caption)).collect()
}

impl Computed<'_> {
    fn entry(&mut self, caption: Caption) -> Result<Entry, VehicleError> {
        let (verdict, because, command) = match (&caption.reproduce, &caption.study) {
            (Some(name), _) => {
                let (verdict, because) = self.of_table(name, &caption)?;
                (verdict, because, format!("cg reproduce ⟨table {name}⟩"))
            }
            (None, Some(name)) => {
                let (verdict, because) = self.of_study(name, &caption.number)?;
                let file = "fixtures/vehicles/baseline-printed.toml";
                (verdict, because, format!("cg study {name} ⟨vehicle {file}⟩"))
            }
            (None, None) => {
                (Verdict::NotComputed, caption.because.clone().unwrap_or_default(), String::new())
            }
        };
        let Caption { kind, number, subject, .. } = caption;
        Ok(Entry { kind, number, subject, verdict, because, command })
    }

    fn of_table(
        &mut self,
        name: &str,
        caption: &Caption,
    ) -> Result<(Verdict, String), VehicleError> {
        if !self.tables.contains_key(name) {
            self.tables.insert(name.to_owned(), table(name, self.options)?);
        }
        // The rows of one of several tables or figures begin with its name.
        let own = match caption.kind {
            Kind::Table => format!("Table {}:", caption.number),
            Kind::Figure => format!("{} ", caption.number),
        };
        let all = &self.tables[name];
        let shared = matches!(name, "inputs" | "C");
        let rows: Vec<&Row> =
            all.iter().filter(|row| !shared || row.item.starts_with(&own)).collect();
        Ok(of_rows(&rows))
    }

    fn of_study(&mut self, name: &str, figure: &str) -> Result<(Verdict, String), VehicleError> {
        if !self.studies.contains_key(name) {
            let both = [study(name, Some(&self.printed_inputs))?, study(name, None)?];
            self.studies.insert(name.to_owned(), both);
        }
        let [printed, measured] = &self.studies[name];
        let (verdict, because) = of_statements(&printed.about(figure).collect::<Vec<_>>());
        let (other, why) = of_statements(&measured.about(figure).collect::<Vec<_>>());
        if other == verdict {
            return Ok((verdict, because));
        }
        Ok((verdict, format!("{because}; with baseline-tables.toml {other}: {why}")))
    }
}

/// The verdict on several numbers: the same if all are.
fn of_rows(rows: &[&Row]) -> (Verdict, String) {
    let compared = rows.iter().filter(|row| row.criterion.is_some()).count();
    let different: Vec<&&Row> = rows.iter().filter(|row| row.verdict == Verdict::Differs).collect();
    // A misprint explains itself; the others come first.
    let first = different.iter().find(|row| !row.is_misprint()).or(different.first());
    match first {
        _ if compared == 0 => (
            Verdict::NotComputed,
            "the thesis prints no numbers of the curves; ours are shown".to_owned(),
        ),
        None => (Verdict::Same, format!("all of {compared} numbers")),
        Some(first) => {
            let note = first.note.as_deref().unwrap_or_default();
            let why = note
                .split("; ")
                .find(|part| part.starts_with("misprint") || part.starts_with("differs because"));
            let why = why.unwrap_or(note).trim_start_matches("differs because ").to_owned();
            (Verdict::Differs, format!("{} of {compared} numbers: {why}", different.len()))
        }
    }
}

/// The verdict on the statements about a figure: the same if all are.
fn of_statements(statements: &[&Statement]) -> (Verdict, String) {
    let different: Vec<&&Statement> =
        statements.iter().filter(|s| s.verdict() != Verdict::Same).collect();
    match different.first() {
        _ if statements.is_empty() => (
            Verdict::NotComputed,
            "the thesis prints no numbers of the curves; ours are drawn".to_owned(),
        ),
        None => (Verdict::Same, statements[0].ours.clone()),
        Some(first) => (first.verdict(), format!("{}: {}", first.ours, first.because)),
    }
}
