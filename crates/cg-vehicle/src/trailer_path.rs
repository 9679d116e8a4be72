//! The path of the trailer from the yaw rate of the tractor.
//!
//! VDC2 has the yaw rate of the tractor. A trailer that is drawn at its axles turns with the lag `l/U`; tires that slip and
//! its inertia change that, and its c.g. is ahead of the axles. For speeds of 6 to 30 m/s and up to about 2 rad/s the linear model
//! of the truck is, to a few percent,
//!
//! ```text
//! r2/r1 or a2/(U r1) = (1 + c p)/(1 + a p + b p²),   a = a₁ V/U + a₂ + a₃ U/V,   c = c₁ V/U + c₂ + c₃ U/V
//! ```
//!
//! with `V` = 15 m/s.

use cg_core::PathLead;
use nalgebra::{Complex, DVector, Matrix2, SMatrix, SVector, Vector2};
use serde::{Deserialize, Serialize};

use crate::equations::{Equations, Variant};
use crate::error::VehicleError;
use crate::linear::Laden;
use crate::response::StateSpace;
use crate::system::{Oscillations, response_of};
use crate::vehicle::Vehicle;

/// Speeds at which it is fitted to the linear model, m/s.
const SPEEDS_MPS: [f64; 7] = [6.0, 8.0, 11.0, 15.0, 20.0, 25.0, 30.0];
/// Angular frequencies at which it is, rad/s: those of turns and lane changes.
const FREQUENCIES_RADPS: [f64; 4] = [0.3, 0.7, 1.5, 3.0];
/// Speeds between which it is used, m/s. A slower one counts as the first, a faster one as the second.
const LEAST_MPS: f64 = 2.0;
const GREATEST_MPS: f64 = 35.0;
/// `V`.
const TERMS_MPS: f64 = 15.0;
const UNKNOWNS: usize = 7;
/// Time between rows beyond which the trailer counts as moving as the tractor does, s.
const GAP_S: f64 = 0.5;

/// How the trailer of a truck follows its tractor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct TrailerPath {
    /// Yaw rate over that of the tractor.
    pub yaw: Follows,
    /// Lateral acceleration of the sprung c.g. over that of a path of the tractor, its yaw rate times the speed.
    pub acceleration: Follows,
}

/// How one motion follows another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Follows {
    /// `a₁`, `a₂`, `a₃`.
    pub lag_s: [f64; 3],
    /// `c₁`, `c₂`, `c₃`.
    pub lead_s: [f64; 3],
    /// `b`.
    pub inertia_s2: f64,
}

impl TrailerPath {
    /// That of a vehicle with its reference load.
    ///
    /// # Errors
    /// As [`Equations::new`].
    pub fn of(vehicle: &Vehicle) -> Result<Self, VehicleError> {
        let laden = Laden::new(vehicle, Variant::Complete, vehicle.reference_load())?;
        let (mut yaw, mut acceleration) = (Fit::default(), Fit::default());
        for speed_mps in SPEEDS_MPS {
            let model = Equations::of(&laden, speed_mps)?.state_space()?;
            let oscillations = Oscillations::of(&model.a, &model.b);
            for omega_radps in FREQUENCIES_RADPS {
                let state = oscillations.state_at(omega_radps)?;
                let [yaw_share, acceleration_share] = shares(&model, &state, speed_mps);
                yaw.add(speed_mps, omega_radps, yaw_share);
                acceleration.add(speed_mps, omega_radps, acceleration_share);
            }
        }
        // Without a fit whose motion decays, it follows as if it were drawn at its axles.
        let drawn = Follows::after(vehicle.trailer_wheelbase_m());
        let [yaw, acceleration] = [yaw, acceleration].map(|fit| fit.found().unwrap_or(drawn));
        Ok(Self { yaw, acceleration })
    }
}

