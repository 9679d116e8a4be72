//! A sprung mass: attitude, motion of its points, and the equations of its unit.
//!
//! All vectors have their components in the unit's own yaw frame: forward along its heading, left,
//! up. The frame rotates; the accelerations are inertial. With yaw `ψ`, pitch `θ` and roll `φ` in this
//! order, `R = Ry(θ) Rx(φ)` transforms body axes to the yaw frame, and the axes of the three rates
//! are `e_z`, `e_y` and `b = R x̂`.

use super::vector::{Vector, add, cross, scaled, sin_cos};

/// A sprung mass.
#[derive(Clone, Debug)]
pub(super) struct Sprung {
    pub(super) mass_kg: f64,
    /// Roll, pitch, yaw about the c.g.
    pub(super) inertia_kgm2: Vector,
    /// C.g. from the unit's reference point, body axes.
    pub(super) cg: Vector,
}

/// Pitch and roll of a sprung mass in its yaw frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attitude {
    pub(super) sin_pitch: f64,
    pub(super) cos_pitch: f64,
    pub(super) sin_roll: f64,
    pub(super) cos_roll: f64,
}

impl Attitude {
    #[inline]
    pub(super) fn new(pitch_rad: f64, roll_rad: f64) -> Self {
        let (sin_pitch, cos_pitch) = sin_cos(pitch_rad);
        let (sin_roll, cos_roll) = sin_cos(roll_rad);
        Self { sin_pitch, cos_pitch, sin_roll, cos_roll }
    }

    /// `R p`: from body axes to the yaw frame.
    #[inline]
    pub(super) fn outward(&self, p: Vector) -> Vector {
        let y = p[1] * self.cos_roll - p[2] * self.sin_roll;
        let z = p[1] * self.sin_roll + p[2] * self.cos_roll;
        [self.cos_pitch * p[0] + self.sin_pitch * z, y, self.cos_pitch * z - self.sin_pitch * p[0]]
    }

    /// The arms of the three rates at `rho`: `e_z × ρ`, `e_y × ρ`, `b × ρ`.
    #[inline]
    pub(super) fn arms(&self, rho: Vector) -> [Vector; 3] {
        let (s, c) = (self.sin_pitch, self.cos_pitch);
        [
            [-rho[1], rho[0], 0.0],
            [rho[2], 0.0, -rho[0]],
            [s * rho[1], -s * rho[0] - c * rho[2], c * rho[1]],
        ]
    }

    /// Generalized components of a moment for the three rates.
    #[inline]
    fn along_rates(&self, moment: Vector) -> [f64; 3] {
        [moment[2], moment[1], self.cos_pitch * moment[0] - self.sin_pitch * moment[2]]
    }
}

/// Motion of a unit: its reference point and its rotation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) attitude: Attitude,
    /// Rates of yaw, pitch and roll.
    pub(super) rates: [f64; 3],
    /// Velocity of the reference point.
    pub(super) velocity: Vector,
    /// Its acceleration at constant rates.
    pub(super) bias: Vector,
    omega: Vector,
    alpha: Vector,
}

impl Motion {
    #[inline]
    pub(super) fn new(attitude: Attitude, rates: [f64; 3], velocity: Vector, bias: Vector) -> Self {
        let [yaw, pitch, roll] = rates;
        let (s, c) = (attitude.sin_pitch, attitude.cos_pitch);
        let omega = [roll * c, pitch, yaw - roll * s];
        // Rotation of the axes of the rates: −θ̇ψ̇ e_x + φ̇ (ψ̇ e_z + θ̇ e_y) × b.
        let alpha = [-pitch * yaw - roll * pitch * s, roll * yaw * c, -roll * pitch * c];
        Self { attitude, rates, velocity, bias, omega, alpha }
    }

    /// Velocity of the point at `rho` and its acceleration at constant rates.
    #[inline]
    pub(super) fn point(&self, rho: Vector) -> (Vector, Vector) {
        let turning = cross(self.omega, rho);
        let bias = add(self.bias, add(cross(self.alpha, rho), cross(self.omega, turning)));
        (add(self.velocity, turning), bias)
    }
}

/// The equations of one unit, `mass · (a, ψ̈, θ̈, φ̈) = force`, where `a` is the part of the
/// acceleration of its reference point that is due to changing rates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equations {
    /// Symmetric: its lower triangle.
    pub(super) mass: [[f64; 6]; 6],
    pub(super) force: [f64; 6],
}

