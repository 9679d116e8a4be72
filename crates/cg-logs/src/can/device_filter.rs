//! The source address from which a quantity is accepted.

use std::fmt;
use std::str::FromStr;

use cg_core::Quantity;

use super::dbc::named;
use crate::malformed::Malformed;

/// The only source address from which a quantity is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceFilter {
    quantity: Quantity,
    address: u8,
}

impl DeviceFilter {
    pub(super) fn quantity(self) -> Quantity {
        self.quantity
    }

    pub(super) fn address(self) -> u8 {
        self.address
    }
}

impl fmt::Display for DeviceFilter {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}=0x{:02X}", self.quantity.name(), self.address)
    }
}

impl FromStr for DeviceFilter {
    type Err = Malformed;

    fn from_str(text: &str) -> Result<Self, Malformed> {
        let expected = "expected QUANTITY=ADDRESS with a source address from 0 to 253, as in \
                        roll=0xE4 or speed=0";
        let (name, address) = text.split_once('=').ok_or(expected)?;
        let quantity = named(name)?;
        let address = match address.strip_prefix("0x").or_else(|| address.strip_prefix("0X")) {
            Some(digits) => u8::from_str_radix(digits, 16),
            None => address.parse(),
        };
        let address = address.ok().filter(|address| *address <= 253).ok_or(expected)?;
        Ok(Self { quantity, address })
    }
}

/// The quantities of which one sensor measures one or the other.
pub(super) const fn siblings(quantity: Quantity) -> &'static [Quantity] {
    const ALL: &[Quantity] = &Quantity::ALL;
    match quantity {
        Quantity::Roll | Quantity::RollToGravity | Quantity::Tilt => {
            &[Quantity::Roll, Quantity::RollToGravity, Quantity::Tilt]
        }
        Quantity::Steer | Quantity::SteeringWheel => &[Quantity::Steer, Quantity::SteeringWheel],
        // The slice that contains only this quantity.
        _ => ALL.split_at(quantity.index()).1.split_at(1).0,
    }
}
