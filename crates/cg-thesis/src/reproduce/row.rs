//! One number of the thesis beside ours.

use serde::Serialize;

use super::printed::Printed;

/// One number of the thesis beside ours. Field names are the keys of the JSON output.
///
/// Units and signs are the thesis's (y to the right, z down: ratios of roll to steer are
/// negative there, positive in ISO 8855 and everywhere else in this crate).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The table, as [`tables`](super::tables) names it.
    pub table: &'static str,
    /// What the number is, with its unit.
    pub item: String,
    /// As printed; `None` if the thesis has no such number.
    pub thesis: Option<f64>,
    /// As computed here; `None` if that cannot be.
    pub ours: Option<f64>,
    /// `(ours − thesis)/|thesis|`; `None` where it would mean nothing.
    pub relative_error: Option<f64>,
    /// What is to be said of it: always there if `thesis` or `ours` is not.
    pub note: Option<String>,
    /// Half a unit of the last printed digit of `thesis`.
    #[serde(skip)]
    pub rounding: Option<f64>,
}

impl Row {
    /// Ours beside a printed number that it should agree with.
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

    /// Ours beside a printed number that need not agree with it; the note says why.
    pub(super) fn against(
        table: &'static str,
        item: impl Into<String>,
        printed: &Printed,
        ours: f64,
        note: impl Into<String>,
    ) -> Self {
        Self::beside(table, item, printed, ours).noted(note)
    }

    /// Ours where the thesis has no such number; the note says what it is for.
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

    /// A printed number that cannot be computed; the note says why.
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

    /// With something to say, after what there is already.
    #[must_use]
    pub(super) fn noted(mut self, note: impl Into<String>) -> Self {
        let note = note.into();
        self.note = Some(match self.note {
            Some(first) => format!("{first}; {note}"),
            None => note,
        });
        self
    }

    /// With the error relative to `size` in place of the printed number.
    #[must_use]
    pub(super) fn relative_to(mut self, size: f64) -> Self {
        self.relative_error =
            self.thesis.zip(self.ours).map(|(thesis, ours)| (ours - thesis) / size.abs());
        self
    }

    /// Without a relative error: the two are not estimates of the same number.
    #[must_use]
    pub(super) fn not_comparable(self) -> Self {
        Self { relative_error: None, ..self }
    }

    /// Whether the printed number is a misprint (the note says what it should be).
    pub fn is_misprint(&self) -> bool {
        self.note.as_ref().is_some_and(|note| note.starts_with("misprint"))
    }

    /// Whether ours rounds to the printed digits; `None` without a printed number.
    pub fn agrees(&self) -> Option<bool> {
        let (difference, rounding) = (self.ours? - self.thesis?, self.rounding?);
        // Ties may fall to either side, and decimal fractions are not exact in binary.
        Some(difference.abs() <= rounding * (1.0 + 1e-9))
    }
}
