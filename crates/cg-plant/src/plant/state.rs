//! The state vector: one flat array, so that the integrator is a loop.
//!
//! ```text
//!     bodies   z1 ψ1 θ1 φ1 ψ2 θ2 φ2 | v1 ż1 ψ̇1 θ̇1 φ̇1 ψ̇2 θ̇2 φ̇2 | X1 Y1 | φf φ̇f
//!     axle i   s φu | ṡ φ̇u | lagged slip | spring force left, right (first axle of a group)
//! ```
//!
//! The trailer's position is not a state: it follows from the fifth wheel. `φf` is the roll of the front
//! half of a trailer whose frame twists, and zero for a rigid one.

/// The greatest number of axles.
pub const MAX_AXLES: usize = 8;

/// States per axle.
const PER_AXLE: usize = 7;
/// Roll angle of the trailer's front half, and its rate.
pub(super) const FRONT_ROLL: usize = 17;
pub(super) const FRONT_ROLL_RATE: usize = 18;
const BODIES: usize = 19;
/// Size of the state vector.
pub(super) const ROOM: usize = BODIES + PER_AXLE * MAX_AXLES;

/// A state of the two sprung masses. ISO 8855 signs: yaw to the left, pitch nose down, roll
/// right side down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// Height of the tractor's sprung c.g. above the road, m.
    TractorHeight,
    /// Yaw angle of the tractor, rad.
    TractorYaw,
    /// Pitch angle of the tractor, rad.
    TractorPitch,
    /// Roll angle of the tractor, rad.
    TractorRoll,
    /// Yaw angle of the trailer, rad.
    TrailerYaw,
    /// Pitch angle of the trailer, rad.
    TrailerPitch,
    /// Roll angle of the trailer (of its rear half, if its frame twists), rad.
    TrailerRoll,
    /// Lateral velocity of the tractor's sprung c.g., horizontal, in the tractor's heading, m/s.
    LateralVelocity,
    /// Vertical velocity of the tractor's sprung c.g., m/s.
    VerticalVelocity,
    /// Yaw rate of the tractor, rad/s.
    TractorYawRate,
    /// Pitch rate of the tractor, rad/s.
    TractorPitchRate,
    /// Roll rate of the tractor, rad/s.
    TractorRollRate,
    /// Yaw rate of the trailer, rad/s.
    TrailerYawRate,
    /// Pitch rate of the trailer, rad/s.
    TrailerPitchRate,
    /// Roll rate of the trailer (of its rear half, if its frame twists), rad/s.
    TrailerRollRate,
    /// Position of the tractor's sprung c.g. along the initial heading, m.
    PositionX,
    /// The same to the left of it, m.
    PositionY,
}

/// A state of an axle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxleCoordinate {
    /// Distance from the axle's center up to the roll center, along the axle's own vertical, m.
    Rise,
    /// Roll angle of the axle, absolute, rad.
    Roll,
    /// Rate of the rise, m/s.
    RiseRate,
    /// Roll rate of the axle, rad/s.
    RollRate,
    /// Lagged slip angle, rad.
    Slip,
    /// Force of the left spring of a group (first axle of the group; measured springs only), N.
    LeftSpring,
    /// The same on the right, N.
    RightSpring,
}

/// The state of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    pub(super) x: [f64; ROOM],
    axles: usize,
}

impl State {
    pub(super) fn zeros(axles: usize) -> Self {
        Self { x: [0.0; ROOM], axles }
    }

    /// Number of entries in use.
    pub(super) fn len(&self) -> usize {
        BODIES + PER_AXLE * self.axles
    }

    /// A state of the sprung masses.
    pub fn get(&self, coordinate: Coordinate) -> f64 {
        self.x[coordinate as usize]
    }

    /// Changes a state of the sprung masses.
    pub fn set(&mut self, coordinate: Coordinate, value: f64) {
        self.x[coordinate as usize] = value;
    }

    /// A state of axle `axle` (tractor first; zero if there is no such axle).
    pub fn axle(&self, axle: usize, coordinate: AxleCoordinate) -> f64 {
        if axle < self.axles { self.x[at(axle, coordinate)] } else { 0.0 }
    }

    pub(super) fn set_axle(&mut self, axle: usize, coordinate: AxleCoordinate, value: f64) {
        self.x[at(axle, coordinate)] = value;
    }
}

/// Index of an axle's state.
#[inline]
pub(super) fn at(axle: usize, coordinate: AxleCoordinate) -> usize {
    BODIES + PER_AXLE * axle + coordinate as usize
}
