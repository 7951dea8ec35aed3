//! The Cholesky factor `L` of a sparse symmetric matrix `L Lᵀ` of 3 × 3 blocks, with one row of blocks for each body.
//!
//! Rows are eliminated in the order of least degree (Tinney, Walker 1967, "Direct solutions of sparse network
//! equations by optimally ordered triangular factorization", scheme 2), so that `L` has little fill-in. Each column
//! is computed from those to its left (George, Liu 1981, "Computer solution of large sparse positive definite
//! systems", sec. 5).

use alloc::{vec, vec::Vec};
use glam::{DMat3, DVec3};

/// No position in a list.
const NONE: u32 = u32::MAX;

/// The blocks of the factor that may be other than zero.
#[derive(Clone, Debug)]
pub(super) struct Pattern {
    /// The place of each row in the order of elimination.
    pub(super) place: Vec<u32>,
    /// The index of the first block below the diagonal of each column, by place, and the end of the last column.
    begin: Vec<usize>,
    /// The row of each block, by place, ascending in each column.
    rows: Vec<u32>,
}

/// The factor. Rows and columns are in the order of elimination.
pub(super) struct Cholesky<'a> {
    pattern: &'a Pattern,
    blocks: Vec<DMat3>,
    /// The inverses of the diagonal blocks of `L`.
    inverse: Vec<DMat3>,
    memory: Memory,
}

/// Memory for the factorization, by column.
struct Memory {
    /// Linked lists of the columns whose next block is in a row: the first column for each row, the next column in
    /// the list for each column, and the index of that block for each column.
    first: Vec<u32>,
    next: Vec<u32>,
    at: Vec<usize>,
    sums: Vec<DMat3>,
}

impl Pattern {
    /// The pattern of matrices with `count` rows of blocks, whose blocks are zero except on the diagonal and between
    /// two tied rows.
    pub(super) fn of_graph(count: usize, ties: impl Iterator<Item = (usize, usize)>) -> Pattern {
        // By row, one bit for each row that is tied to it and has no place yet.
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
        // The rows without a place, in order.
        let mut left: Vec<u32> = (0..count as u32).collect();
        for step in 0..count {
            let least = (0..left.len()).min_by_key(|&at| degree[left[at] as usize]);
            let Some(least) = least else {
                break;
            };
            let row = left.remove(least) as usize;
            place[row] = step as u32;
            own.copy_from_slice(&near[of_row(row)]);
            // From now on, all rows tied to this row are tied to each other.
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
        Pattern { place, begin, rows }
    }

    /// The index of the block between two tied places.
    pub(super) fn between(&self, i: usize, j: usize) -> usize {
        let (column, row) = (i.min(j), i.max(j) as u32);
        let first = self.begin[column];
        let below = &self.rows[first..self.begin[column + 1]];
        first + below.partition_point(|&other| other < row)
    }
}

impl Cholesky<'_> {
    pub(super) fn of(pattern: &Pattern) -> Cholesky<'_> {
        let count = pattern.place.len();
        Cholesky {
            blocks: vec![DMat3::ZERO; pattern.rows.len()],
            inverse: vec![DMat3::ZERO; count],
            memory: Memory {
                first: vec![NONE; count],
                next: vec![NONE; count],
                at: vec![0; count],
                sums: vec![DMat3::ZERO; count],
            },
            pattern,
        }
    }

    /// Begins with a matrix whose diagonal blocks are multiples of the identity.
    pub(super) fn begin(&mut self, diagonal: &[f64]) {
        self.blocks.fill(DMat3::ZERO);
        for (block, &value) in self.inverse.iter_mut().zip(diagonal) {
            *block = DMat3::from_diagonal(DVec3::splat(value));
        }
    }

    /// Adds a block to the diagonal.
    pub(super) fn add(&mut self, row: usize, block: &DMat3) {
        self.inverse[row] += *block;
    }

    /// Subtracts a symmetric block [between](Pattern::between) two rows.
    pub(super) fn take_between(&mut self, at: usize, block: &DMat3) {
        self.blocks[at] -= *block;
    }

    /// Factors the matrix, which must be positive definite.
    pub(super) fn factor(&mut self) {
        let Cholesky {
            pattern: Pattern { begin, rows, .. },
            blocks,
            inverse,
            memory:
                Memory {
                    first,
                    next,
                    at,
                    sums,
                },
        } = self;
        // Adds a column to the list of the row that has its next block.
        let pass_on = |column: usize, place: usize, first: &mut [u32], next: &mut [u32]| {
            if place < begin[column + 1] {
                let row = rows[place] as usize;
                next[column] = first[row];
                first[row] = column as u32;
            }
        };
        first.fill(NONE);
        for column in 0..inverse.len() {
            let (start, end) = (begin[column], begin[column + 1]);
            let mut diagonal = inverse[column];
            for (&row, block) in rows[start..end].iter().zip(&blocks[start..end]) {
                sums[row as usize] = *block;
            }
            let mut left = first[column];
            while left != NONE {
                let own = left as usize;
                left = next[own];
                let here = at[own];
                let below = here + 1..begin[own + 1];
                let across = blocks[here].transpose();
                diagonal -= blocks[here] * across;
                for (&row, block) in rows[below.clone()].iter().zip(&blocks[below]) {
                    sums[row as usize] -= *block * across;
                }
                at[own] = here + 1;
                pass_on(own, here + 1, first, next);
            }
            let root = inverse_of_root(diagonal);
            inverse[column] = root;
            let across = root.transpose();
            for (&row, block) in rows[start..end].iter().zip(&mut blocks[start..end]) {
                *block = sums[row as usize] * across;
            }
            at[column] = start;
            pass_on(column, start, first, next);
        }
    }

    /// Solves for a right-hand side, in place.
    pub(super) fn solve(&self, values: &mut [DVec3]) {
        let Pattern { begin, rows, .. } = self.pattern;
        for (column, inverse) in self.inverse.iter().enumerate() {
            let below = begin[column]..begin[column + 1];
            let value = *inverse * values[column];
            values[column] = value;
            for (&row, block) in rows[below.clone()].iter().zip(&self.blocks[below]) {
                values[row as usize] -= *block * value;
            }
        }
        for (column, inverse) in self.inverse.iter().enumerate().rev() {
            let below = begin[column]..begin[column + 1];
            let mut value = values[column];
            for (&row, block) in rows[below.clone()].iter().zip(&self.blocks[below]) {
                value -= transposed_times(block, values[row as usize]);
            }
            values[column] = transposed_times(inverse, value);
        }
    }
}

