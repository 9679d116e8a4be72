use cg_vehicle::{Load, Variant, Vehicle};
use cg_vehicle::linear::ratio_line;
use cg_core::Channel;
#[test]
fn measure() {
    for name in ["kraz", "euro", "baseline", "air", "baseline-tables"] {
        let v = Vehicle::load(format!("{}/../../fixtures/vehicles/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
        for speed in [5.0, 13.9, 22.2] {
        for payload in [10e3, 25e3] {
            let load = Load { trailer_mass_kg: v.empty_trailer_mass_kg() + payload, ..v.reference_load() };
            let at = |d: f64| { let mut m = v.clone(); m.trailer.payload.behind_hitch_m += d; ratio_line(&m, Variant::Complete, speed, load).unwrap() };
            let (a, b, c) = (at(-0.3), at(0.0), at(0.3));
            print!("{name:16} {speed:4.1} {:3.0} t:", payload/1e3);
            for ch in Channel::ALL { let i = ch.index(); let h = load.cg_height_m;
                let r = b[i].ratio_at(h);
                let s = b[i].relative_slope_at(h) * h;
                print!("  {:+.2} {:+.2} (h {:.2})", 100.*(a[i].ratio_at(h)/r-1.), 100.*(c[i].ratio_at(h)/r-1.), 50.*(c[i].ratio_at(h)-a[i].ratio_at(h))/r/s); }
            println!();
        }}
    }
}
