//! Usual roads, drawn from a seed: segments of constant curvature, joined by clothoids over which the
//! bank changes too.
//!
//! | kind | curves | bank in a curve |
//! |---|---|---|
//! | flat | those of rural roads | none, neither crown nor grade |
//! | rural | radius 130 to 600 m at up to 80 km/h | superelevation min(6 %, max(2 %, 6 % × 120 m/R)) |
//! | motorway | radius 450 to 1500 m at up to 85 km/h, one ramp of 257 m, two lane changes | superelevation min(5 %, max(2 %, 5 % × 400 m/R)) |
//! | roundabouts | ring of 17 to 32 m to the left, entry and exit to the right, 20 to 35 km/h | 2 % outward |
//!
//! Straights have a crown of 2 % as with right-hand traffic. Curvature and bank are averaged over
//! 0.8 s, as a driver rounds the ends of a clothoid. Rural roads climb and fall by up to 5 %, motorways by
//! up to 4 %, over 400 to 1500 m.

use std::f64::consts::TAU;
use std::path::Path;

use cg_core::Word;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use super::table::{Road, RoadPoint};
use cg_vehicle::error::VehicleError;

/// A usual kind of road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RoadKind {
    /// Curves of a country road.
    Rural,
    /// Wide curves, one ramp and two lane changes.
    Motorway,
    /// One roundabout after the other.
    Roundabouts,
    /// A test track: the curves of a country road without bank, crown and grade.
    Flat,
}

cg_core::words!(RoadKind {
    Rural => "rural", "Curves of 130 to 600 m, superelevation up to 6 %";
    Motorway => "motorway", "Wide curves, one ramp, two lane changes; superelevation up to 5 %";
    Roundabouts => "roundabouts", "Roundabouts with 2 % of adverse bank, 20 to 35 km/h";
    Flat => "flat", "The curves of a rural road without bank and grade, as on a test track";
});

/// Crown of a straight road.
const CROWN_RAD: f64 = 0.02;
/// Distance between the points.
const SPACING_M: f64 = 0.5;
/// Time over which curvature and bank are averaged.
const AVERAGE_S: f64 = 0.8;
/// Straight road at the start.
const START_S: f64 = 6.0;
/// A lane change: how far, and in what time.
const LANE_M: f64 = 3.5;
const LANE_CHANGE_S: f64 = 7.0;
/// Greatest grades.
const RURAL_GRADE_RAD: f64 = 0.05;
const MOTORWAY_GRADE_RAD: f64 = 0.04;
/// Distances from one hilltop to the next.
const HILLS_M: [f64; 2] = [400.0, 1500.0];
/// Radius of the motorway's ramp.
const RAMP_M: f64 = 257.0;
const KMH: f64 = 1.0 / 3.6;

impl RoadKind {
    /// The kind with this name; `None` for the path of a file. A file that is named like a kind is
    /// `./rural`.
    pub fn of_name(name: &Path) -> Option<Self> {
        name.to_str()?.parse().ok()
    }
}

impl Road {
    /// The road of a usual kind with this name, or the one in this CSV file.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn named(name: &Path, seed: u64) -> Result<Self, VehicleError> {
        match RoadKind::of_name(name) {
            Some(kind) => Self::kind(kind, seed),
            None => Self::load(name).map_err(|error| match error {
                VehicleError::Read { file, source } => {
                    let kinds: Vec<&str> =
                        RoadKind::WORDS.iter().map(|(_, word, _)| *word).collect();
                    let kinds = kinds.join(", ");
                    let file = format!("{file} (a road is a file or one of {kinds})");
                    VehicleError::Read { file, source }
                }
                other => other,
            }),
        }
    }

    /// A road of a usual kind; `seed` determines its curves. A drive on it takes 120 s (rural, flat: 150 s).
    ///
    /// # Errors
    /// None that a caller can cause.
    pub fn kind(kind: RoadKind, seed: u64) -> Result<Self, VehicleError> {
        let mut draft = Draft::new(StdRng::seed_from_u64(seed));
        let duration_s = match kind {
            RoadKind::Rural | RoadKind::Flat => draft.rural(150.0),
            RoadKind::Motorway => draft.motorway(120.0),
            RoadKind::Roundabouts => draft.roundabouts(120.0),
        };
        let mut points = averaged(&draft.sampled());
        match kind {
            RoadKind::Rural => draft.climb(&mut points, RURAL_GRADE_RAD),
            RoadKind::Motorway => draft.climb(&mut points, MOTORWAY_GRADE_RAD),
            RoadKind::Roundabouts | RoadKind::Flat => {}
        }
        let mut road = Self::new(&kind.to_string(), points)?;
        road.usual_duration_s = Some(duration_s);
        Ok(if kind == RoadKind::Flat { road.flat() } else { road })
    }
}

