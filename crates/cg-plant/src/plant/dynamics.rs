//! The equations of motion: rates of the state from the state and the driver's inputs.
//!
//! ```text
//!     1  poses of all axles, forces of all springs
//!     2  tractor about its sprung c.g., its axles eliminated
//!     3  trailer about the fifth wheel, its axles (and the roll of its front half, if its frame
//!        twists) eliminated; its rotation eliminated leaves an apparent 3 × 3 mass at the fifth wheel
//!     4  five equations for v1, z1, ψ1, θ1, φ1; then back-substitution to trailer and axles
//! ```
//!
//! No matrix larger than 5 × 5 is factorized. The equations are Kane's, with the constraint of the
//! fifth wheel embedded. The speed is prescribed, so its reaction does no virtual work.

use super::axle::{Axle, Eliminated, Pose, Road, group_forces};
use super::body::{Attitude, Equations, Motion, Sprung};
use super::front::Front;
use super::ground::Ground;
use super::hitch::{Coupling, Side, couple};
use super::joint::{Joint, Solution};
use super::state::{AxleCoordinate as A, Coordinate as C, MAX_AXLES, ROOM, State, at};
use super::state::{FRONT_ROLL, FRONT_ROLL_RATE};
use super::suspension::Group;
use super::tyre::Contact;
use super::vector::{Vector, add, scaled, sin_cos, turned};
use cg_vehicle::characteristics::FifthWheel;
use cg_vehicle::characteristics::Grip;
use cg_vehicle::wind::Wind;
use serde::{Deserialize, Serialize};

/// The driver's inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Control {
    /// Mean road-wheel steer angle, left positive.
    pub steer_rad: f64,
    /// Forward speed of the tractor's sprung c.g.
    pub speed_mps: f64,
    /// Rate of the speed.
    pub acceleration_mps2: f64,
    /// The road under the vehicle.
    pub ground: Ground,
    /// Velocity of the wind in the axes of the way at the start: forward, to the left.
    #[serde(default)]
    pub wind_mps: [f64; 2],
}

/// The constant parameters.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    /// Reference point: its c.g.
    pub(super) tractor: Sprung,
    /// Reference point: the fifth wheel. The rear half, if the frame twists.
    pub(super) trailer: Sprung,
    /// The front half of a trailer whose frame twists, with the same reference point.
    pub(super) front: Option<Front>,
    /// From the tractor's c.g., body axes.
    pub(super) hitch_arm: Vector,
    pub(super) hitch: FifthWheel,
    /// Apparent inertia of its angle, which makes a hard joint slower ([`YawRollPlant::slowed`](super::YawRollPlant)); zero for
    /// others.
    pub(super) hitch_inertia_kgm2: f64,
    /// The tractor's axles first.
    pub(super) axles: Vec<Axle>,
    pub(super) groups: Vec<Group>,
    pub(super) kinds: Vec<Grip>,
    pub(super) gravity_mps2: f64,
    /// Places of the accelerometers of tractor and trailer from the reference points, body axes.
    pub(super) accelerometers: [Vector; 2],
    /// The side of the trailer's body and its middle from the fifth wheel, body axes.
    pub(super) side: Option<(Wind, Vector)>,
}

/// Intermediate results of the rates, reused from one evaluation to the next to avoid clearing them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Probe {
    units: Option<[Moving; 2]>,
    front: Option<Moving>,
    /// Force on the trailer, in its yaw frame.
    pub(super) hitch_force_n: Vector,
    pub(super) hitch_moment_nm: f64,
    pub(super) contacts: [Contact; MAX_AXLES],
    eliminated: [Eliminated; MAX_AXLES],
    poses: [Pose; MAX_AXLES],
    pub(super) springs_n: [[f64; 2]; MAX_AXLES],
}

/// A body, its motion and its accelerations: reference point, then yaw, pitch, roll.
#[derive(Clone, Copy, Debug)]
struct Moving {
    motion: Motion,
    rates: [f64; 6],
}

/// Positions and inputs at one instant.
struct Instant<'a> {
    x: &'a [f64; ROOM],
    control: &'a Control,
    /// Sine and cosine of the trailer's yaw minus the tractor's.
    turn: (f64, f64),
    gravity: [Vector; 2],
}

