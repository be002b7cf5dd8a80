//! Products that go to their places in a larger matrix, together with their transposes.

use super::tile::Update;
use super::{Left, Matrix, Panel, Tiles};
use crate::scalar::{MOST_LANES, Pack, Scalar};
use std::ops::Range;

/// Where an n x n product goes in a matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Row and column of its first entry.
    pub at: (usize, usize),
    /// The same for the transpose.
    pub across: (usize, usize),
    /// Whether the product, and the transpose, change their signs.
    pub minus: [bool; 2],
}

impl Place {
    /// Both triangles of a symmetric matrix, of which the tiles cover the lower one.
    pub fn symmetric(at: (usize, usize), minus: bool) -> Self {
        Self { at, across: at, minus: [minus; 2] }
    }
}

impl<S: Scalar> Matrix<S> {
    /// Sets a panel T to `A B`, or adds to it or subtracts from it, and writes each tile to its place as soon
    /// as it is there. Entries outside of the tiles are not touched.
    ///
    /// The matrix is larger than the nearest cache: its lines arrive while the next tile is computed.
    #[inline(never)]
    pub(crate) fn place_tiles(
        &mut self,
        place: Place,
        tiles: &Tiles,
        (a, b): (Left<'_, S>, &Panel<S>),
        (product, update): (&mut Panel<S>, Update<'_, S>),
    ) {
        match a {
            Left::Rows(a) => self.place_all::<false>(place, tiles, (a, b), (product, update)),
            Left::Columns(a) => self.place_all::<true>(place, tiles, (a, b), (product, update)),
        }
    }

    fn place_all<const ACROSS: bool>(
        &mut self,
        place: Place,
        tiles: &Tiles,
        (a, b): (&Panel<S>, &Panel<S>),
        (product, update): (&mut Panel<S>, Update<'_, S>),
    ) {
        product.tiles::<ACROSS>(tiles, a, b, update, |product, block, packs| match place.minus {
            [false, false] => self.place_packs::<false, false>(place, product, block, packs),
            [true, false] => self.place_packs::<true, false>(place, product, block, packs),
            [false, true] => self.place_packs::<false, true>(place, product, block, packs),
            [true, true] => self.place_packs::<true, true>(place, product, block, packs),
        });
    }

    /// Some packs of a block of rows.
    #[inline(never)]
    fn place_packs<const MINUS: bool, const ACROSS_MINUS: bool>(
        &mut self,
        place: Place,
        product: &Panel<S>,
        block: usize,
        packs: Range<usize>,
    ) {
        let (lanes, n) = (Panel::<S>::LANES, product.rows());
        let symmetric = place.at == place.across;
        let (top, stride) = (block * lanes, self.columns);
        let end = packs.end.min(if symmetric { block + 1 } else { n.div_ceil(lanes) });
        // Those that are not cut off, and not on the diagonal of a symmetric matrix.
        let whole = if top + lanes > n { 0 } else { end.min(if symmetric { block } else { n / lanes }) };
        let mut to = (place.at.0 + top) * stride + place.at.1 + packs.start * lanes;
        let mut across = (place.across.0 + packs.start * lanes) * stride + place.across.1 + top;
        for pack in packs.start..whole {
            let mut tile = product.block::<0>(block, pack);
            write_block::<S, MINUS>(&mut self.data[to..], stride, &tile);
            S::Pack::transpose(&mut tile[..lanes]);
            write_block::<S, ACROSS_MINUS>(&mut self.data[across..], stride, &tile);
            to += lanes;
            across += lanes * stride;
        }
        for pack in whole.max(packs.start)..end {
            self.place_at_edge(place, product, block, pack);
        }
    }

    /// A pack of a block of rows that may be cut off, or on the diagonal.
    #[inline(never)]
    fn place_at_edge(&mut self, place: Place, product: &Panel<S>, block: usize, pack: usize) {
        let (lanes, n) = (Panel::<S>::LANES, product.rows());
        let (top, left) = (block * lanes, pack * lanes);
        let (rows, columns) = (lanes.min(n - top), lanes.min(n - left));
        let mut tile = product.block::<0>(block, pack);
        let mut across = tile;
        S::Pack::transpose(&mut across[..lanes]);
        if place.at == place.across && pack == block {
            // The lower triangle decides.
            for r in 0..lanes {
                tile[r] = tile[r].before(r + 1, across[r]);
            }
        } else {
            let (row, column) = place.across;
            self.write_part((row + left, column + top), &across, (columns, rows), place.minus[1]);
        }
        let (row, column) = place.at;
        self.write_part((row + top, column + left), &tile, (rows, columns), place.minus[0]);
    }

    /// The first rows and columns of a block of packs, from this row and column on.
    #[inline(always)]
    fn write_part(
        &mut self,
        (row, column): (usize, usize),
        packs: &[S::Pack; MOST_LANES],
        (rows, columns): (usize, usize),
        minus: bool,
    ) {
        let lanes = Panel::<S>::LANES;
        for (r, &pack) in packs.iter().enumerate().take(lanes) {
            if r < rows {
                let pack = if minus { -pack } else { pack };
                let to = &mut self.data[(row + r) * self.columns + column..];
                // A whole pack is one store.
                if columns == lanes { pack.write(&mut to[..lanes]) } else { pack.write(&mut to[..columns]) }
            }
        }
    }
}

/// Writes a square block of packs to the beginning of rows that are `stride` apart.
#[inline(always)]
fn write_block<S: Scalar, const MINUS: bool>(to: &mut [S], stride: usize, packs: &[S::Pack; MOST_LANES]) {
    let lanes = Panel::<S>::LANES;
    for (r, &pack) in packs.iter().enumerate().take(lanes) {
        let pack = if MINUS { -pack } else { pack };
        pack.write(&mut to[r * stride..][..lanes]);
    }
}

#[cfg(all(test, feature = "wide"))]
mod tests {
    use super::*;
    use crate::matrix::{Part, Pattern, Terms};
    use nalgebra::DMatrix;

    /// A dense matrix with entries where the pattern has them, and a panel of it.
    fn some(n: usize, pattern: &Pattern, from: f64) -> (DMatrix<f64>, Panel<f64>) {
        let entry = |i, j| (from + 1.3 * i as f64 + 0.7 * j as f64).sin();
        let dense = DMatrix::from_fn(n, n, |i, j| if pattern.has(i, j) { entry(i, j) } else { 0.0 });
        let mut panel = Panel::zeros(n, n);
        (0..n).for_each(|i| (0..n).for_each(|j| panel.set(i, j, dense[(i, j)])));
        (dense, panel)
    }

    #[test]
    fn products_of_tiles_are_those_of_matrices_in_their_places() {
        for n in [13, 14, 16, 19, 24, 33, 50] {
            let columns: Vec<Vec<usize>> = (0..n)
                .map(|i| (0..n).filter(|j| (i * i + 3 * j) % 5 < 2 && i / 9 != j / 7).collect())
                .collect();
            let pattern = Pattern::from_rows(n, |i| &columns[i]);
            let across = pattern.transposed();
            let ((a, a_panel), (b, b_panel)) = (some(n, &pattern, 0.2), some(n, &across, 1.1));
            for (left, left_pattern, dense) in [
                (Left::Rows(&a_panel), &pattern, a.clone()),
                (Left::Columns(&a_panel), &across, a.transpose()),
            ] {
                let expected = dense * &b;
                let tiles = Tiles::new::<f64>(left_pattern, &across, Part::Whole, Terms::All);
                let (mut set, mut result) = (Panel::zeros(n, n), Matrix::zeros(2 * n, 2 * n));
                set.set_tiles(&tiles, left, &b_panel);
                set.subtract_tiles(&tiles, left, &b_panel);
                let place = Place { at: (n, 0), across: (0, n), minus: [true, false] };
                result.place_tiles(place, &tiles, (left, &b_panel), (&mut set, Update::Add));
                let result = result.view().to_nalgebra();
                let error = |found: DMatrix<f64>| (found - &expected).amax();
                assert!(error(-result.view((n, 0), (n, n)).into_owned()) < 1e-13, "n = {n}");
                assert!(error(result.view((0, n), (n, n)).transpose()) < 1e-13, "n = {n}");
                assert_eq!(result.view((0, 0), (n, n)).amax(), 0.0);
                assert_eq!(result.view((n, n), (n, n)).amax(), 0.0);
            }
        }
    }

    #[test]
    fn the_lower_tiles_fill_both_triangles_of_a_symmetric_place() {
        for n in [13, 16, 22] {
            let columns: Vec<usize> = (0..n).collect();
            let full = Pattern::from_rows(n, |_| &columns);
            let (dense, panel) = some(n, &full, 0.4);
            let tiles = Tiles::new::<f64>(&full, &full, Part::Lower, Terms::All);
            let (mut product, mut result) = (Panel::zeros(n, n), Matrix::zeros(n, n));
            let place = Place::symmetric((0, 0), true);
            let factors = (Left::Columns(&panel), &panel);
            result.place_tiles(place, &tiles, factors, (&mut product, Update::Set));
            let result = result.view().to_nalgebra();
            assert_eq!(result, result.transpose());
            assert!((result + dense.transpose() * &dense).amax() < 1e-13, "n = {n}");
        }
    }
}
