//! The equations of motion as matrices, and their state-space form.

use std::ops::{AddAssign, SubAssign};

use nalgebra::{DMatrix, DVector};

use crate::error::VehicleError;
use crate::response::StateSpace;
use crate::twisting::Twisting;

/// Version of the equations of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// The complete equations, derived in this project.
    #[default]
    Complete,
    /// Appendix B of the thesis with its misprints corrected.
    AsPrinted,
}

cg_core::words!(Variant {
    Complete => "complete", "All terms";
    AsPrinted => "as-printed", "The thesis's appendix B, misprints corrected";
});

/// Index of each velocity in `w` (axle `i` follows at `AXLE + i`).
pub mod w {
    /// Lateral velocity of the tractor.
    pub const LATERAL: usize = 0;
    /// Yaw rate of the tractor.
    pub const YAW_1: usize = 1;
    /// Yaw rate of the trailer.
    pub const YAW_2: usize = 2;
    /// Roll rate of the tractor's body.
    pub const ROLL_1: usize = 3;
    /// Roll rate of the trailer's body.
    pub const ROLL_2: usize = 4;
    /// Roll rate of the first axle.
    pub const AXLE: usize = 5;
}

/// Index of each angle in `q` (axle `i` follows at `AXLE + i`).
pub(crate) mod q {
    pub(crate) const ARTICULATION: usize = 0;
    pub(crate) const ROLL_1: usize = 1;
    pub(crate) const ROLL_2: usize = 2;
    pub(crate) const AXLE: usize = 3;
}

/// The equations of motion at one speed and load.
#[derive(Clone, Debug)]
pub struct Equations {
    /// Forward speed, m/s.
    pub speed_mps: f64,
    pub(crate) mass: DMatrix<f64>,
    pub(crate) damping: DMatrix<f64>,
    pub(crate) stiffness: DMatrix<f64>,
    /// Roll stiffness of the fifth wheel if `stiffness` does not contain it. A rigid one in the same
    /// matrix would cost the other entries four digits.
    pub(crate) hitch_roll_stiffness: f64,
    /// The articulation of a steady turn.
    pub(crate) articulated: Articulated,
    /// The trailer's sprung mass.
    pub(crate) trailer_kg: f64,
    pub(crate) steer: DVector<f64>,
    /// Lateral acceleration of the trailer's sprung c.g.: its row on ẇ.
    pub(crate) lateral_rate: DVector<f64>,
    /// The same: its row on w.
    pub(crate) lateral_bias: DVector<f64>,
    /// Acceleration of gravity.
    pub(crate) gravity_mps2: f64,
    /// What sensors fixed to the tractor and to the trailer measure.
    pub(crate) units: [UnitSensors; 2],
    /// Number of axles.
    pub(crate) axles: usize,
    /// The front half of a twisting trailer, whose roll follows the axles in `w` and in `q`. `ROLL_2` is
    /// then the roll of the rear half.
    pub(crate) twisting: Option<Twisting>,
}

/// The sensors of the tractor or of the trailer.
#[derive(Clone, Debug)]
pub(crate) struct UnitSensors {
    /// Lateral velocity of the accelerometer's place: its row on w.
    pub(crate) accelerometer: DVector<f64>,
    /// Numbers of the axles relative to which the suspension roll is measured.
    pub(crate) axles: Vec<usize>,
}

/// The motion for which the model is linear: that of the suspensions of tractor and trailer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// Amplitudes of the suspension roll.
    pub(crate) amplitude_rad: [f64; 2],
    /// Factors of the springs' friction.
    pub(crate) friction: [f64; 2],
    /// Factors of the springs' roll stiffness.
    pub(crate) stiffness: [f64; 2],
    /// Factors of the cornering stiffness of the steered axles, the tractor's other axles and the trailer's.
    pub(crate) cornering: [f64; 3],
    pub(crate) articulated: Articulated,
}

impl Motion {
    /// In the limit of no motion, with the friction and the tires that the vehicle file gives.
    pub(crate) const SMALL: Self = Self {
        amplitude_rad: [0.0; 2],
        friction: [1.0; 2],
        stiffness: [1.0; 2],
        cornering: [1.0; 3],
        articulated: Articulated::STRAIGHT,
    };
}

