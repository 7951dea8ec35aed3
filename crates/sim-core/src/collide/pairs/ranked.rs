//! The pairs of a tile in the order in which they are looked at.

use crate::bvh::WIDTH;

/// Pairs in a tile.
pub(crate) const TILE: usize = WIDTH * WIDTH;

/// Up to sixteen pairs of lanes, four bits each, the next one lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ranked {
    pairs: u64,
    count: u32,
}

impl Ranked {
    /// Orders keys made by [`key`], nearest first.
    #[inline(always)]
    pub(crate) fn sort(keys: &mut [u32]) -> Ranked {
        // A tile leaves two or three pairs as a rule, where nothing beats insertion.
        for i in 1..keys.len() {
            let key = keys[i];
            let mut place = i;
            while place > 0 && keys[place - 1] > key {
                keys[place] = keys[place - 1];
                place -= 1;
            }
            keys[place] = key;
        }
        let pairs = keys
            .iter()
            .rev()
            .fold(0, |all, key| all << 4 | u64::from(key & 15));
        Ranked {
            pairs,
            count: keys.len() as u32,
        }
    }

    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The next pair of lanes.
    #[inline(always)]
    pub(crate) fn pop(&mut self) -> Option<(usize, usize)> {
        self.count = self.count.checked_sub(1)?;
        let pair = (self.pairs & 15) as usize;
        self.pairs >>= 4;
        Some((pair / WIDTH, pair % WIDTH))
    }
}

/// Orders a pair by a distance that is not negative: the bits of such floats are in order, and
/// the lowest four, which make no difference, say which pair it is.
#[inline(always)]
pub(crate) fn key(distance: f32, pair: usize) -> u32 {
    distance.to_bits() & !15 | pair as u32
}
