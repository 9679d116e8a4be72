//! Reads small files completely, up to a size limit, and seals texts with a checksum.
//!
//! The limit protects the memory if `/dev/zero` or a log is given by mistake.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use thiserror::Error;

/// Greatest size of a vehicle or calibration file; real ones have 20 kB.
pub const VEHICLE_BYTES: u64 = 1 << 20;
/// Greatest size of a DBC file or a list of known heights; the largest public DBC file has 2 MB.
pub const TABLE_BYTES: u64 = 16 << 20;

/// Reads a file of up to `most` bytes.
///
/// # Errors
/// Those of the operating system, or [`io::ErrorKind::FileTooLarge`].
pub fn read(path: impl AsRef<Path>, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let limit = most >> 20;
        let text = format!("it has more than the {limit} MiB that such a file may have");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, text));
    }
    Ok(bytes)
}

/// Reads a text file of up to `most` bytes.
///
/// # Errors
/// As [`read`]; also if the file is not UTF-8.
pub fn read_text(path: impl AsRef<Path>, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?).map_err(|_| {
        io::Error::new(io::ErrorKind::InvalidData, "stream did not contain valid UTF-8")
    })
}

/// CRC-32 of a text. Line endings of another operating system and empty lines at the end do not
/// change it.
pub fn checksum(text: &str) -> u32 {
    crc32fast::hash(text.trim_ascii_end().replace("\r\n", "\n").as_bytes())
}

/// A text with one more line, which begins with `head` and contains the checksum of all lines before
/// it.
pub fn sealed(text: &str, head: &str) -> String {
    let text = text.trim_ascii_end();
    format!("{text}\n{head}{:08x}\n", checksum(text))
}

/// The lines before the checksum of a [`sealed`] text.
///
/// # Errors
/// [`Unsealed`] if the last line is not their checksum.
pub fn unsealed<'a>(text: &'a str, head: &str) -> Result<&'a str, Unsealed> {
    let text = text.trim_ascii_end();
    let (content, last) = text.rsplit_once('\n').unwrap_or(("", text));
    let Some(stated) = last.strip_prefix(head) else {
        return Err(Unsealed::Absent { now: checksum(text) });
    };
    let now = checksum(content);
    if u32::from_str_radix(stated, 16) == Ok(now) {
        Ok(content)
    } else {
        Err(Unsealed::Wrong { now })
    }
}

/// The reason why a text is not as it was when it was [`sealed`]. `now` is the checksum that it needs.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Unsealed {
    /// There is no checksum.
    #[error("it has no checksum")]
    Absent {
        /// Of the whole text.
        now: u32,
    },
    /// The checksum is that of another text.
    #[error("its checksum is wrong")]
    Wrong {
        /// Of the lines before the last one.
        now: u32,
    },
}
