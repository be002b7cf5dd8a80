//! Minimal convexification of the Hessian.
//!
//! The Hessian of the Lagrangian may have negative curvature along the linear dynamics far from a solution;
//! then the Newton step need not be a descent step. Each node's block is moved towards its positive part,
//! `H + share (H+ - H)`, with H+ the block with its negative eigenvalues set to zero. The share is zero where
//! that suffices, as near a solution that satisfies the second-order conditions, so that Newton's method
//! converges quadratically there.

use crate::barrier::Nodes;
use crate::riccati::{End, Factor, NotConvex, factorise};
use nalgebra::DMatrix;

/// The smallest nonzero share, and the factor between shares.
const LEAST: f64 = 1.0 / 64.0;
const FACTOR: f64 = 4.0;
/// The least eigenvalue of a positive part, relative to its largest.
const FLOOR: f64 = 1e-8;
/// Weight of a given end, relative to [`scale`]: a large weight misjudges fewer convex Hessians, a small one
/// keeps more digits.
const STIFFNESS: [f64; 4] = [1e2, 1e4, 1e6, 1e8];

/// A Hessian with the barrier's part, its factor, and the share of the positive parts in it.
pub struct Convex {
    pub hessian: Vec<DMatrix<f64>>,
    pub factor: Factor,
    pub share: f64,
}

/// Finds the smallest of the shares 0, ..., 1 that gives a convex problem. `last`: the previous share;
/// `least`: the first to try.
pub fn convexify(
    blocks: &[DMatrix<f64>],
    diagonal: &Nodes,
    jacobian: &[DMatrix<f64>],
    end_given: bool,
    last: f64,
    least: f64,
) -> Result<Convex, NotConvex> {
    let weight = scale(blocks, jacobian);
    let attempt = |blocks: &[DMatrix<f64>], share: f64| {
        let mut hessian = blocks.to_vec();
        for (block, diagonal) in hessian.iter_mut().zip(diagonal) {
            (0..diagonal.len()).for_each(|i| block[(i, i)] += diagonal[i]);
        }
        let ends = STIFFNESS.map(|stiffness| End::Given { weight: stiffness * weight });
        let ends = if end_given { &ends[..] } else { &[End::Free] };
        let mut result = Err(NotConvex { node: jacobian.len() });
        for &end in ends {
            result = factorise(&hessian, jacobian, end);
            if result.is_ok() {
                break;
            }
        }
        result.map(|factor| Convex { hessian, factor, share })
    };
    if least == 0.0
        && let Ok(found) = attempt(blocks, 0.0)
    {
        return Ok(found);
    }
    let positive: Vec<_> = blocks.iter().map(positive_part).collect();
    let mut share = (last / FACTOR).max(LEAST).max(least);
    loop {
        let mixed: Vec<_> = blocks
            .iter()
            .zip(&positive)
            .map(|(block, positive)| block + (positive - block) * share)
            .collect();
        match attempt(&mixed, share) {
            Err(_) if share < 1.0 => share = (share * FACTOR).min(1.0),
            result => return result,
        }
    }
}

/// The block with its negative eigenvalues set to (almost) zero.
fn positive_part(block: &DMatrix<f64>) -> DMatrix<f64> {
    let mut eigen = block.clone().symmetric_eigen();
    let floor = FLOOR * eigen.eigenvalues.amax();
    eigen.eigenvalues.apply(|value| *value = value.max(floor));
    eigen.recompose()
}

/// Curvature in the controls per square of what a control does to the next state.
fn scale(blocks: &[DMatrix<f64>], jacobian: &[DMatrix<f64>]) -> f64 {
    let n = jacobian[0].nrows();
    let mut curvature = 0.0_f64;
    let mut effect = 0.0_f64;
    for (block, jacobian) in blocks.iter().zip(jacobian) {
        for i in n..block.nrows() {
            curvature = curvature.max(block[(i, i)].abs());
            effect = effect.max(jacobian.column(i).norm_squared());
        }
    }
    curvature / effect.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::{convexify, positive_part};
    use nalgebra::{DMatrix, DVector};

    /// One state, one control, two intervals; curvature of the states as given, of the controls 1.
    fn share(curvature: f64, end_given: bool) -> f64 {
        let node = DMatrix::from_row_slice(2, 2, &[curvature, 0.0, 0.0, 1.0]);
        let blocks = [node.clone(), node, DMatrix::from_element(1, 1, 0.0)];
        let jacobian = vec![DMatrix::from_row_slice(1, 2, &[1.0, 1.0]); 2];
        let diagonal = vec![DVector::zeros(2), DVector::zeros(2), DVector::zeros(1)];
        convexify(&blocks, &diagonal, &jacobian, end_given, 0.0, 0.0).unwrap().share
    }

    #[test]
    fn blocks_are_touched_only_where_the_whole_is_not_convex() {
        // u_0 and u_1 = -u_0 bring x_1 = u_0: curvature 2 + c of the whole with a given end, 1 + c without.
        assert_eq!(share(-1.9, true), 0.0);
        assert_eq!(share(-0.9, false), 0.0);
        assert!(share(-2.5, true) > 0.0);
        assert!(share(-1.5, false) > 0.0);
    }

    #[test]
    fn a_positive_part_keeps_what_is_positive() {
        let block = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 1.0, 0.0]);
        let expected = DMatrix::from_element(2, 2, 0.5);
        assert!((positive_part(&block) - expected).amax() < 1e-7);
    }
}
