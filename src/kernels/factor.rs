//! Branch-sparse factorisation of the mass matrix, `M = L' D L`.

use super::corner::Corner;
use super::factor_tiles::FactorTiles;
use super::triangle::Triangle;
use crate::matrix::{Matrix, Panel, Pattern, filled, sized};
use crate::robot::Tree;
use crate::scalar::{Pack, Scalar};

/// `M = L' D L` with unit lower triangular L, no pivoting (Featherstone's branch-induced sparsity).
///
/// Row k of L has entries only at the ancestors of joint k; where armature or mimic joints couple different
/// branches, the pattern is closed under elimination. Pivot D_k is the articulated inertia of joint k.
///
/// Beyond 12 joints packs of several lanes compute `N = D^1/2 L` block by block instead of L, `M = N' N`.
#[derive(Clone, Debug)]
pub struct Factor<S: Scalar> {
    /// L, or `N = D^1/2 L` if it is computed block by block.
    pub(super) l: Triangle<S>,
    pub(super) inverse_pivots: Vec<S>,
    pub(super) pivots: Vec<S>,
    sizes: Vec<S>,
    /// Whether U' has been computed.
    pub(super) inverted: bool,
    /// `D L`, then U', unless they are computed block by block.
    pub(super) work: Panel<S>,
    /// `R' = D^-1/2 U'`, if it is computed block by block.
    pub(super) upper: Panel<S>,
    /// Diagonal blocks, likewise.
    pub(super) corners: Vec<Corner<S>>,
    pub(super) tiles: Option<Box<FactorTiles>>,
    /// `M^-1`.
    pub(super) product: Panel<S>,
}