impl Equations {
    pub(super) fn zeros() -> Self {
        Self { mass: [[0.0; 6]; 6], force: [0.0; 6] }
    }

    /// Adds a force at `rho`.
    #[inline]
    pub(super) fn add_force(&mut self, attitude: &Attitude, rho: Vector, force: Vector) {
        let moment = attitude.along_rates(cross(rho, force));
        for i in 0..3 {
            self.force[i] += force[i];
            self.force[3 + i] += moment[i];
        }
    }

    /// Adds an axle: `along · Xᵀ X + across · Yᵀ Y`, where `X` is zero at 1 and 2 and `Y` is zero
    /// at 0.
    #[inline]
    pub(super) fn add_axle(&mut self, x: &[f64; 6], along: f64, y: &[f64; 6], across: f64) {
        const OF_X: [usize; 4] = [0, 3, 4, 5];
        for a in 0..4 {
            let left = along * x[OF_X[a]];
            for b in 0..=a {
                self.mass[OF_X[a]][OF_X[b]] += left * x[OF_X[b]];
            }
        }
        for a in 1..6 {
            let left = across * y[a];
            for b in 1..=a {
                self.mass[a][b] += left * y[b];
            }
        }
    }

    /// Adds the sprung mass itself.
    #[inline]
    pub(super) fn add_sprung(&mut self, motion: &Motion, sprung: &Sprung, gravity: Vector) {
        let mass_kg = sprung.mass_kg;
        let rho = motion.attitude.outward(sprung.cg);
        let arms = motion.attitude.arms(rho);
        for i in 0..3 {
            self.mass[i][i] += mass_kg;
            for j in 0..3 {
                self.mass[3 + j][i] += mass_kg * arms[j][i];
            }
            for j in 0..=i {
                let dot =
                    arms[i][0] * arms[j][0] + arms[i][1] * arms[j][1] + arms[i][2] * arms[j][2];
                self.mass[3 + i][3 + j] += mass_kg * dot;
            }
        }
        let (_, bias) = motion.point(rho);
        let force = add(gravity, scaled(bias, -1.0));
        self.add_force(&motion.attitude, rho, scaled(force, mass_kg));
        self.add_rotation(motion, sprung.inertia_kgm2);
    }

    /// Adds the rotational inertia, in body axes: `Jᵀ I J` and `−Jᵀ (I α + ω × I ω)`.
    #[inline]
    fn add_rotation(&mut self, motion: &Motion, i: Vector) {
        let a = &motion.attitude;
        let [yaw, pitch, roll] = motion.rates;
        let e_z = [-a.sin_pitch, a.cos_pitch * a.sin_roll, a.cos_pitch * a.cos_roll];
        let e_y = [0.0, a.cos_roll, -a.sin_roll];
        let m = &mut self.mass;
        m[3][3] += i[0] * e_z[0] * e_z[0] + i[1] * e_z[1] * e_z[1] + i[2] * e_z[2] * e_z[2];
        m[4][4] += i[1] * e_y[1] * e_y[1] + i[2] * e_y[2] * e_y[2];
        m[5][5] += i[0];
        m[4][3] += i[1] * e_z[1] * e_y[1] + i[2] * e_z[2] * e_y[2];
        m[5][3] += i[0] * e_z[0];

        let omega =
            [yaw * e_z[0] + roll, yaw * e_z[1] + pitch * e_y[1], yaw * e_z[2] + pitch * e_y[2]];
        let alpha = inward(a, motion.alpha);
        let torque = [
            -(i[0] * alpha[0] + (i[2] - i[1]) * omega[1] * omega[2]),
            -(i[1] * alpha[1] + (i[0] - i[2]) * omega[2] * omega[0]),
            -(i[2] * alpha[2] + (i[1] - i[0]) * omega[0] * omega[1]),
        ];
        self.force[3] += e_z[0] * torque[0] + e_z[1] * torque[1] + e_z[2] * torque[2];
        self.force[4] += e_y[1] * torque[1] + e_y[2] * torque[2];
        self.force[5] += torque[0];
    }
}

/// `Rᵀ v`: from the yaw frame to body axes.
#[inline]
fn inward(a: &Attitude, v: Vector) -> Vector {
    let z = a.sin_pitch * v[0] + a.cos_pitch * v[2];
    [
        a.cos_pitch * v[0] - a.sin_pitch * v[2],
        a.cos_roll * v[1] + a.sin_roll * z,
        a.cos_roll * z - a.sin_roll * v[1],
    ]
}
