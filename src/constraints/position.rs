//! Checks of positions.

use crate::error::EvalError;
use crate::kernels::check_entries;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// A position has nq finite entries, its quaternions length 1.
pub(super) fn check_position<S: Scalar>(tree: &Tree, what: &'static str, q: &[S]) -> Result<(), EvalError> {
    if tree.free().is_empty() {
        check_entries(tree, what, q, tree.dof())
    } else {
        tree.check_configuration(q)
    }
}
