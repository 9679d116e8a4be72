//! Splits a stream into lines, in constant memory.
//!
//! ```text
//!     buffer   …… done │ start ── line ── stop ⏎ next ── not searched ── end │ free ……
//! ```
//!
//! Each byte is searched once for a line feed, unless its row was read [ahead](Lines::ahead). A line that does
//! not end within [`LIMIT_BYTES`] is refused before more of it is read.

use std::io::{self, Read};

use super::numbers::AHEAD;

/// Maximum length of a line, and of a record that spans several lines in quotes.
pub(super) const LIMIT_BYTES: usize = 64 * 1024;

/// Four times the limit, so that an incomplete line is rarely moved to the front.
const BUFFER_BYTES: usize = 4 * LIMIT_BYTES;

/// The reason why there is no next line.
#[derive(Debug)]
pub(super) enum Fault {
    TooLong,
    Io(io::Error),
}

pub(super) struct Lines {
    source: Box<dyn Read + Send>,
    buffer: Box<[u8]>,
    start: usize,
    stop: usize,
    next: usize,
    end: usize,
    drained: bool,
    number: u64,
}

impl Lines {
    pub(super) fn new(source: Box<dyn Read + Send>) -> Self {
        Self {
            source,
            buffer: vec![0; BUFFER_BYTES + AHEAD].into_boxed_slice(),
            start: 0,
            stop: 0,
            next: 0,
            end: 0,
            drained: false,
            number: 0,
        }
    }

    /// The current line without its line ending.
    #[inline]
    pub(super) fn line(&self) -> &[u8] {
        let line = &self.buffer[self.start..self.stop];
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    /// The text after the current line, and bytes without meaning behind what has been read so far.
    #[inline]
    pub(super) fn ahead(&self) -> &[u8] {
        self.buffer.get(self.next..).unwrap_or_default()
    }

    /// Takes the next line, whose end was found `length` bytes [ahead](Self::ahead). Returns `false` if that
    /// is behind what has been read so far.
    #[inline]
    pub(super) fn skip(&mut self, length: usize) -> bool {
        let stop = self.next + length;
        if stop >= self.end || length > LIMIT_BYTES {
            return false;
        }
        (self.start, self.stop, self.next) = (self.next, stop, stop + 1);
        self.number += 1;
        true
    }

    /// The number of the current line, from one.
    #[inline]
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Takes the next line. Returns `false` at the end of the stream.
    #[inline]
    pub(super) fn advance(&mut self) -> Result<bool, Fault> {
        self.start = self.next;
        match memchr::memchr(b'\n', &self.buffer[self.start..self.end]) {
            Some(length) => self.stop = self.start + length,
            None if self.advance_across()? => {}
            None => return Ok(false),
        }
        self.next = self.end.min(self.stop + 1);
        if self.stop - self.start > LIMIT_BYTES {
            return Err(Fault::TooLong);
        }
        self.number += 1;
        Ok(true)
    }

    /// Takes a line whose end is not yet in the buffer.
    #[cold]
    fn advance_across(&mut self) -> Result<bool, Fault> {
        loop {
            let seen = self.end - self.start;
            if seen > LIMIT_BYTES {
                return Err(Fault::TooLong);
            }
            if self.drained {
                self.stop = self.end;
                return Ok(seen > 0);
            }
            self.fill().map_err(Fault::Io)?;
            let fresh = self.start + seen;
            if let Some(length) = memchr::memchr(b'\n', &self.buffer[fresh..self.end]) {
                self.stop = fresh + length;
                return Ok(true);
            }
        }
    }

    /// Reads and discards the rest, up to a limit, to check whether it can be read.
    pub(super) fn drain(&mut self) -> io::Result<()> {
        const DRAINED_BYTES: u64 = 256 << 20;
        io::copy(&mut Read::by_ref(&mut self.source).take(DRAINED_BYTES), &mut io::sink())?;
        Ok(())
    }

    /// Reads once from the source and appends to the incomplete line.
    fn fill(&mut self) -> io::Result<()> {
        if self.start == self.end || BUFFER_BYTES - self.end < LIMIT_BYTES {
            self.buffer.copy_within(self.start..self.end, 0);
            self.end -= self.start;
            self.next = 0;
            self.start = 0;
        }
        loop {
            match self.source.read(&mut self.buffer[self.end..BUFFER_BYTES]) {
                Ok(0) => self.drained = true,
                Ok(count) => self.end += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            }
            return Ok(());
        }
    }
}
