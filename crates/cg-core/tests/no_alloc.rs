//! A million samples pass through the estimator without a single allocation.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;

use cg_core::{Channel, Estimator, FilteredArx, Prior, Sample, Settings};

struct Counting;

thread_local! {
    /// Allocations of this thread only, because the test harness has its own threads.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

#[allow(unsafe_code)] // an allocator requires unsafe code
// SAFETY: every call is passed to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller fulfills the contract of the system allocator.
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
    let design = common::full_design().cast::<f32>();
    let before = ALLOCATIONS.get();
    let mut estimator: Estimator<f32, FilteredArx<f32>> =
        Estimator::new(design, Settings::truck(), Prior::standard());
    let mut maneuvers = 0;
    for k in 0..1_000_000_u32 {
        // Turns to both sides with straight driving in between, changing speed and a little noise.
        let t = f64::from(k) * 0.01;
        let steer = 0.05 * (t / 7.0).sin().powi(3);
        let noise = f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        let mut sample = Sample::<f32>::absent(u64::from(k) * 10_000);
        sample.steer_rad = common::narrow(steer);
        sample.roll_rad = common::narrow(0.85 * steer + 1e-3 * noise);
        sample.speed_mps = common::narrow(13.9 + (t / 60.0).sin());
        sample.lateral_acceleration_mps2 = common::narrow(34.0 * steer);
        sample.suspension_roll_rad = sample.roll_rad;
        sample.lateral_specific_force_mps2 = common::narrow(44.0 * steer);
        sample.tractor_suspension_roll_rad = sample.roll_rad;
        sample.tractor_tilt_rad = common::narrow(50.0 * steer / 9.81);
        if let Ok(step) = black_box(estimator.push(&sample)) {
            maneuvers += u32::from(step.closed.is_some());
        }
    }
    let heights = black_box(Channel::ALL.map(|channel| estimator.height(channel)));
    let combined = black_box(estimator.combined());
    assert_eq!(ALLOCATIONS.get() - before, 0);
    // Check that the counter works.
    drop(black_box(Box::new(maneuvers)));
    assert_eq!(ALLOCATIONS.get() - before, 1);
    // Check that the run had hundreds of turns and gave heights.
    assert!(combined.is_some());
    assert!(maneuvers > 100 && heights.iter().all(Option::is_some), "{maneuvers} maneuvers");
}
