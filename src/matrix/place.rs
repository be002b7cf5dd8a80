//! Products in panels go to their places in a larger matrix, together with their transposes.

use super::{Matrix, Panel, Tiles};
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
    pub fn symmetric(at: (usize, usize), minus: bool) -> Self {
        Self { at, across: at, minus: [minus; 2] }
    }
}

impl<S: Scalar> Matrix<S> {
    /// Writes an n x n panel that holds the product of these tiles to its place. Entries outside of the tiles
    /// are not touched.
    #[inline(never)]
    pub(crate) fn place_tiles(&mut self, place: Place, tiles: &Tiles, product: &Panel<S>) {
        match place.minus {
            [false, false] => self.place_all::<false, false>(place, tiles, product),
            [true, false] => self.place_all::<true, false>(place, tiles, product),
            [false, true] => self.place_all::<false, true>(place, tiles, product),
            [true, true] => self.place_all::<true, true>(place, tiles, product),
        }
    }

    fn place_all<const MINUS: bool, const ACROSS_MINUS: bool>(
        &mut self,
        place: Place,
        tiles: &Tiles,
        product: &Panel<S>,
    ) {
        let (lanes, n) = (Panel::<S>::LANES, product.rows());
        let symmetric = place.at == place.across;
        for (block, packs) in tiles.packs::<S>() {
            let (top, rows) = (block * lanes, lanes.min(n - block * lanes));
            for pack in packs.start..packs.end.min(if symmetric { block + 1 } else { usize::MAX }) {
                let (left, columns) = (pack * lanes, lanes.min(n - pack * lanes));
                let mut tile = product.block::<0>(block, pack);
                let mut across = tile;
                S::Pack::transpose(&mut across[..lanes]);
                if symmetric && pack == block {
                    // The lower triangle decides.
                    for r in 0..lanes {
                        tile[r] = tile[r].before(r + 1, across[r]);
                    }
                } else {
                    let at = (place.across.0 + left, place.across.1 + top);
                    self.write_packs::<ACROSS_MINUS>(at, (columns, rows), across);
                }
                self.write_packs::<MINUS>((place.at.0 + top, place.at.1 + left), (rows, columns), tile);
            }
        }
    }

    /// Writes a square block of packs from this row and column on, and of that so many rows and columns.
    #[inline(always)]
    fn write_packs<const MINUS: bool>(
        &mut self,
        (top, left): (usize, usize),
        (rows, columns): (usize, usize),
        packs: [S::Pack; MOST_LANES],
    ) {
        let (lanes, stride) = (Panel::<S>::LANES, self.columns);
        let packs = if MINUS { packs.map(|pack| -pack) } else { packs };
        let to = &mut self.data[top * stride + left..];
        if rows == lanes && columns == lanes {
            for (r, pack) in packs.iter().enumerate().take(lanes) {
                pack.write(&mut to[r * stride..][..lanes]);
            }
        } else {
            for (r, pack) in packs.iter().enumerate().take(rows) {
                pack.write(&mut to[r * stride..][..columns]);
            }
        }
    }
}
