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

impl Method {
    /// Product of pole and step up to which each method is stable, with a margin. The stability limits
    /// are 1.2 along both axes for Adams-Bashforth-Moulton (evaluated again after the correction) and
    /// 2.8 for Runge-Kutta.
    const ADAMS: f64 = 0.6;
    const RUNGE_KUTTA: f64 = 2.5;

    /// The longest step that is stable and not longer than `longest_s`, and its method. Where Adams
    /// would need a shorter step than this, Runge-Kutta has fewer evaluations in spite of its four per
    /// step.
    pub(super) fn for_mode(
        fastest_radps: f64,
        longest_s: f64,
    ) -> Result<(Self, f64), VehicleError> {
        let least_steps = (WHOLE_S * fastest_radps / Self::RUNGE_KUTTA).ceil();
        if !(least_steps <= MOST_STEPS) {
            return Err(VehicleError::Model(format!(
                "the vehicle's fastest motion of {fastest_radps:.0} rad/s cannot be integrated with \
                 steps of {} s: look for a stiffness or damping that is too high",
                WHOLE_S / MOST_STEPS
            )));
        }
        // Rounding must not add a step.
        let step_s = WHOLE_S / (WHOLE_S / longest_s - 1e-9).ceil().max(least_steps);
        let adams = fastest_radps * step_s <= Self::ADAMS;
        Ok((if adams { Self::Adams } else { Self::RungeKutta }, step_s))
    }

    /// Speed below which steps of this length are too long: tires hold the axles against lateral motion as a damper does whose
    /// strength is inversely proportional to the speed. `fastest_radps` is the fastest motion at a speed at which it is the tires'.
    pub(super) fn slow_mps(self, step_s: f64, fastest_radps: f64, speed_mps: f64) -> f64 {
        let greatest = match self {
            Self::Adams => Self::ADAMS,
            Self::RungeKutta => Self::RUNGE_KUTTA,
        };
        speed_mps * fastest_radps * step_s / greatest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_stable_step_is_taken() {
        for (fastest_radps, longest_s, method, step_s) in [
            (100.0, 2e-3, Method::Adams, 2e-3),
            (301.0, 2e-3, Method::RungeKutta, 2e-3),
            (1249.0, 2e-3, Method::RungeKutta, 2e-3),
            (1251.0, 2e-3, Method::RungeKutta, 0.01 / 6.0),
            (1561.0, 2e-3, Method::RungeKutta, 0.01 / 7.0),
            (1561.0, 2.5e-4, Method::Adams, 2.5e-4),
            (100.0, 4e-3, Method::Adams, 0.01 / 3.0),
        ] {
            let (chosen, taken_s) = Method::for_mode(fastest_radps, longest_s).unwrap();
            assert_eq!(chosen, method, "{fastest_radps}");
            assert!((taken_s - step_s).abs() < 1e-15, "{fastest_radps}: {taken_s}");
        }
    }

    #[test]
    fn a_motion_that_is_too_fast_is_an_error() {
        assert!(Method::for_mode(4999.0, 2e-3).is_ok());
        let error = Method::for_mode(5001.0, 2e-3).unwrap_err().to_string();
        assert!(
            error.contains("5001 rad/s cannot be integrated with steps of 0.0005 s"),
            "{error}"
        );
        assert!(Method::for_mode(f64::NAN, 2e-3).is_err());
    }
}