impl Parameters {
    /// Compression of each group's springs, left and right, at rest.
    pub(super) fn compressions(&self, state: &State) -> [[f64; 2]; MAX_AXLES] {
        let mut found = [[0.0; 2]; MAX_AXLES];
        let (tractor, trailer) = attitudes(&state.x);
        let still = |attitude| Motion::new(attitude, [0.0; 3], [0.0; 3], [0.0; 3]);
        let mut poses = [Pose::default(); MAX_AXLES];
        self.pose(&state.x, &[still(tractor), still(trailer)], &mut poses);
        let stored = |_| [0.0; 2];
        group_forces(&self.groups, &self.axles, &poses, stored, |g, _, x| {
            found[g] = [x[0][0], x[1][0]];
        });
        found
    }

    #[inline]
    fn pose(&self, x: &[f64; ROOM], units: &[Motion; 2], poses: &mut [Pose; MAX_AXLES]) {
        for (i, (axle, pose)) in self.axles.iter().zip(poses).enumerate() {
            let own = [A::Rise, A::Roll, A::RiseRate, A::RollRate].map(|c| x[at(i, c)]);
            let roll = if axle.on_trailer { C::TrailerRoll } else { C::TractorRoll };
            *pose = Pose::new(own, x[roll as usize], &units[usize::from(axle.on_trailer)]);
        }
    }

    /// Rates of the state, and the intermediate results in `Probe`.
    #[inline]
    pub(super) fn rates(
        &self,
        x: &[f64; ROOM],
        control: &Control,
        rate: &mut [f64; ROOM],
        probe: &mut Probe,
    ) {
        let value = |c: C| x[c as usize];
        let turn_rad = value(C::TrailerYaw) - value(C::TractorYaw);
        let turn = sin_cos(turn_rad);
        let (tractor, trailer) = self.motions(x, control, turn);
        let hitch_rho = tractor.attitude.outward(self.hitch_arm);
        let units = [tractor, trailer];
        self.pose(x, &units, &mut probe.poses);
        let Probe { poses, springs_n, .. } = probe;
        let stored = |i| [x[at(i, A::LeftSpring)], x[at(i, A::RightSpring)]];
        group_forces(&self.groups, &self.axles, poses, stored, |g, force, x| {
            springs_n[g] = force;
            let group = &self.groups[g];
            for (side, c) in [A::LeftSpring, A::RightSpring].into_iter().enumerate() {
                let [x, x_rate] = x[side];
                rate[at(group.first_axle, c)] = group.law.rate_n_per_s(x, x_rate, force[side]);
            }
        });
        let gravity = control.ground.gravity(self.gravity_mps2, turn_rad);
        let instant = Instant { x, control, turn, gravity };
        self.solve(&instant, &units, hitch_rho, rate, probe);
    }

    #[inline]
    fn motions(&self, x: &[f64; ROOM], control: &Control, turn: (f64, f64)) -> (Motion, Motion) {
        let value = |c: C| x[c as usize];
        let (first, second) = attitudes(x);
        let (speed, side) = (control.speed_mps, value(C::LateralVelocity));
        let yaw = value(C::TractorYawRate);
        let tractor = Motion::new(
            first,
            [yaw, value(C::TractorPitchRate), value(C::TractorRollRate)],
            [speed, side, value(C::VerticalVelocity)],
            [control.acceleration_mps2 - side * yaw, speed * yaw, 0.0],
        );
        let (velocity, bias) = tractor.point(first.outward(self.hitch_arm));
        let trailer = Motion::new(
            second,
            [value(C::TrailerYawRate), value(C::TrailerPitchRate), value(C::TrailerRollRate)],
            turned(velocity, turn),
            turned(bias, turn),
        );
        (tractor, trailer)
    }