/// The [lead](PathLead) of the lateral acceleration of a load over the trailer's own yaw rate times the speed: that of the linear
/// model at these speeds, by least squares.
///
/// # Errors
/// As [`Equations::of`].
pub(crate) fn lead(laden: &Laden, speeds_mps: &[f64]) -> Result<PathLead<f64>, VehicleError> {
    let [omega_radps, ..] = FREQUENCIES_RADPS;
    let (mut products, mut with_known) = (Matrix2::zeros(), Vector2::zeros());
    for &speed_mps in speeds_mps {
        let model = Equations::of(laden, speed_mps)?.state_space()?;
        let state = Oscillations::of(&model.a, &model.b).state_at(omega_radps)?;
        let [yaw, acceleration] = shares(&model, &state, speed_mps);
        let row = Vector2::new(1.0 / speed_mps, -speed_mps);
        products += row * row.transpose();
        with_known += row * ((acceleration / yaw).im / omega_radps);
    }
    // Of at least two speeds, so it has one solution.
    let found = products.cholesky().map_or(Vector2::zeros(), |known| known.solve(&with_known));
    Ok(PathLead { ahead_m: found.x, slip_s2_per_m: found.y })
}

/// Yaw rate and lateral acceleration of the trailer over what follows from the yaw rate of the tractor.
fn shares(model: &StateSpace, state: &DVector<Complex<f64>>, speed_mps: f64) -> [Complex<f64>; 2] {
    let of = |row, feedthrough| response_of(state, row, feedthrough);
    let tractor = of(&model.tractor_yaw_rate, 0.0);
    let acceleration = of(&model.lateral_acceleration, model.lateral_feedthrough);
    [of(&model.trailer_yaw_rate, 0.0) / tractor, acceleration / (tractor * speed_mps)]
}

/// `V/U`, 1 and `U/V`.
fn by_speed(speed_mps: f64) -> [f64; 3] {
    [TERMS_MPS / speed_mps, 1.0, speed_mps / TERMS_MPS]
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The least squares of `c p − (a p + b p²) G = G − 1`, over the frequency, to which it is proportional.
#[derive(Default)]
struct Fit {
    products: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    with_known: SVector<f64, UNKNOWNS>,
}

impl Fit {
    fn add(&mut self, speed_mps: f64, omega_radps: f64, share: Complex<f64>) {
        let (p, terms) = (Complex::new(0.0, omega_radps), by_speed(speed_mps));
        let [lag, lead] = [-p * share, p].map(|factor| terms.map(|term| factor * term));
        let row = [lag[0], lag[1], lag[2], lead[0], lead[1], lead[2], -p * p * share];
        for part in [|z: Complex<f64>| z.re, |z: Complex<f64>| z.im] {
            let row = SVector::from(row.map(|entry| part(entry) / omega_radps));
            self.products += row * row.transpose();
            self.with_known += row * (part(share - 1.0) / omega_radps);
        }
    }

    /// `None` if there is none whose motion decays.
    fn found(&self) -> Option<Follows> {
        let [a1, a2, a3, c1, c2, c3, inertia_s2] =
            self.products.cholesky()?.solve(&self.with_known).into();
        let found = Follows { lag_s: [a1, a2, a3], lead_s: [c1, c2, c3], inertia_s2 };
        found.decays().then_some(found)
    }
}

impl Follows {
    /// After a distance, without slip.
    fn after(distance_m: f64) -> Self {
        Self { lag_s: [distance_m / TERMS_MPS, 0.0, 0.0], lead_s: [0.0; 3], inertia_s2: 0.0 }
    }

    /// Whether what is left of a motion decays at every speed.
    fn decays(&self) -> bool {
        let lag_s = |speed_mps: u32| dot(&self.lag_s, &by_speed(f64::from(speed_mps)));
        // Between two of these speeds `a` changes by less than its size.
        (2..=35).all(|speed_mps| lag_s(speed_mps) > 0.0) && self.inertia_s2 > 0.0
    }
}

/// A motion that follows another one.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Followed {
    last_us: Option<u64>,
    leader: f64,
    /// The leader's motion after `1/(1 + a p + b p²)`, and its rate.
    value: f64,
    rate: f64,
}

