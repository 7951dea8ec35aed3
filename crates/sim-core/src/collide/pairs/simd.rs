//! Tiles in 256- and 512-bit vectors of x86-64.
//!
//! The only `unsafe` of the crate. It says no more than that instructions which have been found
//! to exist may be executed: no pointer is made or followed.
#![allow(unsafe_code)]

use core::arch::x86_64::*;
use core::ops::ControlFlow;

use super::{Ranked, Reach, TILE, Tiles, descend};
use crate::bvh::{Bvh, Node, WIDTH};

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
    visit: impl FnMut(u32, u32) -> ControlFlow<()>,
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
    visit: impl FnMut(u32, u32) -> ControlFlow<()>,
) -> ControlFlow<()> {
    assert!(has_avx512());
    // SAFETY: the processor has AVX-512F and AVX2, by the assertion.
    unsafe { avx512(first, second, reach, visit) }
}

#[target_feature(enable = "avx2,fma")]
fn avx2(
    first: &Bvh,
    second: &Bvh,
    reach: Reach,
    visit: impl FnMut(u32, u32) -> ControlFlow<()>,
) -> ControlFlow<()> {
    descend(first, second, &mut Avx2 { reach, visit })
}

#[target_feature(enable = "avx512f,avx2,fma")]
fn avx512(
    first: &Bvh,
    second: &Bvh,
    reach: Reach,
    visit: impl FnMut(u32, u32) -> ControlFlow<()>,
) -> ControlFlow<()> {
    descend(first, second, &mut Avx512 { reach, visit })
}

/// Made only in [`avx2`].
struct Avx2<V> {
    reach: Reach,
    visit: V,
}

impl<V: FnMut(u32, u32) -> ControlFlow<()>> Tiles for Avx2<V> {
    #[inline(always)]
    fn rank(&mut self, first: &Node, second: &Node) -> Ranked {
        // SAFETY: an `Avx2` exists only inside `avx2`, which runs where AVX2 and FMA are.
        unsafe { rank_avx2(&self.reach, first, second) }
    }

    #[inline(always)]
    fn triangles(&mut self, first: u32, second: u32) -> ControlFlow<()> {
        (self.visit)(first, second)
    }
}

/// Made only in [`avx512`].
struct Avx512<V> {
    reach: Reach,
    visit: V,
}

impl<V: FnMut(u32, u32) -> ControlFlow<()>> Tiles for Avx512<V> {
    #[inline(always)]
    fn rank(&mut self, first: &Node, second: &Node) -> Ranked {
        // SAFETY: an `Avx512` exists only inside `avx512`, which runs where AVX-512F is.
        unsafe { rank_avx512(&self.reach, first, second) }
    }

    #[inline(always)]
    fn triangles(&mut self, first: u32, second: u32) -> ControlFlow<()> {
        (self.visit)(first, second)
    }
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn rank_avx2(reach: &Reach, first: &Node, second: &Node) -> Ranked {
    let mut count = 0;
    let mut keys = [0u32; TILE];
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
        let lanes = _mm256_add_epi32(
            _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7),
            _mm256_set1_epi32(8 * half as i32),
        );
        let distance = _mm256_and_si256(_mm256_castps_si256(distance), _mm256_set1_epi32(!15));
        let lanes: [u32; 8] = bytes_of(_mm256_or_si256(distance, lanes));
        while bits != 0 {
            keys[count] = lanes[bits.trailing_zeros() as usize];
            count += 1;
            bits &= bits - 1;
        }
    }
    Ranked::sort(&mut keys[..count])
}

#[inline]
#[target_feature(enable = "avx512f,avx2,fma")]
fn rank_avx512(reach: &Reach, first: &Node, second: &Node) -> Ranked {
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
    let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    let keys = _mm512_and_si512(_mm512_castps_si512(distance), _mm512_set1_epi32(!15));
    let keys = _mm512_maskz_compress_epi32(meet, _mm512_or_si512(keys, lanes));
    let mut keys: [u32; TILE] = bytes_of_512(keys);
    Ranked::sort(&mut keys[..meet.count_ones() as usize])
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
    let lanes = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
    _mm512_permutexvar_ps(lanes, _mm512_castps128_ps512(four(x)))
}

#[inline(always)]
fn bytes_of(x: __m256i) -> [u32; 8] {
    // SAFETY: both are 32 bytes in which every pattern is a value.
    unsafe { core::mem::transmute(x) }
}

#[inline(always)]
fn bytes_of_512(x: __m512i) -> [u32; TILE] {
    // SAFETY: both are 64 bytes in which every pattern is a value.
    unsafe { core::mem::transmute(x) }
}
