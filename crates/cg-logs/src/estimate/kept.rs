//! What is kept of a maneuver beside what the estimator says.

use serde::{Deserialize, Serialize};

use super::windward::Gust;

/// What is known of a maneuver beside what the estimator says.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Kept {
    /// Whether a signal gave its mass.
    pub(super) is_weighed: bool,
    pub(super) gust: Gust,
}

/// When and how a maneuver ended.
#[derive(Clone, Copy, Debug)]
pub struct Ended {
    /// Time of its end, s.
    pub time_s: f64,
    /// Whether its mass is from a signal.
    pub is_weighed: bool,
    /// What a wind makes of its ratios.
    pub gust: Gust,
}