    /// The equations of one unit with its axles.
    #[inline]
    fn unit(
        &self,
        instant: &Instant<'_>,
        motion: &Motion,
        on_trailer: bool,
        height_m: f64,
        probe: &mut Probe,
    ) -> Equations {
        let mut equations = Equations::zeros();
        let sprung = if on_trailer { &self.trailer } else { &self.tractor };
        let gravity = instant.gravity[usize::from(on_trailer)];
        equations.add_sprung(motion, sprung, gravity);
        for (i, axle) in self.axles.iter().enumerate() {
            if axle.on_trailer != on_trailer {
                continue;
            }
            let road = Road {
                kinds: &self.kinds,
                reference_height_m: height_m,
                gravity,
                steer_rad: instant.control.steer_rad,
                twist_rad: instant.control.ground.twist_rad[i],
                lagged_slip_rad: instant.x[at(i, A::Slip)],
                springs_n: &probe.springs_n,
            };
            let (eliminated, contact) =
                axle.assemble(&mut equations, motion, &probe.poses[i], &road);
            probe.eliminated[i] = eliminated;
            probe.contacts[i] = contact;
        }
        equations
    }

    #[inline]
    fn solve(
        &self,
        instant: &Instant<'_>,
        units: &[Motion; 2],
        hitch_rho: Vector,
        rate: &mut [f64; ROOM],
        probe: &mut Probe,
    ) {
        let height_m = instant.x[C::TractorHeight as usize];
        let [first, second] = units;
        let mut tractor = self.unit(instant, first, false, height_m, probe);
        let mut trailer = self.unit(instant, second, true, height_m + hitch_rho[2], probe);
        let mut front = self.front(instant, second);
        let on_hitch = front.as_ref().map_or(second, |(motion, _)| motion);
        let roll_of = if front.is_some() { FRONT_ROLL } else { C::TrailerRoll as usize };
        let coupling = couple(
            &self.hitch,
            &Side::new(first, instant.x[C::TractorRoll as usize]),
            &Side::new(on_hitch, instant.x[roll_of]),
            instant.turn,
        );
        self.blow(instant, second, &mut trailer, &mut front);
        let coupled = front.as_mut().map_or(&mut trailer, |(_, own)| own);
        for i in 0..3 {
            tractor.force[3 + i] -= coupling.moment_nm * coupling.by_tractor[i];
            coupled.force[3 + i] -= coupling.moment_nm * coupling.by_trailer[i];
        }
        if let (Some(frame), Some((motion, own))) = (&self.front, &mut front) {
            let twist_rad = instant.x[FRONT_ROLL] - instant.x[C::TrailerRoll as usize];
            let frame_nm = frame.frame_nm(twist_rad, motion.rates[2] - second.rates[2]);
            own.force[5] -= frame_nm;
            trailer.force[5] += frame_nm;
            Front::eliminate(own, &mut trailer);
        }
        let arms = first.attitude.arms(hitch_rho);
        let joint = Joint::new(&tractor, &trailer, &arms, instant.turn);
        let mut solution = joint.accelerations(&tractor.force, &trailer.force);
        let own = front.as_ref().map(|(_, own)| own);
        let mut of_front =
            own.map(|own| Front::accelerations(own, own.force[5], &solution.trailer));
        let mut moment_nm = coupling.moment_nm;
        if self.hitch_inertia_kgm2 > 0.0 {
            let [more_nm, front_roll] =
                self.inert(&joint, &coupling, own, (&mut solution, of_front.as_ref()));
            moment_nm += more_nm;
            of_front = of_front.map(|found| {
                let mut all = solution.trailer;
                all[5] = found[5] + front_roll;
                all
            });
        }
        let moving = |motion: &Motion, rates| Moving { motion: *motion, rates };
        probe.units = Some([moving(first, solution.tractor), moving(second, solution.trailer)]);
        probe.front =
            front.as_ref().zip(of_front).map(|((motion, _), rates)| moving(motion, rates));
        probe.hitch_force_n = solution.hitch_force_n;
        probe.hitch_moment_nm = moment_nm;
        self.spread(instant, &solution, probe, rate);
    }

