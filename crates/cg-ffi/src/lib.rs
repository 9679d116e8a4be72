//! The estimator for C: `include/cg_height.h` and its static library.
//!
//! There is no heap and there are no globals: the caller provides the memory, and the design is read
//! in place, in flash. This is the only library crate with `unsafe`, because pointers come from C.
//! Each pointer is checked for null and alignment. The caller guarantees that it points to memory of
//! its type.
#![cfg_attr(target_os = "none", no_std)]
#![allow(unsafe_code)] // pointers from C
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod types;

use cg_core::Maneuver;
use cg_core::{Channel, Estimator, FilteredArx, Prior, Settings, Status, Step};

pub use types::{CHANNELS, CgHeight, CgMeasured, CgOutcome, CgRollover, CgSample, CgStep};

/// Size of an estimator in bytes, as in the header.
pub const CG_ESTIMATOR_SIZE: usize = 5208;

/// The errors of the header, with the same numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
#[allow(missing_docs)] // documented in the header
pub enum CgError {
    Ok = 0,
    NullPointer = 1,
    Misaligned = 2,
    WrongSize = 3,
    BadDesign = 4,
    NotInitialised = 5,
    TimeOrder = 6,
    NoAnswer = 7,
    BadChannel = 8,
    BadRoad = 9,
}

/// The design that C passes.
pub type Design = cg_core::Design<f32, CHANNELS>;

/// Memory for an estimator, as C sees it.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CgEstimator {
    opaque: [u64; CG_ESTIMATOR_SIZE / 8],
}

impl CgEstimator {
    /// Empty memory.
    pub const EMPTY: Self = Self { opaque: [0; CG_ESTIMATOR_SIZE / 8] };
}

type Onboard = Estimator<f32, FilteredArx<f32>, &'static Design, CHANNELS>;

/// The contents of that memory.
#[repr(C)]
struct State {
    /// [`INITIALISED`] after the initialization, otherwise arbitrary.
    mark: u64,
    estimator: Onboard,
}

/// The channel number of the combined height.
const COMBINED: i32 = -1;

const INITIALISED: u64 = 0x6367_6865_6967_6874;

// The state fits on this target, with little waste.
const _: () = assert!(size_of::<State>() <= CG_ESTIMATOR_SIZE);
const _: () = assert!(size_of::<State>() + 128 >= CG_ESTIMATOR_SIZE);
const _: () = assert!(align_of::<State>() <= align_of::<CgEstimator>());

#[cfg(target_os = "none")]
#[panic_handler]
fn never(_: &core::panic::PanicInfo) -> ! {
    // Nothing in the library panics, but the compiler requires a handler.
    loop {}
}

/// # Safety
/// If not null and aligned, the pointer points to a value of `T` that lives for `'a`.
unsafe fn shared<'a, T>(pointer: *const T) -> Result<&'a T, CgError> {
    check(pointer)?;
    // SAFETY: not null and aligned; the caller guarantees the rest.
    Ok(unsafe { &*pointer })
}

/// # Safety
/// As [`shared`], and there is no other reference to the value.
unsafe fn exclusive<'a, T>(pointer: *mut T) -> Result<&'a mut T, CgError> {
    check(pointer)?;
    // SAFETY: not null and aligned; the caller guarantees the rest.
    Ok(unsafe { &mut *pointer })
}

fn check<T>(pointer: *const T) -> Result<(), CgError> {
    if pointer.is_null() {
        Err(CgError::NullPointer)
    } else if pointer.is_aligned() {
        Ok(())
    } else {
        Err(CgError::Misaligned)
    }
}

/// The address of the estimator in its memory.
///
/// # Safety
/// If not null and aligned, the pointer points to the memory of a `CgEstimator`.
unsafe fn initialised(estimator: *const CgEstimator) -> Result<*const Onboard, CgError> {
    check(estimator)?;
    let state = estimator.cast::<State>();
    // SAFETY: the mark is within that memory, and any bits are a valid number.
    if unsafe { (&raw const (*state).mark).read() } != INITIALISED {
        return Err(CgError::NotInitialised);
    }
    // SAFETY: within that memory.
    Ok(unsafe { &raw const (*state).estimator })
}

/// The estimator, for changes.
///
/// # Safety
/// As [`initialised`], and there is no other reference to the estimator.
unsafe fn running<'a>(estimator: *mut CgEstimator) -> Result<&'a mut Onboard, CgError> {
    // SAFETY: the caller's guarantee; the mark shows that `cg_estimator_init` constructed an estimator.
    unsafe { Ok(&mut *initialised(estimator)?.cast_mut()) }
}

/// The estimator, for reading.
///
/// # Safety
/// As [`initialised`], and nothing changes the estimator meanwhile.
unsafe fn for_reading<'a>(estimator: *const CgEstimator) -> Result<&'a Onboard, CgError> {
    // SAFETY: as in `running`.
    unsafe { Ok(&*initialised(estimator)?) }
}

fn code(result: Result<(), CgError>) -> i32 {
    result.err().unwrap_or(CgError::Ok) as i32
}

/// Constructs an estimator; see the header.
///
/// # Safety
/// Pointers that are not null point to memory of their types. The design lives and does not change
/// as long as the estimator is used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cg_estimator_init(
    estimator: *mut CgEstimator,
    estimator_size: usize,
    design: *const Design,
    design_size: usize,
) -> i32 {
    // SAFETY: the caller guarantees it.
    code(unsafe { make(estimator, estimator_size, design, design_size, Settings::truck()) })
}