impl Followed {
    /// The motion when that of the leader is this, by the trapezoidal rule.
    pub(crate) fn follow(
        &mut self,
        time_us: u64,
        leader: f64,
        speed_mps: f64,
        of: &Follows,
    ) -> f64 {
        let passed_s = since_s(&mut self.last_us, time_us);
        let before = std::mem::replace(&mut self.leader, leader);
        if passed_s > GAP_S {
            (self.value, self.rate) = (leader, 0.0);
        }
        let terms = by_speed(speed_mps.clamp(LEAST_MPS, GREATEST_MPS));
        let lead_s = dot(&of.lead_s, &terms);
        if passed_s > 0.0 && passed_s <= GAP_S {
            // With the means of both ends: b (v₁ − v₀)/h + a (v₁ + v₀)/2 + x₀ + h (v₁ + v₀)/4 = u.
            let half_s = passed_s / 2.0;
            let inertia_s = of.inertia_s2 / passed_s;
            let against_s = dot(&of.lag_s, &terms) / 2.0 + half_s / 2.0;
            let pull = f64::midpoint(before, leader) - self.value;
            let rate = (pull + self.rate * (inertia_s - against_s)) / (inertia_s + against_s);
            self.value += half_s * (self.rate + rate);
            self.rate = rate;
        }
        self.value + lead_s * self.rate
    }
}

