//! Reads the numbers of a row in place, without looking for its end first.

use super::cell::Slot;
use super::signal::Signal;

/// Number of bytes that are looked at beyond a row.
pub(super) const AHEAD: usize = 8;

/// Powers of ten that a `f64` holds exactly.
const POWERS_OF_TEN: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// Reads the planned fields of the row at the beginning of `text` into `values`, if they are numbers with at
/// most fifteen digits and no exponent, or empty. Nearly all rows are. Returns the length of the row without
/// its line feed; `None` leaves the row to the slower reading, which also knows what is wrong with it.
#[inline]
pub(super) fn read_numbers(
    text: &[u8],
    delimiter: u8,
    plan: &[Option<Slot>],
    values: &mut [f64; Signal::COUNT],
) -> Option<usize> {
    read_fields(text, delimiter, plan, |slot, field| slot.take(decimal(field)?, values))
}

const _: () = assert!(Signal::COUNT <= u64::BITS as usize, "a bit for each signal");

/// The same for any finite numbers. Signals that have had longer numbers have their bits in `long`: a column with one of them
/// usually has many.
#[inline(never)]
pub(super) fn read_any_numbers(
    text: &[u8],
    delimiter: u8,
    plan: &[Option<Slot>],
    long: &mut u64,
    values: &mut [f64; Signal::COUNT],
) -> Option<usize> {
    read_fields(text, delimiter, plan, |slot, field| {
        let bit = 1 << slot.signal;
        let number = if *long & bit == 0 {
            short(field).or_else(|| {
                *long |= bit;
                general(field)
            })
        } else {
            general(field).or_else(|| short(field))
        };
        slot.take(number?, values)
    })
}

/// A [`decimal`] without an exponent behind it.
#[inline]
fn short(field: &[u8]) -> Option<(f64, usize)> {
    decimal(field).filter(|(_, length)| !matches!(field.get(*length), Some(b'e' | b'E')))
}

/// Reads the row at the beginning of `text` with `read`, which returns the length of a planned field. Returns that of the row.
#[inline]
fn read_fields(
    text: &[u8],
    delimiter: u8,
    plan: &[Option<Slot>],
    mut read: impl FnMut(&Slot, &[u8]) -> Option<usize>,
) -> Option<usize> {
    let (mut slots, mut rest, mut ended) = (plan.iter(), text, false);
    for slot in &mut slots {
        let length = match slot {
            Some(slot) => read(slot, rest)?,
            None => skipped(rest, delimiter)?,
        };
        rest = rest.get(length..)?;
        match rest {
            [byte, more @ ..] if *byte == delimiter => rest = more,
            _ => {
                ended = true;
                break;
            }
        }
    }
    if !ended || slots.len() > 0 {
        return None;
    }
    let length = text.len() - rest.len();
    match rest {
        [b'\n', ..] => Some(length),
        [b'\r', b'\n', ..] => Some(length + 1),
        _ => None,
    }
}

/// The length of a field that is not read, if it has no quotes.
fn skipped(rest: &[u8], delimiter: u8) -> Option<usize> {
    if rest.first() == Some(&b'"') {
        return None;
    }
    memchr::memchr2(delimiter, b'\n', rest)
}

impl Slot {
    /// Takes a number and its length in bytes, and returns the length.
    #[inline]
    fn take(
        &self,
        (value, length): (f64, usize),
        values: &mut [f64; Signal::COUNT],
    ) -> Option<usize> {
        let place = values.get_mut(self.signal)?;
        *place = value;
        if !self.is_si {
            *place = self.si(value);
            if place.is_infinite() {
                return None;
            }
        }
        Some(length)
    }
}

/// A number with any digits and exponent, by the general parser; what is no finite decimal number is left to the slower
/// reading.
fn general(text: &[u8]) -> Option<(f64, usize)> {
    let (value, length) = fast_float2::parse_partial::<f64, _>(text).ok()?;
    value.is_finite().then_some((value, length))
}

/// The number at the beginning of `text` and its length in bytes, if it has at most fifteen digits and no exponent; NaN and
/// zero if there is none. Its digits and its power of ten are exact, and their quotient is rounded once, as every correct parser does it. The
/// first eight bytes are read at once.
#[inline]
fn decimal(text: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(*text.first()? == b'-');
    let text = text.get(sign..)?;
    let digits = word(text)?;
    let others = other_bytes(digits);
    let whole = first_byte(others);
    let (value, length) = if whole == 8 {
        longer(text, number(digits), 8, None)?
    } else if (digits >> (8 * whole)) & 0xFF == u64::from(POINT) {
        let before = (1 << (8 * whole)) - 1;
        let joined = (digits & before) | ((digits >> 8) & !before);
        let stop = first_byte(others & (others - 1));
        if stop < 8 {
            let places = stop - 1 - whole;
            let value = f64::from(number(aligned(joined, stop - 1))) / POWERS_OF_TEN[places & 15];
            if stop > 1 { (value, stop) } else { return None }
        } else {
            longer(text, number(aligned(joined, 7)), 8, Some(whole))?
        }
    } else if whole > 0 {
        (f64::from(number(aligned(digits, whole))), whole)
    } else if sign > 0 {
        return None;
    } else {
        (f64::NAN, 0)
    };
    Some((f64::from_bits(value.to_bits() | ((sign as u64) << 63)), sign + length))
}

