//! The types of the headers `fmi3PlatformTypes.h` and `fmi3FunctionTypes.h`.

use std::ffi::{c_char, c_void};

/// `fmi3Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// All is well.
    Ok = 0,
    /// It was done, but look at the messages. No function returns it; messages have it.
    Warning = 1,
    /// It was not done.
    Error = 3,
    /// The instance must not be used any more.
    Fatal = 4,
}

/// `fmi3Instance` and `fmi3FMUState`.
pub(crate) type Handle = *mut c_void;
/// `fmi3String`.
pub(crate) type Text = *const c_char;
/// `fmi3LogMessageCallback`.
pub(crate) type LogMessage = Option<unsafe extern "C" fn(Handle, Status, Text, Text)>;
