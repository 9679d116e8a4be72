//! A CAN data frame.

pub(super) const EXTENDED_MASK: u32 = 0x1FFF_FFFF;
/// Maximum payload in bytes, that of CAN FD.
pub(super) const ROOM: usize = 64;

/// A CAN data frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Time of reception, µs, usually Unix time.
    pub time_us: u64,
    /// Identifier with 11 or 29 bits.
    pub identifier: u32,
    /// Whether the identifier has 29 bits.
    pub extended: bool,
    /// Number of the bus, from 0 in the order of the first frames in the log.
    pub bus: u8,
    data: [u8; ROOM],
    length: u8,
}

impl Frame {
    /// A data frame of the first bus; `None` if it has more than 64 bytes.
    pub fn new(time_us: u64, identifier: u32, extended: bool, bytes: &[u8]) -> Option<Self> {
        let mut data = [0; ROOM];
        data.get_mut(..bytes.len())?.copy_from_slice(bytes);
        let length = u8::try_from(bytes.len()).ok()?;
        Some(Self { time_us, identifier, extended, bus: 0, data, length })
    }

    /// The payload.
    pub fn data(&self) -> &[u8] {
        // `length` is at most the size of the array.
        self.data.get(..usize::from(self.length)).unwrap_or_default()
    }
}
