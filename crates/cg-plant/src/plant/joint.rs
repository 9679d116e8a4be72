//! Both units as one: the trailer carried by the fifth wheel.

use super::body::Equations;
use super::vector::{Factored, Vector, add, inverse_symmetric, turned};

/// Accelerations of both units: reference point, then yaw, pitch, roll.
pub(super) struct Solution {
    pub(super) tractor: [f64; 6],
    pub(super) trailer: [f64; 6],
    pub(super) hitch_force_n: Vector,
}

impl Solution {
    /// Adds a multiple of the accelerations that other forces cause.
    #[inline]
    pub(super) fn add(&mut self, factor: f64, response: &Self) {
        for i in 0..6 {
            self.tractor[i] += factor * response.tractor[i];
            self.trailer[i] += factor * response.trailer[i];
        }
        for i in 0..3 {
            self.hitch_force_n[i] += factor * response.hitch_force_n[i];
        }
    }
}

/// The masses of both units, coupled at the fifth wheel.
pub(super) struct Joint<'a> {
    /// Of the trailer.
    mass: &'a [[f64; 6]; 6],
    /// Of the trailer's rotation.
    inverse: [[f64; 3]; 3],
    /// With the trailer's mass `T` of translation, `R` of rotation and `C` of both: `C R⁻¹`, and the apparent mass
    /// `A = T − C R⁻¹ Cᵀ`.
    gain: [[f64; 3]; 3],
    apparent: [[f64; 3]; 3],
    /// The fifth wheel's velocity in the trailer's frame, by v1, ż1, then the tractor's rates.
    columns: [Vector; 5],
    whole: Factored<5>,
}

impl<'a> Joint<'a> {
    /// From the masses of both units and the fifth wheel's lever arms for the tractor's rates.
    #[inline]
    pub(super) fn new(
        tractor: &Equations,
        trailer: &'a Equations,
        arms: &[Vector; 3],
        turn: (f64, f64),
    ) -> Self {
        let m = &trailer.mass;
        let inverse = inverse_symmetric([
            [m[3][3], 0.0, 0.0],
            [m[4][3], m[4][4], 0.0],
            [m[5][3], m[5][4], m[5][5]],
        ]);
        let mut gain = [[0.0; 3]; 3];
        let mut apparent = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                gain[i][j] = (0..3).map(|k| m[3 + k][i] * inverse[k][j]).sum();
            }
            for j in 0..3 {
                apparent[i][j] = m[i.max(j)][i.min(j)];
                for k in 0..3 {
                    apparent[i][j] -= gain[i][k] * m[3 + k][j];
                }
            }
        }
        let columns = [
            turned([0.0, 1.0, 0.0], turn),
            [0.0, 0.0, 1.0],
            turned(arms[0], turn),
            turned(arms[1], turn),
            turned(arms[2], turn),
        ];
        let mut whole = [[0.0; 5]; 5];
        for j in 0..5 {
            let carried = times(&apparent, columns[j]);
            for i in j..5 {
                whole[i][j] = tractor.mass[1 + i][1 + j] + dot(columns[i], carried);
            }
        }
        Self { mass: m, inverse, gain, apparent, columns, whole: Factored::new(whole) }
    }

    /// What forces on both units cause.
    #[inline]
    pub(super) fn accelerations(&self, tractor: &[f64; 6], trailer: &[f64; 6]) -> Solution {
        let Self { mass: m, inverse, gain, apparent, columns, whole } = self;
        // p = f_t − C R⁻¹ f_r.
        let mut push = [0.0; 3];
        for i in 0..3 {
            push[i] = trailer[i];
            for j in 0..3 {
                push[i] -= gain[i][j] * trailer[3 + j];
            }
        }
        let mut force = [0.0; 5];
        for j in 0..5 {
            force[j] = tractor[1 + j] + dot(columns[j], push);
        }
        let w = whole.solve(force);
        let mut hitch = [0.0; 3];
        for j in 0..5 {
            hitch = add(hitch, columns[j].map(|value| value * w[j]));
        }
        let mut rest = [0, 1, 2].map(|j| trailer[3 + j]);
        for j in 0..3 {
            rest[j] -= dot([m[3 + j][0], m[3 + j][1], m[3 + j][2]], hitch);
        }
        let rotation = inverse.map(|row| dot(row, rest));
        let needed = times(apparent, hitch);
        Solution {
            tractor: [0.0, w[0], w[1], w[2], w[3], w[4]],
            trailer: [hitch[0], hitch[1], hitch[2], rotation[0], rotation[1], rotation[2]],
            hitch_force_n: [needed[0] - push[0], needed[1] - push[1], needed[2] - push[2]],
        }
    }
}

#[inline]
fn times(matrix: &[[f64; 3]; 3], v: Vector) -> Vector {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[inline]
fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
