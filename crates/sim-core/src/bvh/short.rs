//! Splits runs of a few triangles by sorting them: for so few the surface area heuristic is no better.

use core::array;
use glam::Vec4;

use super::WIDTH;
use super::split::{Bounds, Centres, WHOLE, whole};

/// The most triangles in a short run: the capacity of four leaves.
pub(super) const SHORT: usize = 4 * WIDTH;

/// Sorts five to sixteen triangles along the axis on which their centres lie farthest apart. Returns where to cut
/// them: near the middle, so that the parts fill as few leaves as the whole.
#[inline]
pub(super) fn sort(from: &[Bounds], to: &mut [Bounds]) -> usize {
    let Centres { axis, low, high } = Centres::of(from);
    // An infinite middle does no harm.
    let middle = 0.5 * low + 0.5 * high;
    let count = from.len();
    if count <= SHORT / 2 {
        let before = rank::<{ SHORT / 2 }>(from, to, axis, middle);
        return before.clamp(count - WIDTH, WIDTH);
    }
    let before = rank::<SHORT>(from, to, axis, middle);
    let cut = before.clamp(count - 2 * WIDTH, 2 * WIDTH);
    if count > 3 * WIDTH || cut <= WIDTH || cut >= count - WIDTH {
        cut
    } else if cut - WIDTH < count - WIDTH - cut {
        WIDTH
    } else {
        count - WIDTH
    }
}

/// Sorts up to `N` items along an axis, by the number of items before each, which takes no branches. Returns the
/// number of items below a place.
#[inline]
fn rank<const N: usize>(from: &[Bounds], to: &mut [Bounds], axis: usize, place: f32) -> usize {
    let mut keys = [f32::INFINITY; N];
    let mut before = 0;
    for (i, (key, item)) in keys.iter_mut().zip(from).enumerate() {
        let along = item.along(axis).clamp(f32::MIN, f32::MAX);
        before += usize::from(along <= place);
        // No two keys are the same: the last bits are the item's number.
        *key = f32::from_bits(along.to_bits() & !(N as u32 - 1) | i as u32);
    }
    // Counted in floats, as `WHOLE` plus the rank.
    let mut ranks = [Vec4::splat(WHOLE); SHORT / WIDTH];
    let ranks = &mut ranks[..N / WIDTH];
    let others: [Vec4; SHORT / WIDTH] =
        array::from_fn(|k| Vec4::from_slice(&keys[k * WIDTH % N..][..WIDTH]));
    for &key in &keys[..from.len()] {
        for (rank, &others) in ranks.iter_mut().zip(&others) {
            *rank += Vec4::select(others.cmpgt(Vec4::splat(key)), Vec4::ONE, Vec4::ZERO);
        }
    }
    for (ranks, items) in ranks.iter().zip(from.chunks(WIDTH)) {
        for (&rank, item) in ranks.to_array().iter().zip(items) {
            to[whole(rank) as usize] = *item;
        }
    }
    before
}
