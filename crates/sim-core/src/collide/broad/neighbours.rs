//! Pairs of boxes that meet, by pair and by body.

use alloc::vec::Vec;

use super::rows::Rows;

#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    pairs: Vec<(u32, u32)>,
    /// The index of the first partner of each body.
    begin: Vec<u32>,
    partners: Vec<u32>,
}

impl Neighbours {
    /// Takes the pairs of some rows; `bodies` is above the index of every body.
    pub(super) fn fill(&mut self, rows: &Rows, bodies: usize) {
        self.pairs.clear();
        rows.each_pair(|i, j| self.pairs.push((i as u32, j as u32)));
        // Counting sort by body.
        self.begin.clear();
        self.begin.resize(bodies + 1, 0);
        for &(i, j) in &self.pairs {
            self.begin[i as usize] += 1;
            self.begin[j as usize] += 1;
        }
        let mut end = 0;
        for begin in &mut self.begin {
            end += *begin;
            *begin = end;
        }
        self.partners.clear();
        self.partners.resize(end as usize, 0);
        for &(i, j) in &self.pairs {
            for (body, partner) in [(i, j), (j, i)] {
                let place = &mut self.begin[body as usize];
                *place -= 1;
                self.partners[*place as usize] = partner;
            }
        }
    }

    /// Each pair, the lower body first.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.pairs.iter().map(|&(i, j)| (i as usize, j as usize))
    }

    /// The partners of a body.
    pub(super) fn of(&self, body: usize) -> impl Iterator<Item = usize> {
        let partners = self.begin[body] as usize..self.begin[body + 1] as usize;
        self.partners[partners].iter().map(|&body| body as usize)
    }
}
