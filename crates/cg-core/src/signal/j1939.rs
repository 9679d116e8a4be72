//! J1939 parameter groups: decoding of CAN frames into signals in SI units, and encoding.
//!
//! A signal is a little-endian field of one to three bytes, `value = scale · raw + offset`. Raw
//! values whose highest byte is above `0xFA` mean "not available", "error" or are reserved; such a
//! signal is absent. Signs are those of J1939. For steering, yaw rate and lateral acceleration
//! (positive to the left) they agree with ISO 8855. The sign of a roll sensor depends on its
//! mounting.
//!
//! **Reference.** SAE J1939-71 (signals), J1939-21 (identifiers), J1939-71 §5.1.4 (absent values).

use crate::math::real::Real;
use crate::signal::sample::Quantity;
use crate::signal::unit;

const DEGREE: f64 = unit::DEG.times / unit::DEG.per;
const KMH: f64 = unit::KMH.times / unit::KMH.per;
/// Highest byte of the greatest valid raw value.
const GREATEST_BYTE: u32 = 0xFA;

/// Position and scaling of a signal in its parameter group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal {
    /// Parameter group number.
    pub pgn: u32,
    /// Priority with which the group is sent.
    pub priority: u8,
    /// Index of the first byte, from 0.
    pub first_byte: u8,
    /// Number of bytes, 1 to 3.
    pub bytes: u8,
    /// SI units per bit.
    pub scale: f64,
    /// SI value of the raw value 0.
    pub offset: f64,
}

const fn signal(pgn: u32, priority: u8, place: (u8, u8), scale: f64, offset: f64) -> Signal {
    Signal { pgn, priority, first_byte: place.0, bytes: place.1, scale, offset }
}

/// VDC2: steering-wheel angle (SPN 1807), rad.
pub const STEERING_WHEEL_ANGLE: Signal = signal(61449, 6, (0, 2), 1.0 / 1024.0, -31.374);
/// VDC2: yaw rate (SPN 1808), rad/s.
pub const YAW_RATE: Signal = signal(61449, 6, (3, 2), 1.0 / 8192.0, -3.92);
/// VDC2: lateral acceleration (SPN 1809), m/s². The sensor is fixed to the tractor's body and shows
/// its specific force.
pub const LATERAL_ACCELERATION: Signal = signal(61449, 6, (5, 2), 1.0 / 2048.0, -15.687);
/// SAS: steering-wheel angle (SPN 3683), rad.
pub const STEERING_WHEEL_ANGLE_SAS: Signal = signal(61469, 3, (0, 2), 1.0 / 1024.0, -31.374);
/// SSI: roll angle relative to gravity (SPN 3319), rad.
pub const ROLL: Signal = signal(61459, 3, (2, 2), 0.002 * DEGREE, -64.0 * DEGREE);
/// SSI2: roll angle relative to gravity, finer (SPN 4977), rad.
pub const ROLL_FINE: Signal = signal(61481, 3, (3, 3), DEGREE / 32768.0, -250.0 * DEGREE);
/// ARI: roll rate (SPN 4984), rad/s.
pub const ROLL_RATE: Signal = signal(61482, 3, (2, 2), DEGREE / 128.0, -250.0 * DEGREE);
/// CCVS1: wheel-based speed (SPN 84), m/s.
pub const SPEED: Signal = signal(65265, 6, (1, 2), KMH / 256.0, 0.0);
/// EBC2: speed of the front axle (SPN 904), m/s.
pub const FRONT_AXLE_SPEED: Signal = signal(65215, 6, (0, 2), KMH / 256.0, 0.0);
/// VW: mass of the trailer (SPN 180), kg.
pub const TRAILER_MASS: Signal = signal(65258, 6, (3, 2), 2.0, 0.0);
/// EBS22 (ISO 11992): sum of the trailer's axle loads, kg.
pub const TRAILER_AXLE_LOAD: Signal = signal(65220, 6, (4, 2), 2.0, 0.0);

