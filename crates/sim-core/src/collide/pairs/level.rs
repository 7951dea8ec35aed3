//! Which instructions a descent uses.

use core::ops::ControlFlow;

#[cfg(target_arch = "x86_64")]
use super::simd;
use super::{Meshes, Portable, Question, overlap};

/// Instructions that a descent may use. All give the same answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// What the crate was compiled for: 128-bit vectors on x86-64 and on AArch64.
    Portable,
    /// 256-bit vectors of x86-64.
    Avx2,
    /// 512-bit vectors of x86-64: all of a tile in one.
    Avx512,
}

impl Level {
    /// Every level, narrowest first.
    pub const ALL: [Level; 3] = [Level::Portable, Level::Avx2, Level::Avx512];

    /// Whether this processor has it. Without the feature `std` only what the crate was compiled
    /// for is known.
    #[inline]
    pub fn is_available(self) -> bool {
        self <= Level::best()
    }

    /// The widest level that this processor has.
    #[inline]
    pub fn best() -> Level {
        #[cfg(target_arch = "x86_64")]
        return simd::widest();
        #[cfg(not(target_arch = "x86_64"))]
        Level::Portable
    }

    /// Answers a question at this level; one that is not available is `Portable`.
    #[inline]
    pub(in crate::collide) fn ask<Q: Question, const TURNED: bool>(
        self,
        meshes: Meshes<'_>,
        question: &mut Q,
    ) -> ControlFlow<()> {
        #[cfg(target_arch = "x86_64")]
        if let Some(answer) = simd::ask::<Q, TURNED>(self, meshes, question) {
            return answer;
        }
        portable::<Q, TURNED>(meshes, question)
    }
}

/// Not to take its stack in queries that do without it.
#[inline(never)]
fn portable<Q: Question, const TURNED: bool>(
    meshes: Meshes<'_>,
    question: &mut Q,
) -> ControlFlow<()> {
    overlap::ask::<Portable, Q, TURNED>(meshes, question)
}
