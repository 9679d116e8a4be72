//! Random and damaged CAN text and frames, and the two decoders compared with each other.
//!
//! `PROPTEST_CASES=1000000` runs more cases.

#![cfg(feature = "dbc")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use cg_core::Quantity;
use cg_core::signal::j1939;
use cg_core::signal::j1939::{Compensation, Slope};
use cg_logs::can::{Content, Decoder, Frame, MappedSignal, SignalMap, parse};
use cg_logs::log::Signal;
use proptest::prelude::*;

const DBC: &str = include_str!("../../../fixtures/can/j1939.dbc");

/// The signals of the core's table with their names in the DBC file; SSI also as tilt.
const NAMES: [(&str, Quantity, u32); 13] = [
    ("VDC2.SteeringWheelAngle", Quantity::SteeringWheel, 61449),
    ("VDC2.YawRate", Quantity::YawRate, 61449),
    ("VDC2.LateralAcceleration", Quantity::TractorLateralSpecificForce, 61449),
    ("SSI2.RollAngle", Quantity::RollToGravity, 61481),
    ("SAS.SteeringWheelAngle", Quantity::SteeringWheel, 61469),
    ("CCVS1.WheelBasedVehicleSpeed", Quantity::Speed, 65265),
    ("EBC2.FrontAxleSpeed", Quantity::Speed, 65215),
    ("VW.TrailerWeight", Quantity::TrailerMass, 65258),
    ("EBS22.AxleLoadSum", Quantity::TrailerAxleLoad, 65220),
    ("ASC3.RearLeftLevel", Quantity::TractorLevelLeft, 65113),
    ("ASC3.RearRightLevel", Quantity::TractorLevelRight, 65113),
    ("ASC4.RearLeftPressure", Quantity::DrivePressureLeft, 65112),
    ("ASC4.RearRightPressure", Quantity::DrivePressureRight, 65112),
];

fn mapped(signal: &str, quantity: Quantity) -> MappedSignal {
    let map: SignalMap = format!("{}={signal}", Signal::from(quantity)).parse().unwrap();
    MappedSignal::parse("j1939.dbc", DBC, &[map]).unwrap().remove(0)
}

proptest! {
    /// Every signal of the table, decoded by the DBC file and by the table, in any frame: either
    /// both have a value or neither, and the values are equal except for rounding.
    #[test]
    fn the_table_and_the_dbc_file_say_the_same(
        data in any::<[u8; 8]>(),
        length in 0_usize..=8,
        priority in 0_u32..8,
        source in any::<u8>(),
    ) {
        for (signal, quantity, pgn) in NAMES {
            let identifier = priority << 26 | pgn << 8 | u32::from(source);
            let frame = Frame::new(0, identifier, true, &data[..length]).unwrap();
            let mut by_table = None;
            j1939::decode(identifier, frame.data(), Compensation::On, |found, _, value: f64| {
                if found == quantity {
                    by_table = Some(value);
                }
            });
            let by_dbc = mapped(signal, quantity).decode(&frame).filter(|_| {
                // The figure of merit of a slope sensor also decides whether there is a value.
                Slope::of(identifier, frame.data()).is_none_or(|slope| slope.merit != 2)
            });
            match (by_table, by_dbc) {
                (Some(a), Some(b)) => prop_assert!((a - b).abs() <= 1e-12 * (1.0 + a.abs()), "{signal} {a} {b}"),
                (a, b) => prop_assert_eq!(a, b, "{}", signal),
            }
        }
    }

    /// A valid line with some bytes changed, removed or inserted is read or refused without a
    /// panic. If it is read, the frame is possible.
    #[test]
    fn a_damaged_line_is_read_or_refused(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0_u8..3), 0..6),
        plain in any::<bool>(),
    ) {
        let lines = [
            &b"(1436509052.249713) can0 18F0090B#0011FF8899AABBCC"[..],
            b" (1436509052.249713)  can0  18F0090B   [8]  00 11 FF 88 99 AA BB CC",
        ];
        let mut line = lines[usize::from(plain)].to_vec();
        for (place, byte, edit) in edits {
            let k = place.index(line.len().max(1)).min(line.len().saturating_sub(1));
            match edit {
                0 if !line.is_empty() => line[k] = byte,
                1 if !line.is_empty() => drop(line.remove(k)),
                _ => line.insert(k, byte),
            }
        }
        let text = String::from_utf8_lossy(&line);
        if let Ok(Some(line)) = parse(&text) && let Content::Data(frame) = line.content {
            prop_assert!(frame.identifier < 1 << 29 && frame.data().len() <= 64);
            Decoder::default().decode(&frame, |_, _, value| assert!(value.is_finite()));
        }
    }

    /// A DBC file with some bytes changed or a part cut off is parsed or refused.
    #[test]
    fn a_damaged_dbc_file_is_read_or_refused(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        end in any::<prop::sample::Index>(),
        whole in any::<bool>(),
        data in any::<[u8; 8]>(),
    ) {
        let mut text = DBC.as_bytes().to_vec();
        for (place, byte) in edits {
            let k = place.index(text.len());
            text[k] = byte;
        }
        if !whole {
            text.truncate(end.index(text.len()));
        }
        let map: SignalMap = "roll=SSI2.RollAngle".parse().unwrap();
        let text = String::from_utf8_lossy(&text);
        if let Ok(found) = MappedSignal::parse("damaged.dbc", &text, &[map]) {
            let frame = Frame::new(0, 0x0CF0_29E4, true, &data).unwrap();
            let _ = found[0].decode(&frame);
        }
    }

    #[test]
    fn any_text_is_a_mapping_or_an_explanation(text in "[a-z_]{0,8}=?\\PC{0,20}") {
        if let Err(message) = text.parse::<SignalMap>() {
            let message = message.to_string();
            prop_assert!(message.contains("expected") || message.contains("no quantity"), "{message}");
        }
    }
}