/// ASC3: height of the tractor's body above its front axle, left (SPN 1721), m. Like that on the
/// right it serves no quantity, because a front axle usually has leaf springs.
pub const LEVEL_FRONT_LEFT: Signal = signal(65113, 6, (0, 2), 1e-4, -3.2);
/// ASC3: the same on the right (SPN 1722), m.
pub const LEVEL_FRONT_RIGHT: Signal = signal(65113, 6, (2, 2), 1e-4, -3.2);
/// ASC3: height of the tractor's body above its rear axle, left (SPN 1723), m.
pub const LEVEL_REAR_LEFT: Signal = signal(65113, 6, (4, 2), 1e-4, -3.2);
/// ASC3: the same on the right (SPN 1724), m.
pub const LEVEL_REAR_RIGHT: Signal = signal(65113, 6, (6, 2), 1e-4, -3.2);
/// ASC4: gauge pressure in the air spring of the tractor's rear axle, left (SPN 1727), Pa.
pub const BELLOWS_REAR_LEFT: Signal = signal(65112, 6, (4, 2), 100.0, 0.0);
/// ASC4: the same on the right (SPN 1728), Pa.
pub const BELLOWS_REAR_RIGHT: Signal = signal(65112, 6, (6, 2), 100.0, 0.0);

/// Proprietary B group of this project: c.g. height of the trailer's sprung mass, m.
pub const CG_HEIGHT: Signal = signal(65296, 6, (0, 2), 0.001, 0.0);
/// The same group: standard deviation of the height, m.
pub const CG_HEIGHT_SD: Signal = signal(65296, 6, (2, 1), 0.005, 0.0);
/// The same group: static rollover threshold, g.
pub const CG_THRESHOLD: Signal = signal(65296, 6, (3, 1), 0.005, 0.0);
/// The same group: threshold minus the present lateral acceleration, g.
pub const CG_MARGIN: Signal = signal(65296, 6, (4, 1), 0.01, -1.25);
/// The same group: level of the rollover warning, 0 for none.
pub const CG_WARNING_LEVEL: Signal = signal(65296, 6, (5, 1), 1.0, 0.0);
/// The same group: 0 no height yet, 1 height, 2 height but a signal is missing, 3 no height and a
/// signal is missing.
pub const CG_STATUS: Signal = signal(65296, 6, (6, 1), 1.0, 0.0);
/// The same group: number of maneuvers used for the height, at most 250.
pub const CG_MANEUVERS: Signal = signal(65296, 6, (7, 1), 1.0, 0.0);

/// Another Proprietary B group: the speed that is requested in a turn, m/s.
pub const CG_REQUESTED_SPEED: Signal = signal(65297, 6, (0, 2), 1.0 / 256.0 / 3.6, 0.0);

/// The signals that are decoded, their quantities and their ranks. If several signals measure the
/// same quantity, the one with the smallest rank is preferred. The angle of a slope sensor (SSI,
/// SSI2) is a roll angle relative to gravity or a tilt, depending on [`Slope`].
pub const TABLE: [(Signal, Quantity, u8); 14] = [
    (STEERING_WHEEL_ANGLE, Quantity::SteeringWheel, 0),
    (YAW_RATE, Quantity::YawRate, 0),
    (LATERAL_ACCELERATION, Quantity::TractorLateralSpecificForce, 0),
    (ROLL_FINE, Quantity::RollToGravity, 0),
    (ROLL, Quantity::RollToGravity, 1),
    (STEERING_WHEEL_ANGLE_SAS, Quantity::SteeringWheel, 1),
    (SPEED, Quantity::Speed, 0),
    (FRONT_AXLE_SPEED, Quantity::Speed, 1),
    (TRAILER_MASS, Quantity::TrailerMass, 0),
    (TRAILER_AXLE_LOAD, Quantity::TrailerAxleLoad, 0),
    (LEVEL_REAR_LEFT, Quantity::TractorLevelLeft, 0),
    (LEVEL_REAR_RIGHT, Quantity::TractorLevelRight, 0),
    (BELLOWS_REAR_LEFT, Quantity::DrivePressureLeft, 0),
    (BELLOWS_REAR_RIGHT, Quantity::DrivePressureRight, 0),
];

/// How to decide whether a slope sensor compensates its angle for the accelerations of the vehicle.
/// A compensated angle is a roll angle relative to gravity, an uncompensated one is the tilt of an
/// inclinometer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compensation {
    /// By the compensation bits (SPN 3326, 4980) as defined by J1939-71: 0 on, 1 off. If the bits
    /// contain no information, the angle counts as tilt. The reason: a roll angle used as tilt
    /// gives no height, but a tilt used as roll angle gives a wrong one.
    #[default]
    Bits,
    /// By the compensation bits with inverted meaning, 0 off and 1 on, as some manufacturers use
    /// them.
    InvertedBits,
    /// The angle is compensated; the bits are ignored.
    On,
    /// The angle is not compensated; the bits are ignored.
    Off,
}

