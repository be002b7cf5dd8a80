//! Symmetric equations with a border: few unknowns y beside many x.

use super::chain::dot;
use super::cholesky;

/// The equations
///
/// $$ \begin{pmatrix} K & B \\\\ B^\top & C \end{pmatrix} \begin{pmatrix} x \\\\ y \end{pmatrix} =
///    \begin{pmatrix} f \\\\ g \end{pmatrix} $$
///
/// from a factorisation of K: with the Cholesky factor of the dense $S = C - B^\top K^{-1} B$.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bordered {
    /// B: the first columns, so many as were asked for.
    pub columns: Vec<Vec<f64>>,
    /// C, row by row.
    pub corner: Vec<f64>,
    count: usize,
    /// K^-1 B.
    solved: Vec<Vec<f64>>,
    /// The lower factor of S.
    factor: Vec<f64>,
}

impl Bordered {
    /// Empty columns, and room for C, which is zero. Allocates only if there are more columns than ever
    /// before.
    pub fn reset(&mut self, count: usize) {
        self.count = count;
        if self.columns.len() < count {
            self.columns.resize_with(count, Vec::new);
        }
        self.columns.iter_mut().for_each(Vec::clear);
        self.corner.clear();
        self.corner.resize(count * count, 0.0);
    }

    /// Factorises, where `solve` multiplies by K^-1. Whether S is positive definite: pivots that are not
    /// larger than the part `rounding` of the diagonal of C do not count as positive.
    pub fn factorise(&mut self, rounding: f64, mut solve: impl FnMut(&mut [f64])) -> bool {
        let count = self.count;
        if self.solved.len() < count {
            self.solved.resize_with(count, Vec::new);
        }
        for (solved, column) in self.solved.iter_mut().zip(&self.columns[..count]) {
            solved.clone_from(column);
            solve(solved);
        }
        self.factor.clear();
        self.factor.resize(count * count, 0.0);
        for i in 0..count {
            for j in 0..=i {
                let at = count * i + j;
                self.factor[at] = self.corner[at] - dot(&self.columns[i], &self.solved[j]);
            }
        }
        let corner = &self.corner;
        cholesky::factorise_above(&mut self.factor, count, |i, _| rounding * corner[count * i + i].abs())
    }

    /// From `K^-1 f` and g to x and y. The entries of x stand in two lists, one after the other.
    pub fn finish(&self, x: [&mut [f64]; 2], y: &mut [f64]) {
        let (count, [first, second]) = (self.count, x);
        for (y, column) in y.iter_mut().zip(&self.columns[..count]) {
            let (of_first, of_second) = column.split_at(first.len());
            *y = *y - dot(of_first, first) - dot(of_second, second);
        }
        cholesky::solve(&self.factor, count, y);
        for (y, solved) in y.iter().zip(&self.solved) {
            let x = first.iter_mut().chain(second.iter_mut());
            x.zip(solved).for_each(|(x, entry)| *x -= y * entry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// A random symmetric matrix whose eigenvalues are 1 and more.
    fn random(size: usize, seed: u64) -> DMatrix<f64> {
        let mut random = fastrand::Rng::with_seed(seed);
        let half = DMatrix::from_fn(size, size, |_, _| random.f64() - 0.5);
        &half * half.transpose() + DMatrix::identity(size, size)
    }

    fn bordered(whole: &DMatrix<f64>, many: usize) -> (Bordered, bool) {
        let count = whole.nrows() - many;
        let mut found = Bordered::default();
        found.reset(count);
        for (j, column) in found.columns.iter_mut().enumerate() {
            column.extend(whole.view((0, many + j), (many, 1)).iter());
        }
        found.corner.copy_from_slice(whole.view((many, many), (count, count)).clone_owned().as_slice());
        let inverse = whole.view((0, 0), (many, many)).clone_owned().try_inverse().unwrap();
        let definite = found.factorise(1e-14, |column| {
            let product = &inverse * DVector::from_column_slice(column);
            column.copy_from_slice(product.as_slice());
        });
        (found, definite)
    }

    #[test]
    fn the_whole_is_solved() {
        let (whole, many) = (random(9, 5), 6);
        let (found, definite) = bordered(&whole, many);
        assert!(definite);
        let right = DVector::from_fn(9, |i, _| 1.0 + i as f64);
        let expected = whole.clone().try_inverse().unwrap() * &right;
        let inverse = whole.view((0, 0), (many, many)).clone_owned().try_inverse().unwrap();
        let mut x = (inverse * right.rows(0, many)).as_slice().to_vec();
        let mut y = right.rows(many, 3).iter().copied().collect::<Vec<_>>();
        let (first, second) = x.split_at_mut(4);
        found.finish([first, second], &mut y);
        for (found, expected) in x.iter().chain(&y).zip(expected.iter()) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        let mut whole = random(9, 5);
        whole[(8, 8)] = -1.0;
        assert!(!bordered(&whole, 6).1);
        // With the same column twice S is singular but for rounding.
        let mut whole = random(9, 6);
        for i in 0..9 {
            whole[(i, 8)] = whole[(i, 7)];
        }
        for i in 0..9 {
            whole[(8, i)] = whole[(7, i)];
        }
        assert!(!bordered(&whole, 6).1);
    }
}
