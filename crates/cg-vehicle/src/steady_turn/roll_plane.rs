//! The roll plane of a steady turn: its lateral acceleration at a roll angle of the trailer, axle by axle.
//!
//! Tractor and trailer roll about the roll centers of their axles and are coupled by a moment at
//! the fifth wheel. Each axle rolls on its tires. Let `α` be the lateral acceleration of the
//! trailer in g and `γ` the articulation:
//!
//! ```text
//!     trailer   A2 α cos φ2 + B2 sin φ2 = Σ Ms + M5 cos γ     A, S: lateral forces per α times their heights
//!     tractor   A1 α cos φ1 + B1 sin φ1 = Σ Ms − M5                 above the points that support them
//!     axle      Ms + S α + C φu = Mt(φu)/cos φu               B, C: the same with weights
//!     springs   Ms of a load group from the mean of the sines of the body's roll angles relative to its axles
//! ```
//!
//! An axle whose inner wheels have left the road turns about the outer ones and rises, and `S` and `C` contain the rise: it
//! takes 3 % from the threshold of a light load on soft springs, whose trailer has lifted long before the tractor tips.
//! `Ms` includes spring curves with friction, `Mt` wheels that lift, and `M5 (φ2 cos γ − φ1)`
//! plates that separate. Of a trailer whose frame twists, the front half stands on the fifth wheel and the
//! rear half on the axles; `φ2` is then the roll angle of the rear half, and the front half is eliminated
//! (`frame`). The axles lift one after the other, and when the first axle of a
//! load group lifts, the springs that it shares yield as well. The lateral forces are those of a
//! steady turn at the given speed (`yaw_plane`). At each roll angle of the trailer, the other
//! unknowns are solved by Newton's method; the greatest `α` of all roll angles is the threshold
//! (`path`). The supports carry their static loads; if these depend on stiffness, axles that lift
//! change them.
//!
//! **Reference.** Winkler et al., *Rollover of Heavy Commercial Vehicles*, UMTRI-99-19, ch. 2 (the
//! diagram of moment over roll angle, whose corners are computed here).

use super::frame::{Frame, Front};
use super::point::Point;
use super::support::Held;
use super::suspension::{Axle, Suspension};
use super::yaw_plane::{Drift, Sides, Standing, Turn};
use crate::balance::{Give, StaticBalance, balance_on, static_balance};
use crate::characteristics::FifthWheel;
use crate::error::VehicleError;
use crate::load::Load;
use crate::vehicle::Vehicle;

/// A step of Newton's method (g, rad) below this always ends the iteration. It is a thousandth of what must agree in the end.
const LEAST: f64 = 1e-8;
/// Number of steps after which there is no state.
const STEPS: usize = 20;
/// A fifth wheel that is stiffer counts as this stiff. Before its plates separate, at some tens of kN m, it twists by two
/// milliradians at most, and Newton's method finds the bends of its curve.
const STIFFEST_NM_PER_RAD: f64 = 3e7;
/// Lateral acceleration (g) at which the first distribution of forces is computed. Small forces
/// grow in proportion to it.
const FIRST: f64 = 0.01;

/// A rise of an axle below this shifts a few newtons, some millionths of a load.
const RISE_M: f64 = 1e-6;

/// The roll plane of a vehicle with a trailer mass at a speed, for any height.
pub(crate) struct RollPlane<'a> {
    vehicle: &'a Vehicle,
    load: Load,
    balance: StaticBalance,
    pub(super) suspension: Suspension,
    turn: Turn,
    hitch: FifthWheel,
    /// The frame, if it twists.
    frame: Option<Frame>,
    hitch_height_m: f64,
    /// Moment of the weight of the tractor's sprung mass about the road.
    tractor_own_nm: f64,
}

/// Deflections of the tires, and the loads that follow from them.
pub(super) type Stood = (Vec<Give>, StaticBalance);

impl<'a> RollPlane<'a> {
    /// Every roll angle is multiplied by `compliance`, the compensation `R_c` of a calibration.
    ///
    /// # Errors
    /// As [`static_balance`].
    pub(crate) fn new(
        vehicle: &'a Vehicle,
        load: Load,
        speed_mps: f64,
        compliance: f64,
    ) -> Result<Self, VehicleError> {
        let balance = static_balance(vehicle, load)?;
        let suspension = Suspension::of(vehicle, &balance.axle_load_n, compliance);
        let (tractor, hitch) = (&vehicle.tractor, &vehicle.hitch);
        let fifth_wheel = FifthWheel::of(hitch);
        let stiffness_nm_per_rad = fifth_wheel.stiffness_nm_per_rad.min(STIFFEST_NM_PER_RAD);
        Ok(Self {
            vehicle,
            load,
            balance,
            tractor_own_nm: tractor.sprung_mass_kg * vehicle.gravity_mps2 * tractor.cg_height_m,
            suspension,
            turn: Turn::new(vehicle, &vehicle.trailer_sprung_mass(load)?, speed_mps),
            hitch: FifthWheel { stiffness_nm_per_rad, ..fifth_wheel },
            frame: Frame::of(vehicle, load)?,
            hitch_height_m: hitch.height_m,
        })
    }

