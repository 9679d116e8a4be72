//! Input that may stall: a pipe, a terminal. A thread reads it, so that a request to stop is noticed while nothing comes, and the
//! silence itself.

use std::io::{self, Cursor, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::Builder;

use super::signals::{LOOK, Stop};

/// Greatest number of bytes that are passed on together.
const BLOCK_BYTES: usize = 1 << 16;

/// First byte of gzip, with which no text begins.
const GZIP: u8 = 0x1f;

type Block = io::Result<Vec<u8>>;

/// Whether reading fails with [`io::ErrorKind::WouldBlock`] while nothing comes, instead of waiting. The beginning of a log is
/// waited for, and what is packed, whose decoder cannot go on after an error.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pauses(Arc<AtomicBool>);

impl Pauses {
    /// From now on it fails.
    pub(crate) fn tell(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn are_told(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A stream that is read until its end, or until the program is asked to stop. Reading then fails, because an end would
/// make a whole line of what has come of the last one.
pub(crate) struct Stalling {
    blocks: Receiver<Block>,
    block: Cursor<Vec<u8>>,
    packed: Option<bool>,
    pauses: Pauses,
    stop: Stop,
}

impl Stalling {
    /// Reads what `open` returns. The thread calls it, because opening a named pipe waits for a program that writes to it.
    pub(crate) fn new<R: Read>(
        open: impl FnOnce() -> io::Result<R> + Send + 'static,
        (pauses, stop): (&Pauses, &Stop),
    ) -> io::Result<Self> {
        let (sender, blocks) = sync_channel(1);
        Builder::new().name("input".to_owned()).spawn(move || {
            if let Err(error) = open().and_then(|stream| pass(stream, &sender)) {
                // Nobody reads any more if this fails.
                let _ = sender.send(Err(error));
            }
        })?;
        let (pauses, stop) = (pauses.clone(), stop.clone());
        Ok(Self { blocks, block: Cursor::default(), packed: None, pauses, stop })
    }
}

/// Passes on all that is read, until nobody takes it any more.
fn pass(mut stream: impl Read, blocks: &SyncSender<Block>) -> io::Result<()> {
    let mut block = vec![0; BLOCK_BYTES];
    loop {
        match stream.read(&mut block) {
            Ok(0) => return Ok(()),
            Ok(bytes) if blocks.send(Ok(block[..bytes].to_vec())).is_err() => return Ok(()),
            Err(error) if error.kind() != io::ErrorKind::Interrupted => return Err(error),
            Ok(_) | Err(_) => {}
        }
    }
}

impl Read for Stalling {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let bytes = self.block.read(buffer)?;
            if bytes > 0 || buffer.is_empty() {
                return Ok(bytes);
            }
            if self.stop.is_requested() {
                return Err(io::Error::other("the program was asked to stop"));
            }
            match self.blocks.recv_timeout(LOOK) {
                Ok(block) => {
                    self.block = Cursor::new(block?);
                    self.packed.get_or_insert(self.block.get_ref().first() == Some(&GZIP));
                }
                Err(RecvTimeoutError::Timeout)
                    if self.packed == Some(false) && self.pauses.are_told() =>
                {
                    return Err(io::ErrorKind::WouldBlock.into());
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(0),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_bytes_come_in_order_and_then_the_error_or_the_end() {
        let sent: Vec<u8> = (0..=250).cycle().take(3 * BLOCK_BYTES).collect();
        let (stop, stream) = (Stop::default(), sent.clone());
        let told = (&Pauses::default(), &stop);
        let mut taken = Vec::new();
        Stalling::new(|| Ok(Cursor::new(stream)), told).unwrap().read_to_end(&mut taken).unwrap();
        assert_eq!(taken, sent);
        let missing = || Err::<io::Empty, _>(io::Error::from(io::ErrorKind::NotFound));
        let error = Stalling::new(missing, told).unwrap().read(&mut [0]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
    }

    /// The half of a line that has come is no line.
    #[test]
    fn a_request_to_stop_is_an_error_and_no_end() {
        let (stop, (reader, mut writer)) = (Stop::default(), io::pipe().unwrap());
        io::Write::write_all(&mut writer, b"half").unwrap();
        let mut stream = Stalling::new(|| Ok(reader), (&Pauses::default(), &stop)).unwrap();
        let mut buffer = [0; 8];
        assert_eq!(stream.read(&mut buffer).unwrap(), 4);
        stop.request();
        assert!(stream.read(&mut buffer).is_err());
        drop(writer);
    }

    /// A pause is told once the beginning has come, and what comes after it is not lost.
    #[test]
    fn a_pause_is_an_error_and_no_end() {
        let (stop, pauses, (reader, mut writer)) =
            (Stop::default(), Pauses::default(), io::pipe().unwrap());
        let mut stream = Stalling::new(|| Ok(reader), (&pauses, &stop)).unwrap();
        let mut buffer = [0; 8];
        for text in [b"first", b"later"] {
            io::Write::write_all(&mut writer, text).unwrap();
            assert_eq!(stream.read(&mut buffer).unwrap(), text.len());
            pauses.tell();
            assert_eq!(stream.read(&mut buffer).unwrap_err().kind(), io::ErrorKind::WouldBlock);
        }
        drop(writer);
        assert_eq!(stream.read(&mut buffer).unwrap(), 0);
    }

    #[test]
    fn no_pause_of_packed_text_is_told() {
        let (stop, pauses, (reader, mut writer)) =
            (Stop::default(), Pauses::default(), io::pipe().unwrap());
        pauses.tell();
        io::Write::write_all(&mut writer, &[GZIP, 0x8b]).unwrap();
        let closing = std::thread::spawn(move || {
            std::thread::sleep(3 * LOOK);
            drop(writer);
        });
        let mut packed = Vec::new();
        Stalling::new(|| Ok(reader), (&pauses, &stop)).unwrap().read_to_end(&mut packed).unwrap();
        assert_eq!(packed, [GZIP, 0x8b]);
        closing.join().unwrap();
    }
}
