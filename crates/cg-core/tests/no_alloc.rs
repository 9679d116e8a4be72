//! A million samples through the whole pipeline, and not one allocation.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;

use cg_core::{Channel, Estimator, FilteredArx, Prior, Sample, Settings};

struct Counting;

thread_local! {
    /// Allocations of this thread: the test harness has threads of its own.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

#[allow(unsafe_code)] // an allocator cannot be written without
// SAFETY: every call is handed on to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's contract is the system allocator's.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `alloc` above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_million_samples_allocate_nothing() {
    let design = common::design().cast::<f32>();
    let before = ALLOCATIONS.get();
    let mut estimator =
        Estimator::<f32, FilteredArx<f32>>::new(design, Settings::truck(), Prior::standard());
    let mut maneuvers = 0;
    for k in 0..1_000_000_u32 {
        // Turns of both signs with straights between, some speed and a little noise.
        let t = f64::from(k) * 0.01;
        let steer = 0.05 * (t / 7.0).sin().powi(3);
        let noise = f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        let mut sample = Sample::<f32>::absent(u64::from(k) * 10_000);
        sample.steer_rad = common::narrow(steer);
        sample.roll_rad = common::narrow(0.85 * steer + 1e-3 * noise);
        sample.speed_mps = common::narrow(13.9 + (t / 60.0).sin());
        sample.lateral_acceleration_mps2 = common::narrow(34.0 * steer);
        if let Ok(step) = black_box(estimator.push(&sample)) {
            maneuvers += u32::from(step.closed.is_some());
        }
    }
    let height = black_box(estimator.height(Channel::Steer));
    assert_eq!(ALLOCATIONS.get() - before, 0);
    // The counter counts.
    drop(black_box(Box::new(maneuvers)));
    assert_eq!(ALLOCATIONS.get() - before, 1);
    // The run did what it should: hundreds of turns, and a height from them.
    assert!(maneuvers > 100 && height.is_some(), "{maneuvers} maneuvers");
}
