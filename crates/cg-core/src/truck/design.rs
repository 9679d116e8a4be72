//! The constants of one truck, which are computed offline and used by the estimator.

use core::fmt;

use crate::math::real::Real;
use crate::truck::articulation::Articulation;
use crate::truck::axis::{Weights, cubic, locate};
use crate::truck::channel::{CHANNELS, Channel, Output};
use crate::truck::friction::Friction;
use crate::truck::path_lead::PathLead;
use crate::truck::ratio::RatioLine;
use crate::truck::reduced::Reduced5;
use crate::truck::rollover::{RolloverDesign, ThresholdLine};
pub use crate::truck::spread::Spread;

/// Number of speeds on the speed axis of a design.
pub const SPEEDS: usize = 8;
/// Number of trailer masses on the mass axis of a design.
pub const MASSES: usize = 6;
/// Steps between two masses of the axis, at which the springs are known.
pub const STEPS: usize = 3;
const STEPS_F64: f64 = 3.0;
/// Number of masses at which the springs are known.
pub const SPRING_MASSES: usize = (MASSES - 1) * STEPS + 1;

/// The model of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChannelDesign<T> {
    /// [`Channel::index`] of this channel: a number, because a structure in the memory of another
    /// language may hold any.
    pub index: u32,
    /// The reduced models at the nominal speed and reference height, one for each mass on the
    /// design's mass axis. Only the shape of their dynamics is used.
    pub models: [Reduced5<T>; MASSES],
    /// The friction of the springs in the roll angle, at the masses of the axis and at [`STEPS`] equal
    /// steps between two of them.
    pub friction: [Friction<T>; SPRING_MASSES],
    /// The DC ratio at these masses over that of the interpolated lines: measured springs have slopes
    /// that no smooth curve through the masses of the axis follows.
    pub of_lines: [T; SPRING_MASSES],
    /// What a tight turn does to the ratio.
    pub articulation: Articulation<T>,
    /// Ratio lines (rad per unit of input), `[speed][mass]` on the axes of the design. All are
    /// scaled to `b0 + b1 h = 1` at the reference height, so that they can be interpolated.
    pub lines: [[RatioLine<T>; MASSES]; SPEEDS],
    /// `R_c`, the DC ratio of the compensation (eq. 5.19).
    pub compensation: T,
}

/// The constants of one truck: numbers only, checked by [`Design::validate`].
///
/// The memory layout is that of C, so firmware in any language can keep the structure in flash.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [ChannelDesign<T>; C]: serde::Serialize, [[T; C]; C]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [ChannelDesign<T>; C]: serde::Deserialize<'de>, [[T; C]; C]: serde::Deserialize<'de>"
    ))
)]
pub struct Design<T, const C: usize = CHANNELS> {
    /// Speed axis of the ratio lines, strictly increasing.
    pub speed_mps: [T; SPEEDS],
    /// Trailer-mass axis of the ratio lines (sprung mass and axles), strictly increasing.
    pub trailer_mass_kg: [T; MASSES],
    /// The channels. A design on a computer has all of them in the order of [`Channel::ALL`], one
    /// for a chip those that are chosen for the truck's sensors.
    pub channels: [ChannelDesign<T>; C],
    /// Uncertainty of the ratios of all channels, `[speed][mass]`.
    pub spread: [[Spread<T, C>; MASSES]; SPEEDS],
    /// Speed that is used until a sample has one.
    pub nominal_speed_mps: T,
    /// Trailer mass that is used until a sample has one.
    pub nominal_trailer_mass_kg: T,
    /// Height for which the reduced models hold and at which the ratio lines are scaled.
    pub reference_height_m: T,
    /// The least height of the sprung c.g. that this trailer can have.
    pub least_height_m: T,
    /// The greatest height of the sprung c.g. that this trailer can have.
    pub greatest_height_m: T,
    /// Distance of the trailer's axles (their mean) behind the fifth wheel.
    pub trailer_wheelbase_m: T,
    /// The lead of the trailer's lateral acceleration over yaw rate times speed.
    pub path_lead: PathLead<T>,
    /// Acceleration of gravity.
    pub gravity_mps2: T,
    /// Parameters of the static stability factor.
    pub rollover: RolloverDesign<T>,
    /// Rollover thresholds over the height, one line for each mass on the mass axis.
    pub thresholds: [ThresholdLine<T>; MASSES],
}

