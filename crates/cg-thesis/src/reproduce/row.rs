//! One number of the thesis and the recomputed one.

use serde::Serialize;

use super::printed::Printed;

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
    /// Half a unit of the last printed digit of `thesis`.
    #[serde(skip)]
    pub rounding: Option<f64>,
}

impl Row {
    /// A recomputed number that should agree with the printed one.
    pub(super) fn beside(
        table: &'static str,
        item: impl Into<String>,
        printed: &Printed,
        ours: f64,
    ) -> Self {
        let thesis = printed.value;
        Self {
            table,
            item: item.into(),
            thesis: Some(thesis),
            ours: Some(ours),
            relative_error: (thesis != 0.0).then(|| (ours - thesis) / thesis.abs()),
            note: printed.misprint.as_ref().map(|misprint| format!("misprint: {}", misprint.why)),
            rounding: Some(printed.rounding),
        }
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
            rounding: None,
        }
    }

    /// A printed number that cannot be recomputed; the note states why.
    pub(super) fn missing(
        table: &'static str,
        item: impl Into<String>,
        printed: &Printed,
        note: impl Into<String>,
    ) -> Self {
        Self {
            table,
            item: item.into(),
            thesis: Some(printed.value),
            ours: None,
            relative_error: None,
            note: Some(note.into()),
            rounding: Some(printed.rounding),
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
        self
    }

    /// The row without a relative error, because the two are not estimates of the same number.
    #[must_use]
    pub(super) fn not_comparable(self) -> Self {
        Self { relative_error: None, ..self }
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
