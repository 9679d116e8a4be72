//! Measured characteristics in the vehicle file: leaf springs with friction, and tires beyond the
//! linear range. All are optional. The nonlinear plant uses them. The linear model uses the
//! springs as linear ones at their load and usual amplitude, and the tires' stiffnesses in the same
//! file.

use serde::{Deserialize, Serialize};

/// A spring measured under slow compression and release: two curves that enclose its friction.
///
/// When the direction of motion changes, the force moves from one curve to the other within about
/// the friction deflection `β`: `dF/dx = (F_env − F)/β` (Fancher, Ervin, MacAdam and Winkler, SAE
/// 800905).
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Name of the spring.
    pub name: String,
    /// Compression of the spring, strictly increasing. Only differences matter.
    pub deflection_m: Vec<f64>,
    /// Force during compression.
    pub compression_n: Vec<f64>,
    /// Force during release; nowhere greater than that during compression.
    pub extension_n: Vec<f64>,
    /// `β`: deflection within which the force moves from one curve to the other.
    pub friction_deflection_m: f64,
}

impl Spring {
    /// The spring with its friction multiplied by a factor: the curve midway between both is the same, and so is
    /// the stiffness with which friction begins to hold, so that its deflection changes by the factor, too.
    #[must_use]
    pub fn with_friction(mut self, factor: f64) -> Self {
        for (up, down) in self.compression_n.iter_mut().zip(&mut self.extension_n) {
            let (middle, half) = (f64::midpoint(*up, *down), 0.5 * (*up - *down));
            (*up, *down) = (middle + factor * half, middle - factor * half);
        }
        self.friction_deflection_m *= factor;
        self
    }
}

/// Lateral force divided by the load, as a function of slip angle and load.
///
/// It is interpolated linearly between the nodes and to zero at zero slip. Beyond the last slip
/// angle, and below the first and above the last load, the coefficient is constant.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct LateralForceTable {
    /// Loads of the columns, strictly increasing.
    pub load_n: Vec<f64>,
    /// Slip angles of the rows, positive and strictly increasing.
    pub slip_rad: Vec<f64>,
    /// Lateral force divided by the load: one row per slip angle, one column per load.
    pub coefficient: Vec<Vec<f64>>,
}

/// Aligning moment as a function of slip angle and load.
///
/// It is interpolated linearly between the nodes and to zero at zero slip and at zero load. Beyond
/// the last row and column it is constant.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct AligningMomentTable {
    /// Loads of the columns, strictly increasing.
    pub load_n: Vec<f64>,
    /// Slip angles of the rows, positive and strictly increasing.
    pub slip_rad: Vec<f64>,
    /// Moment that turns the wheel towards its direction of travel: one row per slip angle, one
    /// column per load.
    pub moment_nm: Vec<Vec<f64>>,
}
