//! Judges a maneuver: whether the ratios of its channels can be true, and which heights follow.

use core::array::from_fn;

use crate::decide::consistency::Inconsistency;
use crate::decide::maneuver::{Outcome, Reject};
use crate::decide::road::Road;
use crate::decide::settings::Settings;
use crate::decide::window::Window;
use crate::identify::identifier::{Answer, Fit};
use crate::math::real::Real;
use crate::truck::channel::Channel;
use crate::truck::design::{Design, Spread};
use crate::truck::ratio::{HeightError, Measured, RatioLine, solve_height};

/// Number of standard deviations that chance exceeds with a probability of 1 %.
const ONCE_IN_A_HUNDRED: f64 = 2.576;
/// Number of standard deviations that chance exceeds with a probability of 0.1 %.
const ONCE_IN_A_THOUSAND: f64 = 3.29;
/// Roll angle of a laden trailer at 1 g, used if the design does not have the channel from lateral
/// acceleration to roll angle. It is at the lower end, so that the bank counts for more.
const LEAST_ROLL_RAD_PER_G: f64 = 0.1;

/// Greatest relative standard deviation of a ratio by articulation. Turns that are tighter are left out.
const MOST_TURNED: f64 = 0.08;

/// What is known about a maneuver that ends.
pub(crate) struct Judge<'a, T, const C: usize> {
    design: &'a Design<T, C>,
    settings: &'a Settings<T>,
    window: &'a Window<T, C>,
    spread: Option<Spread<T, C>>,
    road: Road<T>,
}

impl<'a, T: Real, const C: usize> Judge<'a, T, C> {
    /// `bank_free` tells whether the truck has a channel that does not feel the bank of the road.
    pub(crate) fn new(
        design: &'a Design<T, C>,
        settings: &'a Settings<T>,
        window: &'a Window<T, C>,
        bank_free: bool,
    ) -> Self {
        let (speed_mps, mass_kg) = (window.speed_mps, window.trailer_mass_kg);
        let gravity_mps2 = design.gravity_mps2;
        let roll = design.line(Channel::LateralAcceleration, speed_mps, mass_kg);
        let on_road = window.to_gravity || bank_free;
        let road = Road {
            bank_sd_rad: if on_road { settings.bank_sd_rad } else { settings.bank_sd_to_road_rad },
            lateral_g: window.lateral_mps2() / gravity_mps2,
            roll_rad_per_g: roll.map_or(T::of(LEAST_ROLL_RAD_PER_G), |line| {
                line.ratio_at(design.reference_height_m) * gravity_mps2
            }),
            to_gravity: window.to_gravity,
            by_yaw_rate: window.by_yaw_rate,
            unsteady_square: window.unsteady_square(),
            articulation_rad: design.trailer_wheelbase_m * window.lateral_mps2()
                / (speed_mps * speed_mps),
        };
        Self { design, settings, window, spread: design.spread(speed_mps, mass_kg), road }
    }

    /// The result of the channel at this place of the design, and whether its ratio is
    /// [far](Self::is_far) from what this trailer can have; `None` if this was not judged.
    /// `answer` is the result of the identifier if the channel had signals, `input_noise_rad2_s` the
    /// noise of the inputs with which its roll angle is compared.
    pub(crate) fn outcome(
        &self,
        place: usize,
        answer: Option<Answer<T>>,
        input_noise_rad2_s: T,
    ) -> (Outcome<T>, Option<bool>) {
        let (speed_mps, trailer_mass_kg) = (self.window.speed_mps, self.window.trailer_mass_kg);
        let rejected = |fit, reject| (Outcome::rejected(fit, reject), None);
        let known = self.design.channel(place).and_then(|channel| {
            let line = self.design.line(channel, speed_mps, trailer_mass_kg)?;
            Some((channel, line, self.spread.as_ref()?))
        });
        let Some((channel, line, spread)) = known else {
            return rejected(None, Reject::OutsideDesign { speed_mps, trailer_mass_kg });
        };
        let mut fit = match answer {
            None => return rejected(None, Reject::Absent),
            Some(Answer::Unexcited(reason)) => return rejected(None, Reject::Unexcited(reason)),
            Some(Answer::Ready(fit)) => fit,
        };
        let compensation = self.design.compensation(channel);
        let expected = line.ratio_at(self.design.reference_height_m) * compensation;
        let square = |x: T| x * x;
        let watch = self.window.watch(self.design.first_with_output(place));
        let steps = watch.map_or(T::zero(), |watch| watch.step_share(fit.noise_sd_rad));
        let ratio_sd = (square(fit.ratio.sd) + square(steps)).root();
        let ratio_sd_relative = (ratio_sd / fit.ratio.value).abs();
        fit.ratio.sd = ratio_sd_relative * fit.ratio.value.abs();
        (fit.ratio.value, fit.ratio.sd) = (fit.ratio.value * expected, fit.ratio.sd * expected);
        let road_sd_relative = self.road.sd_relative(channel);
        if !(road_sd_relative <= self.settings.road_sd_relative) {
            return rejected(Some(fit), Reject::Road { ratio_sd_relative: road_sd_relative });
        }
        let articulation = self.design.articulation(channel);
        let turned = self.road.articulated_sd(channel, &articulation);
        if !(ratio_sd_relative <= self.settings.ratio_sd_relative && turned < T::of(MOST_TURNED)) {
            let ratio_sd_relative = ratio_sd_relative.max(turned);
            return rejected(Some(fit), Reject::Imprecise { ratio_sd_relative });
        }
        if let Some(reason) = self.inconsistency(&fit, place, input_noise_rad2_s) {
            return rejected(Some(fit), Reject::Inconsistent(reason));
        }
        let [common_road, own_road] =
            self.road.parts(channel, &articulation, expected, self.design.gravity_mps2);
        let model_sd = (square(spread.sd(place)) + square(common_road)).root();
        let far_sd = (square(ratio_sd_relative) + square(model_sd) + square(own_road)).root();
        let turned = self.road.articulated(channel, &articulation);
        let compensation = Measured::exact(compensation * turned);
        let far = self.is_far(&line, fit.ratio.value / compensation.value, far_sd);
        let exact = Measured::exact(fit.ratio.value);
        let height = solve_height(&line, fit.ratio, compensation, own_road);
        let systematic = solve_height(&line, exact, compensation, model_sd);
        let road = solve_height(&line, exact, compensation, road_sd_relative);
        let outcome = match (height, systematic, road) {
            (Ok(height), Ok(systematic), Ok(road)) if self.is_possible(height.value) => Outcome {
                fit: Some(fit),
                height_m: Ok(height),
                systematic_sd_m: systematic.sd,
                road_sd_m: road.sd,
            },
            (Ok(Measured { value: height_m, .. }), ..) => {
                Outcome::rejected(Some(fit), Reject::Height(HeightError::OutOfRange { height_m }))
            }
            (Err(error), ..) => Outcome::rejected(Some(fit), Reject::Height(error)),
        };
        (outcome, Some(far))
    }