/// The reason why a design is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DesignError {
    /// A number is not finite. Contains the name of the field.
    NotFinite(&'static str),
    /// An axis is not strictly increasing. Contains the name of the field.
    NotIncreasing(&'static str),
    /// A number that must be positive is not. Contains the name of the field.
    NotPositive(&'static str),
    /// The uncertainty of the ratios is no covariance matrix.
    NotCovariance,
    /// A channel occurs twice, or its index is unknown.
    NoSuchChannel {
        /// The index.
        index: u32,
    },
    /// The reduced model of this channel is unstable.
    Unstable(Channel),
    /// The friction of this channel is neither none nor a share between −1 and 1, a bend that leaves the
    /// springs a slope, and positive angles.
    NotFriction(Channel),
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite(field) => write!(f, "{field} must be a finite number"),
            Self::NotIncreasing(field) => write!(f, "{field} must increase strictly"),
            Self::NotPositive(field) => write!(f, "{field} must be positive"),
            Self::NotCovariance => {
                write!(f, "the uncertainty of the ratios must be a symmetric covariance matrix")
            }
            Self::NoSuchChannel { index } => {
                write!(f, "channel {index} is unknown or occurs twice")
            }
            Self::NotFriction(channel) => {
                write!(f, "the friction of the {channel} channel must be none, or positive angles")
            }
            Self::Unstable(channel) => {
                write!(f, "the reduced model of the {channel} channel is unstable")
            }
        }
    }
}

impl core::error::Error for DesignError {}

impl<T: Real, const C: usize> Design<T, C> {
    /// The same design in another precision.
    pub fn cast<U: Real>(&self) -> Design<U, C> {
        let to = |x: T| U::of(x.as_f64());
        Design {
            speed_mps: self.speed_mps.map(to),
            trailer_mass_kg: self.trailer_mass_kg.map(to),
            channels: self.channels.map(|c| ChannelDesign {
                index: c.index,
                models: c.models.map(|model| Reduced5 {
                    numerator: model.numerator.map(to),
                    denominator: model.denominator.map(to),
                    speed_slope: model.speed_slope.map(to),
                }),
                friction: c.friction.map(|friction| friction.cast()),
                of_lines: c.of_lines.map(to),
                articulation: c.articulation.cast(),
                lines: c.lines.map(|row| {
                    row.map(|l| RatioLine {
                        a0: to(l.a0),
                        a1: to(l.a1),
                        b0: to(l.b0),
                        b1: to(l.b1),
                    })
                }),
                compensation: to(c.compensation),
            }),
            spread: self
                .spread
                .map(|row| row.map(|s| Spread { covariance: s.covariance.map(|row| row.map(to)) })),
            nominal_speed_mps: to(self.nominal_speed_mps),
            nominal_trailer_mass_kg: to(self.nominal_trailer_mass_kg),
            reference_height_m: to(self.reference_height_m),
            least_height_m: to(self.least_height_m),
            greatest_height_m: to(self.greatest_height_m),
            trailer_wheelbase_m: to(self.trailer_wheelbase_m),
            path_lead: self.path_lead.cast(),
            gravity_mps2: to(self.gravity_mps2),
            rollover: RolloverDesign {
                half_track_m: to(self.rollover.half_track_m),
                unsprung_mass_kg: to(self.rollover.unsprung_mass_kg),
                unsprung_height_m: to(self.rollover.unsprung_height_m),
                payload_beside_sd_m: to(self.rollover.payload_beside_sd_m),
                tightest_turn_g: to(self.rollover.tightest_turn_g),
            },
            thresholds: self.thresholds.map(|line| ThresholdLine {
                threshold_g: line.threshold_g.map(|line| line.map(to)),
            }),
        }
    }

