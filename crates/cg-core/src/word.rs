//! Options whose values are words: one table from which they are read, printed and explained.

use core::fmt;
use core::marker::PhantomData;

/// A type whose values are written as words, such as `steer`. [`words!`](crate::words) implements
/// it from a table.
pub trait Word: Copy + PartialEq + 'static {
    /// Each value with its word and its meaning.
    const WORDS: &'static [(Self, &'static str, &'static str)];

    /// Other words that are read, but never printed.
    const OTHERS: &'static [(Self, &'static str)];

    /// The word of this value.
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(value, ..)| *value == self).map_or("", |(_, word, _)| word)
    }

    /// The meaning of this value.
    fn meaning(self) -> &'static str {
        Self::WORDS.iter().find(|(value, ..)| *value == self).map_or("", |(.., meaning)| meaning)
    }

    /// The value of a word.
    ///
    /// # Errors
    /// [`UnknownWord`] if no value has this word. Its message lists the possible words.
    fn of_word(text: &str) -> Result<Self, UnknownWord<Self>> {
        let words = Self::WORDS.iter().map(|(value, word, _)| (*value, *word));
        let mut all = words.chain(Self::OTHERS.iter().copied());
        all.find(|(_, word)| *word == text).map(|(value, _)| value).ok_or(UnknownWord(PhantomData))
    }
}

/// The error for a text that is not a word of `T`. Its message lists the possible words.
pub struct UnknownWord<T>(PhantomData<T>);

impl<T: Word> fmt::Display for UnknownWord<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("expected ")?;
        for (place, (_, word, _)) in T::WORDS.iter().enumerate() {
            f.write_str(match T::WORDS.len() - place {
                _ if place == 0 => "",
                1 => " or ",
                _ => ", ",
            })?;
            f.write_str(word)?;
        }
        Ok(())
    }
}

impl<T: Word> fmt::Debug for UnknownWord<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl<T: Word> core::error::Error for UnknownWord<T> {}

/// Implements [`Word`], `FromStr` and `Display` for a type from a table of its values. A value may have a
/// further word after its meaning.
#[macro_export]
macro_rules! words {
    ($type:ty { $($value:ident => $word:expr, $meaning:expr $(, $other:expr)?;)+ }) => {
        impl $crate::word::Word for $type {
            const WORDS: &'static [(Self, &'static str, &'static str)] =
                &[$((<$type>::$value, $word, $meaning)),+];
            const OTHERS: &'static [(Self, &'static str)] = &[$($((<$type>::$value, $other),)?)+];
        }

        impl ::core::str::FromStr for $type {
            type Err = $crate::word::UnknownWord<Self>;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                $crate::word::Word::of_word(text)
            }
        }

        impl ::core::fmt::Display for $type {
            fn fmt(&self, f: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                f.pad($crate::word::Word::word(*self))
            }
        }
    };
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;

    use super::Word;
    use crate::{Channel, Quantity};

    #[test]
    fn every_word_is_read_back_and_an_unknown_one_lists_them() {
        for &(quantity, word, meaning) in Quantity::WORDS {
            assert_eq!((word.parse().ok(), quantity.to_string().as_str()), (Some(quantity), word));
            assert!(!meaning.is_empty());
        }
        assert_eq!("tractor-suspension".parse::<Channel>().unwrap(), Channel::Tractor);
        let error = "both".parse::<Channel>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "expected steer, lateral-acceleration, suspension or tractor"
        );
    }
}
