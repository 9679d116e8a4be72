//! The board: a counter of instructions or cycles, the memory in use, lines of text.

use core::num::NonZeroU32;

use cg_core::Height;
use cg_firmware::Maneuver;
use cortex_m::Peripherals;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{DWT, SYST};
use cortex_m_semihosting::hio::{self, HostStream};

/// Instructions per tick of the timer: QEMU runs one instruction per nanosecond
/// (`-icount shift=0`), and the timer of this board runs at 25 MHz.
const INSTRUCTIONS_PER_TICK: u32 = 40;
const RELOAD: u32 = 0x00ff_ffff;

const DECIMAL: NonZeroU32 = NonZeroU32::new(10).unwrap();
const HEXADECIMAL: NonZeroU32 = NonZeroU32::new(16).unwrap();

/// Counts cycles if the chip can, otherwise QEMU's instructions.
#[derive(Clone, Copy)]
pub(crate) struct Counter {
    cycles: bool,
}

impl Counter {
    /// Starts the counter; `None` if it was started before.
    pub(crate) fn start() -> Option<Self> {
        let mut core = Peripherals::take()?;
        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
        let before = DWT::cycle_count();
        cortex_m::asm::nop();
        let cycles = DWT::cycle_count() != before; // QEMU does not count cycles
        core.SYST.set_clock_source(SystClkSource::Core);
        core.SYST.set_reload(RELOAD);
        core.SYST.clear_current();
        core.SYST.enable_counter();
        Some(Self { cycles })
    }

    /// The unit of the count.
    pub(crate) fn unit(self) -> &'static str {
        if self.cycles { "cycles" } else { "instructions" }
    }

    /// The count; differences are valid for less than half a second.
    pub(crate) fn now(self) -> u32 {
        if self.cycles {
            DWT::cycle_count()
        } else {
            // The timer counts down with 24 bits; the multiplication makes differences wrap like 32 bits.
            RELOAD.wrapping_sub(SYST::get_current()).wrapping_mul(INSTRUCTIONS_PER_TICK)
        }
    }
}

unsafe extern "C" {
    static __vector_table: u32;
    static __sidata: u32;
    static __sdata: u32;
    static __edata: u32;
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Memory in use, bytes.
pub(crate) struct Memory {
    /// Flash: code, constants, the design, initial values; without the log.
    pub(crate) image: u32,
    /// Statically allocated RAM.
    pub(crate) fixed: u32,
    /// Maximum stack depth so far.
    pub(crate) stack: u32,
}

impl Memory {
    /// Reads the linker's symbols and how much of the painted stack was overwritten.
    #[allow(clippy::cast_possible_truncation)] // 32-bit addresses
    pub(crate) fn measure() -> Self {
        let address = |symbol: *const u32| symbol as usize as u32;
        let data = address(&raw const __edata) - address(&raw const __sdata);
        let (low, high) = (address(&raw const _stack_end), address(&raw const _stack_start));
        let mut place = &raw const _stack_end;
        // SAFETY: these are aligned words of RAM between the end of the statics and the start of the
        // stack. The stack in use is above the paint, and its words are read as plain numbers only.
        let word = |place: *const u32| unsafe { place.read_volatile() };
        while address(place) < high && word(place) == cortex_m_rt::STACK_PAINT_VALUE {
            place = place.wrapping_add(1);
        }
        Self {
            image: address(&raw const __sidata) + data - address(&raw const __vector_table),
            fixed: low - address(&raw const __sdata),
            stack: high - address(place),
        }
    }
}

/// A line of text to the debugger (or to QEMU's standard output). It uses no heap and no `core::fmt`,
/// whose checks would link panics into the image.
pub(crate) struct Line {
    bytes: [u8; 100],
    length: usize,
}

impl Line {
    /// An empty line.
    pub(crate) fn new() -> Self {
        Self { bytes: [0; 100], length: 0 }
    }

    /// Adds text, as far as it fits.
    #[must_use]
    #[inline(never)] // keeps the image small: its size is a budget of the estimator
    pub(crate) fn text(mut self, text: &str) -> Self {
        for byte in text.bytes() {
            if let Some(place) = self.bytes.get_mut(self.length) {
                *place = byte;
                self.length += 1;
            }
        }
        self
    }

    /// Adds a number with at least `least` digits, from the first one on.
    #[inline(never)]
    fn digits(mut self, value: u32, base: NonZeroU32, least: u32) -> Self {
        let mut unit = base.get().pow(least - 1);
        while value.checked_div(unit).is_some_and(|first| first >= base.get()) {
            unit *= base.get();
        }
        while let Some(leading) = value.checked_div(unit) {
            #[allow(clippy::cast_possible_truncation)] // a digit
            let digit = (leading % base) as u8;
            if let Some(place) = self.bytes.get_mut(self.length) {
                *place = digit + if digit < 10 { b'0' } else { b'a' - 10 };
                self.length += 1;
            }
            unit /= base;
        }
        self
    }

    /// Adds a whole number.
    #[must_use]
    pub(crate) fn whole(self, value: u32) -> Self {
        self.digits(value, DECIMAL, 1)
    }

    /// Adds 64 bits as sixteen digits.
    #[must_use]
    #[allow(clippy::cast_possible_truncation)] // halves
    pub(crate) fn hexadecimal(self, value: u64) -> Self {
        // Halves, because a division of 64 bits would enlarge the image.
        let [high, low] = [value >> 32, value & 0xFFFF_FFFF].map(|half| half as u32);
        self.digits(high, HEXADECIMAL, 8).digits(low, HEXADECIMAL, 8)
    }

    /// Adds a number from 0 to 400 000 with four decimals; a dash for any other.
    #[must_use]
    pub(crate) fn decimal(self, value: f32) -> Self {
        let scaled = value * 1e4 + 0.5;
        if !(0.0..4e9).contains(&scaled) {
            return self.text("-");
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // in range
        let scaled = scaled as u32;
        self.whole(scaled / 10_000).text(".").digits(scaled % 10_000, DECIMAL, 4)
    }

    /// Writes the line; without a debugger it is lost.
    pub(crate) fn end(self, out: &mut HostStream) {
        let line = self.text("\n");
        let _ = out.write_all(line.bytes.get(..line.length).unwrap_or(&[]));
    }
}

/// Prints a maneuver and the height after it.
pub(crate) fn maneuver(out: &mut HostStream, maneuver: &Maneuver, height: Option<Height<f32>>) {
    let (value, sd) = height.map_or((f32::NAN, f32::NAN), |h| (h.height_m.value, h.height_m.sd));
    #[allow(clippy::cast_precision_loss)] // printed
    let end_s = maneuver.end_us as f32 * 1e-6;
    Line::new()
        .text("maneuver to ")
        .decimal(end_s)
        .text(" s: height ")
        .decimal(value)
        .text(" m, one sigma ")
        .decimal(sd)
        .text(" m")
        .end(out);
}

/// The stream to which lines are written.
pub(crate) fn output() -> Option<HostStream> {
    hio::hstdout().ok()
}