    /// Checks every number once, so that the estimator does not have to.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Result<(), DesignError> {
        increasing(&self.speed_mps, "speed_mps")?;
        increasing(&self.trailer_mass_kg, "trailer_mass_kg")?;
        increasing(
            &[self.least_height_m, self.reference_height_m, self.greatest_height_m],
            "least, reference and greatest height_m",
        )?;
        positive(self.least_height_m, "least_height_m")?;
        for (place, design) in self.channels.iter().enumerate() {
            let channel = self
                .channel(place)
                .filter(|channel| self.place(*channel) == Some(place))
                .ok_or(DesignError::NoSuchChannel { index: design.index })?;
            if !design.models.iter().all(Reduced5::is_stable) {
                return Err(DesignError::Unstable(channel));
            }
            positive(design.compensation, "compensation")?;
            if !design.friction.iter().all(Friction::is_possible) {
                return Err(DesignError::NotFriction(channel));
            }
            if !design.articulation.is_possible() {
                return Err(DesignError::NotFinite("articulation"));
            }
            for of_lines in design.of_lines {
                positive(of_lines, "of_lines")?;
            }
            for line in design.lines.iter().flatten() {
                positive(line.ratio_at(self.reference_height_m), "ratio at the reference height")?;
            }
        }
        for spread in self.spread.iter().flatten() {
            for i in 0..C {
                positive(spread.at(i, i), "spread of a ratio")?;
                for j in 0..i {
                    let (common, limit) = (spread.at(i, j), spread.at(i, i) * spread.at(j, j));
                    // Rounding may exceed the limit of fully correlated ratios.
                    let possible = common * common <= limit * T::of(1.0 + 1e-6);
                    if !possible || common != spread.at(j, i) {
                        return Err(DesignError::NotCovariance);
                    }
                }
            }
        }
        if !self.path_lead.is_possible() {
            return Err(DesignError::NotFinite("path_lead"));
        }
        self.validate_rollover()?;
        positive(self.nominal_speed_mps, "nominal_speed_mps")?;
        positive(self.nominal_trailer_mass_kg, "nominal_trailer_mass_kg")?;
        positive(self.trailer_wheelbase_m, "trailer_wheelbase_m")?;
        positive(self.gravity_mps2, "gravity_mps2")
    }

    /// The part of [`validate`](Self::validate) for the rollover threshold.
    fn validate_rollover(&self) -> Result<(), DesignError> {
        positive(self.rollover.half_track_m, "rollover half_track_m")?;
        positive(self.rollover.unsprung_mass_kg, "rollover unsprung_mass_kg")?;
        positive(self.rollover.unsprung_height_m, "rollover unsprung_height_m")?;
        positive(self.rollover.tightest_turn_g, "rollover tightest_turn_g")?;
        let beside_m = self.rollover.payload_beside_sd_m;
        if !(beside_m >= T::zero() && beside_m.present()) {
            return Err(DesignError::NotPositive("rollover payload_beside_sd_m"));
        }
        let [lightest_kg, ..] = self.trailer_mass_kg;
        increasing(
            &[self.rollover.unsprung_mass_kg, lightest_kg],
            "rollover unsprung_mass_kg and least trailer_mass_kg",
        )?;
        for threshold_g in self.thresholds.iter().flat_map(|line| line.threshold_g).flatten() {
            positive(threshold_g, "rollover threshold")?;
        }
        Ok(())
    }

    /// The channel at a place in [`channels`](Self::channels).
    pub fn channel(&self, place: usize) -> Option<Channel> {
        let index = usize::try_from(self.channels.get(place)?.index).ok()?;
        Channel::ALL.get(index).copied()
    }

    /// The place of a channel in [`channels`](Self::channels); `None` if the design does not have
    /// it.
    pub fn place(&self, channel: Channel) -> Option<usize> {
        self.channels.iter().position(|design| design.index as usize == channel.index())
    }

    /// Whether a bank of the road changes the ratio of the channel at this place.
    pub(crate) fn feels_bank(&self, place: usize) -> bool {
        self.channel(place).is_none_or(Channel::feels_bank)
    }

    /// Whether the roll angle of the channel at this place passes the lags of
    /// [`ROLL_LAG_S`](crate::truck::channel::ROLL_LAG_S).
    pub(crate) fn lags_roll(&self, place: usize) -> bool {
        self.channel(place).is_some_and(Channel::lags_roll)
    }

    /// The roll angle that the channel at this place explains.
    #[inline(never)] // one copy in the firmware image
    pub(crate) fn output(&self, place: usize) -> Option<Output> {
        Some(self.channel(place)?.output())
    }

    /// The place of the first channel with the same roll angle as the one at this place.
    pub(crate) fn first_with_output(&self, place: usize) -> usize {
        let output = self.output(place);
        (0..place).find(|other| self.output(*other) == output).unwrap_or(place)
    }

    /// The same design with some of its channels, for a chip. `None` if one of them is missing.
    pub fn with_channels<const N: usize>(&self, chosen: [Channel; N]) -> Option<Design<T, N>> {
        let mut places = [0; N];
        let first = self.channels.first()?;
        let mut channels = [*first; N];
        for ((place, design), channel) in places.iter_mut().zip(&mut channels).zip(chosen) {
            *place = self.place(channel)?;
            *design = *self.channels.get(*place)?;
        }
        Some(Design {
            speed_mps: self.speed_mps,
            trailer_mass_kg: self.trailer_mass_kg,
            channels,
            spread: self.spread.map(|row| {
                row.map(|spread| Spread {
                    covariance: places.map(|i| places.map(|j| spread.at(i, j))),
                })
            }),
            nominal_speed_mps: self.nominal_speed_mps,
            nominal_trailer_mass_kg: self.nominal_trailer_mass_kg,
            reference_height_m: self.reference_height_m,
            least_height_m: self.least_height_m,
            greatest_height_m: self.greatest_height_m,
            trailer_wheelbase_m: self.trailer_wheelbase_m,
            path_lead: self.path_lead,
            gravity_mps2: self.gravity_mps2,
            rollover: self.rollover,
            thresholds: self.thresholds,
        })
    }

    /// The ratio line of a channel at a speed and trailer mass; `None` outside the axes, or if the
    /// design does not have the channel.
    ///
    /// Each coefficient is a cubic in speed and mass; the ratio is multiplied by what the springs make of it.
    pub fn line(&self, channel: Channel, speed_mps: T, trailer_mass_kg: T) -> Option<RatioLine<T>> {
        let design = self.channels.get(self.place(channel)?)?;
        let mass = cubic(&self.trailer_mass_kg, trailer_mass_kg, false)?;
        let speed = cubic(&self.speed_mps, speed_mps, !design.is_steer())?;
        let line = design.line(&speed, &mass);
        let of_lines = design.of_lines(self.springs(trailer_mass_kg));
        Some(RatioLine { a0: line.a0 * of_lines, a1: line.a1 * of_lines, ..line })
    }

    /// What a tight turn does to the ratio of a channel; nothing if the design does not have it.
    pub(crate) fn articulation(&self, channel: Channel) -> Articulation<T> {
        let design = self.place(channel).and_then(|place| self.channels.get(place));
        design.map_or(Articulation::NONE, |design| design.articulation)
    }

    /// `R_c` of a channel; one if the design does not have it.
    pub fn compensation(&self, channel: Channel) -> T {
        let design = self.place(channel).and_then(|place| self.channels.get(place));
        design.map_or(T::one(), |design| design.compensation)
    }

    /// The place of the mass below on the mass axis, and the share of the one above it. Beyond the axis
    /// it is an end of the axis.
    fn nearest_masses(&self, trailer_mass_kg: T) -> (usize, T) {
        let ends = (self.trailer_mass_kg.first(), self.trailer_mass_kg.last());
        let within_kg = match ends {
            (Some(least), Some(greatest)) => trailer_mass_kg.max(*least).min(*greatest),
            _ => trailer_mass_kg,
        };
        locate(&self.trailer_mass_kg, within_kg).unwrap_or((0, T::zero()))
    }

    /// The place of the mass below among the masses at which the springs are known, and the share of the one
    /// above it.
    pub(super) fn springs(&self, trailer_mass_kg: T) -> (usize, T) {
        let (j, share) = self.nearest_masses(trailer_mass_kg);
        let (mut step, mut share) = (0, share * T::of(STEPS_F64));
        while share > T::one() {
            (step, share) = (step + 1, share - T::one());
        }
        (STEPS * j + step, share)
    }

    /// The friction at a place in [`channels`](Self::channels) and a trailer mass, interpolated linearly.
    pub fn friction(&self, place: usize, trailer_mass_kg: T) -> Option<Friction<T>> {
        let friction = &self.channels.get(place)?.friction;
        let (j, share) = self.springs(trailer_mass_kg);
        Some(friction.get(j)?.blend(friction.get(j + 1)?, share))
    }

    /// The reduced model at a place in [`channels`](Self::channels) and a trailer mass, interpolated
    /// linearly between the neighbors on the mass axis. If the interpolated model is unstable, it
    /// is the nearer neighbor. Beyond the axis it is the last model.
    pub fn model(&self, place: usize, trailer_mass_kg: T) -> Option<Reduced5<T>> {
        let models = &self.channels.get(place)?.models;
        let (j, share) = self.nearest_masses(trailer_mass_kg);
        let (light, heavy) = (models.get(j)?, models.get(j + 1)?);
        let blended = light.blend(heavy, share);
        Some(if blended.is_stable() {
            blended
        } else if share < T::of(0.5) {
            *light
        } else {
            *heavy
        })
    }

    /// The uncertainty of the ratios at a speed and trailer mass, interpolated linearly; `None`
    /// outside the axes.
    pub fn spread(&self, speed_mps: T, trailer_mass_kg: T) -> Option<Spread<T, C>> {
        let (i, u) = locate(&self.speed_mps, speed_mps)?;
        let (j, m) = locate(&self.trailer_mass_kg, trailer_mass_kg)?;
        let mut spread = Spread { covariance: [[T::zero(); C]; C] };
        for (row, u) in self.spread.get(i..)?.iter().zip([T::one() - u, u]) {
            for (corner, m) in row.get(j..)?.iter().zip([T::one() - m, m]) {
                spread.add(corner, u * m);
            }
        }
        Some(spread)
    }
}

