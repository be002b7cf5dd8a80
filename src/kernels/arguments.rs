//! Checks of arguments.

use crate::error::{EvalError, check_length};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// `values` must have `expected` finite entries; entry i belongs to joint i mod n. No joint is floating or
/// spherical, and there are no constraints.
pub(crate) fn check<S: Scalar>(
    tree: &Tree,
    what: &'static str,
    values: &[S],
    expected: usize,
) -> Result<(), EvalError> {
    tree.refuse_free()?;
    tree.refuse_constraints()?;
    check_entries(tree, what, values, expected)
}

/// `values` must have `expected` finite entries; entry i belongs to joint i mod n.
pub(crate) fn check_entries<S: Scalar>(
    tree: &Tree,
    what: &'static str,
    values: &[S],
    expected: usize,
) -> Result<(), EvalError> {
    check_length(what, values, expected)?;
    match values.iter().position(|value| S::CHECKED && !value.is_finite()) {
        Some(index) => Err(EvalError::NonFinite { what, index, joint: tree.name(index % tree.dof()).into() }),
        None => Ok(()),
    }
}
