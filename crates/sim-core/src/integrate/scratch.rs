//! Memory for intermediate results.

use alloc::{boxed::Box, vec::Vec};
use glam::DVec3;

use super::{Jacobians, implicit::Progress};
use crate::rotation::Rotor;

/// Columns for the intermediate results of a method, kept so that only the first step allocates. Their contents at the
/// start of a step have no meaning, so a copy starts without them.
#[derive(Debug, Default)]
pub struct Scratch {
    stages: Vec<DVec3>,
    pub(super) newton: Newton,
    /// Boxed, because it is seldom needed and each step moves the scratch.
    pub(crate) gathered: Option<Box<Gathered>>,
    /// The sum of bodies over all steps that adaptive methods have tried since this was last reset.
    pub(crate) tried: u64,
}

/// Columns for bodies that are copied side by side to be stepped.
#[derive(Debug, Default)]
pub(crate) struct Gathered {
    columns: Vec<DVec3>,
    mass: Vec<f64>,
    pub(crate) rotors: Vec<Rotor>,
}

impl Clone for Scratch {
    fn clone(&self) -> Scratch {
        Scratch::default()
    }
}

impl Gathered {
    /// `N` columns of `len` vectors, and one of masses.
    pub(crate) fn columns<const N: usize>(
        &mut self,
        len: usize,
    ) -> ([&mut [DVec3]; N], &mut [f64]) {
        if self.mass.len() < len {
            self.mass.resize(len, 0.0);
        }
        (columns(&mut self.columns, len), &mut self.mass[..len])
    }
}

/// Columns for an implicit equation, separate from those of the stages.
#[derive(Debug, Default)]
pub(super) struct Newton {
    columns: Vec<DVec3>,
    pub(super) jacobians: Vec<Jacobians>,
    /// The inverted matrices of three stages, for each body.
    pub(super) inverses: Vec<[[f64; 9]; 9]>,
    pub(super) progress: Vec<Progress>,
}

impl Scratch {
    /// `N` columns of `len` vectors.
    pub fn columns<const N: usize>(&mut self, len: usize) -> [&mut [DVec3]; N] {
        columns(&mut self.stages, len)
    }

    /// `N` columns of `len` vectors, and the columns for an implicit equation.
    pub(super) fn with_newton<const N: usize>(
        &mut self,
        len: usize,
    ) -> ([&mut [DVec3]; N], &mut Newton) {
        (columns(&mut self.stages, len), &mut self.newton)
    }
}

impl Newton {
    /// The progress of `len` bodies, to be put back later.
    pub(super) fn take_progress(&mut self, len: usize) -> Vec<Progress> {
        let mut progress = core::mem::take(&mut self.progress);
        progress.resize(len, Progress::NONE);
        progress
    }

    /// `N` columns of `len` vectors, and the matrices.
    pub(super) fn columns<const N: usize>(
        &mut self,
        len: usize,
    ) -> ([&mut [DVec3]; N], &mut Vec<Jacobians>) {
        (columns(&mut self.columns, len), &mut self.jacobians)
    }

    /// The same, with the matrices of three stages.
    #[expect(clippy::type_complexity, reason = "each part is borrowed for itself")]
    pub(super) fn with_inverses<const N: usize>(
        &mut self,
        len: usize,
    ) -> (
        [&mut [DVec3]; N],
        &mut Vec<Jacobians>,
        &mut Vec<[[f64; 9]; 9]>,
    ) {
        let columns = columns(&mut self.columns, len);
        (columns, &mut self.jacobians, &mut self.inverses)
    }
}

fn columns<const N: usize>(room: &mut Vec<DVec3>, len: usize) -> [&mut [DVec3]; N] {
    if room.len() < N * len {
        room.resize(N * len, DVec3::ZERO);
    }
    let mut rest = &mut room[..N * len];
    core::array::from_fn(|_| {
        let (column, others) = core::mem::take(&mut rest).split_at_mut(len);
        rest = others;
        column
    })
}
