//! The error of options that have a form of their own, such as `roll=0xE4`.

use std::borrow::Cow;

use thiserror::Error;

/// A text that does not have the form of its option. The message says what is wrong and which form is
/// expected.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Malformed(Cow<'static, str>);

impl From<&'static str> for Malformed {
    fn from(message: &'static str) -> Self {
        Self(Cow::Borrowed(message))
    }
}

impl From<String> for Malformed {
    fn from(message: String) -> Self {
        Self(Cow::Owned(message))
    }
}
