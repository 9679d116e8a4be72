//! Decoding of CAN frames into values, by the J1939 table or by signals of a DBC file.

use cg_core::Quantity;
use cg_core::signal::j1939::{self, Compensation, Slope};

use super::dbc::{Mapped, MappedSignal, RANK};
use super::device_filter::{DeviceFilter, siblings};
use super::frame::Frame;

/// A number that identifies the sending device, and the rank of its signal, for
/// [`cg_core::Aligner::push`].
pub type Device = (u32, u8);

/// Bit that marks an 11-bit identifier in device numbers.
pub(super) const STANDARD: u32 = 0x8000_0000;
/// The five bits of the bus in device numbers.
pub(super) const BUS: u32 = 0x7C00_0000;
const WITHOUT_PRIORITY: u32 = 0x03FF_FFFF;

/// What the lateral acceleration of VDC2 (SPN 1809) is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Vdc2 {
    /// The specific force of the tractor: the sensor is fixed to its body and also feels gravity.
    #[default]
    SpecificForce,
    /// The acceleration of the path: its maker subtracts gravity.
    Acceleration,
}

cg_core::words!(Vdc2 {
    SpecificForce => "specific-force", "The reading of a sensor fixed to the tractor's body, gravity included";
    Acceleration => "acceleration", "The acceleration of the path: the device compensates gravity";
});

/// Decodes CAN frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decoder {
    mapped: Vec<MappedSignal>,
    filters: Vec<DeviceFilter>,
    flipped: Vec<Quantity>,
    compensation: Compensation,
    vdc2: Vdc2,
}

impl Decoder {
    /// A decoder for J1939. Mapped signals replace the J1939 signals of the same quantity.
    /// `filters` restrict quantities to one source address, and `flipped` reverses the signs of
    /// quantities. The compensation bits of a slope sensor decide whether it measures roll or tilt.
    pub fn new(
        mapped: Vec<MappedSignal>,
        filters: Vec<DeviceFilter>,
        flipped: Vec<Quantity>,
    ) -> Self {
        Self {
            mapped,
            filters,
            flipped,
            compensation: Compensation::default(),
            vdc2: Vdc2::default(),
        }
    }

    /// Uses another rule for slope sensors.
    #[must_use]
    pub fn with_compensation(self, compensation: Compensation) -> Self {
        Self { compensation, ..self }
    }

    /// Uses the lateral acceleration of VDC2 as this.
    #[must_use]
    pub fn with_vdc2(self, vdc2: Vdc2) -> Self {
        Self { vdc2, ..self }
    }

    /// Decodes a frame: calls `found` with quantity, device and SI value. It returns the state that
    /// a slope sensor reports about its roll angle, if the frame is from a slope sensor that is in
    /// use.
    pub fn decode(
        &self,
        frame: &Frame,
        mut found: impl FnMut(Quantity, Device, f64),
    ) -> Option<Slope> {
        let kind = if frame.extended { 0 } else { STANDARD };
        let number = frame.identifier & WITHOUT_PRIORITY | kind | bus_bits(frame.bus);
        for signal in self.mapped.iter().filter(|signal| signal.is_of(frame)) {
            let Mapped::Quantity(quantity) = signal.measures else { continue };
            if let Some(value) = signal.decode(frame).filter(|_| self.accepts(quantity, frame)) {
                found(quantity, (number, RANK), self.sign(quantity) * value);
            }
        }
        if !frame.extended {
            return None;
        }
        let listens = |quantity| !self.is_replaced(quantity) && self.accepts(quantity, frame);
        j1939::decode(
            frame.identifier,
            frame.data(),
            self.compensation,
            |quantity, rank, value| {
                let is_mapped = self.reads(quantity, frame);
                let quantity = self.meant(quantity);
                if listens(quantity) && !is_mapped {
                    let value: f64 = value;
                    found(quantity, (number, rank), self.sign(quantity) * value);
                }
            },
        );
        Slope::of(frame.identifier, frame.data()).filter(|_| listens(Quantity::Roll))
    }

    /// Whether some frame may have the position of the lift axles.
    pub fn maps_lift_axle(&self) -> bool {
        self.mapped.iter().any(|signal| signal.measures == Mapped::LiftAxle)
    }

    /// The position of the lift axles in a frame.
    pub fn lift_axle(&self, frame: &Frame) -> Option<f64> {
        let mut mapped = self.mapped.iter().filter(|signal| signal.measures == Mapped::LiftAxle);
        mapped.find(|signal| signal.is_of(frame))?.decode(frame)
    }

