//! Jacobians and Hessians in (x, u) as one matrix each, row by row.

use crate::matrix::Block;
use crate::scalar::Scalar;

/// `[ in_x in_u ]`, truncated to the length of the slice.
pub(crate) fn jacobian<S: Scalar>(in_x: Block<'_, S>, in_u: Block<'_, S>, matrix: &mut [S]) {
    let entries = in_x.iter_rows().zip(in_u.iter_rows()).flat_map(|(x, u)| x.iter().chain(u));
    matrix.iter_mut().zip(entries).for_each(|(to, from)| *to = *from);
}

/// `[ xx ux' ; ux uu ]`, for a slice of (states + controls)^2 numbers; ux is zero in the states beyond its
/// columns.
pub(crate) fn hessian<S: Scalar>(
    [xx, ux, uu]: [Option<Block<'_, S>>; 3],
    [states, controls]: [usize; 2],
    matrix: &mut [S],
) {
    let width = states + controls;
    matrix.fill(S::zero());
    for (block, [top, left]) in [(xx, [0, 0]), (ux, [states, 0]), (uu, [states, states])] {
        for (i, row) in block.iter().flat_map(|block| block.iter_rows()).enumerate() {
            for (j, &entry) in row.iter().enumerate() {
                matrix[(top + i) * width + left + j] = entry;
                if top != left {
                    matrix[(left + j) * width + top + i] = entry;
                }
            }
        }
    }
}