/// Constructs an estimator for roads with this bank; see the header.
///
/// # Safety
/// As [`cg_estimator_init`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cg_estimator_init_on_road(
    estimator: *mut CgEstimator,
    estimator_size: usize,
    design: *const Design,
    design_size: usize,
    bank_sd_rad: f32,
) -> i32 {
    if !(bank_sd_rad.is_finite() && bank_sd_rad >= 0.0) {
        return CgError::BadRoad as i32;
    }
    let settings = Settings::truck().on_road(bank_sd_rad);
    // SAFETY: the caller guarantees it.
    code(unsafe { make(estimator, estimator_size, design, design_size, settings) })
}

/// # Safety
/// As [`cg_estimator_init`].
unsafe fn make(
    estimator: *mut CgEstimator,
    estimator_size: usize,
    design: *const Design,
    design_size: usize,
    settings: Settings<f32>,
) -> Result<(), CgError> {
    check(estimator)?;
    if estimator_size != CG_ESTIMATOR_SIZE || design_size != size_of::<Design>() {
        check(design)?;
        return Err(CgError::WrongSize);
    }
    // SAFETY: the caller's guarantee, and the size was checked.
    let design: &'static Design = unsafe { shared(design) }?;
    design.validate().map_err(|_| CgError::BadDesign)?;
    let state = estimator.cast::<State>();
    // SAFETY: not null, aligned, large enough (asserted above), and not used elsewhere.
    unsafe {
        (&raw mut (*state).estimator).write(Onboard::new(design, settings, Prior::standard()));
        (&raw mut (*state).mark).write(INITIALISED);
    }
    Ok(())
}

/// Settings for a microcontroller; see the header.
///
/// # Safety
/// As [`cg_estimator_push`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cg_estimator_lighten(estimator: *mut CgEstimator) -> i32 {
    // SAFETY: the caller guarantees it.
    code(unsafe { running(estimator) }.map(Onboard::lighten))
}

/// Processes a sample; see the header.
///
/// # Safety
/// Pointers that are not null point to values of their types; nothing else uses the estimator.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cg_estimator_push(
    estimator: *mut CgEstimator,
    sample: *const CgSample,
    step: *mut CgStep,
) -> i32 {
    let push = || {
        // SAFETY: the caller guarantees it.
        let (estimator, sample) = unsafe { (running(estimator)?, shared(sample)?) };
        // SAFETY: the caller guarantees it; may be null.
        let out = if step.is_null() { None } else { Some(unsafe { exclusive(step) }?) };
        let answer = estimator.push(&sample.sample()).map_err(|_| CgError::TimeOrder)?;
        if let Some(out) = out {
            *out = CgStep::new(&answer);
        }
        Ok(())
    };
    code(push())
}

/// Closes the open maneuver; see the header.
///
/// # Safety
/// As [`cg_estimator_push`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cg_estimator_finish(
    estimator: *mut CgEstimator,
    step: *mut CgStep,
) -> i32 {
    let finish = || {
        // SAFETY: the caller guarantees it.
        let estimator = unsafe { running(estimator) }?;
        // SAFETY: the caller guarantees it; may be null.
        let out = if step.is_null() { None } else { Some(unsafe { exclusive(step) }?) };
        let closed: Option<Maneuver<f32, CHANNELS>> = estimator.finish();
        if let Some(out) = out {
            *out = CgStep::new(&Step { status: Status::Absent, closed });
        }
        Ok(())
    };
    code(finish())
}

/// The height so far; see the header.
///
/// # Safety
/// As [`cg_estimator_push`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cg_estimator_height(
    estimator: *const CgEstimator,
    channel: i32,
    height: *mut CgHeight,
) -> i32 {
    let ask = || {
        // SAFETY: the caller guarantees it; only read.
        let (estimator, out) = unsafe { (for_reading(estimator)?, exclusive(height)?) };
        let height = if channel == COMBINED {
            estimator.combined_height()
        } else {
            let index = usize::try_from(channel).ok();
            let channel = index.and_then(|index| Channel::ALL.get(index).copied());
            let known = channel.filter(|channel| estimator.design().place(*channel).is_some());
            estimator.height(known.ok_or(CgError::BadChannel)?)
        };
        *out = CgHeight::new(&height.ok_or(CgError::NoAnswer)?);
        Ok(())
    };
    code(ask())
}

/// The rollover threshold at the combined height; see the header.
///
/// # Safety
/// As [`cg_estimator_push`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cg_estimator_threshold(
    estimator: *const CgEstimator,
    trailer_mass_kg: f32,
    speed_mps: f32,
    rollover: *mut CgRollover,
) -> i32 {
    let ask = || {
        // SAFETY: the caller guarantees it; only read.
        let (estimator, out) = unsafe { (for_reading(estimator)?, exclusive(rollover)?) };
        let height = estimator.combined_height().ok_or(CgError::NoAnswer)?.height_m;
        let found = estimator.design().rollover(height, trailer_mass_kg, speed_mps);
        *out = CgRollover::new(&found.ok_or(CgError::NoAnswer)?);
        Ok(())
    };
    code(ask())
}
