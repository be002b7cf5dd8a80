//! Almost block diagonal elimination against dense elimination.

use costate_control::AlmostBlockDiagonal;
use nalgebra::{DMatrix, DVector};

fn random(m: usize, first: usize, blocks: usize, seed: u64) -> (AlmostBlockDiagonal, DMatrix<f64>) {
    let mut random = fastrand::Rng::with_seed(seed);
    // Sizes over several powers of ten, so that rows must be exchanged.
    let mut number = || (2.0 * random.f64() - 1.0) * 10.0_f64.powi(random.i32(-3..3));
    let mut sparse = AlmostBlockDiagonal::zeros(m, first, blocks);
    let mut dense = DMatrix::zeros(sparse.size(), sparse.size());
    for r in 0..first {
        for c in 0..m {
            dense[(r, c)] = number();
            sparse.left_mut()[r * m + c] = dense[(r, c)];
        }
    }
    for k in 0..blocks {
        for r in 0..m {
            for c in 0..2 * m {
                let at = (first + k * m + r, k * m + c);
                dense[at] = number();
                sparse.block_row_mut(k, r)[c] = dense[at];
            }
        }
    }
    for r in 0..m - first {
        for c in 0..m {
            let at = (first + blocks * m + r, blocks * m + c);
            dense[at] = number();
            sparse.right_mut()[r * m + c] = dense[at];
        }
    }
    (sparse, dense)
}

#[test]
fn solutions_agree_with_dense_elimination() {
    for (m, first, blocks) in
        [(1, 0, 3), (1, 1, 2), (2, 1, 1), (5, 2, 7), (4, 4, 6), (8, 0, 5), (9, 4, 20), (3, 2, 0)]
    {
        for seed in 0..5 {
            let (mut sparse, dense) = random(m, first, blocks, seed);
            let b = DVector::from_fn(sparse.size(), |i, _| (i as f64).sin());
            let mut x = b.as_slice().to_vec();
            sparse.factor().unwrap();
            sparse.solve(&mut x);
            let judge = dense.clone().lu().solve(&b).unwrap();
            let residual = (&dense * DVector::from_vec(x.clone()) - &b).amax();
            let scale = dense.amax() * judge.amax();
            assert!(residual < 1e-13 * scale, "{m} {first} {blocks}: {residual} of {scale}");
            let difference = (DVector::from_vec(x) - &judge).amax();
            let condition = dense.clone().svd(false, false).singular_values;
            let condition = condition.max() / condition.min();
            assert!(difference < 1e-14 * condition * judge.amax(), "{difference}, condition {condition}");
        }
    }
}

#[test]
fn a_singular_matrix_is_an_error() {
    let mut matrix = AlmostBlockDiagonal::zeros(2, 1, 2);
    assert_eq!(matrix.factor().map_err(|singular| singular.node), Err(0));
    matrix.left_mut().copy_from_slice(&[1.0, f64::NAN]);
    assert!(matrix.factor().is_err());
}
