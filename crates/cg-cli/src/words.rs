//! Arguments that are words of a library, with their meaning in the help.

use cg_core::Word;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Reads a word of `T`; help and errors list all of them.
pub(crate) fn word<T: Word + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let words = T::WORDS.iter().map(|(_, word, meaning)| PossibleValue::new(*word).help(*meaning));
    PossibleValuesParser::new(words).try_map(|text| T::of_word(&text))
}
