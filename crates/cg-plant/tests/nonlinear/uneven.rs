//! Roads on which the axles do not stand on one level plane: grade, and bank that changes along the
//! vehicle (twist).

use super::{KMH, linear, vehicle};
use cg_plant::plant::{Ground, MAX_AXLES, PlantOptions, PlantSample, YawRollPlant};

const SPEED_MPS: f64 = 60.0 * KMH;

fn plant(options: &PlantOptions) -> YawRollPlant {
    let vehicle = vehicle("kraz");
    YawRollPlant::new(&vehicle, vehicle.reference_load(), options).unwrap()
}

/// A steady turn on this ground.
fn steady(plant: &YawRollPlant, steer_rad: f64, ground: &Ground) -> PlantSample {
    let mut run = plant.start(SPEED_MPS).unwrap();
    run.push_on(steer_rad, SPEED_MPS, ground, 2.0);
    for _ in 0..3000 {
        run.push(steer_rad, SPEED_MPS, 0.01);
    }
    run.sample()
}

/// A road whose plane is level and whose axles all stand on one bank is that banked road: suspension
/// rolls, specific forces and wheel loads are the same, and roll relative to gravity is. Without the
/// turned contact of the axles, nothing would roll.
#[test]
fn a_twist_common_to_all_axles_is_a_bank() {
    let plant = plant(&linear());
    for (common_rad, steer_rad) in [(0.02, 0.02), (-0.03, 0.02), (0.02, 0.0)] {
        let bank = Ground { bank_rad: common_rad, ..Ground::default() };
        let twist = Ground { twist_rad: [common_rad; MAX_AXLES], ..Ground::default() };
        let [a, b] = [bank, twist].map(|ground| steady(&plant, steer_rad, &ground));
        let level = steady(&plant, steer_rad, &Ground::default());
        // The turn lies in the plane of the road: across its axles the centripetal acceleration has the
        // part c a_y, which adds to gravity. Everything else is of second order.
        let share =
            common_rad.powi(2) + (common_rad * a.trailer.lateral_acceleration_mps2 / 9.8).abs();
        let same = |a: f64, b: f64, scale: f64, what: &str| {
            println!("{what}, {common_rad}, {steer_rad}: {a} {b}, {:.4}", (a - b) / scale);
            assert!((a - b).abs() < 1.5 * share * scale.abs(), "{what}, {common_rad}: {a} {b}");
        };
        for ((a, b), level) in [(a.tractor, b.tractor), (a.trailer, b.trailer)]
            .into_iter()
            .zip([level.tractor, level.trailer])
        {
            let moved_rad = a.suspension_roll_rad - level.suspension_roll_rad;
            assert!(moved_rad.abs() > 1e-3, "{moved_rad}");
            let [a_rad, b_rad] = [a, b].map(|unit| unit.suspension_roll_rad);
            same(a_rad, b_rad, moved_rad.abs() + a_rad.abs(), "suspension");
            same(a.roll_to_gravity_rad, b.roll_to_gravity_rad, common_rad, "roll");
            same(a.roll_rad + common_rad, b.roll_rad, common_rad, "turned roll");
        }
        for (a, b) in a.axles().iter().zip(b.axles()) {
            same(a.left_load_n, b.left_load_n, a.left_load_n, "load");
            same(a.right_load_n, b.right_load_n, a.right_load_n, "load");
        }
    }
}

/// Where tractor and trailer stand on banks of opposite sign, their frames share one roll angle (the
/// fifth wheel is stiff), and each suspension shows the difference.
#[test]
fn a_twist_between_the_units_rolls_both_suspensions_against_each_other() {
    let plant = plant(&linear());
    let mut twist_rad = [-0.01; MAX_AXLES];
    twist_rad[..3].fill(0.01);
    let rest = steady(&plant, 0.0, &Ground::default());
    let twisted = steady(&plant, 0.0, &Ground { twist_rad, ..Ground::default() });
    let tractor = twisted.tractor.suspension_roll_rad - rest.tractor.suspension_roll_rad;
    let trailer = twisted.trailer.suspension_roll_rad - rest.trailer.suspension_roll_rad;
    // Springs and tires in series take the 0.02 rad between the two axle groups together.
    assert!(tractor < -1e-3 && trailer > 1e-3, "{tractor} {trailer}");
    assert!(trailer - tractor < 0.02, "{tractor} {trailer}");
}

