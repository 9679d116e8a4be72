//! A CAN interface through SocketCAN: kernel filters and time stamps, the kernel's count of dropped
//! frames, error frames, and loss and return of the interface.

use std::cell::Cell;
use std::io::{self, IoSliceMut};
use std::os::fd::{AsFd, AsRawFd};
use std::rc::Rc;
use std::time::Duration;

use cg_logs::can::Frame;
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::socket::sockopt::{RcvBuf, RcvBufForce, RxqOvfl};
use nix::sys::socket::{ControlMessageOwned, MsgFlags, recvmsg, setsockopt};
use nix::sys::time::TimeSpec;
use socketcan::{CanFilter, CanFrame, CanSocket, EmbeddedFrame, ExtendedId, Socket, SocketOptions};

use super::wall;

/// Size of the receive buffer in bytes: some seconds of a full bus, while a disk is slow.
const BUFFER: usize = 8 << 20;
const EXTENDED_FLAG: u32 = 0x8000_0000;
const REMOTE_FLAG: u32 = 0x4000_0000;
const ERROR_FLAG: u32 = 0x2000_0000;
const EXTENDED_MASK: u32 = 0x1FFF_FFFF;
/// Size of a classic frame from the kernel: identifier, length, 3 bytes, 8 data bytes.
const FRAME_SIZE: usize = 16;

/// What was received.
#[derive(Debug)]
pub(crate) enum Received {
    /// A data frame.
    Frame(Frame),
    /// An error frame, as text.
    Error(&'static str),
    /// A remote frame or another frame that is not used.
    Nothing,
}

/// An open interface.
pub(crate) struct Bus {
    socket: Rc<Shared>,
    control: Vec<u8>,
    dropped: u32,
}

/// The socket for reading and writing. The kernel reports the loss of an interface only once, to
/// the next call. If the writing side receives this report, it is stored for the reading side.
struct Shared {
    can: CanSocket,
    fault: Cell<Option<Errno>>,
}

impl Shared {
    fn send(&self, identifier: u32, data: [u8; 8]) {
        let frame = ExtendedId::new(identifier).and_then(|id| CanFrame::new(id, &data));
        if let Some(Err(error)) = frame.map(|frame| self.can.write_frame(&frame)) {
            self.note_error(error.raw_os_error());
        }
    }

    /// Handles an error of sending. After a full queue, the next frame follows a tenth of a second
    /// later; the loss of the interface is reported by the reader.
    fn note_error(&self, code: Option<i32>) {
        let errno = Errno::from_raw(code.unwrap_or(0));
        if matches!(errno, Errno::ENETDOWN | Errno::ENODEV | Errno::ENXIO) {
            self.fault.set(Some(errno));
        }
    }
}

impl Bus {
    /// Opens an interface for frames with these identifiers (whether they have 29 bits, and masks)
    /// and for error frames.
    pub(crate) fn open(interface: &str, frames: &[(u32, bool, u32)]) -> io::Result<Self> {
        let socket = CanSocket::open(interface)?;
        let filters: Vec<CanFilter> = frames
            .iter()
            .map(|&(identifier, extended, mask)| {
                let flag = if extended { EXTENDED_FLAG } else { 0 };
                CanFilter::new(identifier | flag, mask | EXTENDED_FLAG | REMOTE_FLAG)
            })
            .collect();
        socket.set_filters(&filters)?;
        socket.set_error_filter_accept_all()?;
        socket.set_recv_timestamp(true)?;
        socket.set_nonblocking(true)?;
        setsockopt(&*Rc::new(socket.as_fd()), RxqOvfl, &1)?;
        // With the necessary right the size may exceed the system's limit, otherwise not.
        if setsockopt(&socket.as_fd(), RcvBufForce, &BUFFER).is_err() {
            setsockopt(&socket.as_fd(), RcvBuf, &BUFFER)?;
        }
        Ok(Self::over(socket))
    }

    fn over(can: CanSocket) -> Self {
        let control = nix::cmsg_space!(TimeSpec, u32);
        Self { socket: Rc::new(Shared { can, fault: Cell::new(None) }), control, dropped: 0 }
    }

