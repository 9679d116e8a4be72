//! An axle. It is guided at its roll center, which is fixed in the sprung mass and slides along the
//! axle's own vertical. It has two coordinates, rise `s` and roll `φu`.
//!
//! Let `k` be the axle's vertical, `j` its direction to the left and `s` the distance of the roll
//! center above its c.g. The inertias of the axle are then uncoupled: `m` for the rise and
//! `m s² + I` for the roll. Both accelerations are eliminated directly, which leaves for the sprung
//! mass
//!
//! ```text
//!     mass    m X Xᵀ + m I/(m s² + I) Y Yᵀ      X, Y: rows of the c.g.'s velocity along e_x and j
//!     force   at the c.g., without its part along k, with the springs in its place
//! ```
//!
//! Lateral forces thus reach the body through the roll center without being computed.

use super::body::{Equations, Motion};
use super::suspension::Group;
use super::tyre::{Contact, Hub, Tyres};
use super::vector::Vector;
use cg_vehicle::characteristics::Grip;

/// Parameters of an axle.
#[derive(Clone, Debug)]
pub(super) struct Axle {
    pub(super) on_trailer: bool,
    /// From the unit's reference point, body axes.
    pub(super) roll_center: Vector,
    pub(super) mass_kg: f64,
    /// Roll and yaw.
    pub(super) inertia_kgm2: f64,
    /// Static distance of the roll center above the axle's center.
    pub(super) rise_m: f64,
    pub(super) half_spread_m: f64,
    pub(super) auxiliary_nm_per_rad: f64,
    /// Sum of both dampers.
    pub(super) bounce_damping_ns_per_m: f64,
    pub(super) roll_damping_nms_per_rad: f64,
    pub(super) roll_steer: f64,
    /// One if the axle is steered, otherwise zero.
    pub(super) steered: f64,
    /// Index of the springs, and one divided by the number of axles that share them.
    pub(super) group: usize,
    pub(super) share: f64,
    pub(super) tyres: Tyres,
}

/// Position of an axle relative to its body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pose {
    pub(super) rise_m: f64,
    pub(super) rise_rate: f64,
    pub(super) roll_rad: f64,
    pub(super) roll_rate: f64,
    pub(super) sin: f64,
    pub(super) cos: f64,
    /// Roll of the body minus that of the axle.
    lean_rad: f64,
    lean_rate: f64,
    cos_lean: f64,
    sin_lean: f64,
}

impl Pose {
    /// From rise, roll and their rates.
    #[inline]
    pub(super) fn new(own: [f64; 4], body_roll_rad: f64, motion: &Motion) -> Self {
        let [rise_m, roll_rad, rise_rate, roll_rate] = own;
        let (sin, cos) = super::vector::sin_cos(roll_rad);
        let (sin_body, cos_body) = (motion.attitude.sin_roll, motion.attitude.cos_roll);
        Self {
            rise_m,
            rise_rate,
            roll_rad,
            roll_rate,
            sin,
            cos,
            lean_rad: body_roll_rad - roll_rad,
            lean_rate: motion.rates[2] - roll_rate,
            cos_lean: cos_body * cos + sin_body * sin,
            sin_lean: sin_body * cos - cos_body * sin,
        }
    }
}

/// The values from which an axle's accelerations are recovered.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Eliminated {
    along_j: [f64; 6],
    along_k: [f64; 6],
    rise: f64,
    roll: f64,
    coupling: f64,
}

impl Eliminated {
    /// Accelerations of rise and roll, from those of the unit.
    #[inline]
    pub(super) fn accelerations(&self, unit: &[f64; 6]) -> (f64, f64) {
        let (mut j, mut k) = (0.0, 0.0);
        for i in 0..6 {
            j += self.along_j[i] * unit[i];
            k += self.along_k[i] * unit[i];
        }
        (self.rise + k, self.roll - self.coupling * j)
    }
}

