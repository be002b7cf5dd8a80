//! Transposition of matrices whose rows are whole packs, square block by square block.

use super::Panel;
use crate::scalar::{MOST_LANES, Pack, Scalar};

impl<S: Scalar> Panel<S> {
    /// The square block of packs in rows `LANES top` and on and place `left`.
    #[inline(always)]
    pub fn block<const W: usize>(&self, top: usize, left: usize) -> [S::Pack; MOST_LANES] {
        let (width, mut block) = (self.width::<W>(), [S::Pack::zero(); MOST_LANES]);
        let rows = &self.packs()[top * Self::LANES * width..][..Self::LANES * width];
        for r in 0..Self::LANES {
            block[r] = rows[r * width + left];
        }
        block
    }

    /// The rows of a block.
    #[inline(always)]
    pub fn rows_of(&self, block: usize) -> [&[S::Pack]; MOST_LANES] {
        let mut rows = [&self.packs()[..0]; MOST_LANES];
        for (r, row) in rows.iter_mut().enumerate().take(Self::LANES) {
            *row = self.row(block * Self::LANES + r);
        }
        rows
    }

    /// Sets the same packs.
    #[inline(always)]
    pub fn set_block<const W: usize>(&mut self, top: usize, left: usize, block: &[S::Pack]) {
        let width = self.width::<W>();
        let rows = &mut self.packs_mut()[top * Self::LANES * width..][..Self::LANES * width];
        for r in 0..Self::LANES {
            rows[r * width + left] = block[r];
        }
    }

    /// Sets this panel to the transpose of a square panel of the same size. W: packs per row if known, else
    /// 0.
    #[inline(always)]
    pub fn take_transpose<const W: usize>(&mut self, from: &Self) {
        for top in 0..self.width::<W>() {
            for left in 0..self.width::<W>() {
                let mut block = from.block::<W>(top, left);
                S::Pack::transpose(&mut block[..Self::LANES]);
                self.set_block::<W>(left, top, &block);
            }
        }
    }

    /// `A + A'` for a square panel A of the same size.
    pub fn add_transpose(&mut self, a: &Self) {
        let size = self.width::<0>();
        for top in 0..size {
            for left in 0..=top {
                let (lower, mut upper) = (a.block::<0>(top, left), a.block::<0>(left, top));
                S::Pack::transpose(&mut upper[..Self::LANES]);
                upper.iter_mut().zip(&lower).for_each(|(upper, &lower)| *upper += lower);
                self.set_block::<0>(top, left, &upper);
                S::Pack::transpose(&mut upper[..Self::LANES]);
                self.set_block::<0>(left, top, &upper);
            }
        }
    }

    /// Keeps half of the diagonal of a square panel and all below it: zero above.
    pub fn keep_half(&mut self) {
        for i in 0..self.rows() {
            let (pack, lane) = (i / Self::LANES, i % Self::LANES);
            let row = self.row_mut(i);
            row[pack + 1..].fill(S::Pack::zero());
            for above in lane + 1..Self::LANES {
                row[pack] = row[pack].with_lane(above, S::zero());
            }
            row[pack] = row[pack].with_lane(lane, row[pack].lane(lane).times(0.5));
        }
    }

    /// Copies the lower triangle of a block on the diagonal to the upper one.
    #[inline(always)]
    pub fn mirror_block(&mut self, block: usize) {
        let mut across = self.block::<0>(block, block);
        let lower = across;
        S::Pack::transpose(&mut across[..Self::LANES]);
        for (r, (across, lower)) in across.iter_mut().zip(lower).enumerate().take(Self::LANES) {
            *across = lower.before(r + 1, *across);
        }
        self.set_block::<0>(block, block, &across);
    }

    /// Copies the lower triangle of a square matrix to the upper one.
    #[inline(always)]
    pub fn mirror_lower<const W: usize>(&mut self) {
        for top in 0..self.width::<W>() {
            for left in 0..top {
                let mut block = self.block::<W>(top, left);
                S::Pack::transpose(&mut block[..Self::LANES]);
                self.set_block::<W>(left, top, &block);
            }
            let mut block = self.block::<W>(top, top);
            let lower = block;
            S::Pack::transpose(&mut block[..Self::LANES]);
            for (r, (pack, lower)) in block.iter_mut().zip(&lower).enumerate().take(Self::LANES) {
                for lane in 0..=r {
                    *pack = pack.with_lane(lane, lower.lane(lane));
                }
            }
            self.set_block::<W>(top, top, &block);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panel_of_any_size_is_transposed_and_mirrored() {
        for n in 1..=13 {
            let mut given = Panel::<f64>::zeros(n, n);
            (0..n).for_each(|i| (0..n).for_each(|j| given.set(i, j, (10 * i + j) as f64)));
            let (mut transposed, mut mirrored) = (Panel::zeros(n, n), given.clone());
            transposed.take_transpose::<0>(&given);
            mirrored.mirror_lower::<0>();
            for i in 0..n {
                for j in 0..n {
                    assert_eq!(transposed.get(i, j), given.get(j, i), "n = {n}");
                    assert_eq!(mirrored.get(i, j), given.get(i.max(j), i.min(j)), "n = {n}");
                }
            }
        }
    }
}
