//! A frame.

pub(super) const EXTENDED_MASK: u32 = 0x1FFF_FFFF;
/// The greatest payload, that of CAN FD.
pub(super) const ROOM: usize = 64;

/// A data frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Time stamp of its reception, µs; mostly Unix time.
    pub time_us: u64,
    /// The identifier, 11 or 29 bits.
    pub identifier: u32,
    /// Whether it has 29 bits.
    pub extended: bool,
    /// Which bus of a log it was on, from 0 in the order of their first frames.
    pub bus: u8,
    data: [u8; ROOM],
    length: u8,
}

impl Frame {
    /// A data frame of the first bus; `None` if there are more than 64 bytes.
    pub fn new(time_us: u64, identifier: u32, extended: bool, bytes: &[u8]) -> Option<Self> {
        let mut data = [0; ROOM];
        data.get_mut(..bytes.len())?.copy_from_slice(bytes);
        let length = u8::try_from(bytes.len()).ok()?;
        Some(Self { time_us, identifier, extended, bus: 0, data, length })
    }

    /// Its payload.
    pub fn data(&self) -> &[u8] {
        // The length was checked against the room.
        self.data.get(..usize::from(self.length)).unwrap_or_default()
    }
}
