//! What a check of a vehicle file says, and where in the file.

use std::fmt;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// No vehicle is like this: the file is refused.
    Error,
    /// Hardly any vehicle is like this: the file is used.
    Warning,
}

/// Something wrong or unusual in a vehicle file.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// The key, such as `trailer.axle[1].spring_spread_m`.
    pub key: String,
    /// Its value.
    pub value: String,
    /// What is wrong with it.
    pub problem: String,
    /// What is usual; empty where only the problem can say it.
    pub usual: String,
    /// What to do; empty where the problem says it.
    pub remedy: String,
}

impl Finding {
    /// A finding that has no place yet.
    pub(super) fn new(
        severity: Severity,
        key: impl Into<String>,
        value: impl fmt::Display,
        problem: impl Into<String>,
    ) -> Self {
        Self {
            severity,
            line: 1,
            column: 1,
            key: key.into(),
            value: value.to_string(),
            problem: problem.into(),
            usual: String::new(),
            remedy: String::new(),
        }
    }

    pub(super) fn error(
        key: impl Into<String>,
        value: impl fmt::Display,
        problem: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Error, key, value, problem)
    }

    /// The finding with its place in a file, as compilers write it.
    pub fn in_file(&self, file: &str) -> String {
        let warning = if self.severity == Severity::Warning { "warning: " } else { "" };
        format!("{file}:{}:{}: {warning}{self}", self.line, self.column)
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}: {}", self.key, self.value, self.problem)?;
        if !self.usual.is_empty() {
            write!(f, " (usual: {})", self.usual)?;
        }
        if !self.remedy.is_empty() {
            write!(f, "; {}", self.remedy)?;
        }
        Ok(())
    }
}

/// Gives findings their places and sorts them: errors first, then in the order of the file.
pub(super) fn located(mut findings: Vec<Finding>, text: &str) -> Vec<Finding> {
    if let Ok(root) = DeTable::parse(text) {
        for finding in &mut findings {
            (finding.line, finding.column) = place(text, &root, &finding.key);
        }
    }
    findings.sort_by_key(|finding| (finding.severity, finding.line, finding.column));
    findings
}

/// Line and column (from 1) of the value at `path` (`trailer.axle[1].tyre`), or of its nearest
/// ancestor in the file.
fn place(text: &str, root: &Spanned<DeTable<'_>>, path: &str) -> (usize, usize) {
    let mut offset = 0;
    let mut table = Some(root.get_ref());
    for step in path.split('.') {
        let mut parts = step.split('[');
        let name = parts.next().unwrap_or_default();
        let Some(mut entry) = table.and_then(|table| table.get(name)) else { break };
        offset = entry.span().start;
        for index in parts.map_while(|part| part.trim_end_matches(']').parse::<usize>().ok()) {
            let DeValue::Array(items) = entry.get_ref() else { break };
            let Some(item) = items.get(index) else { break };
            offset = item.span().start;
            entry = item;
        }
        table = match entry.get_ref() {
            DeValue::Table(table) => Some(table),
            _ => None,
        };
    }
    let before = &text[..offset.min(text.len())];
    let line = before.matches('\n').count() + 1;
    let column = before.len() - before.rfind('\n').map_or(0, |i| i + 1) + 1;
    (line, column)
}
