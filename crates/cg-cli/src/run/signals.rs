//! Requests to stop, by SIGTERM and SIGINT and by a standard output that fails.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::interrupt;

/// Longest time between two looks for a request.
pub(crate) const LOOK: Duration = Duration::from_millis(100);

/// Whether the program was asked to stop.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Handles the signals. A second signal ends the program at once.
    pub(crate) fn listen() -> io::Result<Self> {
        let flag = Arc::new(AtomicBool::new(false));
        interrupt::handle_signals(Some(Arc::clone(&flag)))?;
        Ok(Self(flag))
    }

    /// Asks to stop, as the first signal does.
    pub(crate) fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    pub(crate) fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Waits for this time, or until a request.
    pub(crate) fn wait_at_most(&self, longest: Duration) {
        let began = Instant::now();
        while !self.is_requested()
            && let Some(rest) = longest.checked_sub(began.elapsed())
        {
            std::thread::sleep(rest.min(LOOK));
        }
    }

    /// Waits for a request.
    pub(crate) fn wait(&self) {
        while !self.is_requested() {
            std::thread::sleep(LOOK);
        }
    }
}