    /// The same at another speed.
    ///
    /// # Errors
    /// As [`static_balance`].
    pub(crate) fn at_speed(self, speed_mps: f64) -> Result<Self, VehicleError> {
        let sprung = self.vehicle.trailer_sprung_mass(self.load)?;
        Ok(Self { turn: Turn::new(self.vehicle, &sprung, speed_mps), ..self })
    }

    /// The state of straight driving; `None` if the tires hold no turn at all.
    pub(super) fn start(&self) -> Option<Point> {
        let mut point = Point {
            roll_rad: 0.0,
            alpha: 0.0,
            tractor_rad: 0.0,
            front_rad: 0.0,
            axles_rad: vec![0.0; self.suspension.axles.len()],
            axle_load_n: self.balance.axle_load_n.clone(),
            risen_m: vec![0.0; self.suspension.axles.len()],
            linked_n: vec![0.0; self.suspension.axles.len()],
            hitch_load_n: self.balance.hitch_load_n,
            sides: Sides::default(),
            drift: Drift::default(),
            slides: false,
        };
        self.turn_on(false, &mut point).then_some(point)
    }

    /// Solves the yaw plane at the present lateral acceleration and roll angles, and takes its forces or, to
    /// damp them, their mean with those of before. The result is `false`, and the forces are as before, if
    /// the tires cannot hold the vehicle.
    pub(super) fn turn_on(&self, damped: bool, point: &mut Point) -> bool {
        let (alpha, standing) = (point.alpha.max(FIRST), self.standing(point));
        let mut drift = point.drift;
        let found = self.turn.sides(alpha, &standing, &mut drift).or_else(|| {
            drift = Drift::default();
            self.turn.sides_in_steps(alpha, &standing, &mut drift)
        });
        let holds = found.is_some();
        if let Some(sides) = found {
            point.drift = drift;
            if damped {
                point.sides.halfway(&sides);
            } else {
                point.sides = sides;
            }
        }
        holds
    }

    fn standing(&self, point: &Point) -> Vec<Standing> {
        let standing = |i: usize| {
            let axle = &self.suspension.axles[i];
            let angle_rad = self.suspension.angle_rad(i, point);
            let loads_n = axle.tyres.loads_n(point.load_n(i), angle_rad);
            Standing {
                loads_n: loads_n.filter(|load_n| *load_n > 0.0).collect(),
                lean_rad: self.suspension.lean_rad(i, point),
            }
        };
        (0..self.suspension.axles.len()).map(standing).collect()
    }

    /// Shifts loads between axles. An axle rises when its inner wheels leave the road, and takes
    /// load from axles that do not share their load with it. Only half of the shift is made at a time,
    /// because an axle with more load also rolls less, by nearly as much, and the full shift would
    /// overshoot.
    pub(super) fn shift(&self, point: &mut Point, last: &mut Option<Stood>) {
        if self.suspension.groups.len() <= 3 {
            return; // the loads follow from forces and moments alone
        }
        let gives: Vec<_> = (0..self.suspension.axles.len())
            .map(|i| {
                let angle_rad = self.suspension.angle_rad(i, point);
                self.suspension.axles[i].tyres.give(point.load_n(i), angle_rad)
            })
            .collect();
        // As long as no wheel lifts, the loads remain those of the last step.
        if last.as_ref().is_none_or(|(known, _)| !same(known, &gives)) {
            *last = balance_on(self.vehicle, self.load, &gives).ok().map(|found| (gives, found));
        }
        if let Some((_, balance)) = last {
            point.hitch_load_n = 0.5 * (point.hitch_load_n + balance.hitch_load_n);
            for (load_n, found_n) in point.axle_load_n.iter_mut().zip(&balance.axle_load_n) {
                *load_n = 0.5 * (*load_n + found_n);
            }
        }
    }

    /// Lateral forces and weights on the axles of a body: their sums, and the sums multiplied by
    /// the heights of the roll centers.
    fn carried(&self, on_trailer: bool, point: &Point) -> [Held; 2] {
        let none = || Held { side_nm: 0.0, weight_nm: 0.0 };
        let (mut force, mut moment) = (none(), none());
        for (i, axle) in
            self.suspension.axles.iter().enumerate().filter(|(_, a)| a.on_trailer == on_trailer)
        {
            let (side_n, weight_n) = (point.sides.axle_n[i], point.axle_load_n[i] - axle.own_n);
            force.side_nm += side_n;
            force.weight_nm += weight_n;
            moment.side_nm += side_n * axle.roll_center_m;
            moment.weight_nm += weight_n * axle.roll_center_m;
        }
        [force, moment]
    }

