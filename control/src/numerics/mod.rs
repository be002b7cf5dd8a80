//! TODO.

pub(crate) mod almost_block_diagonal;
pub(crate) mod dormand_prince;
pub(crate) mod lu;