    /// Calls `found` with each quantity of a frame that is not used because a [filter](DeviceFilter) accepts it from
    /// another source address, and with the address of the frame.
    pub(super) fn refused(&self, frame: &Frame, mut found: impl FnMut(Quantity, u8)) {
        if self.filters.is_empty() || !frame.extended {
            return;
        }
        let mut refuse = |quantity| {
            if !self.accepts(quantity, frame) {
                found(quantity, address_of(frame));
            }
        };
        let mapped =
            self.mapped.iter().filter(|one| one.is_of(frame) && one.decode(frame).is_some());
        mapped.filter_map(|signal| signal.measures.quantity()).for_each(&mut refuse);
        let found = |quantity, _, _: f64| {
            let is_mapped = self.reads(quantity, frame);
            let quantity = self.meant(quantity);
            if !is_mapped && !self.is_replaced(quantity) {
                refuse(quantity);
            }
        };
        j1939::decode(frame.identifier, frame.data(), self.compensation, found);
    }

    /// Whether some frame could have a value of this quantity, or of another one that the same sensor measures.
    pub fn may_give(&self, quantity: Quantity) -> bool {
        let is_of = |of: Quantity| siblings(self.meant(of)).contains(&quantity);
        self.mapped().any(|mapped| mapped == quantity)
            || j1939::TABLE.iter().any(|(_, of, _)| is_of(*of))
    }

    /// The filters of source addresses.
    pub(super) fn filters(&self) -> &[DeviceFilter] {
        &self.filters
    }

    /// The quantity that a signal of J1939 measures.
    fn meant(&self, quantity: Quantity) -> Quantity {
        match (quantity, self.vdc2) {
            (Quantity::TractorLateralSpecificForce, Vdc2::Acceleration) => {
                Quantity::LateralAcceleration
            }
            _ => quantity,
        }
    }

    /// Whether a mapped signal is the field of the J1939 signal of this quantity in a frame, which then
    /// measures what the mapping says and nothing else.
    fn reads(&self, quantity: Quantity, frame: &Frame) -> bool {
        let is_of = |signal: &j1939::Signal| {
            signal.pgn == j1939::pgn_of(frame.identifier)
                && self.mapped.iter().any(|mapped| {
                    mapped.is_of(frame) && mapped.begins_at(u16::from(signal.first_byte) * 8)
                })
        };
        !self.mapped.is_empty()
            && j1939::TABLE.iter().any(|(signal, of, _)| *of == quantity && is_of(signal))
    }

    /// The quantities of the mapped signals, in the order of the options.
    pub fn mapped(&self) -> impl Iterator<Item = Quantity> {
        self.mapped.iter().filter_map(|signal| signal.measures.quantity())
    }

    /// Whether a yaw rate is that of VDC2, which is the tractor's.
    pub fn has_tractor_yaw(&self) -> bool {
        !self.is_replaced(Quantity::YawRate)
    }

    /// Whether a lateral acceleration is that of VDC2, likewise.
    pub fn has_tractor_acceleration(&self) -> bool {
        self.vdc2 == Vdc2::Acceleration && !self.is_replaced(Quantity::LateralAcceleration)
    }

    /// The rule for slope sensors.
    pub fn compensation(&self) -> Compensation {
        self.compensation
    }

    /// Whether a mapped signal replaces the J1939 signal of a quantity. This is the case if it
    /// measures the same quantity, or one over which the J1939 signal would be preferred. J1939
    /// signals from which the trailer mass follows less directly remain as a reserve.
    fn is_replaced(&self, quantity: Quantity) -> bool {
        let replacing: &[Quantity] = match quantity {
            Quantity::TrailerMass => &[
                Quantity::TrailerMass,
                Quantity::TrailerAxleLoad,
                Quantity::TrailerSuspensionPressure,
            ],
            Quantity::TrailerAxleLoad => {
                &[Quantity::TrailerAxleLoad, Quantity::TrailerSuspensionPressure]
            }
            _ => siblings(quantity),
        };
        self.mapped().any(|mapped| replacing.contains(&mapped))
    }

    /// The sign of a quantity: −1 if it, or another one that the same sensor measures, is flipped.
    fn sign(&self, quantity: Quantity) -> f64 {
        let is_flipped = siblings(quantity).iter().any(|one| self.flipped.contains(one));
        if is_flipped { -1.0 } else { 1.0 }
    }

