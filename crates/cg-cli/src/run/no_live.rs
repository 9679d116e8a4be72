//! In place of `live` and `socket` on systems without SocketCAN. `args` refuses `--can` there.

use std::io::{self, Write};

use super::frames::Frames;
use super::session::Session;
use super::signals::Stop;

pub(crate) fn run<W: Write>(
    _: &str,
    _: Option<u8>,
    _: &mut Frames,
    _: &mut Session<W>,
    _: &Stop,
) -> io::Result<&'static str> {
    Err(io::ErrorKind::Unsupported.into())
}
