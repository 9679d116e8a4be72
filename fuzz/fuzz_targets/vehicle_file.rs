//! See `cg_fuzz::vehicle_file`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    cg_fuzz::vehicle_file(data);
});
