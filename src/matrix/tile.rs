//! One tile of a product of panels, whose sums stay in registers, and products stored in panels.

use super::tiles::{Corner, MOST_REGISTERS, Run, Tiles};
use super::{Left, Panel};
use crate::scalar::{MOST_LANES, Pack, Scalar};

/// As many packs as fit into a register.
type Wide<S> = <<S as Scalar>::Pack as Pack<S>>::Wide;

/// Some rows of a product, C registers of each.
type Sums<S, const C: usize> = [[Wide<S>; C]; MOST_LANES];

/// Which step a product takes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Update<'a, S: Scalar> {
    Set,
    Subtract,
    Add,
    /// The result is this panel, of the same size, minus the product.
    SubtractFrom(&'a Panel<S>),
}

/// Computes a tile of so many registers in a row, and does something with its sums.
macro_rules! with_sums {
    ($S:ty, $ACROSS:expr, ($a:expr, $b:expr, $corner:expr, $registers:expr, $runs:expr),
     |$sums:ident| $then:expr) => {
        // Sizes beyond the largest are not compiled.
        if MOST_REGISTERS > 2 && $registers == 3 {
            let $sums = sums::<$S, 3, $ACROSS>($a, $b, $corner, $runs);
            $then
        } else if MOST_REGISTERS > 1 && $registers == 2 {
            let $sums = sums::<$S, 2, $ACROSS>($a, $b, $corner, $runs);
            $then
        } else {
            let $sums = sums::<$S, 1, $ACROSS>($a, $b, $corner, $runs);
            $then
        }
    };
}

/// The tile of A B, or of A' B.
#[inline(always)]
fn sums<S: Scalar, const C: usize, const ACROSS: bool>(
    a: &Panel<S>,
    b: &Panel<S>,
    (block, left): Corner,
    runs: &[Run],
) -> Sums<S, C> {
    let (lanes, width) = (Panel::<S>::LANES, <S::Pack as Pack<S>>::WIDTH);
    let (stride, from, left) = (a.width::<0>(), b.width::<0>(), left * width);
    let mut sums = [[Wide::<S>::zero(); C]; MOST_LANES];
    let along = if ACROSS { [&a.packs()[..0]; MOST_LANES] } else { a.rows_of(block) };
    let (a, b) = (a.packs(), b.packs());
    for run in runs {
        for k in run.terms() {
            let row = &b[k * from + left..][..C * width];
            if ACROSS {
                let entries = &a[k * stride + block];
                add_term::<S, C>(&mut sums, row, |r| entries.lane(r));
            } else {
                let (pack, lane) = (k / lanes, k % lanes);
                add_term::<S, C>(&mut sums, row, |r| along[r][pack].lane(lane));
            }
        }
    }
    sums
}

/// Adds a column of the left factor, entry by entry, times some registers of a row of the right one.
#[inline(always)]
fn add_term<S: Scalar, const C: usize>(sums: &mut Sums<S, C>, row: &[S::Pack], entry: impl Fn(usize) -> S) {
    let width = <S::Pack as Pack<S>>::WIDTH;
    let mut registers = [Wide::<S>::zero(); C];
    for (register, packs) in registers.iter_mut().zip(row.chunks_exact(width)) {
        *register = S::Pack::join(packs);
    }
    // Row by row: in a loop with checks of indices in it, the sums would be in memory.
    let [first, second, third, fourth] = sums;
    add_row::<S, C>(first, &registers, entry(0));
    if Panel::<S>::LANES > 1 {
        add_row::<S, C>(second, &registers, entry(1));
        add_row::<S, C>(third, &registers, entry(2));
        add_row::<S, C>(fourth, &registers, entry(3));
    }
}

/// Adds an entry times these registers.
#[inline(always)]
fn add_row<S: Scalar, const C: usize>(sums: &mut [Wide<S>; C], registers: &[Wide<S>; C], entry: S) {
    let entry = S::Pack::splat_wide(entry);
    sums.iter_mut().zip(registers).for_each(|(sum, &register)| *sum = entry.mul_add(register, *sum));
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

    /// Sets or adds to a product, or subtracts it.
    #[inline(never)]
    pub fn update_tiles(&mut self, tiles: &Tiles, a: Left<'_, S>, b: &Self, update: Update<'_, S>) {
        match a {
            Left::Rows(a) => self.tiles::<false>(tiles, a, b, update),
            Left::Columns(a) => self.tiles::<true>(tiles, a, b, update),
        }
    }

    /// Computes the tiles, one after the other.
    #[inline(always)]
    fn tiles<const ACROSS: bool>(&mut self, tiles: &Tiles, a: &Self, b: &Self, update: Update<'_, S>) {
        for block in 0..tiles.blocks() {
            for (corner, registers, runs) in tiles.of_block(block) {
                with_sums!(S, ACROSS, (a, b, corner, registers, runs), |sums| {
                    self.store(corner, &sums, update);
                });
            }
        }
    }

    /// `T_I -= T' T` for the rows I of a block, T' with the pattern of the tiles: the terms are other rows.
    #[inline(always)]
    pub(crate) fn subtract_own_square(&mut self, tiles: &Tiles, block: usize) {
        for (corner, registers, runs) in tiles.of_block(block) {
            with_sums!(S, true, (&*self, &*self, corner, registers, runs), |sums| {
                self.store(corner, &sums, Update::Subtract)
            });
        }
    }

    /// `T_I = A' T` likewise, A' with the pattern of the tiles.
    #[inline(always)]
    pub(crate) fn set_own_rows(&mut self, tiles: &Tiles, block: usize, a: &Self) {
        for (corner, registers, runs) in tiles.of_block(block) {
            with_sums!(S, true, (a, &*self, corner, registers, runs), |sums| {
                self.store(corner, &sums, Update::Set)
            });
        }
    }

    #[inline(always)]
    fn store<const C: usize>(&mut self, (block, left): Corner, sums: &Sums<S, C>, update: Update<'_, S>) {
        let (stride, width) = (self.width::<0>(), <S::Pack as Pack<S>>::WIDTH);
        for (r, sums) in sums.iter().enumerate().take(Self::LANES) {
            let place = (block * Self::LANES + r) * stride + left * width;
            let target = &mut self.packs_mut()[place..][..C * width];
            for (c, &sum) in sums.iter().enumerate() {
                let target = &mut target[c * width..][..width];
                let sum = match update {
                    Update::Set => sum,
                    Update::Subtract => S::Pack::join(target) - sum,
                    Update::Add => S::Pack::join(target) + sum,
                    Update::SubtractFrom(base) => {
                        S::Pack::join(&base.packs()[place + c * width..][..width]) - sum
                    }
                };
                S::Pack::split(sum, target);
            }
        }
    }
}