words!(Compensation {
    Bits => "bit", "Use the compensation bits (SPN 3326, 4980: 0 on, 1 off); without valid bits it is not compensated";
    InvertedBits => "inverted-bit", "Use the bits with inverted meaning: 0 off, 1 on";
    On => "yes", "It is compensated; ignore the bits";
    Off => "no", "It is not compensated; ignore the bits";
});

/// State of the roll angle of a slope sensor (SSI, SSI2), sent together with its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slope {
    /// Compensation (SPN 3326, 4980): 0 on, 1 off, 2 error, 3 not available.
    pub compensation: u8,
    /// Figure of merit (SPN 3324, 4981): 0 as specified, 1 degraded, 2 error, 3 not available.
    pub merit: u8,
}

impl Slope {
    /// Reads the state from a frame; `None` if the frame is not from a slope sensor. Bits that a
    /// short frame does not contain count as not available.
    pub fn of(identifier: u32, data: &[u8]) -> Option<Self> {
        let [compensation, merit] = slope_bits(pgn_of(identifier))?;
        let byte = data.get(6).copied().unwrap_or(0xFF);
        Some(Self { compensation: byte >> compensation & 3, merit: byte >> merit & 3 })
    }

    /// The quantity that the angle measures; `None` if the sensor reports an error.
    pub const fn quantity(self, rule: Compensation) -> Option<Quantity> {
        if self.merit == 2 {
            return None;
        }
        match (rule, self.compensation) {
            (Compensation::Bits | Compensation::InvertedBits, 2) => None,
            (Compensation::On, _) | (Compensation::Bits, 0) | (Compensation::InvertedBits, 1) => {
                Some(Quantity::RollToGravity)
            }
            _ => Some(Quantity::Tilt),
        }
    }
}

/// Bit positions of compensation and figure of merit of the roll angle in the seventh byte of a
/// slope sensor's group.
const fn slope_bits(pgn: u32) -> Option<[u8; 2]> {
    match pgn {
        61459 => Some([6, 2]),
        61481 => Some([4, 6]),
        _ => None,
    }
}

/// Decodes a frame: calls `found` with quantity, rank and SI value of each present signal of
/// [`TABLE`].
pub fn decode<T: Real>(
    identifier: u32,
    data: &[u8],
    rule: Compensation,
    mut found: impl FnMut(Quantity, u8, T),
) {
    let pgn = pgn_of(identifier);
    for (signal, quantity, rank) in TABLE {
        if signal.pgn != pgn {
            continue;
        }
        let Some(value) = signal.decode(data) else { continue };
        let meant = Slope::of(identifier, data).map_or(Some(quantity), |said| said.quantity(rule));
        if let Some(quantity) = meant {
            found(quantity, rank, value);
        }
    }
}

/// Data of a frame in which every signal is not available: all bits are set.
pub const NOT_AVAILABLE: [u8; 8] = [0xFF; 8];

/// The parameter group of a 29-bit identifier. Below format 240, the destination address is not
/// part of the group number.
pub const fn pgn_of(identifier: u32) -> u32 {
    let format = (identifier >> 16) & 0xFF;
    if format < 240 { (identifier >> 8) & 0x3_FF00 } else { (identifier >> 8) & 0x3_FFFF }
}

impl Signal {
    /// The 29-bit identifier of the signal's group with this source address.
    pub const fn identifier(&self, source: u8) -> u32 {
        ((self.priority as u32) << 26) | (self.pgn << 8) | source as u32
    }

    /// The value in a frame of its group, SI units; `None` if it is absent.
    pub fn decode<T: Real>(&self, data: &[u8]) -> Option<T> {
        let (first, bytes) = (usize::from(self.first_byte), usize::from(self.bytes));
        let field = data.get(first..first + bytes)?;
        let raw = field.iter().rev().fold(0_u32, |raw, &byte| (raw << 8) | u32::from(byte));
        let highest = u32::from(*field.last()?);
        if highest > GREATEST_BYTE {
            return None;
        }
        // At most 24 bits, which single precision represents exactly.
        Some(T::of(f64::from(raw)) * T::of(self.scale) + T::of(self.offset))
    }

    /// Sets the compensation bits of the roll angle in a frame of a slope sensor. Other groups have
    /// no such bits and are unchanged.
    pub const fn set_compensated(&self, compensated: bool, data: &mut [u8; 8]) {
        if let Some([place, _]) = slope_bits(self.pgn) {
            data[6] = data[6] & !(3 << place) | (!compensated as u8) << place;
        }
    }

