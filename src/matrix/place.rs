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

    #[inline(always)]
    fn place_all<const ACROSS: bool>(
        &mut self,
        place: Place,
        tiles: &Tiles,
        (a, b): (&Panel<S>, &Panel<S>),
        (product, update): (&mut Panel<S>, Update<'_, S>),
    ) {
        product.tiles::<ACROSS>(tiles, a, b, update, |product, block, packs| {
            self.place_packs(&place, product, block, packs);
        });
    }

    /// Some packs of a block of rows.
    #[inline(never)]
    fn place_packs(&mut self, place: &Place, product: &mut Panel<S>, block: usize, packs: Range<usize>) {
        let (lanes, n) = (Panel::<S>::LANES, product.rows());
        let symmetric = place.at == place.across;
        let mut end = packs.end.min(if symmetric { block + 1 } else { n.div_ceil(lanes) });
        if symmetric && end > block {
            product.mirror_block(block);
        }
        let top = block * lanes;
        let rows = top..n.min(top + lanes);
        match (end * lanes).saturating_sub(n) {
            0 => self.place_rows::<0>(place, product, rows.clone(), packs.start..end),
            1 => self.place_rows::<3>(place, product, rows.clone(), packs.start..end - 1),
            2 => self.place_rows::<2>(place, product, rows.clone(), packs.start..end - 1),
            _ => self.place_rows::<1>(place, product, rows.clone(), packs.start..end - 1),
        }
        if symmetric {
            // The diagonal is its own transpose.
            end = end.min(block);
        }
        match rows.len() {
            1 => self.place_columns::<1>(place, product, block, packs.start..end),
            2 => self.place_columns::<2>(place, product, block, packs.start..end),
            3 => self.place_columns::<3>(place, product, block, packs.start..end),
            _ => self.place_columns::<MOST_LANES>(place, product, block, packs.start..end),
        }
    }

    /// Whole packs of these rows, and R entries after them.
    #[inline(always)]
    fn place_rows<const R: usize>(
        &mut self,
        place: &Place,
        product: &Panel<S>,
        rows: Range<usize>,
        packs: Range<usize>,
    ) {
        let (lanes, stride, sign) = (Panel::<S>::LANES, self.columns, place.sign::<S>(0));
        let length = packs.len() * lanes;
        for i in rows {
            let first = (place.at.0 + i) * stride + place.at.1 + packs.start * lanes;
            let (whole, rest) = self.data[first..][..length + R].split_at_mut(length);
            let row = &product.row(i)[packs.start..];
            for (to, &pack) in whole.chunks_exact_mut(lanes).zip(row) {
                (pack * sign).write(to);
            }
            if R > 0 {
                write_first::<S, R>(row[packs.len()] * sign, rest);
            }
        }
    }

    /// The transpose of some packs of a block of C rows.
    #[inline(always)]
    fn place_columns<const C: usize>(
        &mut self,
        place: &Place,
        product: &Panel<S>,
        block: usize,
        packs: Range<usize>,
    ) {
        let (lanes, n, stride) = (Panel::<S>::LANES, product.rows(), self.columns);
        let (sign, column) = (place.sign::<S>(1), place.across.1 + block * lanes);
        let rows = product.rows_of(block);
        let transposed = |pack: usize| {
            let mut tile = [S::Pack::zero(); MOST_LANES];
            tile.iter_mut().zip(&rows).take(lanes).for_each(|(tile, row)| *tile = row[pack] * sign);
            S::Pack::transpose(&mut tile[..lanes]);
            tile
        };
        let whole = packs.end.min(n / lanes);
        let mut to = &mut self.data[(place.across.0 + packs.start * lanes) * stride..];
        for pack in packs.start..whole {
            let tile = transposed(pack);
            let (some, after) = to.split_at_mut(lanes * stride);
            to = after;
            let (first, some) = some.split_at_mut(stride);
            write_first::<S, C>(tile[0], &mut first[column..]);
            if lanes > 1 {
                let (second, some) = some.split_at_mut(stride);
                let (third, fourth) = some.split_at_mut(stride);
                write_first::<S, C>(tile[1], &mut second[column..]);
                write_first::<S, C>(tile[2], &mut third[column..]);
                write_first::<S, C>(tile[3], &mut fourth[column..]);
            }
        }
        if whole < packs.end {
            let tile = transposed(whole);
            for (row, &pack) in to.chunks_mut(stride).zip(&tile[..n - whole * lanes]) {
                write_first::<S, C>(pack, &mut row[column..]);
            }
        }
    }
}

impl Place {
    /// What the product, or the transpose, is multiplied by.
    #[inline(always)]
    fn sign<S: Scalar>(&self, transpose: usize) -> S::Pack {
        S::Pack::from_f64(if self.minus[transpose] { -1.0 } else { 1.0 })
    }
}

/// Writes the first C lanes of a pack to the beginning of a row.
#[inline(always)]
fn write_first<S: Scalar, const C: usize>(pack: S::Pack, to: &mut [S]) {
    if C >= Panel::<S>::LANES {
        return pack.write(&mut to[..Panel::<S>::LANES]);
    }
    for (lane, to) in to[..C].iter_mut().enumerate() {
        *to = pack.lane(lane);
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
