//! The yaw plane of a steady turn: which lateral forces the axles and the fifth wheel carry, and how
//! far the trailer is articulated.
//!
//! With the yaw rate `r`, the tractor's speed `U` and the trailer's `U2`, both along their own
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
//! `F` and `M` are those of every tyre at its own load. In a tight turn the axles of a group differ
//! in slip by their distance over the radius: the rear one carries more and lifts first.

use super::support::Tyres;
use crate::plant::Grip;
use crate::vehicle::{PlacedAxle, SprungMass, Vehicle};

/// Newton's steps each time: the last solution is never further than a milliradian of roll.
const STEPS: usize = 4;
/// Part of a velocity below which a step is rounding.
const ROUNDING: f64 = 1e-9;
/// Step of velocity for a slope.
const PROBE_MPS: f64 = 1e-4;

/// An axle as the yaw plane sees it.
struct Rolling {
    on_trailer: bool,
    steered: bool,
    /// Ahead of the tractor's c.g.; behind the fifth wheel on the trailer.
    position_m: f64,
    own_kg: f64,
    roll_steer: f64,
    kind: usize,
}

/// The yaw plane of a vehicle under a load at a speed.
pub(super) struct Turn {
    kinds: Vec<Grip>,
    axles: Vec<Rolling>,
    speed_mps: f64,
    gravity_mps2: f64,
    tractor_kg: f64,
    hitch_behind_cg_m: f64,
    trailer_kg: f64,
    trailer_cg_m: f64,
    /// Where the steered axles are, in the middle.
    front_m: f64,
}

/// Lateral forces per lateral acceleration of the trailer in units of gravity.
#[derive(Clone, Debug, Default)]
pub(super) struct Sides {
    /// Through the roll centre of each axle.
    pub(super) axle_n: Vec<f64>,
    /// Inertia of each axle.
    pub(super) own_n: Vec<f64>,
    /// At the fifth wheel, across the trailer and across the tractor.
    pub(super) hitch_n: [f64; 2],
    /// The tractor's lateral acceleration over the trailer's.
    pub(super) tractor: f64,
    /// Cosine of the articulation.
    pub(super) cos: f64,
}

/// A solution: lateral velocities of the tractor's c.g. and of the fifth wheel across the trailer,
/// and the articulation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Drift {
    tractor_mps: f64,
    trailer_mps: f64,
    articulation_rad: f64,
}