impl Axle {
    /// Compression of both springs from the static position and its rate: `[x, ẋ]` left, right.
    #[inline]
    pub(super) fn compression(&self, pose: &Pose) -> [[f64; 2]; 2] {
        let (bounce, rate) = (self.rise_m - pose.rise_m, -pose.rise_rate);
        let (roll, roll_rate) = (
            self.half_spread_m * pose.sin_lean,
            self.half_spread_m * pose.cos_lean * pose.lean_rate,
        );
        [[bounce - roll, rate - roll_rate], [bounce + roll, rate + roll_rate]]
    }

    /// Force on the rise and roll moment on the body, from the forces of the group's springs, which
    /// act equally on every axle of the group.
    #[inline]
    fn suspension(&self, pose: &Pose, springs_n: [f64; 2]) -> (f64, f64) {
        let [left, right] = springs_n;
        let lever = self.half_spread_m * pose.cos_lean;
        let damped = self.roll_damping_nms_per_rad * pose.cos_lean * pose.cos_lean;
        (
            left + right - self.bounce_damping_ns_per_m * pose.rise_rate,
            lever * (left - right)
                - damped * pose.lean_rate
                - self.auxiliary_nm_per_rad * pose.lean_rad,
        )
    }

    /// Adds the axle to its unit's equations.
    #[inline]
    pub(super) fn assemble(
        &self,
        equations: &mut Equations,
        motion: &Motion,
        pose: &Pose,
        road: &Road<'_>,
    ) -> (Eliminated, Contact) {
        let (s, sin, cos, m) = (pose.rise_m, pose.sin, pose.cos, self.mass_kg);
        let rho = motion.attitude.outward(self.roll_center);
        let center = [rho[0], rho[1] + s * sin, rho[2] - s * cos];
        let arms = motion.attitude.arms(rho);
        let yaw_arm = [-center[1], center[0]];
        // Rows of the center's velocity along e_x, j = (0, cos, sin) and k = (0, −sin, cos).
        let (pitch, roll) = (arms[1], arms[2]);
        let x = [1.0, 0.0, 0.0, yaw_arm[0], pitch[0], roll[0]];
        let along_j =
            [0.0, cos, sin, cos * yaw_arm[1], sin * pitch[2], cos * roll[1] + sin * roll[2]];
        let along_k =
            [0.0, -sin, cos, -sin * yaw_arm[1], cos * pitch[2], cos * roll[2] - sin * roll[1]];
        let roll_inertia = m * s * s + self.inertia_kgm2;
        let coupling = m * s / roll_inertia;
        equations.add_axle(&x, m, &along_j, m * self.inertia_kgm2 / roll_inertia);
        equations.mass[3][3] += self.inertia_kgm2 * cos * cos;

        let (velocity, bias) = center_motion(motion, pose, rho);
        let contact =
            self.contact(motion, pose, road, road.reference_height_m + center[2], velocity);
        let (rise_n, lean_nm) = self.suspension(pose, road.springs_n[self.group]);
        equations.force[5] += lean_nm;

        let net = [0, 1, 2].map(|i| contact.force[i] + m * (road.gravity[i] - bias[i]));
        let (net_j, net_k) = (cos * net[1] + sin * net[2], cos * net[2] - sin * net[1]);
        let yaw_rate = motion.rates[0];
        let spin = self.inertia_kgm2 * yaw_rate * sin * cos;
        equations.force[3] += contact.yaw_nm + 2.0 * spin * pose.roll_rate;
        let own_rise = rise_n - net_k;
        let own_roll = s * net_j + contact.roll_nm - yaw_rate * spin - lean_nm;
        let side = net_j - coupling * own_roll;
        for i in 0..6 {
            equations.force[i] += x[i] * net[0] + along_j[i] * side + along_k[i] * rise_n;
        }
        let eliminated = Eliminated {
            along_j,
            along_k,
            rise: own_rise / m,
            roll: own_roll / roll_inertia,
            coupling,
        };
        (eliminated, contact)
    }

