//! A state of a steady turn.

use super::yaw_plane::{Drift, Sides};

/// A state: the lateral acceleration (g), the roll angles of the units and of the axles, the loads, and
/// the solution of the yaw plane.
#[derive(Clone)]
pub(super) struct Point {
    /// Roll angle of the trailer, or of its rear half if its frame twists.
    pub(super) roll_rad: f64,
    pub(super) alpha: f64,
    pub(super) tractor_rad: f64,
    /// Roll angle of the trailer's front half, if its frame twists.
    pub(super) front_rad: f64,
    pub(super) axles_rad: Vec<f64>,
    pub(super) axle_load_n: Vec<f64>,
    /// How far the body has risen at each axle, and the load that its links have moved to it from the axles that share its
    /// springs.
    pub(super) risen_m: Vec<f64>,
    pub(super) linked_n: Vec<f64>,
    pub(super) hitch_load_n: f64,
    pub(super) sides: Sides,
    pub(super) drift: Drift,
    /// The tires cannot hold the vehicle, which slides before it tips.
    pub(super) slides: bool,
}

impl Point {
    /// The load of an axle.
    pub(super) fn load_n(&self, i: usize) -> f64 {
        self.axle_load_n[i] + self.linked_n[i]
    }
}
