//! Cholesky factorisation of symmetric block-tridiagonal matrices.

use super::tiles::{
    BadPivot, ROWS, factorise_rows, substitute_backward, substitute_forward, subtract_square, with_rows,
};
use super::widest::widest_fused;
use std::fmt;

/// A pivot was not positive: the matrix is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotPositiveDefinite {
    /// The block of rows with the pivot.
    pub block: usize,
}

impl fmt::Display for NotPositiveDefinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the matrix is not positive definite at block {}", self.block)
    }
}

/// A symmetric matrix of `count` x `count` blocks, each `size` x `size`, with blocks on the diagonal and
/// beside it; then its factor U, A = U'U.
///
/// A block row holds the diagonal block and the one to its right, row by row, 2 `size` numbers a row. Only
/// the upper triangle of diagonal blocks is read. Rows are combined as wholes, so that loops run over
/// contiguous numbers.
#[derive(Clone, Debug)]
pub(crate) struct BlockTridiagonal {
    size: usize,
    rows: Vec<f64>,
}

impl BlockTridiagonal {
    /// The zero matrix.
    pub fn new(count: usize, size: usize) -> Self {
        Self { size, rows: vec![0.0; count * size * 2 * size] }
    }

    /// Sets the number of blocks, and all entries to zero. Allocates only if it is larger than ever before.
    pub fn reset(&mut self, count: usize) {
        self.rows.clear();
        self.rows.resize(count * self.size * 2 * self.size, 0.0);
    }

    /// Number of blocks on the diagonal.
    pub fn count(&self) -> usize {
        self.rows.len() / (2 * self.size * self.size)
    }

    /// Rows of a block: `size` rows of the diagonal block and the one to its right, 2 `size` numbers each.
    #[inline(always)]
    pub fn block_row(&mut self, k: usize) -> &mut [f64] {
        let length = 2 * self.size * self.size;
        &mut self.rows[k * length..(k + 1) * length]
    }

    /// The rows of two neighbouring blocks.
    #[inline(always)]
    pub fn block_rows(&mut self, k: usize) -> (&mut [f64], &mut [f64]) {
        let length = 2 * self.size * self.size;
        let (first, second) = self.rows[k * length..(k + 2) * length].split_at_mut(length);
        (first, second)
    }

    /// One row of a block.
    pub fn row(&self, k: usize, i: usize) -> &[f64] {
        let width = 2 * self.size;
        &self.rows[(k * self.size + i) * width..][..width]
    }

    /// Takes the entries of another matrix.
    pub fn copy_from(&mut self, other: &Self) {
        self.rows.clone_from(&other.rows);
        self.size = other.size;
    }

    /// A += factor B.
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.rows.iter_mut().zip(&other.rows).for_each(|(to, from)| *to += factor * from);
    }

    /// A = U'U in place, `size`^3 7/3 products a block; the diagonal of U is replaced by its reciprocals.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; the matrix is lost then.
    pub fn factorise(&mut self) -> Result<(), NotPositiveDefinite> {
        widest_fused(
            #[inline(always)]
            |fused| if fused { self.factorise_blocks::<true>() } else { self.factorise_blocks::<false>() },
        )
    }

    #[inline(always)]
    fn factorise_blocks<const FUSED: bool>(&mut self) -> Result<(), NotPositiveDefinite> {
        let (size, count, stride) = (self.size, self.count(), 2 * self.size);
        for k in 0..count {
            let width = if k + 1 < count { stride } else { size };
            factorise_rows::<FUSED>(self.block_row(k), stride, size, width)
                .map_err(|BadPivot| NotPositiveDefinite { block: k })?;
            if k + 1 < count {
                let (above, below) = self.block_rows(k);
                subtract_square::<FUSED>(above, below, stride, size, size);
            }
        }
        Ok(())
    }

    /// x = A^-1 r in place, after [`factorise`](Self::factorise).
    pub fn solve(&self, r: &mut [f64]) {
        widest_fused(
            #[inline(always)]
            |fused| if fused { self.substitute::<true>(r) } else { self.substitute::<false>(r) },
        );
    }

    #[inline(always)]
    fn substitute<const FUSED: bool>(&self, r: &mut [f64]) {
        let (size, stride) = (self.size, 2 * self.size);
        // Rows of two blocks, the last ones of one.
        let rows = r.len();
        let part = |k: usize| k * size..((k + 2) * size).min(rows);
        let blocks = || self.rows.chunks_exact(stride * size).enumerate();
        for (k, rows) in blocks() {
            let r = &mut r[part(k)];
            for i in (0..size).step_by(ROWS) {
                let (rows, r) = (&rows[i * stride..], &mut r[i..]);
                with_rows!(i of size, R => substitute_forward::<FUSED, R>(rows, stride, i, r));
            }
        }
        for (k, rows) in blocks().rev() {
            let r = &mut r[part(k)];
            for i in (0..size).step_by(ROWS).rev() {
                let (rows, r) = (&rows[i * stride..], &mut r[i..]);
                with_rows!(i of size, R => substitute_backward::<FUSED, R>(rows, stride, i, r));
            }
        }
    }
}

