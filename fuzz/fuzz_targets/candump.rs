//! See `cg_fuzz::candump`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    cg_fuzz::candump(data);
});
