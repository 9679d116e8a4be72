//! The steady roll plane: how much lateral acceleration a load withstands, axle by axle.
//!
//! Tractor and trailer roll about the roll centres of their axles and share a moment at the fifth
//! wheel; each axle rolls on its tyres. With `α` the lateral acceleration in units of gravity:
//!
//! ```text
//!     trailer   B2 (α + φ2) = Σ Ms(φ2 − φu) + M5(φ2 − φ1)       B: weight times height above the
//!     tractor   B1 (α + φ1) = Σ Ms(φ1 − φu) − M5(φ2 − φ1)          points that carry it
//!     axle      Ms(φ − φu) + C (α + φu) = Mt(φu)                C: weights on it times height
//! ```
//!
//! `Ms` knows spring curves with friction and lash, `Mt` wheels that lift, `M5` plates that
//! part: axles give up one after the other. The trailer's roll angle is raised in small steps and
//! the rest solved by Newton's method; the greatest `α` on the way is the threshold. Supports carry
//! what they carry at rest, so that lateral forces are shared as the loads are.
//!
//! **Reference.** Winkler et al., *Rollover of Heavy Commercial Vehicles*, UMTRI-99-19, ch. 2 (the
//! diagram of moment over roll angle, here with its corners computed).

use crate::balance::static_balance;
use crate::error::VehicleError;
use crate::plant::{Envelope, Hitch};
use crate::vehicle::{Load, PlacedAxle, Vehicle};

/// Step of the trailer's roll angle.
const STEP_RAD: f64 = 1e-3;
/// Where the search ends: any trailer has tipped by then.
const END_RAD: f64 = 0.6;
/// Distance of the nodes of moment curves, and their number.
const NODE_RAD: f64 = 5e-4;
const NODES: usize = 800;
/// Steps of Newton's method (g, rad, m) below which nothing is left to gain.
const ROUNDING: f64 = 1e-12;
/// Share of the greatest lateral acceleration below which the vehicle is on its way over.
const FALLEN: f64 = 0.8;

/// An odd function of an angle, linear between its nodes and beyond the last one.
struct Curve(Vec<f64>);

impl Curve {
    fn new(value: impl FnMut(f64) -> f64) -> Self {
        #[allow(clippy::cast_precision_loss)] // indices
        Self((0..NODES).map(|k| k as f64 * NODE_RAD).map(value).collect())
    }

    /// Value and slope.
    fn at(&self, angle_rad: f64) -> (f64, f64) {
        // In range: an angle is some tenths of a radian.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let k = ((angle_rad.abs() / NODE_RAD) as usize).min(self.0.len() - 2);
        let slope = (self.0[k + 1] - self.0[k]) / NODE_RAD;
        #[allow(clippy::cast_precision_loss)]
        let value = self.0[k] + slope * (angle_rad.abs() - k as f64 * NODE_RAD);
        (value.copysign(angle_rad), slope)
    }
}

struct Axle {
    on_trailer: bool,
    springs: Curve,
    tyres: Curve,
    /// `C`.
    moment_nm: f64,
    roll_center_m: f64,
    sprung_n: f64,
}

/// What the roll plane of a vehicle under a trailer mass consists of; the height is left open.
pub(crate) struct RollPlane {
    axles: Vec<Axle>,
    hitch: Hitch,
    hitch_height_m: f64,
    hitch_load_n: f64,
    tractor_nm: f64,
    /// Roll angle of the true vehicle over that of the file's.
    compliance: f64,
}

/// Lateral acceleration, the tractor's roll and those of the axles.
struct Point {
    alpha: f64,
    tractor_rad: f64,
    axles_rad: Vec<f64>,
}

