//! The factors of the mass matrix block by block: as many rows at once as a pack has lanes.
//!
//! `N = D^1/2 L` takes the place of L here: `M = N' N`, and one matrix holds what is eliminated and what is left.

use super::Factor;
use super::factor_tiles::FactorTiles;
use crate::matrix::{Left, Matrix, Panel};
use crate::scalar::{MOST_LANES, Pack, Scalar};
use std::ops::Range;

/// Some rows of a matrix, in one pack.
type Rows<S> = [<S as Scalar>::Pack; MOST_LANES];

/// A diagonal block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner<S: Scalar> {
    /// Rows of L: only entries below its diagonal have a meaning.
    l: Rows<S>,
    /// `D^-1/2`.
    roots: S::Pack,
}

impl<S: Scalar> Corner<S> {
    /// That of the unit matrix.
    pub fn unit() -> Self {
        Self { l: [S::Pack::zero(); MOST_LANES], roots: S::Pack::one() }
    }

    /// L and D of a symmetric block, whose entries above the diagonal do not matter; D apart as well.
    #[inline(always)]
    fn of(mut rows: Rows<S>) -> (Self, S::Pack) {
        let (mut corner, mut pivots, mut inverses) = (Self::unit(), S::Pack::one(), S::Pack::one());
        for i in (0..Panel::<S>::LANES).rev() {
            let (own, pivot) = (rows[i], rows[i].lane(i));
            let inverse = pivot.recip();
            pivots = pivots.with_lane(i, pivot);
            inverses = inverses.with_lane(i, inverse);
            let inverse = S::Pack::splat(inverse);
            corner.l[i] = own * inverse;
            for (r, row) in rows.iter_mut().enumerate().take(i) {
                // The inverse comes last: products do not wait for it.
                *row = inverse.mul_add(-(S::Pack::splat(own.lane(r)) * own), *row);
            }
        }
        corner.roots = inverses.sqrt();
        (corner, pivots)
    }

    /// `L'^-1 X`, each row times its lane of `scale`.
    #[inline(always)]
    fn solve(&self, mut x: Rows<S>, scale: S::Pack) -> Rows<S> {
        for i in (1..Panel::<S>::LANES).rev() {
            for r in 0..i {
                x[r] = S::Pack::splat(-self.l[i].lane(r)).mul_add(x[i], x[r]);
            }
        }
        for (r, x) in x.iter_mut().enumerate().take(Panel::<S>::LANES) {
            *x *= S::Pack::splat(scale.lane(r));
        }
        x
    }
}

impl<S: Scalar> Factor<S> {
    /// Rows of this block.
    fn rows(&self, block: usize) -> Range<usize> {
        let first = block * Panel::<S>::LANES;
        first..(first + Panel::<S>::LANES).min(self.pivots.len())
    }

    /// Number of blocks of rows.
    fn blocks(&self) -> usize {
        self.corners.len()
    }

    /// `row_i = M_i - sum_k N_ki N_k` over k > i and `N_i = row_i / sqrt(D_i)`, block by block from the last.
    #[inline(never)]
    pub(super) fn eliminate_blocks(&mut self, tiles: &FactorTiles, mass_matrix: &Matrix<S>) {
        self.read_lower(mass_matrix);
        self.inverted = false;
        for block in (0..self.blocks()).rev() {
            let (rows, n) = (self.rows(block), self.l.entries_mut());
            n.subtract_own_square(&tiles.eliminate, block);
            // Rows that are cut off are those of the unit matrix.
            let (corner, pivots) = Corner::<S>::of(n.block::<0>(block, block));
            pivots.write(&mut self.pivots[rows]);
            self.corners[block] = corner;
            for &pack in tiles.lower.of(block) {
                let x = corner.solve(n.block::<0>(block, pack), corner.roots);
                n.set_block::<0>(block, pack, &x);
            }
        }
    }