impl<S: Scalar> Factor<S> {
    /// Symbolic factorisation and buffers.
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let (n, l) = (tree.dof(), Triangle::new(tree));
        let (work, upper) = if Panel::<S>::in_blocks(n) { (0, n) } else { (n, 0) };
        Self {
            tiles: Panel::<S>::for_blocks(n, || FactorTiles::new(&l)),
            upper: Panel::zeros(upper, upper),
            corners: filled(Corner::unit(), upper.div_ceil(Panel::<S>::LANES)),
            l,
            inverse_pivots: filled(S::one(), n),
            pivots: filled(S::zero(), n),
            sizes: filled(S::zero(), n),
            inverted: false,
            work: Panel::zeros(work, work),
            product: Panel::zeros(n, n),
        }
    }

    /// `1 / D_k`, n.
    pub(super) fn inverse_pivots(&self) -> &[S] {
        &self.inverse_pivots
    }

    /// Factors the n x n matrix; `size_of(k)` is the scale of the rounding error of entry (k, k).
    ///
    /// # Errors
    /// The index of a joint whose pivot is not above its rounding error: M is singular in working precision.
    /// The factorisation is completed nevertheless.
    pub fn factor(&mut self, mass_matrix: &Matrix<S>, size_of: impl Fn(usize) -> S) -> Result<(), usize> {
        self.decompose(mass_matrix);
        if S::CHECKED { self.check_pivots(size_of) } else { Ok(()) }
    }

    /// The same for a panel, where factors are computed block by block.
    pub(crate) fn factor_panel(
        &mut self,
        mass_matrix: &Panel<S>,
        size_of: impl Fn(usize) -> S,
    ) -> Result<(), usize> {
        if let Some(tiles) = self.tiles.take().filter(|_| !Panel::<S>::ONE_LANE) {
            self.eliminate_panel(&tiles, mass_matrix);
            self.tiles = Some(tiles);
        }
        if S::CHECKED { self.check_pivots(size_of) } else { Ok(()) }
    }

    /// L and D.
    #[inline(never)]
    fn decompose(&mut self, mass_matrix: &Matrix<S>) {
        if Panel::<S>::ONE_LANE {
            self.eliminate::<0, 0>(mass_matrix);
        } else if let Some(tiles) = self.tiles.take() {
            self.eliminate_blocks(&tiles, mass_matrix);
            self.tiles = Some(tiles);
        } else {
            sized!(S, self.work.columns(), self.eliminate(mass_matrix));
        }
    }

    /// Row by row from the last, `row_i = M_i - sum_k L_ki row_k` over k > i and `L_i = row_i / D_i`, D_i its
    /// last entry.
    fn eliminate<const N: usize, const W: usize>(&mut self, mass_matrix: &Matrix<S>) {
        self.work.has_size::<N, W>();
        self.l.entries().has_size::<N, W>();
        self.work.read::<N>(mass_matrix);
        self.inverted = false;
        let (n, width) = (if N > 0 { N } else { self.work.rows() }, self.work.width::<W>());
        for i in (0..n).rev() {
            let (_, row, below) = self.work.split_at_row::<W>(i);
            let row = &mut row[..Panel::<S>::width_up_to::<W>(i + 1)];
            self.l.minus_columns::<N, W>(i, row, below, width);
            let inverse = self.work.entry::<W>(i, i).recip();
            self.inverse_pivots[i] = inverse;
            // With one lane, only the entries left of the diagonal.
            let end = if Panel::<S>::ONE_LANE { i } else { width };
            let row = &self.work.sized_row::<W>(i)[..end];
            let (_, l, _) = self.l.entries_mut().split_at_row::<W>(i);
            let scale = S::Pack::splat(inverse);
            for (l, &entry) in l.iter_mut().zip(row) {
                *l = entry * scale;
            }
        }
    }

    /// Compares each pivot with its possible rounding error.
    ///
    /// `D_i = w' M w` for the motion w of joint i with the joints beyond it free: column i of `U = L^-1`. An
    /// error of `eps size_k` in each `M_kk` therefore moves D_i by `eps sum_k U_ki^2 size_k`; 128 times this
    /// must be below D_i. U is computed only if some pivot is below a thousandth of its scale: otherwise
    /// there is no cancellation.
    fn check_pivots(&mut self, size_of: impl Fn(usize) -> S) -> Result<(), usize> {
        let mut settled = true;
        let blocks = self.tiles.is_some();
        for (k, (pivot, size)) in self.pivots.iter_mut().zip(&mut self.sizes).enumerate() {
            if !blocks {
                *pivot = self.work.get(k, k);
            }
            *size = size_of(k);
            settled &= S::all(size.times(1e-3).less(*pivot));
        }
        if settled {
            return Ok(());
        }
        // A pivot that is not positive makes all that follow meaningless.
        let positive = |pivot: &S| S::all(S::zero().less(*pivot));
        if let Some(i) = self.pivots.iter().rposition(|pivot| !positive(pivot)) {
            return Err(i);
        }
        self.invert();
        let u = if blocks { &self.upper } else { &self.work };
        let unit = 128.0 * S::EPSILON;
        for i in (0..self.pivots.len()).rev() {
            let first = i / Panel::<S>::LANES;
            let sizes = self.sizes.chunks(Panel::<S>::LANES).skip(first).map(S::Pack::read);
            let moved = u.row(i)[first..].iter().zip(sizes);
            let moved = moved.fold(S::Pack::zero(), |sum, (&u, size)| (u * u).mul_add(size, sum));
            let moved = (0..Panel::<S>::LANES).fold(S::zero(), |sum, lane| sum + moved.lane(lane));
            // Squares of rows of `D^-1/2 U'` are divided by the pivot.
            let most = if blocks { S::one() } else { self.pivots[i] };
            if !S::all(moved.times(unit).less(most)) {
                return Err(i);
            }
        }
        Ok(())
    }

    /// `x <- M^-1 x`, length n.
    #[inline(never)]
    pub fn solve(&self, x: &mut [S]) {
        if Panel::<S>::ONE_LANE {
            self.solve_vector::<0, 0>(x);
        } else if let Some(tiles) = &self.tiles {
            if self.inverted { self.multiply_by_blocks(tiles, x) } else { self.solve_by_blocks(tiles, x) }
        } else {
            sized!(S, x.len(), self.solve_vector(x));
        }
    }

    fn solve_vector<const N: usize, const W: usize>(&self, x: &mut [S]) {
        let n = if N > 0 { N } else { x.len() };
        let (x, l) = (&mut x[..n], self.l.entries());
        for k in (0..n).rev() {
            let from = -x[k];
            let mut subtract = |i: usize| x[i] = l.entry::<W>(k, i).mul_add(from, x[i]);
            if self.l.is_full() {
                (0..k).rev().for_each(subtract);
            } else {
                self.l.row_pattern(k).iter().rev().for_each(|&i| subtract(i));
            }
        }
        x.iter_mut().zip(&self.inverse_pivots).for_each(|(x, &inverse)| *x *= inverse);
        // Column by column, which shortens the chain of dependent sums.
        for i in 0..n {
            let from = -x[i];
            let mut subtract = |k: usize| x[k] = l.entry::<W>(k, i).mul_add(from, x[k]);
            if self.l.is_full() {
                (i + 1..n).for_each(subtract);
            } else {
                self.l.column_pattern(i).iter().for_each(|&k| subtract(k));
            }
        }
    }

    /// `Y <- L'^-1 Y` for a panel with n rows: the first half of a solve, unless factors are computed
    /// block by block.
    pub(crate) fn first_half(&self, y: &mut Panel<S>) {
        let width = y.width::<0>();
        for i in (0..y.rows()).rev() {
            let (_, target, after) = y.split_at_row::<0>(i);
            self.l.minus_columns::<0, 0>(i, target, after, width);
        }
    }

    /// Number of rows.
    pub(crate) fn size(&self) -> usize {
        self.pivots.len()
    }

    /// Positions of the entries of L below the diagonal.
    pub(crate) fn pattern(&self) -> Pattern {
        self.l.pattern()
    }

    /// Positions of the entries of `U = L^-1`.
    pub(crate) fn inverse_pattern(&self) -> Pattern {
        self.l.inverse_pattern()
    }

    /// `Y <- D^-1 Y`.
    pub(crate) fn divide_by_pivots(&self, y: &mut Panel<S>) {
        for (k, &inverse) in self.inverse_pivots.iter().enumerate() {
            let inverse = S::Pack::splat(inverse);
            y.row_mut(k).iter_mut().for_each(|y| *y *= inverse);
        }
    }

    /// `Y <- L^-1 Y`: the second half of a solve.
    pub(crate) fn second_half(&self, y: &mut Panel<S>) {
        let width = y.width::<0>();
        for k in 0..y.rows() {
            let (before, target, _) = y.split_at_row::<0>(k);
            self.l.minus_rows(k, target, before, width);
        }
    }

    /// `Y <- M^-1 Y` for a panel with n rows.
    #[inline(never)]
    pub(crate) fn solve_panel(&self, y: &mut Panel<S>) {
        if self.tiles.is_some() {
            return self.solve_panel_by_blocks(y);
        }
        self.first_half(y);
        self.divide_by_pivots(y);
        self.second_half(y);
    }
}
