//! V5, V6: the complete linear model is the plant's limit for small motion.

use cg_plant::plant::YawRollPlant;
use cg_vehicle::equations::Equations;
use cg_vehicle::linear::Laden;
use cg_vehicle::response::StateSpace;
use cg_vehicle::{Load, Variant, Vehicle};

use super::{KMH, linear, rounded, vehicle};

/// The equations with the tires of small motion.
fn small_motion(vehicle: &Vehicle, load: Load, speed_mps: f64) -> Equations {
    let laden = Laden::new(vehicle, Variant::Complete, load).unwrap();
    Equations::of(&laden.with_tires_of_the_file(), speed_mps).unwrap()
}

/// Both models of small motion at 50 km/h.
fn both(vehicle: &Vehicle) -> (StateSpace, StateSpace) {
    let (load, speed_mps) = (vehicle.reference_load(), 50.0 * KMH);
    let plant = YawRollPlant::new(vehicle, load, &linear()).unwrap();
    let equations = small_motion(vehicle, load, speed_mps);
    (plant.linearized(speed_mps).unwrap(), equations.state_space().unwrap())
}

/// The baseline with separate springs for every axle, as in the linear model.
fn ungrouped() -> Vehicle {
    let mut vehicle = vehicle("baseline");
    for axle in &mut vehicle.tractor.axle {
        axle.axle.load_group = None;
    }
    for axle in &mut vehicle.trailer.axle {
        axle.axle.load_group = None;
    }
    for tyre in &mut vehicle.tyre {
        tyre.unloaded_radius_m = Some(0.538);
    }
    vehicle
}

/// The truck without the tires' vertical dampers, which are not in the linear model.
fn kraz() -> Vehicle {
    let mut vehicle = vehicle("kraz");
    for tyre in &mut vehicle.tyre {
        tyre.vertical_damping_ns_per_m = 0.0;
    }
    vehicle
}

/// The second truck with a frame that twists: a van and a flatbed. Its dampers and load groups are left
/// out as above. The roll sensor is at the front, over the axles, or there are both; the accelerometer
/// is on the half of the (first) roll sensor.
fn twisting() -> impl Iterator<Item = Vehicle> {
    [3e6, 6e5].into_iter().flat_map(|stiffness_nm_per_rad| {
        [[Some(0.5), None], [None, None], [Some(0.5), Some(8.0)]].map(|places| {
            let mut vehicle = vehicle("euro");
            vehicle.name = format!("{stiffness_nm_per_rad:e} N m/rad, roll at {places:?}");
            vehicle.trailer.frame_torsional_stiffness_nm_per_rad = Some(stiffness_nm_per_rad);
            let roll = &mut vehicle.sensors.roll;
            [roll.behind_hitch_m, roll.second_behind_hitch_m] = places;
            vehicle.sensors.accelerometer.behind_hitch_m = Some(places[0].unwrap_or(7.7));
            for axle in &mut vehicle.trailer.axle {
                axle.axle.load_group = None;
            }
            for tyre in &mut vehicle.tyre {
                tyre.vertical_damping_ns_per_m = 0.0;
            }
            vehicle
        })
    })
}

fn steady(model: &StateSpace) -> Vec<(&'static str, f64)> {
    let dc = |row| model.steady(row, 0.0).unwrap();
    let force = |unit: usize| {
        let (row, feedthrough) = &model.specific_force[unit];
        model.steady(row, *feedthrough).unwrap()
    };
    vec![
        ("f1", force(0)),
        ("f2", force(1)),
        ("φ1−φu", dc(&model.suspension_roll[0])),
        ("φ2−φu", dc(&model.suspension_roll[1])),
        ("v1", dc(&model.tractor_lateral_velocity)),
        ("r", dc(&model.trailer_yaw_rate)),
        ("φ1", dc(&model.tractor_roll)),
        ("ψ1−ψ2", dc(&model.articulation)),
        ("φ2", dc(&model.trailer_roll)),
        ("front", dc(&model.halves_roll[0])),
        ("rear", dc(&model.halves_roll[1])),
        ("a_y2", model.lateral_gain().unwrap()),
    ]
}

/// Central differences of 1e-6 rad have errors of 1e-12 by curvature and 1e-10 by rounding, times the
/// condition number of the static system (1e4).
const SAME: f64 = 1e-6;

#[test]
fn steady_gains_are_those_of_the_linear_model() {
    for vehicle in [ungrouped(), kraz()].into_iter().chain(twisting()) {
        let (ours, theirs) = both(&vehicle);
        for ((name, a), (_, b)) in steady(&ours).iter().zip(steady(&theirs)) {
            println!("{} {name:6} {a:10.6} {b:10.6}", vehicle.name);
            assert!((a / b - 1.0).abs() < SAME, "{name}: {a} {b}");
        }
        for (a, b) in ours.axle_roll.iter().zip(&theirs.axle_roll) {
            let (a, b) = (ours.steady(a, 0.0).unwrap(), theirs.steady(b, 0.0).unwrap());
            assert!((a / b - 1.0).abs() < SAME, "{a} {b}");
        }
    }
}

