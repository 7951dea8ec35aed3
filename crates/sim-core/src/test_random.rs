//! Random numbers for unit tests, the same in each run.

use glam::DVec3;

/// SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators") from any seed.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    /// A whole number from `-most` to `most`.
    pub(crate) fn up_to(&mut self, most: i64) -> i64 {
        (self.bits() >> 1) as i64 % (2 * most + 1) - most
    }

    /// Three whole numbers from `-most` to `most`.
    pub(crate) fn three(&mut self, most: i64) -> [i64; 3] {
        [self.up_to(most), self.up_to(most), self.up_to(most)]
    }

    /// A vector of whole numbers from `-most` to `most`.
    pub(crate) fn vector(&mut self, most: i64) -> DVec3 {
        DVec3::from_array(self.three(most).map(|x| x as f64))
    }

    /// A whole number from 0, less than `count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From -1 to 1.
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// A vector whose components are each from 0 to 1.
    pub(crate) fn in_unit_cube(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }

    /// A vector whose components are each from -1 to 1.
    pub(crate) fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}