    /// Correlations of the systematic errors: those of the model, and the bank of the road, which
    /// is the same for all channels that feel it. Twist and articulation are of one channel.
    pub(crate) fn correlation(&self) -> [[T; C]; C] {
        let mut correlation = [[T::one(); C]; C];
        let Some(spread) = &self.spread else { return correlation };
        let road: [T; C] = from_fn(|place| self.common_road(place).unwrap_or(T::zero()));
        for (i, row) in correlation.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let (a, b) = (spread.sd(i), spread.sd(j));
                let scale = (a * a + road[i] * road[i]) * (b * b + road[j] * road[j]);
                let banked = self.design.feels_bank(i) && self.design.feels_bank(j);
                let common = if banked { road[i] * road[j] } else { T::zero() };
                let common = spread.correlation(i, j) * a * b + common;
                if i != j && scale > T::zero() {
                    *entry = (common / scale.root()).max(-T::one()).min(T::one());
                }
            }
        }
        correlation
    }

    /// Relative standard deviation of the ratio of the channel at this place that the road causes in
    /// all curves alike.
    fn common_road(&self, place: usize) -> Option<T> {
        let channel = self.design.channel(place)?;
        let line = self.design.line(channel, self.window.speed_mps, self.window.trailer_mass_kg)?;
        let ratio =
            line.ratio_at(self.design.reference_height_m) * self.design.compensation(channel);
        let articulation = self.design.articulation(channel);
        let [common, _] = self.road.parts(channel, &articulation, ratio, self.design.gravity_mps2);
        Some(common)
    }

    /// The reason why the roll angle cannot be true, if there is one.
    fn inconsistency(
        &self,
        fit: &Fit<T>,
        place: usize,
        input_noise_rad2_s: T,
    ) -> Option<Inconsistency<T>> {
        let Settings { standstill, misfit, bend, .. } = *self.settings;
        let watch = self.window.watch(self.design.first_with_output(place));
        if let Some(stood) =
            watch.and_then(|watch| watch.standstill(standstill, input_noise_rad2_s))
        {
            return Some(stood);
        }
        if !(fit.misfit <= misfit) {
            return Some(Inconsistency::Misfit { share: fit.misfit });
        }
        // A positive bend is not used, because a delayed sensor has the same effect.
        let short = -fit.bend.value;
        (short > bend && short > T::of(ONCE_IN_A_THOUSAND) * fit.bend.sd)
            .then_some(Inconsistency::Bent { share: short })
    }

    /// Whether a ratio is outside the range of all heights that this trailer can have, by more than
    /// its relative uncertainty explains (probability 1 %).
    fn is_far(&self, line: &RatioLine<T>, ratio: T, sd_relative: T) -> bool {
        let above = ratio / line.ratio_at(self.design.greatest_height_m) - T::one();
        let below = T::one() - ratio / line.ratio_at(self.design.least_height_m);
        above.max(below) > T::of(ONCE_IN_A_HUNDRED) * sd_relative
    }

    fn is_possible(&self, height_m: T) -> bool {
        height_m >= self.design.least_height_m && height_m <= self.design.greatest_height_m
    }
}

/// A faulty sensor affects all channels with its roll angle.
pub(crate) fn share_faults<T: Real, const C: usize>(
    design: &Design<T, C>,
    outcomes: &mut [Outcome<T>; C],
) {
    for place in 0..C {
        let reason = match outcomes.get(place).map(|outcome| &outcome.height_m) {
            Some(Err(Reject::Inconsistent(reason))) => *reason,
            _ => continue,
        };
        if matches!(reason, Inconsistency::Misfit { .. }) {
            continue;
        }
        for (other, outcome) in outcomes.iter_mut().enumerate() {
            if outcome.height_m.is_ok() && design.output(other) == design.output(place) {
                outcome.height_m = Err(Reject::Inconsistent(reason));
            }
        }
    }
}
