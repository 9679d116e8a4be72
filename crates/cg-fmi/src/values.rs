//! Functions that read and set variables.

use cg_fmu::variable::Type;
use cg_fmu::{FmuError, Instance};

use crate::component::{array, missing, with};
use crate::types::{Handle, Status};

fn is_float64(kind: Type) -> bool {
    matches!(kind, Type::Float64(_))
}

/// Enumerations are 64-bit integers in FMI 3.0.
fn is_int64(kind: Type) -> bool {
    matches!(kind, Type::Int64 | Type::Enumeration(_))
}

fn is_boolean(kind: Type) -> bool {
    kind == Type::Boolean
}

/// # Safety
/// Those of FMI, see the crate.
unsafe fn get<T>(
    instance: Handle,
    (references, count): (*const u32, usize),
    (values, value_count): (*mut T, usize),
    is_type: fn(Type) -> bool,
    convert: fn(f64) -> T,
) -> Status {
    let get = |instance: &mut Instance| {
        same(count, value_count)?;
        // SAFETY: the caller guarantees it.
        let references = unsafe { array("valueReferences", references, count) }?;
        if count > 0 && values.is_null() {
            return Err(missing("values"));
        }
        instance.get(references, is_type, |place, value| {
            // SAFETY: not null, and the caller guarantees as many values as references.
            unsafe { values.add(place).write(convert(value)) };
        })
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, |component| get(&mut component.instance)) }
}

/// All variables are scalars.
fn same(references: usize, values: usize) -> Result<(), FmuError> {
    if references == values {
        return Ok(());
    }
    Err(FmuError::call(format!(
        "{references} value references and {values} values: all are scalars"
    )))
}

/// Reads floating-point variables.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: Handle,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> Status {
    // SAFETY: the caller guarantees it.
    unsafe { get(instance, (references, count), (values, value_count), is_float64, |value| value) }
}

/// Reads integers and enumerations.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt64(
    instance: Handle,
    references: *const u32,
    count: usize,
    values: *mut i64,
    value_count: usize,
) -> Status {
    #[allow(clippy::cast_possible_truncation)] // counts and items
    let whole = |value: f64| value as i64;
    // SAFETY: the caller guarantees it.
    unsafe { get(instance, (references, count), (values, value_count), is_int64, whole) }
}

/// Reads truth values.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBoolean(
    instance: Handle,
    references: *const u32,
    count: usize,
    values: *mut bool,
    value_count: usize,
) -> Status {
    let truth = |value: f64| value > 0.0;
    // SAFETY: the caller guarantees it.
    unsafe { get(instance, (references, count), (values, value_count), is_boolean, truth) }
}

/// Sets floating-point variables.
///
/// # Safety
/// Those of FMI, see the crate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: Handle,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> Status {
    let set = |instance: &mut Instance| {
        same(count, value_count)?;
        // SAFETY: the caller guarantees it.
        let references = unsafe { array("valueReferences", references, count) }?;
        // SAFETY: the caller guarantees it.
        let values = unsafe { array("values", values, count) }?;
        instance.set(references, is_float64, values)
    };
    // SAFETY: the caller guarantees it.
    unsafe { with(instance, |component| set(&mut component.instance)) }
}
