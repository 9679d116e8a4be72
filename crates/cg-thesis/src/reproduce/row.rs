//! One number of the thesis and the recomputed one.

use serde::Serialize;

use super::printed::Printed;
use crate::verdict::{Criterion, Verdict};

/// One number of the thesis and the recomputed one. Field names are the keys of the JSON output.
///
/// Units and signs are those of the thesis (y to the right, z down: ratios of roll to steer are
/// negative there, but positive in ISO 8855 and everywhere else in this crate).
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Row {
    /// The name of the table, see [`tables`](super::tables).
    pub table: &'static str,
    /// The quantity, with its unit.
    pub item: String,
    /// The printed value; `None` if the thesis has no such number.
    pub thesis: Option<f64>,
    /// The recomputed value; `None` if it cannot be computed.
    pub ours: Option<f64>,
    /// `(ours − thesis)/|thesis|`; `None` if it would have no meaning.
    pub relative_error: Option<f64>,
    /// An explanation; always present if `thesis` or `ours` is not.
    pub note: Option<String>,
    /// Half the width of the range around `thesis` in which `ours` is the same; `None` if one of them is
    /// missing.
    pub criterion: Option<f64>,
    /// Why the range is that wide.
    pub criterion_reason: Option<&'static str>,
    /// Whether they are the same. [`Verdict::Differs`] and [`Verdict::NotComputed`] have a note.
    pub verdict: Verdict,
    /// Half a unit of the last printed digit of `thesis`.
    #[serde(skip)]
    pub rounding: Option<f64>,
    /// What `relative_error` is relative to.
    #[serde(skip)]
    pub(super) size: f64,
}

/// The criterion of rows that have no other.
const ROUNDING: &str = "half a unit of the last printed digit";

impl Row {
    /// A recomputed number that should agree with the printed one.
    pub(super) fn beside(
        table: &'static str,
        item: impl Into<String>,
        printed: &Printed,
        ours: f64,
    ) -> Self {
        let thesis = printed.value;
        let row = Self {
            thesis: Some(thesis),
            relative_error: (thesis != 0.0).then(|| (ours - thesis) / thesis.abs()),
            note: printed.misprint.as_ref().map(|misprint| format!("misprint: {}", misprint.why)),
            rounding: Some(printed.rounding),
            size: thesis.abs(),
            ..Self::ours(table, item, ours, "")
        };
        row.within(printed.rounding, ROUNDING)
    }

    /// A recomputed number that need not agree with the printed one; the note states why.
    pub(super) fn against(
        table: &'static str,
        item: impl Into<String>,
        printed: &Printed,
        ours: f64,
        note: impl Into<String>,
    ) -> Self {
        Self::beside(table, item, printed, ours).noted(note)
    }

    /// A recomputed number that is not in the thesis; the note states its purpose.
    pub(super) fn ours(
        table: &'static str,
        item: impl Into<String>,
        ours: f64,
        note: impl Into<String>,
    ) -> Self {
        Self {
            table,
            item: item.into(),
            thesis: None,
            ours: Some(ours),
            relative_error: None,
            note: Some(note.into()),
            criterion: None,
            criterion_reason: None,
            verdict: Verdict::NotPrinted,
            rounding: None,
            size: 0.0,
        }
    }

    /// Appends a note.
    #[must_use]
    pub(super) fn noted(mut self, note: impl Into<String>) -> Self {
        let note = note.into();
        self.note = Some(match self.note {
            Some(first) => format!("{first}; {note}"),
            None => note,
        });
        self
    }

    /// The row with the error relative to `size` instead of the printed number.
    #[must_use]
    pub(super) fn relative_to(mut self, size: f64) -> Self {
        self.relative_error =
            self.thesis.zip(self.ours).map(|(thesis, ours)| (ours - thesis) / size.abs());
        self.size = size.abs();
        self
    }

    /// The row without a relative error, because the two are not estimates of the same number.
    #[must_use]
    pub(super) fn not_comparable(self) -> Self {
        Self { relative_error: None, ..self }
    }

    /// The row without a criterion, because no number of ours can be compared with the printed one.
    #[must_use]
    pub(super) fn undetermined(self, why: &str) -> Self {
        let row = self.not_comparable().noted(why);
        Self { criterion: None, criterion_reason: None, verdict: Verdict::NotComputed, ..row }
    }

    /// The row with another criterion: `half_width` to either side of the printed number.
    #[must_use]
    pub(super) fn within(mut self, half_width: f64, reason: &'static str) -> Self {
        if let (Some(thesis), Some(ours)) = (self.thesis, self.ours) {
            self.criterion = Some(half_width);
            self.criterion_reason = Some(reason);
            self.verdict = Criterion::around(thesis, half_width, reason).judge(ours);
        }
        self
    }

    /// The same row with another number in place of ours, judged again.
    #[must_use]
    pub fn with_ours(self, ours: f64) -> Self {
        let relative_error = self.relative_error.zip(self.thesis);
        let relative_error = relative_error.map(|(_, thesis)| (ours - thesis) / self.size);
        let row = Self { ours: Some(ours), relative_error, ..self };
        match (row.criterion, row.criterion_reason) {
            (Some(half_width), Some(reason)) => row.within(half_width, reason),
            _ => row,
        }
    }

    /// Whether the printed number is a misprint (the note gives the correct one).
    pub fn is_misprint(&self) -> bool {
        self.note.as_ref().is_some_and(|note| note.starts_with("misprint"))
    }

    /// Whether the recomputed number rounds to the printed digits; `None` without a printed number.
    pub fn agrees(&self) -> Option<bool> {
        let (difference, rounding) = (self.ours? - self.thesis?, self.rounding?);
        // Ties may fall to either side, and decimal fractions are not exact in binary.
        Some(difference.abs() <= rounding * (1.0 + 1e-9))
    }
}
