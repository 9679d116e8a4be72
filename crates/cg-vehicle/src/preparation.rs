//! What is done to the samples of a drive before the estimator gets them: spikes are left out, the path of the tractor becomes that
//! of the trailer, and road twist is taken from the suspension rolls.

use cg_core::{Quantity, Sample};
use serde::{Deserialize, Serialize};

use crate::road_twist::RoadTwist;
use crate::spikes::Spikes;
use crate::trailer_path::{Followed, TrailerPath};
use crate::twist_correction::{TwistCorrection, YawRates};
use crate::vehicle::Vehicle;

/// What must be known of a truck for it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Prepares {
    /// What road twist does to the pairs.
    pub road_twist: RoadTwist,
    /// How the trailer follows the tractor.
    pub trailer_path: TrailerPath,
    /// Whether the yaw rate is that of the tractor, if the vehicle file says it.
    pub yaw_on_tractor: Option<bool>,
}

impl Prepares {
    /// For a vehicle; `None` if it has no equations.
    pub fn of(vehicle: &Vehicle) -> Option<Self> {
        Some(Self {
            road_twist: RoadTwist::of(vehicle).ok()?,
            trailer_path: TrailerPath::of(vehicle).ok()?,
            yaw_on_tractor: vehicle.sensors.yaw_rate_on_tractor(),
        })
    }
}

/// Prepares the samples of a drive.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Preparation {
    /// Whether the yaw rate is that of the tractor because of where it comes from, unless the vehicle file says it.
    pub has_tractor_yaw: bool,
    /// Whether the lateral acceleration is that of the tractor's path, likewise.
    pub has_tractor_acceleration: bool,
    /// The last speed.
    speed_mps: f64,
    /// The yaw rate of the trailer. That the lateral acceleration of its c.g. leads it is known to the channel.
    yaw: Followed,
    acceleration: Followed,
    twist: TwistCorrection,
    spikes: Spikes,
}

impl Preparation {
    /// Before the first sample. The speed, m/s, is that of samples before the first one that has one.
    pub fn at(nominal_speed_mps: f64) -> Self {
        Self {
            has_tractor_yaw: false,
            has_tractor_acceleration: false,
            speed_mps: nominal_speed_mps,
            yaw: Followed::default(),
            acceleration: Followed::default(),
            twist: TwistCorrection::default(),
            spikes: Spikes::default(),
        }
    }

    /// Takes what a row says of its yaw rate and its lateral acceleration: 1 if that is measured on the tractor, 0 if not. It holds
    /// until another row says something else; NaN says nothing.
    pub fn hear(&mut self, yaw_rate_on_tractor: f64, lateral_acceleration_on_tractor: f64) {
        for (said, has) in [
            (yaw_rate_on_tractor, &mut self.has_tractor_yaw),
            (lateral_acceleration_on_tractor, &mut self.has_tractor_acceleration),
        ] {
            if !said.is_nan() {
                *has = said > 0.5;
            }
        }
    }

    /// What is said of spikes that were left out.
    pub fn spikes(&self) -> Option<String> {
        let count = self.spikes.count;
        (count > 0).then(|| {
            let (noun, jump) = if count > 1 { ("angles", "jump") } else { ("angle", "jumps") };
            format!(
                "{count} {noun} (roll or steer) {jump} by more than 7 degrees from one row to the next, and not to stay, and \
                 were left out: check the sensor and its wires"
            )
        })
    }

