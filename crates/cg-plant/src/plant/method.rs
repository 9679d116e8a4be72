//! Which method integrates the plant, with which step.

use cg_vehicle::error::VehicleError;

/// The integration method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    Adams,
    RungeKutta,
}

/// An interval that has a whole number of steps, so that logs at 50 and 100 Hz have equal steps.
const WHOLE_S: f64 = 0.01;
/// Most steps in that interval. A vehicle that needs more has a mistake in its file.
const MOST_STEPS: f64 = 20.0;

/// The fastest motion of a vehicle as each method feels it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fastest {
    pub(super) radps: f64,
    /// The same, and more for a motion with hardly any damping.
    adams_radps: f64,
}

impl Fastest {
    /// Adams lets a motion without damping grow by `0.15 z⁶` per step, where `z` is the product of pole and step; a damping ratio `ζ`
    /// takes away `ζ z`. At 0.2 five minutes make it four times as great, and such motions (of axles that share their load) begin
    /// with rounding.
    pub(super) fn of(poles: &[(f64, f64)]) -> Self {
        let mut fastest = Self { radps: 0.0, adams_radps: 0.0 };
        for (re, im) in poles {
            let radps = libm::hypot(*re, *im);
            let damping_ratio = (-re / radps).max(0.0);
            let reach = libm::pow(damping_ratio / 0.15, 0.2).clamp(0.2, Method::ADAMS);
            fastest.radps = fastest.radps.max(radps);
            fastest.adams_radps = fastest.adams_radps.max(radps * Method::ADAMS / reach);
        }
        fastest
    }
}

impl Method {
    /// Product of pole and step up to which each method is stable, with a margin. The stability limits
    /// are 1.2 along the negative axis and 0.95 at a damping ratio of 0.2 for Adams-Bashforth-Moulton (evaluated again after the
    /// correction), and 2.8 along both axes for Runge-Kutta.
    const ADAMS: f64 = 0.6;
    const RUNGE_KUTTA: f64 = 2.5;

    /// Evaluations per step.
    fn per_step(self) -> f64 {
        match self {
            Self::Adams => 2.0,
            Self::RungeKutta => 4.0,
        }
    }

    fn limit(self) -> f64 {
        match self {
            Self::Adams => Self::ADAMS,
            Self::RungeKutta => Self::RUNGE_KUTTA,
        }
    }

    /// The number of stable steps in [`WHOLE_S`].
    fn steps(self, fastest: Fastest, longest_s: f64) -> f64 {
        let fastest_radps = match self {
            Self::Adams => fastest.adams_radps,
            Self::RungeKutta => fastest.radps,
        };
        let least = (WHOLE_S * fastest_radps / self.limit()).ceil();
        // Rounding must not add a step.
        (WHOLE_S / longest_s - 1e-9).ceil().max(least)
    }

    /// The method that takes fewer evaluations.
    fn of(fastest: Fastest, longest_s: f64) -> Self {
        let count = |method: Self| method.steps(fastest, longest_s) * method.per_step();
        if count(Self::Adams) <= count(Self::RungeKutta) { Self::Adams } else { Self::RungeKutta }
    }

    /// Number of evaluations in [`WHOLE_S`].
    pub(super) fn evaluations(fastest: Fastest, longest_s: f64) -> f64 {
        let method = Self::of(fastest, longest_s);
        method.steps(fastest, longest_s) * method.per_step()
    }

    /// The method that takes fewer evaluations, and its longest step that is stable and not longer than `longest_s`.
    ///
    /// # Errors
    /// [`VehicleError`] if the motion is too fast for any step.
    pub(super) fn for_mode(fastest: Fastest, longest_s: f64) -> Result<(Self, f64), VehicleError> {
        let method = Self::of(fastest, longest_s);
        let fastest_radps = fastest.radps;
        if !(WHOLE_S * fastest_radps / Self::RUNGE_KUTTA <= MOST_STEPS) {
            return Err(VehicleError::Model(format!(
                "the vehicle's fastest motion of {fastest_radps:.0} rad/s cannot be integrated with \
                 steps of {} s: look for a stiffness or damping that is too high",
                WHOLE_S / MOST_STEPS
            )));
        }
        Ok((method, WHOLE_S / method.steps(fastest, longest_s)))
    }

    /// The fastest motion that [`Method::Adams`] follows with steps of this length, with a margin for what a load changes.
    pub(super) fn followed_radps(step_s: f64) -> f64 {
        0.95 * Self::ADAMS / step_s
    }

