//! Boots on a Cortex-M4F, replays the log, and prints the results and their cost.
//!
//! `cargo run --release` runs it in QEMU and counts instructions. On a board with a debugger the
//! same image counts cycles.
#![no_std]
#![no_main]

mod board;

use board::{Counter, Line, Memory, output};
use cg_firmware::log::samples;
use cg_firmware::replay::{Report, replay};
use cg_firmware::truck::DESIGN;
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
    let mut maneuvers = 0;
    let report = replay(
        &DESIGN,
        samples(),
        || counter.now(),
        |maneuver, height| {
            maneuvers += 1;
            board::maneuver(out, maneuver, height);
        },
    );
    #[cfg(feature = "control")]
    control(maneuvers);
    let memory = Memory::measure();
    number(out, "maneuvers", maneuvers, "");
    costs(out, counter, &report);
    number(out, "image", memory.image, "bytes");
    number(out, "ram_fixed", memory.fixed, "bytes");
    number(out, "ram_stack", memory.stack, "bytes");
    number(out, "ram", memory.fixed + memory.stack, "bytes");
    if let Some(height) = report.height {
        Line::new().text("height = ").decimal(height.height_m.value).text(" m").end(out);
        Line::new().text("height_sd = ").decimal(height.height_m.sd).text(" m").end(out);
        Line::new().text("threshold = ").decimal(report.threshold_g).text(" g").end(out);
    }
    Line::new().text("hash = ").hexadecimal(report.trace.0).end(out);
}

/// A bounds check that is not optimized away: the search for panics must find it.
#[cfg(feature = "control")]
fn control(index: u32) {
    let table = core::hint::black_box([1_u32, 2, 3]);
    core::hint::black_box(table[index as usize]);
}

fn costs(out: &mut HostStream, counter: Counter, report: &Report) {
    number(out, "push_mean", report.all.mean(), counter.unit());
    number(out, "push_worst", report.all.worst, counter.unit());
    number(out, "finish", report.finish, counter.unit());
    number(out, "samples", report.all.calls, "");
}

fn number(out: &mut HostStream, name: &str, value: u32, unit: &str) {
    Line::new().text(name).text(" = ").whole(value).text(" ").text(unit).end(out);
}
