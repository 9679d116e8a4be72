//! The log as the suspensions of trailer and tractor show it: heights, and the cost of a sample.
#![no_std]
#![no_main]

#[path = "../board.rs"]
#[allow(dead_code)] // only the other images use decimals of their own
mod board;

use board::{Counter, Line, Memory, output};
use cg_firmware::pair;
use cg_firmware::replay::replay;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::hio::HostStream;
use panic_halt as _;

#[entry]
fn main() -> ! {
    let shown = match (Counter::start(), output()) {
        (Some(counter), Some(mut out)) => {
            show(counter, &mut out);
            EXIT_SUCCESS
        }
        _ => EXIT_FAILURE,
    };
    debug::exit(shown);
    loop {
        cortex_m::asm::wfi();
    }
}

fn show(counter: Counter, out: &mut HostStream) {
    let report = replay(
        &pair::DESIGN,
        pair::samples(),
        || counter.now(),
        |maneuver, height| board::maneuver(out, maneuver, height),
    );
    let memory = Memory::measure();
    for (name, value, unit) in [
        ("pair_push_mean", report.all.mean(), counter.unit()),
        ("pair_push_worst", report.all.worst, counter.unit()),
        ("pair_image", memory.image, "bytes"),
        ("pair_ram", memory.fixed + memory.stack, "bytes"),
    ] {
        Line::new().text(name).text(" = ").whole(value).text(" ").text(unit).end(out);
    }
    Line::new().text("pair_hash = ").hexadecimal(report.trace.0).end(out);
}
