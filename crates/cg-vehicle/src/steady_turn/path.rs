//! The path of a steady turn from straight driving until the vehicle tips, and its greatest lateral
//! acceleration, which is the rollover threshold.
//!
//! The trailer's roll angle is increased in steps. The roll plane, the loads of the axles and the yaw
//! plane depend on each other and are solved in turn at every step until they agree, so that a point of
//! the path does not depend on the steps before it. Large steps therefore find about where the greatest lateral
//! acceleration is, and are then halved around it.

use super::point::Point;
use super::roll_plane::RollPlane;
use super::suspension::Suspension;

/// First step (g) to the tightest turn.
const TURN_G: f64 = 0.02;
/// Steps of the trailer's roll angle that find the greatest lateral acceleration, and those that measure
/// it. The measured ones miss the corner of the curve by half a step at most, which is 0.13 % of the
/// threshold of an empty truck, where the curve is steepest.
const STEP_RAD: f64 = 8e-3;
const FINE_RAD: f64 = 5e-4;
/// While all wheels are on the road, the lateral acceleration grows with the roll angle, and the steps that find its greatest value are
/// this many times as large.
const UPRIGHT: f64 = 4.0;
/// Where it slides, the steps are halved many times, so that steps this many times as large are fine.
const SLIDING: f64 = 2.0;
/// Number of times that a step may be halved.
const HALVINGS: u32 = 6;
/// Roll angle at which the search ends, because any trailer has tipped by then.
const END_RAD: f64 = 0.6;
/// When the lateral acceleration falls below this share of its greatest value, the vehicle is
/// tipping.
const FALLEN: f64 = 0.8;
/// Number of steps without a state at which the vehicle is tipping. At fewer, an axle of a pair turns over at
/// once when it lifts, and the path goes on behind the jump.
const JUMP: u32 = 4;
/// A change of the lateral acceleration (g) below this means that roll plane, loads and yaw plane agree.
const SETTLED: f64 = 1e-5;
/// The roll plane is solved up to this share of the last change, of which the first one counts as that many g.
const EXACT: f64 = 0.01;
const FIRST_G: f64 = 0.01;
/// Number of times that they are solved in turn. Near the threshold of a light load the shift of loads may
/// settle more slowly, and then lacks 0.001 g at most.
const ROUNDS: usize = 20;
/// From this round on the forces of the yaw plane are damped: which axle of a pair lifts first depends on
/// their forces, and these on which has lifted, so that the two would take turns.
const UNDAMPED: usize = 4;

/// What has no solution.
enum Unsolved {
    Roll,
    Turn,
}

