//! Reading from a CAN interface for an unlimited time.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use nix::errno::Errno;
use sd_notify::NotifyState;

use super::frames::Frames;
use super::session::Session;
use super::signals::Stop;
use super::socket::{Bus, Received};
use super::wall;

/// Longest wait for a frame. Requests to stop and the watchdog are handled in between.
const WAIT: Duration = Duration::from_millis(50);
/// Time between two attempts to open a missing interface.
const RETRY: Duration = Duration::from_secs(1);
/// Pause after all frames were read. On a full bus, several frames are then read at once, which
/// takes less processor time.
const REST: Duration = Duration::from_millis(1);
/// Maximum number of frames read in a row.
const BATCH: usize = 256;

/// State of the interface.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Link {
    Up,
    /// Time of the loss on the wall clock, µs. Older frames waited in the queue.
    Down {
        since_us: u64,
    },
}

/// State of the loop.
struct Live<'a> {
    interface: &'a str,
    transmit_address: Option<u8>,
    began: Instant,
    link: Link,
    error: &'static str,
    /// Number of frames lost on closed sockets.
    lost_before: u64,
    watchdog: Option<Duration>,
    alive: Instant,
}

/// Reads frames until the program is asked to stop.
pub(crate) fn run<W: Write>(
    interface: &str,
    transmit_address: Option<u8>,
    frames: &mut Frames,
    session: &mut Session<W>,
    stop: &Stop,
) -> io::Result<&'static str> {
    let mut live = Live {
        interface,
        transmit_address,
        began: Instant::now(),
        link: Link::Up,
        error: "",
        lost_before: 0,
        watchdog: sd_notify::watchdog_enabled().map(|period| period / 2),
        alive: Instant::now(),
    };
    notify(&[NotifyState::Ready, NotifyState::Status("listening")]);
    while !stop.is_requested() {
        let Some(bus) = live.open(frames, session)? else {
            live.pause(frames, session, stop)?;
            continue;
        };
        live.listen(bus, frames, session, stop)?;
    }
    notify(&[NotifyState::Stopping]);
    Ok("signal")
}

/// Notifies systemd. Without systemd this has no effect and is not an error.
fn notify(states: &[NotifyState<'_>]) {
    let _ = sd_notify::notify(states);
}

impl Live<'_> {
    fn monotonic_us(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    fn open<W: Write>(
        &mut self,
        frames: &Frames,
        session: &mut Session<W>,
    ) -> io::Result<Option<Bus>> {
        match Bus::open(self.interface, &frames.filters()) {
            Ok(bus) => {
                if let Some(address) = self.transmit_address {
                    session.outputs.sender = Some((Box::new(bus.sender()), address));
                }
                Ok(Some(bus))
            }
            Err(error) => {
                self.down(session, &error)?;
                Ok(None)
            }
        }
    }

    fn down<W: Write>(&mut self, session: &mut Session<W>, error: &io::Error) -> io::Result<()> {
        if self.link == Link::Up {
            self.link = Link::Down { since_us: wall::now_us() };
            let message = format!("{}: {error}; waiting for it", self.interface);
            session.notice("interface", &message)?;
        }
        Ok(())
    }

    /// Waits for the interface.
    fn pause<W: Write>(
        &mut self,
        frames: &mut Frames,
        session: &mut Session<W>,
        stop: &Stop,
    ) -> io::Result<()> {
        let until = Instant::now() + RETRY;
        while Instant::now() < until && !stop.is_requested() {
            std::thread::sleep(WAIT);
            self.idle(frames, session)?;
        }
        Ok(())
    }

    fn idle<W: Write>(&mut self, frames: &mut Frames, session: &mut Session<W>) -> io::Result<()> {
        self.feed_watchdog();
        frames.idle(wall::now_us(), self.monotonic_us(), session)
    }

    fn feed_watchdog(&mut self) {
        if self.watchdog.is_some_and(|period| self.alive.elapsed() >= period) {
            self.alive = Instant::now();
            notify(&[NotifyState::Watchdog]);
        }
    }

    /// Reads until the interface is lost, and then the frames that arrived before.
    fn listen<W: Write>(
        &mut self,
        mut bus: Bus,
        frames: &mut Frames,
        session: &mut Session<W>,
        stop: &Stop,
    ) -> io::Result<()> {
        let mut gone = false;
        while !stop.is_requested() {
            if !gone && !bus.wait(WAIT)? {
                self.idle(frames, session)?;
            }
            for _ in 0..BATCH {
                match bus.read() {
                    Ok(Some(received)) => self.take(&received, frames, session)?,
                    Ok(None) | Err(_) if gone => {
                        self.lost_before += u64::from(bus.dropped());
                        return Ok(());
                    }
                    Ok(None) => break,
                    Err(error) => {
                        self.down(session, &error)?;
                        // If the interface is only down, the socket remains open and receives again
                        // when it is up.
                        gone = error.raw_os_error() != Some(Errno::ENETDOWN as i32);
                        if gone {
                            session.outputs.sender = None;
                        }
                    }
                }
            }
            session.counters.frames_lost = self.lost_before + u64::from(bus.dropped());
            self.feed_watchdog();
            std::thread::sleep(REST);
        }
        Ok(())
    }

    fn take<W: Write>(
        &mut self,
        received: &Received,
        frames: &mut Frames,
        session: &mut Session<W>,
    ) -> io::Result<()> {
        match received {
            Received::Frame(frame) => {
                if let Link::Down { since_us } = self.link
                    && frame.time_us > since_us
                {
                    self.link = Link::Up;
                    session.notice("interface", &format!("{}: up again", self.interface))?;
                }
                frames.take(frame, Some(self.monotonic_us()), session)?;
                session.outputs.latency.push(wall::now_us().saturating_sub(frame.time_us));
            }
            Received::Error(words) => {
                session.counters.error_frames += 1;
                if *words != self.error {
                    self.error = words;
                    session.notice("bus", &format!("{}: {words}", self.interface))?;
                }
            }
            Received::Nothing => {}
        }
        Ok(())
    }
}
