//! The axles, which may share springs, eliminated from the equations of the roll plane.
//!
//! Axles that share their springs lift one after the other. The one that leans more is pressed down by its link, by some percent of
//! its load. Without this, the next one would turn over at once when it lifts.

use super::point::Point;
use super::support::{Righting, Springs, Tyres};
use crate::balance::load_groups;
use crate::vehicle::{PlacedAxle, Vehicle};

pub(super) struct Axle {
    pub(super) on_trailer: bool,
    pub(super) steered: bool,
    half_spread_m: f64,
    auxiliary_nm_per_rad: f64,
    pub(super) tyres: Tyres,
    pub(super) roll_center_m: f64,
    center_m: f64,
    pub(super) own_n: f64,
}

impl Axle {
    fn of(vehicle: &Vehicle, placed: &PlacedAxle<'_>) -> Self {
        Self {
            on_trailer: placed.on_trailer,
            steered: placed.steered,
            half_spread_m: 0.5 * placed.axle.spring_spread_m,
            auxiliary_nm_per_rad: placed.axle.auxiliary_roll_stiffness_nm_per_rad,
            tyres: Tyres::of(placed),
            roll_center_m: placed.axle.roll_center_height_m,
            center_m: placed.axle.center_height_m,
            own_n: placed.axle.unsprung_mass_kg * vehicle.gravity_mps2,
        }
    }
}

/// A pair of springs, and the axles that share it.
pub(super) struct Group {
    springs: Springs,
    pub(super) axles: Vec<usize>,
}