    /// Whether a quantity is accepted from the source address of a frame. Frames with 11-bit identifiers have none.
    fn accepts(&self, quantity: Quantity, frame: &Frame) -> bool {
        let is_of = |filter: &&DeviceFilter| siblings(quantity).contains(&filter.quantity());
        let mut filters = self.filters.iter().filter(is_of).peekable();
        !frame.extended
            || filters.peek().is_none()
            || filters.any(|filter| filter.address() == address_of(frame))
    }

    /// Identifier, whether it has 29 bits, and mask of all frames with usable values, for a kernel
    /// filter.
    pub fn frames(&self) -> Vec<(u32, bool, u32)> {
        const GROUP: u32 = 0x03FF_FF00;
        let mut frames: Vec<(u32, bool, u32)> =
            j1939::TABLE.iter().map(|(signal, ..)| (signal.pgn << 8, true, GROUP)).collect();
        frames.extend(self.mapped.iter().map(|signal| {
            let (identifier, extended, by_group) = signal.filter();
            let whole = if extended { 0x1FFF_FFFF } else { 0x7FF };
            (identifier, extended, if by_group { GROUP } else { whole })
        }));
        frames.sort_unstable();
        frames.dedup();
        frames
    }
}

/// The source address in a 29-bit identifier.
const fn address_of(frame: &Frame) -> u8 {
    frame.identifier.to_le_bytes()[0]
}

/// The bus number in five bits that no identifier uses, so that devices on different buses have
/// different numbers.
const fn bus_bits(bus: u8) -> u32 {
    (bus as u32) << BUS.trailing_zeros() & BUS
}

#[cfg(test)]
#[cfg(feature = "dbc")]
mod tests {
    use super::*;
    use crate::can::SignalMap;
    use crate::can::dbc::named;

    const DBC: &str = r#"VERSION ""

BU_: TILT

BO_ 2566851100 SLOPE: 8 TILT
 SG_ Angle : 0|16@1- (0.01,0) [-90|90] "deg" Vector__XXX
 SG_ Bare : 16|16@1+ (0.001,0) [0|0] "" Vector__XXX
 SG_ Wide : 32|8@1+ (1,0) [0|200] "km/h" Vector__XXX

BO_ 291 PLAIN: 8 TILT
 SG_ Motorola : 7|16@0- (0.5,1) [0|0] "deg" Vector__XXX
"#;

    fn decoder(maps: &[&str]) -> Decoder {
        let maps: Vec<SignalMap> = maps.iter().map(|map| map.parse().unwrap()).collect();
        let mapped = MappedSignal::parse("tilt.dbc", DBC, &maps).unwrap();
        Decoder::new(mapped, Vec::new(), Vec::new())
    }

    fn values(decoder: &Decoder, identifier: u32, data: &[u8]) -> Vec<(Quantity, f64)> {
        let extended = identifier > 0x7FF;
        let frame = Frame::new(0, identifier, extended, data).unwrap();
        let mut values = Vec::new();
        decoder.decode(&frame, |quantity, _, value| values.push((quantity, value)));
        values
    }

    /// −2.00 degrees, then with reversed sign and with 0.3 degrees added.
    #[test]
    fn a_mapped_signal_takes_scale_sign_and_offset() {
        let data = [0x38, 0xFF, 0, 0, 50, 0, 0, 0];
        let id = 0x18FF_0A1C;
        for (map, degrees) in [
            ("roll=SLOPE.Angle", -2.0_f64),
            ("roll=SLOPE.Angle*-1", 2.0),
            ("roll=SLOPE.Angle[deg]*-1+0.3", 2.3),
            ("roll=SLOPE.Angle*1e-1-0.5", -0.7),
            ("roll=SLOPE.Angle+1", -1.0),
        ] {
            let found = values(&decoder(&[map]), id, &data);
            assert_eq!(found.len(), 1, "{map}");
            assert!((found[0].1 - degrees.to_radians()).abs() < 1e-12, "{map} {found:?}");
        }
        // A frame with another priority and source address belongs to the same group.
        let found = values(&decoder(&["speed=SLOPE.Wide"]), 0x0CFF_0A55, &data);
        assert_eq!(found, [(Quantity::Speed, 50.0 / 3.6)]);
        // A value outside the range, a value that is not available, and a frame that is too short.
        for bad in [&[0x38, 0x7F, 0, 0, 201, 0, 0, 0][..], &[0, 0, 0, 0, 0xFF], &[0, 0]] {
            assert!(values(&decoder(&["speed=SLOPE.Wide"]), id, bad).is_empty());
        }
    }

    #[test]
    fn big_endian_fields_and_short_identifiers_work() {
        let found = values(&decoder(&["tilt=PLAIN.Motorola"]), 0x123, &[0xFF, 0xFE]);
        assert_eq!(found, [(Quantity::Tilt, 0.0)]); // −2 · 0.5 + 1
    }

