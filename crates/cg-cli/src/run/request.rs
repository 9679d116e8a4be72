//! The speed that `--speed-request` asks for while a turn uses too much of the rollover threshold.

use cg_core::{Design, Warner, curve_speed_mps};

use super::events::Result as Known;

/// A request ends when the turn uses this part of the share.
const ENDS: f64 = 0.9;
/// Below this speed nothing is requested.
const LEAST_MPS: f64 = 3.0;

/// The request: the greatest speed at which the present curve would use no more than a share of the
/// lower bound of the threshold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpeedRequest {
    share: f64,
    pub(crate) speed_mps: Option<f64>,
}

impl SpeedRequest {
    pub(crate) const fn new(share: f64) -> Self {
        Self { share, speed_mps: None }
    }

    /// Follows a turn by the speed and the lateral acceleration in it; returns whether a request has begun or
    /// ended.
    pub(crate) fn update(&mut self, design: &Design<f64>, known: &Known, motion: [f64; 2]) -> bool {
        let before = self.speed_mps.is_some();
        self.speed_mps = self.wanted(design, known, motion);
        self.speed_mps.is_some() != before
    }

    fn wanted(&self, design: &Design<f64>, known: &Known, motion: [f64; 2]) -> Option<f64> {
        let [speed_mps, lateral_mps2] = motion.map(f64::abs);
        let bound_g = Warner::bound_g(known.threshold_g?);
        let used = lateral_mps2 / (bound_g * design.gravity_mps2);
        let from = self.share * if self.speed_mps.is_some() { ENDS } else { 1.0 };
        if !(speed_mps > LEAST_MPS && used >= from) {
            return None;
        }
        let radius_m = speed_mps * speed_mps / lateral_mps2;
        curve_speed_mps(design, known.measured_m?, known.trailer_mass_kg, radius_m, self.share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::events::MassSource;
    use cg_core::{Combined, Height, Measured, ThresholdLine};
    use cg_vehicle::{Variant, Vehicle};

    /// A truck that tips at 0.4 g at every height, mass and speed, and its height. The standard deviation of its threshold
    /// is the same at all speeds above 25 m/s.
    fn truck() -> (Design<f64>, Known) {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
        let vehicle = Vehicle::load(file).unwrap();
        let mut design = cg_vehicle::design::design(&vehicle, Variant::Complete).unwrap();
        design.thresholds = [ThresholdLine { threshold_g: [[0.4; 8]; 2] }; 6];
        let height_m = Measured { value: 2.0, sd: 0.1 };
        let height = Height { height_m, random_sd_m: 0.05, maneuvers: 2 };
        let mass = (design.nominal_trailer_mass_kg, MassSource::Signal);
        let mut known = Known::new(Some(Combined::Agreed(height)), None, mass);
        known.at_speed(&design, 40.0);
        (design, known)
    }

    /// m/s² of a share of the threshold's lower bound.
    fn at(design: &Design<f64>, known: &Known, share: f64) -> f64 {
        share * Warner::bound_g(known.threshold_g.unwrap()) * design.gravity_mps2
    }

    /// At half the bound, the curve of 40 m/s and three quarters of it is driven at 40 m/s · √(2/3).
    #[test]
    fn the_request_is_the_speed_at_which_the_curve_keeps_the_share() {
        let (design, known) = truck();
        let mut request = SpeedRequest::new(0.5);
        for share in [0.75, -0.75] {
            request.update(&design, &known, [40.0, at(&design, &known, share)]);
            let asked_mps = request.speed_mps.unwrap();
            assert!((asked_mps - 40.0 * (2.0_f64 / 3.0).sqrt()).abs() < 1e-6, "{asked_mps}");
        }
    }

    #[test]
    fn a_request_begins_at_the_share_and_ends_below_it() {
        let (design, known) = truck();
        let mut request = SpeedRequest::new(0.5);
        for (share, changes, asks) in [
            (0.499, false, false),
            (0.501, true, true),
            (0.451, false, true),
            (0.449, true, false),
            (0.499, false, false),
        ] {
            let lateral_mps2 = at(&design, &known, share);
            assert_eq!(request.update(&design, &known, [20.0, lateral_mps2]), changes);
            assert_eq!(request.speed_mps.is_some(), asks, "{share}");
        }
    }

    #[test]
    fn nothing_is_requested_of_what_is_not_known() {
        let (design, known) = truck();
        let lateral_mps2 = 0.3 * design.gravity_mps2;
        for (known, motion) in [
            (Known::default(), [20.0, lateral_mps2]),
            (known.clone(), [2.9, lateral_mps2]),
            (known.clone(), [f64::NAN, lateral_mps2]),
            (known.clone(), [20.0, f64::NAN]),
        ] {
            let mut request = SpeedRequest::new(0.5);
            assert!(!request.update(&design, &known, motion) && request.speed_mps.is_none());
        }
    }
}
