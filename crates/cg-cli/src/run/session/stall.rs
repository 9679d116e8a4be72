//! A stream that stalls. Its last values are not those of now, and no longer warn.

use std::io::{self, Write};
use std::time::Duration;

use super::{NextTimes, SILENT_US, Session};

impl<W: Write> Session<W> {
    /// Follows that nothing has come for this time. `missing` names the signals that are missing at a stream time. The stream goes
    /// on where it stopped, so that rows that come late are used as if they had come in time; only what depends on the present
    /// ends. Events have the time of the last row.
    pub(crate) fn stall(
        &mut self,
        silence: Duration,
        missing: impl FnOnce(u64) -> Vec<&'static str>,
    ) -> io::Result<()> {
        let silence_us = u64::try_from(silence.as_micros()).unwrap_or(u64::MAX);
        if silence_us <= SILENT_US {
            return Ok(());
        }
        let now_us = self.now_us.saturating_add(silence_us);
        self.stalls = true;
        self.missing(missing(now_us))?;
        self.follow(now_us, f64::NAN)?;
        if self.driving != "waiting" {
            self.drive("no signals")?;
        }
        self.report(now_us, true)
    }

    /// What is due by the time of the stall is due by that of the stream again.
    pub(super) fn end_stall(&mut self) {
        if std::mem::take(&mut self.stalls) {
            self.next = NextTimes::default();
        }
    }
}
