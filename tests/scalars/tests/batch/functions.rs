//! Functions of slices, as generators and compilers make them.

use crate::arrays::{Arrays, node};
use costate::batch::{Batch, Failure, NodeArray, NodeError, NodeFunction, Packed};
use costate::on_slices;
use costate::scalar::Scalar;
use costate_test_support::random_robot::difference;

/// F of a pendulum with a slider on it, as straight-line code: what a generator writes.
fn straight_line<S: Scalar>(x: &[S; 4], u: &[S; 2], f: &mut [S; 4]) {
    let (sin, cos) = x[0].sin_cos();
    let inertia = (x[1] * x[1]).times(2.0).plus(0.3);
    let rate = x[2] * inertia.recip();
    f[0] = rate;
    f[1] = x[3].times(0.5);
    f[2] = u[0] - (x[1] * sin).times(19.62);
    f[3] = (x[1] * rate).mul_add(rate.times(2.0), cos.times(19.62)) + u[1];
}

fn functions_are_evaluated<S: Packed<Lane = f64>>() {
    let nodes = 19;
    let Arrays { mut x, u, .. } = Arrays::new(4, 2, nodes);
    let function = on_slices!(S, straight_line, (x: 4, u: 2) -> (f: 4));
    let mut batch = Batch::<S, _>::new(NodeFunction::new(
        &[NodeArray::new("x", 4), NodeArray::new("u", 2)],
        &[NodeArray::new("f", 4)],
        function,
    ));
    let mut f = vec![0.0; nodes * 4];
    assert!(batch.run((), nodes, [&x, &u], [&mut f]).unwrap().is_empty());
    for k in 0..nodes {
        let mut expected = [0.0; 4];
        straight_line(
            node(&x, k, nodes).try_into().unwrap(),
            node(&u, k, nodes).try_into().unwrap(),
            &mut expected,
        );
        assert!(difference(node(&f, k, nodes), &expected) < 1e-14);
    }
    // A function refuses nothing: inputs that are not finite and results that overflow are found by the
    // batch.
    x[4 * 5] = f64::NAN;
    x[4 * 6 + 2] = 1e308;
    x[4 * 6 + 1] = 1e-3;
    let mut again = f.clone();
    let failures = batch.run((), nodes, [&x, &u], [&mut again]).unwrap();
    assert_eq!(failures.len(), 2);
    assert_eq!(failures[0], Failure { node: 5, error: NodeError::Input { what: "x", index: 0 } });
    assert_eq!(failures[1], Failure { node: 6, error: NodeError::Output { what: "f", index: 0 } });
    for k in 0..nodes {
        let (found, before) = (node(&again, k, nodes), node(&f, k, nodes));
        assert!(if k == 5 || k == 6 { found.iter().all(|x| x.is_nan()) } else { found == before });
    }
}

#[test]
fn straight_line_functions_are_evaluated_like_models() {
    functions_are_evaluated::<f64>();
    #[cfg(feature = "wide")]
    functions_are_evaluated::<costate::scalar::F64x4>();
    #[cfg(feature = "wide")]
    functions_are_evaluated::<costate::scalar::F64x8>();
}

/// A layout and a function that differ: nothing is written, and that is no success.
#[test]
fn a_function_of_other_lengths_than_its_layout_fails_at_every_node() {
    let function = on_slices!(f64, straight_line, (x: 4, u: 2) -> (f: 4));
    let mut batch = Batch::<f64, _>::new(NodeFunction::new(
        &[NodeArray::new("x", 4), NodeArray::new("u", 2)],
        &[NodeArray::new("f", 3)],
        function,
    ));
    let mut f = vec![0.0; 6];
    let failures = batch.run((), 2, [&[0.1; 8], &[0.2; 4]], [&mut f]).unwrap();
    assert_eq!(failures.len(), 2);
    assert!(f.iter().all(|f| f.is_nan()));
}
