//! Lines of text out of a stream, in constant memory.
//!
//! ```text
//!     buffer   …… done │ start ── line ── stop ⏎ next ── not looked at ── end │ free ……
//! ```
//!
//! Each byte is looked at once for its line feed; a line that does not end within
//! [`LIMIT_BYTES`] is refused before more of it is read.

use std::io::{self, Read};

/// The longest line, and the longest record of several lines in quotes.
pub(super) const LIMIT_BYTES: usize = 64 * 1024;

/// Four limits, so that moving the unfinished line to the front stays rare.
const BUFFER_BYTES: usize = 4 * LIMIT_BYTES;

/// Why there is no next line.
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
            buffer: vec![0; BUFFER_BYTES].into_boxed_slice(),
            start: 0,
            stop: 0,
            next: 0,
            end: 0,
            drained: false,
            number: 0,
        }
    }

    /// The line last taken, without its end.
    #[inline]
    pub(super) fn line(&self) -> &[u8] {
        let line = &self.buffer[self.start..self.stop];
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    /// The number of the line last taken, from one.
    #[inline]
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Takes the next line. `false` at the end of the stream.
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

    /// The same for a line whose end is not in the buffer yet.
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

    /// Reads and drops what is left, up to a limit, to learn whether it can be read.
    pub(super) fn drain(&mut self) -> io::Result<()> {
        const DRAINED_BYTES: u64 = 256 << 20;
        io::copy(&mut Read::by_ref(&mut self.source).take(DRAINED_BYTES), &mut io::sink())?;
        Ok(())
    }

    /// One read from the source, behind the line that is not whole yet.
    fn fill(&mut self) -> io::Result<()> {
        if self.start == self.end || self.buffer.len() - self.end < LIMIT_BYTES {
            self.buffer.copy_within(self.start..self.end, 0);
            self.end -= self.start;
            self.next = 0;
            self.start = 0;
        }
        loop {
            match self.source.read(&mut self.buffer[self.end..]) {
                Ok(0) => self.drained = true,
                Ok(count) => self.end += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            }
            return Ok(());
        }
    }
}
