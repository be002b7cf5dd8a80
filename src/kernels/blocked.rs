//! The factors of the mass matrix block by block: as many rows at once as a pack has lanes.
//!
//! `N = D^1/2 L` takes the place of L here: `M = N' N`, and one matrix holds what is eliminated and what is
//! left.

use super::Factor;
use super::corner::Corner;
use super::factor_tiles::FactorTiles;
use crate::matrix::{Left, Matrix, Panel};
use crate::scalar::{MOST_LANES, Pack, Scalar};
use std::ops::Range;

impl<S: Scalar> Factor<S> {
    /// Rows of this block.
    pub(super) fn rows(&self, block: usize) -> Range<usize> {
        let first = block * Panel::<S>::LANES;
        first..(first + Panel::<S>::LANES).min(self.pivots.len())
    }

    /// Number of blocks of rows.
    pub(super) fn blocks(&self) -> usize {
        self.corners.len()
    }

    /// `M = N' N` of a matrix.
    #[inline(never)]
    pub(super) fn eliminate_blocks(&mut self, tiles: &FactorTiles, mass_matrix: &Matrix<S>) {
        let (n, register) = (mass_matrix.rows(), Panel::<S>::LANES * <S::Pack as Pack<S>>::WIDTH);
        // The entries of the registers that hold some on or below the diagonal.
        for i in 0..n {
            let columns = (i + 1).next_multiple_of(register).min(n);
            self.l.entries_mut().read_row::<0>(i, &mass_matrix.row(i)[..columns]);
        }
        self.eliminate_read(tiles);
    }

    /// The same for a panel.
    #[inline(never)]
    pub(super) fn eliminate_panel(&mut self, tiles: &FactorTiles, mass_matrix: &Panel<S>) {
        for block in 0..self.blocks() {
            for pack in 0..(block + 1).next_multiple_of(<S::Pack as Pack<S>>::WIDTH) {
                self.l.entries_mut().set_block::<0>(block, pack, &mass_matrix.block::<0>(block, pack));
            }
        }
        self.eliminate_read(tiles);
    }

    /// `row_i = M_i - sum_k N_ki N_k` over k > i and `N_i = row_i / sqrt(D_i)`, block by block from the last.
    #[inline(always)]
    fn eliminate_read(&mut self, tiles: &FactorTiles) {
        self.inverted = false;
        // Rows beyond the last, up to a whole block, are those of the unit matrix.
        let lanes = Panel::<S>::LANES;
        for k in self.pivots.len()..self.blocks() * lanes {
            self.l.entries_mut().row_mut(k)[k / lanes] = S::Pack::zero().with_lane(k % lanes, S::one());
        }
        for block in (0..self.blocks()).rev() {
            let (rows, n) = (self.rows(block), self.l.entries_mut());
            n.subtract_own_square(&tiles.eliminate, block);
            let (corner, pivots) = Corner::<S>::of(n.block::<0>(block, block));
            pivots.write(&mut self.pivots[rows]);
            self.corners[block] = corner;
            for &pack in tiles.lower.of(block) {
                let x = corner.solve(n.block::<0>(block, pack), corner.roots);
                n.set_block::<0>(block, pack, &x);
            }
        }
    }

    /// `R' = N'^-1`, block by block from the last: with the diagonal block C of N, `R'_I = C'^-1 (1 - sum_k
    /// N_kI R'_k)` over rows k of other blocks.
    #[inline(never)]
    pub(super) fn invert_blocks(&mut self, tiles: &FactorTiles) {
        let mut unit = [S::Pack::zero(); MOST_LANES];
        for (r, row) in unit.iter_mut().enumerate().take(Panel::<S>::LANES) {
            *row = row.with_lane(r, S::one());
        }
        for block in (0..self.blocks()).rev() {
            let corner = self.corners[block];
            self.upper.set_own_rows(&tiles.invert, block, self.l.entries());
            for &pack in tiles.upper.of(block) {
                // Rows of later blocks are zero in this pack.
                let x = if pack == block {
                    corner.solve(unit, corner.roots)
                } else {
                    corner.solve(self.upper.block::<0>(block, pack), -corner.roots)
                };
                self.upper.set_block::<0>(block, pack, &x);
            }
        }
        self.inverted = true;
    }