impl RollPlane {
    /// `compliance` scales every roll angle: the compensation `R_c` of a calibration.
    ///
    /// # Errors
    /// As [`static_balance`].
    pub(crate) fn new(
        vehicle: &Vehicle,
        load: Load,
        compliance: f64,
    ) -> Result<Self, VehicleError> {
        let balance = static_balance(vehicle, load)?;
        let axles: Vec<Axle> = vehicle
            .axles()
            .iter()
            .zip(&balance.axle_load_n)
            .map(|(placed, &load_n)| axle(vehicle, placed, load_n))
            .collect();
        let (tractor, hitch) = (&vehicle.tractor, &vehicle.hitch);
        let carried: f64 = axles
            .iter()
            .filter(|axle| !axle.on_trailer)
            .map(|axle| axle.sprung_n * axle.roll_center_m)
            .sum();
        let own = tractor.sprung_mass_kg * vehicle.gravity_mps2 * tractor.cg_height_m;
        Ok(Self {
            tractor_nm: own + balance.hitch_load_n * hitch.height_m - carried,
            axles,
            hitch: Hitch::of(hitch),
            hitch_height_m: hitch.height_m,
            hitch_load_n: balance.hitch_load_n,
            compliance,
        })
    }

    /// The rollover threshold at a height of the trailer's sprung c.g., in units of gravity.
    pub(crate) fn threshold_g(&self, cg_height_m: f64) -> f64 {
        let on_axles: f64 = self
            .axles
            .iter()
            .filter(|axle| axle.on_trailer)
            .map(|axle| axle.sprung_n * (cg_height_m - axle.roll_center_m))
            .sum();
        let trailer_nm = on_axles + self.hitch_load_n * (cg_height_m - self.hitch_height_m);
        let mut point =
            Point { alpha: 0.0, tractor_rad: 0.0, axles_rad: vec![0.0; self.axles.len()] };
        let (mut roll_rad, mut greatest) = (0.0, 0.0_f64);
        while roll_rad < END_RAD && point.alpha >= FALLEN * greatest {
            roll_rad += STEP_RAD;
            self.solve(trailer_nm, roll_rad, &mut point);
            greatest = greatest.max(point.alpha);
        }
        greatest
    }

    /// Newton's method from the point before: the axles eliminated, two equations are left. The
    /// curves are straight almost everywhere, so a few steps end in rounding.
    fn solve(&self, trailer_nm: f64, roll_rad: f64, point: &mut Point) {
        for _ in 0..8 {
            let (fifth, fifth_slope) = self.fifth_wheel(roll_rad - point.tractor_rad);
            // Columns: by α, by φ1; residual.
            let mut trailer =
                [trailer_nm, fifth_slope, trailer_nm * (point.alpha + roll_rad) - fifth];
            let mut tractor = [
                self.tractor_nm,
                self.tractor_nm - fifth_slope,
                self.tractor_nm * (point.alpha + point.tractor_rad) + fifth,
            ];
            let mut steps = Vec::with_capacity(self.axles.len());
            for (axle, &axle_rad) in self.axles.iter().zip(&point.axles_rad) {
                let body_rad = if axle.on_trailer { roll_rad } else { point.tractor_rad };
                let c = self.compliance;
                let (springs, k) = axle.springs.at((body_rad - axle_rad) / c);
                let (tyres, tyre_slope) = axle.tyres.at(axle_rad / c);
                let k = k / c;
                let residual = springs + axle.moment_nm * (point.alpha + axle_rad) - tyres;
                let stiffness = k + tyre_slope / c - axle.moment_nm;
                // The axle's step: (residual + C dα + k dφ)/stiffness.
                let by = [axle.moment_nm, k, residual].map(|term| term / stiffness);
                if axle.on_trailer {
                    trailer[0] += k * by[0];
                    trailer[2] += k * by[2] - springs;
                } else {
                    tractor[0] += k * by[0];
                    tractor[1] += k * (by[1] - 1.0);
                    tractor[2] += k * by[2] - springs;
                }
                steps.push(by);
            }
            let determinant = trailer[0] * tractor[1] - trailer[1] * tractor[0];
            let alpha = (trailer[1] * tractor[2] - tractor[1] * trailer[2]) / determinant;
            let tractor_rad = (tractor[0] * trailer[2] - trailer[0] * tractor[2]) / determinant;
            for ((axle, by), axle_rad) in self.axles.iter().zip(steps).zip(&mut point.axles_rad) {
                let body = if axle.on_trailer { 0.0 } else { tractor_rad };
                *axle_rad += by[0] * alpha + by[1] * body + by[2];
            }
            point.alpha += alpha;
            point.tractor_rad += tractor_rad;
            if alpha.abs() + tractor_rad.abs() < ROUNDING {
                break;
            }
        }
    }