    /// Takes the entries of the registers that hold some on or below the diagonal.
    #[inline(always)]
    fn read_lower(&mut self, mass_matrix: &Matrix<S>) {
        let (n, register) = (mass_matrix.rows(), Panel::<S>::LANES * <S::Pack as Pack<S>>::WIDTH);
        for i in 0..n {
            let columns = (i + 1).next_multiple_of(register).min(n);
            self.l.entries_mut().read_row::<0>(i, &mass_matrix.row(i)[..columns]);
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

    /// `x <- M^-1 x`, length n.
    #[inline(never)]
    pub(super) fn solve_by_blocks(&self, tiles: &FactorTiles, x: &mut [S]) {
        let (lanes, n) = (Panel::<S>::LANES, self.l.entries());
        for block in (0..self.blocks()).rev() {
            let (rows, corner) = (self.rows(block), &self.corners[block]);
            let own = &mut x[rows.clone()];
            for i in (1..own.len()).rev() {
                for r in 0..i {
                    own[r] = (-corner.l[i].lane(r)).mul_add(own[i], own[r]);
                }
            }
            // Numbers, not packs of them: those would be stored lane by lane.
            let mut from = [S::zero(); MOST_LANES];
            for (r, (x, from)) in own.iter_mut().zip(&mut from).enumerate() {
                *x *= corner.roots.lane(r);
                *from = -*x;
            }
            let (_, others) = tiles.lower.of(block).split_last().unwrap_or((&0, &[]));
            for &pack in others {
                let target = &mut x[pack * lanes..][..lanes];
                let mut sum = S::Pack::read(target);
                for (row, &from) in rows.clone().zip(&from) {
                    sum = S::Pack::splat(from).mul_add(n.row(row)[pack], sum);
                }
                sum.write(target);
            }
        }
        for block in 0..self.blocks() {
            let (rows, corner) = (self.rows(block), &self.corners[block]);
            let mut sums = [S::Pack::zero(); MOST_LANES];
            let (_, others) = tiles.lower.of(block).split_last().unwrap_or((&0, &[]));
            for &pack in others {
                let from = S::Pack::read(&x[pack * lanes..][..lanes]);
                for (row, sum) in rows.clone().zip(&mut sums) {
                    *sum = n.row(row)[pack].mul_add(from, *sum);
                }
            }
            S::Pack::transpose(&mut sums[..lanes]);
            let sum = sums[..lanes].iter().fold(S::Pack::zero(), |sum, &part| sum + part);
            let own = (S::Pack::read(&x[rows.clone()]) - sum) * corner.roots;
            let mut solved = [S::zero(); MOST_LANES];
            for r in 0..rows.len() {
                solved[r] = own.lane(r);
                for c in 0..r {
                    solved[r] = (-corner.l[r].lane(c)).mul_add(solved[c], solved[r]);
                }
            }
            S::Pack::read(&solved[..lanes]).write(&mut x[rows]);
        }
    }

    /// `Y <- N^-1 N'^-1 Y` for a panel with n rows, row by row.
    pub(super) fn solve_panel_by_blocks(&self, y: &mut Panel<S>) {
        let (n, width, lanes) = (y.rows(), y.width::<0>(), Panel::<S>::LANES);
        let scale = |i: usize, row: &mut [S::Pack]| {
            let root = S::Pack::splat(self.corners[i / lanes].roots.lane(i % lanes));
            row.iter_mut().for_each(|y| *y *= root);
        };
        for i in (0..n).rev() {
            let (_, row, after) = y.split_at_row::<0>(i);
            self.l.minus_columns::<0, 0>(i, row, after, width);
            scale(i, row);
        }
        for i in 0..n {
            let (before, row, _) = y.split_at_row::<0>(i);
            self.l.minus_rows(i, row, before, width);
            scale(i, row);
        }
    }

    /// `x <- R R' x`, length n, with R' at hand: no row waits for another one, as in a substitution.
    #[inline(never)]
    pub(super) fn multiply_by_blocks(&self, tiles: &FactorTiles, x: &mut [S]) {
        let (lanes, u) = (Panel::<S>::LANES, &self.upper);
        for block in 0..self.blocks() {
            let (rows, along) = (self.rows(block), u.rows_of(block));
            let mut sums = [S::Pack::zero(); MOST_LANES];
            for &pack in tiles.upper.of(block) {
                let from = S::Pack::read(lanes_of(x, pack * lanes, lanes));
                for (r, sum) in sums.iter_mut().enumerate().take(lanes) {
                    *sum = along[r][pack].mul_add(from, *sum);
                }
            }
            S::Pack::transpose(&mut sums[..lanes]);
            let sum = sums[..lanes].iter().fold(S::Pack::zero(), |sum, &part| sum + part);
            sum.write(&mut x[rows]);
        }
        // From the last pack on: others need the entries before it alone.
        for pack in (0..self.blocks()).rev() {
            let mut sums = [S::Pack::zero(); 2];
            for &block in tiles.upper_across.of(pack) {
                let (from, along) = (S::Pack::read(lanes_of(x, block * lanes, lanes)), u.rows_of(block));
                for r in 0..lanes {
                    sums[r % 2] = S::Pack::splat(from.lane(r)).mul_add(along[r][pack], sums[r % 2]);
                }
            }
            (sums[0] + sums[1]).write(&mut x[self.rows(pack)]);
        }
    }
}

/// So many numbers from one on, or as many as there are.
#[inline(always)]
fn lanes_of<S>(x: &[S], at: usize, lanes: usize) -> &[S] {
    x.get(at..at + lanes).unwrap_or_else(|| &x[at..])
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
