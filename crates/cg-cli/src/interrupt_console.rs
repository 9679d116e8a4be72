//! In place of `interrupt` on Windows: handling of Ctrl-C and Ctrl-Break. The program leaves no
//! incomplete files.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use cg_output::draft::abandon;

/// Exit status of a program that Ctrl-C has ended (`STATUS_CONTROL_C_EXIT`, 0xC000013A).
const ENDED_BY_USER: i32 = -0x3FFF_FEC6;

/// Ends the program at Ctrl-C. With a flag, the first one sets it, and the second one ends the
/// program.
pub(crate) fn handle_signals(flag: Option<Arc<AtomicBool>>) -> io::Result<()> {
    ctrlc::set_handler(move || {
        if flag.as_ref().is_some_and(|flag| !flag.swap(true, Ordering::Relaxed)) {
            return;
        }
        let _abandoned = abandon();
        std::process::exit(ENDED_BY_USER);
    })
    .map_err(io::Error::other)
}
