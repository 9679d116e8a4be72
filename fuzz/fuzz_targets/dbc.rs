//! See `cg_fuzz::dbc`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    cg_fuzz::dbc(data);
});
