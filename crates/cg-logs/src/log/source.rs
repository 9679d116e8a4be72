//! The bytes of a log: counted, and decompressed if they are gzip.

use std::io::{self, Chain, Cursor, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use flate2::bufread::MultiGzDecoder;

/// The file format, detected from the first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Magic {
    Text,
    Gzip,
    Parquet,
    /// Another format: what it is, and what to do.
    Other(&'static str, &'static str),
}

const MAGIC_BYTES: usize = 4;

const BY_PYTHON: &str =
    "the Python package reads it (cgheight.estimate_log), and cgheight.write_log saves it as CSV";
const AS_CSV: &str = "save it as CSV";

/// Formats that logs may have and that are not read here: their first bytes, what they are, and what to
/// do.
const OTHERS: [(&[u8; 4], &str, &str); 10] = [
    (b"LOGG", "a log of CAN frames in the format BLF", BY_PYTHON),
    (b"MDF ", "a measurement in the format MDF (MF4)", BY_PYTHON),
    (b"UnFi", "an unfinished measurement in the format MDF (MF4)", BY_PYTHON),
    (b";$FI", "a log of CAN frames in the format TRC", BY_PYTHON),
    (b"MATL", "a MATLAB file", BY_PYTHON),
    (b"\x89HDF", "an HDF5 file (MATLAB 7.3 writes such files)", BY_PYTHON),
    (b"AR\x52O", "an Arrow file (Feather)", BY_PYTHON),
    (b"FEA1", "a Feather file of the first version", BY_PYTHON),
    (b"PK\x03\x04", "a ZIP archive or an Excel workbook", AS_CSV),
    (b"\xd0\xcf\x11\xe0", "an old Excel workbook", AS_CSV),
];

/// A stream whose first bytes have been read for detection and are delivered again.
pub(super) struct Sniffed<R> {
    pub(super) magic: Magic,
    pub(super) stream: Chain<Cursor<Vec<u8>>, R>,
}

/// Detects the format of a stream.
pub(super) fn sniff<R: Read>(mut stream: R) -> io::Result<Sniffed<R>> {
    let mut head = Vec::with_capacity(MAGIC_BYTES);
    Read::by_ref(&mut stream).take(MAGIC_BYTES as u64).read_to_end(&mut head)?;
    let magic = match head.as_slice() {
        [0x1f, 0x8b, ..] => Magic::Gzip,
        b"PAR1" => Magic::Parquet,
        [a, b, c, d] => OTHERS
            .iter()
            .find(|(magic, ..)| *magic == &[*a, *b, *c, *d])
            .map_or(Magic::Text, |&(_, format, remedy)| Magic::Other(format, remedy)),
        _ => Magic::Text,
    };
    Ok(Sniffed { magic, stream: Cursor::new(head).chain(stream) })
}

/// The text of a plain or gzip stream; gzip may have several members.
pub(super) fn text<R: Read + Send + 'static>(sniffed: Sniffed<R>) -> Box<dyn Read + Send> {
    const PACKED_BYTES: usize = 64 * 1024;
    let stream = sniffed.stream;
    if sniffed.magic == Magic::Gzip {
        let packed = io::BufReader::with_capacity(PACKED_BYTES, stream);
        Box::new(MultiGzDecoder::new(packed))
    } else {
        Box::new(stream)
    }
}

/// The beginning of a text (a few lines at most), and the whole text. It waits only for the first
/// line, so that a live pipe is not delayed.
pub(super) fn head(mut stream: Box<dyn Read + Send>) -> (Vec<u8>, Box<dyn Read + Send>) {
    const HEAD_BYTES: usize = 4096;
    let mut head = vec![0; HEAD_BYTES];
    let mut length = 0;
    let mut fault = Fault(None);
    while length < HEAD_BYTES && !head[..length].trim_ascii_start().contains(&b'\n') {
        match stream.read(&mut head[length..]) {
            Ok(0) => break,
            Ok(bytes) => length += bytes,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => {
                fault = Fault(Some(error));
                break;
            }
        }
    }
    head.truncate(length);
    let whole = Cursor::new(head.clone()).chain(fault).chain(stream);
    (head, Box::new(whole))
}

/// An error that has already occurred; it is returned when the reader reaches its position.
struct Fault(Option<io::Error>);

impl Read for Fault {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        self.0.take().map_or(Ok(0), Err)
    }
}

/// A stream that counts the bytes that are read from it.
pub(super) struct Counted<R> {
    inner: R,
    count: Arc<AtomicU64>,
}

impl<R> Counted<R> {
    /// The stream and its counter.
    pub(super) fn new(inner: R) -> (Self, Arc<AtomicU64>) {
        let count = Arc::new(AtomicU64::new(0));
        (Self { inner, count: Arc::clone(&count) }, count)
    }
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let bytes = self.inner.read(buffer)?;
        self.count.fetch_add(bytes as u64, Ordering::Relaxed);
        Ok(bytes)
    }
}
