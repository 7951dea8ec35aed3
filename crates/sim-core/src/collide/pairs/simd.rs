//! Tiles in 256- and 512-bit vectors of x86-64.
//!
//! The only `unsafe` of the crate. It says no more than that instructions which have been found
//! to exist may be executed: no pointer is made or followed.
#![allow(unsafe_code)]

use core::arch::x86_64::*;
use core::ops::ControlFlow;

use super::{Leaves, Reach, Stack, TILE, Tiles, Visit, descend};
use crate::bvh::{Bvh, Node, TRIANGLE, WIDTH};

#[inline]
pub(super) fn has_avx2() -> bool {
    #[cfg(feature = "std")]
    return std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(feature = "std"))]
    cfg!(all(target_feature = "avx2", target_feature = "fma"))
}

#[inline]
pub(super) fn has_avx512() -> bool {
    #[cfg(feature = "std")]
    return std::arch::is_x86_feature_detected!("avx512f") && has_avx2();
    #[cfg(not(feature = "std"))]
    cfg!(all(target_feature = "avx512f", target_feature = "avx2"))
}

/// [`super::each_pair`] in 256-bit vectors. The caller has asked [`has_avx2`].
pub(super) fn each_pair_avx2(
    first: &Bvh,
    second: &Bvh,
    reach: Reach,
    visit: impl Visit,
) -> ControlFlow<()> {
    assert!(has_avx2());
    // SAFETY: the processor has AVX2 and FMA, by the assertion.
    unsafe { avx2(first, second, reach, visit) }
}

/// [`super::each_pair`] in 512-bit vectors. The caller has asked [`has_avx512`].
pub(super) fn each_pair_avx512(
    first: &Bvh,
    second: &Bvh,
    reach: Reach,
    visit: impl Visit,
) -> ControlFlow<()> {
    assert!(has_avx512());
    // SAFETY: the processor has AVX-512F and AVX2, by the assertion.
    unsafe { avx512(first, second, reach, visit) }
}

#[target_feature(enable = "avx2,fma")]
fn avx2(first: &Bvh, second: &Bvh, reach: Reach, visit: impl Visit) -> ControlFlow<()> {
    descend(first, second, &mut Avx2 { reach, visit })
}

#[target_feature(enable = "avx512f,avx2,fma")]
fn avx512(first: &Bvh, second: &Bvh, reach: Reach, visit: impl Visit) -> ControlFlow<()> {
    descend(first, second, &mut Avx512 { reach, visit })
}

/// Made only in [`avx2`].
struct Avx2<V> {
    reach: Reach,
    visit: V,
}

impl<V: Visit> Tiles for Avx2<V> {
    #[inline(always)]
    fn expand(&mut self, first: &Node, second: &Node, stack: &mut Stack, leaves: &mut Leaves) {
        // SAFETY: an `Avx2` exists only inside `avx2`, which runs where AVX2 and FMA are.
        unsafe { expand_avx2(&self.reach, first, second, stack, leaves) }
    }

    #[inline(always)]
    fn triangles(&mut self, pairs: (&[u32], &[u32])) -> ControlFlow<()> {
        self.visit.visit(pairs)
    }
}

/// Made only in [`avx512`].
struct Avx512<V> {
    reach: Reach,
    visit: V,
}

impl<V: Visit> Tiles for Avx512<V> {
    #[inline(always)]
    fn expand(&mut self, first: &Node, second: &Node, stack: &mut Stack, leaves: &mut Leaves) {
        // SAFETY: an `Avx512` exists only inside `avx512`, which runs where AVX-512F is.
        unsafe { expand_avx512(&self.reach, first, second, stack, leaves) }
    }

    #[inline(always)]
    fn triangles(&mut self, pairs: (&[u32], &[u32])) -> ControlFlow<()> {
        self.visit.visit(pairs)
    }
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn expand_avx2(reach: &Reach, first: &Node, second: &Node, stack: &mut Stack, leaves: &mut Leaves) {
    let (mut nearest, mut least, mut count) = (0, u32::MAX, 0);
    // Two lanes of the first node at a time, each against the four of the second.
    for half in 0..2 {
        let mut meet = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
        let mut distance = _mm256_setzero_ps();
        for axis in 0..3 {
            let a_min = pair_of(first.min[axis], half);
            let a_max = pair_of(first.max[axis], half);
            let b_min = _mm_add_ps(four(second.min[axis]), _mm_set1_ps(reach.low[axis]));
            let b_max = _mm_add_ps(four(second.max[axis]), _mm_set1_ps(reach.high[axis]));
            let (b_min, b_max) = (_mm256_set_m128(b_min, b_min), _mm256_set_m128(b_max, b_max));
            meet = _mm256_and_ps(meet, _mm256_cmp_ps::<_CMP_LE_OQ>(a_min, b_max));
            meet = _mm256_and_ps(meet, _mm256_cmp_ps::<_CMP_LE_OQ>(b_min, a_max));
            let d = _mm256_sub_ps(_mm256_add_ps(a_min, a_max), _mm256_add_ps(b_min, b_max));
            distance = _mm256_fmadd_ps(d, d, distance);
        }
        let mut bits = _mm256_movemask_ps(meet) as u32;
        if bits == 0 {
            continue;
        }
        // Distances are not negative, so their bits are in order.
        let distance: [u32; 8] = words_256(_mm256_castps_si256(distance));
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let a = first.child[2 * half + lane / WIDTH];
            let b = second.child[lane % WIDTH];
            if a & b & TRIANGLE != 0 {
                leaves.push(a & !TRIANGLE, b & !TRIANGLE);
            } else {
                stack.push(a, b);
                if distance[lane] < least {
                    (nearest, least) = (count, distance[lane]);
                }
                count += 1;
            }
        }
    }
    if count > 1 {
        stack.raise(count - 1 - nearest);
    }
}

