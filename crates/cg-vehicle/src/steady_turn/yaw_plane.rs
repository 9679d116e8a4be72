//! The yaw plane of a steady turn: the lateral forces of the axles and the fifth wheel, and the
//! articulation angle.
//!
//! Let `r` be the yaw rate, `U` and `U2` the speeds of tractor and trailer, each along its own
//! heading, and `v` the lateral velocity of a point:
//!
//! ```text
//!     trailer about the fifth wheel   Σ F x + Σ M = a2 Σ m x        x behind the fifth wheel
//!     tractor about its front axles   Σ F x + Σ M = a1 Σ m x + Y1 x5   x behind them
//!     slip, tractor and trailer       α = −v/U,  −v/U2              + roll steer
//!     fifth wheel                     v2 = U sin γ + v5 cos γ,  U2 = U cos γ − v5 sin γ
//!     accelerations                   a1 = r U,  a2 = r U2
//! ```
//!
//! `F` and `M` are the forces and aligning moments of every tire at its own load. In a tight turn
//! the slip angles of the axles in a group differ by their distance divided by the radius. The rear
//! axle therefore carries more lateral force and lifts first.

use crate::characteristics::Grip;
use crate::load::SprungMass;
use crate::vehicle::{PlacedAxle, Vehicle};

/// Number of Newton steps. The start is the last solution, which differs by at most one milliradian
/// of roll.
const STEPS: usize = 4;
/// A step below this share of the velocity is due to rounding.
const ROUNDING: f64 = 1e-9;
/// Number of times that the yaw plane is solved again with the articulation that it found, and the change of it that ends
/// this: where a turn exists, the changes become smaller from one to the next.
const FOLLOWED: usize = 100;
const FOLLOWED_RAD: f64 = 1e-3;
/// Number of turns by way of which a tight one is found.
const GENTLER: u32 = 8;

/// An axle in the yaw plane.
struct Rolling {
    on_trailer: bool,
    steered: bool,
    /// Position ahead of the tractor's c.g., or behind the fifth wheel for the trailer.
    position_m: f64,
    own_kg: f64,
    roll_steer: f64,
    kind: usize,
}

/// The yaw plane of a vehicle with a load at a speed.
pub(super) struct Turn {
    kinds: Vec<Grip>,
    axles: Vec<Rolling>,
    speed_mps: f64,
    gravity_mps2: f64,
    tractor_kg: f64,
    hitch_behind_cg_m: f64,
    trailer_kg: f64,
    trailer_cg_m: f64,
    /// Mean position of the steered axles.
    front_m: f64,
}

/// Lateral forces divided by the lateral acceleration of the trailer in g.
#[derive(Clone, Debug, Default)]
pub(super) struct Sides {
    /// Force through the roll center of each axle.
    pub(super) axle_n: Vec<f64>,
    /// Inertia force of each axle.
    pub(super) own_n: Vec<f64>,
    /// Force at the fifth wheel, lateral to the trailer and lateral to the tractor.
    pub(super) hitch_n: [f64; 2],
    /// Lateral acceleration of the tractor divided by that of the trailer.
    pub(super) tractor: f64,
    /// Cosine of the articulation.
    pub(super) cos: f64,
}

impl Sides {
    /// Moves half of the way to other forces.
    pub(super) fn halfway(&mut self, to: &Self) {
        let halfway = |own: &mut f64, other: f64| *own = f64::midpoint(*own, other);
        self.axle_n.iter_mut().zip(&to.axle_n).for_each(|(own, other)| halfway(own, *other));
        self.own_n.iter_mut().zip(&to.own_n).for_each(|(own, other)| halfway(own, *other));
        self.hitch_n.iter_mut().zip(to.hitch_n).for_each(|(own, other)| halfway(own, other));
        halfway(&mut self.tractor, to.tractor);
        halfway(&mut self.cos, to.cos);
    }
}

/// The unknowns of the solution: the lateral velocities of the tractor's c.g. and of the fifth
/// wheel (lateral to the trailer), and the articulation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Drift {
    tractor_mps: f64,
    trailer_mps: f64,
    articulation_rad: f64,
}

/// Motion of the vehicle in the turn.
struct Pace {
    /// Lateral acceleration of the trailer, m/s².
    acceleration: f64,
    radps: f64,
    /// Speed along the trailer's heading.
    trailer_mps: f64,
}

/// State of an axle: the loads of its tires on the road, and the roll angle of the body relative to it.
pub(super) struct Standing {
    pub(super) loads_n: Vec<f64>,
    pub(super) lean_rad: f64,
}

/// Lateral force and aligning moment of an axle, and their derivatives with respect to its velocity across.
#[derive(Default)]
struct TyreForces {
    force_n: f64,
    moment_nm: f64,
    force_slope: f64,
    moment_slope: f64,
}