    /// Speed below which steps of this length are too long: tires hold the axles against lateral motion as a damper does whose
    /// strength is inversely proportional to the speed. `fastest_radps` is the fastest motion at a speed at which it is the tires'.
    pub(super) fn slow_mps(self, step_s: f64, fastest_radps: f64, speed_mps: f64) -> f64 {
        speed_mps * fastest_radps * step_s / self.limit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With a damping ratio that does not matter.
    fn damped(radps: f64) -> Fastest {
        Fastest { radps, adams_radps: radps }
    }

    #[test]
    fn the_method_with_fewer_evaluations_has_its_longest_stable_step() {
        for (fastest_radps, longest_s, method, step_s) in [
            (100.0, 2e-3, Method::Adams, 2e-3),
            (301.0, 2e-3, Method::Adams, 0.01 / 6.0),
            (599.0, 2e-3, Method::Adams, 1e-3),
            (601.0, 2e-3, Method::RungeKutta, 2e-3),
            (1249.0, 2e-3, Method::RungeKutta, 2e-3),
            (1251.0, 2e-3, Method::RungeKutta, 0.01 / 6.0),
            (1561.0, 2e-3, Method::RungeKutta, 0.01 / 7.0),
            (1561.0, 2.5e-4, Method::Adams, 2.5e-4),
            (100.0, 4e-3, Method::Adams, 0.01 / 3.0),
        ] {
            let (chosen, taken_s) = Method::for_mode(damped(fastest_radps), longest_s).unwrap();
            assert_eq!(chosen, method, "{fastest_radps}");
            assert!((taken_s - step_s).abs() < 1e-15, "{fastest_radps}: {taken_s}");
        }
    }

    #[test]
    fn a_motion_that_is_too_fast_is_an_error() {
        assert!(Method::for_mode(damped(4999.0), 2e-3).is_ok());
        let error = Method::for_mode(damped(5001.0), 2e-3).unwrap_err().to_string();
        assert!(
            error.contains("5001 rad/s cannot be integrated with steps of 0.0005 s"),
            "{error}"
        );
        assert!(Method::for_mode(damped(f64::NAN), 2e-3).is_err());
    }

    /// Amplitude of an oscillation of one radian per second after many steps of Adams, begun with its true past.
    fn amplitude(damping_ratio: f64, step_s: f64, steps: u32) -> f64 {
        let rates =
            |[x, v]: [f64; 2]| [v, -x - 2.0 * damping_ratio * v].map(|rate| rate * step_s / 24.0);
        let at = |k: f64| [(k * step_s).cos(), -(k * step_s).sin()];
        let mut past = [0.0, -1.0, -2.0, -3.0].map(|k| rates(at(k)));
        let mut now = at(0.0);
        for _ in 0..steps {
            let [zero, one, two, three] = past;
            let ahead = [0, 1]
                .map(|i| now[i] + 55.0 * zero[i] - 59.0 * one[i] + 37.0 * two[i] - 9.0 * three[i]);
            let found = rates(ahead);
            now = [0, 1].map(|i| now[i] + 9.0 * found[i] + 19.0 * zero[i] - 5.0 * one[i] + two[i]);
            past = [rates(now), zero, one, two];
        }
        now[0].hypot(now[1])
    }

    /// A motion with little damping gets the step at which it does not grow, or slowly; with the step of a damped one it would.
    #[test]
    fn a_motion_without_damping_hardly_grows() {
        for damping_ratio in [0.0_f64, 1e-3, 0.01, 0.2] {
            let pole = (-damping_ratio, (1.0 - damping_ratio * damping_ratio).sqrt());
            let fastest = Fastest::of(&[pole]);
            assert!((fastest.radps - 1.0).abs() < 1e-12);
            // Without damping, by 100 000 · 0.15 · 0.2⁶ in the logarithm.
            let most = if damping_ratio > 0.0 { 1.0 } else { 0.96_f64.exp() };
            let step_s = Method::ADAMS / fastest.adams_radps;
            assert!(amplitude(damping_ratio, step_s, 100_000) < 1.05 * most, "{damping_ratio}");
            let grows = amplitude(damping_ratio, Method::ADAMS, 10_000) > 10.0;
            assert_eq!(grows, damping_ratio < 0.01, "{damping_ratio}");
        }
    }
}
