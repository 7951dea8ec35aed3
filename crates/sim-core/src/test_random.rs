//! Whole numbers for tests.

use glam::DVec3;

/// Numbers from a sequence of Marsaglia's (2003, "Xorshift RNGs").
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// From `-most` to `most`.
    pub(crate) fn up_to(&mut self, most: i64) -> i64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 1) as i64 % (2 * most + 1) - most
    }

    pub(crate) fn three(&mut self, most: i64) -> [i64; 3] {
        [self.up_to(most), self.up_to(most), self.up_to(most)]
    }

    pub(crate) fn vector(&mut self, most: i64) -> DVec3 {
        DVec3::from_array(self.three(most).map(|x| x as f64))
    }
}
