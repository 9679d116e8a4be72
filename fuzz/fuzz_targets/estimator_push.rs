//! See `cg_fuzz::estimator_push`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    cg_fuzz::estimator_push(data);
});
