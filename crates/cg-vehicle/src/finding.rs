//! Findings of the check of a vehicle file: errors and warnings.

use std::fmt;

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Severity {
    /// No vehicle can have this value: the file is refused.
    Error,
    /// Hardly any vehicle has this value: the file is used.
    Warning,
}

/// An impossible or unusual value in a vehicle file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Finding {
    /// Error or warning.
    pub severity: Severity,
    /// Line in the file, from 1.
    pub line: usize,
    /// Column in the file, from 1.
    pub column: usize,
    /// The key, such as `trailer.axle[1].spring_spread_m`.
    pub key: String,
    /// Its value.
    pub value: String,
    /// What is wrong with it.
    pub problem: String,
    /// The usual values; empty if the problem contains them.
    pub usual: String,
    /// How to correct it; empty if the problem contains it.
    pub remedy: String,
}

impl Finding {
    /// A finding whose position is not set yet.
    pub(crate) fn new(
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

    pub(crate) fn error(
        key: impl Into<String>,
        value: impl fmt::Display,
        problem: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Error, key, value, problem)
    }

    /// The finding with its position in a file, in the form of compiler messages.
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

/// A number of a vehicle and its distance from the usual values.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Unusual {
    /// The key, such as `trailer.axle[1].spring_spread_m`.
    pub key: String,
    /// Its value.
    pub value: f64,
    /// The usual values.
    pub usual: String,
    /// The value of [`Range::distance`](crate::check::Range::distance): above 1, the number is
    /// outside the usual range.
    pub distance: f64,
}

/// `low to high unit`.
pub(crate) fn span([low, high]: [f64; 2], unit: &str) -> String {
    format!("{} to {} {unit}", plain(low), plain(high)).trim_end().to_owned()
}

/// A number in its usual notation.
pub(crate) fn plain(value: f64) -> String {
    if value == 0.0 || (1e-4..1e7).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}