/// How an axle stands: the angle and load of its tyres, and how far the body leans over it.
pub(super) struct Standing<'a> {
    pub(super) tyres: &'a Tyres,
    pub(super) load_n: f64,
    pub(super) angle_rad: f64,
    pub(super) lean_rad: f64,
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

    /// Force and aligning moment of an axle's tyres at a slip angle.
    fn grip(&self, axle: &Rolling, slip_rad: f64, on: &Standing<'_>) -> (f64, f64) {
        let grip = &self.kinds[axle.kind];
        on.tyres.loads_n(on.load_n, on.angle_rad).filter(|load_n| *load_n > 0.0).fold((0.0, 0.0), |sum, load_n| {
            let (force_n, moment_nm) = grip.at(slip_rad, load_n);
            // The grip's force is against the slip.
            (sum.0 - force_n, sum.1 + moment_nm)
        })
    }

    /// Forces at a lateral acceleration, from axles as they stand; `None` where their tyres do not
    /// hold the vehicle in the turn.
    pub(super) fn sides(
        &self,
        alpha: f64,
        standing: &[Standing<'_>],
        drift: &mut Drift,
    ) -> Option<Sides> {
        let acceleration = alpha * self.gravity_mps2;
        let (sin, cos) = drift.articulation_rad.sin_cos();
        let hitch_mps = |radps: f64, tractor_mps: f64| tractor_mps - radps * self.hitch_behind_cg_m;
        // The yaw rate from the last articulation and drift.
        let across = hitch_mps(0.0, drift.tractor_mps);
        let along = self.speed_mps * cos - across * sin;
        let radps = acceleration / (along + acceleration / along * self.hitch_behind_cg_m * sin);
        let trailer_mps = acceleration / radps;
        let force = |i: usize, slip_rad: f64| {
            let (axle, on) = (&self.axles[i], &standing[i]);
            self.grip(axle, slip_rad + axle.roll_steer * on.lean_rad, on)
        };
        let on = |trailer: bool| {
            let of = move |i: &usize| {
                self.axles[*i].on_trailer == trailer && (trailer || !self.axles[*i].steered)
            };
            (0..self.axles.len()).filter(of)
        };
        let mut axle_n = vec![0.0; self.axles.len()];
        // Trailer.
        let inertia: f64 = self.trailer_kg * self.trailer_cg_m
            + on(true).map(|i| self.axles[i].own_kg * self.axles[i].position_m).sum::<f64>();
        drift.trailer_mps = newton(drift.trailer_mps, |v| {
            let moment: f64 = on(true)
                .map(|i| {
                    let x = self.axles[i].position_m;
                    let (force_n, moment_nm) = force(i, ((radps * x - v) / trailer_mps).atan());
                    force_n * x + moment_nm
                })
                .sum();
            moment - acceleration * inertia
        })?;
        let mut mass_kg = self.trailer_kg;
        for i in on(true) {
            let x = self.axles[i].position_m;
            let slip_rad = ((radps * x - drift.trailer_mps) / trailer_mps).atan();
            axle_n[i] = force(i, slip_rad).0 - self.axles[i].own_kg * acceleration;
            mass_kg += self.axles[i].own_kg;
        }
        let hitch_n = self.trailer_kg * acceleration - on(true).map(|i| axle_n[i]).sum::<f64>();
        // How far ahead of the foot of the turn's centre the trailer's c.g. is: it wants to go on,
        // and the tractor holds it.
        let ahead_m = drift.trailer_mps / radps - inertia / mass_kg;
        let push_n = mass_kg * radps * radps * ahead_m;
        let hitch_1_n = hitch_n * cos + push_n * sin;
        // Tractor.
        let tractor = radps * self.speed_mps / acceleration;
        let behind = |i: usize| self.front_m - self.axles[i].position_m;
        let inertia: f64 = self.tractor_kg * self.front_m
            + on(false).map(|i| self.axles[i].own_kg * behind(i)).sum::<f64>();
        let needed = tractor * acceleration * inertia
            + hitch_1_n * (self.front_m + self.hitch_behind_cg_m);
        let slip = |i: usize, v: f64| {
            (-(v + radps * self.axles[i].position_m) / self.speed_mps).atan()
        };
        drift.tractor_mps = newton(drift.tractor_mps, |v| {
            let moment: f64 = on(false)
                .map(|i| {
                    let (force_n, moment_nm) = force(i, slip(i, v));
                    force_n * behind(i) + moment_nm
                })
                .sum();
            moment - needed
        })?;
        for i in on(false) {
            let own_n = self.axles[i].own_kg * tractor * acceleration;
            axle_n[i] = force(i, slip(i, drift.tractor_mps)).0 - own_n;
        }
        // The steered axles carry the rest.
        let rest_n = self.tractor_kg * tractor * acceleration + hitch_1_n
            - on(false).map(|i| axle_n[i]).sum::<f64>();
        let steered = self.axles.iter().filter(|axle| axle.steered).count().max(1);
        for (side_n, axle) in axle_n.iter_mut().zip(&self.axles) {
            if axle.steered {
                #[allow(clippy::cast_precision_loss)]
                let share = 1.0 / steered as f64;
                *side_n = share * rest_n;
            }
        }
        // The articulation that follows.
        let across = hitch_mps(radps, drift.tractor_mps);
        let sine = (drift.trailer_mps - across * cos) / self.speed_mps;
        if !(sine.abs() < 1.0) {
            return None;
        }
        drift.articulation_rad = sine.asin();
        let own = |axle: &Rolling| {
            let share = if axle.on_trailer { 1.0 } else { tractor };
            axle.own_kg * share * self.gravity_mps2
        };
        Some(Sides {
            own_n: self.axles.iter().map(own).collect(),
            axle_n: axle_n.into_iter().map(|n| n / alpha).collect(),
            hitch_n: [hitch_n / alpha, hitch_1_n / alpha],
            tractor,
            cos: drift.articulation_rad.cos(),
        })
    }
}

/// A root near a velocity, if the slope leads to one.
fn newton(mut v: f64, residual: impl Fn(f64) -> f64) -> Option<f64> {
    for _ in 0..STEPS {
        let here = residual(v);
        let slope = (residual(v - PROBE_MPS) - here) / -PROBE_MPS;
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