    /// Waits for a frame; returns whether there is something to read.
    pub(crate) fn wait(&self, longest: Duration) -> io::Result<bool> {
        let mut files = [PollFd::new(self.socket.can.as_fd(), PollFlags::POLLIN)];
        let timeout = PollTimeout::try_from(longest).unwrap_or(PollTimeout::MAX);
        match poll(&mut files, timeout) {
            Ok(ready) => Ok(ready > 0),
            Err(Errno::EINTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// The next item received; `None` if there is none. The loss of the interface is returned once
    /// as an error. Frames that arrived before can still be read.
    pub(crate) fn read(&mut self) -> io::Result<Option<Received>> {
        if let Some(errno) = self.socket.fault.take() {
            return Err(errno.into());
        }
        let mut bytes = [0_u8; FRAME_SIZE];
        let mut slices = [IoSliceMut::new(&mut bytes)];
        let flags = MsgFlags::MSG_DONTWAIT;
        let file = self.socket.can.as_raw_fd();
        let (length, mut time_us) = {
            let message = match recvmsg::<()>(file, &mut slices, Some(&mut self.control), flags) {
                Ok(message) => message,
                Err(Errno::EAGAIN | Errno::EINTR) => return Ok(None),
                Err(error) => return Err(error.into()),
            };
            let mut time_us = 0;
            for control in message.cmsgs()? {
                match control {
                    ControlMessageOwned::ScmTimestampns(time) => time_us = microseconds(time),
                    ControlMessageOwned::RxqOvfl(dropped) => self.dropped = dropped,
                    _ => {}
                }
            }
            (message.bytes, time_us)
        };
        if time_us == 0 {
            time_us = wall::now_us();
        }
        Ok(Some(frame(&bytes, length, time_us)))
    }

    /// Number of frames that the kernel has dropped since the socket was opened.
    pub(crate) fn dropped(&self) -> u32 {
        self.dropped
    }

    /// A function that sends frames over the same socket. A frame is discarded if the queue is
    /// full.
    pub(crate) fn sender(&self) -> impl FnMut(u32, [u8; 8]) + use<> {
        let socket = Rc::clone(&self.socket);
        move |identifier, data| socket.send(identifier, data)
    }
}

fn frame(bytes: &[u8; FRAME_SIZE], length: usize, time_us: u64) -> Received {
    let [a, b, c, d, count, _, _, _, data @ ..] = bytes;
    let identifier = u32::from_ne_bytes([*a, *b, *c, *d]);
    if length < FRAME_SIZE || identifier & REMOTE_FLAG != 0 {
        return Received::Nothing;
    }
    if identifier & ERROR_FLAG != 0 {
        return Received::Error(error(identifier, *data));
    }
    let extended = identifier & EXTENDED_FLAG != 0;
    let data = data.get(..usize::from(*count)).unwrap_or(data);
    Frame::new(time_us, identifier & EXTENDED_MASK, extended, data)
        .map_or(Received::Nothing, Received::Frame)
}

/// The most serious error that an error frame reports (linux/can/error.h).
fn error(class: u32, data: [u8; 8]) -> &'static str {
    let [_, controller, ..] = data;
    if class & 0x40 != 0 {
        "bus off: the controller has left the bus"
    } else if class & 0x100 != 0 {
        "the controller has been restarted"
    } else if class & 0x4 != 0 && controller & 0x30 != 0 {
        "error passive: too many errors on the bus"
    } else if class & 0x4 != 0 && controller & 0x3 != 0 {
        "a buffer of the controller has overflowed"
    } else if class & 0x4 != 0 && controller & 0xC != 0 {
        "error warning: many errors on the bus"
    } else if class & 0x20 != 0 {
        "no node acknowledges frames"
    } else {
        "an error on the bus"
    }
}

fn microseconds(time: TimeSpec) -> u64 {
    // Both numbers have 32 bits on some systems and 64 on others.
    let seconds = u64::try_from(time.tv_sec()).unwrap_or(0);
    let nanos = u64::try_from(time.tv_nsec()).unwrap_or(0);
    seconds.saturating_mul(1_000_000).saturating_add(nanos / 1000)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(identifier: u32, data: &[u8]) -> [u8; FRAME_SIZE] {
        let mut bytes = [0; FRAME_SIZE];
        bytes[..4].copy_from_slice(&identifier.to_ne_bytes());
        bytes[4] = u8::try_from(data.len()).unwrap();
        bytes[8..8 + data.len()].copy_from_slice(data);
        bytes
    }

    #[test]
    fn the_kernels_frames_are_taken_apart() {
        let data = [1, 2, 3];
        let Received::Frame(found) = frame(&raw(0x98F0_090B, &data), 16, 7) else {
            panic!("frame")
        };
        assert_eq!(Some(found), Frame::new(7, 0x18F0_090B, true, &data));
        let Received::Frame(found) = frame(&raw(0x123, &data), 16, 7) else { panic!("frame") };
        assert!(!found.extended);
        assert!(matches!(frame(&raw(0x4000_0123, &data), 16, 7), Received::Nothing));
        assert!(matches!(frame(&raw(0x123, &data), 8, 7), Received::Nothing));
        // An impossible length.
        let mut long = raw(0x123, &data);
        long[4] = 200;
        let Received::Frame(found) = frame(&long, 16, 7) else { panic!("frame") };
        assert_eq!(found.data().len(), 8);
    }

    #[test]
    fn the_loss_that_the_sender_hears_reaches_the_reader() {
        let (ours, _theirs) = std::os::unix::net::UnixDatagram::pair().unwrap();
        let mut bus = Bus::over(CanSocket::from(std::os::fd::OwnedFd::from(ours)));
        assert!(bus.read().unwrap().is_none());
        for (code, lost) in [(Errno::ENOBUFS, false), (Errno::ENETDOWN, true), (Errno::ENXIO, true)]
        {
            bus.socket.note_error(Some(code as i32));
            assert_eq!(
                bus.read().err().and_then(|e| e.raw_os_error()),
                lost.then_some(code as i32)
            );
            assert!(bus.read().unwrap().is_none(), "reported once");
        }
    }

    #[test]
    fn error_frames_say_what_is_wrong() {
        for (class, controller, words) in [
            (0x40, 0, "bus off"),
            (0x100, 0, "restarted"),
            (0x4, 0x20, "error passive"),
            (0x4, 0x08, "error warning"),
            (0x4, 0x01, "overflowed"),
            (0x20, 0, "acknowledges"),
            (0x80, 0, "an error"),
        ] {
            let bytes = raw(ERROR_FLAG | class, &[0, controller, 0, 0, 0, 0, 0, 0]);
            let Received::Error(found) = frame(&bytes, 16, 7) else { panic!("error") };
            assert!(found.contains(words), "{found}");
        }
    }
}
