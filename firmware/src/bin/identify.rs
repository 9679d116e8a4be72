//! Counts the cost of the identifier alone, for one row of one channel.
#![no_std]
#![no_main]

#[path = "../board.rs"]
#[allow(dead_code)] // only the other images use memory and decimals
mod board;

use board::{Counter, Line, output};
use cg_firmware::replay::identify;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use panic_halt as _;

#[entry]
fn main() -> ! {
    let shown = match (Counter::start(), output()) {
        (Some(counter), Some(mut out)) => {
            let costs = identify(|| counter.now());
            for (name, value) in [
                ("identify_mean", costs.even.mean()),
                ("identify_worst", costs.even.worst),
                ("identify_jitter_mean", costs.jitter.mean()),
            ] {
                Line::new()
                    .text(name)
                    .text(" = ")
                    .whole(value)
                    .text(" ")
                    .text(counter.unit())
                    .end(&mut out);
            }
            EXIT_SUCCESS
        }
        _ => EXIT_FAILURE,
    };
    debug::exit(shown);
    loop {
        cortex_m::asm::wfi();
    }
}
