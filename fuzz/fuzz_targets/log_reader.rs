//! See `cg_fuzz::log_reader`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    cg_fuzz::log_reader(data);
});
