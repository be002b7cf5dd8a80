//! Quantities, and the size of batches.

/// The quantities, as the list of `costate bench` calls them.
pub const FUNCTION: &str = "F";
pub const FIRST: &str = "F, F_x";
pub const SECOND: &str = "F, F_x, y'F_xx";

/// States of one call of a batch.
pub const NODES: usize = 16;