/// How the units stand to each other in a steady turn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Articulated {
    /// The shares of the roll angles of tractor and trailer in the angle of the fifth wheel.
    pub(crate) hitch_shares: [f64; 2],
    /// The trailer's lateral acceleration over that of the tractor.
    pub(crate) circle: f64,
}

impl Articulated {
    /// In line.
    pub(crate) const STRAIGHT: Self = Self { hitch_shares: [1.0; 2], circle: 1.0 };
}

impl Equations {
    pub(crate) fn zeros(axles: usize, twisting: Option<Twisting>, speed_mps: f64) -> Self {
        let bodies = usize::from(twisting.is_some());
        let (nw, nq) = (w::AXLE + axles + bodies, q::AXLE + axles + bodies);
        Self {
            speed_mps,
            mass: DMatrix::zeros(nw, nw),
            damping: DMatrix::zeros(nw, nw),
            stiffness: DMatrix::zeros(nw, nq),
            hitch_roll_stiffness: 0.0,
            articulated: Articulated::STRAIGHT,
            trailer_kg: 0.0,
            steer: DVector::zeros(nw),
            lateral_rate: DVector::zeros(nw),
            lateral_bias: DVector::zeros(nw),
            gravity_mps2: 0.0,
            units: [(); 2]
                .map(|()| UnitSensors { accelerometer: DVector::zeros(nw), axles: Vec::new() }),
            axles,
            twisting,
        }
    }

    /// Roll rate and roll angle of the body on the fifth wheel: the trailer, or its front half.
    pub(crate) fn on_hitch(&self) -> (usize, usize) {
        match self.twisting {
            Some(_) => (w::AXLE + self.axles, q::AXLE + self.axles),
            None => (w::ROLL_2, q::ROLL_2),
        }
    }

    /// Roll angle at a sensor on the trailer as a row on q; `share` is that of the front half.
    pub(crate) fn trailer_roll(&self, share: impl Fn(&Twisting) -> f64) -> DVector<f64> {
        let mut row = DVector::zeros(self.stiffness.ncols());
        row[q::ROLL_2] = 1.0;
        if let Some(twisting) = &self.twisting {
            let (share, (_, front)) = (share(twisting), self.on_hitch());
            row[q::ROLL_2] -= share;
            row[front] += share;
        }
        row
    }

    /// The stiffness with that of the fifth wheel.
    pub(crate) fn stiffness_with_hitch(&self) -> DMatrix<f64> {
        let mut stiffness = self.stiffness.clone();
        let (rate, roll) = self.on_hitch();
        for (velocity, angle) in [(w::ROLL_1, q::ROLL_1), (rate, roll)] {
            stiffness[(velocity, angle)] += self.hitch_roll_stiffness;
        }
        for (velocity, angle) in [(w::ROLL_1, roll), (rate, q::ROLL_1)] {
            stiffness[(velocity, angle)] -= self.hitch_roll_stiffness;
        }
        stiffness
    }

