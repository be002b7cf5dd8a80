//! Products of matrices whose rows are whole packs.

use super::Panel;
use super::rows::add_rows;
use crate::scalar::{Pack, Scalar};

/// Which entries of a product are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// All.
    Whole,
    /// The entries on and below the diagonal; the others are undefined.
    Lower,
}

/// The left factor A of a product, `A_ik` for row i of the result.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Left<'a, S: Scalar> {
    /// The panel itself.
    Rows(&'a Panel<S>),
    /// Its transpose.
    Columns(&'a Panel<S>),
}

/// Rows of a tile, such that the sums of all its columns fit into registers.
const ROWS: usize = if cfg!(target_feature = "avx") { 4 } else { 2 };

/// Maximum number of packs per row of a tile.
const COLUMNS: usize = 3;

/// First row and pack of a tile.
type Corner = (usize, usize);

/// Which tiles a row of W packs consists of, 0 if W is not known: up to three packs are one tile.
struct Tiles<const W: usize>;

impl<const W: usize> Tiles<W> {
    /// Whether tiles of one pack, of two and of [`COLUMNS`] occur: the others are not compiled.
    const ONE: bool = W == 0 || W == 1 || W > COLUMNS;
    const TWO: bool = W == 0 || W == 2 || W > COLUMNS;
    const ALL: bool = W == 0 || W >= COLUMNS;
}

impl<S: Scalar> Panel<S> {
    /// `A x`, for x with an entry for each column.
    #[inline(never)]
    pub fn times(&self, x: &[S], product: &mut [S]) {
        for (i, product) in product.iter_mut().enumerate() {
            let terms = self.row(i).iter().zip(x.chunks(Self::LANES).map(S::Pack::read));
            let sum = terms.fold(S::Pack::zero(), |sum, (&a, x)| a.mul_add(x, sum));
            *product = (1..Self::LANES).fold(sum.lane(0), |total, lane| total + sum.lane(lane));
        }
    }

    /// `T = A B` for the rows T of this panel. W: packs in a row where known, N: rows of all three, else 0.
    ///
    /// Packs of several lanes are computed tile by tile: the sums of a tile stay in registers during the loop
    /// over the rows of B, and tiles are independent.
    #[inline(always)]
    pub fn set_product<const N: usize, const W: usize>(&mut self, a: Left<'_, S>, b: &Self, part: Part) {
        match a {
            Left::Rows(a) => self.product::<N, W, false, false>(a, b, part),
            Left::Columns(a) => self.product::<N, W, true, false>(a, b, part),
        }
    }

    /// `T -= A B` likewise.
    #[inline(always)]
    pub fn subtract_product<const N: usize, const W: usize>(&mut self, a: Left<'_, S>, b: &Self, part: Part) {
        match a {
            Left::Rows(a) => self.product::<N, W, false, true>(a, b, part),
            Left::Columns(a) => self.product::<N, W, true, true>(a, b, part),
        }
    }

    /// The product with A or its transpose, set or subtracted: one function for all products of a size.
    #[inline(never)]
    fn product<const N: usize, const W: usize, const ACROSS: bool, const MINUS: bool>(
        &mut self,
        a: &Self,
        b: &Self,
        part: Part,
    ) {
        [&*self, a, b].into_iter().for_each(Self::has_size::<N, W>);
        let (rows, terms) = if N > 0 { (N, N) } else { (self.rows(), b.rows()) };
        if Self::ONE_LANE {
            for i in 0..rows {
                let end = if part == Part::Lower { i + 1 } else { self.columns() };
                let entry = |k: usize| if ACROSS { a.splat::<W>(k, i) } else { a.splat::<W>(i, k) };
                let target = &mut self.row_mut(i)[..end];
                if !MINUS {
                    target.fill(S::Pack::zero());
                }
                let terms = (0..terms).map(|k| (k, if MINUS { -entry(k) } else { entry(k) }));
                add_rows(target, b.packs(), b.width::<0>(), terms);
            }
            return;
        }
        let mut top = 0;
        while top + ROWS <= rows {
            self.band::<N, W, ROWS, ACROSS, MINUS>(a, b, top, part);
            top += ROWS;
        }
        if ROWS > 2 && top + 2 <= rows {
            self.band::<N, W, 2, ACROSS, MINUS>(a, b, top, part);
            top += 2;
        }
        if top < rows {
            self.band::<N, W, 1, ACROSS, MINUS>(a, b, top, part);
        }
    }

    /// R rows of a product from `top`.
    #[inline(always)]
    fn band<const N: usize, const W: usize, const R: usize, const ACROSS: bool, const MINUS: bool>(
        &mut self,
        a: &Self,
        b: &Self,
        top: usize,
        part: Part,
    ) {
        let end = if part == Part::Lower { Self::width_up_to::<W>(top + R) } else { self.width::<W>() };
        let mut left = 0;
        while Tiles::<W>::ALL && left + COLUMNS <= end {
            self.tile::<N, W, R, COLUMNS, ACROSS, MINUS>(a, b, (top, left));
            left += COLUMNS;
        }
        if Tiles::<W>::TWO && left + 2 <= end {
            self.tile::<N, W, R, 2, ACROSS, MINUS>(a, b, (top, left));
            left += 2;
        }
        if Tiles::<W>::ONE && left < end {
            self.tile::<N, W, R, 1, ACROSS, MINUS>(a, b, (top, left));
        }
    }

    /// R rows and C packs of a product.
    #[inline(always)]
    fn tile<
        const N: usize,
        const W: usize,
        const R: usize,
        const C: usize,
        const ACROSS: bool,
        const MINUS: bool,
    >(
        &mut self,
        a: &Self,
        b: &Self,
        (top, left): Corner,
    ) {
        let (stride, from, terms) = (a.width::<W>(), b.width::<W>(), if N > 0 { N } else { b.rows() });
        let mut sums = [[S::Pack::zero(); C]; R];
        let place = |r: usize, width: usize| (top + r) * width + left;
        if MINUS {
            for (r, sums) in sums.iter_mut().enumerate() {
                sums.copy_from_slice(&self.packs()[place(r, self.width::<W>())..][..C]);
            }
        }
        let b = &b.packs()[..terms * from];
        for block in 0..terms.div_ceil(Self::LANES) {
            // Entries of A for these rows of B: packs of its rows, or one pack across for each row of B.
            let mut along = [&a.packs()[0]; R];
            if !ACROSS {
                for (r, along) in along.iter_mut().enumerate() {
                    *along = &a.packs()[(top + r) * stride + block];
                }
            }
            for k in block * Self::LANES..terms.min((block + 1) * Self::LANES) {
                let (lane, row) = (k % Self::LANES, &b[k * from + left..][..C]);
                let across = &a.packs()[if ACROSS { k * stride + top / Self::LANES } else { 0 }];
                for (r, sums) in sums.iter_mut().enumerate() {
                    let entry = if ACROSS { across.lane(top % Self::LANES + r) } else { along[r].lane(lane) };
                    let entry = S::Pack::splat(if MINUS { -entry } else { entry });
                    for (sum, &b) in sums.iter_mut().zip(row) {
                        *sum = entry.mul_add(b, *sum);
                    }
                }
            }
        }
        let width = self.width::<W>();
        for (r, sums) in sums.iter().enumerate() {
            self.packs_mut()[place(r, width)..][..C].copy_from_slice(sums);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries without a common factor.
    fn panel(n: usize, from: f64) -> Panel<f64> {
        let mut panel = Panel::zeros(n, n);
        (0..n).for_each(|i| {
            (0..n).for_each(|j| panel.set(i, j, (from + 1.3 * i as f64 + 0.7 * j as f64).sin()))
        });
        panel
    }

    /// Both products, of both kinds, entry by entry.
    fn check<const N: usize, const W: usize>(n: usize) {
        let (a, b, at) = (panel(n, 0.2), panel(n, 1.1), panel(n, 2.3));
        for (left, across) in [(Left::Rows(&a), false), (Left::Columns(&a), true)] {
            let sum = |i: usize, j: usize| -> f64 {
                (0..n).map(|k| if across { a.get(k, i) } else { a.get(i, k) } * b.get(k, j)).sum()
            };
            for part in [Part::Whole, Part::Lower] {
                let (mut set, mut less) = (panel(n, 3.1), at.clone());
                set.set_product::<N, W>(left, &b, part);
                less.subtract_product::<N, W>(left, &b, part);
                for i in 0..n {
                    for j in 0..if part == Part::Lower { i + 1 } else { n } {
                        assert!((set.get(i, j) - sum(i, j)).abs() < 1e-14, "n = {n}, {part:?}, {across}");
                        assert!(
                            (less.get(i, j) - at.get(i, j) + sum(i, j)).abs() < 1e-14,
                            "n = {n}, {part:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn products_of_panels_are_those_of_matrices() {
        for n in 1..=29 {
            check::<0, 0>(n);
        }
    }

    #[cfg(feature = "wide")]
    #[test]
    fn a_size_that_is_known_changes_no_product() {
        check::<6, 2>(6);
        check::<7, 2>(7);
        check::<12, 3>(12);
        (1..=4).for_each(check::<0, 1>);
        (5..=8).for_each(check::<0, 2>);
        (9..=12).for_each(check::<0, 3>);
    }
}