    /// Writes a value (SI units), rounded to the nearest raw value, into a frame of its group. If
    /// the value is not finite or outside the range of the signal, writes "not available" and
    /// returns `false`.
    pub fn encode(&self, value: f64, data: &mut [u8; 8]) -> bool {
        let greatest = (GREATEST_BYTE << (8 * (u32::from(self.bytes) - 1)))
            | ((1 << (8 * (u32::from(self.bytes) - 1))) - 1);
        let raw = libm::round((value - self.offset) / self.scale);
        let fits = raw >= 0.0 && raw <= f64::from(greatest);
        // The value is in range, so the cast is exact.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let raw = if fits { raw as u32 } else { u32::MAX };
        for (k, byte) in raw.to_le_bytes().into_iter().take(usize::from(self.bytes)).enumerate() {
            if let Some(place) = data.get_mut(usize::from(self.first_byte) + k) {
                *place = byte;
            }
        }
        fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Signal; TABLE.len()] = {
        let mut all = [ROLL_RATE; TABLE.len()];
        let mut k = 0;
        while k < TABLE.len() {
            all[k] = TABLE[k].0;
            k += 1;
        }
        all
    };

    #[test]
    fn every_value_comes_back_to_half_a_bit() {
        for signal in ALL {
            let span = signal.scale * f64::from(0xFA_FFFF_u32 >> (8 * (3 - signal.bytes)));
            for share in [0.0, 0.123_456, 0.5, 0.999_99] {
                let value = signal.offset + share * span;
                let mut data = NOT_AVAILABLE;
                assert!(signal.encode(value, &mut data));
                let back: f64 = signal.decode(&data).unwrap();
                assert!((back - value).abs() <= 0.5 * signal.scale * (1.0 + 1e-9), "{signal:?}");
            }
        }
    }

    #[test]
    fn what_is_not_available_is_absent() {
        for signal in ALL {
            assert_eq!(signal.decode::<f64>(&NOT_AVAILABLE), None);
            let mut data = [0; 8];
            assert!(!signal.encode(f64::NAN, &mut data));
            assert_eq!(signal.decode::<f64>(&data), None);
            assert!(!signal.encode(1e9, &mut data));
            assert!(!signal.encode(signal.offset - signal.scale, &mut data));
            assert_eq!(signal.decode::<f64>(&data[..1]), None); // a short frame
        }
    }

    #[test]
    fn signals_of_one_group_do_not_touch_each_other() {
        let mut data = NOT_AVAILABLE;
        STEERING_WHEEL_ANGLE.encode(0.5, &mut data);
        LATERAL_ACCELERATION.encode(-1.25, &mut data);
        assert!((STEERING_WHEEL_ANGLE.decode::<f64>(&data).unwrap() - 0.5).abs() < 1e-3);
        assert!((LATERAL_ACCELERATION.decode::<f64>(&data).unwrap() + 1.25).abs() < 1e-3);
        assert_eq!(YAW_RATE.decode::<f64>(&data), None);
    }

    /// Straight-ahead steering is raw 32126.976. The nearest raw value 32127 is 0.024/1024 rad to
    /// the left.
    #[test]
    fn steering_zero_lies_between_two_raw_values() {
        let mut data = NOT_AVAILABLE;
        STEERING_WHEEL_ANGLE.encode(0.0, &mut data);
        assert_eq!(u16::from_le_bytes([data[0], data[1]]), 32_127);
        let back: f64 = STEERING_WHEEL_ANGLE.decode(&data).unwrap();
        assert!((back - 0.024 / 1024.0).abs() < 1e-9);
    }

