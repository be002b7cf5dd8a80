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

/// q has [`Tree::nq`] finite entries, and its quaternions have length 1. With n entries it is refused by
/// name.
pub(crate) fn check_configuration<S: Scalar>(tree: &Tree, q: &[S]) -> Result<(), EvalError> {
    if q.len() == tree.dof() {
        // What knows nothing of quaternions passes as many entries as v has.
        tree.refuse_free()?;
    }
    check_length("q", q, tree.nq())?;
    if S::CHECKED
        && let Some(index) = q.iter().position(|value| !value.is_finite())
    {
        let joint = tree.joint_of_position(index).into();
        return Err(EvalError::NonFinite { what: "q", index, joint });
    }
    tree.check_unit(q)
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