#[inline]
#[target_feature(enable = "avx512f,avx2,fma")]
fn expand_avx512(
    reach: &Reach,
    first: &Node,
    second: &Node,
    stack: &mut Stack,
    leaves: &mut Leaves,
) {
    let mut meet: __mmask16 = !0;
    let mut distance = _mm512_setzero_ps();
    for axis in 0..3 {
        let a_min = each_four_times(first.min[axis]);
        let a_max = each_four_times(first.max[axis]);
        let b_min = _mm_add_ps(four(second.min[axis]), _mm_set1_ps(reach.low[axis]));
        let b_max = _mm_add_ps(four(second.max[axis]), _mm_set1_ps(reach.high[axis]));
        let (b_min, b_max) = (_mm512_broadcast_f32x4(b_min), _mm512_broadcast_f32x4(b_max));
        meet = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(meet, a_min, b_max);
        meet = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(meet, b_min, a_max);
        let d = _mm512_sub_ps(_mm512_add_ps(a_min, a_max), _mm512_add_ps(b_min, b_max));
        distance = _mm512_fmadd_ps(d, d, distance);
    }
    let a = _mm512_permutexvar_epi32(
        FOUR_TIMES.vector(),
        _mm512_castsi128_si512(four_words(first.child)),
    );
    let b = _mm512_broadcast_i32x4(four_words(second.child));
    let flag = _mm512_set1_epi32(TRIANGLE as i32);
    let leaf = _mm512_mask_test_epi32_mask(meet, _mm512_and_si512(a, b), flag);
    if leaf != 0 {
        let pack = |x| {
            words(_mm512_maskz_compress_epi32(
                leaf,
                _mm512_andnot_si512(flag, x),
            ))
        };
        leaves.push_tile(pack(a), pack(b), leaf.count_ones() as usize);
    }
    let inner = meet & !leaf;
    if inner != 0 {
        let pack = |x| words(_mm512_maskz_compress_epi32(inner, x));
        stack.push_tile(pack(a), pack(b), inner.count_ones() as usize);
        // Distances are not negative, so their bits are in order; the lowest ones name the lane.
        let distance = _mm512_castps_si512(distance);
        let keys = _mm512_or_si512(
            _mm512_and_si512(distance, _mm512_set1_epi32(!15)),
            LANES.vector(),
        );
        let nearest = _mm512_mask_reduce_min_epu32(inner, keys) & 15;
        stack.raise((inner >> nearest).count_ones() as usize - 1);
    }
}

/// Four floats as a vector.
#[inline]
#[target_feature(enable = "sse2")]
fn four([a, b, c, d]: [f32; WIDTH]) -> __m128 {
    _mm_setr_ps(a, b, c, d)
}

/// Lanes `2 half` and `2 half + 1`, four times each.
#[inline]
#[target_feature(enable = "avx2")]
fn pair_of(x: [f32; WIDTH], half: usize) -> __m256 {
    _mm256_set_m128(_mm_set1_ps(x[2 * half + 1]), _mm_set1_ps(x[2 * half]))
}

/// Each lane four times, in order.
#[inline]
#[target_feature(enable = "avx512f")]
fn each_four_times(x: [f32; WIDTH]) -> __m512 {
    _mm512_permutexvar_ps(FOUR_TIMES.vector(), _mm512_castps128_ps512(four(x)))
}

/// Four words as a vector.
#[inline]
#[target_feature(enable = "sse2")]
fn four_words(x: [u32; WIDTH]) -> __m128i {
    let [a, b, c, d] = x.map(|x| x as i32);
    _mm_setr_epi32(a, b, c, d)
}

/// Numbers of lanes.
struct Lanes([i32; TILE]);

const LANES: Lanes = Lanes([0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]);
const FOUR_TIMES: Lanes = Lanes([0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]);

impl Lanes {
    #[inline(always)]
    fn vector(&self) -> __m512i {
        // SAFETY: both are 64 bytes in which every pattern is a value.
        unsafe { core::mem::transmute(self.0) }
    }
}

#[inline(always)]
fn words_256(x: __m256i) -> [u32; 8] {
    // SAFETY: both are 32 bytes in which every pattern is a value.
    unsafe { core::mem::transmute(x) }
}

#[inline(always)]
fn words(x: __m512i) -> [u32; TILE] {
    // SAFETY: both are 64 bytes in which every pattern is a value.
    unsafe { core::mem::transmute(x) }
}