    /// Bits of the seventh byte, counted from 1. In SSI the figure of merit of the roll angle is at
    /// 7.3 and the compensation at 7.7. In SSI2 the compensation is at 7.5 and the figure of merit
    /// at 7.7.
    #[test]
    fn a_slope_sensor_says_whether_its_angle_is_a_roll_angle() {
        use Compensation::{Bits, InvertedBits, Off, On};
        const ROLL_ANGLE: Option<Quantity> = Some(Quantity::RollToGravity);
        const TILT: Option<Quantity> = Some(Quantity::Tilt);
        let meant = [
            // compensation, merit: bits, inverted bits, on, off
            ((0, 3), [ROLL_ANGLE, TILT, ROLL_ANGLE, TILT]),
            ((1, 3), [TILT, ROLL_ANGLE, ROLL_ANGLE, TILT]),
            ((2, 3), [None, None, ROLL_ANGLE, TILT]),
            ((3, 3), [TILT, TILT, ROLL_ANGLE, TILT]),
            ((0, 0), [ROLL_ANGLE, TILT, ROLL_ANGLE, TILT]),
            ((0, 1), [ROLL_ANGLE, TILT, ROLL_ANGLE, TILT]),
            ((0, 2), [None; 4]),
        ];
        for (signal, compensation_bit, merit_bit) in [(ROLL, 6, 2), (ROLL_FINE, 4, 6)] {
            let mut data = [0xFF; 8];
            signal.encode(0.05, &mut data);
            for ((compensation, merit), expected) in meant {
                // The bits of the pitch angle in the same byte report an error and must have no
                // effect.
                data[6] = 0b1010_1010 & !(3 << compensation_bit) & !(3 << merit_bit)
                    | compensation << compensation_bit
                    | merit << merit_bit;
                let slope = Slope::of(signal.identifier(0xE4), &data);
                assert_eq!(slope, Some(Slope { compensation, merit }));
                for (rule, expected) in [Bits, InvertedBits, On, Off].into_iter().zip(expected) {
                    let mut seen = None;
                    decode(signal.identifier(0xE4), &data, rule, |quantity, _, _: f64| {
                        seen = Some(quantity);
                    });
                    assert_eq!(seen, expected, "{signal:?} {compensation} {merit} {rule:?}");
                }
            }
            // A frame without a seventh byte contains no state.
            let short = Slope::of(signal.identifier(0xE4), &data[..6]);
            assert_eq!(short, Some(Slope { compensation: 3, merit: 3 }));
            for compensated in [true, false] {
                signal.set_compensated(compensated, &mut data);
                let said = Slope::of(signal.identifier(0xE4), &data).map(|s| s.compensation);
                assert_eq!(said, Some(u8::from(!compensated)));
            }
        }
        assert_eq!(Slope::of(SPEED.identifier(0), &[0; 8]), None);
    }

    #[test]
    fn identifiers_carry_group_and_source() {
        assert_eq!(STEERING_WHEEL_ANGLE.identifier(0x3E), 0x18F0_093E);
        assert_eq!(pgn_of(0x18F0_093E), 61449);
        assert_eq!(pgn_of(0x0CF0_29E4), 61481);
        assert_eq!(pgn_of(0x18EA_FF00), 0xEA00); // the destination address is not included
    }

    /// Values for raw 0 and per bit as printed in J1939-71: degrees, km/h, kg, kPa and SI
    /// units.
    #[test]
    fn every_signal_has_the_scale_and_the_offset_of_its_standard() {
        let (rad, deg, kmh, kpa) = (1.0, core::f64::consts::PI / 180.0, 1.0 / 3.6, 1e3);
        for (signal, unit, offset, per_bit) in [
            (STEERING_WHEEL_ANGLE, rad, -31.374, 1.0 / 1024.0),
            (STEERING_WHEEL_ANGLE_SAS, rad, -31.374, 1.0 / 1024.0),
            (YAW_RATE, rad, -3.92, 1.0 / 8192.0),
            (LATERAL_ACCELERATION, rad, -15.687, 1.0 / 2048.0),
            (ROLL, deg, -64.0, 0.002),
            (ROLL_FINE, deg, -250.0, 1.0 / 32768.0),
            (ROLL_RATE, deg, -250.0, 1.0 / 128.0),
            (SPEED, kmh, 0.0, 1.0 / 256.0),
            (FRONT_AXLE_SPEED, kmh, 0.0, 1.0 / 256.0),
            (TRAILER_MASS, rad, 0.0, 2.0),
            (TRAILER_AXLE_LOAD, rad, 0.0, 2.0),
            (LEVEL_FRONT_LEFT, rad, -3.2, 1e-4),
            (LEVEL_FRONT_RIGHT, rad, -3.2, 1e-4),
            (LEVEL_REAR_LEFT, rad, -3.2, 1e-4),
            (LEVEL_REAR_RIGHT, rad, -3.2, 1e-4),
            (BELLOWS_REAR_LEFT, kpa, 0.0, 0.1),
            (BELLOWS_REAR_RIGHT, kpa, 0.0, 0.1),
            (CG_HEIGHT, rad, 0.0, 0.001),
            (CG_HEIGHT_SD, rad, 0.0, 0.005),
            (CG_THRESHOLD, rad, 0.0, 0.005),
            (CG_MARGIN, rad, -1.25, 0.01),
        ] {
            let mut data = [0; 8];
            let at = |data: &[u8]| signal.decode::<f64>(data).unwrap() / unit;
            assert!((at(&data) - offset).abs() < 1e-12, "{signal:?}");
            data[usize::from(signal.first_byte)] = 100;
            assert!((at(&data) - (offset + 100.0 * per_bit)).abs() < 1e-12, "{signal:?}");
        }
    }