    /// Adds what the apparent inertia of the fifth wheel's angle changes. Returns its moment, and what it adds to the roll of the
    /// front half.
    #[inline]
    fn inert(
        &self,
        joint: &Joint<'_>,
        coupling: &Coupling,
        front: Option<&Equations>,
        (solution, of_front): (&mut Solution, Option<&[f64; 6]>),
    ) -> [f64; 2] {
        let Coupling { by_tractor, by_trailer, drift_radps2, .. } = coupling;
        // The accelerations that one newton meter causes.
        let (mut tractor, mut trailer) = ([0.0; 6], [0.0; 6]);
        for i in 0..3 {
            (tractor[3 + i], trailer[3 + i]) = (-by_tractor[i], -by_trailer[i]);
        }
        let own_nm = trailer[5];
        if let Some(own) = front {
            Front::pass_on(own, &mut trailer);
        }
        let response = joint.accelerations(&tractor, &trailer);
        let by_front = front.map(|own| Front::accelerations(own, own_nm, &response.trailer));
        let along = |of: &Solution, of_front: Option<&[f64; 6]>| -> f64 {
            let coupled = of_front.unwrap_or(&of.trailer);
            (0..3).map(|i| by_tractor[i] * of.tractor[3 + i] + by_trailer[i] * coupled[3 + i]).sum()
        };
        let inertia = self.hitch_inertia_kgm2;
        let angle_radps2 = (along(solution, of_front) + drift_radps2)
            / (1.0 - inertia * along(&response, by_front.as_ref()));
        let moment_nm = inertia * angle_radps2;
        solution.add(moment_nm, &response);
        [moment_nm, by_front.map_or(0.0, |by_front| moment_nm * by_front[5])]
    }

    /// Adds the force of the wind on the side of the trailer's body, half of it on each half. Still air has none.
    #[inline]
    fn blow(
        &self,
        instant: &Instant<'_>,
        rear: &Motion,
        trailer: &mut Equations,
        front: &mut Option<(Motion, Equations)>,
    ) {
        let [ahead_mps, left_mps] = instant.control.wind_mps;
        let blows = ahead_mps.abs() > 0.0 || left_mps.abs() > 0.0;
        let Some((side, middle)) = self.side.filter(|_| blows) else { return };
        let (sin, cos) = libm::sincos(instant.x[C::TrailerYaw as usize]);
        let along_mps = ahead_mps * cos + left_mps * sin - rear.velocity[0];
        let across_mps = left_mps * cos - ahead_mps * sin - rear.velocity[1];
        let force_n = side.force_n([along_mps, across_mps]);
        let share = if front.is_some() { 0.5 } else { 1.0 };
        let add = |motion: &Motion, equations: &mut Equations| {
            let rho = motion.attitude.outward(middle);
            equations.add_force(&motion.attitude, rho, [0.0, share * force_n, 0.0]);
        };
        add(rear, trailer);
        if let Some((motion, own)) = front {
            add(motion, own);
        }
    }

    /// Motion and equations of the front half, without the moments of fifth wheel and frame.
    #[inline]
    fn front(&self, instant: &Instant<'_>, rear: &Motion) -> Option<(Motion, Equations)> {
        let front = self.front.as_ref()?;
        let motion = Front::motion(instant.x, instant.x[C::TrailerPitch as usize], rear);
        let mut equations = Equations::zeros();
        equations.add_sprung(&motion, &front.half, instant.gravity[1]);
        Some((motion, equations))
    }

    /// Writes every rate.
    #[inline]
    fn spread(
        &self,
        instant: &Instant<'_>,
        solution: &Solution,
        probe: &Probe,
        rate: &mut [f64; ROOM],
    ) {
        let x = instant.x;
        rate[..7].copy_from_slice(&x[8..15]);
        let Solution { tractor, trailer, .. } = solution;
        rate[FRONT_ROLL] = x[FRONT_ROLL_RATE];
        rate[FRONT_ROLL_RATE] = probe.front.as_ref().map_or(0.0, |front| front.rates[5]);
        rate[7..12].copy_from_slice(&tractor[1..]);
        rate[12..15].copy_from_slice(&trailer[3..]);
        let (sin, cos) = libm::sincos(x[C::TractorYaw as usize]);
        let (speed, side) = (instant.control.speed_mps, x[C::LateralVelocity as usize]);
        rate[C::PositionX as usize] = speed * cos - side * sin;
        rate[C::PositionY as usize] = speed * sin + side * cos;
        for (i, axle) in self.axles.iter().enumerate() {
            let unit = if axle.on_trailer { trailer } else { tractor };
            let (rise, roll) = probe.eliminated[i].accelerations(unit);
            rate[at(i, A::Rise)] = probe.poses[i].rise_rate;
            rate[at(i, A::Roll)] = probe.poses[i].roll_rate;
            rate[at(i, A::RiseRate)] = rise;
            rate[at(i, A::RollRate)] = roll;
            rate[at(i, A::Slip)] = probe.contacts[i].slip_rate;
        }
    }

