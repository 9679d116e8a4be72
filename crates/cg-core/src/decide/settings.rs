//! The settings of the estimator: when maneuvers start and end, and which of them are used.

use crate::math::real::Real;

/// Standard deviation of the bank of public roads in curves, radians: crown and superelevation are
/// two to seven percent.
pub const PUBLIC_BANK_SD_RAD: f64 = 0.02;

/// Settings of the estimator: when maneuvers start and end, and which of them are used. Times are
/// in microseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Settings<T> {
    /// Duration of straight driving that ends a maneuver.
    pub straight_us: u64,
    /// Greatest duration of a maneuver; a longer turn is split.
    pub longest_us: u64,
    /// Samples are averaged over at most this time. In the band of usual maneuvers (up to ω = 6 rad/s) the signals scatter
    /// about their means by `(ω τ)²/12` of their square in it, which is the information that is lost: at most 2 % at 80 ms, and
    /// 0.2 % of the standard deviation in usual maneuvers. It is slightly above a round number, so that rounding does not
    /// decide which sample is the last.
    pub mean_us: u32,
    /// Whether the solution at the end of a maneuver is spread over the next samples, so that none of them costs as much
    /// as the whole. The result then comes some samples later (three per channel, and those that complete a mean), and
    /// these samples are in no maneuver. Otherwise the sample that ends the maneuver does all.
    pub spreads: bool,
    /// Greatest gap between two samples that is bridged by linear interpolation.
    pub gap_us: u64,
    /// Half-life of the weight of straight driving before a maneuver.
    pub fade_us: u64,
    /// Duration of straight driving at the start whose mean input is the initial steady state.
    pub rest_us: u64,
    /// Time after a gap in a turn until the wrong initial state of the filters has decayed.
    pub settle_us: u64,
    /// Greatest relative deviation of the speed from that at the start of the maneuver.
    pub speed_spread: T,
    /// Greatest relative standard deviation of a ratio that is used.
    pub ratio_sd_relative: T,
    /// Greatest share of the expected motion during which the roll angle may be constant; infinity
    /// disables the test. On the baseline truck's nonlinear plant the share reaches 0.11 when the
    /// truck settles in a turn. With a sensor whose range ends at two thirds of the turn's roll
    /// angle, and 20 dB of noise, it is 0.17 or more.
    pub standstill: T,
    /// Greatest share of the roll angle that the reduced model may leave unexplained. It is up to
    /// 0.05 on the logs of the independent truck without calibration, and up to 0.29 in its drive if
    /// the roll sensor is late by 0.5 s, which moves the height by less than 1 %.
    pub misfit: T,
    /// Greatest nonlinear part of the roll angle, as a share of the greatest angle. Dynamics that
    /// differ from the model look like a part of up to 0.5; the end of a sensor's range gives
    /// several times the angle.
    pub bend: T,
    /// Duration for which a different trailer mass must be measured before it is used.
    pub weighing_us: u64,
    /// Relative change of the trailer mass that means another load.
    pub mass_change: T,
    /// Standard deviation of the bank of the road in curves, radians. It applies to roll angles
    /// relative to gravity, and to all roll angles of a truck whose other sensors do not feel the
    /// bank.
    pub bank_sd_rad: T,
    /// The same for roll angles relative to the road without such other sensors. Such angles come
    /// from a simulation or a test track, so it is usually zero.
    pub bank_sd_to_road_rad: T,
    /// Greatest relative standard deviation of a ratio due to the bank of the road.
    pub road_sd_relative: T,
}

impl<T: Real> Settings<T> {
    /// The same settings for roads whose bank in curves has this standard deviation, radians; zero
    /// for a flat test track.
    #[must_use]
    pub fn on_road(self, bank_sd_rad: T) -> Self {
        Self { bank_sd_rad, bank_sd_to_road_rad: bank_sd_rad, ..self }
    }

    /// The same settings with solutions that are spread over samples, for a microcontroller.
    #[must_use]
    pub fn spread(self) -> Self {
        Self { spreads: true, ..self }
    }

    /// Settings for trucks on roads.
    pub fn truck() -> Self {
        Self {
            straight_us: 4_000_000,
            longest_us: 40_000_000,
            mean_us: 80_400,
            spreads: false,
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
            bank_sd_rad: T::of(PUBLIC_BANK_SD_RAD),
            road_sd_relative: T::of(0.5),
            bank_sd_to_road_rad: T::zero(),
        }
    }
}
