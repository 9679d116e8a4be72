//! What an instance of C points to.

use std::ffi::{CStr, CString};
use std::panic::{AssertUnwindSafe, catch_unwind};

use cg_fmu::{FmuError, Instance};

use crate::types::{Handle, LogMessage, Status, Text};

/// The category of warnings in the model description.
pub(crate) const WARNING: &CStr = c"logStatusWarning";
/// The category of errors.
pub(crate) const ERROR: &CStr = c"logStatusError";

/// The logger of the simulation tool.
#[derive(Clone, Copy)]
pub(crate) struct Logger {
    pub(crate) environment: Handle,
    pub(crate) log: LogMessage,
    /// Whether warnings are wanted. Errors are always reported.
    pub(crate) warns: bool,
}

impl Logger {
    pub(crate) fn error(&self, message: &str) {
        self.say(Status::Error, ERROR, message);
    }

    pub(crate) fn warning(&self, message: &str) {
        if self.warns {
            self.say(Status::Warning, WARNING, message);
        }
    }

    fn say(&self, status: Status, category: &CStr, message: &str) {
        let Some(log) = self.log else { return };
        // A text from a file may contain a zero, which would end it.
        let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
        // SAFETY: the function and the environment are those of the tool, and both texts live until it
        // returns.
        unsafe { log(self.environment, status, category.as_ptr(), text.as_ptr()) };
    }
}

/// An instance and its logger.
pub(crate) struct Component {
    pub(crate) instance: Instance,
    pub(crate) logger: Logger,
}

/// Runs a function of an instance, and reports its error. A panic would be an error of this library; it must
/// not reach C.
///
/// # Safety
/// The handle is null, or it is one that `fmi3InstantiateCoSimulation` returned and that has not been
/// freed, and nothing else uses it meanwhile.
pub(crate) unsafe fn with(
    handle: Handle,
    work: impl FnOnce(&mut Component) -> Result<(), FmuError>,
) -> Status {
    // SAFETY: the caller's guarantee.
    let Some(component) = (unsafe { handle.cast::<Component>().as_mut() }) else {
        return Status::Error;
    };
    let logger = component.logger;
    match catch_unwind(AssertUnwindSafe(|| work(component))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(error)) => {
            logger.error(&error.to_string());
            Status::Error
        }
        Err(_) => {
            logger.error("an error of the library cg_fmi; the instance cannot be used any more");
            Status::Fatal
        }
    }
}

/// The same for a call that needs memory of the caller.
pub(crate) fn missing(what: &str) -> FmuError {
    FmuError::call(format!("{what} is a null pointer"))
}

/// An array of C; empty if it has no elements.
///
/// # Safety
/// If the pointer is not null, it points to `length` values that nothing changes meanwhile.
pub(crate) unsafe fn array<'a, T>(
    what: &str,
    pointer: *const T,
    length: usize,
) -> Result<&'a [T], FmuError> {
    if length == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() || !pointer.is_aligned() {
        return Err(missing(what));
    }
    // SAFETY: not null and aligned; the caller guarantees the rest.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// A text of C.
///
/// # Safety
/// If the pointer is not null, it points to a text that ends with a zero and that nothing changes meanwhile.
pub(crate) unsafe fn text<'a>(what: &str, pointer: Text) -> Result<&'a str, FmuError> {
    if pointer.is_null() {
        return Err(missing(what));
    }
    // SAFETY: not null; the caller guarantees the rest.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|_| FmuError::call(format!("{what} is not UTF-8")))
}

/// Writes a result that the caller may not want.
///
/// # Safety
/// The pointer is null, or it points to a value that nothing else uses meanwhile.
pub(crate) unsafe fn put<T>(pointer: *mut T, value: T) {
    if !pointer.is_null() {
        // SAFETY: not null; the caller guarantees the rest.
        unsafe { pointer.write(value) };
    }
}