    /// 0xFA and all lower bits set: 250, 64255 and 16449535.
    #[test]
    fn the_greatest_raw_value_is_a_value_and_the_next_is_none() {
        for (signal, greatest) in [(CG_MANEUVERS, 250), (SPEED, 0xFAFF), (ROLL_FINE, 0xFA_FFFF)] {
            let value = |raw: u32| signal.offset + signal.scale * f64::from(raw);
            let mut data = [0; 8];
            assert!(signal.encode(value(greatest), &mut data), "{signal:?}");
            let back: f64 = signal.decode(&data).unwrap();
            assert!((back - value(greatest)).abs() < 1e-9 * back.abs());
            assert!(!signal.encode(value(greatest + 1), &mut data), "{signal:?}");
            assert!(signal.encode(value(0), &mut data));
        }
    }

    #[test]
    fn a_frame_gives_its_signals_with_their_ranks() {
        let seen = |identifier: u32, wanted: Quantity| {
            let (mut count, mut ranks) = (0, None);
            decode(identifier, &[0x10; 8], Compensation::On, |quantity, rank, _: f64| {
                count += 1;
                if quantity == wanted {
                    ranks = Some(rank);
                }
            });
            (count, ranks)
        };
        assert_eq!(seen(YAW_RATE.identifier(0x0B), Quantity::YawRate), (3, Some(0)));
        assert_eq!(seen(ROLL.identifier(0xE4), Quantity::RollToGravity), (1, Some(1)));
        assert_eq!(seen(ROLL_FINE.identifier(0xE4), Quantity::RollToGravity), (1, Some(0)));
        assert_eq!(seen(FRONT_AXLE_SPEED.identifier(0x0B), Quantity::Speed), (1, Some(1)));
        assert_eq!(seen(CG_HEIGHT.identifier(0x0B), Quantity::Speed), (0, None));
    }

    /// Frames of two real trucks, ASC3 and VDC2. The raw values are 31965 and 31971; 31954, 32032,
    /// 31967 and 31995; 32105, 32099 and 32599.
    #[test]
    fn frames_of_real_trucks_have_the_values_of_their_standard() {
        let check = |signal: Signal, data: [u8; 8], expected: Option<f64>| {
            let found = signal.decode::<f64>(&data);
            let close = |expected: f64| found.is_some_and(|found| (found - expected).abs() < 1e-9);
            assert!(expected.map_or(found.is_none(), close), "{signal:?}: {found:?}");
        };
        assert_eq!([pgn_of(0x18FE_592F), pgn_of(0x18FE_582F)], [65113, 65112]);
        let levels = [LEVEL_FRONT_LEFT, LEVEL_FRONT_RIGHT, LEVEL_REAR_LEFT, LEVEL_REAR_RIGHT];
        let of_rear = 0xFFFF_FFFF_DD7C_E37C_u64.to_be_bytes();
        let of_all = 0xD27C_207D_DF7C_FB7C_u64.to_be_bytes();
        for (k, signal) in levels.into_iter().enumerate() {
            check(signal, of_rear, [None, None, Some(-0.0035), Some(-0.0029)][k]);
            check(signal, of_all, Some([-0.0046, 0.0032, -0.0033, -0.0005][k]));
        }
        let vdc2 = 0x697D_7F63_7D57_7F7D_u64.to_be_bytes();
        check(STEERING_WHEEL_ANGLE, vdc2, Some(32_105.0 / 1024.0 - 31.374));
        check(YAW_RATE, vdc2, Some(32_099.0 / 8192.0 - 3.92));
        check(LATERAL_ACCELERATION, vdc2, Some(32_599.0 / 2048.0 - 15.687));
    }

    /// From format 240 on, the group number has 18 bits.
    #[test]
    fn groups_below_240_leave_their_destination_out() {
        assert_eq!(pgn_of(0x18EF_1234), 0xEF00);
        assert_eq!(pgn_of(0x18F0_1234), 0xF012);
        assert_eq!(pgn_of(0x1BFF_FF00), 0x3_FFFF);
        assert_eq!(pgn_of(0x1DEF_1234), 0x1_EF00);
    }
}