impl Group {
    /// The pairs of springs: one for each load group, and one for each axle without a group.
    pub(super) fn all(vehicle: &Vehicle, placed: &[PlacedAxle<'_>], sprung_n: &[f64]) -> Vec<Self> {
        let pair = |axles: Vec<usize>| {
            let of: Vec<_> = axles.iter().map(|&i| &placed[i]).collect();
            let mean_n = mean(axles.iter().map(|&i| sprung_n[i]));
            Self { springs: Springs::of(vehicle, &of, mean_n), axles }
        };
        load_groups(placed).into_iter().map(pair).collect()
    }

    /// Share of an axle.
    fn share(&self) -> f64 {
        #[allow(clippy::cast_precision_loss)] // a few axles
        let count = self.axles.len() as f64;
        1.0 / count
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// Axles of a group that lift within this share of a step of Newton's method lift together.
const TOGETHER: f64 = 1e-9;

/// The linearized equation of an axle.
struct Follows {
    /// The derivative with respect to the roll angle of the axle, with the sign of a stiffness.
    stiffness: f64,
    /// Derivatives with respect to `α` and to the roll angle of the body, and the residual.
    direct: [f64; 3],
    /// Derivatives with respect to half the difference of the springs' compressions, and to the mean load of the links.
    by_springs: f64,
    by_links: f64,
    /// What this axle contributes to these two: the compression per roll angle of the body relative to the axle, and the load
    /// per roll angle of the axle.
    compresses: f64,
    presses: f64,
    /// The same of the links' mean load with respect to `α`.
    presses_by_alpha: f64,
    /// Moment of the springs on the axle.
    springs_nm: f64,
}

/// All axles and their springs.
pub(super) struct Suspension {
    pub(super) axles: Vec<Axle>,
    pub(super) groups: Vec<Group>,
    /// Roll angle of the real vehicle divided by that of the vehicle file.
    pub(super) compliance: f64,
}

impl Suspension {
    /// The suspension of a vehicle whose axles carry these loads.
    pub(super) fn of(vehicle: &Vehicle, axle_load_n: &[f64], compliance: f64) -> Self {
        let placed = vehicle.axles();
        let axles: Vec<Axle> = placed.iter().map(|placed| Axle::of(vehicle, placed)).collect();
        let sprung_n: Vec<f64> =
            axles.iter().zip(axle_load_n).map(|(axle, load_n)| load_n - axle.own_n).collect();
        let groups = Group::all(vehicle, &placed, &sprung_n);
        Self { axles, groups, compliance }
    }

    /// Roll angle of an axle for the tires and springs of the file.
    pub(super) fn angle_rad(&self, i: usize, point: &Point) -> f64 {
        point.axles_rad[i] / self.compliance
    }

    /// Raises the bodies with their axles and on their springs. The roll centers belong to the body, which rises by the mean of
    /// the axles that are close together.
    pub(super) fn rise(&self, point: &mut Point) {
        let mut risen_m = vec![0.0; self.axles.len()];
        for group in &self.groups {
            let springs_m = group.springs.rise_m(self.apart_m(group, point));
            for &i in &group.axles {
                let angle_rad = self.angle_rad(i, point);
                let tyres_m = self.axles[i].tyres.rise_m(point.load_n(i), angle_rad);
                risen_m[i] = self.compliance * (tyres_m + springs_m);
            }
        }
        let place = |i: usize| (self.axles[i].on_trailer, self.axles[i].steered);
        let all = 0..self.axles.len();
        let near = |i: usize| all.clone().filter(move |&k| place(k) == place(i));
        point.risen_m = all.clone().map(|i| mean(near(i).map(|k| risen_m[k]))).collect();
    }

    /// Half the difference of the compressions of a group's springs.
    fn apart_m(&self, group: &Group, point: &Point) -> f64 {
        let of = |&i: &usize| self.axles[i].half_spread_m * libm::sin(self.lean_rad(i, point));
        mean(group.axles.iter().map(of)) / self.compliance
    }

    /// Roll angle of the body minus that of an axle.
    pub(super) fn lean_rad(&self, i: usize, point: &Point) -> f64 {
        let body_rad = if self.axles[i].on_trailer { point.roll_rad } else { point.tractor_rad };
        body_rad - point.axles_rad[i]
    }

    /// Moves load between axles that share their springs. The springs press all of them equally, along the vertical axis of each,
    /// and a link takes what is lateral to the axle, of the lateral force and of theirs: an axle that leans more is pressed down.
    /// With the springs' force `S` and the lateral force `F`, an axle carries `S/cos φ + F tan φ`.
    pub(super) fn link(&self, point: &mut Point) {
        for group in self.groups.iter().filter(|group| group.axles.len() > 1) {
            let by_link_n = |i: usize| {
                let (sin, cos) = libm::sincos(point.axles_rad[i]);
                let carried_n = point.axle_load_n[i] - self.axles[i].own_n;
                (point.alpha * point.sides.axle_n[i] * sin + carried_n * (1.0 - cos)) / cos
            };
            let mean_n = mean(group.axles.iter().map(|&i| by_link_n(i)));
            let linked_n: Vec<f64> = group.axles.iter().map(|&i| by_link_n(i) - mean_n).collect();
            for (&i, n) in group.axles.iter().zip(linked_n) {
                point.linked_n[i] = n;
            }
        }
    }

    /// Share of these steps of the axles' roll angles after which of two axles of a group only one has lifted. The first one yields,
    /// and with it the springs that both share, so that the other one may not lift at all.
    pub(super) fn one_by_one(&self, point: &Point, steps_rad: &[f64]) -> f64 {
        let lifts = |i: usize| {
            let angle_rad = self.angle_rad(i, point);
            let lift_rad = self.axles[i].tyres.next_lift_rad(point.load_n(i), angle_rad)?;
            let share = (lift_rad - angle_rad) * self.compliance / steps_rad[i];
            (steps_rad[i] > 0.0 && share < 1.0).then_some(share)
        };
        let mut limit = 1.0_f64;
        for group in self.groups.iter().filter(|group| group.axles.len() > 1) {
            let [mut first, mut second] = [1.0_f64; 2];
            for share in group.axles.iter().filter_map(|&i| lifts(i)) {
                if share < first {
                    (first, second) = (share, first);
                } else {
                    second = second.min(share);
                }
            }
            if second < 1.0 && second - first > TOGETHER {
                limit = limit.min(f64::midpoint(first, second));
            }
        }
        limit
    }

    /// The Newton steps of a group's axles: per step of `α`, per step of the body's roll angle, and
    /// a constant part. Returns the same three parts of the moment on the body, and the moment
    /// itself.
    pub(super) fn group(
        &self,
        group: &Group,
        point: &Point,
        steps: &mut [[f64; 3]],
    ) -> ([f64; 3], f64) {
        let springs = group.springs.at(self.apart_m(group, point));
        let follows: Vec<_> =
            group.axles.iter().map(|&i| self.follows(i, group, springs, point)).collect();
        // The compression of the springs and the mean load of the links depend on the axles, and these on both.
        let [mut compression, mut links] = [[1.0, 0.0], [0.0, 1.0]];
        let [mut compressed, mut linked] = [[0.0; 3]; 2];
        for f in &follows {
            compression[0] += f.compresses * f.by_springs / f.stiffness;
            compression[1] += f.compresses * f.by_links / f.stiffness;
            links[0] -= f.presses * f.by_springs / f.stiffness;
            links[1] -= f.presses * f.by_links / f.stiffness;
            compressed[1] += f.compresses;
            linked[0] += f.presses_by_alpha;
            for k in 0..3 {
                compressed[k] -= f.compresses * f.direct[k] / f.stiffness;
                linked[k] += f.presses * f.direct[k] / f.stiffness;
            }
        }
        let determinant = compression[0] * links[1] - compression[1] * links[0];
        let (mut on_body, mut springs_nm) = ([0.0; 3], 0.0);
        for (&i, f) in group.axles.iter().zip(&follows) {
            let auxiliary = f.direct[1];
            for k in 0..3 {
                let apart = (compressed[k] * links[1] - compression[1] * linked[k]) / determinant;
                let mean = (compression[0] * linked[k] - links[0] * compressed[k]) / determinant;
                let pressed = f.by_springs * apart;
                steps[i][k] = (f.direct[k] + pressed + f.by_links * mean) / f.stiffness;
                on_body[k] += pressed - auxiliary * steps[i][k];
            }
            on_body[1] += auxiliary;
            springs_nm += f.springs_nm;
        }
        (on_body, springs_nm)
    }

    /// The equation of an axle of a group whose springs have this difference of forces and this slope.
    fn follows(
        &self,
        i: usize,
        group: &Group,
        (force_n, slope): (f64, f64),
        point: &Point,
    ) -> Follows {
        let (axle, c) = (&self.axles[i], self.compliance);
        let (angle_rad, load_n) = (point.axles_rad[i], point.load_n(i));
        let lean_rad = self.lean_rad(i, point);
        let lever_m = axle.half_spread_m * libm::cos(lean_rad);
        let auxiliary = axle.auxiliary_nm_per_rad / c;
        let springs_nm = lever_m * force_n + auxiliary * lean_rad;
        let Righting { moment_nm: tyres_nm, slope: tyre_slope, rise_m, lever_m: rise_slope } =
            axle.tyres.right(load_n, angle_rad / c);
        let [axle_n, own_n] = [point.sides.axle_n[i], point.sides.own_n[i]];
        let roll_center_m = axle.roll_center_m + point.risen_m[i];
        let center_m = axle.center_m + c * rise_m;
        let side = axle_n * roll_center_m + own_n * center_m;
        let weight_nm = (load_n - axle.own_n) * roll_center_m + axle.own_n * center_m;
        let rising = (own_n * point.alpha + axle.own_n * angle_rad) * rise_slope;
        let (sin, cos) = libm::sincos(angle_rad);
        // Load that the link of an axle of several moves to it (see `link`), and what load does to the axle.
        let moved = if group.axles.len() > 1 { 1.0 } else { 0.0 };
        let carried_n = point.axle_load_n[i] - axle.own_n;
        let linked = moved * (point.alpha * axle_n + carried_n * sin) / (cos * cos);
        let linked_by_alpha = moved * axle_n * sin / cos;
        let by_load = roll_center_m * angle_rad - rise_slope / cos;
        // The points of contact move outward with the tires, which lean.
        let stiffness = auxiliary + tyre_slope / cos / c + tyres_nm * sin / (cos * cos)
            - weight_nm
            - rising
            - by_load * linked;
        let residual = springs_nm + weight_nm * angle_rad - tyres_nm / cos + side * point.alpha;
        Follows {
            stiffness,
            direct: [side + by_load * linked_by_alpha, auxiliary, residual],
            by_springs: lever_m * slope,
            by_links: -by_load,
            compresses: group.share() * lever_m / c,
            presses: group.share() * linked,
            presses_by_alpha: group.share() * linked_by_alpha,
            springs_nm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::yaw_plane::{Drift, Sides};
    use super::*;
    use crate::balance::static_balance;

    /// On each axle the link's force `T`, lateral to the axle, and that of the springs `S`, the same on all axles of a group, balance
    /// the lateral force `F` and the load `V`: `T cos φ − S sin φ = F`, `S cos φ + T sin φ = V`. The code takes the mean load of the
    /// group for `S`, which leaves out `F φ · φ²/2`.
    #[test]
    fn links_press_down_the_axle_that_leans_more() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/baseline.toml");
        let vehicle = Vehicle::load(file).unwrap();
        let axle_load_n = static_balance(&vehicle, vehicle.reference_load()).unwrap().axle_load_n;
        let suspension = Suspension::of(&vehicle, &axle_load_n, 1.0);
        let [first, second] = suspension.groups.last().unwrap().axles[..] else {
            panic!("two axles")
        };
        let count = axle_load_n.len();
        let mut point = Point {
            roll_rad: 0.12,
            alpha: 0.4,
            tractor_rad: 0.0,
            front_rad: 0.0,
            axles_rad: vec![0.0; count],
            axle_load_n: axle_load_n.clone(),
            risen_m: vec![0.0; count],
            linked_n: vec![0.0; count],
            hitch_load_n: 0.0,
            sides: Sides { axle_n: vec![6e4; count], ..Sides::default() },
            drift: Drift::default(),
            slides: false,
        };
        (point.axles_rad[first], point.axles_rad[second]) = (0.02, 0.1);
        suspension.link(&mut point);
        let total_n = 2.0 * (axle_load_n[first] - suspension.axles[first].own_n);
        let side_n = 0.4 * 6e4;
        let leans = [(first, 0.02_f64), (second, 0.1)];
        let by_springs: f64 = leans.iter().map(|(_, rad)| 1.0 / rad.cos()).sum();
        let by_links_n: f64 = leans.iter().map(|(_, rad)| side_n * rad.tan()).sum();
        let springs_n = (total_n - by_links_n) / by_springs;
        for (i, rad) in leans {
            let link_n = (side_n + springs_n * rad.sin()) / rad.cos();
            let moved_n = springs_n * rad.cos() + link_n * rad.sin() - 0.5 * total_n;
            println!("{moved_n:.0} N, {:.0} N", point.linked_n[i]);
            let left_out_n = 0.5 * side_n * 0.1_f64.powi(3);
            assert!((point.linked_n[i] - moved_n).abs() < left_out_n, "{moved_n}");
        }
    }
}
