//! The Cholesky factor `L` of a sparse symmetric matrix `L Lᵀ` of 3 × 3 blocks, one row of blocks a body.
//!
//! Rows are eliminated in the order of least degree (Tinney, Walker 1967, "Direct solutions of sparse
//! network equations by optimally ordered triangular factorization", scheme 2), so that `L` has little
//! fill-in. Each column is computed from those to its left (George, Liu 1981,
//! "Computer solution of large sparse positive definite systems", sec. 5).

use alloc::{vec, vec::Vec};
use glam::{DMat3, DVec3};

/// No place in a list.
const NONE: u32 = u32::MAX;

/// The factor, and where it may be other than zero.
pub(super) struct Cholesky {
    /// The place of each row in the order of elimination.
    place: Vec<u32>,
    /// Where the blocks below the diagonal of each column begin, by places, and where the last end.
    begin: Vec<usize>,
    /// The row of each block, by place, ascending in each column.
    rows: Vec<u32>,
    blocks: Vec<DMat3>,
    /// Of the diagonal blocks of `L`.
    inverse: Vec<DMat3>,
}

impl Cholesky {
    /// Of matrices of so many rows of blocks that are zero but on the diagonal and where two rows are
    /// tied.
    pub(super) fn of_graph(count: usize, ties: impl Iterator<Item = (usize, usize)>) -> Cholesky {
        // By row, a bit for each row that it is tied to and that has no place yet.
        let words = count.div_ceil(64);
        let mut near = vec![0_u64; count * words];
        for (i, j) in ties {
            near[i * words + j / 64] |= 1 << (j % 64);
            near[j * words + i / 64] |= 1 << (i % 64);
        }
        let of_row = |row: usize| row * words..(row + 1) * words;
        let size = |set: &[u64]| set.iter().map(|word| word.count_ones()).sum::<u32>();
        let mut degree: Vec<u32> = (0..count).map(|row| size(&near[of_row(row)])).collect();
        let (mut place, mut own) = (vec![NONE; count], vec![0; words]);
        let (mut begin, mut rows) = (vec![0], Vec::new());
        // Those that have no place, in order.
        let mut left: Vec<u32> = (0..count as u32).collect();
        for step in 0..count {
            let least = (0..left.len()).min_by_key(|&at| degree[left[at] as usize]);
            let Some(least) = least else {
                break;
            };
            let row = left.remove(least) as usize;
            place[row] = step as u32;
            own.copy_from_slice(&near[of_row(row)]);
            // Whatever is tied to it is tied together from now on.
            for other in bits(&own) {
                let set = &mut near[of_row(other)];
                for (word, own) in set.iter_mut().zip(&own) {
                    *word |= own;
                }
                for gone in [other, row] {
                    set[gone / 64] &= !(1 << (gone % 64));
                }
                degree[other] = size(set);
                rows.push(other as u32);
            }
            begin.push(rows.len());
        }
        for bounds in begin.windows(2) {
            let rows = &mut rows[bounds[0]..bounds[1]];
            rows.iter_mut().for_each(|row| *row = place[*row as usize]);
            rows.sort_unstable();
        }
        Cholesky {
            blocks: vec![DMat3::ZERO; rows.len()],
            inverse: vec![DMat3::ZERO; count],
            place,
            begin,
            rows,
        }
    }

    /// Begins with a matrix that is a multiple of one in each row.
    pub(super) fn begin(&mut self, diagonal: impl Iterator<Item = f64>) {
        self.blocks.fill(DMat3::ZERO);
        for (row, value) in diagonal.enumerate() {
            self.inverse[self.place[row] as usize] = DMat3::from_diagonal(DVec3::splat(value));
        }
    }

    /// Adds a block to the diagonal.
    pub(super) fn add(&mut self, row: usize, block: DMat3) {
        self.inverse[self.place[row] as usize] += block;
    }

    /// Adds a symmetric block where two rows are tied.
    pub(super) fn add_between(&mut self, i: usize, j: usize, block: DMat3) {
        let (i, j) = (self.place[i], self.place[j]);
        let (column, row) = (i.min(j) as usize, i.max(j));
        let first = self.begin[column];
        let below = &self.rows[first..self.begin[column + 1]];
        self.blocks[first + below.partition_point(|&other| other < row)] += block;
    }

    /// Factors what has been added, which has to be positive.
    pub(super) fn factor(&mut self) {
        let count = self.inverse.len();
        // The columns whose next block lies in a row, as lists: of each row the first, of each column the
        // next in its list, and of each column that block.
        let (mut first, mut next, mut at) = (vec![NONE; count], vec![NONE; count], vec![0; count]);
        let mut sums = vec![DMat3::ZERO; count];
        for column in 0..count {
            let (begin, end) = (self.begin[column], self.begin[column + 1]);
            let mut diagonal = self.inverse[column];
            let own = self.rows[begin..end].iter().zip(&self.blocks[begin..end]);
            for (&row, block) in own {
                sums[row as usize] = *block;
            }
            let mut left = first[column];
            while left != NONE {
                let (own, next_left) = (left as usize, next[left as usize]);
                let (here, end) = (at[own], self.begin[own + 1]);
                let across = self.blocks[here].transpose();
                diagonal -= self.blocks[here] * across;
                let below = self.rows[here + 1..end]
                    .iter()
                    .zip(&self.blocks[here + 1..end]);
                for (&row, block) in below {
                    sums[row as usize] -= *block * across;
                }
                self.pass_on(own, here + 1, (&mut first, &mut next, &mut at));
                left = next_left;
            }
            let inverse = inverse_of_root(diagonal);
            self.inverse[column] = inverse;
            let across = inverse.transpose();
            let own = self.rows[begin..end]
                .iter()
                .zip(&mut self.blocks[begin..end]);
            for (&row, block) in own {
                *block = sums[row as usize] * across;
            }
            self.pass_on(column, begin, (&mut first, &mut next, &mut at));
        }
    }

