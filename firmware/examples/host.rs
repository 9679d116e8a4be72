//! The same replays on the host: the answers that the chip must give, bit for bit.

use cg_core::Height;
use cg_firmware::log::samples;
use cg_firmware::replay::replay;
use cg_firmware::truck::DESIGN;
use cg_firmware::{Maneuver, can, pair};

fn tell(maneuver: &Maneuver, height: Option<Height<f32>>) {
    // The chip's format and rounding: a dash if there is no number.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // in range
    let scaled = |x: f32| (x * 1e4 + 0.5) as u32;
    let number = |x: Option<f32>| {
        let scaled = x.map(scaled);
        scaled.map_or("-".to_owned(), |x| format!("{}.{:04}", x / 10_000, x % 10_000))
    };
    let value = number(height.map(|h| h.height_m.value));
    let sd = number(height.map(|h| h.height_m.sd));
    #[allow(clippy::cast_precision_loss)]
    let end_s = number(Some(maneuver.end_us as f32 * 1e-6));
    println!("maneuver to {end_s} s: height {value} m, one sigma {sd} m");
}

fn main() {
    let report = replay(&DESIGN, samples(), || 0, tell);
    println!("samples = {}", report.all.calls);
    println!("hash = {:016x}", report.trace.0);
    let trace = can::replay(|maneuver, estimator| tell(maneuver, estimator.combined_height()));
    println!("can_hash = {:016x}", trace.0);
    let report = replay(&pair::DESIGN, pair::samples(), || 0, tell);
    println!("pair_hash = {:016x}", report.trace.0);
}