/// A road that is being drawn.
struct Draft {
    rng: StdRng,
    /// Ends of clothoids and of segments.
    knots: Vec<RoadPoint>,
    /// Side of the last curve.
    side: f64,
    /// Time to drive at the limits.
    time_s: f64,
}

impl Draft {
    fn new(mut rng: StdRng) -> Self {
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        Self { rng, knots: Vec::new(), side, time_s: 0.0 }
    }

    fn uniform(&mut self, [least, greatest]: [f64; 2]) -> f64 {
        self.rng.random_range(least..greatest)
    }

    fn last(&self) -> RoadPoint {
        let start = RoadPoint {
            distance_m: 0.0,
            curvature_per_m: 0.0,
            bank_rad: CROWN_RAD,
            grade_rad: 0.0,
            speed_mps: f64::INFINITY,
        };
        self.knots.last().copied().unwrap_or(start)
    }

    fn knot(&mut self, ahead_m: f64, to: RoadPoint) {
        let last = self.last();
        self.time_s += ahead_m / to.speed_mps.min(last.speed_mps);
        self.knots.push(RoadPoint { distance_m: last.distance_m + ahead_m, ..to });
    }

    /// A clothoid of a duration, then constant curvature over a length.
    fn segment(&mut self, clothoid_s: f64, length_m: f64, to: RoadPoint) {
        if self.knots.is_empty() {
            self.knot(0.0, to);
        } else {
            self.knot(clothoid_s * to.speed_mps, to);
        }
        self.knot(length_m, to);
    }

    fn straight(&mut self, clothoid_s: f64, length_m: f64, speed_mps: f64) {
        let to = RoadPoint {
            distance_m: 0.0,
            curvature_per_m: 0.0,
            bank_rad: CROWN_RAD,
            grade_rad: 0.0,
            speed_mps,
        };
        self.segment(clothoid_s, length_m, to);
    }

    /// A curve (radius positive to the left) with a bank into it.
    fn curve(
        &mut self,
        clothoid_s: f64,
        length_m: f64,
        (radius_m, into_rad): (f64, f64),
        speed_mps: f64,
    ) {
        let to = RoadPoint {
            distance_m: 0.0,
            curvature_per_m: 1.0 / radius_m,
            bank_rad: -into_rad * radius_m.signum(),
            grade_rad: 0.0,
            speed_mps,
        };
        self.segment(clothoid_s, length_m, to);
    }

    /// The side of the next curve: more often the other one than the same one.
    fn turn(&mut self) -> f64 {
        if self.rng.random_bool(0.7) {
            self.side = -self.side;
        }
        self.side
    }

    fn rural(&mut self, duration_s: f64) -> f64 {
        let greatest = 80.0 * KMH;
        self.straight(0.0, START_S * greatest, greatest);
        while self.time_s < duration_s {
            // Small radii are more frequent than large ones.
            let radius_m = 130.0 * libm::pow(600.0 / 130.0, self.uniform([0.0, 1.0]));
            let lateral_mps2 = self.uniform([1.3, 1.9]);
            let speed_mps = (lateral_mps2 * radius_m).sqrt().min(greatest);
            let into_rad = (0.06 * 120.0 / radius_m).clamp(0.02, 0.06);
            let (clothoid_s, held_s) = (self.uniform([2.0, 4.0]), self.uniform([3.0, 8.0]));
            let radius_m = self.turn() * radius_m;
            self.curve(clothoid_s, held_s * speed_mps, (radius_m, into_rad), speed_mps);
            // A third of the curves follow each other directly.
            if self.rng.random_bool(0.67) {
                let length_m = self.uniform([40.0, 160.0]);
                self.straight(clothoid_s, length_m, greatest);
            }
        }
        self.straight(3.0, 50.0, greatest);
        duration_s
    }

    fn motorway(&mut self, duration_s: f64) -> f64 {
        let greatest = 85.0 * KMH;
        self.straight(0.0, START_S * greatest, greatest);
        // The ramp and the lane changes come after these curves.
        let ramp = self.rng.random_range(1..4);
        let changes = [self.rng.random_range(0..2), self.rng.random_range(2..5)];
        let mut curves = 0;
        while self.time_s < duration_s || curves < 5 {
            let radius_m = self.turn() * self.uniform([450.0, 1500.0]);
            let into_rad = (0.05 * 400.0 / radius_m.abs()).clamp(0.02, 0.05);
            let (clothoid_s, held_s) = (self.uniform([2.5, 4.0]), self.uniform([3.0, 7.0]));
            self.curve(clothoid_s, held_s * greatest, (radius_m, into_rad), greatest);
            let length_m = self.uniform([40.0, 120.0]);
            self.straight(clothoid_s, length_m, greatest);
            if changes.contains(&curves) {
                self.lane_change(greatest);
            }
            if curves == ramp {
                let speed_mps = self.uniform([65.0, 75.0]) * KMH;
                let (held_s, side) = (self.uniform([6.0, 10.0]), self.turn());
                self.curve(4.0, held_s * speed_mps, (side * RAMP_M, 0.05), speed_mps);
                self.straight(4.0, 60.0, greatest);
            }
            curves += 1;
        }
        duration_s
    }