/// The time since the last one, s, which is then this one; infinite before the first one.
pub(crate) fn since_s(last_us: &mut Option<u64>, time_us: u64) -> f64 {
    #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
    let seconds = |us: u64| us as f64 * 1e-6;
    let last_us = last_us.replace(time_us);
    last_us.map_or(f64::INFINITY, |last_us| seconds(time_us.saturating_sub(last_us)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::{TruckKind, template};

    fn truck() -> Vehicle {
        Vehicle::parse(&template(TruckKind::FourByTwoThreeAxle), "truck").unwrap()
    }

    impl Follows {
        fn at(&self, speed_mps: f64, omega_radps: f64) -> Complex<f64> {
            let (p, terms) = (Complex::new(0.0, omega_radps), by_speed(speed_mps));
            (p * dot(&self.lead_s, &terms) + 1.0)
                / (p * dot(&self.lag_s, &terms) + p * p * self.inertia_s2 + 1.0)
        }
    }

    /// Between the speeds at which it was fitted, at the frequency of turns.
    #[test]
    fn the_lead_is_that_of_the_model() {
        let truck = truck();
        let laden = Laden::new(&truck, Variant::Complete, truck.reference_load()).unwrap();
        let found = lead(&laden, &[6.0, 10.0, 15.0, 25.0]).unwrap();
        // What follows its path is near the axles, so the c.g. is ahead of it by less than the wheelbase.
        assert!((0.0..truck.trailer_wheelbase_m()).contains(&found.ahead_m), "{found:?}");
        for speed_mps in [8.0, 13.0, 20.0] {
            let model = Equations::of(&laden, speed_mps).unwrap().state_space().unwrap();
            let state = Oscillations::of(&model.a, &model.b).state_at(0.5).unwrap();
            let [yaw, acceleration] = shares(&model, &state, speed_mps);
            let lead_s = found.ahead_m / speed_mps - found.slip_s2_per_m * speed_mps;
            let rest = (Complex::new(1.0, 0.5 * lead_s) - acceleration / yaw).norm_sqr().sqrt();
            // The interval between two means at 25 Hz.
            assert!(rest < 0.5 * 0.04, "{speed_mps} m/s: {rest}");
        }
    }

    /// Between the speeds and frequencies at which it was fitted, what it leaves of the difference of both motions is less than a
    /// tenth, in turns and lane changes at usual speeds.
    #[test]
    fn it_follows_as_the_model_does() {
        let truck = truck();
        let path = TrailerPath::of(&truck).unwrap();
        let laden = Laden::new(&truck, Variant::Complete, truck.reference_load()).unwrap();
        for speed_mps in [10.0, 13.0, 17.0, 23.0] {
            let model = Equations::of(&laden, speed_mps).unwrap().state_space().unwrap();
            let oscillations = Oscillations::of(&model.a, &model.b);
            for omega_radps in [0.5, 1.0, 2.0] {
                let state = oscillations.state_at(omega_radps).unwrap();
                let of_model = shares(&model, &state, speed_mps);
                for (of_model, fitted) in of_model.into_iter().zip([path.yaw, path.acceleration]) {
                    let rest = (fitted.at(speed_mps, omega_radps) - of_model).norm_sqr().sqrt();
                    let difference = (of_model - 1.0).norm_sqr().sqrt();
                    assert!(difference > 0.1, "{speed_mps} {omega_radps}: {of_model}");
                    assert!(rest < 0.1 * difference, "{speed_mps} {omega_radps}: {rest}");
                }
            }
        }
    }

    /// An oscillation comes out as the transfer function says, at every rate of rows; trapezoids of 0.1 s have a tenth of a percent
    /// of error at 1 rad/s, `(ω h)²/12`.
    #[test]
    fn an_oscillation_is_followed() {
        let (follows, omega_radps, speed_mps) = (TrailerPath::of(&truck()).unwrap().yaw, 1.0, 16.0);
        for step_us in [10_000_u64, 100_000] {
            let mut followed = Followed::default();
            for k in 0..(60_000_000 / step_us) {
                #[allow(clippy::cast_precision_loss)]
                let phase = omega_radps * (k * step_us) as f64 * 1e-6;
                let of_leader = Complex::new(phase.cos(), phase.sin());
                let found = followed.follow(k * step_us, of_leader.re, speed_mps, &follows);
                let exact = (of_leader * follows.at(speed_mps, omega_radps)).re;
                // What is left of its beginning has decayed.
                let is_steady = phase > 30.0;
                assert!(!is_steady || (found - exact).abs() < 2e-3, "{phase}: {found} {exact}");
            }
        }
    }

    /// A trailer of 8 m whose axles do not slip reaches 63 % of the yaw rate of its tractor at 20 m/s after 0.4 s.
    #[test]
    fn a_drawn_trailer_turns_after_its_tractor() {
        let (mut followed, follows) = (Followed::default(), Follows::after(8.0));
        let mut follow = |time_us, leader| followed.follow(time_us, leader, 20.0, &follows);
        follow(0, 0.0);
        // The first row is the middle of the step.
        let values: Vec<f64> = (1..=40).map(|k| follow(k * 10_000, 0.1)).collect();
        let expected = 0.1 * (1.0 - (-0.395_f64 / 0.4).exp());
        assert!((values[39] - expected).abs() < 1e-5, "{}", values[39]);
        // Two values at one time, and a gap, after which it is where the tractor is.
        assert!((follow(400_000, 0.1) - values[39]).abs() < 1e-15);
        assert!((follow(10_000_000, -0.1) + 0.1).abs() < 1e-15);
    }

    /// A motion that would grow at one of the speeds is not used.
    #[test]
    fn what_does_not_decay_is_found() {
        let decaying = Follows { inertia_s2: 0.1, ..Follows::after(8.0) };
        assert!(decaying.decays());
        assert!(!Follows { inertia_s2: -0.1, ..decaying }.decays());
        // `8/U - 0.3` s is positive below 26 m/s only.
        assert!(!Follows { lag_s: [8.0 / TERMS_MPS, -0.3, 0.0], ..decaying }.decays());
        assert!(Fit::default().found().is_none());
    }
}
