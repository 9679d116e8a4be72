//! Finds mapped signals in a DBC file.

use can_dbc::{ByteOrder, Dbc, MessageId, MultiplexIndicator, SignalExtendedValueType, ValueType};

use super::dbc::{DbcError, Mapped, MappedSignal, SignalMap};

/// Maximum number of names in an error message.
const MOST_LISTED: usize = 20;

/// A signal and its message.
type Place<'a> = (&'a can_dbc::Message, &'a can_dbc::Signal);

/// Finds the mapped signal in the file.
fn place<'a>(file: &str, dbc: &'a Dbc, map: &SignalMap) -> Result<Place<'a>, String> {
    let is_asked = |name: &str| map.message.as_deref().is_none_or(|asked| asked == name);
    let messages: Vec<_> = dbc.messages.iter().filter(|m| is_asked(&m.name)).collect();
    if messages.is_empty() {
        let names = dbc.messages.iter().map(|message| message.name.clone());
        let asked = map.message.as_deref().unwrap_or_default();
        return Err(format!("{file} has no message `{asked}`, only {}", listed(names)));
    }
    let all = messages.iter().flat_map(|m| m.signals.iter().map(move |signal| (*m, signal)));
    let names = |places: Vec<Place>| {
        listed(places.into_iter().map(|(m, signal)| format!("{}.{}", m.name, signal.name)))
    };
    let found: Vec<Place> = all.clone().filter(|(_, s)| s.name == map.signal).collect();
    match found.as_slice() {
        [one] => Ok(*one),
        [] => {
            let known = names(all.collect());
            Err(format!("{file} has no signal `{}`, only {known}", map.signal))
        }
        _ => {
            let known = names(found);
            Err(format!("{} is in several messages: give one of {known}", map.signal))
        }
    }
}

/// A list of names for an error message, shortened if it is long.
fn listed(names: impl Iterator<Item = String>) -> String {
    let mut names: Vec<String> = names.collect();
    let more = names.len().saturating_sub(MOST_LISTED);
    names.truncate(MOST_LISTED);
    if more > 0 {
        names.push(format!("and {more} more"));
    }
    names.join(", ")
}

impl MappedSignal {
    /// Finds the mapped signals in the text of a DBC file. `file` is its name in messages.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(file: &str, text: &str, maps: &[SignalMap]) -> Result<Vec<Self>, DbcError> {
        let dbc = Dbc::try_from(text).map_err(|error| DbcError::Syntax {
            file: file.to_owned(),
            message: error.to_string(),
        })?;
        if let Some(map) = maps.iter().filter(|map| map.measures == Mapped::LiftAxle).nth(1) {
            let message = "the position of the lift axles is one signal, and another one is given for it, too: lift axles that are \
                           raised one by one need a vehicle file for each position, without lift_m";
            return Err(DbcError::Map { map: map.text.clone(), message: message.to_owned() });
        }
        let found: Vec<Self> =
            maps.iter().map(|map| Self::find(file, &dbc, map)).collect::<Result<_, _>>()?;
        let place = |one: &Self| (one.measures, one.identifier, one.extended, one.start_bit);
        for (k, map) in maps.iter().enumerate() {
            if found[..k].iter().any(|one| place(one) == place(&found[k])) {
                let message = format!(
                    "this signal is given for {} before, too; give one of both",
                    map.measures
                );
                return Err(DbcError::Map { map: map.text.clone(), message });
            }
        }
        Ok(found)
    }

    fn find(file: &str, dbc: &Dbc, map: &SignalMap) -> Result<Self, DbcError> {
        let fail = |message: String| DbcError::Map { map: map.text.clone(), message };
        let (message, signal) = place(file, dbc, map).map_err(fail)?;
        if !matches!(
            signal.multiplexer_indicator,
            MultiplexIndicator::Plain | MultiplexIndicator::Multiplexor
        ) {
            return Err(fail("multiplexed signals are not supported".to_owned()));
        }
        let kind = dbc.extended_value_type_for_signal(message.id, &signal.name);
        if kind
            .is_some_and(|kind| !matches!(kind, SignalExtendedValueType::SignedOrUnsignedInteger))
        {
            return Err(fail(
                "signals in floating point (SIG_VALTYPE_) are not supported".to_owned(),
            ));
        }
        let (Ok(start_bit), Ok(bits @ 1..=64)) =
            (u16::try_from(signal.start_bit), u8::try_from(signal.size))
        else {
            return Err(fail(format!("a signal of {} bits cannot be read", signal.size)));
        };
        let dimension = map.measures.dimension();
        let unit = match map.unit.as_deref().unwrap_or(&signal.unit) {
            // A state has no unit.
            "" if map.measures == Mapped::LiftAxle => dimension.si().suffix,
            unit => unit,
        };
        let to_si = dimension.spelled(unit).map(|unit| unit.times / unit.per).ok_or_else(|| {
            let known = dimension.units().iter().flat_map(|unit| unit.spellings);
            fail(format!(
                "the unit \"{unit}\" is not one of {}; give the unit: {}={}.{}[{}]",
                known.copied().collect::<Vec<_>>().join(", "),
                map.measures,
                message.name,
                map.signal,
                dimension.si().suffix,
            ))
        })?;
        let (least, greatest) = (signal.min.to_string(), signal.max.to_string());
        let range = least
            .parse()
            .ok()
            .zip(greatest.parse().ok())
            .filter(|(least, greatest): &(f64, f64)| least < greatest);
        let (identifier, extended) = match message.id {
            MessageId::Standard(id) => (u32::from(id), false),
            MessageId::Extended(id) => (id & 0x1FFF_FFFF, true),
        };
        Ok(Self {
            measures: map.measures,
            identifier,
            extended,
            start_bit,
            bits,
            big_endian: signal.byte_order == ByteOrder::BigEndian,
            signed: signal.value_type == ValueType::Signed,
            factor: signal.factor,
            offset: signal.offset,
            range,
            to_si: (map.factor * to_si, map.offset * to_si),
        })
    }
}
