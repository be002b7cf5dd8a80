//! Products of panels, limited to the entries that can differ from zero.

use super::pattern::Pattern;
use super::{Left, Panel, Part};
use crate::scalar::{MOST_LANES, Pack, Scalar};
use std::ops::Range;

/// Block of rows and first pack of a tile.
type Corner = (usize, usize);

/// The largest number of packs in a row of a tile, such that its sums fit into registers.
const MOST_PACKS: usize = if cfg!(target_feature = "avx") { 3 } else { 1 };

/// A tile takes in one more pack if that adds less than this part of the terms of that pack to the sums of
/// the others.
const SPARE: f64 = 0.35;

/// What is computed of a product T = A B of n x n matrices: tiles of T, and for each the rows of B that enter.
///
/// A tile has as many rows as a pack has lanes, and one to three packs of columns.
#[derive(Clone, Debug)]
pub(crate) struct Tiles {
    tiles: Vec<Tile>,
    terms: Vec<u32>,
    /// The first tile of each block of rows.
    starts: Vec<usize>,
}

/// Some rows and packs of a product.
#[derive(Clone, Copy, Debug)]
struct Tile {
    /// Rows `LANES block` and on.
    block: u32,
    /// First pack.
    left: u32,
    packs: u32,
    /// One after the last of its terms.
    end: u32,
}

/// Which terms of a product enter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Terms {
    /// All.
    All,
    /// Those with a row of B outside of the block of rows of the result.
    OtherBlocks,
}

/// Which step a product takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Update {
    Set,
    Subtract,
}

impl Tiles {
    /// For factors with these patterns and packs of so many lanes.
    pub fn new(lanes: usize, a: &Pattern, b: &Pattern, part: Part, terms: Terms) -> Self {
        let (n, across) = (a.size(), b.transposed());
        let block_of = |block: usize| block * lanes..((block + 1) * lanes).min(n);
        let blocks = n.div_ceil(lanes);
        let columns: Vec<Vec<u64>> = (0..blocks).map(|pack| across.columns_of(block_of(pack))).collect();
        let mut tiles = Self { tiles: Vec::new(), terms: Vec::new(), starts: vec![0] };
        for block in 0..blocks {
            let mut rows = a.columns_of(block_of(block));
            if terms == Terms::OtherBlocks {
                block_of(block).for_each(|k| rows[k / 64] &= !(1 << (k % 64)));
            }
            let common = |pack: usize| -> Vec<u64> {
                rows.iter().zip(&columns[pack]).map(|(rows, columns)| rows & columns).collect()
            };
            let end = if part == Part::Lower { block + 1 } else { blocks };
            let mut left = 0;
            while left < end {
                let mut terms = common(left);
                if count(&terms) == 0 {
                    left += 1;
                    continue;
                }
                let mut packs = 1;
                while packs < MOST_PACKS && left + packs < end {
                    let next = common(left + packs);
                    let both: Vec<u64> = terms.iter().zip(&next).map(|(a, b)| a | b).collect();
                    let more = packs * (count(&both) - count(&terms)) + count(&both) - count(&next);
                    if count(&next) == 0 || more as f64 > SPARE * count(&next) as f64 {
                        break;
                    }
                    (terms, packs) = (both, packs + 1);
                }
                tiles.push(block, left, packs, &terms);
                left += packs;
            }
            tiles.starts.push(tiles.tiles.len());
        }
        tiles
    }

    fn push(&mut self, block: usize, left: usize, packs: usize, terms: &[u64]) {
        let of_word = |(word, &bits): (usize, &u64)| {
            (0..64).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| (64 * word + bit) as u32)
        };
        self.terms.extend(terms.iter().enumerate().flat_map(of_word));
        let [block, left, packs, end] = [block, left, packs, self.terms.len()].map(|number| number as u32);
        self.tiles.push(Tile { block, left, packs, end });
    }
}

/// Number of bits that are set.
fn count(bits: &[u64]) -> usize {
    bits.iter().map(|bits| bits.count_ones() as usize).sum()
}

impl<S: Scalar> Panel<S> {
    /// `T = A B` for this panel T: entries outside of the tiles are not touched.
    #[inline(never)]
    pub fn set_tiles(&mut self, tiles: &Tiles, a: Left<'_, S>, b: &Self) {
        match a {
            Left::Rows(a) => self.tiles::<false>(tiles, 0..tiles.tiles.len(), a, b, Update::Set),
            Left::Columns(a) => self.tiles::<true>(tiles, 0..tiles.tiles.len(), a, b, Update::Set),
        }
    }