    /// The state-space form, with every response as an output.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if the mass matrix is singular.
    pub fn state_space(&self) -> Result<StateSpace, VehicleError> {
        let (nw, nq) = self.stiffness.shape();
        let lu = self.mass.clone().lu();
        let singular = || VehicleError::Model("the mass matrix is singular".to_owned());
        let rates = |rhs: DMatrix<f64>| lu.solve(&rhs).ok_or_else(singular);
        let mut a = DMatrix::zeros(nw + nq, nw + nq);
        a.view_mut((0, 0), (nw, nw)).copy_from(&rates(-&self.damping)?);
        a.view_mut((0, nw), (nw, nq)).copy_from(&rates(-self.stiffness_with_hitch())?);
        a[(nw + q::ARTICULATION, w::YAW_1)] = 1.0;
        a[(nw + q::ARTICULATION, w::YAW_2)] = -1.0;
        for i in q::ROLL_1..nq {
            a[(nw + i, w::ROLL_1 + i - q::ROLL_1)] = 1.0;
        }
        let mut b = DVector::zeros(nw + nq);
        let kick = lu.solve(&self.steer).ok_or_else(singular)?;
        b.rows_mut(0, nw).copy_from(&kick);
        let state = |i: usize| {
            let mut row = DVector::zeros(nw + nq);
            row[i] = 1.0;
            row
        };
        let angles = |row: &DVector<f64>| {
            let mut whole = DVector::zeros(nw + nq);
            whole.rows_mut(nw, nq).copy_from(row);
            whole
        };
        let mut lateral = (self.lateral_rate.transpose() * a.rows(0, nw)).transpose();
        for i in 0..nw {
            lateral[i] += self.lateral_bias[i];
        }
        Ok(StateSpace {
            trailer_roll: angles(&self.trailer_roll(|twisting| twisting.roll_share)),
            halves_roll: [1.0, 0.0].map(|share| angles(&self.trailer_roll(|_| share))),
            tractor_roll: state(nw + q::ROLL_1),
            trailer_yaw_rate: state(w::YAW_2),
            tractor_yaw_rate: state(w::YAW_1),
            articulation: state(nw + q::ARTICULATION),
            tractor_lateral_velocity: state(w::LATERAL),
            axle_roll: (0..self.axles).map(|i| state(nw + q::AXLE + i)).collect(),
            lateral_feedthrough: self.lateral_rate.dot(&kick),
            lateral_acceleration: lateral,
            suspension_roll: [0, 1].map(|unit| {
                let mut row = state(nw + q::ROLL_1 + unit);
                row.rows_mut(nw, nq).sub_assign(&self.mean_axle_roll(unit));
                row
            }),
            specific_force: [0, 1].map(|unit| {
                let rate = &self.units[unit].accelerometer;
                let mut row = (rate.transpose() * a.rows(0, nw)).transpose();
                row[w::YAW_1] += self.speed_mps;
                row.rows_mut(nw, nq).add_assign(&(self.gravity_mps2 * self.roll_at_force(unit)));
                (row, rate.dot(&kick))
            }),
            a,
            b,
        })
    }

    /// Roll angle of the accelerometer of a unit as a row on q.
    pub(crate) fn roll_at_force(&self, unit: usize) -> DVector<f64> {
        if unit == 1 {
            return self.trailer_roll(|twisting| twisting.accelerometer_share);
        }
        let mut row = DVector::zeros(self.stiffness.ncols());
        row[q::ROLL_1] = 1.0;
        row
    }

    /// Mean roll angle of the axles relative to which the suspension roll of a unit is measured, as a
    /// row on q.
    pub(crate) fn mean_axle_roll(&self, unit: usize) -> DVector<f64> {
        let axles = &self.units[unit].axles;
        let mut row = DVector::zeros(self.stiffness.ncols());
        for &axle in axles {
            #[allow(clippy::cast_precision_loss)] // a number of axles
            let share = 1.0 / axles.len() as f64;
            row[q::AXLE + axle] = share;
        }
        row
    }

    /// The steady-state system `S x = b` in `x = (v, r, ψ1 − ψ2, φ1, φ2, φu…, m)`, without
    /// accelerations and with the same yaw rate of both units. The moment `m` of the fifth wheel is
    /// an unknown of its own if the model has its stiffness as a number.
    pub(crate) fn steady(&self) -> (DMatrix<f64>, DVector<f64>) {
        let (nw, nq) = self.stiffness.shape();
        let own = usize::from(self.hitch_roll_stiffness > 0.0);
        let (mut s, mut b) = (DMatrix::zeros(nw + own, nw + own), DVector::zeros(nw + own));
        b.rows_mut(0, nw).copy_from(&self.steer);
        s.view_mut((0, 0), (nw, 1)).copy_from(&self.damping.column(w::LATERAL));
        let turning = self.damping.column(w::YAW_1) + self.damping.column(w::YAW_2);
        // On a smaller circle the trailer has less lateral acceleration.
        let less = (self.articulated.circle - 1.0) * self.trailer_kg * self.speed_mps;
        s.view_mut((0, 1), (nw, 1)).copy_from(&(turning + less * &self.lateral_rate));
        s.view_mut((0, 2), (nw, nq)).copy_from(&self.stiffness);
        if own > 0 {
            let (angles, moment) = (2, nw);
            let (rate, roll) = self.on_hitch();
            let [tractor, trailer] = self.articulated.hitch_shares;
            (s[(w::ROLL_1, moment)], s[(rate, moment)]) = (tractor, -trailer);
            (s[(moment, angles + q::ROLL_1)], s[(moment, angles + roll)]) = (tractor, -trailer);
            s[(moment, moment)] = -1.0 / self.hitch_roll_stiffness;
        }
        (s, b)
    }
}
