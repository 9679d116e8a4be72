#![allow(missing_docs)]
#[path = "../../cg-vehicle/tests/common/mod.rs"]
mod common;
use cg_core::Channel;
use cg_plant::maneuver::Maneuver;
use cg_plant::road::{Road, RoadPoint};
use cg_plant::sensors::ChassisSensors;
use cg_plant::simulate::{LogSimulation, Scenario};
use cg_vehicle::linear::ratio_line;
use cg_vehicle::{Load, Variant};
#[test]
fn zz() {
    for f in [0.05, 0.3, 1.0] {
        let mut v = common::vehicle("baseline-tables.toml");
        v.spring = v.spring.iter().map(|s| s.clone().with_friction(f)).collect();
        for (m, h) in [(13761.0, 1.6), (13761.0, 2.1), (31261.0, 1.6), (31261.0, 2.1)] {
            let load = Load { trailer_mass_kg: m, cg_height_m: h };
            let mut s = format!("fr {f} m {m} h {h}: ");
            for g in [0.04, 0.08, 0.12, 0.16, 0.2] {
                let u = 14.0;
                let r = u * u / (9.81 * g);
                let places = [(0.0, 0.0), (40.0, 0.0), (120.0, 1.0), (520.0, 1.0), (900.0, 1.0)];
                let pts = places.map(|(d, sh)| RoadPoint { distance_m: d, curvature_per_m: sh / r, bank_rad: 0.0, grade_rad: 0.0, speed_mps: u });
                let road = Road::new("x", pts.to_vec()).unwrap();
                let sc = Scenario { load, rate_hz: 50.0, duration_s: 32.0, ..Scenario::of(&v, Maneuver::Drive) };
                let rows = LogSimulation::on_road(&v, sc, &road, &ChassisSensors::default()).unwrap().rows();
                let n = rows.len();
                let last = &rows[n - 100..];
                let mean = |k: fn(&cg_logs::log::LogRow) -> f64| last.iter().map(k).sum::<f64>() / 100.0;
                let (sr, fr) = (mean(|r| r.suspension_roll_rad), mean(|r| r.lateral_specific_force_mps2));
                let (s1, f1) = (mean(|r| r.tractor_suspension_roll_rad), mean(|r| r.tractor_lateral_specific_force_mps2));
                let fric = cg_vehicle::friction::roll_friction(&v, load).unwrap();
                let corr = |fr: &cg_core::Friction<f64>, s: f64| if fr.deflection_rad > 0.0 { s * (1.0 - fr.usual_share) + fr.bend * (s - fr.knee_rad).max(0.0) + fr.roll_rad * (1.0 - (-s / fr.deflection_rad).exp()) } else { s };
                let (sr, s1) = (corr(&fric[Channel::Suspension.index()], sr), corr(&fric[Channel::Tractor.index()], s1));
                if g == 0.04 { println!("{:?}", fric[Channel::Tractor.index()]); } let raw1 = mean(|r| r.tractor_suspension_roll_rad); let hm = rows[n-1].clone(); let _ = hm;
                let lines = ratio_line(&v, Variant::Complete, u, load).unwrap();
                let t = lines[Channel::Suspension.index()];
                let tr = lines[Channel::Tractor.index()];
                let hh = |l: cg_core::RatioLine<f64>, x: f64| (l.a0 - x * l.b0) / (x * l.b1 - l.a1) / h - 1.0;
                s += &format!(" [{g}g s={:.1} raw1 {:.2} y1 {:.2} lin {:.2} {:+.1}% {:+.1}%]", 1e3 * sr, 1e3 * raw1, 1e3 * s1, 1e3 * f1 * tr.ratio_at(h), 100.0 * hh(t, sr / fr), 100.0 * hh(tr, s1 / f1));
            }
            println!("{s}");
        }
    }
}
