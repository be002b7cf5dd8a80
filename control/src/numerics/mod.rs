//! Linear algebra and integration that know nothing of optimal control.

pub(crate) mod almost_block_diagonal;
pub(crate) mod bordered;
pub(crate) mod chain;
pub(crate) mod chain_end;
pub(crate) mod cholesky;
pub(crate) mod dormand_prince;
pub(crate) mod gauss_kronrod;
pub(crate) mod knots;
pub(crate) mod lagrange;
pub(crate) mod lu;
pub(crate) mod padded;
mod products;
pub(crate) mod radau;
pub(crate) mod random;
pub(crate) mod roots;
mod substitution;
mod tiles;
