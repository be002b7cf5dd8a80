//! The factorisation against dense matrices.

use super::ChainMatrix;
use nalgebra::{DMatrix, DVector};

/// A random matrix with so many intervals, positive definite unless `shift` is negative, and the same one
/// dense.
fn random(intervals: usize, node: usize, inner: usize, shift: f64) -> (ChainMatrix, DMatrix<f64>) {
    let mut random = fastrand::Rng::with_seed(7);
    let mut matrix = ChainMatrix::new(node, inner);
    matrix.reset(intervals);
    matrix.inner_rows.iter_mut().chain(&mut matrix.node_rows).for_each(|entry| *entry = random.f64() - 0.5);
    let (size, nodes) = (matrix.size(), node * (intervals + 1));
    for at in 0..size {
        let place = if at < nodes {
            &mut matrix.node_rows[2 * node * at + at % node]
        } else {
            let row = at - nodes;
            &mut matrix.inner_rows[(inner + 2 * node) * row + row % inner]
        };
        *place += shift;
    }
    let dense = DMatrix::from_fn(size, size, |i, j| matrix.entry(i, j));
    (matrix, dense)
}

#[test]
fn solutions_are_those_of_the_dense_matrix() {
    for (intervals, node, inner) in [(1, 1, 1), (1, 5, 2), (2, 3, 4), (5, 6, 3), (4, 9, 5)] {
        let (mut matrix, dense) = random(intervals, node, inner, 3.0 * (2 * node + inner) as f64);
        assert_eq!(dense, dense.transpose());
        let expected = DVector::from_fn(matrix.size(), |i, _| (i as f64 * 0.7).sin());
        let mut found = &dense * &expected;
        matrix.factorise().unwrap();
        matrix.solve(found.as_mut_slice());
        assert!((found - expected).amax() < 1e-12);
    }
}

#[test]
fn removed_unknowns_have_the_row_of_the_identity() {
    for k in 0..3 {
        let (mut matrix, mut dense) = random(2, 3, 2, 1.0);
        let at = 3 * k + 1;
        let mut column = vec![0.0; matrix.size()];
        matrix.add_column(k, 1, 2.0, &mut column);
        assert!(column.iter().enumerate().all(|(i, entry)| *entry == 2.0 * dense[(i, at)]));
        matrix.remove(k, 1);
        dense.row_mut(at).fill(0.0);
        dense.column_mut(at).fill(0.0);
        dense[(at, at)] = 1.0;
        assert_eq!(DMatrix::from_fn(dense.nrows(), dense.ncols(), |i, j| matrix.entry(i, j)), dense);
    }
}

#[test]
fn a_matrix_that_is_not_positive_definite_is_refused() {
    let (mut matrix, dense) = random(3, 4, 2, -1.0);
    assert!(dense.symmetric_eigenvalues().min() < 0.0);
    assert!(matrix.factorise().is_err());
    let (mut matrix, _) = random(3, 4, 2, f64::NAN);
    assert!(matrix.factorise().is_err());
}