    /// `A2` and `B2`.
    fn trailer(&self, cg_height_m: f64, point: &Point) -> Held {
        let [force, moment] = self.carried(true, point);
        let above_m = cg_height_m - self.hitch_height_m;
        Held {
            side_nm: point.sides.hitch_n[0] * above_m + force.side_nm * cg_height_m
                - moment.side_nm,
            weight_nm: point.hitch_load_n * above_m + force.weight_nm * cg_height_m
                - moment.weight_nm,
        }
    }

    /// `A1` and `B1`.
    fn tractor(&self, point: &Point) -> Held {
        let [_, moment] = self.carried(false, point);
        let (own, hitch_m) = (self.tractor_own_nm, self.hitch_height_m);
        Held {
            side_nm: own * point.sides.tractor + point.sides.hitch_n[1] * hitch_m - moment.side_nm,
            weight_nm: own + point.hitch_load_n * hitch_m - moment.weight_nm,
        }
    }

    /// Newton's method, started from the previous state; whether its steps fell below `exact` (g, rad). Axles and
    /// springs are eliminated, which leaves two equations. The curves are linear almost everywhere, so a
    /// few steps are enough.
    pub(super) fn solve(&self, cg_height_m: f64, exact: f64, point: &mut Point) -> bool {
        let roll_rad = point.roll_rad;
        let (of_trailer, of_tractor) = (self.trailer(cg_height_m, point), self.tractor(point));
        let cos = point.sides.cos;
        for _ in 0..STEPS {
            self.suspension.link(point);
            let on_hitch_rad = if self.frame.is_some() { point.front_rad } else { roll_rad };
            let (fifth, fifth_slope) = self.fifth_wheel(on_hitch_rad * cos - point.tractor_rad);
            // Columns: derivatives with respect to α and φ1, and the residual.
            let [by_alpha, _, moment_nm] = of_trailer.moment(point.alpha, roll_rad);
            let mut trailer = [by_alpha, cos * fifth_slope, moment_nm - cos * fifth];
            let [by_alpha, by_roll, moment_nm] = of_tractor.moment(point.alpha, point.tractor_rad);
            let mut tractor = [by_alpha, by_roll - fifth_slope, moment_nm + fifth];
            let front = self.frame.as_ref().map_or([0.0; 3], |frame| {
                let at = Front {
                    alpha: point.alpha,
                    rear_rad: roll_rad,
                    roll_rad: point.front_rad,
                    cos,
                    fifth_wheel: (fifth, fifth_slope),
                    above_m: cg_height_m - self.hitch_height_m,
                    compliance: self.suspension.compliance,
                };
                frame.split(&at, &mut trailer, &mut tractor)
            });
            let mut steps = vec![[0.0; 3]; self.suspension.axles.len()];
            for group in &self.suspension.groups {
                let on_trailer = self.suspension.axles[group.axles[0]].on_trailer;
                let moves = if on_trailer { 0.0 } else { 1.0 };
                let (found, springs_nm) = self.suspension.group(group, point, &mut steps);
                let unit = if on_trailer { &mut trailer } else { &mut tractor };
                unit[0] -= found[0];
                unit[1] -= moves * found[1];
                unit[2] -= found[2] + springs_nm;
            }
            let determinant = trailer[0] * tractor[1] - trailer[1] * tractor[0];
            let alpha = (trailer[1] * tractor[2] - tractor[1] * trailer[2]) / determinant;
            let tractor_rad = (tractor[0] * trailer[2] - trailer[0] * tractor[2]) / determinant;
            let front_rad = front[0] * alpha + front[1] * tractor_rad + front[2];
            let by_axle = |(axle, by): (&Axle, [f64; 3])| {
                let body = if axle.on_trailer { 0.0 } else { tractor_rad };
                by[0] * alpha + by[1] * body + by[2]
            };
            let axles_rad: Vec<f64> =
                self.suspension.axles.iter().zip(steps).map(by_axle).collect();
            let share = self.suspension.one_by_one(point, &axles_rad);
            for (axle_rad, by_rad) in point.axles_rad.iter_mut().zip(&axles_rad) {
                *axle_rad += share * by_rad;
            }
            point.alpha += share * alpha;
            point.tractor_rad += share * tractor_rad;
            point.front_rad += share * front_rad;
            let moved_rad = axles_rad.iter().map(|by_rad| by_rad.abs()).sum::<f64>();
            if alpha.abs() + tractor_rad.abs() + front_rad.abs() + moved_rad < exact.max(LEAST) {
                return true;
            }
        }
        false
    }

    fn fifth_wheel(&self, angle_rad: f64) -> (f64, f64) {
        let at = |angle_rad: f64| self.hitch.moment_nm(angle_rad / self.suspension.compliance);
        (at(angle_rad), (at(angle_rad + 1e-6) - at(angle_rad)) / 1e-6)
    }
}

/// Whether deflections are the same up to [`RISE_M`].
fn same(known: &[Give], gives: &[Give]) -> bool {
    let is_same = |(known, give): (&Give, &Give)| {
        known.compliance_m_per_n.total_cmp(&give.compliance_m_per_n).is_eq()
            && (known.rise_m - give.rise_m).abs() < RISE_M
    };
    known.iter().zip(gives).all(is_same)
}
