//! The same replay on the host: the answers that the chip must give, bit for bit.

use cg_firmware::replay::replay;

fn main() {
    let report = replay(
        || 0,
        |maneuver, height| {
            let (value, sd) =
                height.map_or((f32::NAN, f32::NAN), |h| (h.height_m.value, h.height_m.sd));
            #[allow(clippy::cast_precision_loss)]
            let end_s = maneuver.end_us as f32 * 1e-6;
            println!("maneuver to {end_s:.4} s: height {value:.4} m, one sigma {sd:.4} m");
        },
    );
    println!("samples = {}", report.all.calls);
    println!("hash = {:016x}", report.trace.0);
}
