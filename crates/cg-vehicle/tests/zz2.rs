//! x
mod common;
use cg_vehicle::{Variant, design::design};
#[test]
fn x() {
    for n in ["baseline.toml", "kraz.toml", "air.toml"] {
        let t = std::time::Instant::now();
        let d = design(&common::vehicle(n), Variant::Complete).unwrap();
        println!("Reduced5 {:?}", t.elapsed());
        for c in d.channels {
            let s = c.model.time_scale_radps();
            println!("{n} {s:.2} {:.4?}", c.model.in_scaled_time(s));
        }
    }
}
