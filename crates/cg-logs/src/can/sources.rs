//! Which source addresses send the quantities that are accepted from one address only, and from which one to another a quantity went.

use std::collections::BTreeSet;

use cg_core::Quantity;

use super::decoder::{BUS, Device, STANDARD};
use super::device_filter::{DeviceFilter, siblings};

/// Time after the first frame within which a device should have sent a value, µs (a mass is sent once a second).
const BEGUN_US: u64 = 3_000_000;

/// What has come from the wanted addresses and from others.
#[derive(Clone, Debug, Default)]
pub(super) struct Sources {
    wanted: Vec<Wanted>,
    since_us: Option<u64>,
    /// The device of each quantity that came.
    used: Vec<(Quantity, Device)>,
    /// The first change of each quantity to another device that is not preferred, and how many of them have been told.
    changed: Vec<(Quantity, [Device; 2])>,
    told: usize,
}

/// A filter and what has come.
#[derive(Clone, Debug)]
struct Wanted {
    filter: DeviceFilter,
    /// Whether an accepted value has come.
    is_heard: bool,
    /// Addresses whose values are not accepted.
    others: BTreeSet<u8>,
    is_told: bool,
}

impl Sources {
    pub(super) fn new(filters: &[DeviceFilter]) -> Self {
        let wanted = |filter: &DeviceFilter| Wanted {
            filter: *filter,
            is_heard: false,
            others: BTreeSet::new(),
            is_told: false,
        };
        Self { wanted: filters.iter().map(wanted).collect(), ..Self::default() }
    }

    fn of(&mut self, quantity: Quantity) -> impl Iterator<Item = &mut Wanted> {
        let is_of = move |one: &&mut Wanted| siblings(quantity).contains(&one.filter.quantity());
        self.wanted.iter_mut().filter(is_of)
    }

    /// Sets the time of a frame.
    pub(super) fn begin(&mut self, now_us: u64) {
        self.since_us.get_or_insert(now_us);
    }

    /// Registers an accepted value.
    pub(super) fn heard(&mut self, quantity: Quantity) {
        self.of(quantity).for_each(|one| one.is_heard = true);
    }

    /// Registers the device whose value is used.
    pub(super) fn used(&mut self, quantity: Quantity, device: Device) {
        let Some((_, known)) = self.used.iter_mut().find(|(known, _)| *known == quantity) else {
            self.used.push((quantity, device));
            return;
        };
        if *known == device {
            return;
        }
        let before = std::mem::replace(known, device);
        let is_another = source(device) != source(before) && device.1 >= before.1;
        if is_another && !self.changed.iter().any(|(changed, _)| *changed == quantity) {
            self.changed.push((quantity, [before, device]));
        }
    }

    /// Registers a value of an address from which the quantity is not accepted.
    pub(super) fn refused(&mut self, quantity: Quantity, address: u8) {
        self.of(quantity).for_each(|one| {
            one.others.insert(address);
        });
    }

    /// Whether the devices have had time to send.
    pub(super) fn has_begun(&self, now_us: u64) -> bool {
        self.since_us.is_some_and(|since_us| now_us.saturating_sub(since_us) >= BEGUN_US)
    }

    /// The quantities of which no accepted value has come.
    pub(super) fn unheard(&self) -> Vec<Quantity> {
        let unheard = self.wanted.iter().filter(|one| !one.is_heard);
        unheard.map(|one| one.filter.quantity()).collect()
    }

    /// The sentences about filters to which only other addresses have sent, each as signal and sentence.
    pub(super) fn remarks(&self) -> Vec<(&'static str, String)> {
        let changed = self.changed.iter().map(|(quantity, devices)| change(*quantity, devices));
        self.wanted.iter().filter_map(Wanted::remark).chain(changed).collect()
    }

    /// Those sentences that have not been told.
    pub(super) fn news(&mut self) -> Vec<(&'static str, String)> {
        let untold = self.wanted.iter_mut().filter(|one| !one.is_told);
        let tell = |one: &mut Wanted| {
            let remark = one.remark();
            one.is_told = remark.is_some();
            remark
        };
        let of_filters = untold.filter_map(tell);
        let untold = std::mem::replace(&mut self.told, self.changed.len());
        let changed = self.changed.iter().skip(untold);
        of_filters.chain(changed.map(|(quantity, devices)| change(*quantity, devices))).collect()
    }
}

/// What sends as a device: an address on a bus, which may send several groups, or a frame with an 11-bit identifier.
const fn source((number, _): Device) -> u32 {
    if number & STANDARD == 0 { number & (BUS | 0xFF) } else { number }
}

