//! Numbers by chance for unit tests, the same in each run.

/// From -1 to 1 (Knuth's linear congruential generator, "The Art of Computer Programming" 2, section 3.3.4).
pub(crate) fn signed(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
