//! Measured springs in the linear model: their roll stiffness at the static load.
//!
//! A measured spring is neither linear nor free of friction. The linear model uses the describing
//! function of its two curves ([`Envelope::stiffness_n_per_m`]) at the load that it carries, and at
//! the amplitude that it has in a usual turn.

use crate::characteristics::Envelope;
use crate::tables::Spring;
use crate::vehicle::{Axle, PlacedAxle, Vehicle};

impl Vehicle {
    /// The measured spring of an axle; `None` if its springs are linear.
    pub fn spring_of(&self, axle: &Axle) -> Option<&Spring> {
        let name = axle.spring.as_ref()?;
        self.spring.iter().find(|spring| spring.name == *name)
    }

    /// Whether an axle of the trailer, or of the tractor, has measured springs.
    pub(crate) fn has_measured_springs_on(&self, trailer: bool) -> bool {
        let mut of_unit = self.axles().into_iter().filter(|placed| placed.on_trailer == trailer);
        of_unit.any(|placed| self.spring_of(placed.axle).is_some())
    }

    /// Whether an axle has measured springs.
    pub(crate) fn has_measured_springs(&self) -> bool {
        [false, true].into_iter().any(|trailer| self.has_measured_springs_on(trailer))
    }

    /// Roll stiffness between body and axle (springs and anti-roll bar, N m/rad) of an axle that carries
    /// `load_n` on the road, for rolling of an amplitude, with the friction multiplied by a factor.
    pub(crate) fn roll_stiffness(
        &self,
        placed: &PlacedAxle<'_>,
        load_n: f64,
        amplitude_rad: f64,
        friction: f64,
    ) -> f64 {
        self.with_springs(placed, load_n, amplitude_rad, |spring, load_n, amplitude_m| {
            let spring = spring.clone().with_friction(friction);
            Envelope::new(&spring).stiffness_n_per_m(
                load_n,
                amplitude_m,
                spring.friction_deflection_m,
            )
        })
    }

    /// The same without friction, if the body [neither rises nor sinks](Envelope::slope_at_rest) in a turn.
    pub(crate) fn roll_stiffness_at_rest(
        &self,
        placed: &PlacedAxle<'_>,
        load_n: f64,
        amplitude_rad: f64,
    ) -> f64 {
        self.with_springs(placed, load_n, amplitude_rad, |spring, load_n, amplitude_m| {
            Envelope::new(spring).slope_at_rest(load_n, amplitude_m)
        })
    }

    /// The roll stiffness if a measured spring has this stiffness at its load and amplitude.
    fn with_springs(
        &self,
        placed: &PlacedAxle<'_>,
        load_n: f64,
        amplitude_rad: f64,
        stiffness_n_per_m: impl FnOnce(&Spring, f64, f64) -> f64,
    ) -> f64 {
        let linear = placed.suspension_roll_stiffness_nm_per_rad();
        let Some(spring) = self.spring_of(placed.axle) else { return linear };
        let axle = placed.axle;
        let half_spread_m = 0.5 * axle.spring_spread_m;
        let load_n = self.spring_load_n(axle, load_n);
        let change = stiffness_n_per_m(spring, load_n, half_spread_m * amplitude_rad)
            - axle.spring_stiffness_n_per_m;
        linear + 2.0 * half_spread_m * half_spread_m * change
    }

    /// Moment with which the friction of an axle's springs holds the body in rolling of an amplitude (N m),
    /// and the roll angle within which it changes sides.
    pub(crate) fn roll_friction(
        &self,
        placed: &PlacedAxle<'_>,
        load_n: f64,
        amplitude_rad: f64,
    ) -> (f64, f64) {
        let Some(spring) = self.spring_of(placed.axle) else { return (0.0, 0.0) };
        let half_spread_m = 0.5 * placed.axle.spring_spread_m;
        let around = Envelope::new(spring).hysteresis(
            self.spring_load_n(placed.axle, load_n),
            half_spread_m * amplitude_rad,
            spring.friction_deflection_m,
        );
        (2.0 * half_spread_m * around.lost_n, around.deflection_m / half_spread_m)
    }

    /// The load of one spring of an axle that carries `load_n` on the road.
    fn spring_load_n(&self, axle: &Axle, load_n: f64) -> f64 {
        0.5 * (load_n - axle.unsprung_mass_kg * self.gravity_mps2)
    }
}