/// What is said of a quantity that came from another device when the first one paused.
fn change(quantity: Quantity, devices: &[Device; 2]) -> (&'static str, String) {
    let name = quantity.name();
    let [before, now] = devices.map(|(number, _)| match number & STANDARD {
        0 => format!("0x{:02X}", number & 0xFF),
        _ => format!("the frame 0x{:X}", number & !(STANDARD | BUS)),
    });
    let [(first, _), (second, _)] = devices;
    let is_of_other_bus = (first ^ second) & BUS != 0;
    let bus = if is_of_other_bus { " on another bus" } else { "" };
    let remedy = if is_of_other_bus {
        "select one bus with ⟨bus NAME⟩".to_owned()
    } else if (first | second) & STANDARD == 0 {
        format!("accept one source with ⟨source_of {name}=ADDRESS⟩")
    } else {
        "map one of the two signals only".to_owned()
    };
    let sentence = format!(
        "{before} paused, and the values come from {now}{bus} since: if both do not measure alike, the heights are \
         wrong, which their intervals do not contain; {remedy}"
    );
    (name, sentence)
}

impl Wanted {
    fn remark(&self) -> Option<(&'static str, String)> {
        let first = self.others.first().filter(|_| !self.is_heard)?;
        let (filter, name) = (self.filter, self.filter.quantity().name());
        let others: Vec<String> = self.others.iter().map(|one| format!("0x{one:02X}")).collect();
        let sentence = format!(
            "no value comes from the address of ⟨source_of {filter}⟩, and those of {} are not used; correct the \
             address, as in ⟨source_of {name}=0x{first:02X}⟩",
            others.join(", ")
        );
        Some((name, sentence))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_that_sends_nothing_is_told_once_with_those_that_do() {
        let filters = ["roll=0x99", "speed=0"].map(|text| text.parse().unwrap());
        let mut sources = Sources::new(&filters);
        sources.begin(7);
        assert!(!sources.has_begun(3_000_006) && sources.has_begun(3_000_007));
        // A slope sensor has one address for what it measures.
        sources.refused(Quantity::Tilt, 0xE5);
        sources.refused(Quantity::RollToGravity, 0xE4);
        sources.heard(Quantity::Speed);
        assert_eq!(sources.unheard(), [Quantity::Roll]);
        let told = sources.news();
        assert_eq!((told.len(), told[0].0), (1, "roll"));
        for part in ["⟨source_of roll=0x99⟩", "0xE4, 0xE5 are", "⟨source_of roll=0xE4⟩"] {
            assert!(told[0].1.contains(part), "{told:?}");
        }
        assert!(sources.news().is_empty());
        assert_eq!(sources.remarks(), told);
        sources.heard(Quantity::Tilt);
        assert!(sources.remarks().is_empty() && sources.unheard().is_empty());
    }

    /// A preferred signal is no news, and a change that goes back and forth is told once.
    #[test]
    fn another_device_of_a_quantity_is_told() {
        let mut sources = Sources::new(&[]);
        for rank in [2, 1] {
            sources.used(Quantity::Roll, (0x00F0_29E4, rank));
            sources.used(Quantity::Speed, (0x00FE_F100, rank));
        }
        assert!(sources.news().is_empty());
        for address in [0xE5, 0xE4, 0xE5] {
            sources.used(Quantity::Roll, (0x00F0_2900 + address, 1));
        }
        sources.used(Quantity::YawRate, (STANDARD | 0x123, 0));
        sources.used(Quantity::YawRate, (STANDARD | 0x124, 0));
        let told = sources.news();
        assert_eq!(told.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["roll", "yaw_rate"]);
        assert!(told[0].1.starts_with("0xE4 paused, and the values come from 0xE5"), "{told:?}");
        assert!(told[1].1.starts_with("the frame 0x123 paused"), "{told:?}");
        assert!(told[1].1.ends_with("map one of the two signals only"), "{told:?}");
        assert!(sources.news().is_empty());
        assert_eq!(sources.remarks(), told);
    }

    /// SSI2 and SSI of one sensor; then the same address on another bus.
    #[test]
    fn one_address_with_two_groups_is_one_device() {
        let mut sources = Sources::new(&[]);
        for (group, rank) in [(0x00F0_29E4, 0), (0x00F0_13E4, 1), (0x00F0_29E4, 0)] {
            sources.used(Quantity::Roll, (group, rank));
        }
        assert_eq!(sources.news(), []);
        sources.used(Quantity::Roll, (0x04F0_29E4, 0));
        let told = sources.news();
        let begin = "0xE4 paused, and the values come from 0xE4 on another bus since";
        assert!(told[0].1.starts_with(begin) && told[0].1.ends_with("⟨bus NAME⟩"), "{told:?}");
    }
}
