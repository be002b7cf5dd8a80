//! The factors of the mass matrix block by block: as many rows at once as a pack has lanes.

use super::Factor;
use super::factor_tiles::FactorTiles;
use crate::matrix::{Left, Matrix, Panel};
use crate::scalar::{MOST_LANES, Pack, Scalar};
use std::ops::Range;

/// Entries below the diagonal of a diagonal block of L, zero elsewhere.
type Corner<S> = [[S; MOST_LANES]; MOST_LANES];

/// `x_r -= sum_i L_ir x_i`, i > r, for the rows x of a block.
#[inline(always)]
fn solve_corner<S: Scalar, P: Pack<S>>(l: &Corner<S>, x: &mut [P; MOST_LANES]) {
    for i in (1..P::LANES).rev() {
        for r in 0..i {
            x[r] = P::splat(-l[i][r]).mul_add(x[i], x[r]);
        }
    }
}

impl<S: Scalar> Factor<S> {
    /// Rows of this block.
    fn rows(&self, block: usize) -> Range<usize> {
        let first = block * Panel::<S>::LANES;
        first..(first + Panel::<S>::LANES).min(self.inverse_pivots.len())
    }

    /// Number of blocks of rows.
    fn blocks(&self) -> usize {
        self.work.columns().div_ceil(Panel::<S>::LANES)
    }

    /// `row_i = M_i - sum_k L_ki row_k` over k > i and `L_i = row_i / D_i`, block by block from the last.
    #[inline(never)]
    pub(super) fn eliminate_blocks(&mut self, tiles: &FactorTiles, mass_matrix: &Matrix<S>) {
        self.read_lower(mass_matrix);
        self.inverted = false;
        for block in (0..self.blocks()).rev() {
            self.work.subtract_own_rows(&tiles.eliminate, block, self.l.entries());
            let (l, inverses) = self.eliminate_corner(block);
            for &pack in tiles.lower.of(block) {
                let mut x = self.work.block::<0>(block, pack);
                solve_corner(&l, &mut x);
                self.work.set_block::<0>(block, pack, &x);
                x.iter_mut().zip(&inverses).for_each(|(x, &inverse)| *x *= S::Pack::splat(inverse));
                self.l.entries_mut().set_block::<0>(block, pack, &x);
            }
        }
    }

    /// Takes the entries of the registers that hold some on or below the diagonal.
    #[inline(always)]
    fn read_lower(&mut self, mass_matrix: &Matrix<S>) {
        let (n, register) = (mass_matrix.rows(), Panel::<S>::LANES * <S::Pack as Pack<S>>::WIDTH);
        for i in 0..n {
            let columns = (i + 1).next_multiple_of(register).min(n);
            self.work.read_row::<0>(i, &mass_matrix.row(i)[..columns]);
        }
    }

    /// Sets the pivots of a block of rows: the entries of L below the diagonal of its diagonal block, and the
    /// inverses of the pivots.
    #[inline(always)]
    fn eliminate_corner(&mut self, block: usize) -> (Corner<S>, [S; MOST_LANES]) {
        // Loops of a length that is known; rows that are cut off are those of the unit matrix.
        let (lanes, rows) = (Panel::<S>::LANES, self.rows(block));
        let mut l = [[S::zero(); MOST_LANES]; MOST_LANES];
        let mut d = l;
        for (r, d) in d.iter_mut().enumerate().take(lanes) {
            if r < rows.len() {
                (0..=r).for_each(|c| d[c] = self.work.get(rows.start + r, rows.start + c));
            } else {
                d[r] = S::one();
            }
        }
        let mut inverses = [S::one(); MOST_LANES];
        for i in (0..lanes).rev() {
            let inverse = d[i][i].recip();
            inverses[i] = inverse;
            for r in 0..i {
                l[i][r] = d[i][r] * inverse;
            }
            let (above, own) = d.split_at_mut(i);
            for (r, row) in above.iter_mut().enumerate() {
                for (entry, own) in row[..=r].iter_mut().zip(own[0]) {
                    *entry = (-l[i][r]).mul_add(own, *entry);
                }
            }
        }
        S::Pack::read(&inverses[..lanes]).write(&mut self.inverse_pivots[rows]);
        (l, inverses)
    }