impl<T: Real> ChannelDesign<T> {
    /// The effect of the steer angle is a smooth function of the speed, that of an acceleration a
    /// smooth function of the curvature, by which the tires scrub.
    fn is_steer(&self) -> bool {
        self.index as usize == Channel::Steer.index()
    }

    /// A speed on the axis on which the lines are interpolated.
    pub(super) fn speed_axis(&self, speed_mps: T) -> T {
        if self.is_steer() { speed_mps } else { T::one() / (speed_mps * speed_mps) }
    }

    /// The ratio over that of the lines between [two masses](Design::springs).
    #[inline(never)] // one copy in the firmware image
    pub(super) fn of_lines(&self, (place, share): (usize, T)) -> T {
        match self.of_lines.get(place..) {
            Some([below, above, ..]) => *below + (*above - *below) * share,
            _ => T::one(),
        }
    }

    /// The line at these weights of the speeds and masses.
    fn line(&self, speed: &Weights<T>, mass: &Weights<T>) -> RatioLine<T> {
        let mut sum = RatioLine::NONE;
        for (place, u) in (speed.first..).zip(speed.weights) {
            sum.add(&self.line_of_speed(place, mass), u);
        }
        sum
    }

    /// The line of one speed of the axis at these weights of the masses.
    #[inline(never)]
    pub(super) fn line_of_speed(&self, place: usize, mass: &Weights<T>) -> RatioLine<T> {
        let mut sum = RatioLine::NONE;
        let row = self.lines.get(place).and_then(|row| row.get(mass.first..));
        for (line, m) in row.unwrap_or_default().iter().zip(mass.weights) {
            sum.add(line, m);
        }
        sum
    }
}

fn increasing<T: Real>(axis: &[T], field: &'static str) -> Result<(), DesignError> {
    for value in axis {
        if !value.present() {
            return Err(DesignError::NotFinite(field));
        }
    }
    if axis.windows(2).all(|pair| matches!(pair, [a, b] if a < b)) {
        Ok(())
    } else {
        Err(DesignError::NotIncreasing(field))
    }
}

fn positive<T: Real>(value: T, field: &'static str) -> Result<(), DesignError> {
    if !value.present() {
        Err(DesignError::NotFinite(field))
    } else if value > T::zero() {
        Ok(())
    } else {
        Err(DesignError::NotPositive(field))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_that_does_not_increase_is_refused() {
        assert_eq!(increasing(&[1.0, 1.0], "x"), Err(DesignError::NotIncreasing("x")));
        assert_eq!(increasing(&[1.0, f64::NAN], "x"), Err(DesignError::NotFinite("x")));
    }
}
