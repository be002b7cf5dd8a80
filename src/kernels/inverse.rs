//! The inverses of the mass matrix and of its triangular factor.

use super::Factor;
use crate::matrix::{Matrix, Panel, Place, add_scaled, sized, sum_rows};
use crate::scalar::{Pack, Scalar};

impl<S: Scalar> Factor<S> {
    /// U', for the check of the pivots and for products with it; `D^-1/2 U'`, if it is computed block by
    /// block.
    pub(crate) fn invert(&mut self) {
        if self.inverted {
            return;
        }
        if Panel::<S>::ONE_LANE {
            self.invert_transposed::<0, 0>();
        } else if let Some(tiles) = self.tiles.take() {
            self.invert_blocks(&tiles);
            self.tiles = Some(tiles);
        } else {
            self.invert_transposed::<0, 0>();
        }
        self.inverted = true;
    }

    /// `U' = L'^-1` into the work matrix, n x n.
    #[inline(always)]
    fn invert_transposed<const N: usize, const W: usize>(&mut self) {
        self.work.has_size::<N, W>();
        self.l.entries().has_size::<N, W>();
        let width = self.work.width::<W>();
        let n = if N > 0 { N } else { self.work.rows() };
        for i in (0..n).rev() {
            self.work.set_unit_row::<W>(i);
            let (_, row, below) = self.work.split_at_row::<W>(i);
            if !Panel::<S>::ONE_LANE {
                // Packs left of the diagonal are zero.
                let start = if W > 0 { 0 } else { i / Panel::<S>::LANES };
                let below = below.get(start..).unwrap_or_default();
                self.l.minus_columns::<N, W>(i, &mut row[start..], below, width);
            } else {
                // One lane: no products with the zeros left of the diagonal.
                for (k, factor) in self.l.column_terms(i) {
                    let source = &below[(k - i - 1) * width + k..];
                    add_scaled(&mut row[k..], S::Pack::splat(factor), source);
                }
            }
        }
    }

    /// Writes M^-1 to a matrix from this row and column on, where it is computed block by block.
    pub(crate) fn place_inverse(&mut self, to: &mut Matrix<S>, at: (usize, usize)) {
        self.inverse_by_blocks();
        self.place_formed_inverse(to, at);
    }

    /// The same, after [`inverse_by_blocks`](Self::inverse_by_blocks).
    pub(crate) fn place_formed_inverse(&mut self, to: &mut Matrix<S>, at: (usize, usize)) {
        if let Some(tiles) = self.tiles.as_ref().filter(|_| !Panel::<S>::ONE_LANE) {
            to.place_panel(Place::symmetric(at, false), &tiles.inverse, &mut self.product);
        }
    }

    /// M^-1 on and below the diagonal as a panel, if it is computed block by block.
    pub(crate) fn inverse_by_blocks(&mut self) -> &Panel<S> {
        if let Some(tiles) = self.tiles.take().filter(|_| !Panel::<S>::ONE_LANE) {
            self.form_inverse_by_blocks(&tiles);
            self.tiles = Some(tiles);
        }
        &self.product
    }

    /// `R' = D^-1/2 U'`, after [`invert`](Self::invert), if it is computed block by block: `M^-1 = R R'`.
    pub(crate) fn root(&self) -> &Panel<S> {
        &self.upper
    }

    /// `M^-1 = U D^-1 U'` with `U = L^-1`, n x n, exactly symmetric.
    #[inline(never)]
    pub fn inverse(&mut self, inverse: &mut Matrix<S>) {
        if !Panel::<S>::ONE_LANE && self.tiles.is_some() {
            // The tiles leave out what is zero.
            inverse.fill_zero();
            return self.place_inverse(inverse, (0, 0));
        }
        let mut product = std::mem::replace(&mut self.product, Panel::zeros(0, 0));
        sized!(S, product.columns(), self.form_inverse(&mut product));
        product.write(inverse);
        self.product = product;
    }

    /// The same as a panel, unless it is computed block by block.
    #[inline(never)]
    pub(crate) fn form_inverse<const N: usize, const W: usize>(&mut self, inverse: &mut Panel<S>) {
        debug_assert!(self.tiles.is_none());
        if !self.inverted {
            self.invert_transposed::<N, W>();
        }
        self.work.has_size::<N, W>();
        inverse.has_size::<N, W>();
        let n = if N > 0 { N } else { inverse.rows() };
        let pivots = &self.inverse_pivots[..n];
        for i in 0..n {
            let (_, row, _) = inverse.split_at_row::<W>(i);
            for pack in row.iter_mut() {
                *pack = S::Pack::zero();
            }
            let column = (0..=i).map(|k| (k, self.work.entry::<W>(k, i) * pivots[k]));
            if !Panel::<S>::ONE_LANE {
                let width = self.work.width::<W>();
                let terms = column.map(|(k, a)| (k, S::Pack::splat(a)));
                let row = &mut row[..Panel::<S>::width_up_to::<W>(i + 1)];
                sum_rows::<W, S::Pack>(row, self.work.packs(), width, terms);
            } else {
                for (k, a) in column {
                    add_scaled(&mut row[k..=i], S::Pack::splat(a), &self.work.row(k)[k..]);
                }
            }
        }
        inverse.mirror_lower::<W>();
    }
}