    /// Entries of L below the diagonal of this diagonal block.
    #[inline(always)]
    fn corner(&self, block: usize) -> Corner<S> {
        let rows = self.rows(block);
        let mut l = [[S::zero(); MOST_LANES]; MOST_LANES];
        for (r, row) in rows.clone().enumerate() {
            for (c, l) in l[r].iter_mut().enumerate().take(r) {
                *l = self.l.entries().get(row, rows.start + c);
            }
        }
        l
    }

    /// `R' = D^-1/2 U'` from `U' = L'^-1`, block by block from the last.
    #[inline(never)]
    pub(super) fn invert_blocks(&mut self, tiles: &FactorTiles) {
        for block in (0..self.blocks()).rev() {
            for &pack in tiles.upper.of(block) {
                let mut unit = [S::Pack::zero(); MOST_LANES];
                if pack == block {
                    for (r, unit) in unit.iter_mut().enumerate().take(Panel::<S>::LANES) {
                        *unit = unit.with_lane(r, S::one());
                    }
                }
                self.upper.set_block::<0>(block, pack, &unit);
            }
            self.upper.subtract_own_rows(&tiles.invert, block, self.l.entries());
            let l = self.corner(block);
            for &pack in tiles.upper.of(block) {
                let mut x = self.upper.block::<0>(block, pack);
                solve_corner(&l, &mut x);
                self.upper.set_block::<0>(block, pack, &x);
            }
        }
        // Rows above a block are made of its rows of U'.
        for block in 0..self.blocks() {
            let roots = S::Pack::read(&self.inverse_pivots[self.rows(block)]).sqrt();
            for &pack in tiles.upper.of(block) {
                let mut x = self.upper.block::<0>(block, pack);
                for (r, x) in x.iter_mut().enumerate().take(Panel::<S>::LANES) {
                    *x *= S::Pack::splat(roots.lane(r));
                }
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
        let (lanes, l) = (Panel::<S>::LANES, self.l.entries());
        for block in (0..self.blocks()).rev() {
            let (rows, corner) = (self.rows(block), self.corner(block));
            let own = &mut x[rows.clone()];
            for i in (1..own.len()).rev() {
                for r in 0..i {
                    own[r] = (-corner[i][r]).mul_add(own[i], own[r]);
                }
            }
            // Numbers, not packs of them: those would be stored lane by lane.
            let mut from = [S::zero(); MOST_LANES];
            own.iter().zip(&mut from).for_each(|(&x, from)| *from = -x);
            let (_, others) = tiles.lower.of(block).split_last().unwrap_or((&0, &[]));
            for &pack in others {
                let target = &mut x[pack * lanes..][..lanes];
                let mut sum = S::Pack::read(target);
                for (row, &from) in rows.clone().zip(&from) {
                    sum = S::Pack::splat(from).mul_add(l.row(row)[pack], sum);
                }
                sum.write(target);
            }
        }
        for block in 0..self.blocks() {
            let (rows, corner) = (self.rows(block), self.corner(block));
            let mut sums = [S::Pack::zero(); MOST_LANES];
            let (_, others) = tiles.lower.of(block).split_last().unwrap_or((&0, &[]));
            for &pack in others {
                let from = S::Pack::read(&x[pack * lanes..][..lanes]);
                for (row, sum) in rows.clone().zip(&mut sums) {
                    *sum = l.row(row)[pack].mul_add(from, *sum);
                }
            }
            S::Pack::transpose(&mut sums[..lanes]);
            let sum = sums[..lanes].iter().fold(S::Pack::zero(), |sum, &part| sum + part);
            let pivots = S::Pack::read(&self.inverse_pivots[rows.clone()]);
            let own = S::Pack::read(&x[rows.clone()]).mul_add(pivots, -sum);
            let mut solved = [S::zero(); MOST_LANES];
            for r in 0..rows.len() {
                solved[r] = own.lane(r);
                for c in 0..r {
                    solved[r] = (-corner[r][c]).mul_add(solved[c], solved[r]);
                }
            }
            S::Pack::read(&solved[..lanes]).write(&mut x[rows]);
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
