//! Products with M^-1 from its factors block by block.

use super::Factor;
use super::factor_tiles::FactorTiles;
use crate::matrix::Panel;
use crate::scalar::{MOST_LANES, Pack, Scalar};

impl<S: Scalar> Factor<S> {
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