/// Identical axles of a load group share the same roll moment. Their own roll angles then differ as the
/// tire forces differ, which does not affect the bodies.
#[test]
fn load_equalization_leaves_the_steady_body_alone() {
    let (ours, theirs) = both(&vehicle("baseline"));
    for ((name, a), (_, b)) in steady(&ours).iter().zip(steady(&theirs)) {
        assert!((a / b - 1.0).abs() < SAME, "{name}: {a} {b}");
    }
    let dc = |model: &StateSpace, i: usize| model.steady(&model.axle_roll[i], 0.0).unwrap();
    for pair in [[1, 2], [3, 4]] {
        let [a, b] = [&ours, &theirs].map(|model| dc(model, pair[0]) + dc(model, pair[1]));
        assert!((a / b - 1.0).abs() < SAME, "{a} {b}");
    }
}

/// Every pole of the linear model is a pole of the plant, which also has the poles of bounce and pitch.
#[test]
fn poles_are_those_of_the_linear_model() {
    for mut vehicle in [ungrouped(), kraz()].into_iter().chain(twisting()) {
        // Plates that can part keep the motion of a hard fifth wheel, which a run slows otherwise.
        vehicle.hitch.separation_moment_nm = Some(1e12);
        let (ours, theirs) = both(&vehicle);
        let poles = ours.to_trailer_roll().poles().unwrap();
        for (re, im) in theirs.to_trailer_roll().poles().unwrap() {
            let nearest = poles
                .iter()
                .map(|pole| (pole.0 - re).hypot(pole.1 - im))
                .fold(f64::INFINITY, f64::min);
            // Differences as above, on entries of up to 1e6 1/s² (the roll-rigid fifth wheel); poles
            // close to each other are moved by the square root of the error.
            assert!(nearest / re.hypot(im) < 1e-5, "{}: {re} {im}: {nearest:e}", vehicle.name);
        }
        assert!(poles.iter().all(|pole| pole.0 < 1e-6), "{poles:?}");
    }
}

/// Normalized rms difference of trailer roll between plant and linear model in a rounded step.
fn difference(vehicle: &Vehicle, steer_rad: f64) -> f64 {
    let (load, speed_mps) = (vehicle.reference_load(), 50.0 * KMH);
    let plant = YawRollPlant::new(vehicle, load, &linear()).unwrap();
    let equations = small_motion(vehicle, load, speed_mps);
    let model = equations.state_space().unwrap();
    let samples = rounded(&mut plant.start(speed_mps).unwrap(), steer_rad, speed_mps, 8.0);
    let mut run = model.simulation(1e-3);
    let (mut error, mut size) = (0.0, 0.0);
    for (k, sample) in samples.iter().enumerate().skip(1) {
        for j in 1..=10 {
            #[allow(clippy::cast_precision_loss)] // thousands of steps
            let time_s = (10 * (k - 1) + j) as f64 * 1e-3;
            run.push(steer_rad * cg_vehicle::reduction::quality::rounded_step(time_s, 3.0));
        }
        let roll_rad = model.trailer_roll.dot(&run.state);
        error += (sample.trailer.roll_rad - roll_rad).powi(2);
        size += roll_rad * roll_rad;
    }
    (error / size).sqrt()
}

/// The roll equations 3.61–3.82 with the fifth wheel's moment (the complete model) in time. A symmetric
/// vehicle has no even terms. What the linear model leaves out (nonlinear cornering stiffness over
/// load, products of angles) therefore grows with the square of the steer angle, or faster if loads
/// reach the next node of a table: at half the angle the difference is at most a quarter, within a
/// tenth. At 0.01 rad loads change by 10 % and angles are 0.01: 1e-4 to 1e-3.
#[test]
fn small_motion_in_time_is_that_of_the_linear_model() {
    let mut twisting = kraz();
    twisting.name = "kraz on a frame that twists".to_owned();
    twisting.trailer.frame_torsional_stiffness_nm_per_rad = Some(6e5);
    twisting.sensors.roll.behind_hitch_m = Some(0.5);
    for vehicle in [ungrouped(), kraz(), twisting] {
        let [whole, half] = [0.01, 0.005].map(|steer_rad| difference(&vehicle, steer_rad));
        let three = difference(&vehicle, 3.3_f64.to_radians());
        println!(
            "{}: rms difference {half:.2e} at 0.005 rad, {whole:.2e} at 0.01, {three:.2e} at 3.3 degrees",
            vehicle.name
        );
        assert!(whole < 1e-3, "{whole}");
        assert!(whole / half > 3.5, "{}", whole / half);
    }
}
