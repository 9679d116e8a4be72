//! White noise for unit tests.

/// Number `k` of uniform white noise with a standard deviation of one: a multiplicative hash of `k`. It deviates by
/// √3 at most.
pub(crate) fn white(k: u32) -> f64 {
    let mixed = (u64::from(k) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let [.., a, b, c, d] = mixed.to_be_bytes();
    (f64::from(u32::from_be_bytes([a, b, c, d])) / f64::from(u32::MAX) - 0.5) * 12.0_f64.sqrt()
}
