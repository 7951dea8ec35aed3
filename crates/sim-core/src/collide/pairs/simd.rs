//! Lanes in 256- and 512-bit vectors of x86-64.
//!
//! The `unsafe` here only asserts that the processor has the instructions: no pointer is made or followed except in
//! loads and stores of whole arrays.
#![allow(unsafe_code)]

use core::arch::x86_64::*;

use super::lanes::push_each;
use super::{InLanes, Lanes, Level, Stack, TILE};
use crate::bvh::WIDTH;

#[cfg(feature = "std")]
macro_rules! has {
    ($($feature:tt),*) => { $(std::arch::is_x86_feature_detected!($feature))&&* };
}
#[cfg(not(feature = "std"))]
macro_rules! has {
    ($($feature:tt),*) => { cfg!(all($(target_feature = $feature),*)) };
}

fn widest_of_processor() -> Level {
    let has_avx2 = has!("avx2", "fma", "bmi1", "bmi2", "popcnt");
    match (has_avx2, has!("avx512f")) {
        (true, true) => Level::Avx512,
        (true, false) => Level::Avx2,
        (false, _) => Level::Portable,
    }
}

/// The widest level that this processor has.
#[cfg(feature = "std")]
#[inline]
pub(super) fn widest() -> Level {
    // Asked once, because the check would be noticeable in very short queries.
    static WIDEST: std::sync::OnceLock<Level> = std::sync::OnceLock::new();
    *WIDEST.get_or_init(widest_of_processor)
}

/// The widest level that the crate was compiled for.
#[cfg(not(feature = "std"))]
#[inline]
pub(super) fn widest() -> Level {
    widest_of_processor()
}