impl RollPlane<'_> {
    /// The rollover threshold at a height of the trailer's sprung c.g., in g; if the vehicle slides before it tips, the
    /// lateral acceleration at which it slides.
    pub(crate) fn threshold_g(&self, cg_height_m: f64) -> f64 {
        self.threshold_in_steps(cg_height_m, STEP_RAD, FINE_RAD).map_or(0.0, |point| point.alpha)
    }

    /// The greatest lateral acceleration of any turn of the upright vehicle, in g; zero if the tires hold none.
    pub(super) fn tightest_turn_g(&self) -> f64 {
        let Some(mut point) = self.start() else { return 0.0 };
        let (mut greatest_g, mut step_g) = (point.alpha, TURN_G);
        while step_g > SETTLED {
            point.alpha = greatest_g + step_g;
            if self.turn_on(false, &mut point) {
                greatest_g = point.alpha;
            } else {
                step_g *= 0.5;
            }
        }
        greatest_g
    }

    /// The state at the threshold; `None` if the tires hold no turn at all.
    fn threshold_in_steps(&self, cg_height_m: f64, step_rad: f64, fine_rad: f64) -> Option<Point> {
        let [mut before, mut greatest] = self.greatest(cg_height_m, step_rad, self.start()?);
        if greatest.slides {
            // How near the path comes to the tightest turn depends on its steps.
            let [_, greatest] = self.greatest(cg_height_m, SLIDING * fine_rad, before);
            return Some(greatest);
        }
        let mut step_rad = step_rad;
        // A vehicle that tips at once has its greatest value at the start.
        while step_rad > fine_rad && greatest.roll_rad > 0.0 {
            step_rad *= 0.5;
            let beside = |from: &Point, to_rad: f64| {
                let mut point = from.clone();
                self.follow(cg_height_m, to_rad, HALVINGS, &mut point);
                point
            };
            let less = beside(&before, greatest.roll_rad - step_rad);
            if less.alpha > greatest.alpha {
                greatest = less;
                continue;
            }
            let more = beside(&greatest, greatest.roll_rad + step_rad);
            if more.alpha > greatest.alpha {
                (before, greatest) = (greatest, more);
            } else {
                before = less;
            }
        }
        Some(greatest)
    }

    /// The state of the greatest lateral acceleration in steps of this size from a state, after the state one step before it. The
    /// path ends if the vehicle tips or slides. It has tipped if all inner wheels but those of steered axles have lifted and the
    /// lateral acceleration falls.
    fn greatest(&self, cg_height_m: f64, step_rad: f64, start: Point) -> [Point; 2] {
        let (mut to_rad, mut missing) = (start.roll_rad, 0);
        let mut point = start.clone();
        let [mut before, mut greatest] = [start.clone(), start];
        while self.rise_upright(cg_height_m, UPRIGHT * step_rad, &mut point) {
            (before, greatest) = (greatest, point.clone());
            to_rad = point.roll_rad;
        }
        while to_rad < END_RAD
            && missing <= JUMP
            && point.alpha >= FALLEN * greatest.alpha
            && !point.slides
            && !(point.alpha < greatest.alpha && self.lifted(&point))
        {
            let last = point.clone();
            to_rad += step_rad;
            let found = self.follow(cg_height_m, to_rad, HALVINGS, &mut point);
            missing = if found { 0 } else { missing + 1 };
            if point.alpha > greatest.alpha {
                (before, greatest) = (last, point.clone());
            }
        }
        [before, greatest]
    }

    /// Moves to a larger roll angle of the trailer if all wheels stay on the road and the lateral acceleration grows; whether it does.
    fn rise_upright(&self, cg_height_m: f64, step_rad: f64, point: &mut Point) -> bool {
        let mut next = point.clone();
        next.roll_rad += step_rad;
        let rises = self.settle(cg_height_m, &mut next).is_ok()
            && next.alpha > point.alpha
            && self.axles_on_road(&next);
        if rises {
            *point = next;
        }
        rises
    }

    fn axles_on_road(&self, point: &Point) -> bool {
        let Suspension { axles, .. } = &self.suspension;
        axles.iter().enumerate().all(|(i, axle)| {
            axle.tyres.all_on_road(point.load_n(i), self.suspension.angle_rad(i, point))
        })
    }

    /// Whether all inner wheels but those of steered axles have lifted.
    fn lifted(&self, point: &Point) -> bool {
        let Suspension { axles, .. } = &self.suspension;
        axles.iter().enumerate().all(|(i, axle)| {
            let angle_rad = self.suspension.angle_rad(i, point);
            axle.steered || axle.tyres.inner_lifted(point.load_n(i), angle_rad)
        })
    }

    /// Moves to a larger roll angle of the trailer; whether there is a state. Where none is found (springs
    /// whose friction builds up within less than a step), the step is halved. If that does not help
    /// either, the last state that was found remains. If the tires cannot hold the vehicle even after the
    /// last halving, it slides from there.
    fn follow(&self, cg_height_m: f64, to_rad: f64, halvings: u32, point: &mut Point) -> bool {
        let mut next = point.clone();
        next.roll_rad = to_rad;
        match self.settle(cg_height_m, &mut next) {
            Ok(()) => {
                *point = next;
                return true;
            }
            Err(Unsolved::Turn) if halvings == 0 => {
                point.slides = true;
                return true;
            }
            Err(_) => {}
        }
        let middle_rad = f64::midpoint(point.roll_rad, to_rad);
        halvings > 0
            && self.follow(cg_height_m, middle_rad, halvings - 1, point)
            && (point.slides || self.follow(cg_height_m, to_rad, halvings - 1, point))
    }

    /// Solves roll plane, loads and yaw plane in turn.
    fn settle(&self, cg_height_m: f64, point: &mut Point) -> Result<(), Unsolved> {
        let mut standing = None;
        let mut changed_g = FIRST_G;
        for round in 0..ROUNDS {
            let (before_g, exact_g) = (point.alpha, EXACT * changed_g);
            if !self.solve(cg_height_m, exact_g, point) {
                return Err(Unsolved::Roll);
            }
            changed_g = (point.alpha - before_g).abs();
            if round > 0 && changed_g < SETTLED && exact_g < SETTLED {
                break;
            }
            self.shift(point, &mut standing);
            self.suspension.rise(point);
            if !self.turn_on(round >= UNDAMPED, point) {
                return Err(Unsolved::Turn);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::Load;
    use crate::vehicle::Vehicle;

    /// Bound of what the last small step misses (see [`FINE_RAD`]), for empty to full trailers with low and
    /// high loads in tight and wide turns. A fifth of the step finds the value itself. Near the tightest turn,
    /// where the articulation is found to a milliradian while the lateral acceleration hardly changes, the bound is four times that.
    #[test]
    fn thresholds_do_not_depend_on_the_steps() {
        let vehicles = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
        for name in ["kraz", "euro", "baseline", "baseline-tables", "air"] {
            let vehicle = Vehicle::load(format!("{vehicles}/{name}.toml")).unwrap();
            for payload_kg in [0.0, 5_000.0, 25_000.0] {
                let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
                let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
                let vehicle = &*vehicle.with_springs_at(load).unwrap();
                for kmh in [30.0, 40.0, 90.0, 180.0] {
                    let plane = RollPlane::new(vehicle, load, kmh / 3.6, 1.0).unwrap();
                    for cg_height_m in [1.2, 1.7, 2.3] {
                        let found = plane.threshold_g(cg_height_m);
                        let exact = plane.threshold_in_steps(cg_height_m, 2e-3, 1e-4).unwrap();
                        let is_tight = exact.alpha > 0.95 * plane.tightest_turn_g();
                        let bound = if is_tight { 0.005 } else { 0.001_25 };
                        assert!(
                            (found / exact.alpha - 1.0).abs() < bound,
                            "{name} {load:?} {kmh} km/h {cg_height_m} m: {found} g, {} g",
                            exact.alpha
                        );
                    }
                }
            }
        }
    }

    /// In the tightest turns the articulation changes much with the lateral acceleration. That of the threshold is the one
    /// that its own lateral acceleration has, solved once more, and not that of the step before.
    #[test]
    fn the_articulation_is_that_of_the_threshold() {
        let mut tips = 0;
        let vehicles = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
        for name in ["kraz", "euro", "baseline", "baseline-tables", "air"] {
            let vehicle = Vehicle::load(format!("{vehicles}/{name}.toml")).unwrap();
            for payload_kg in [5_000.0, 25_000.0] {
                let trailer_mass_kg = vehicle.empty_trailer_mass_kg() + payload_kg;
                let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
                let vehicle = &*vehicle.with_springs_at(load).unwrap();
                for kmh in [22.0, 25.0, 30.0] {
                    let plane = RollPlane::new(vehicle, load, kmh / 3.6, 1.0).unwrap();
                    let found = plane.threshold_in_steps(1.9, STEP_RAD, FINE_RAD).unwrap();
                    if found.slides {
                        continue;
                    }
                    tips += 1;
                    let mut again = found.clone();
                    assert!(plane.turn_on(false, &mut again), "{name} {payload_kg} kg {kmh} km/h");
                    let change = again.sides.cos - found.sides.cos;
                    // The changes that end the solution are a milliradian at most, as cosines at most that.
                    assert!(change.abs() < 2e-3, "{name} {payload_kg} kg {kmh} km/h: {change}");
                }
            }
        }
        assert!(tips >= 10, "{tips}"); // the others slide, or cannot be steered so
    }

    /// A trailer of the length `L` behind its fifth wheel, at 45° to a tractor whose tires do not slip, has `U²/2L`. At this
    /// lateral acceleration tires slip by up to 5°, which is 0.09 of a radian, and change `U²/2L` by no more than that.
    #[test]
    fn the_tightest_turn_is_that_at_45_degrees() {
        let vehicles = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
        for name in ["euro", "baseline", "baseline-tables", "air"] {
            let vehicle = Vehicle::load(format!("{vehicles}/{name}.toml")).unwrap();
            let axles = &vehicle.trailer.axle;
            #[allow(clippy::cast_precision_loss)] // two or three
            let length_m =
                axles.iter().map(|axle| axle.behind_hitch_m).sum::<f64>() / axles.len() as f64;
            for speed_mps in [25.0, 30.0].map(|kmh: f64| kmh / 3.6) {
                let load = vehicle.reference_load();
                let found_g =
                    RollPlane::new(&vehicle, load, speed_mps, 1.0).unwrap().tightest_turn_g();
                let expected_g = speed_mps * speed_mps / (2.0 * length_m) / vehicle.gravity_mps2;
                let ratio = found_g / expected_g;
                println!("{name} {speed_mps:.1} m/s: {found_g:.4} g, {ratio:.3} times U²/2L");
                assert!((ratio - 1.0).abs() < 0.09, "{name} {speed_mps} m/s: {ratio}");
            }
        }
    }
}
