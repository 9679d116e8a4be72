//! See `cg_fuzz::calibration_file`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    cg_fuzz::calibration_file(data);
});
