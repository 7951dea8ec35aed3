//! The vector instructions that lanes use.

#[cfg(target_arch = "x86_64")]
use super::simd;
use super::{InLanes, Portable};

/// Instructions that lanes may use. All give the same answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// The instructions for which the crate was compiled: 128-bit vectors on x86-64 and on AArch64.
    Portable,
    /// 256-bit vectors of x86-64.
    Avx2,
    /// 512-bit vectors of x86-64: a whole tile in one.
    Avx512,
}

impl Level {
    /// Every level, narrowest first.
    pub const ALL: [Level; 3] = [Level::Portable, Level::Avx2, Level::Avx512];

    /// Whether this processor has the instructions. Without the feature `std`, only those for which the crate was
    /// compiled are known.
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

    /// Does work at this level, or at `Portable` if the level is not available.
    #[inline]
    pub(in crate::collide) fn run<W: InLanes>(self, work: W) -> W::Output {
        #[cfg(target_arch = "x86_64")]
        let work = match simd::run(self, work) {
            Ok(output) => return output,
            Err(work) => work,
        };
        portable(work)
    }
}

/// Not inlined, so that queries without it do not pay for its stack frame.
#[inline(never)]
fn portable<W: InLanes>(work: W) -> W::Output {
    work.run::<Portable>()
}