    /// `M^-1 = R R'` on and below the diagonal.
    #[inline(never)]
    pub(super) fn form_inverse_by_blocks(&mut self, tiles: &FactorTiles) {
        if !self.inverted {
            self.invert_blocks(tiles);
        }
        self.product.set_tiles(&tiles.inverse, Left::Columns(&self.upper), &self.upper);
    }
}

#[cfg(test)]
mod tests {
    use crate::kernels::{Factor, KernelOne};
    use crate::matrix::{Matrix, Panel};
    use crate::robot::Tree;
    use crate::robot::test_robot::robot;
    use nalgebra::{DMatrix, DVector};

    fn tree(n: usize, parent: impl Fn(usize) -> usize, coupled: bool) -> Tree {
        Tree::from(&robot(n, parent, coupled))
    }

    fn compare(tree: &Tree) {
        let n = tree.dof();
        let numbers = |from: f64| (0..n).map(|i| (from + 1.3 * i as f64).sin()).collect::<Vec<f64>>();
        let (mut kernel, mut factor) = (KernelOne::<f64>::new(tree), Factor::<f64>::new(tree));
        // The second time, nothing may be left of the first.
        for from in [0.3, 1.1] {
            kernel.set_position(tree, &numbers(from)).unwrap();
            factor.factor(kernel.mass_matrix(), |k| kernel.size_of_entry(tree, k)).unwrap();
            let m = DMatrix::from_row_slice(n, n, kernel.mass_matrix().as_slice());
            let expected = m.clone().try_inverse().unwrap();
            let mut inverse = Matrix::zeros(n, n);
            factor.inverse(&mut inverse);
            let inverse = DMatrix::from_row_slice(n, n, inverse.as_slice());
            assert_eq!(inverse, inverse.transpose());
            assert!((&inverse - &expected).amax() < 1e-11 * expected.amax(), "n = {n}");
            let mut x = numbers(0.7);
            let solved = &expected * DVector::from_column_slice(&x);
            factor.solve(&mut x);
            assert!((DVector::from_column_slice(&x) - &solved).amax() < 1e-11 * solved.amax(), "n = {n}");
            // The inverse has U' computed; without it by substitution.
            let mut x = numbers(0.7);
            factor.factor(kernel.mass_matrix(), |k| kernel.size_of_entry(tree, k)).unwrap();
            factor.solve(&mut x);
            assert!((DVector::from_column_slice(&x) - &solved).amax() < 1e-11 * solved.amax(), "n = {n}");
            let mut large = Matrix::zeros(2 * n, 2 * n);
            factor.place_inverse(&mut large, (n, 0));
            if Panel::<f64>::in_blocks(n) {
                assert_eq!(large.block(n, 0, n, n).to_nalgebra(), inverse);
            }
        }
        // A row and column of zeros.
        let mut singular = kernel.mass_matrix().clone();
        (0..n).for_each(|k| (singular[(n / 3, k)], singular[(k, n / 3)]) = (0.0, 0.0));
        assert_eq!(factor.factor(&singular, |_| 1.0), Err(n / 3));
    }

    #[test]
    fn blocks_give_the_inverse_of_the_mass_matrix_of_any_tree() {
        for n in [1, 12, 13, 14, 15, 16, 17, 30, 67] {
            compare(&tree(n, |k| k.wrapping_sub(1), false));
            compare(&tree(n, |k| k / 2 + k % 3, false));
            compare(&tree(n, |k| (k * k + 1) % (k + 2), false));
        }
        compare(&tree(19, |k| (k * k + 1) % (k + 2), true));
        compare(&tree(26, |k| k / 3, true));
    }
}
