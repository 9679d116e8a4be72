//! Arguments whose values are words of a library.

use cg_core::Word;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Parses a word of `T`. Help and error messages list all words with their meanings.
pub(crate) fn word<T: Word + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let words = T::WORDS.iter().map(|(_, word, meaning)| PossibleValue::new(*word).help(*meaning));
    PossibleValuesParser::new(words).try_map(|text| T::of_word(&text))
}
