//! Functions of what these FMUs do not have. They fail and say so. FMI wants every function to be there.

use std::ffi::c_int;

use cg_fmu::FmuError;

use crate::component::with;
use crate::types::{Handle, Status, Text};

/// The other functions that read or set variables. Nothing to read or to set is no error.
macro_rules! of_other_types {
    ($($name:ident($references:ty, $count:ty $(, $argument:ty)*);)+) => {
        $(
            /// There are no variables of this type, or they cannot be set.
            ///
            /// # Safety
            /// Those of FMI, see the crate.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(
                instance: Handle,
                _: $references,
                count: $count
                $(, _: $argument)*
            ) -> Status {
                // SAFETY: the caller guarantees it.
                unsafe { refuse_some(instance, count, stringify!($name)) }
            }
        )+
    };
}

/// Functions of other kinds of FMUs.
macro_rules! of_other_kinds {
    ($($name:ident($($argument:ty),*);)+) => {
        $(
            /// These FMUs have no such function.
            ///
            /// # Safety
            /// Those of FMI, see the crate.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: Handle $(, _: $argument)*) -> Status {
                // SAFETY: the caller guarantees it.
                unsafe { refuse(instance, stringify!($name)) }
            }
        )+
    };
}

/// # Safety
/// Those of FMI, see the crate.
unsafe fn refuse_some(instance: Handle, count: usize, name: &str) -> Status {
    let refuse = || FmuError::call(format!("{name}: the FMU has no variables for this function"));
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, |_| if count == 0 { Ok(()) } else { Err(refuse()) }) }
}

/// # Safety
/// Those of FMI, see the crate.
unsafe fn refuse(instance: Handle, name: &str) -> Status {
    let error =
        FmuError::call(format!("{name} is not a function of this FMU (modelDescription.xml)"));
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, |_| Err(error)) }
}

of_other_types! {
    fmi3GetFloat32(*const u32, usize, *mut f32, usize);
    fmi3GetInt8(*const u32, usize, *mut i8, usize);
    fmi3GetUInt8(*const u32, usize, *mut u8, usize);
    fmi3GetInt16(*const u32, usize, *mut i16, usize);
    fmi3GetUInt16(*const u32, usize, *mut u16, usize);
    fmi3GetInt32(*const u32, usize, *mut i32, usize);
    fmi3GetUInt32(*const u32, usize, *mut u32, usize);
    fmi3GetUInt64(*const u32, usize, *mut u64, usize);
    fmi3GetString(*const u32, usize, *mut Text, usize);
    fmi3GetBinary(*const u32, usize, *mut usize, *mut *const u8, usize);
    fmi3GetClock(*const u32, usize, *mut bool);
    fmi3SetFloat32(*const u32, usize, *const f32, usize);
    fmi3SetInt8(*const u32, usize, *const i8, usize);
    fmi3SetUInt8(*const u32, usize, *const u8, usize);
    fmi3SetInt16(*const u32, usize, *const i16, usize);
    fmi3SetUInt16(*const u32, usize, *const u16, usize);
    fmi3SetInt32(*const u32, usize, *const i32, usize);
    fmi3SetUInt32(*const u32, usize, *const u32, usize);
    fmi3SetInt64(*const u32, usize, *const i64, usize);
    fmi3SetUInt64(*const u32, usize, *const u64, usize);
    fmi3SetBoolean(*const u32, usize, *const bool, usize);
    fmi3SetString(*const u32, usize, *const Text, usize);
    fmi3SetBinary(*const u32, usize, *const usize, *const *const u8, usize);
    fmi3SetClock(*const u32, usize, *const bool);
    fmi3GetIntervalDecimal(*const u32, usize, *mut f64, *mut c_int);
    fmi3GetIntervalFraction(*const u32, usize, *mut u64, *mut u64, *mut c_int);
    fmi3SetIntervalDecimal(*const u32, usize, *const f64);
    fmi3SetIntervalFraction(*const u32, usize, *const u64, *const u64);
}

of_other_kinds! {
    fmi3EnterEventMode();
    fmi3GetNumberOfVariableDependencies(u32, *mut usize);
    fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut c_int, usize);
    fmi3SerializedFMUStateSize(Handle, *mut usize);
    fmi3SerializeFMUState(Handle, *mut u8, usize);
    fmi3DeserializeFMUState(*const u8, usize, *mut Handle);
    fmi3GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3GetAdjointDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    fmi3EnterConfigurationMode();
    fmi3ExitConfigurationMode();
    fmi3GetShiftDecimal(*const u32, usize, *mut f64);
    fmi3GetShiftFraction(*const u32, usize, *mut u64, *mut u64);
    fmi3SetShiftDecimal(*const u32, usize, *const f64);
    fmi3SetShiftFraction(*const u32, usize, *const u64, *const u64);
    fmi3EvaluateDiscreteStates();
    fmi3UpdateDiscreteStates(*mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64);
    fmi3EnterContinuousTimeMode();
    fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool);
    fmi3SetTime(f64);
    fmi3SetContinuousStates(*const f64, usize);
    fmi3GetContinuousStateDerivatives(*mut f64, usize);
    fmi3GetEventIndicators(*mut f64, usize);
    fmi3GetContinuousStates(*mut f64, usize);
    fmi3GetNominalsOfContinuousStates(*mut f64, usize);
    fmi3GetNumberOfEventIndicators(*mut usize);
    fmi3GetNumberOfContinuousStates(*mut usize);
    fmi3EnterStepMode();
    fmi3GetOutputDerivatives(*const u32, usize, *const i32, *mut f64, usize);
    fmi3ActivateModelPartition(u32, f64);
}
