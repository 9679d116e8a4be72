//! When maneuvers open and close, and what is good enough.

use crate::math::real::Real;

/// When maneuvers open and close, and what is good enough. Times in microseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings<T> {
    /// Straight driving that ends a maneuver.
    pub straight_us: u64,
    /// The longest maneuver; a longer turn is cut.
    pub longest_us: u64,
    /// The longest hole between two samples that a straight line may bridge.
    pub gap_us: u64,
    /// Half-life of the straight driving before a maneuver.
    pub fade_us: u64,
    /// Straight driving at a beginning whose mean input is taken as the state of rest.
    pub rest_us: u64,
    /// After a hole in a turn: time until the filters have forgotten their wrong start.
    pub settle_us: u64,
    /// The greatest relative deviation of speed from that at the maneuver's start.
    pub speed_spread: T,
    /// The greatest relative standard deviation of a ratio that counts.
    pub ratio_sd_relative: T,
    /// The greatest share of the expected motion that the roll angle may stand still for; infinity = any.
    /// The baseline truck's nonlinear plant stands for up to 0.11 where it settles in a turn, a sensor
    /// whose range ends at two thirds of the turn's roll angle, with 20 dB of noise, for 0.17 and more.
    pub standstill: T,
    /// The greatest share of the roll angle that the reduced model may miss. On the independent
    /// truck's logs it misses up to 0.19 uncalibrated; of a sensor that is 1 s late, 0.39 and more.
    pub misfit: T,
    /// The greatest share of the roll angle, at its greatest, that may be a bend over the expected one:
    /// dynamics that are not quite the model's look like up to 0.5 of it, the end of a range like
    /// several times the angle.
    pub bend: T,
    /// How long another trailer mass must last.
    pub weighing_us: u64,
    /// Relative change of the trailer mass that means another load.
    pub mass_change: T,
}

impl<T: Real> Settings<T> {
    /// For trucks on roads.
    pub fn truck() -> Self {
        Self {
            straight_us: 4_000_000,
            longest_us: 40_000_000,
            gap_us: 500_000,
            fade_us: 2_000_000,
            rest_us: 300_000,
            settle_us: 3_000_000,
            speed_spread: T::of(0.3),
            ratio_sd_relative: T::of(0.2),
            standstill: T::of(0.15),
            misfit: T::of(0.35),
            bend: T::one(),
            weighing_us: 10_000_000,
            mass_change: T::of(0.05),
        }
    }
}