    /// Prepares a sample. `may_twist`: whether the road may be twisted.
    pub fn prepare(
        &mut self,
        sample: &mut Sample<f64>,
        of: &Prepares,
        may_twist: bool,
        gravity_mps2: f64,
    ) {
        self.spikes.leave_out(sample);
        if Quantity::Speed.plausible(sample.speed_mps) {
            self.speed_mps = sample.speed_mps;
        }
        let (time_us, speed_mps, path) = (sample.time_us, self.speed_mps, &of.trailer_path);
        let measured_radps = sample.yaw_rate_radps;
        let mut yaw_rates = YawRates { tractor_radps: None, trailer_radps: measured_radps };
        let is_of_tractor = of.yaw_on_tractor.unwrap_or(self.has_tractor_yaw);
        if is_of_tractor && Quantity::YawRate.plausible(measured_radps) {
            let trailer_radps = self.yaw.follow(time_us, measured_radps, speed_mps, &path.yaw);
            yaw_rates = YawRates { tractor_radps: Some(measured_radps), trailer_radps };
            sample.yaw_rate_radps = trailer_radps;
        }
        let lateral_mps2 = &mut sample.lateral_acceleration_mps2;
        if self.has_tractor_acceleration && Quantity::LateralAcceleration.plausible(*lateral_mps2) {
            *lateral_mps2 =
                self.acceleration.follow(time_us, *lateral_mps2, speed_mps, &path.acceleration);
        }
        if may_twist {
            self.twist.correct(sample, speed_mps, yaw_rates, &of.road_twist, gravity_mps2);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::{TruckKind, template};

    /// The last of some samples of a step in both inputs, prepared.
    fn last(of: &Prepares, mut preparation: Preparation, yaw_radps: f64) -> Sample<f64> {
        let samples = (0..10_u64).map(|k| {
            let mut sample = Sample::absent(k * 20_000);
            (sample.speed_mps, sample.yaw_rate_radps) = (if k == 0 { 15.0 } else { f64::NAN }, 0.0);
            sample.lateral_acceleration_mps2 = 0.0;
            if k > 0 {
                (sample.yaw_rate_radps, sample.lateral_acceleration_mps2) = (yaw_radps, 1.0);
            }
            preparation.prepare(&mut sample, of, true, 9.81);
            sample
        });
        samples.last().unwrap()
    }

    /// A drive without a speed has that of the vehicle file from its first sample on.
    #[test]
    fn without_a_speed_the_trailer_follows_at_the_nominal_one() {
        let text = template(TruckKind::FourByTwoThreeAxle);
        let of = Prepares::of(&Vehicle::parse(&text, "truck").unwrap()).unwrap();
        let followed = |nominal_mps: f64, speed_mps: f64| {
            let mut preparation = Preparation::at(nominal_mps);
            preparation.has_tractor_yaw = true;
            let samples = (0..25_u64).map(|k| {
                let yaw_rate_radps = if k > 0 { 0.1 } else { 0.0 };
                let mut sample = Sample { yaw_rate_radps, speed_mps, ..Sample::absent(k * 20_000) };
                preparation.prepare(&mut sample, &of, true, 9.81);
                sample.yaw_rate_radps
            });
            samples.last().unwrap()
        };
        assert_eq!(followed(15.0, f64::NAN).to_bits(), followed(3.0, 15.0).to_bits());
        let slow = followed(3.0, f64::NAN) / followed(15.0, f64::NAN);
        assert!((slow - 1.0).abs() > 0.2, "{slow}");
    }

    /// Only what is measured on the tractor is another one on the trailer, and that later.
    #[test]
    fn what_the_tractor_measures_becomes_that_of_the_trailer() {
        let text = template(TruckKind::FourByTwoThreeAxle);
        let of = Prepares::of(&Vehicle::parse(&text, "truck").unwrap()).unwrap();
        let text = text + "\n[sensors.yaw_rate]\non_tractor = true\n";
        let by_file = Prepares::of(&Vehicle::parse(&text, "truck").unwrap()).unwrap();
        let (plain, mut on_bus) = (Preparation::at(15.0), Preparation::at(15.0));
        on_bus.has_tractor_yaw = true;
        let is_same = |found: f64, measured: f64| found.to_bits() == measured.to_bits();
        let same = last(&of, plain.clone(), 0.1);
        assert!(is_same(same.yaw_rate_radps, 0.1) && is_same(same.lateral_acceleration_mps2, 1.0));
        for sample in [last(&by_file, plain.clone(), 0.1), last(&of, on_bus.clone(), 0.1)] {
            assert!(sample.yaw_rate_radps > 0.0 && sample.yaw_rate_radps < 0.05, "{sample:?}");
            assert!(is_same(sample.lateral_acceleration_mps2, 1.0), "{sample:?}");
        }
        let accelerated = Preparation { has_tractor_acceleration: true, ..plain };
        let sample = last(&of, accelerated, 0.1);
        assert!(is_same(sample.yaw_rate_radps, 0.1), "{sample:?}");
        let lateral_mps2 = sample.lateral_acceleration_mps2;
        assert!(lateral_mps2 > 0.0 && lateral_mps2 < 0.5, "{sample:?}");
        // The file knows better than the bus.
        let by_file = Prepares { yaw_on_tractor: Some(false), ..of };
        assert!(is_same(last(&by_file, on_bus.clone(), 0.1).yaw_rate_radps, 0.1));
        // An impossible value stays for the estimator to leave out, and does not enter the others.
        assert!(is_same(last(&of, on_bus, 1e300).yaw_rate_radps, 1e300));
    }
}