    /// A lane change on a straight; its lateral acceleration is one sine.
    fn lane_change(&mut self, speed_mps: f64) {
        let (length_m, from) = (LANE_CHANGE_S * speed_mps, self.last());
        let side = if self.rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let size = side * LANE_M * TAU / (length_m * length_m);
        for k in 1..=64 {
            let curvature_per_m = size * libm::sin(TAU * f64::from(k) / 64.0);
            self.knot(length_m / 64.0, RoadPoint { curvature_per_m, ..from });
        }
    }

    fn roundabouts(&mut self, duration_s: f64) -> f64 {
        let greatest = 35.0 * KMH;
        self.straight(0.0, START_S * greatest, greatest);
        while self.time_s < duration_s {
            let (ring_m, lateral_mps2) = (self.uniform([17.0, 32.0]), self.uniform([1.3, 1.7]));
            let speed_mps = (lateral_mps2 * ring_m).sqrt().max(19.0 * KMH);
            let angle_rad = TAU * self.uniform([0.2, 0.7]);
            let aside_m = -self.uniform([1.1, 1.6]) * ring_m;
            let aside_rad = self.uniform([0.3, 0.6]);
            let outward = -CROWN_RAD;
            // The clothoids turn too: half of each belongs to the ring.
            let held_m = (angle_rad * ring_m - 2.0 * speed_mps).max(2.0 * speed_mps);
            for (radius_m, length_m) in [
                (aside_m, aside_rad * aside_m.abs()),
                (ring_m, held_m),
                (aside_m, aside_rad * aside_m.abs()),
            ] {
                self.curve(2.0, length_m, (radius_m, outward), speed_mps);
            }
            let length_m = self.uniform([20.0, 60.0]);
            self.straight(2.0, length_m, greatest);
        }
        duration_s
    }

    /// Hills: two sines, level at the start. They are drawn last, so the curves of a seed are the same with
    /// and without them.
    fn climb(&mut self, points: &mut [RoadPoint], greatest_rad: f64) {
        let per_m = [0, 1].map(|_| TAU / self.uniform(HILLS_M));
        let share = self.uniform([0.3, 0.7]);
        for point in points {
            let [a, b] = per_m.map(|per_m| libm::sin(per_m * point.distance_m));
            point.grade_rad = greatest_rad * (share * a + (1.0 - share) * b);
        }
    }

    /// The knots' lines at equal distances.
    fn sampled(&self) -> Vec<RoadPoint> {
        let (mut points, mut knot, mut distance_m) = (Vec::new(), 0, 0.0);
        while let Some(b) = self.knots.get(knot + 1) {
            let a = &self.knots[knot];
            if distance_m > b.distance_m {
                knot += 1;
                continue;
            }
            let share = (distance_m - a.distance_m) / (b.distance_m - a.distance_m);
            let line = |a: f64, b: f64| a + share * (b - a);
            points.push(RoadPoint {
                distance_m,
                curvature_per_m: line(a.curvature_per_m, b.curvature_per_m),
                bank_rad: line(a.bank_rad, b.bank_rad),
                grade_rad: 0.0,
                speed_mps: line(a.speed_mps, b.speed_mps),
            });
            distance_m += SPACING_M;
        }
        points
    }
}

/// Curvature and bank averaged over [`AVERAGE_S`].
fn averaged(points: &[RoadPoint]) -> Vec<RoadPoint> {
    let mut averaged = points.to_vec();
    for (k, point) in averaged.iter_mut().enumerate() {
        // A distance of meters in steps of half a meter.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let half = (0.5 * AVERAGE_S * point.speed_mps / SPACING_M).round() as usize;
        let half = half.min(k).min(points.len() - 1 - k);
        let around = &points[k - half..=k + half];
        #[allow(clippy::cast_precision_loss)] // tens of points
        let n = around.len() as f64;
        point.curvature_per_m = around.iter().map(|p| p.curvature_per_m).sum::<f64>() / n;
        point.bank_rad = around.iter().map(|p| p.bank_rad).sum::<f64>() / n;
    }
    averaged
}
