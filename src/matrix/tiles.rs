//! Products of panels, limited to the entries that can differ from zero.

use super::pattern::Pattern;
use super::{Left, Panel, Part};
use crate::scalar::{MOST_LANES, Pack, Scalar};
use std::ops::Range;

/// Block of rows and first pack of a tile.
pub(super) type Corner = (usize, usize);

/// Numbers of packs in a row of a tile, such that its sums fit into registers; most first.
const SIZES: &[usize] = if cfg!(target_feature = "avx512f") {
    &[6, 4, 2, 1]
} else if cfg!(target_feature = "avx") {
    &[3, 2, 1]
} else {
    &[1]
};

/// The largest of them.
const MOST_PACKS: usize = SIZES[0];

/// A tile may compute zeros up to this part of what it computes for nothing but its packs one by one.
const SPARE: f64 = 0.35;

/// Some rows of a product, as many packs of each as there are in the tile.
pub(super) type Sums<P> = [[P; MOST_PACKS]; MOST_LANES];

/// What is computed of a product T = A B of n x n matrices: tiles of T, and for each the rows of B that
/// enter.
///
/// A tile has as many rows as a pack has lanes, and up to [`MOST_PACKS`] packs of columns.
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
                let fits = |&&packs: &&usize| left + packs <= end && spare(common, left, packs) <= SPARE;
                let packs = SIZES.iter().find(fits).copied().unwrap_or(1);
                let terms = union(common, left, packs);
                if count(&terms) == 0 {
                    left += 1;
                    continue;
                }
                tiles.push(block, left, packs, &terms);
                left += packs;
            }
            tiles.starts.push(tiles.tiles.len());
        }
        tiles
    }

    /// Corner, number of packs and terms of each tile.
    #[inline(always)]
    pub(super) fn all(&self) -> impl Iterator<Item = (Corner, usize, &[u32])> {
        self.of(0..self.tiles.len())
    }

    /// The same for the tiles of a block of rows.
    #[inline(always)]
    pub(super) fn of_block(&self, block: usize) -> impl Iterator<Item = (Corner, usize, &[u32])> {
        self.of(self.starts[block]..self.starts[block + 1])
    }

    #[inline(always)]
    fn of(&self, range: Range<usize>) -> impl Iterator<Item = (Corner, usize, &[u32])> {
        let mut start = range.start.checked_sub(1).map_or(0, |before| self.tiles[before].end as usize);
        self.tiles[range].iter().map(move |tile| {
            let terms = &self.terms[start..tile.end as usize];
            start = tile.end as usize;
            ((tile.block as usize, tile.left as usize), tile.packs as usize, terms)
        })
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

/// The rows of B that enter any of these packs.
fn union(common: impl Fn(usize) -> Vec<u64>, left: usize, packs: usize) -> Vec<u64> {
    (left + 1..left + packs).fold(common(left), |union, pack| {
        union.iter().zip(common(pack)).map(|(union, terms)| union | terms).collect()
    })
}

/// How much more a tile of these packs computes than the packs one by one; infinite if one of them is zero.
fn spare(common: impl Fn(usize) -> Vec<u64>, left: usize, packs: usize) -> f64 {
    let each: Vec<usize> = (left..left + packs).map(|pack| count(&common(pack))).collect();
    if each.contains(&0) {
        return f64::INFINITY;
    }
    let all = packs * count(&union(common, left, packs));
    all as f64 / each.iter().sum::<usize>() as f64 - 1.0
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
            Left::Rows(a) => self.tiles::<false>(tiles, a, b, Update::Set),
            Left::Columns(a) => self.tiles::<true>(tiles, a, b, Update::Set),
        }
    }

    /// `T -= A B` likewise.
    #[inline(never)]
    pub fn subtract_tiles(&mut self, tiles: &Tiles, a: Left<'_, S>, b: &Self) {
        match a {
            Left::Rows(a) => self.tiles::<false>(tiles, a, b, Update::Subtract),
            Left::Columns(a) => self.tiles::<true>(tiles, a, b, Update::Subtract),
        }
    }
}

impl<S: Scalar> Panel<S> {
    fn tiles<const ACROSS: bool>(&mut self, tiles: &Tiles, a: &Self, b: &Self, update: Update) {
        for (corner, packs, terms) in tiles.all() {
            let sums = sums::<S, ACROSS>(a, b, corner, packs, terms);
            self.store(corner, &sums, packs, update);
        }
    }

