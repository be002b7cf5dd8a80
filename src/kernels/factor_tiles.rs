//! What is computed of the factors of the mass matrix, block by block.

use super::triangle::Triangle;
use crate::matrix::{Panel, Part, Pattern, Terms, Tiles};
use crate::scalar::Scalar;

/// What is computed of the factors, and where the entries of `U = L^-1` are.
#[derive(Clone, Debug)]
pub(super) struct FactorTiles {
    /// `sum_k L_ki row_k`, rows k of other blocks, on and below the diagonal.
    pub eliminate: Tiles,
    /// The same for the rows of U'.
    pub invert: Tiles,
    /// `R R'`, `R = U D^-1/2`.
    pub inverse: Tiles,
    /// Packs of the rows of a block that hold entries of L, and of U'.
    pub lower: Packs,
    pub upper: Packs,
    /// Blocks of rows of U' with entries in a pack.
    pub upper_across: Packs,
}

/// Some packs of each block of rows.
#[derive(Clone, Debug)]
pub(super) struct Packs {
    starts: Vec<usize>,
    packs: Vec<usize>,
}

impl Packs {
    /// Those that hold an entry of the pattern.
    fn new(lanes: usize, pattern: &Pattern) -> Self {
        let n = pattern.size();
        let lanes_of = |block: usize| lanes * block..(lanes * (block + 1)).min(n);
        let (mut starts, mut packs) = (vec![0], Vec::new());
        for block in 0..n.div_ceil(lanes) {
            let columns = pattern.columns_of(lanes_of(block));
            let has = |j: usize| columns[j / 64] >> (j % 64) & 1 == 1;
            packs.extend((0..n.div_ceil(lanes)).filter(|&pack| lanes_of(pack).any(has)));
            starts.push(packs.len());
        }
        Self { starts, packs }
    }

    /// Packs of this block of rows, ascending.
    #[inline(always)]
    pub fn of(&self, block: usize) -> &[usize] {
        &self.packs[self.starts[block]..self.starts[block + 1]]
    }
}

impl FactorTiles {
    pub fn new<S: Scalar>(l: &Triangle<S>) -> Self {
        let lanes = Panel::<S>::LANES;
        let (below, lower, upper) =
            (l.pattern(), l.pattern().with_diagonal(), l.inverse_pattern().transposed());
        let across = below.transposed();
        Self {
            eliminate: Tiles::new::<S>(&across, &lower, Part::Lower, Terms::OtherBlocks),
            invert: Tiles::new::<S>(&across, &upper, Part::Whole, Terms::OtherBlocks),
            inverse: Tiles::new::<S>(&upper.transposed(), &upper, Part::Lower, Terms::All),
            lower: Packs::new(lanes, &lower),
            upper: Packs::new(lanes, &upper),
            upper_across: Packs::new(lanes, &upper.transposed()),
        }
    }
}