    /// Puts a column into the list of the row in which its next block lies.
    fn pass_on(
        &self,
        column: usize,
        place: usize,
        (first, next, at): (&mut [u32], &mut [u32], &mut [usize]),
    ) {
        if place < self.begin[column + 1] {
            let row = self.rows[place] as usize;
            at[column] = place;
            next[column] = first[row];
            first[row] = column as u32;
        }
    }

    /// The blocks of a column, with their rows.
    fn below(&self, column: usize) -> impl Iterator<Item = (&u32, &DMat3)> {
        let all = self.begin[column]..self.begin[column + 1];
        self.rows[all.clone()].iter().zip(&self.blocks[all])
    }

    /// Solves for a right-hand side, in its place, with some memory of the same length.
    pub(super) fn solve(&self, values: &mut [DVec3], memory: &mut [DVec3]) {
        for (row, &place) in self.place.iter().enumerate() {
            memory[place as usize] = values[row];
        }
        for column in 0..self.inverse.len() {
            let value = self.inverse[column] * memory[column];
            memory[column] = value;
            for (&row, block) in self.below(column) {
                memory[row as usize] -= *block * value;
            }
        }
        for column in (0..self.inverse.len()).rev() {
            let mut value = memory[column];
            for (&row, block) in self.below(column) {
                value -= block.transpose() * memory[row as usize];
            }
            memory[column] = self.inverse[column].transpose() * value;
        }
        for (row, &place) in self.place.iter().enumerate() {
            values[row] = memory[place as usize];
        }
    }
}

/// The places of the bits of a set, ascending.
fn bits(set: &[u64]) -> impl Iterator<Item = usize> {
    set.iter().enumerate().flat_map(|(word, &bits)| {
        let mut left = bits;
        core::iter::from_fn(move || {
            let bit = (left != 0).then(|| left.trailing_zeros() as usize)?;
            left &= left - 1;
            Some(64 * word + bit)
        })
    })
}

/// The inverse of the lower triangle `l` with `l lᵀ` a positive matrix.
fn inverse_of_root(matrix: DMat3) -> DMat3 {
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    // What rounding leaves of nothing would be no number.
    let root = |value: f64| libm::sqrt(value.max(f64::MIN_POSITIVE));
    let a = 1.0 / root(x.x);
    let (b, c) = (x.y * a, x.z * a);
    let d = 1.0 / root(y.y - b * b);
    let e = (y.z - b * c) * d;
    let f = 1.0 / root(z.z - c * c - e * e);
    DMat3::from_cols(
        DVec3::new(a, -b * a * d, (b * d * e - c) * a * f),
        DVec3::new(0.0, d, -e * d * f),
        DVec3::new(0.0, 0.0, f),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_solved_for_comes_back(
            count in 1_usize..14,
            ties in proptest::collection::vec(
                ((0_usize..14, 0_usize..14), prop::array::uniform3(-1.0..1.0)), 0..40),
            wanted in proptest::collection::vec(prop::array::uniform3(-1.0..1.0), 14),
        ) {
            let ties: Vec<((usize, usize), DVec3)> = ties
                .into_iter()
                .map(|((i, j), along)| ((i % count, j % count), DVec3::from_array(along)))
                .filter(|((i, j), _)| i != j)
                .collect();
            let mut matrix = Cholesky::of_graph(count, ties.iter().map(|tie| tie.0));
            matrix.begin((0..count).map(|row| 0.5 + row as f64));
            for &((i, j), along) in &ties {
                let block = outer(along);
                matrix.add(i, block);
                matrix.add(j, block);
                matrix.add_between(i, j, -block);
            }
            matrix.factor();
            let wanted: Vec<DVec3> = wanted[..count].iter().map(|&v| DVec3::from_array(v)).collect();
            let mut values: Vec<DVec3> =
                wanted.iter().enumerate().map(|(row, v)| (0.5 + row as f64) * *v).collect();
            for &((i, j), along) in &ties {
                let pull = along.dot(wanted[i] - wanted[j]) * along;
                values[i] += pull;
                values[j] -= pull;
            }
            matrix.solve(&mut values, &mut vec![DVec3::ZERO; count]);
            for (value, wanted) in values.iter().zip(&wanted) {
                prop_assert!((*value - *wanted).length() < 1e-11, "{value} for {wanted}");
            }
        }
    }

    fn outer(along: DVec3) -> DMat3 {
        DMat3::from_cols(along.x * along, along.y * along, along.z * along)
    }
}
