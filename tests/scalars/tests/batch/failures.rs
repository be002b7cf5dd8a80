//! Bad nodes and arrays that do not fit.

use crate::arrays::{Arrays, gimbal, node, robot};
use costate::batch::{ArrayRole, Batch, BatchError, Model, ModelQuantity, NodeError, Packed};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::{EvalError, LengthError};
use std::f64::consts::FRAC_PI_2;

/// Bad nodes among good ones: each is named, its outputs are not-a-number, and the others are what they are
/// without it.
fn nothing_is_lost<S: Packed<Lane = f64>>() {
    let robot = gimbal();
    let nodes = 21;
    let mut good = Arrays::new(6, 3, nodes);
    let mut batch = Batch::<S, _>::new(Model(HamiltonianSecondOrder::new(&robot)));
    assert!(good.evaluate(&mut batch).is_empty());
    for bad in [vec![0], vec![20], vec![3, 4, 11], (0..nodes).collect::<Vec<_>>()] {
        let mut arrays = good.clone();
        for &k in &bad {
            match k % 3 {
                0 => arrays.x[6 * k + 1] = FRAC_PI_2,
                1 => arrays.u[3 * k + 2] = f64::INFINITY,
                _ => arrays.x[6 * k + 4] = f64::NAN,
            }
        }
        let failures = arrays.evaluate(&mut batch);
        assert_eq!(failures.iter().map(|failure| failure.node).collect::<Vec<_>>(), bad);
        for failure in &failures {
            let NodeError::Evaluation(error) = &failure.error else { panic!("{failure}") };
            let as_expected = match failure.node % 3 {
                0 => matches!(error, EvalError::SingularMassMatrix { .. }),
                1 => matches!(error, EvalError::NonFinite { what: "u", index: 2, .. }),
                _ => matches!(error, EvalError::NonFinite { what: "p", index: 1, .. }),
            };
            assert!(as_expected, "{failure}");
        }
        for (found, expected) in arrays.results.iter().zip(&good.results) {
            for k in 0..nodes {
                let (found, expected) = (node(found, k, nodes), node(expected, k, nodes));
                if bad.contains(&k) {
                    assert!(found.iter().all(|entry| entry.is_nan()));
                } else {
                    assert_eq!(found, expected, "node {k} beside {bad:?}");
                }
            }
        }
    }
    assert!(good.clone().evaluate(&mut batch).is_empty(), "failures of one call are forgotten in the next");
}

#[test]
fn bad_nodes_cost_no_other_node() {
    nothing_is_lost::<f64>();
    #[cfg(feature = "wide")]
    nothing_is_lost::<costate::scalar::F64x4>();
    #[cfg(feature = "wide")]
    nothing_is_lost::<costate::scalar::F64x8>();
}

#[test]
fn arrays_that_do_not_fit_are_refused_and_left_alone() {
    let mut batch = Batch::<f64, _>::new(Model(HamiltonianSecondOrder::new(&robot("two_link.toml"))));
    let (x, u, mut f) = (vec![0.1; 12], vec![0.2; 6], vec![7.0; 12]);
    let wrong = |what, length: usize, found| BatchError::WrongLength {
        nodes: 3,
        length: LengthError { what, expected: 3 * length, found },
    };
    assert_eq!(batch.evaluate(&x, &u[..5], &mut f).unwrap_err(), wrong("u", 2, 5));
    assert_eq!(batch.evaluate(&x, &u, &mut f[..11]).unwrap_err(), wrong("f", 4, 11));
    assert_eq!(batch.run(ModelQuantity::Value, 3, [&x[..11], &u], [&mut f]).unwrap_err(), wrong("x", 4, 11));
    let error = batch.run(ModelQuantity::Value, 3, [&x], [&mut f]).unwrap_err();
    assert_eq!(error, BatchError::WrongNumber { role: ArrayRole::Input, expected: 2, found: 1 });
    assert_eq!(error.to_string(), "the quantity has 2 inputs, not 1; its layout names them in order");
    let error = batch.run(ModelQuantity::Linearisation, 3, [&x, &u], [&mut f]).unwrap_err();
    assert_eq!(error, BatchError::WrongNumber { role: ArrayRole::Output, expected: 3, found: 1 });
    assert_eq!(f, vec![7.0; 12]);
    assert!(batch.evaluate(&x, &u, &mut f).unwrap().is_empty() && f[11] != 7.0);
    assert!(batch.evaluate(&[], &[], &mut []).unwrap().is_empty(), "no nodes are none too many");
}