/// x.y over the shorter of the two, in four sums.
#[inline(always)]
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let length = x.len().min(y.len());
    let (x, y) = (x[..length].chunks_exact(4), y[..length].chunks_exact(4));
    let rest: f64 = x.remainder().iter().zip(y.remainder()).map(|(x, y)| x * y).sum();
    let mut sums = [0.0; 4];
    for (x, y) in x.zip(y) {
        sums.iter_mut().zip(x.iter().zip(y)).for_each(|(sum, (x, y))| *sum += x * y);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::BlockTridiagonal;
    use nalgebra::{DMatrix, DVector};

    /// A random matrix with so many blocks, positive definite unless `shift` is negative, and the same one
    /// dense.
    fn random(count: usize, size: usize, shift: f64) -> (BlockTridiagonal, DMatrix<f64>) {
        let mut random = fastrand::Rng::with_seed(7);
        let mut matrix = BlockTridiagonal::new(count, size);
        let mut dense = DMatrix::zeros(count * size, count * size);
        for k in 0..count {
            for i in 0..size {
                for j in 0..if k + 1 < count { 2 * size } else { size } {
                    if j < i {
                        continue;
                    }
                    let entry = random.f64() - 0.5 + if i == j { shift } else { 0.0 };
                    matrix.block_row(k)[i * 2 * size + j] = entry;
                    dense[(k * size + i, k * size + j)] = entry;
                    dense[(k * size + j, k * size + i)] = entry;
                }
            }
        }
        // Below the diagonal of a diagonal block nothing is read; blocks to the right are full.
        for k in 0..count - 1 {
            for i in 0..size {
                for j in size..2 * size {
                    let entry = random.f64() - 0.5;
                    matrix.block_row(k)[i * 2 * size + j] = entry;
                    dense[(k * size + i, k * size + j)] = entry;
                    dense[(k * size + j, k * size + i)] = entry;
                }
            }
        }
        (matrix, dense)
    }

    #[test]
    fn solutions_are_those_of_the_dense_matrix() {
        for (count, size) in [(1, 1), (1, 5), (2, 3), (5, 6), (4, 9), (3, 14), (3, 18), (2, 21), (2, 36)] {
            let (matrix, dense) = random(count, size, 3.0 * size as f64);
            let expected = DVector::from_fn(count * size, |i, _| (i as f64 * 0.7).sin());
            let right = &dense * &expected;
            for fused in [false, true] {
                let (mut matrix, mut found) = (matrix.clone(), right.clone());
                if fused {
                    matrix.factorise_blocks::<true>().unwrap();
                    matrix.substitute::<true>(found.as_mut_slice());
                } else {
                    matrix.factorise_blocks::<false>().unwrap();
                    matrix.substitute::<false>(found.as_mut_slice());
                }
                assert!((found - &expected).amax() < 1e-12, "{count} {size} {fused}");
            }
            let (mut matrix, mut found) = (matrix, right);
            matrix.factorise().unwrap();
            matrix.solve(found.as_mut_slice());
            assert!((found - expected).amax() < 1e-12, "{count} {size}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        let (mut matrix, dense) = random(3, 4, -1.0);
        assert!(dense.symmetric_eigenvalues().min() < 0.0);
        assert!(matrix.factorise().is_err());
        let (mut matrix, _) = random(3, 4, f64::NAN);
        assert!(matrix.factorise().is_err());
    }
}
