//! Listening to a CAN interface for months.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use nix::errno::Errno;
use sd_notify::NotifyState;

use super::frames::Frames;
use super::session::Session;
use super::signals::Stop;
use super::socket::{Bus, Received, wall_us};

/// The longest wait for a frame; signals and watchdog are looked after in between.
const WAIT: Duration = Duration::from_millis(50);
/// Between two tries to open an interface that is not there.
const RETRY: Duration = Duration::from_secs(1);
/// Rest after reading all there was: on a full bus some frames come at once, at a fraction of the cost.
const REST: Duration = Duration::from_millis(1);
/// Frames read in a row before anything else.
const BATCH: usize = 256;

/// What the interface is doing.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Link {
    Up,
    /// Since when, on the wall clock; frames that are older waited in the queue.
    Down {
        since_us: u64,
    },
}

/// The loop's own state.
struct Live<'a> {
    interface: &'a str,
    transmit_address: Option<u8>,
    began: Instant,
    link: Link,
    error: &'static str,
    /// Frames lost on sockets that are closed.
    lost_before: u64,
    watchdog: Option<Duration>,
    alive: Instant,
}

/// Listens until somebody asks for the end.
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
    while !stop.asked() {
        let Some(bus) = live.open(frames, session)? else {
            live.pause(frames, session, stop)?;
            continue;
        };
        live.listen(bus, frames, session, stop)?;
    }
    notify(&[NotifyState::Stopping]);
    Ok("signal")
}

/// Without systemd nobody listens, which is no error.
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
        match Bus::open(self.interface, &frames.wanted()) {
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
            self.link = Link::Down { since_us: wall_us() };
            let message = format!("{}: {error}; waiting for it", self.interface);
            session.notice("interface", message)?;
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
        while Instant::now() < until && !stop.asked() {
            std::thread::sleep(WAIT);
            self.idle(frames, session)?;
        }
        Ok(())
    }

    fn idle<W: Write>(&mut self, frames: &mut Frames, session: &mut Session<W>) -> io::Result<()> {
        self.feed_watchdog();
        frames.idle(wall_us(), self.monotonic_us(), session)
    }

    fn feed_watchdog(&mut self) {
        if self.watchdog.is_some_and(|period| self.alive.elapsed() >= period) {
            self.alive = Instant::now();
            notify(&[NotifyState::Watchdog]);
        }
    }

    /// Reads until the interface is gone, and then what has come before.
    fn listen<W: Write>(
        &mut self,
        mut bus: Bus,
        frames: &mut Frames,
        session: &mut Session<W>,
        stop: &Stop,
    ) -> io::Result<()> {
        let mut gone = false;
        while !stop.asked() {
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
                        // Only down: the socket stays and hears again when it is up.
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
                    session.notice("interface", format!("{}: up again", self.interface))?;
                }
                frames.take(frame, Some(self.monotonic_us()), session)?;
                session.outputs.latency.push(wall_us().saturating_sub(frame.time_us));
            }
            Received::Error(words) => {
                session.counters.error_frames += 1;
                if *words != self.error {
                    self.error = words;
                    session.notice("bus", format!("{}: {words}", self.interface))?;
                }
            }
            Received::Nothing => {}
        }
        Ok(())
    }
}