/// What is said of one quantity of a sensor holds for the mapped signal of another one, as it does for J1939's.
#[test]
fn the_sign_of_a_sibling_is_that_of_a_mapped_signal() {
    use Quantity::{Roll, RollToGravity, Speed, Steer, SteeringWheel, Tilt};
    let value = |signal: &str, quantity, flipped: &[Quantity]| {
        let decoder = Decoder::new(vec![mapped(signal, quantity)], Vec::new(), flipped.to_vec());
        let pgn = NAMES.iter().find(|(name, ..)| *name == signal).unwrap().2;
        let frame = Frame::new(0, 0x0C00_0000 | pgn << 8, true, &[0x70; 8]).unwrap();
        let mut found = Vec::new();
        decoder.decode(&frame, |of, _, value| found.extend((of == quantity).then_some(value)));
        found[0]
    };
    for (signal, quantity, siblings) in [
        ("SSI2.RollAngle", RollToGravity, &[Roll, RollToGravity, Tilt][..]),
        ("SSI2.RollAngle", Tilt, &[Roll]),
        ("VDC2.SteeringWheelAngle", SteeringWheel, &[Steer]),
    ] {
        let upright = value(signal, quantity, &[Speed]);
        assert!(upright.abs() > 1e-3, "{signal} {upright}");
        for flipped in siblings {
            let turned = value(signal, quantity, &[*flipped]);
            assert!((upright + turned).abs() < 1e-12, "{signal} {flipped}: {upright} {turned}");
        }
    }
}

/// In J1939 all bits of a field are set if there is no value, but one bit has two values only.
#[test]
fn a_field_of_one_bit_has_both_values() {
    const AXLE: &str = r#"VERSION ""

BU_: TRAILER

BO_ 2566851100 AXLE: 8 TRAILER
 SG_ One : 0|1@1+ (1,0) [0|1] "" Vector__XXX
 SG_ Two : 4|2@1+ (1,0) [0|3] "" Vector__XXX
"#;
    let read = |signal: &str, byte: u8| {
        let map: SignalMap = format!("lift_axle=AXLE.{signal}").parse().unwrap();
        let mapped = MappedSignal::parse("axle.dbc", AXLE, &[map]).unwrap();
        let frame = Frame::new(0, 0x18FF_0A55, true, &[byte]).unwrap();
        Decoder::new(mapped, Vec::new(), Vec::new()).lift_axle(&frame)
    };
    assert_eq!([0x00, 0x01, 0xFF].map(|byte| read("One", byte)), [Some(0.0), Some(1.0), Some(1.0)]);
    assert_eq!([0x00, 0x10, 0x30].map(|byte| read("Two", byte)), [Some(0.0), Some(1.0), None]);
}

#[cfg(unix)]
#[test]
fn an_endless_dbc_file_is_refused_at_once() {
    let error = MappedSignal::load("/dev/zero".as_ref(), &[]).unwrap_err().to_string();
    assert!(error.starts_with("/dev/zero: cannot be read"), "{error}");
    assert!(error.contains("MiB that such a file may have"), "{error}");
}
