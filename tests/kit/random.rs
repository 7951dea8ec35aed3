//! Pseudorandom numbers that are the same on every run.

use sim_core::DVec3;

/// A sequence of 64-bit numbers, and values derived from them.
pub struct Random {
    state: u64,
    next: fn(&mut u64) -> u64,
    /// The number of low bits that integers leave out, because these have the shortest periods.
    dropped: u32,
}

fn xorshift(state: &mut u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state
}

impl Random {
    /// SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators").
    pub fn splitmix(seed: u64) -> Random {
        let next = |state: &mut u64| {
            *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mixed = (*state ^ *state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            mixed ^ mixed >> 31
        };
        Random {
            state: seed,
            next,
            dropped: 0,
        }
    }

    /// A sequence by Marsaglia (2003, "Xorshift RNGs").
    pub fn xorshift(seed: u64, dropped: u32) -> Random {
        Random {
            state: seed,
            next: xorshift,
            dropped,
        }
    }

    /// The same, multiplied (Vigna 2016, "An experimental exploration of Marsaglia's xorshift generators,
    /// scrambled").
    pub fn scrambled(seed: u64) -> Random {
        let next = |state: &mut u64| xorshift(state).wrapping_mul(0x2545_f491_4f6c_dd1d);
        Random {
            state: seed,
            next,
            dropped: 11,
        }
    }

    /// Knuth's linear congruential sequence.
    pub fn linear(seed: u64) -> Random {
        let next = |state: &mut u64| {
            *state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            *state
        };
        Random {
            state: seed,
            next,
            dropped: 33,
        }
    }

    /// The bits from which integers are made.
    pub fn bits(&mut self) -> u64 {
        (self.next)(&mut self.state) >> self.dropped
    }

    /// An integer less than a count.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// An integer between two limits, inclusive.
    pub fn whole(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as usize) as i64
    }

    /// True with the probability of one in `count`.
    pub fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    /// One of some values.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// From 0 to 1.
    pub fn unit(&mut self) -> f64 {
        ((self.next)(&mut self.state) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Between two numbers.
    pub fn from(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// From -1 to 1.
    pub fn signed(&mut self) -> f64 {
        self.from(-1.0, 1.0)
    }

    /// A vector whose components are each from -1 to 1.
    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// A vector of length 1.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            if (0.1..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
}