    #[inline]
    fn contact(
        &self,
        motion: &Motion,
        pose: &Pose,
        road: &Road<'_>,
        height_m: f64,
        velocity: Vector,
    ) -> Contact {
        let hub = Hub {
            sin: pose.sin,
            cos: pose.cos,
            roll_rad: pose.roll_rad,
            roll_rate: pose.roll_rate,
            yaw_rate: motion.rates[0],
            height_m,
            velocity,
            steer_rad: self.roll_steer * pose.lean_rad + self.steered * road.steer_rad,
            lagged_slip_rad: road.lagged_slip_rad,
        };
        if road.twist_rad == 0.0 {
            return self.tyres.contact(road.kinds, &hub);
        }
        // The same in the plane under this axle, which is turned about the line below its center.
        let (sin, cos) = super::vector::sin_cos(road.twist_rad);
        let roll_rad = hub.roll_rad - road.twist_rad;
        let hub = Hub {
            sin: pose.sin * cos - pose.cos * sin,
            cos: pose.cos * cos + pose.sin * sin,
            roll_rad,
            height_m: height_m * cos,
            velocity: [
                velocity[0],
                cos * velocity[1] + sin * velocity[2],
                cos * velocity[2] - sin * velocity[1],
            ],
            ..hub
        };
        let contact = self.tyres.contact(road.kinds, &hub);
        let [x, y, z] = contact.force;
        Contact { force: [x, cos * y - sin * z, sin * y + cos * z], ..contact }
    }
}

/// Velocity of the center, and its acceleration at constant rates.
#[inline]
fn center_motion(motion: &Motion, pose: &Pose, rho: Vector) -> (Vector, Vector) {
    let (s, ds, sin, cos) = (pose.rise_m, pose.rise_rate, pose.sin, pose.cos);
    let (yaw, roll) = (motion.rates[0], pose.roll_rate);
    let (at_center, base) = motion.point(rho);
    // ω_u × k for ω_u = φ̇u e_x + ψ̇ e_z.
    let turning = [yaw * sin, -roll * cos, -roll * sin];
    let velocity = [
        at_center[0] - s * turning[0],
        at_center[1] + ds * sin - s * turning[1],
        at_center[2] - ds * cos - s * turning[2],
    ];
    let bias = [
        base[0] - 2.0 * ds * turning[0] - 2.0 * s * roll * yaw * cos,
        base[1] - 2.0 * ds * turning[1] - s * (yaw * yaw + roll * roll) * sin,
        base[2] - 2.0 * ds * turning[2] + s * roll * roll * cos,
    ];
    (velocity, bias)
}

/// What acts on an axle from outside its unit: road, inputs and springs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Road<'a> {
    pub(super) kinds: &'a [Grip],
    /// Height of the unit's reference point.
    pub(super) reference_height_m: f64,
    pub(super) gravity: Vector,
    pub(super) steer_rad: f64,
    /// Bank under this axle minus that of the road's plane.
    pub(super) twist_rad: f64,
    pub(super) lagged_slip_rad: f64,
    /// Forces of each group's springs, left and right.
    pub(super) springs_n: &'a [[f64; 2]],
}

/// Forces of each group's springs from the compressions of its axles, and rates of the stored ones.
#[inline]
pub(super) fn group_forces(
    groups: &[Group],
    axles: &[Axle],
    poses: &[Pose],
    mut stored: impl FnMut(usize) -> [f64; 2],
    mut found: impl FnMut(usize, [f64; 2], [[f64; 2]; 2]),
) {
    let mut x = [[[0.0; 2]; 2]; super::state::MAX_AXLES];
    for (axle, pose) in axles.iter().zip(poses) {
        let compression = axle.compression(pose);
        for side in 0..2 {
            for k in 0..2 {
                x[axle.group][side][k] += axle.share * compression[side][k];
            }
        }
    }
    for (g, group) in groups.iter().enumerate() {
        let stored = stored(group.first_axle);
        let force = [0, 1].map(|side| group.law.force_n(x[g][side][0], stored[side]));
        found(g, force, x[g]);
    }
}