    fn fifth_wheel(&self, angle_rad: f64) -> (f64, f64) {
        let at = |angle_rad: f64| self.hitch.moment_nm(angle_rad / self.compliance);
        (at(angle_rad), (at(angle_rad + 1e-6) - at(angle_rad)) / 1e-6)
    }
}

fn axle(vehicle: &Vehicle, placed: &PlacedAxle<'_>, load_n: f64) -> Axle {
    let own_n = placed.axle.unsprung_mass_kg * vehicle.gravity_mps2;
    let sprung_n = load_n - own_n;
    let roll_center_m = placed.axle.roll_center_height_m;
    Axle {
        on_trailer: placed.on_trailer,
        springs: springs(vehicle, placed, sprung_n),
        tyres: tyres(placed, load_n),
        moment_nm: sprung_n * roll_center_m + own_n * placed.axle.center_height_m,
        roll_center_m,
        sprung_n,
    }
}

/// Moment of both springs and of the auxiliary stiffness over the angle between body and axle, the
/// sum of the spring forces held. Friction builds up as the springs move.
fn springs(vehicle: &Vehicle, placed: &PlacedAxle<'_>, sprung_n: f64) -> Curve {
    let axle = placed.axle;
    let named = axle.spring.as_ref();
    let Some(spring) = named.and_then(|name| vehicle.spring.iter().find(|s| s.name == *name))
    else {
        let stiffness = placed.suspension_roll_stiffness_nm_per_rad();
        return Curve::new(|angle_rad| stiffness * angle_rad);
    };
    let (envelope, half_m) = (Envelope::new(spring), 0.5 * axle.spring_spread_m);
    let mut middle_m = envelope.deflection_at(0.5 * sprung_n);
    Curve::new(|angle_rad| {
        let apart_m = half_m * angle_rad;
        let friction = 1.0 - (-apart_m / spring.friction_deflection_m).exp();
        let forces = |middle_m: f64| {
            [friction, -friction].map(|share| {
                let x = middle_m + apart_m.copysign(share);
                let (force_n, slope) = envelope.middle(x);
                (force_n + share * envelope.friction_n(x).max(0.0), slope)
            })
        };
        for _ in 0..20 {
            let [outer, inner] = forces(middle_m);
            let step_m = (sprung_n - outer.0 - inner.0) / (outer.1 + inner.1);
            middle_m += step_m;
            if step_m.abs() < ROUNDING {
                break;
            }
        }
        let [outer, inner] = forces(middle_m);
        half_m * (outer.0 - inner.0) + axle.auxiliary_roll_stiffness_nm_per_rad * angle_rad
    })
}

/// Moment of the tyres over the axle's roll angle; a tyre that has lifted carries nothing.
fn tyres(placed: &PlacedAxle<'_>, load_n: f64) -> Curve {
    let (tyre, positions_m) = (placed.tyre, &placed.axle.tyre_positions_m);
    let overturning = placed.tyres() * tyre.overturning_stiffness_nm_per_rad;
    let sides = || positions_m.iter().flat_map(|&y| [y, -y]);
    Curve::new(|angle_rad| {
        // Tyres leave the road from the inside: the outer `n` of them carry the load.
        let mut levers: Vec<f64> = sides().collect();
        levers.sort_by(|a, b| b.total_cmp(a));
        let stiffness = tyre.vertical_stiffness_n_per_m;
        let mut count = levers.len();
        let (mut rise_m, mut sum);
        loop {
            #[allow(clippy::cast_precision_loss)] // a few tyres
            let n = count as f64;
            sum = levers[..count].iter().sum::<f64>();
            rise_m = (load_n / stiffness - angle_rad * sum) / n;
            if count == 1 || rise_m + angle_rad * levers[count - 1] >= 0.0 {
                break;
            }
            count -= 1;
        }
        let moment: f64 = levers[..count]
            .iter()
            .map(|&lever| stiffness * (rise_m + angle_rad * lever) * lever)
            .sum();
        moment + overturning * angle_rad
    })
}
