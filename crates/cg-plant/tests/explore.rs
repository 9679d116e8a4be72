#![allow(clippy::unwrap_used, warnings)]
#[path = "../../cg-logs/tests/common/mod.rs"]
mod common;
use cg_logs::calibrate::*;
use cg_logs::estimate::{EstimateOptions, LogEstimator};
use cg_logs::log::LogRow;
use cg_plant::maneuver::Maneuver;
use cg_plant::sensors::Sensors;
use cg_plant::simulate::{LogSimulation, Plant, Scenario};
use cg_vehicle::design::design_with;
use cg_vehicle::{Load, Variant, Vehicle, VehicleError};

fn rows(v: &Vehicle, m: Maneuver, payload_t: f64, h: f64, snr: Option<f64>, seed: u64) -> Vec<LogRow> {
    let load = Load { trailer_mass_kg: v.empty_trailer_mass_kg() + 1e3 * payload_t, cg_height_m: h };
    let s = Scenario { plant: Plant::Nonlinear, load, rate_hz: 50.0, sensors: Sensors { snr_db: snr, ..Sensors::default() }, seed, ..Scenario::of(v, m) };
    LogSimulation::new(v, s).unwrap().rows()
}
#[test]
fn explore() {
    let snr: Option<f64> = std::env::var("SNR").ok().map(|s| s.parse().unwrap());
    for name in std::env::var("TRUCKS").unwrap_or("baseline-tables.toml,kraz.toml,euro.toml".into()).split(',') {
        let v = common::vehicle(name);
        let tare = v.trailer.tare.cg_height_m;
        for calib in [vec![Maneuver::RoundedStep], vec![Maneuver::RoundedStep, Maneuver::LaneChange]] {
            let mut set = Vec::new();
            for &m in &calib { for (p, h) in [(0.0, tare), (20.0, 1.9)] { set.push((format!("{m} {p}"), h, rows(&v, m, p, h, snr, 1), v.empty_trailer_mass_kg() + 1e3*p)); } }
            let known: Vec<KnownLog> = set.iter().map(|(n, h, _, m)| KnownLog { log: n.clone(), load: KnownLoad::Laden { height_m: *h, trailer_mass_kg: Some(*m) } }).collect();
            let options = CalibrateOptions { force: true, ..CalibrateOptions::default() };
            let t0 = std::time::Instant::now();
            let calibration = calibrate::<VehicleError>(&v, options, &known, |k, e| {
                for r in &set.iter().find(|s| s.0 == k.log).unwrap().2 { e.push(r).unwrap(); }
                Ok(())
            }).unwrap();
            println!("== {name} calibrated on {calib:?}, birge {} {:?}", calibration.judgment().birge(), t0.elapsed());
            for s in &calibration.shape { println!("{s:?}"); }
            for s in &calibration.statement { println!("  {s}"); }
            let with = calibration.belief();
            let without = cg_vehicle::belief::Belief { shapes: Default::default(), ..with.clone() };
            let designs: Vec<_> = [&without, &with].map(|b| design_with(&v, Variant::Complete, b).unwrap()).to_vec();
            for m in [Maneuver::LaneChange, Maneuver::RoundedStep] { for (p, h) in [(5.0, 1.5), (15.0, 2.0), (25.0, 2.2)] {
                print!("   {m} {p} t:");
                for d in &designs {
                    let (mut e, mut cov, mut sd, mut chs) = (vec![], 0, 0.0, vec![vec![], vec![]]);
                    let n = if snr.is_some() { 20 } else { 1 };
                    for seed in 0..n {
                        let r = rows(&v, m, p, h, snr, 100 + seed);
                        let o = EstimateOptions { trailer_mass_kg: Some(v.empty_trailer_mass_kg() + 1e3*p), ..EstimateOptions::default() };
                        let mut est = LogEstimator::from_design(d, v.align_settings(), o);
                        for r in &r { est.push(r).unwrap(); }
                        let est = est.finish();
                        let Some(x) = est.height_m else { continue };
                        e.push(100.0*(x/h-1.0));
                        for (c, l) in est.channels.iter().zip(&mut chs) { if let Some(x) = c.height_m { l.push(100.0*(x/h-1.0)); } }
                        let ci = est.height_ci95_m.unwrap();
                        cov += usize::from(ci[0] <= h && h <= ci[1]); sd = 100.0*est.height_sd_m.unwrap()/h;
                    }
                    let mean = |e: &[f64]| e.iter().sum::<f64>() / e.len() as f64;
                    let rms = (e.iter().map(|x| x*x).sum::<f64>() / e.len() as f64).sqrt();
                    print!(" | bias {:+.2} rms {rms:.2} sd {sd:.2} cov {cov}/{} [{:+.2} {:+.2}]", mean(&e), e.len(), mean(&chs[0]), mean(&chs[1]));
                }
                println!();
            } }
        }
    }
}