impl TyreForces {
    /// Adds the moment about a point, and its slope.
    fn add_about(&self, lever_m: f64, (moment_nm, slope): (f64, f64)) -> (f64, f64) {
        (
            moment_nm + self.force_n * lever_m + self.moment_nm,
            slope + self.force_slope * lever_m + self.moment_slope,
        )
    }
}

impl Turn {
    pub(super) fn new(vehicle: &Vehicle, trailer: &SprungMass, speed_mps: f64) -> Self {
        let placed = vehicle.axles();
        let kind = |placed: &PlacedAxle<'_>| {
            vehicle.tyre.iter().position(|tyre| tyre.name == placed.tyre.name).unwrap_or(0)
        };
        let axles: Vec<Rolling> = placed
            .iter()
            .map(|placed| Rolling {
                on_trailer: placed.on_trailer,
                steered: placed.steered,
                position_m: placed.position_m,
                own_kg: placed.axle.unsprung_mass_kg,
                roll_steer: placed.axle.roll_steer_rad_per_rad,
                kind: kind(placed),
            })
            .collect();
        let front: Vec<f64> = axles.iter().filter(|a| a.steered).map(|a| a.position_m).collect();
        #[allow(clippy::cast_precision_loss)] // one or two
        let front_m = front.iter().sum::<f64>() / front.len().max(1) as f64;
        Self {
            kinds: vehicle.tyre.iter().map(|tyre| Grip::new(tyre, false)).collect(),
            axles,
            speed_mps,
            gravity_mps2: vehicle.gravity_mps2,
            tractor_kg: vehicle.tractor.sprung_mass_kg,
            hitch_behind_cg_m: vehicle.tractor.hitch_behind_cg_m,
            trailer_kg: trailer.mass_kg,
            trailer_cg_m: trailer.cg_behind_hitch_m,
            front_m,
        }
    }

    /// The forces at a lateral acceleration, for the present state of the axles; `None` if there is no such turn: the
    /// tires cannot hold the vehicle, or the trailer articulates so far that a tighter turn, which lowers its speed
    /// along its own heading, would not accelerate it more.
    pub(super) fn sides(
        &self,
        alpha: f64,
        standing: &[Standing],
        drift: &mut Drift,
    ) -> Option<Sides> {
        for _ in 0..FOLLOWED {
            let before_rad = drift.articulation_rad;
            let sides = self.sides_once(alpha, standing, drift)?;
            if (drift.articulation_rad - before_rad).abs() < FOLLOWED_RAD {
                return Some(sides);
            }
        }
        None
    }

    /// The same by way of gentler turns, each of which is found from the one before.
    pub(super) fn sides_in_steps(
        &self,
        alpha: f64,
        standing: &[Standing],
        drift: &mut Drift,
    ) -> Option<Sides> {
        let step = alpha / f64::from(GENTLER);
        let mut found = None;
        for k in 1..=GENTLER {
            found = Some(self.sides(step * f64::from(k), standing, drift)?);
        }
        found
    }

    /// The same with the articulation and the velocities of the last solution, which become those of this one.
    fn sides_once(&self, alpha: f64, standing: &[Standing], drift: &mut Drift) -> Option<Sides> {
        let (sin, cos) = libm::sincos(drift.articulation_rad);
        let acceleration = alpha * self.gravity_mps2;
        // `r U2` is the acceleration, and `U2 = U cos γ − (v1 − r x5) sin γ`.
        let along_mps = self.speed_mps * cos - drift.tractor_mps * sin;
        let hitch_m = self.hitch_behind_cg_m;
        let root_mps = (along_mps * along_mps + 4.0 * acceleration * hitch_m * sin).sqrt();
        let radps = 2.0 * acceleration / (along_mps + root_mps);
        let pace = Pace { acceleration, radps, trailer_mps: acceleration / radps };
        let mut axle_n = vec![0.0; self.axles.len()];
        let hitch_n = self.trailer(&pace, standing, drift, &mut axle_n)?;
        let [across_n, push_n] = hitch_n;
        let hitch_n = [across_n, across_n * cos + push_n * sin];
        self.tractor(&pace, hitch_n[1], standing, drift, &mut axle_n)?;
        let sine =
            (drift.trailer_mps - (drift.tractor_mps - radps * hitch_m) * cos) / self.speed_mps;
        if !(sine.abs() < 1.0) {
            return None;
        }
        drift.articulation_rad = libm::asin(sine);
        let tractor = radps * self.speed_mps / acceleration;
        let own_n = |axle: &Rolling| {
            axle.own_kg * self.gravity_mps2 * if axle.on_trailer { 1.0 } else { tractor }
        };
        Some(Sides {
            own_n: self.axles.iter().map(own_n).collect(),
            axle_n: axle_n.into_iter().map(|n| n / alpha).collect(),
            hitch_n: hitch_n.map(|n| n / alpha),
            tractor,
            cos: libm::cos(drift.articulation_rad),
        })
    }

    /// Force and aligning moment of an axle when its middle moves across at `across_mps` and along at `along_mps`, and the
    /// derivatives of both with respect to `across_mps`.
    fn held(&self, i: usize, across_mps: f64, along_mps: f64, standing: &[Standing]) -> TyreForces {
        let (axle, on) = (&self.axles[i], &standing[i]);
        let slope = -across_mps / along_mps;
        let slip_rad = libm::atan(slope) + axle.roll_steer * on.lean_rad;
        let grip = &self.kinds[axle.kind];
        let row = grip.row(slip_rad);
        let mut held = TyreForces::default();
        for &load_n in &on.loads_n {
            let [(force_n, moment_nm), slopes] = grip.sloped(slip_rad, load_n, row);
            // The force of the tires is opposite to the slip.
            held.force_n -= force_n;
            held.moment_nm += moment_nm;
            held.force_slope -= slopes.0;
            held.moment_slope += slopes.1;
        }
        let by_across = -1.0 / (along_mps * (1.0 + slope * slope));
        held.force_slope *= by_across;
        held.moment_slope *= by_across;
        held
    }

    /// Solves for the forces of the trailer's axles. Returns the lateral and the longitudinal force
    /// on the trailer at the fifth wheel.
    fn trailer(
        &self,
        pace: &Pace,
        standing: &[Standing],
        drift: &mut Drift,
        axle_n: &mut [f64],
    ) -> Option<[f64; 2]> {
        let axles = || (0..self.axles.len()).filter(|&i| self.axles[i].on_trailer);
        let mass_kg = self.trailer_kg + axles().map(|i| self.axles[i].own_kg).sum::<f64>();
        let inertia_kgm = self.trailer_kg * self.trailer_cg_m
            + axles().map(|i| self.axles[i].own_kg * self.axles[i].position_m).sum::<f64>();
        let held = |i: usize, v: f64| {
            let across_mps = v - pace.radps * self.axles[i].position_m;
            self.held(i, across_mps, pace.trailer_mps, standing)
        };
        drift.trailer_mps = newton(drift.trailer_mps, |v| {
            axles().fold((-pace.acceleration * inertia_kgm, 0.0), |sum, i| {
                held(i, v).add_about(self.axles[i].position_m, sum)
            })
        })?;
        let mut across_n = self.trailer_kg * pace.acceleration;
        for i in axles() {
            axle_n[i] =
                held(i, drift.trailer_mps).force_n - self.axles[i].own_kg * pace.acceleration;
            across_n -= axle_n[i];
        }
        // If the c.g. is ahead of the foot of the perpendicular from the center of the turn, the
        // tractor holds it back with a longitudinal force.
        let ahead_m = drift.trailer_mps / pace.radps - inertia_kgm / mass_kg;
        Some([across_n, mass_kg * pace.radps * pace.radps * ahead_m])
    }

    /// Solves for the forces of the tractor's axles, given the lateral force of the trailer on it.
    /// The steered axles carry the remaining force.
    fn tractor(
        &self,
        pace: &Pace,
        hitch_n: f64,
        standing: &[Standing],
        drift: &mut Drift,
        axle_n: &mut [f64],
    ) -> Option<()> {
        let on = |steered: bool| {
            let of = move |axle: &Rolling| !axle.on_trailer && axle.steered == steered;
            (0..self.axles.len()).filter(move |&i| of(&self.axles[i]))
        };
        let behind_m = |i: usize| self.front_m - self.axles[i].position_m;
        let acceleration = pace.radps * self.speed_mps;
        let inertia_kgm = self.tractor_kg * self.front_m
            + on(false).map(|i| self.axles[i].own_kg * behind_m(i)).sum::<f64>();
        let needed_nm =
            acceleration * inertia_kgm + hitch_n * (self.front_m + self.hitch_behind_cg_m);
        let held = |i: usize, v: f64| {
            let across_mps = v + pace.radps * self.axles[i].position_m;
            self.held(i, across_mps, self.speed_mps, standing)
        };
        drift.tractor_mps = newton(drift.tractor_mps, |v| {
            on(false).fold((-needed_nm, 0.0), |sum, i| held(i, v).add_about(behind_m(i), sum))
        })?;
        let mut rest_n = self.tractor_kg * acceleration + hitch_n;
        for i in on(false) {
            axle_n[i] = held(i, drift.tractor_mps).force_n - self.axles[i].own_kg * acceleration;
            rest_n -= axle_n[i];
        }
        #[allow(clippy::cast_precision_loss)] // one or two
        let steered = on(true).count().max(1) as f64;
        on(true).for_each(|i| axle_n[i] = rest_n / steered);
        Some(())
    }
}

/// A root near a velocity of a function, which is given with its slope; `None` if the slope does not lead to one.
fn newton(mut v: f64, residual: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
    for _ in 0..STEPS {
        let (here, slope) = residual(v);
        let step = here / slope;
        if !(slope < 0.0 && step.abs() < 5.0) {
            return None;
        }
        v -= step;
        if step.abs() < ROUNDING {
            break;
        }
    }
    Some(v)
}
