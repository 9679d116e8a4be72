//! What the truck does, and the signals that are missing.

use std::io::{self, Write};

use cg_core::Status as Driving;

use super::Session;
use crate::run::events::Event;

/// Time without a roll angle or an input after which there are no signals, µs. Single rows may lack them.
const LOST_US: u64 = 500_000;

impl<W: Write> Session<W> {
    /// Follows what the estimator says of the sample at a time.
    pub(super) fn follow_driving(&mut self, time_us: u64, status: Driving) -> io::Result<()> {
        match status {
            Driving::Absent if time_us.saturating_sub(self.heard_us) < LOST_US => Ok(()),
            Driving::Absent => self.drive("no signals"),
            Driving::Straight => {
                self.heard_us = time_us;
                self.drive("straight")
            }
            Driving::Turning => {
                self.heard_us = time_us;
                self.drive("turning")
            }
        }
    }

    pub(super) fn drive(&mut self, state: &'static str) -> io::Result<()> {
        if state == self.driving {
            return Ok(());
        }
        self.driving = state;
        let missing = self.missing.clone();
        self.write_event(&Event::State { state, missing })
    }

    /// Reports changes of the missing signals.
    pub(crate) fn missing(&mut self, missing: Vec<&'static str>) -> io::Result<()> {
        if missing == self.missing {
            return Ok(());
        }
        self.missing.clone_from(&missing);
        self.write_event(&Event::State { state: self.driving, missing })
    }
}
