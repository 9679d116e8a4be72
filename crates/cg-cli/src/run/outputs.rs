//! All outputs: events, live page, state file, metrics, frames.
//!
//! A failure of an output is reported once and tried again later. It never stops the estimation. Only
//! if standard output fails, the program stops as at a signal, so that the state is saved. A state that
//! is not saved at the end is an error.

use std::io::{self, Write};

use cg_core::Memory;
use cg_logs::learn::Learned;
use cg_output::Target;

use super::events::{self, Event, Status};
use super::latency::Histogram;
use super::metrics;
use super::serve::{Kind, Page};
use super::signals::Stop;
use super::state::{Found, SavedLoad, StateFile};
use super::transmit;

/// Sends a frame with this identifier and these data.
pub(crate) type Sender = Box<dyn FnMut(u32, [u8; 8])>;

/// The outputs.
pub(crate) struct Outputs<W: Write> {
    /// The stream of event lines.
    pub(crate) lines: W,
    /// The error of that stream after which nothing is written to it any more.
    failure: Option<io::Error>,
    /// Asked to stop when the stream fails. Without it, the error is returned at once.
    pub(crate) stop: Option<Stop>,
    pub(crate) state: Option<StateFile>,
    pub(crate) metrics: Option<Target>,
    /// The sender of frames and its source address.
    pub(crate) sender: Option<(Sender, u8)>,
    /// The live page.
    pub(crate) page: Option<Page>,
    pub(crate) latency: Histogram,
    state_failed: bool,
    metrics_failed: bool,
}

impl<W: Write> Outputs<W> {
    pub(crate) fn new(
        lines: W,
        state: Option<StateFile>,
        metrics: Option<Target>,
        sender: Option<(Sender, u8)>,
    ) -> Self {
        let latency = Histogram::default();
        Self {
            lines,
            failure: None,
            stop: None,
            state,
            metrics,
            sender,
            page: None,
            latency,
            state_failed: false,
            metrics_failed: false,
        }
    }

    /// Writes an event as a line, which is flushed at once, and shows it on the page. If the stream
    /// fails, the program is asked to stop, and [`failed`](Self::failed) has the error.
    pub(crate) fn write(&mut self, time_s: f64, event: &Event<'_>) -> io::Result<()> {
        let line = events::line(time_s, event)?;
        if let Some(page) = &self.page {
            page.line(Kind::from(event), &line);
        }
        if self.failure.is_some() {
            return Ok(());
        }
        let written = self.lines.write_all(line.as_bytes()).and_then(|()| self.lines.flush());
        match (written, &self.stop) {
            (Err(error), Some(stop)) => {
                stop.request();
                self.failure = Some(error);
                Ok(())
            }
            (written, _) => written,
        }
    }

    /// The error of the stream of event lines, if it has failed.
    pub(crate) fn failed(&mut self) -> io::Result<()> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// The content of the state file, if there is one.
    pub(crate) fn load(&mut self) -> Option<io::Result<Found>> {
        self.state.as_mut().map(StateFile::load)
    }

    /// Writes the state; returns a message if writing starts to fail or works again, or if another
    /// program has written the file.
    pub(crate) fn save(
        &mut self,
        memory: &Memory<f64>,
        saved_s: f64,
        load: SavedLoad,
        learned: Learned,
    ) -> Option<String> {
        let state = self.state.as_mut()?;
        let result = state.save(memory, saved_s, load, learned);
        let others = state.aside.take().map(|path| {
            format!(
                "another program has written this file, perhaps another cg run with the same --state; what it \
                 wrote is now in {}; give each its own file",
                path.display()
            )
        });
        let told: Vec<String> =
            others.into_iter().chain(changed(&mut self.state_failed, result)).collect();
        (!told.is_empty()).then(|| told.join("; "))
    }

    /// Returns a message if the state file cannot be written, so that it is known before the first turn.
    pub(crate) fn try_state(&mut self) -> Option<String> {
        let result = self.state.as_ref()?.try_open();
        changed(&mut self.state_failed, result)
    }

    /// The error if the state could not be written at last.
    pub(crate) fn unsaved(&self) -> io::Result<()> {
        match &self.state {
            Some(state) if self.state_failed => Err(io::Error::other(format!(
                "--state {}: could not be written, so what this run has learned is lost; the reason is in the last \
                 notice of the subject \"state\"",
                state.path().display()
            ))),
            _ => Ok(()),
        }
    }

    /// Writes the metrics; returns a message if writing starts to fail or works again.
    pub(crate) fn measure(&mut self, status: &Status) -> Option<String> {
        let result = metrics::write(self.metrics.as_ref()?, status, self.latency.summary());
        changed(&mut self.metrics_failed, result)
    }

    pub(crate) fn transmits(&self) -> bool {
        self.sender.is_some()
    }

    pub(crate) fn transmit(&mut self, status: &Status) {
        if let Some((send, address)) = &mut self.sender {
            let (identifier, data) = transmit::frame(status, *address);
            send(identifier, data);
            if status.requests_speed {
                let (identifier, data) = transmit::request(status, *address);
                send(identifier, data);
            }
        }
    }
}

/// The message when success changes to failure or back.
fn changed(failed: &mut bool, result: io::Result<()>) -> Option<String> {
    let before = std::mem::replace(failed, result.is_err());
    match result {
        Err(error) if !before => Some(format!("cannot be written, will be tried again: {error}")),
        Ok(()) if before => Some("can be written again".to_owned()),
        _ => None,
    }
}
