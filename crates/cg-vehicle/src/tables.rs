//! Measured characteristics in the vehicle file: leaf springs with friction, tyres beyond the
//! linear range. All optional; the nonlinear plant reads them, the linear model its stiffnesses beside them.

use serde::{Deserialize, Serialize};

/// A spring measured by loading it slowly up and down: two curves that enclose its friction.
///
/// Between the curves the force moves from one to the other within about the friction
/// deflection `β`: `dF/dx = (F_env − F)/β` (Fancher, Ervin, MacAdam and Winkler, SAE 800905).
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Its name.
    pub name: String,
    /// Compression of the spring, strictly increasing; only differences matter.
    pub deflection_m: Vec<f64>,
    /// Force while it is being compressed.
    pub compression_n: Vec<f64>,
    /// Force while it is being released, nowhere greater.
    pub extension_n: Vec<f64>,
    /// `β`: how far the spring moves until the force has turned from one curve to the other.
    pub friction_deflection_m: f64,
}

/// Lateral force over load as a function of slip angle and load.
///
/// Linear between the nodes and to zero at no slip; beyond the last slip angle, and below the
/// first and above the last load, the coefficient stays.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct LateralForceTable {
    /// Loads of the columns, strictly increasing.
    pub load_n: Vec<f64>,
    /// Slip angles of the rows, positive and strictly increasing.
    pub slip_rad: Vec<f64>,
    /// Lateral force over load: one row per slip angle, one column per load.
    pub coefficient: Vec<Vec<f64>>,
}

/// Aligning moment as a function of slip angle and load.
///
/// Linear between the nodes, to zero at no slip and at no load; beyond the last row and column
/// it stays.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct AligningMomentTable {
    /// Loads of the columns, strictly increasing.
    pub load_n: Vec<f64>,
    /// Slip angles of the rows, positive and strictly increasing.
    pub slip_rad: Vec<f64>,
    /// Moment that turns the wheel into its direction of travel: one row per slip angle, one
    /// column per load.
    pub moment_nm: Vec<Vec<f64>>,
}