    /// Values of tractor and trailer at the last evaluation; of a trailer whose frame twists, the mean of
    /// both halves, in which the front half has a share.
    fn of_units(
        &self,
        probe: &Probe,
        share: impl Fn(&Front) -> f64,
        value: impl Fn(&Moving, usize) -> f64,
    ) -> [f64; 2] {
        let Some([tractor, trailer]) = &probe.units else { return [0.0; 2] };
        let mut found = [value(tractor, 0), value(trailer, 1)];
        if let (Some(front), Some(moving)) = (&self.front, &probe.front) {
            found[1] += share(front) * (value(moving, 1) - found[1]);
        }
        found
    }

    /// Roll angles of tractor and trailer against the true vertical at the last evaluation.
    pub(super) fn roll_to_gravity_rad(&self, probe: &Probe, gravity: &[Vector; 2]) -> [f64; 2] {
        let roll_rad = |moving: &Moving, unit: usize| {
            let up = |axis: Vector| {
                let axis = moving.motion.attitude.outward(axis);
                -(0..3).map(|i| axis[i] * gravity[unit][i]).sum::<f64>()
            };
            libm::atan2(up([0.0, 1.0, 0.0]), up([0.0, 0.0, 1.0]))
        };
        self.of_units(probe, |front| front.roll_share, roll_rad)
    }

    /// Lateral accelerations of the sprung c.g.s at the last evaluation, in the plane of the road, in
    /// each unit's heading.
    pub(super) fn lateral_mps2(&self, probe: &Probe) -> [f64; 2] {
        let Some([tractor, trailer]) = &probe.units else { return [0.0; 2] };
        let lateral = |moving: &Moving, sprung: &Sprung| moving.acceleration(sprung.cg)[1];
        let mut found = [lateral(tractor, &self.tractor), lateral(trailer, &self.trailer)];
        if let (Some(front), Some(moving)) = (&self.front, &probe.front) {
            found[1] += front.mass_share * (lateral(moving, &front.half) - found[1]);
        }
        found
    }

    /// What the accelerometers of tractor and trailer show at the last evaluation: acceleration minus
    /// gravity along the lateral axis of the body.
    pub(super) fn specific_force_mps2(&self, probe: &Probe, gravity: &[Vector; 2]) -> [f64; 2] {
        let force_mps2 = |moving: &Moving, unit: usize| {
            let felt =
                add(moving.acceleration(self.accelerometers[unit]), scaled(gravity[unit], -1.0));
            let left = moving.motion.attitude.outward([0.0, 1.0, 0.0]);
            (0..3).map(|i| felt[i] * left[i]).sum()
        };
        self.of_units(probe, |front| front.accelerometer_share, force_mps2)
    }
}

impl Moving {
    /// Acceleration of a point of the body, in the unit's yaw frame. `arm` is its place from the
    /// unit's reference point, body axes.
    fn acceleration(&self, arm: Vector) -> Vector {
        let Self { motion, rates } = self;
        let rho = motion.attitude.outward(arm);
        let arms = motion.attitude.arms(rho);
        let (_, bias) = motion.point(rho);
        [0, 1, 2].map(|i| {
            let turning: f64 = (0..3).map(|j| arms[j][i] * rates[3 + j]).sum();
            rates[i] + turning + bias[i]
        })
    }
}

/// Attitudes of both units.
#[inline]
fn attitudes(x: &[f64; ROOM]) -> (Attitude, Attitude) {
    let value = |c: C| x[c as usize];
    (
        Attitude::new(value(C::TractorPitch), value(C::TractorRoll)),
        Attitude::new(value(C::TrailerPitch), value(C::TrailerRoll)),
    )
}
