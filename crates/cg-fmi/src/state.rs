//! Functions that keep a state and return to it. States cannot be serialized.

use cg_fmu::Instance;

use crate::component::{Component, missing, with};
use crate::types::{Handle, Status};

/// Keeps the present state, in place of an earlier one if there is one.
///
/// # Safety
/// Those of FMI, see the crate; `state` points to null or to a state of this library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: Handle, state: *mut Handle) -> Status {
    let keep = |component: &mut Component| {
        // SAFETY: the caller guarantees it.
        let state = unsafe { state.as_mut() }.ok_or_else(|| missing("FMUState"))?;
        let now = component.instance.clone();
        // SAFETY: null, or from `Box::into_raw` below.
        match unsafe { state.cast::<Instance>().as_mut() } {
            Some(earlier) => *earlier = now,
            None => *state = Box::into_raw(Box::new(now)).cast(),
        }
        Ok(())
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, keep) }
}

/// Returns to a state.
///
/// # Safety
/// Those of FMI, see the crate; `state` is one of this library that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: Handle, state: Handle) -> Status {
    let restore = |component: &mut Component| {
        // SAFETY: from `Box::into_raw` in `fmi3GetFMUState`, or null.
        let state = unsafe { state.cast::<Instance>().as_ref() };
        component.instance = state.ok_or_else(|| missing("FMUState"))?.clone();
        Ok(())
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, restore) }
}

/// Frees a state.
///
/// # Safety
/// Those of FMI, see the crate; `state` points to null or to a state of this library, which is not used
/// again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: Handle, state: *mut Handle) -> Status {
    let free = |_: &mut Component| {
        // SAFETY: the caller guarantees it.
        let Some(state) = (unsafe { state.as_mut() }) else { return Ok(()) };
        if !state.is_null() {
            // SAFETY: from `Box::into_raw` in `fmi3GetFMUState`, and freed once.
            drop(unsafe { Box::from_raw(state.cast::<Instance>()) });
            *state = std::ptr::null_mut();
        }
        Ok(())
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, free) }
}
