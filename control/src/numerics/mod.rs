//! Linear algebra and integration that know nothing of optimal control.

pub(crate) mod almost_block_diagonal;
pub(crate) mod bordered;
pub(crate) mod chain;
pub(crate) mod cholesky;
pub(crate) mod dormand_prince;
pub(crate) mod knots;
pub(crate) mod lagrange;
pub(crate) mod lu;
pub(crate) mod padded;
mod products;
mod substitution;
mod tiles;
pub(crate) mod widest;