/// A byte of a point as a number, see [`word`].
const POINT: u8 = b'.' ^ b'0';

/// Eight bytes of text as numbers, those of digits below ten. The first byte is the lowest.
#[inline]
fn word(text: &[u8]) -> Option<u64> {
    Some(u64::from_le_bytes(*text.first_chunk()?) ^ 0x3030_3030_3030_3030)
}

/// The highest bits of the bytes that are no digits. They are right up to the first byte that is neither
/// a digit nor a point.
#[inline]
fn other_bytes(word: u64) -> u64 {
    // What carries into the next byte is not ASCII.
    (word.wrapping_add(0x7676_7676_7676_7676) | word) & 0x8080_8080_8080_8080
}

/// The place of the first byte of [`other_bytes`]; eight if there is none.
#[inline]
fn first_byte(others: u64) -> usize {
    others.trailing_zeros() as usize / 8
}

/// The first `count` digits, at most seven, behind zeros.
#[inline]
fn aligned(digits: u64, count: usize) -> u64 {
    (digits << ((7 - count) * 8)) << 8
}

/// The number of eight digits: they are added up in pairs, and then in pairs of pairs.
#[inline]
fn number(digits: u64) -> u32 {
    const PAIRS: u64 = 0x0000_00FF_0000_00FF;
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let odd = (pairs & PAIRS).wrapping_mul((1_000_000 << 32) + 100);
    let even = ((pairs >> 16) & PAIRS).wrapping_mul((10_000 << 32) + 1);
    #[allow(clippy::cast_possible_truncation)] // eight digits
    let number = (odd.wrapping_add(even) >> 32) as u32;
    number
}

