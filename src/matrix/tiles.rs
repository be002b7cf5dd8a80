//! Products of panels, limited to the entries that can differ from zero.

use super::pattern::Pattern;
use super::{Panel, Part};
use crate::scalar::{Pack, Scalar};
use std::ops::Range;

/// Block of rows and first register of a tile.
pub(super) type Corner = (usize, usize);

/// Numbers of registers in a row of a tile, such that its sums fit into registers; most first.
const SIZES: &[usize] = if cfg!(target_feature = "avx") { &[3, 2, 1] } else { &[1] };

/// The first of them.
pub(super) const MOST_REGISTERS: usize = SIZES[0];

/// A tile may compute zeros up to this part of what it computes for nothing but its registers one by one.
const SPARE: f64 = 0.2;

/// What is computed of a product T = A B of n x n matrices: tiles of T, and for each the rows of B that
/// enter.
///
/// A tile has as many rows as a pack has lanes, and its columns fill up to three registers.
#[derive(Clone, Debug)]
pub(crate) struct Tiles {
    tiles: Vec<Tile>,
    runs: Vec<Run>,
    /// The first tile of each block of rows.
    starts: Vec<usize>,
    /// What the tiles cover: packs of each block of rows, and blocks of rows of each pack. Of the lower part,
    /// the first up to the diagonal, and the second below it.
    packs: Vec<Vec<Range<usize>>>,
    blocks: Vec<Vec<Range<usize>>>,
}

/// Terms that follow one another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    first: u32,
    end: u32,
}

impl Run {
    /// The terms.
    #[inline(always)]
    pub fn terms(self) -> Range<usize> {
        self.first as usize..self.end as usize
    }
}

/// Some rows of a product, and some registers of them.
#[derive(Clone, Copy, Debug)]
struct Tile {
    /// Rows `LANES block` and on.
    block: u32,
    /// First register.
    left: u32,
    registers: u32,
    /// One after the last of its runs of terms.
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

impl Tiles {
    /// For factors with these patterns.
    pub fn new<S: Scalar>(a: &Pattern, b: &Pattern, part: Part, terms: Terms) -> Self {
        Self::of_registers(Panel::<S>::LANES, <S::Pack as Pack<S>>::WIDTH, [a, b], part, terms)
    }

    /// The same for registers of `width` packs of so many lanes.
    fn of_registers(lanes: usize, width: usize, [a, b]: [&Pattern; 2], part: Part, terms: Terms) -> Self {
        let (n, across) = (a.size(), b.transposed());
        let some = |from: usize, count: usize| from * count..((from + 1) * count).min(n);
        let (blocks, registers) = (n.div_ceil(lanes), n.div_ceil(lanes * width));
        let columns: Vec<Vec<u64>> =
            (0..registers).map(|register| across.columns_of(some(register, lanes * width))).collect();
        let [packs, covered] = [vec![Vec::new(); blocks], vec![Vec::new(); blocks]];
        let mut tiles = Self { tiles: Vec::new(), runs: Vec::new(), starts: vec![0], packs, blocks: covered };
        for block in 0..blocks {
            let mut rows = a.columns_of(some(block, lanes));
            if terms == Terms::OtherBlocks {
                some(block, lanes).for_each(|k| rows[k / 64] &= !(1 << (k % 64)));
            }
            let common = |register: usize| -> Vec<u64> {
                rows.iter().zip(&columns[register]).map(|(rows, columns)| rows & columns).collect()
            };
            let end = if part == Part::Lower { (block + 1).div_ceil(width) } else { registers };
            let mut left = 0;
            while left < end {
                let fits = |&&count: &&usize| left + count <= end && spare(common, left, count) <= SPARE;
                let count = SIZES.iter().find(fits).copied().unwrap_or(1);
                let terms = union(common, left, count);
                if bits(&terms) == 0 {
                    left += 1;
                    continue;
                }
                tiles.push(block, left, count, &terms);
                left += count;
            }
            tiles.starts.push(tiles.tiles.len());
            tiles.cover(block, width, part);
        }
        tiles
    }

