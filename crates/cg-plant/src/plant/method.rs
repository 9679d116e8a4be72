//! Which method integrates the plant.

use cg_vehicle::error::VehicleError;

/// The integration method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    Adams,
    RungeKutta,
}

impl Method {
    /// Product of pole and step up to which each method is stable, with a margin. The stability limits
    /// are 1.2 along both axes for Adams-Bashforth-Moulton (evaluated again after the correction) and
    /// 2.8 for Runge-Kutta.
    const ADAMS: f64 = 0.6;
    const RUNGE_KUTTA: f64 = 2.5;

    /// Whether a method is stable with this step.
    pub(super) fn is_stable(fastest_radps: f64, step_s: f64) -> bool {
        fastest_radps * step_s <= Self::RUNGE_KUTTA
    }

    pub(super) fn for_mode(fastest_radps: f64, step_s: f64) -> Result<Self, VehicleError> {
        match fastest_radps * step_s {
            reach if reach <= Self::ADAMS => Ok(Self::Adams),
            reach if reach <= Self::RUNGE_KUTTA => Ok(Self::RungeKutta),
            _ => Err(VehicleError::Model(format!(
                "a step of {step_s} s is too long for the vehicle's fastest motion of \
                 {fastest_radps:.0} rad/s: take {:.1e} s or less, or look for a stiffness or \
                 damping that is too high",
                Self::RUNGE_KUTTA / fastest_radps
            ))),
        }
    }
}