/// A number of which the first bytes have been read.
#[inline]
fn longer(text: &[u8], number: u32, read: usize, point: Option<usize>) -> Option<(f64, usize)> {
    const MOST_DIGITS: usize = 15;
    let (mut number, mut length, mut point) = (i64::from(number), read, point);
    loop {
        let digit = *text.get(length)? ^ b'0';
        if digit < 10 {
            number = number * 10 + i64::from(digit);
        } else if digit == POINT && point.is_none() {
            point = Some(length);
        } else {
            break;
        }
        length += 1;
        if length - usize::from(point.is_some()) > MOST_DIGITS {
            return None;
        }
    }
    let places = point.map_or(0, |point| length - 1 - point);
    #[allow(clippy::cast_precision_loss)] // below 10^15
    let digits = number as f64;
    Some((digits / POWERS_OF_TEN[places & 15], length))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::log::cell::{Writing, read_plain};
    use crate::log::columns::Column;
    use crate::log::signal::Signal;

    /// A number at the beginning of a text that goes on in the buffer.
    fn read(text: &str) -> Option<(u64, usize)> {
        let text = format!("{text}\n{:AHEAD$}", "");
        decimal(text.as_bytes()).map(|(value, length)| (value.to_bits(), length))
    }

    proptest! {
        /// Every number of up to fifteen digits is the double that the standard library's parser gives.
        #[test]
        fn a_number_is_the_nearest_double(
            digits in 0_u64..1_000_000_000_000_000,
            divisor in 0_u32..15,
            places in 0_usize..16,
            point: bool,
            negative: bool,
            rest in "(,.*)?",
        ) {
            let digits = digits / 10_u64.pow(divisor);
            let text = format!("{digits:0>width$}", width = places + 1);
            let (whole, part) = text.split_at(text.len() - places);
            let sign = if negative { "-" } else { "" };
            let point = if places > 0 || point { "." } else { "" };
            let cell = format!("{sign}{whole}{point}{part}");
            prop_assume!(text.len() <= 15);
            let known = (cell.parse::<f64>().unwrap().to_bits(), cell.len());
            prop_assert_eq!(read(&format!("{cell}{rest}")), Some(known));
        }

        /// Whatever stands in a row, the fast reading gives what the slower one gives, or leaves it to that.
        #[test]
        fn the_fast_reading_of_a_row_agrees_with_the_slower_one(
            row in prop::collection::vec("[-+0-9.,eE \r\u{b1}naN\"]{0,4}[0-9]{0,9}[.]?[0-9]{0,9}", 1..4),
            ending in "\r?",
            factor in prop::sample::select(vec![1.0, 0.001]),
        ) {
            let column = |(index, times)| {
                let signal = Signal::ALL[index];
                Slot::from(&Column { index, signal, times, per: 1.0, clock: false })
            };
            let plan = [Some((0, 1.0)), None, Some((2, factor))].map(|one| one.map(column));
            let line = format!("{}{ending}\n", row.join(";"));
            let text = format!("{line}{:AHEAD$}", "");
            let [mut fast, mut slow] = [[0.0; Signal::COUNT]; 2];
            for long in [None, Some(0), Some(u64::MAX)] {
                let length = match long {
                    None => read_numbers(text.as_bytes(), b';', &plan, &mut fast),
                    Some(mut long) => read_any_numbers(text.as_bytes(), b';', &plan, &mut long, &mut fast),
                };
                let Some(length) = length else { continue };
                prop_assert_eq!(length + 1, line.len());
                let mut writing = Writing::new(b';');
                let cells = line.trim_end();
                prop_assert_eq!(read_plain(cells.as_bytes(), &mut writing, &plan, &mut slow), Ok(()));
                prop_assert_eq!(fast.map(f64::to_bits), slow.map(f64::to_bits));
            }
        }
    }

    #[test]
    fn other_numbers_are_left_to_the_general_parser() {
        for (cell, value) in [
            ("999999999999999", Some(999_999_999_999_999.0)),
            ("1000000000000000", None), // sixteen digits
            ("0.00000000000001", Some(1e-14)),
            ("0.000000000000001", None),
            ("-0", Some(-0.0_f64)),
            ("7.", Some(7.0)),
            (".5", Some(0.5)),
            ("-.5", Some(-0.5)),
            ("", Some(f64::NAN)),
            ("-", None),
            (".", None),
            ("-.", None),
            ("1.2.3", None),
            ("1e5", None),
            ("+1", None),
            (" 1", None),
            ("1 ", None),
            ("--1", None),
            ("nan", None),
            ("12345678", Some(12_345_678.0)),
            ("12345678.", Some(12_345_678.0)),
            ("1234567.8", Some(1_234_567.8)),
            ("1714564800.02", Some(1_714_564_800.02)),
        ] {
            for rest in ["", ";", ";2"] {
                let found = read(&format!("{cell}{rest}")).filter(|found| found.1 == cell.len());
                assert_eq!(found, value.map(|value| (value.to_bits(), cell.len())), "{cell}");
            }
        }
    }

    /// All of them in place, as the slower reading has them.
    #[test]
    fn finite_numbers_of_any_length_are_read_in_place() {
        let plan = [Signal::Time, Signal::Roll].map(|signal| {
            let index = signal as usize;
            Some(Slot::from(&Column { index, signal, times: 1.0, per: 1.0, clock: false }))
        });
        for cell in [
            "0.012345678901234567",
            "-0.00000000000000000123456789",
            "1e5",
            "-1.25E-07",
            ".5e1",
            "9007199254740993",
            "1714564800.123456789",
            "1.7976931348623157e308",
        ] {
            let text = format!("{cell},{cell}\n{:AHEAD$}", "");
            let (mut long, mut values) = (1 << Signal::Time as u64, [0.0; Signal::COUNT]);
            let length = read_any_numbers(text.as_bytes(), b',', &plan, &mut long, &mut values);
            assert_eq!(length, Some(2 * cell.len() + 1), "{cell}");
            assert_eq!(long, (1 << Signal::Time as u64) | (1 << Signal::Roll as u64));
            let known = cell.parse::<f64>().unwrap().to_bits();
            let found =
                [Signal::Time, Signal::Roll].map(|signal| values[signal as usize].to_bits());
            assert_eq!(found, [known; 2], "{cell}");
        }
        for cell in ["nan", "inf", "-inf", "1e999", "+1", "1e", "0x1", "-", "1_0", " 1"] {
            let text = format!("{cell},1\n{:AHEAD$}", "");
            let mut values = [0.0; Signal::COUNT];
            let length = read_any_numbers(text.as_bytes(), b',', &plan, &mut 0, &mut values);
            assert_eq!(length, None, "{cell}");
        }
    }

    /// Unfinished numbers at the end of what was read so far are not taken for finished ones.
    #[test]
    fn a_row_must_end_in_the_text() {
        let plan = [Some(Slot::from(&Column {
            index: 0,
            signal: Signal::Time,
            times: 1.0,
            per: 1.0,
            clock: false,
        }))];
        let mut values = [0.0; Signal::COUNT];
        for text in ["1", "1.25", "1.234567890", "123456789", "1\r"] {
            assert_eq!(read_numbers(text.as_bytes(), b',', &plan, &mut values), None, "{text}");
        }
        assert_eq!(read_numbers(b"1.25\r\n0.5\n0.75\n", b',', &plan, &mut values), Some(5));
        assert_eq!(values[0].to_bits(), 1.25_f64.to_bits());
    }
}