    /// A frame with one J1939 signal.
    fn sent(signal: j1939::Signal, value: f64) -> (u32, [u8; 8]) {
        let mut data = j1939::NOT_AVAILABLE;
        signal.encode(value, &mut data);
        signal.set_compensated(true, &mut data);
        (signal.identifier(0xE4), data)
    }

    /// A mapped signal also replaces another measurement of the same: a tilt replaces a roll angle,
    /// and the suspension pressure replaces a mass.
    #[test]
    fn a_mapped_signal_replaces_j1939() {
        let j1939s = [
            (sent(j1939::ROLL_FINE, 0.1), Quantity::RollToGravity),
            (sent(j1939::ROLL, 0.1), Quantity::RollToGravity),
            (sent(j1939::STEERING_WHEEL_ANGLE, 0.1), Quantity::SteeringWheel),
            (sent(j1939::TRAILER_MASS, 2e4), Quantity::TrailerMass),
            (sent(j1939::TRAILER_AXLE_LOAD, 2e4), Quantity::TrailerAxleLoad),
        ];
        for (map, replaced) in [
            (None, [false; 5]),
            (Some("roll=SLOPE.Angle"), [true, true, false, false, false]),
            (Some("tilt=SLOPE.Angle"), [true, true, false, false, false]),
            (Some("steer=SLOPE.Angle"), [false, false, true, false, false]),
            (Some("trailer_mass=SLOPE.Bare[t]"), [false, false, false, true, false]),
            (Some("trailer_axle_load=SLOPE.Bare[t]"), [false, false, false, true, true]),
            (
                Some("trailer_suspension_pressure=SLOPE.Bare[bar]"),
                [false, false, false, true, true],
            ),
        ] {
            let decoder = decoder(map.as_slice());
            for (((identifier, data), quantity), replaced) in j1939s.iter().zip(replaced) {
                let found = values(&decoder, *identifier, data);
                let expected = if replaced { None } else { Some(*quantity) };
                assert_eq!(found.first().map(|found| found.0), expected, "{map:?}");
            }
        }
    }

