//! Doubt whether the mass is that of the load on the trailer.

/// Whether turns say that another load is on the trailer than the one of the mass.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DoubtedMass {
    /// Whether the height is not shown.
    pub(crate) hides: bool,
    /// Whether it is not shown because the mass was of before a restart, or some minutes old.
    pub(crate) was_old: bool,
    /// Whether the last turn gave an impossible height that was too high; `None` if it gave no impossible one.
    pub(crate) is_high: Option<bool>,
}
