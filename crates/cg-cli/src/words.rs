//! Arguments whose values are words of a library.

use cg_core::Word;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Parses a word of `T`. Help and error messages list all words with their meanings.
pub(crate) fn word<T: Word + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let words = T::WORDS.iter().map(|(value, word, meaning)| {
        let others = T::OTHERS.iter().filter(move |(of, _)| of == value).map(|(_, other)| *other);
        PossibleValue::new(*word).help(*meaning).aliases(others)
    });
    PossibleValuesParser::new(words).try_map(|text| T::of_word(&text))
}