    /// A J1939 signal is mapped itself. Only the mapped quantity is decoded.
    #[test]
    fn the_native_signal_mapped_as_a_tilt_is_a_tilt_only() {
        let dbc = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/can/j1939.dbc");
        let map = ["tilt=SSI2.RollAngle".parse().unwrap()];
        let decoder =
            Decoder::new(MappedSignal::load(dbc.as_ref(), &map).unwrap(), Vec::new(), Vec::new());
        let (identifier, data) = sent(j1939::ROLL_FINE, 0.1);
        let found = values(&decoder, identifier, &data);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, Quantity::Tilt);
        assert!((found[0].1 - 0.1).abs() < 1e-6);
    }

    /// A device that compensates gravity sends the acceleration of the path: by the option, or because
    /// the signal itself is mapped as that.
    #[test]
    fn the_lateral_acceleration_of_vdc2_is_what_one_says() {
        let dbc = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/can/j1939.dbc");
        let (identifier, data) = sent(j1939::LATERAL_ACCELERATION, 1.5);
        let force = Decoder::default();
        let acceleration = Decoder::default().with_vdc2(Vdc2::Acceleration);
        let map = ["lateral_acceleration=VDC2.LateralAcceleration".parse().unwrap()];
        let mapped = MappedSignal::load(dbc.as_ref(), &map).unwrap();
        let mapped = Decoder::new(mapped, Vec::new(), Vec::new());
        for (decoder, quantity) in [
            (force, Quantity::TractorLateralSpecificForce),
            (acceleration, Quantity::LateralAcceleration),
            (mapped, Quantity::LateralAcceleration),
        ] {
            let found = values(&decoder, identifier, &data);
            let quantities: Vec<_> = found.iter().map(|found| found.0).collect();
            assert_eq!(quantities, [quantity]);
            assert!((found[0].1 - 1.5).abs() < 1e-3);
        }
    }

    /// Sign and source address given for the roll angle also apply to the tilt that the sensor may
    /// measure instead.
    #[test]
    fn roll_and_tilt_of_a_slope_sensor_are_one_sensor() {
        let (identifier, mut data) = sent(j1939::ROLL_FINE, 0.1);
        for compensated in [true, false] {
            j1939::ROLL_FINE.set_compensated(compensated, &mut data);
            let expected = if compensated { Quantity::RollToGravity } else { Quantity::Tilt };
            for (asked, address, count) in [("roll", 0xE4, 1), ("tilt", 0xE4, 1), ("roll", 5, 0)] {
                let filter = format!("{asked}={address}").parse().unwrap();
                let flip = named(asked).unwrap();
                let decoder = Decoder::new(Vec::new(), vec![filter], vec![flip]);
                let found = values(&decoder, identifier, &data);
                assert_eq!(found.len(), count);
                assert!(found.iter().all(|found| found.0 == expected && found.1 < 0.0));
            }
        }
    }

    #[test]
    fn what_a_slope_sensor_says_of_itself_is_handed_on() {
        let (identifier, mut data) = sent(j1939::ROLL_FINE, 0.1);
        data[6] = 0x9F; // not compensated, error
        let frame = Frame::new(0, identifier, true, &data).unwrap();
        let slope = |decoder: &Decoder| decoder.decode(&frame, |_, _, _| panic!("no value"));
        assert_eq!(slope(&decoder(&[])), Some(Slope { compensation: 1, merit: 2 }));
        assert_eq!(slope(&decoder(&["roll=SLOPE.Angle"])), None);
    }

    #[test]
    fn a_device_on_another_bus_is_another_device() {
        let (identifier, data) = sent(j1939::ROLL_FINE, 0.1);
        let mut frame = Frame::new(0, identifier, true, &data).unwrap();
        let mut devices = Vec::new();
        for bus in [0, 1, 2] {
            frame.bus = bus;
            decoder(&[]).decode(&frame, |_, device, _| devices.push(device));
        }
        devices.dedup();
        assert_eq!(devices.len(), 3);
    }

    #[test]
    fn a_source_address_can_be_asked_for_and_signs_turned() {
        let filter = "roll=0xE5".parse().unwrap();
        let decoder = Decoder::new(Vec::new(), vec![filter], vec![Quantity::Roll]);
        let mut data = j1939::NOT_AVAILABLE;
        j1939::ROLL_FINE.encode(0.1, &mut data);
        j1939::ROLL_FINE.set_compensated(true, &mut data);
        assert_eq!(values(&decoder, j1939::ROLL_FINE.identifier(0xE4), &data), []);
        let found = values(&decoder, j1939::ROLL_FINE.identifier(0xE5), &data);
        assert!((found[0].1 + 0.1).abs() < 1e-6);
        assert!("roll=0xFF".parse::<DeviceFilter>().is_err());
        assert!(
            "rol=1"
                .parse::<DeviceFilter>()
                .unwrap_err()
                .to_string()
                .contains("lateral_acceleration")
        );
    }

    #[test]
    fn mistakes_in_a_mapping_say_what_to_do() {
        let error = |map: &str| {
            let maps = [map.parse::<SignalMap>().unwrap()];
            MappedSignal::parse("tilt.dbc", DBC, &maps).unwrap_err().to_string()
        };
        assert!(error("roll=SLOP.Angle").contains("only SLOPE, PLAIN"));
        assert!(error("roll=SLOPE.Angel").contains("only SLOPE.Angle, SLOPE.Bare, SLOPE.Wide"));
        assert!(error("roll=SLOPE.Bare").contains("give the unit: roll=SLOPE.Bare[rad]"));
        assert!(error("speed=SLOPE.Angle").contains("\"deg\" is not one of m/s, km/h"));
        for map in ["roll", "roll=SLOPE.A[deg", "roll=SLOPE.A*0", "roll=SLOPE.A*x", "roll=A.B+"] {
            assert!(map.parse::<SignalMap>().is_err(), "{map}");
        }
        let twice = ["roll=SLOPE.Angle", "roll=SLOPE.Angle*-1"].map(|map| map.parse().unwrap());
        let error = MappedSignal::parse("tilt.dbc", DBC, &twice).unwrap_err().to_string();
        assert!(error.contains("Angle*-1⟩: this signal is given for roll before, too"), "{error}");
        let number = DBC.lines().find(|line| line.contains(" SLOPE:")).unwrap();
        let number = number.split(' ').nth(1).unwrap();
        let float = format!("{DBC}\nSIG_VALTYPE_ {number} Angle : 1;\n");
        let error = MappedSignal::parse("tilt.dbc", &float, &twice[..1]).unwrap_err().to_string();
        assert!(error.contains("floating point"), "{error}");
        let broken = MappedSignal::parse("x.dbc", "BO_ what", &[]).unwrap_err().to_string();
        assert!(broken.starts_with("x.dbc: not a DBC file"), "{broken}");
    }
}