    /// Notes what the tiles of the last block of rows cover.
    fn cover(&mut self, block: usize, width: usize, part: Part) {
        let (lower, all) = (part == Part::Lower, self.packs.len());
        for tile in &self.tiles[self.starts[block]..] {
            let (first, count) = (tile.left as usize * width, tile.registers as usize * width);
            for pack in first..(first + count).min(if lower { block + 1 } else { all }) {
                extend(&mut self.packs[block], pack);
                if !lower || pack < block {
                    extend(&mut self.blocks[pack], block);
                }
            }
        }
    }

    /// Packs that the tiles of a block of rows cover.
    #[inline(always)]
    pub(super) fn packs_of(&self, block: usize) -> &[Range<usize>] {
        &self.packs[block]
    }

    /// Blocks of rows with a tile that covers a pack.
    #[inline(always)]
    pub(super) fn blocks_of(&self, pack: usize) -> &[Range<usize>] {
        &self.blocks[pack]
    }

    /// Number of blocks of rows.
    #[inline(always)]
    pub(super) fn blocks(&self) -> usize {
        self.packs.len()
    }

    /// Corner, number of registers in a row and runs of terms of each tile of a block of rows.
    #[inline(always)]
    pub(super) fn of_block(&self, block: usize) -> impl Iterator<Item = (Corner, usize, &[Run])> {
        self.of(self.starts[block]..self.starts[block + 1])
    }

    #[inline(always)]
    fn of(&self, range: Range<usize>) -> impl Iterator<Item = (Corner, usize, &[Run])> {
        let mut start = range.start.checked_sub(1).map_or(0, |before| self.tiles[before].end as usize);
        self.tiles[range].iter().map(move |tile| {
            let runs = &self.runs[start..tile.end as usize];
            start = tile.end as usize;
            ((tile.block as usize, tile.left as usize), tile.registers as usize, runs)
        })
    }

    fn push(&mut self, block: usize, left: usize, registers: usize, terms: &[u64]) {
        let before = self.runs.len();
        let of_word = |(word, &bits): (usize, &u64)| {
            (0..64).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| (64 * word + bit) as u32)
        };
        for term in terms.iter().enumerate().flat_map(of_word) {
            match self.runs[before..].last_mut() {
                Some(run) if run.end == term => run.end += 1,
                _ => self.runs.push(Run { first: term, end: term + 1 }),
            }
        }
        let numbers = [block, left, registers, self.runs.len()];
        let [block, left, registers, end] = numbers.map(|number| number as u32);
        self.tiles.push(Tile { block, left, registers, end });
    }
}

/// Appends a number to ascending ranges.
fn extend(ranges: &mut Vec<Range<usize>>, next: usize) {
    match ranges.last_mut() {
        Some(last) if last.end == next => last.end += 1,
        _ => ranges.push(next..next + 1),
    }
}

/// The rows of B that enter any of these registers.
fn union(common: impl Fn(usize) -> Vec<u64>, left: usize, count: usize) -> Vec<u64> {
    (left + 1..left + count).fold(common(left), |union, register| {
        union.iter().zip(common(register)).map(|(union, terms)| union | terms).collect()
    })
}

/// How much more a tile of these registers computes than the registers one by one; infinite if one of them is
/// zero.
fn spare(common: impl Fn(usize) -> Vec<u64>, left: usize, count: usize) -> f64 {
    let each: Vec<usize> = (left..left + count).map(|register| bits(&common(register))).collect();
    if each.contains(&0) {
        return f64::INFINITY;
    }
    let all = count * bits(&union(common, left, count));
    all as f64 / each.iter().sum::<usize>() as f64 - 1.0
}

/// Number of bits that are set.
fn bits(words: &[u64]) -> usize {
    words.iter().map(|word| word.count_ones() as usize).sum()
}