/// Does work at a level with special instructions, if this processor has them; otherwise returns the work.
#[inline]
pub(super) fn run<W: InLanes>(level: Level, work: W) -> Result<W::Output, W> {
    if level > widest() {
        return Err(work);
    }
    // SAFETY: the processor has the level, and so the instructions for which these are compiled.
    match level {
        Level::Portable => Err(work),
        Level::Avx2 => Ok(unsafe { avx2(work) }),
        Level::Avx512 => Ok(unsafe { avx512(work) }),
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
fn avx2<W: InLanes>(work: W) -> W::Output {
    work.run::<Avx2>()
}

#[target_feature(enable = "avx512f,avx2,fma,bmi1,bmi2,popcnt")]
fn avx512<W: InLanes>(work: W) -> W::Output {
    work.run::<Avx512>()
}

/// Two rows of four in each vector. Made only in [`avx2`].
#[derive(Clone, Copy)]
struct Avx2(__m256, __m256);

/// Made only in [`avx512`].
#[derive(Clone, Copy)]
struct Avx512(__m512);

/// Calls an intrinsic; safe, since the type exists only where its instructions do.
macro_rules! call {
    ($($call:tt)*) => {
        // SAFETY: values of this type are made only in functions that run where the processor
        // has these instructions; loads and stores are of whole arrays.
        unsafe { $($call)* }
    };
}

impl Lanes for Avx2 {
    #[inline(always)]
    fn store(self, to: &mut [f32; TILE]) {
        let (low, high) = to.split_at_mut(TILE / 2);
        call! {
            _mm256_storeu_ps(low.as_mut_ptr(), self.0);
            _mm256_storeu_ps(high.as_mut_ptr(), self.1);
        }
    }

    #[inline(always)]
    fn splat(x: f32) -> Avx2 {
        call! { let x = _mm256_set1_ps(x); Avx2(x, x) }
    }

    #[inline(always)]
    fn rows(x: &[f32; WIDTH]) -> Avx2 {
        call! {
            let x = _mm_loadu_ps(x.as_ptr());
            let x = _mm256_set_m128(x, x);
            Avx2(
                _mm256_permutevar_ps(x, _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1)),
                _mm256_permutevar_ps(x, _mm256_setr_epi32(2, 2, 2, 2, 3, 3, 3, 3)),
            )
        }
    }

    #[inline(always)]
    fn columns(x: &[f32; WIDTH]) -> Avx2 {
        call! { let x = _mm_loadu_ps(x.as_ptr());
        let x = _mm256_set_m128(x, x); Avx2(x, x) }
    }

    #[inline(always)]
    fn add(self, other: Avx2) -> Avx2 {
        call! { Avx2(_mm256_add_ps(self.0, other.0), _mm256_add_ps(self.1, other.1)) }
    }

    #[inline(always)]
    fn sub(self, other: Avx2) -> Avx2 {
        call! { Avx2(_mm256_sub_ps(self.0, other.0), _mm256_sub_ps(self.1, other.1)) }
    }

    #[inline(always)]
    fn mul_add(self, factor: Avx2, sum: Avx2) -> Avx2 {
        call! {
            Avx2(
                _mm256_fmadd_ps(self.0, factor.0, sum.0),
                _mm256_fmadd_ps(self.1, factor.1, sum.1),
            )
        }
    }

    #[inline(always)]
    fn mul(self, factor: Avx2) -> Avx2 {
        call! { Avx2(_mm256_mul_ps(self.0, factor.0), _mm256_mul_ps(self.1, factor.1)) }
    }

    #[inline(always)]
    fn abs(self) -> Avx2 {
        call! {
            let sign = _mm256_set1_ps(-0.0);
            Avx2(_mm256_andnot_ps(sign, self.0), _mm256_andnot_ps(sign, self.1))
        }
    }

    #[inline(always)]
    fn min(self, other: Avx2) -> Avx2 {
        call! { Avx2(_mm256_min_ps(self.0, other.0), _mm256_min_ps(self.1, other.1)) }
    }

    #[inline(always)]
    fn max(self, other: Avx2) -> Avx2 {
        call! { Avx2(_mm256_max_ps(self.0, other.0), _mm256_max_ps(self.1, other.1)) }
    }

    #[inline(always)]
    fn at_most(self, other: Avx2) -> u32 {
        call! {
            let low = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0));
            let high = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.1, other.1));
            (low | high << 8) as u32
        }
    }

    #[inline(always)]
    fn above(self, other: Avx2) -> u32 {
        call! {
            let low = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(self.0, other.0));
            let high = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(self.1, other.1));
            (low | high << 8) as u32
        }
    }

    #[inline(always)]
    fn least(self, among: u32) -> (u32, bool) {
        call! {
            let first = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let last = _mm256_add_epi32(first, _mm256_set1_epi32(8));
            let x = _mm256_min_ps(keys(self.0, first, among), keys(self.1, last, among));
            let x = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
            let x = _mm_min_ps(x, _mm_movehl_ps(x, x));
            let x = _mm_cvtss_f32(_mm_min_ss(x, _mm_movehdup_ps(x)));
            (x.to_bits() & 15, x.is_sign_negative())
        }
    }

    #[inline(always)]
    fn push(stack: &mut Stack, bits: u32, rows: &[u32; WIDTH], columns: &[u32; WIDTH]) {
        push_each(stack, bits, rows, columns);
    }
}

