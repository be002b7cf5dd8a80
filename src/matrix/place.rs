//! Products whose tiles go to their places in a larger matrix, together with their transposes.

use super::tiles::{Corner, Sums, Tiles, sums};
use super::{Left, Matrix, Panel};
use crate::scalar::{MOST_LANES, Pack, Scalar};

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
    pub fn symmetric(at: (usize, usize)) -> Self {
        Self { at, across: at, minus: [false; 2] }
    }
}

/// A matrix to which a product is added.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Base<'a, S: Scalar> {
    Zero,
    /// `C - A B`.
    Minus(&'a Panel<S>),
    /// `A B - C`.
    Less(&'a Panel<S>),
    /// `A B + C`.
    Plus(&'a Panel<S>),
}

impl<S: Scalar> Matrix<S> {
    /// Writes a product of n x n matrices, or its sum with or difference from a matrix, to its place. Entries
    /// outside of the tiles are not touched.
    #[inline(never)]
    pub(crate) fn place_tiles(
        &mut self,
        place: Place,
        tiles: &Tiles,
        (a, b): (Left<'_, S>, &Panel<S>),
        base: Base<'_, S>,
    ) {
        match a {
            Left::Rows(a) => self.place_all::<false>(place, tiles, (a, b), base),
            Left::Columns(a) => self.place_all::<true>(place, tiles, (a, b), base),
        }
    }

    fn place_all<const ACROSS: bool>(
        &mut self,
        place: Place,
        tiles: &Tiles,
        (a, b): (&Panel<S>, &Panel<S>),
        base: Base<'_, S>,
    ) {
        let n = b.rows();
        for (corner, packs, terms) in tiles.all() {
            let mut tile = sums::<S, ACROSS>(a, b, corner, packs, terms);
            add_base(base, corner, packs, &mut tile);
            self.place_tile(n, place, corner, packs, &mut tile);
        }
    }

    #[inline(always)]
    fn place_tile(
        &mut self,
        n: usize,
        place: Place,
        (block, left): Corner,
        packs: usize,
        tile: &mut Sums<S::Pack>,
    ) {
        let lanes = Panel::<S>::LANES;
        let top = block * lanes;
        for c in 0..packs {
            let pack = left + c;
            let mut columns = [S::Pack::zero(); MOST_LANES];
            columns.iter_mut().zip(tile.iter()).for_each(|(column, row)| *column = row[c]);
            S::Pack::transpose(&mut columns[..lanes]);
            if place.at == place.across && pack == block {
                // The lower triangle decides.
                for (r, row) in tile.iter_mut().enumerate().take(lanes) {
                    for above in r + 1..lanes {
                        row[c] = row[c].with_lane(above, columns[r].lane(above));
                    }
                }
                continue;
            }
            let first = pack * lanes;
            for (r, &column) in columns.iter().enumerate().take(lanes.min(n - first)) {
                let row = &mut self.row_mut(place.across.0 + first + r)[place.across.1..][..n];
                let end = (top + lanes).min(n);
                if place.minus[1] { -column } else { column }.write(&mut row[top..end]);
            }
        }
        for (r, tile) in tile.iter().enumerate().take(lanes.min(n - top)) {
            let row = &mut self.row_mut(place.at.0 + top + r)[place.at.1..][..n];
            let end = ((left + packs) * lanes).min(n);
            for (to, &tile) in row[left * lanes..end].chunks_mut(lanes).zip(tile) {
                if place.minus[0] { -tile } else { tile }.write(to);
            }
        }
    }
}

/// The product and the matrix that it is added to.
#[inline(always)]
fn add_base<S: Scalar>(base: Base<'_, S>, (block, left): Corner, packs: usize, tile: &mut Sums<S::Pack>) {
    let lanes = Panel::<S>::LANES;
    let mut join = |base: &Panel<S>, join: fn(S::Pack, S::Pack) -> S::Pack| {
        for (r, tile) in tile.iter_mut().enumerate().take(lanes) {
            for (tile, &base) in tile.iter_mut().zip(&base.row(block * lanes + r)[left..][..packs]) {
                *tile = join(*tile, base);
            }
        }
    };
    match base {
        Base::Zero => {}
        Base::Minus(base) => join(base, |tile, base| base - tile),
        Base::Less(base) => join(base, |tile, base| tile - base),
        Base::Plus(base) => join(base, |tile, base| tile + base),
    }
}
