//! x
#![allow(clippy::unwrap_used)]
mod common;
use cg_core::*;
use cg_vehicle::{
    Variant, design::design, estimate::*, log::*, maneuver::Maneuver, sensors::Sensors, simulate::*,
};
fn show(name: &str, d: &Design<f64>, rows: &[LogRow]) {
    let mut e: Estimator<f64, FilteredArx<f64>> =
        Estimator::new(d, Settings::truck(), Prior::standard());
    let mut all = vec![];
    for r in rows {
        let s = Sample {
            time_us: (r.time_s * 1e6).round() as u64,
            steer_rad: r.steer_rad,
            roll_rad: r.roll_rad,
            tilt_rad: r.tilt_rad,
            speed_mps: r.speed_mps,
            lateral_acceleration_mps2: r.lateral_acceleration_mps2,
            yaw_rate_radps: r.yaw_rate_radps,
            trailer_mass_kg: r.trailer_mass_kg,
        };
        all.extend(e.push(&s).unwrap().closed);
    }
    all.extend(e.finish());
    for m in all {
        for o in m.outcomes {
            if let Some(f) = o.fit {
                println!(
                    "{name:30} misfit {:6.2} snr {:5.1} fit {:5.1} noise {:.5} ratio {:.4} ± {:.4} h {:?}",
                    f.misfit,
                    f.snr_db,
                    f.fit_percent,
                    f.noise_sd_rad,
                    f.ratio.value,
                    f.ratio.sd,
                    o.height_m.map(|h| (h.value * 1000.0).round() / 1000.0).ok()
                );
            }
        }
    }
}
#[test]
fn x() {
    let d = design(&common::vehicle("kraz.toml"), Variant::Complete).unwrap();
    for k in common::known() {
        let path = common::fixtures().join("logs").join(&k.log);
        let rows: Vec<LogRow> = LogReader::open(&path, &LogOptions::default())
            .unwrap()
            .collect::<Result<_, _>>()
            .unwrap();
        show(&k.log, &d, &rows);
    }
    let v = common::vehicle("baseline.toml");
    let d = design(&v, Variant::Complete).unwrap();
    let p = Sensors::default();
    let n = Sensors { snr_db: Some(20.0), ..p };
    for (name, s) in [
        ("clean", p),
        ("20 dB", n),
        ("sat 1 deg clean", Sensors { roll_limit_rad: Some(0.0175), ..p }),
        ("sat 1 deg 20 dB", Sensors { roll_limit_rad: Some(0.0175), ..n }),
        ("sat 2 deg 20 dB", Sensors { roll_limit_rad: Some(0.035), ..n }),
        ("sat 2.4 deg 20 dB", Sensors { roll_limit_rad: Some(0.042), ..n }),
        ("delay 0.3", Sensors { delay_s: 0.3, ..n }),
        ("delay 1", Sensors { delay_s: 1.0, ..n }),
        ("play", Sensors { steer_play_rad: 0.0087, ..n }),
        ("lag 1", Sensors { noise_lag_s: 1.0, ..n }),
    ] {
        for m in [Maneuver::RoundedStep, Maneuver::LaneChange, Maneuver::Drive] {
            let sim = LogSimulation::new(
                &v,
                Scenario {
                    sensors: s,
                    duration_s: if m == Maneuver::Drive { 60.0 } else { 20.0 },
                    ..Scenario::of(&v, m)
                },
            )
            .unwrap();
            let mut rows = vec![];
            sim.run(|r| {
                rows.push(*r);
                Ok::<(), ()>(())
            })
            .unwrap();
            show(&format!("{name} {m:?}"), &d, &rows);
        }
    }
}