impl Lanes for Avx512 {
    #[inline(always)]
    fn store(self, to: &mut [f32; TILE]) {
        call! { _mm512_storeu_ps(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn splat(x: f32) -> Avx512 {
        call! { Avx512(_mm512_set1_ps(x)) }
    }

    #[inline(always)]
    fn rows(x: &[f32; WIDTH]) -> Avx512 {
        call! {
            let x = _mm512_broadcast_f32x4(_mm_loadu_ps(x.as_ptr()));
            Avx512(_mm512_permutevar_ps(x, row_of_lane()))
        }
    }

    #[inline(always)]
    fn columns(x: &[f32; WIDTH]) -> Avx512 {
        call! { Avx512(_mm512_broadcast_f32x4(_mm_loadu_ps(x.as_ptr()))) }
    }

    #[inline(always)]
    fn add(self, other: Avx512) -> Avx512 {
        call! { Avx512(_mm512_add_ps(self.0, other.0)) }
    }

    #[inline(always)]
    fn sub(self, other: Avx512) -> Avx512 {
        call! { Avx512(_mm512_sub_ps(self.0, other.0)) }
    }

    #[inline(always)]
    fn mul_add(self, factor: Avx512, sum: Avx512) -> Avx512 {
        call! { Avx512(_mm512_fmadd_ps(self.0, factor.0, sum.0)) }
    }

    #[inline(always)]
    fn mul(self, factor: Avx512) -> Avx512 {
        call! { Avx512(_mm512_mul_ps(self.0, factor.0)) }
    }

    #[inline(always)]
    fn abs(self) -> Avx512 {
        call! { Avx512(_mm512_abs_ps(self.0)) }
    }

    #[inline(always)]
    fn min(self, other: Avx512) -> Avx512 {
        call! { Avx512(_mm512_min_ps(self.0, other.0)) }
    }

    #[inline(always)]
    fn max(self, other: Avx512) -> Avx512 {
        call! { Avx512(_mm512_max_ps(self.0, other.0)) }
    }

    #[inline(always)]
    fn at_most(self, other: Avx512) -> u32 {
        call! { u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0)) }
    }

    #[inline(always)]
    fn above(self, other: Avx512) -> u32 {
        call! { u32::from(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(self.0, other.0)) }
    }

    #[inline(always)]
    fn least(self, among: u32) -> (u32, bool) {
        call! {
            // The lowest bits hold the number of the lane.
            let bits = _mm512_castps_si512(self.0);
            let lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            let key = _mm512_or_si512(_mm512_and_si512(bits, _mm512_set1_epi32(!15)), lane);
            let key = _mm512_castsi512_ps(key);
            let least = _mm512_mask_reduce_min_ps(among as __mmask16, key);
            (least.to_bits() & 15, least.is_sign_negative())
        }
    }

    #[inline(always)]
    fn push(stack: &mut Stack, bits: u32, rows: &[u32; WIDTH], columns: &[u32; WIDTH]) {
        call! {
            let rows = _mm512_broadcast_i32x4(_mm_loadu_si128(rows.as_ptr().cast()));
            let rows = _mm512_permutevar_ps(_mm512_castsi512_ps(rows), row_of_lane());
            let columns = _mm512_broadcast_i32x4(_mm_loadu_si128(columns.as_ptr().cast()));
            let pack = |x| words(_mm512_maskz_compress_epi32(bits as __mmask16, x));
            let rows = pack(_mm512_castps_si512(rows));
            stack.push_tile(rows, pack(columns), bits.count_ones() as usize);
        }
    }
}

/// The floats with the number of their lane in the lowest bits; infinite for lanes outside `among`.
#[inline]
#[target_feature(enable = "avx2")]
fn keys(x: __m256, lane: __m256i, among: u32) -> __m256 {
    let bits = _mm256_and_si256(_mm256_castps_si256(x), _mm256_set1_epi32(!15));
    let key = _mm256_castsi256_ps(_mm256_or_si256(bits, lane));
    let bit = _mm256_sllv_epi32(_mm256_set1_epi32(1), lane);
    let is_not = _mm256_andnot_si256(_mm256_set1_epi32(among as i32), bit);
    let is_not = _mm256_castsi256_ps(_mm256_cmpeq_epi32(is_not, bit));
    _mm256_blendv_ps(key, _mm256_set1_ps(f32::INFINITY), is_not)
}

/// Indices that select, within each row of four lanes, the lane with the number of the row.
#[inline]
#[target_feature(enable = "avx512f")]
fn row_of_lane() -> __m512i {
    _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3)
}

#[inline(always)]
fn words(x: __m512i) -> [u32; TILE] {
    // SAFETY: both are 64 bytes in which every pattern is a value.
    unsafe { core::mem::transmute(x) }
}
