//! Functions that make an instance, lead it through its life, and free it.

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use cg_fmu::{FmuError, Instance};

use crate::component::{Component, Logger, WARNING, array, put, text, with};
use crate::types::{Handle, LogMessage, Status, Text};

/// The version of FMI.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> Text {
    c"3.0".as_ptr()
}

/// Sets which messages are wanted: all, or those of these categories.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: Handle,
    logging_on: bool,
    count: usize,
    categories: *const Text,
) -> Status {
    let set = |component: &mut Component| {
        // SAFETY: the caller guarantees it.
        let categories = unsafe { array("categories", categories, count) }?;
        let mut warns = categories.is_empty();
        for category in categories {
            // SAFETY: the caller guarantees it.
            let category = unsafe { text("a category", *category) }?;
            warns |= WARNING.to_str() == Ok(category);
        }
        component.logger.warns = logging_on && warns;
        Ok(())
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, set) }
}

/// Makes an instance; null after an error, which is reported.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: Text,
    token: Text,
    resources: Text,
    _visible: bool,
    logging_on: bool,
    event_mode_used: bool,
    _early_return_allowed: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: Handle,
    log: LogMessage,
    _intermediate_update: *const c_void,
) -> Handle {
    let logger = Logger { environment, log, warns: logging_on };
    let make = || -> Result<Handle, FmuError> {
        if event_mode_used {
            return Err(FmuError::call(
                "this FMU has no event mode: call it with eventModeUsed = false",
            ));
        }
        // SAFETY: the caller guarantees it.
        let token = unsafe { text("instantiationToken", token) }?;
        // SAFETY: the caller guarantees it.
        let resources = unsafe { text("resourcePath", resources) }?;
        let instance = Instance::unpacked(token, Path::new(resources))?;
        Ok(Box::into_raw(Box::new(Component { instance, logger })).cast())
    };
    match catch_unwind(AssertUnwindSafe(make)) {
        Ok(Ok(handle)) => handle,
        Ok(Err(error)) => {
            logger.error(&error.to_string());
            std::ptr::null_mut()
        }
        Err(_) => {
            logger.error("an error of the library cg_fmi: no instance can be made");
            std::ptr::null_mut()
        }
    }
}

/// There is no model exchange: null.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: Text,
    _token: Text,
    _resources: Text,
    _visible: bool,
    _logging_on: bool,
    environment: Handle,
    log: LogMessage,
) -> Handle {
    only_co_simulation(environment, log)
}

/// There is no scheduled execution: null.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _name: Text,
    _token: Text,
    _resources: Text,
    _visible: bool,
    _logging_on: bool,
    environment: Handle,
    log: LogMessage,
    _clock_update: *const c_void,
    _lock: *const c_void,
    _unlock: *const c_void,
) -> Handle {
    only_co_simulation(environment, log)
}

fn only_co_simulation(environment: Handle, log: LogMessage) -> Handle {
    let logger = Logger { environment, log, warns: false };
    logger.error("this FMU is for co-simulation only");
    std::ptr::null_mut()
}

/// Frees an instance.
///
/// # Safety
/// Those of FMI, see the crate; the instance is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Handle) {
    if !instance.is_null() {
        // SAFETY: it came from `Box::into_raw` in `fmi3InstantiateCoSimulation` and is freed once.
        drop(unsafe { Box::from_raw(instance.cast::<Component>()) });
    }
}

/// Begins the initialization.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: Handle,
    _tolerance_defined: bool,
    _tolerance: f64,
    start_s: f64,
    _stop_defined: bool,
    _stop_s: f64,
) -> Status {
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, |component| component.instance.enter_initialization(start_s)) }
}

/// Ends the initialization.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: Handle) -> Status {
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, |component| component.instance.exit_initialization()) }
}

/// Advances by a communication step.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: Handle,
    from_s: f64,
    step_s: f64,
    _no_earlier_state: bool,
    event_needed: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_s: *mut f64,
) -> Status {
    let step = |component: &mut Component| {
        let result = component.instance.step(from_s, step_s);
        let end = result.as_ref().is_ok_and(|stepped| stepped.end.is_some());
        // SAFETY: the caller guarantees it.
        unsafe {
            put(event_needed, false);
            put(terminate, end);
            put(early_return, false);
            put(last_s, component.instance.time_s());
        }
        if let Some(why) = result?.end {
            component.logger.warning(&why);
        }
        Ok(())
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, step) }
}

/// Ends the simulation.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: Handle) -> Status {
    let terminate = |component: &mut Component| {
        for message in component.instance.terminate()? {
            component.logger.warning(&message);
        }
        Ok(())
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, terminate) }
}

/// Makes an instance as it was at first.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: Handle) -> Status {
    let reset = |component: &mut Component| {
        component.instance.reset();
        Ok(())
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, reset) }
}
