//! Springs: linear, or measured curves with friction; axles of a load group share one pair.
//!
//! The compression `x` of one side counts from the static position. A measured spring moves
//! between its two curves,
//!
//! ```text
//!     dF/dt = |ẋ| (F_env(x0 + x) − F)/β      F_env: compression curve while ẋ > 0, else extension
//! ```
//!
//! (Fancher, Ervin, MacAdam and Winkler, SAE 800905, as an ordinary differential equation). This
//! dissipates energy only if `β ≤ C/k`, half the distance between the curves divided by the greater
//! slope. Where the file's β is greater, as for the inner spring in a strong turn, this limit is used
//! ([`Envelope::force_rate`]).

use cg_vehicle::characteristics::Envelope;
use cg_vehicle::error::VehicleError;
use cg_vehicle::tables::Spring;

/// Force law of a pair of springs.
#[derive(Clone, Debug)]
pub(super) enum Law {
    Linear { preload_n: f64, stiffness_n_per_m: f64 },
    Measured { envelope: Envelope, start_m: f64, friction_deflection_m: f64 },
}

impl Law {
    /// A measured spring that carries `load_n` in its static position.
    ///
    /// # Errors
    /// If its curves do not rise there, or have no friction between them.
    pub(super) fn measured(spring: &Spring, load_n: f64) -> Result<Self, VehicleError> {
        let envelope = Envelope::new(spring);
        let start_m = envelope.deflection_at(load_n);
        if !(envelope.steepest(start_m) > 0.0 && envelope.friction_n(start_m) > 0.0) {
            return Err(VehicleError::Model(format!(
                "spring \"{}\": at its static load of {load_n:.0} N its curves must rise and have \
                 friction between them (compression_n above extension_n); a spring without \
                 friction is given by the axle's spring_stiffness_n_per_m alone",
                spring.name
            )));
        }
        let friction_deflection_m = spring.friction_deflection_m;
        Ok(Self::Measured { envelope, start_m, friction_deflection_m })
    }

    /// Force at compression `x`; `stored_n` is the state of a measured spring.
    #[inline]
    pub(super) fn force_n(&self, x: f64, stored_n: f64) -> f64 {
        match self {
            Self::Linear { preload_n, stiffness_n_per_m } => preload_n + stiffness_n_per_m * x,
            Self::Measured { .. } => stored_n,
        }
    }

    /// Rate of the stored force.
    #[inline]
    pub(super) fn rate_n_per_s(&self, x: f64, rate: f64, stored_n: f64) -> f64 {
        match self {
            Self::Linear { .. } => 0.0,
            Self::Measured { envelope, start_m, friction_deflection_m } => {
                envelope.force_rate(start_m + x, rate, stored_n, *friction_deflection_m)
            }
        }
    }

    /// Force at rest: midway between the curves.
    pub(super) fn resting_n(&self, x: f64) -> f64 {
        match self {
            Self::Linear { .. } => self.force_n(x, 0.0),
            Self::Measured { envelope, start_m, .. } => envelope.middle(start_m + x).0,
        }
    }
}

/// Axles that ideally share one pair of springs (walking beam, four-spring tandem).
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) law: Law,
    /// The axle whose state holds the forces.
    pub(super) first_axle: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spring(friction_deflection_m: f64) -> Spring {
        Spring {
            name: "leaf".to_owned(),
            deflection_m: vec![0.0, 0.01, 0.03, 0.06],
            compression_n: vec![1000.0, 5000.0, 15000.0, 45000.0],
            extension_n: vec![0.0, 3000.0, 11000.0, 36000.0],
            friction_deflection_m,
        }
    }

    /// Work of the friction over a cycle, force at both ends of it.
    fn cycle(law: &Law, from: f64, to: f64) -> (f64, f64, f64) {
        let steps = 200_000;
        let mut force = law.resting_n(from);
        let mut work = 0.0;
        let mut ends = (0.0, 0.0);
        for half in 0..4 {
            let (a, b) = if half % 2 == 0 { (from, to) } else { (to, from) };
            let dx = (b - a) / f64::from(steps);
            for k in 0..steps {
                let x = a + dx * f64::from(k);
                let middle = force + 0.5 * law.rate_n_per_s(x, dx, force);
                force += law.rate_n_per_s(x + 0.5 * dx, dx, middle);
                if half >= 2 {
                    work += middle * dx;
                }
            }
            if half == 2 { ends.0 = force } else { ends.1 = force }
        }
        (work, ends.0, ends.1)
    }

    #[test]
    fn little_friction_deflection_reproduces_the_curves() {
        let law = Law::measured(&spring(1e-5), 8000.0).unwrap();
        let Law::Measured { start_m, .. } = law else { panic!("measured") };
        let (_, up, down) = cycle(&law, 0.002 - start_m, 0.05 - start_m);
        // The lag behind the curve is slope times β = 1e6 N/m · 1e-5 m.
        assert!((up - 35_000.0).abs() < 10.1, "{up}");
        assert!((down - 600.0).abs() < 10.1, "{down}");
    }

    #[test]
    fn a_cycle_takes_energy_out() {
        let law = Law::measured(&spring(0.001), 8000.0).unwrap();
        let (work, ..) = cycle(&law, -0.003, 0.003);
        // At most the area between the curves: 2 · 1625 N · 6 mm.
        assert!(work > 0.0 && work < 2.0 * 1625.0 * 0.006 * 1.1, "{work}");
    }

    /// 2.5 mm are possible at 8000 N (2.9 mm), where the spring rests, but not when it is nearly unloaded: half the
    /// distance between the curves is there 600 to 800 N, and the slope 4e5 N/m. 20 mm are possible nowhere.
    #[test]
    fn friction_never_feeds_energy_in() {
        for deflection_m in [0.0025, 0.02] {
            let law = Law::measured(&spring(deflection_m), 8000.0).unwrap();
            let Law::Measured { start_m, .. } = law else { panic!("measured") };
            for from_m in [0.002, 0.012, 0.035, 0.055] {
                let (work, ..) = cycle(&law, from_m - start_m, from_m + 0.004 - start_m);
                assert!(work > 0.0, "{deflection_m} {from_m}: {work}");
            }
        }
    }

    #[test]
    fn curves_without_friction_are_an_error() {
        let mut frictionless = spring(0.001);
        frictionless.extension_n.clone_from(&frictionless.compression_n);
        let error = Law::measured(&frictionless, 8000.0).unwrap_err().to_string();
        assert!(error.contains("friction between them"), "{error}");
    }

    #[test]
    fn the_static_position_carries_the_load() {
        for load_n in [400.0, 8000.0, 60_000.0] {
            let law = Law::measured(&spring(1e-5), load_n).unwrap();
            assert!((law.resting_n(0.0) - load_n).abs() < 1e-9);
        }
    }
}
