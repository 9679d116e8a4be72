//! Reading from a CAN interface for an unlimited time.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::time::{ClockId, clock_gettime};
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
    /// The monotonic clock when the last frame was stamped, µs.
    stamped_us: u64,
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
        stamped_us: 0,
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

/// A clock that nobody sets and that goes on while the system sleeps, µs.
fn monotonic_us() -> io::Result<u64> {
    let since = Duration::from(clock_gettime(ClockId::CLOCK_BOOTTIME)?);
    Ok(u64::try_from(since.as_micros()).unwrap_or(u64::MAX))
}

/// That clock when a frame was stamped, µs: when it is read, less the time for which it waited, by the wall clock, while this program
/// wrote to a slow disk. If the wall clock was set meanwhile, the wait is wrong, but the frame before was stamped earlier.
fn stamped_us(before_us: u64, read_us: u64, waited_us: u64) -> u64 {
    read_us.saturating_sub(waited_us).max(before_us)
}

/// Notifies systemd. Without systemd this has no effect and is not an error.
fn notify(states: &[NotifyState<'_>]) {
    let _ = sd_notify::notify(states);
}

impl Live<'_> {
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
        frames.idle(wall::now_us(), monotonic_us()?, session)
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
                let waited_us = wall::now_us().saturating_sub(frame.time_us);
                self.stamped_us = stamped_us(self.stamped_us, monotonic_us()?, waited_us);
                frames.take(frame, Some(self.stamped_us), session)?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use cg_logs::can::Clock;

    const HOUR_US: u64 = 3_600_000_000;

    /// The steps of the stream and the jumps of frames with a time stamp, a time at which they are read, and what the wall clock
    /// shows then.
    fn steps(frames: &[[u64; 3]]) -> Vec<(u64, i64)> {
        let (mut clock, mut at_us, mut before_us) = (Clock::default(), 0, None);
        let mut steps = Vec::new();
        for [stamp_us, read_us, wall_us] in frames {
            at_us = stamped_us(at_us, *read_us, wall_us.saturating_sub(*stamp_us));
            let instant = clock.stream(*stamp_us, Some(at_us));
            let before_us = before_us.replace(instant.stream_us).unwrap_or(instant.stream_us);
            steps.push((instant.stream_us - before_us, instant.jump_us));
        }
        steps
    }

    /// A disk that takes 1.2 s to write: the frames that waited are as far apart as they were on the bus.
    #[test]
    fn a_program_that_stalls_is_no_jump_of_the_clock() {
        let (wall, read) = (HOUR_US, 7 * HOUR_US);
        let frames = [
            [wall, read, wall],
            [wall + 10_000, read + 1_200_000, wall + 1_200_000],
            [wall + 20_000, read + 1_200_010, wall + 1_200_010],
            [wall + 1_210_000, read + 1_210_000, wall + 1_210_000],
        ];
        let expected = [(0, 0), (10_000, 0), (10_000, 0), (1_190_000, 0)];
        assert_eq!(steps(&frames), expected);
    }

    /// The clock is set an hour ahead while two frames wait: the one that comes after it has jumped.
    #[test]
    fn a_clock_that_is_set_in_a_stall_has_jumped() {
        let (wall, read) = (HOUR_US, 7 * HOUR_US);
        let frames = [
            [wall, read, wall],
            [wall + 10_000, read + 300_000, wall + HOUR_US + 300_000],
            [wall + 20_000, read + 300_010, wall + HOUR_US + 300_010],
            [wall + HOUR_US + 310_000, read + 310_000, wall + HOUR_US + 310_000],
        ];
        let found = steps(&frames);
        assert_eq!(found[..3], [(0, 0), (10_000, 0), (10_000, 0)]);
        // What the frames waited is not known, so the stream goes on by up to that more.
        assert_eq!(found[3], (310_000, i64::try_from(HOUR_US).unwrap() - 20_000));
    }
}