/// `matrixᵀ v`.
fn transposed_times(matrix: &DMat3, v: DVec3) -> DVec3 {
    DVec3::new(
        matrix.x_axis.dot(v),
        matrix.y_axis.dot(v),
        matrix.z_axis.dot(v),
    )
}

/// The indices of the bits of a set, ascending.
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

/// The inverse of the lower triangle `l` with `l lᵀ` equal to a positive definite matrix.
fn inverse_of_root(matrix: DMat3) -> DMat3 {
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    // Rounding may leave a value of zero or less, whose root would be no valid divisor.
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
            let pattern = Pattern::of_graph(count, ties.iter().map(|tie| tie.0));
            let place: Vec<usize> = pattern.place.iter().map(|&place| place as usize).collect();
            let between = |(i, j): (usize, usize)| pattern.between(place[i], place[j]);
            let at: Vec<usize> = ties.iter().map(|tie| between(tie.0)).collect();
            let mut diagonal = vec![0.0; count];
            for (row, &place) in place.iter().enumerate() {
                diagonal[place] = 0.5 + row as f64;
            }
            let mut matrix = Cholesky::of(&pattern);
            matrix.begin(&diagonal);
            for (&((i, j), along), at) in ties.iter().zip(at) {
                let block = outer(along);
                matrix.add(place[i], &block);
                matrix.add(place[j], &block);
                matrix.take_between(at, &block);
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
            let mut placed = vec![DVec3::ZERO; count];
            for (value, &place) in values.iter().zip(&place) {
                placed[place] = *value;
            }
            matrix.solve(&mut placed);
            for (&place, wanted) in place.iter().zip(&wanted) {
                let value = placed[place];
                prop_assert!((value - *wanted).length() < 1e-11, "{value} for {wanted}");
            }
        }
    }

    fn outer(along: DVec3) -> DMat3 {
        DMat3::from_cols(along.x * along, along.y * along, along.z * along)
    }
}
