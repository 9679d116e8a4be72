//! One client: its request, the answer, and the events as fast as it reads them.
//!
//! Nothing here waits. What a client cannot take stays until the next turn, and of the present values a slow client
//! gets only the newest.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

use super::board::{Board, frame};
use super::request::{Asked, GREATEST, read};

/// Time for a request.
const ASKING: Duration = Duration::from_secs(5);
/// Time in which a client must take something if something waits for it.
const STALLED: Duration = Duration::from_secs(20);
/// Time in which a client must close its side.
const CLOSING: Duration = Duration::from_secs(2);
/// Time without an event after which a sign of life is sent.
const SILENT: Duration = Duration::from_secs(2);

const COMMON: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
    Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n";
/// The page may ask for its events, and for nothing else.
const POLICY: &str = "Content-Security-Policy: default-src 'none'; style-src 'unsafe-inline'; \
    script-src 'unsafe-inline'; connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; \
    frame-ancestors 'none'\r\n";

/// A connection that does not block.
pub(super) trait Connection: Read + Write {
    /// Ends the writing side.
    fn finish(&mut self);
}

impl Connection for TcpStream {
    fn finish(&mut self) {
        let _ = self.shutdown(Shutdown::Write);
    }
}

/// What the server offers to all clients.
pub(super) struct Offer<'a> {
    pub(super) page: &'a str,
    pub(super) name: Option<&'a str>,
    /// Whether another client may listen.
    pub(super) has_room: bool,
}

/// What a listener has got.
#[derive(Debug, Default)]
struct Seen {
    /// `None` before the history.
    lines: Option<u64>,
    snapshot: u64,
    turn: u64,
}

#[derive(Debug)]
enum Phase {
    Asking(Vec<u8>),
    /// The connection ends with the answer.
    Answering,
    Listening(Seen),
    Closing,
}

/// A client.
pub(super) struct Client<S> {
    stream: S,
    phase: Phase,
    pending: Vec<u8>,
    written: usize,
    /// Beginning of the phase, or the last time that bytes were taken.
    since: Instant,
}

impl<S: Connection> Client<S> {
    pub(super) fn new(stream: S, now: Instant) -> Self {
        let phase = Phase::Asking(Vec::new());
        Self { stream, phase, pending: Vec::new(), written: 0, since: now }
    }

    pub(super) fn is_listening(&self) -> bool {
        matches!(self.phase, Phase::Listening(_))
    }

    /// Whether nothing waits for this client.
    pub(super) fn is_served(&self) -> bool {
        self.pending.is_empty()
    }

    /// Does what can be done without waiting. Returns whether the client remains.
    pub(super) fn turn(&mut self, board: &Board, offer: &Offer<'_>, now: Instant) -> bool {
        let limit = match self.phase {
            Phase::Asking(_) => ASKING,
            Phase::Closing => CLOSING,
            Phase::Answering | Phase::Listening(_) => STALLED,
        };
        let waits = !(self.is_listening() && self.is_served());
        let late = waits && now.duration_since(self.since) > limit;
        !late && self.hear(offer, now).and_then(|()| self.tell(board, now)).is_ok()
    }

    /// Reads what has arrived: the request; after it nothing is expected but the end.
    fn hear(&mut self, offer: &Offer<'_>, now: Instant) -> io::Result<()> {
        let mut buffer = [0; 1024];
        for _ in 0..=GREATEST / buffer.len() {
            let length = match self.stream.read(&mut buffer) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(length) => length,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            if let Phase::Asking(request) = &mut self.phase {
                request.extend_from_slice(buffer.get(..length).unwrap_or_default());
                match read(request, offer.name) {
                    Asked::Unfinished => {}
                    asked => self.answer(&asked, offer, now),
                }
            }
        }
        Ok(())
    }

    fn answer(&mut self, asked: &Asked, offer: &Offer<'_>, now: Instant) {
        let page = "text/html; charset=utf-8";
        self.phase = Phase::Answering;
        self.since = now;
        self.pending = match asked {
            Asked::Page { head } => {
                let body = if *head { "" } else { offer.page };
                format!("{}{body}", head_of("200 OK", page, Some(offer.page.len())))
            }
            Asked::Events if offer.has_room => {
                self.phase = Phase::Listening(Seen::default());
                format!("{}retry: 2000\n\n", head_of("200 OK", "text/event-stream", None))
            }
            Asked::Events => refusal("503 Service Unavailable", "too many clients read the events"),
            Asked::Refused(status, reason) => refusal(status, reason),
            Asked::Unfinished => String::new(),
        }
        .into_bytes();
        self.written = 0;
    }

    /// Writes what the client can take.
    fn tell(&mut self, board: &Board, now: Instant) -> io::Result<()> {
        self.write(now)?;
        if !self.pending.is_empty() {
            return Ok(());
        }
        match &mut self.phase {
            Phase::Asking(_) | Phase::Closing => return Ok(()),
            Phase::Answering => {
                self.stream.finish();
                (self.phase, self.since) = (Phase::Closing, now);
                return Ok(());
            }
            Phase::Listening(seen) => {
                seen.fill(board, &mut self.pending);
                if self.pending.is_empty() && now.duration_since(self.since) > SILENT {
                    self.pending = frame("alive", "{}");
                }
                // The time without an event is not a time in which the client took nothing.
                if !self.pending.is_empty() {
                    self.since = now;
                }
            }
        }
        self.write(now)
    }

    fn write(&mut self, now: Instant) -> io::Result<()> {
        while let Some(rest) = self.pending.get(self.written..).filter(|rest| !rest.is_empty()) {
            match self.stream.write(rest) {
                Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
                Ok(length) => (self.written, self.since) = (self.written + length, now),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        // A history is large and rare, so its memory is given back.
        (self.pending, self.written) = (Vec::new(), 0);
        Ok(())
    }
}

impl Seen {
    /// Adds what the client has not got.
    fn fill(&mut self, board: &Board, pending: &mut Vec<u8>) {
        if let Some(lines) = self.lines.and_then(|seen| board.since(seen)) {
            lines.for_each(|line| pending.extend(line));
        } else {
            pending.extend(board.history());
            // The history does not contain the last maneuver's signals.
            self.turn = 0;
        }
        self.lines = Some(board.count());
        for newest in [board.turn.after(&mut self.turn), board.snapshot.after(&mut self.snapshot)] {
            pending.extend_from_slice(newest.unwrap_or_default());
        }
    }
}

fn head_of(status: &str, kind: &str, length: Option<usize>) -> String {
    let length = length.map_or(String::new(), |length| format!("Content-Length: {length}\r\n"));
    format!("HTTP/1.1 {status}\r\nContent-Type: {kind}\r\n{length}{COMMON}{POLICY}\r\n")
}

fn refusal(status: &str, reason: &str) -> String {
    let body = format!("{status}: {reason}\n");
    let allow = if status.starts_with("405") { "Allow: GET, HEAD\r\n" } else { "" };
    let head = head_of(status, "text/plain; charset=utf-8", Some(body.len()));
    format!("{}{body}", head.replacen("\r\n", &format!("\r\n{allow}"), 1))
}

#[cfg(test)]
mod tests;
