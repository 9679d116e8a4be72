//! One channel on its way: its identifier, the state of rest that it starts from, its heights.

use crate::condition::{Row, seconds};
use crate::height::Fusion;
use crate::identify::Identify;
use crate::real::Real;
use crate::settings::Settings;

/// One channel's identifier, the time of its last sample, and the heights that it gave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lane<T: Real, I> {
    pub(crate) identifier: I,
    pub(crate) last_us: Option<u64>,
    settled_us: u64,
    rest: Rest<T>,
    pub(crate) fusion: Fusion<T>,
    /// Whether its last height was one that this trailer cannot have, and the other channel says
    /// nothing that would put the blame on this one's input.
    pub(crate) impossible: bool,
}

/// The state of rest that an identifier starts from: the mean input of some straight driving,
/// since the noise of a single sample would be taken for a turn that has just ended.
#[derive(Clone, Copy, Debug)]
struct Rest<T> {
    until_us: u64,
    rows: T,
    mean_rad: T,
}

impl<T: Real> Rest<T> {
    const fn new(until_us: u64) -> Self {
        Self { until_us, rows: T::ZERO, mean_rad: T::ZERO }
    }

    fn with(&mut self, expected_rad: T) -> T {
        self.rows += T::one();
        self.mean_rad += (expected_rad - self.mean_rad) / self.rows;
        self.mean_rad
    }
}

impl<T: Real, I: Identify<T>> Lane<T, I> {
    /// Before the first row.
    pub(crate) const EMPTY: Self = Self {
        identifier: I::EMPTY,
        last_us: None,
        settled_us: 0,
        rest: Rest::new(0),
        fusion: Fusion::new(),
        impossible: false,
    };

    /// Hands a row to the identifier: roll expected of this channel's input, and whether it counts.
    pub(crate) fn identify(
        &mut self,
        row: &Row<T>,
        expected_rad: T,
        usable: bool,
        settings: &Settings<T>,
    ) {
        if !expected_rad.present() {
            return;
        }
        let interval_us = self.last_us.map(|last_us| row.time_us.saturating_sub(last_us));
        match interval_us {
            Some(interval_us) if interval_us <= settings.gap_us => {}
            _ => {
                self.identifier.restart();
                // In a turn the filters start from a wrong state of rest.
                let wait = if row.turning { settings.settle_us } else { 0 };
                self.settled_us = row.time_us.saturating_add(wait);
                let rest_us = if row.turning { 0 } else { settings.rest_us };
                self.rest = Rest::new(row.time_us.saturating_add(rest_us));
            }
        }
        self.last_us = Some(row.time_us);
        if row.time_us < self.rest.until_us && !row.turning {
            let rest_rad = self.rest.with(expected_rad);
            self.identifier.restart();
            self.identifier.push(rest_rad, row.roll_rad, T::zero(), false);
            return;
        }
        let interval_s = seconds(interval_us.unwrap_or(0));
        let use_row = usable && row.time_us >= self.settled_us;
        self.identifier.push(expected_rad, row.roll_rad, interval_s, use_row);
    }

    /// Forgets the heights: the load is another one.
    pub(crate) fn unload(&mut self) {
        self.fusion = Fusion::new();
        self.impossible = false;
    }
}
