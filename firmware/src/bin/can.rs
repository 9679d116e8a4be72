//! J1939 frames in, heights out, without a heap.
#![no_std]
#![no_main]

#[path = "../board.rs"]
#[allow(dead_code)] // only the other images use the counter
mod board;

use board::{Line, Memory, output};
use cg_firmware::can::replay;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::hio::HostStream;
use panic_halt as _;

#[entry]
fn main() -> ! {
    let shown = match output() {
        Some(mut out) => {
            show(&mut out);
            EXIT_SUCCESS
        }
        None => EXIT_FAILURE,
    };
    debug::exit(shown);
    loop {
        cortex_m::asm::wfi();
    }
}

fn show(out: &mut HostStream) {
    let trace =
        replay(|maneuver, estimator| board::maneuver(out, maneuver, estimator.combined_height()));
    let memory = Memory::measure();
    Line::new().text("can_ram = ").whole(memory.fixed + memory.stack).text(" bytes").end(out);
    Line::new().text("can_hash = ").hexadecimal(trace.0).end(out);
}