    #[inline(always)]
    fn store(&mut self, (block, left): Corner, sums: &Sums<S::Pack>, packs: usize, update: Update) {
        let width = self.width::<0>();
        for (r, sums) in sums.iter().enumerate().take(Self::LANES) {
            let place = (block * Self::LANES + r) * width + left;
            let target = &mut self.packs_mut()[place..][..packs];
            for (target, &sum) in target.iter_mut().zip(sums) {
                *target = match update {
                    Update::Set => sum,
                    Update::Subtract => *target - sum,
                };
            }
        }
    }

    /// `T_I -= A' T` for the rows I of a block, A' with the pattern of the tiles: the terms are other rows of
    /// T.
    #[inline(always)]
    pub(crate) fn subtract_own_rows(&mut self, tiles: &Tiles, block: usize, a: &Self) {
        for (corner, packs, terms) in tiles.of_block(block) {
            let sums = sums::<S, true>(a, self, corner, packs, terms);
            self.store(corner, &sums, packs, Update::Subtract);
        }
    }
}

/// The tile of A B, or of A' B, from this row and pack block.
#[inline(always)]
pub(super) fn sums<S: Scalar, const ACROSS: bool>(
    a: &Panel<S>,
    b: &Panel<S>,
    corner: Corner,
    packs: usize,
    terms: &[u32],
) -> Sums<S::Pack> {
    let mut sums = [[S::Pack::zero(); MOST_PACKS]; MOST_LANES];
    match packs / <S::Pack as Pack<S>>::WIDTH {
        0 => narrow::<S, ACROSS>(a, b, corner, terms, &mut sums),
        1 => add_terms::<S, 1, ACROSS>(a, b, corner, terms, &mut sums),
        2 => add_terms::<S, 2, ACROSS>(a, b, corner, terms, &mut sums),
        _ => add_terms::<S, 3, ACROSS>(a, b, corner, terms, &mut sums),
    }
    sums
}

/// Sums of C registers in a row, which they do not leave.
#[inline(always)]
fn add_terms<S: Scalar, const C: usize, const ACROSS: bool>(
    a: &Panel<S>,
    b: &Panel<S>,
    corner: Corner,
    terms: &[u32],
    to: &mut Sums<S::Pack>,
) {
    let width = <S::Pack as Pack<S>>::WIDTH;
    let mut sums = [[<S::Pack as Pack<S>>::Wide::zero(); C]; MOST_LANES];
    for_terms::<S, ACROSS>(a, b, corner, C * width, terms, |r, entry, row| {
        let entry = S::Pack::splat_wide(entry);
        for (sum, b) in sums[r].iter_mut().zip(row.chunks_exact(width)) {
            *sum = entry.mul_add(S::Pack::join(b), *sum);
        }
    });
    for (to, sums) in to.iter_mut().zip(&sums) {
        for (to, &sum) in to.chunks_exact_mut(width).zip(sums) {
            S::Pack::split(sum, to);
        }
    }
}

/// Sums of one pack in a row that fills a part of a register.
#[inline(always)]
fn narrow<S: Scalar, const ACROSS: bool>(
    a: &Panel<S>,
    b: &Panel<S>,
    corner: Corner,
    terms: &[u32],
    to: &mut Sums<S::Pack>,
) {
    let mut sums = [S::Pack::zero(); MOST_LANES];
    for_terms::<S, ACROSS>(a, b, corner, 1, terms, |r, entry, row| {
        sums[r] = S::Pack::splat(entry).mul_add(row[0], sums[r]);
    });
    to.iter_mut().zip(&sums).for_each(|(to, &sum)| to[0] = sum);
}

/// Calls `add` with each row r of the tile, entry `A_rk` and packs of row k of B.
#[inline(always)]
fn for_terms<S: Scalar, const ACROSS: bool>(
    a: &Panel<S>,
    b: &Panel<S>,
    (block, left): Corner,
    packs: usize,
    terms: &[u32],
    mut add: impl FnMut(usize, S, &[S::Pack]),
) {
    let lanes = Panel::<S>::LANES;
    let (stride, from) = (a.width::<0>(), b.width::<0>());
    let mut along = [&a.packs()[..0]; MOST_LANES];
    if !ACROSS {
        for (r, along) in along.iter_mut().enumerate().take(lanes) {
            *along = a.row(block * lanes + r);
        }
    }
    for &k in terms {
        let k = k as usize;
        let row = &b.packs()[k * from + left..][..packs];
        let across = &a.packs()[if ACROSS { k * stride + block } else { 0 }];
        for (r, along) in along.iter().enumerate().take(lanes) {
            add(r, if ACROSS { across.lane(r) } else { along[k / lanes].lane(k % lanes) }, row);
        }
    }
}
