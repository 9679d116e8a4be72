//! Small files, read whole but never beyond a limit: `/dev/zero` or a log given by mistake must
//! not fill the memory.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The most that a vehicle or calibration file has; real ones have 20 kB.
pub const VEHICLE_BYTES: u64 = 1 << 20;
/// The most that a DBC file or a list of known heights has; the largest public DBC has 2 MB.
pub const TABLE_BYTES: u64 = 16 << 20;

/// Reads a file of up to `most` bytes.
///
/// # Errors
/// As the system says, or [`io::ErrorKind::FileTooLarge`].
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
/// As [`read`]; also if it is not UTF-8.
pub fn read_text(path: impl AsRef<Path>, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?).map_err(|_| {
        io::Error::new(io::ErrorKind::InvalidData, "stream did not contain valid UTF-8")
    })
}
