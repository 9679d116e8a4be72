//! Handling of SIGINT, SIGTERM and SIGHUP: the program ends with the signal's status and leaves no
//! incomplete files.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::Builder;

use cg_output::draft::abandon;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// Ends the program at a signal. With a flag, the first signal sets it, and the second one ends the
/// program.
pub(crate) fn handle_signals(flag: Option<Arc<AtomicBool>>) -> io::Result<()> {
    let mut handled = vec![SIGINT, SIGTERM];
    // If `nohup` has set SIGHUP to be ignored, it remains ignored.
    if !ignores(SIGHUP) {
        handled.push(SIGHUP);
    }
    let mut signals = Signals::new(handled)?;
    Builder::new().name("signals".to_owned()).spawn(move || {
        for signal in signals.forever() {
            if flag.as_ref().is_some_and(|flag| !flag.swap(true, Ordering::Relaxed)) {
                continue;
            }
            let _abandoned = abandon();
            // This ends the process with the status of the signal.
            let _ = emulate_default_handler(signal);
        }
    })?;
    Ok(())
}

/// Whether this process was started with a signal ignored; `false` if the system does not tell.
fn ignores(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}
