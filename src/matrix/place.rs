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
    /// Sets a panel T to `A B`, or adds to it or subtracts from it, and writes its tiles to their places.
    pub(crate) fn place_tiles(
        &mut self,
        place: Place,
        tiles: &Tiles,
        (a, b): (Left<'_, S>, &Panel<S>),
        (product, update): (&mut Panel<S>, Update<'_, S>),
    ) {
        product.update_tiles(tiles, a, b, update);
        self.place_panel(place, tiles, product);
    }

    /// Writes the tiles of a panel to their places. Entries outside of them are not touched. Of a symmetric
    /// matrix, the lower triangle of the panel decides, and its diagonal blocks become symmetric.
    ///
    /// The matrix is larger than the nearest cache, and the factors of products fill most of that: several
    /// products are computed before the first is written, and some rows are written after the other, as many
    /// as a pack has lanes, so that few lines arrive twice.
    #[inline(never)]
    pub(crate) fn place_panel(&mut self, place: Place, tiles: &Tiles, product: &mut Panel<S>) {
        match product.rows() % Panel::<S>::LANES {
            0 => self.place_and::<0>(&place, tiles, product),
            1 => self.place_and::<1>(&place, tiles, product),
            2 => self.place_and::<2>(&place, tiles, product),
            _ => self.place_and::<3>(&place, tiles, product),
        }
    }

    /// The same, the last rows and columns being R, if not as many as a pack has lanes.
    fn place_and<const R: usize>(&mut self, place: &Place, tiles: &Tiles, product: &mut Panel<S>) {
        let symmetric = place.at == place.across;
        // The tiles may be those of a larger matrix, empty beyond this one.
        let blocks = product.rows().div_ceil(Panel::<S>::LANES);
        for block in 0..blocks {
            if symmetric {
                product.mirror_block(block);
            }
            self.place_rows::<R>(place, product, block, tiles.packs_of(block));
            if symmetric {
                self.place_columns::<R>(place, product, block, tiles.blocks_of(block));
            }
        }
        if !symmetric {
            for pack in 0..blocks {
                self.place_columns::<R>(place, product, pack, tiles.blocks_of(pack));
            }
        }
    }

    /// Some packs of a block of rows.
    #[inline(always)]
    fn place_rows<const R: usize>(
        &mut self,
        place: &Place,
        product: &Panel<S>,
        block: usize,
        runs: &[Range<usize>],
    ) {
        let (lanes, n) = (Panel::<S>::LANES, product.rows());
        let ((top, left), sign) = (place.at, place.sign::<S>(0));
        if R > 0 && block == n / lanes {
            for i in block * lanes..n {
                let (from, to) = (product.row(i), &mut self.row_mut(top + i)[left..left + n]);
                for run in runs {
                    for pack in run.clone() {
                        (from[pack] * sign).write(&mut to[pack * lanes..n.min((pack + 1) * lanes)]);
                    }
                }
            }
            return;
        }
        let from = product.rows_of(block);
        let signed = |r: usize, pack: usize| from[r][pack] * sign;
        let [first, second, third, fourth] = self.rows_from(top + block * lanes, left, n);
        for run in runs {
            let whole = run.end.min(n / lanes);
            for pack in run.start..whole {
                let columns = pack * lanes..(pack + 1) * lanes;
                signed(0, pack).write(&mut first[columns.clone()]);
                if lanes > 1 {
                    signed(1, pack).write(&mut second[columns.clone()]);
                    signed(2, pack).write(&mut third[columns.clone()]);
                    signed(3, pack).write(&mut fourth[columns]);
                }
            }
            if R > 0 && whole < run.end {
                let column = whole * lanes;
                write_first::<S, R>(signed(0, whole), &mut first[column..]);
                if lanes > 1 {
                    write_first::<S, R>(signed(1, whole), &mut second[column..]);
                    write_first::<S, R>(signed(2, whole), &mut third[column..]);
                    write_first::<S, R>(signed(3, whole), &mut fourth[column..]);
                }
            }
        }
    }

    /// Some columns of as many rows as a pack has lanes.
    #[inline(always)]
    fn rows_from(&mut self, top: usize, left: usize, columns: usize) -> [&mut [S]; MOST_LANES] {
        let mut rows = self.data[top * self.columns..].chunks_mut(self.columns);
        let mut next = || rows.next().map_or(&mut [][..], |row| &mut row[left..left + columns]);
        let mut some = [next(), &mut [], &mut [], &mut []];
        (1..Panel::<S>::LANES).for_each(|r| some[r] = next());
        some
    }

    /// The transpose of a pack of some blocks of rows.
    #[inline(always)]
    fn place_columns<const R: usize>(
        &mut self,
        place: &Place,
        product: &Panel<S>,
        pack: usize,
        runs: &[Range<usize>],
    ) {
        let (lanes, n, stride) = (Panel::<S>::LANES, product.rows(), self.columns);
        let ((top, left), sign) = (place.across, place.sign::<S>(1));
        let transposed = |block: usize| {
            let mut tile = product.block::<0>(block, pack);
            S::Pack::transpose(&mut tile[..lanes]);
            tile.map(|row| row * sign)
        };
        if R > 0 && pack == n / lanes {
            let rows = &mut self.data[(top + pack * lanes) * stride..];
            for block in runs.iter().cloned().flatten() {
                for (row, pack) in rows.chunks_mut(stride).zip(&transposed(block)[..R]) {
                    let columns = left + block * lanes..left + n.min((block + 1) * lanes);
                    pack.write(&mut row[columns]);
                }
            }
            return;
        }
        let [first, second, third, fourth] = self.rows_from(top + pack * lanes, left, n);
        for run in runs {
            let whole = run.end.min(n / lanes);
            for block in run.start..whole {
                let (tile, columns) = (transposed(block), block * lanes..(block + 1) * lanes);
                tile[0].write(&mut first[columns.clone()]);
                if lanes > 1 {
                    tile[1].write(&mut second[columns.clone()]);
                    tile[2].write(&mut third[columns.clone()]);
                    tile[3].write(&mut fourth[columns]);
                }
            }
            if R > 0 && whole < run.end {
                let (tile, column) = (transposed(whole), whole * lanes);
                write_first::<S, R>(tile[0], &mut first[column..]);
                if lanes > 1 {
                    write_first::<S, R>(tile[1], &mut second[column..]);
                    write_first::<S, R>(tile[2], &mut third[column..]);
                    write_first::<S, R>(tile[3], &mut fourth[column..]);
                }
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

/// Writes the first R lanes of a pack to the beginning of a row.
#[inline(always)]
fn write_first<S: Scalar, const R: usize>(pack: S::Pack, to: &mut [S]) {
    for (lane, to) in to[..R].iter_mut().enumerate() {
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