/// On a grade the wheels carry the weight times its cosine. The c.g. of the trailer is higher than the
/// fifth wheel that pulls it, so uphill a part of its load moves from there to its axles.
#[test]
fn a_grade_moves_the_load_to_the_rear() {
    let vehicle = vehicle("kraz");
    let load = vehicle.reference_load();
    let axles = &vehicle.trailer.axle;
    let unsprung = |of: fn(&cg_vehicle::vehicle::Axle) -> f64| -> f64 {
        axles.iter().map(|axle| of(&axle.axle)).sum()
    };
    let sprung_kg = load.trailer_mass_kg - unsprung(|axle| axle.unsprung_mass_kg);
    let height_kgm = sprung_kg * load.cg_height_m
        + unsprung(|axle| axle.unsprung_mass_kg * axle.center_height_m);
    let above_hitch_m = height_kgm / load.trailer_mass_kg - vehicle.hitch.height_m;
    for grade_rad in [0.05, -0.08] {
        let at = |grade_rad| plant(&PlantOptions { grade_rad, ..linear() });
        let sample = |plant: &YawRollPlant| plant.start(SPEED_MPS).unwrap().sample();
        let (level, graded) = (sample(&at(0.0)), sample(&at(grade_rad)));
        let sum = |s: &PlantSample| -> f64 {
            s.axles().iter().map(|axle| axle.left_load_n + axle.right_load_n).sum()
        };
        assert!((sum(&graded) / sum(&level) / f64::cos(grade_rad) - 1.0).abs() < 1e-9);
        // Moment of the wheel loads about the fifth wheel.
        let moment = |s: &PlantSample| -> f64 {
            let carried = s.axles().iter().filter(|axle| axle.is_on_trailer);
            let carried = carried.map(|axle| axle.left_load_n + axle.right_load_n);
            carried.zip(axles).map(|(load_n, axle)| load_n * axle.behind_hitch_m).sum()
        };
        let moved_nm = moment(&graded) - f64::cos(grade_rad) * moment(&level);
        let pull_n = load.trailer_mass_kg * super::G * f64::sin(grade_rad);
        let arm_m = moved_nm / pull_n;
        println!("{arm_m} {above_hitch_m}");
        // The body pitches by about a milliradian, over seven meters.
        assert!((arm_m - above_hitch_m).abs() < 0.01, "{arm_m} {above_hitch_m}");
        assert!((graded.grade_rad - grade_rad).abs() < 1e-15);
    }
}

/// A turn on a grade: the trailer is pulled along the tractor, at the articulation angle `ψ` to its own
/// axis, with `m g γ`. Compared with `m a_y`, this is the most by which its roll can change.
#[test]
fn a_grade_changes_the_ratios_by_the_pull_across_the_trailer() {
    let level = steady(&plant(&linear()), 0.02, &Ground::default());
    let graded = Ground { grade_rad: 0.05, ..Ground::default() };
    let graded = steady(&plant(&linear()), 0.02, &graded);
    let a_y = level.trailer.lateral_acceleration_mps2;
    let most = (super::G * 0.05 * level.articulation_rad / a_y).abs();
    for (a, b) in [(level.tractor, graded.tractor), (level.trailer, graded.trailer)] {
        let ratio =
            |unit: cg_plant::plant::UnitSample| unit.suspension_roll_rad / unit.specific_force_mps2;
        let change = ratio(b) / ratio(a) - 1.0;
        println!("{:+.3} % of {:.3} %", 100.0 * change, 100.0 * most);
        assert!(change.abs() > 0.1 * most && change.abs() < most, "{change} {most}");
    }
}