    /// `T -= A B` likewise.
    #[inline(never)]
    pub fn subtract_tiles(&mut self, tiles: &Tiles, a: Left<'_, S>, b: &Self) {
        match a {
            Left::Rows(a) => self.tiles::<false>(tiles, 0..tiles.tiles.len(), a, b, Update::Subtract),
            Left::Columns(a) => self.tiles::<true>(tiles, 0..tiles.tiles.len(), a, b, Update::Subtract),
        }
    }
}

impl<S: Scalar> Panel<S> {
    fn tiles<const ACROSS: bool>(
        &mut self,
        tiles: &Tiles,
        range: Range<usize>,
        a: &Self,
        b: &Self,
        update: Update,
    ) {
        let mut start = range.start.checked_sub(1).map_or(0, |before| tiles.tiles[before].end as usize);
        for tile in &tiles.tiles[range] {
            let terms = &tiles.terms[start..tile.end as usize];
            start = tile.end as usize;
            let corner = (tile.block as usize, tile.left as usize);
            match tile.packs {
                1 => self.store(corner, sums::<S, 1, ACROSS>(a, b, corner, terms), update),
                2 => self.store(corner, sums::<S, 2, ACROSS>(a, b, corner, terms), update),
                _ => self.store(corner, sums::<S, MOST_PACKS, ACROSS>(a, b, corner, terms), update),
            }
        }
    }

    #[inline(always)]
    fn store<const C: usize>(
        &mut self,
        (block, left): Corner,
        sums: [[S::Pack; C]; MOST_LANES],
        update: Update,
    ) {
        let width = self.width::<0>();
        for (r, sums) in sums.iter().enumerate().take(Self::LANES) {
            let place = (block * Self::LANES + r) * width + left;
            let target = &mut self.packs_mut()[place..][..C];
            for (target, &sum) in target.iter_mut().zip(sums) {
                *target = match update {
                    Update::Set => sum,
                    Update::Subtract => *target - sum,
                };
            }
        }
    }

    /// `T_I -= A' T` for the rows I of a block, A' with the patterns of the tiles: the terms are other rows of T.
    #[inline(always)]
    pub fn subtract_own_rows(&mut self, tiles: &Tiles, block: usize, a: &Self) {
        let range = tiles.starts[block]..tiles.starts[block + 1];
        let mut start = range.start.checked_sub(1).map_or(0, |before| tiles.tiles[before].end as usize);
        for tile in &tiles.tiles[range] {
            let terms = &tiles.terms[start..tile.end as usize];
            start = tile.end as usize;
            let corner = (block, tile.left as usize);
            match tile.packs {
                1 => {
                    let sums = sums::<S, 1, true>(a, self, corner, terms);
                    self.store(corner, sums, Update::Subtract);
                }
                2 => {
                    let sums = sums::<S, 2, true>(a, self, corner, terms);
                    self.store(corner, sums, Update::Subtract);
                }
                _ => {
                    let sums = sums::<S, MOST_PACKS, true>(a, self, corner, terms);
                    self.store(corner, sums, Update::Subtract);
                }
            }
        }
    }
}

/// The tile of A B, or of A' B, from this row and pack block: the sums stay in registers.
#[inline(always)]
fn sums<S: Scalar, const C: usize, const ACROSS: bool>(
    a: &Panel<S>,
    b: &Panel<S>,
    (block, left): Corner,
    terms: &[u32],
) -> [[S::Pack; C]; MOST_LANES] {
    let lanes = Panel::<S>::LANES;
    let (stride, from) = (a.width::<0>(), b.width::<0>());
    let mut sums = [[S::Pack::zero(); C]; MOST_LANES];
    let mut along = [&a.packs()[..0]; MOST_LANES];
    if !ACROSS {
        for (r, along) in along.iter_mut().enumerate().take(lanes) {
            *along = a.row(block * lanes + r);
        }
    }
    for &k in terms {
        let k = k as usize;
        let row = &b.packs()[k * from + left..][..C];
        let across = &a.packs()[if ACROSS { k * stride + block } else { 0 }];
        for (r, sums) in sums.iter_mut().enumerate().take(lanes) {
            let entry = if ACROSS { across.lane(r) } else { along[r][k / lanes].lane(k % lanes) };
            let entry = S::Pack::splat(entry);
            for (sum, &b) in sums.iter_mut().zip(row) {
                *sum = entry.mul_add(b, *sum);
            }
        }
    }
    sums
}
