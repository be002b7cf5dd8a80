//! Steps from many nodes.

use crate::arrays::{Arrays, node, robot};
use costate::batch::{Batch, Failure, NodeError, Packed, SecondOrderArrays, StepArrays, StepMap};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::matrix::Block;
use costate::step::{ImplicitMidpoint, RungeKutta4, Step, StepError};
use costate_test_support::random_robot::difference;

/// Steps at every node, each with its own duration, against single steps.
fn steps_are_steps<S: Packed<Lane = f64>>(allowed: f64) {
    let robot = robot("ur5.urdf");
    let model = || HamiltonianSecondOrder::<S>::new(&robot);
    check(
        StepMap(RungeKutta4::new(model())),
        RungeKutta4::new(HamiltonianSecondOrder::<f64>::new(&robot)),
        allowed,
    );
    check(
        StepMap(ImplicitMidpoint::new(model())),
        ImplicitMidpoint::new(HamiltonianSecondOrder::<f64>::new(&robot)),
        allowed,
    );

    fn check<S, P, A>(map: StepMap<P>, mut alone: A, allowed: f64)
    where
        S: Packed<Lane = f64>,
        P: Step<S, Error: Send> + Send,
        A: Step<f64>,
    {
        let nodes = 11;
        let Arrays { mut x, u, y, .. } = Arrays::new(12, 6, nodes);
        // Momenta that the wrist turns at a few rad/s with.
        x.chunks_mut(12).for_each(|x| x[6..].iter_mut().for_each(|p| *p *= 1e-3));
        let h: Vec<f64> = (0..nodes).map(|k| 0.001 * (k + 1) as f64).collect();
        let zeros = |length: usize| vec![7.0; nodes * length];
        let (mut next, mut phi_x, mut phi_u, mut phi_h) = (zeros(12), zeros(144), zeros(72), zeros(12));
        let (mut xx, mut ux, mut uu) = (zeros(144), zeros(72), zeros(36));
        let first = StepArrays { next: &mut next, phi_x: &mut phi_x, phi_u: &mut phi_u, phi_h: &mut phi_h };
        let second = SecondOrderArrays { xx: &mut xx, ux: &mut ux, uu: &mut uu };
        let mut batch = Batch::<S, _>::new(map);
        assert!(batch.contract([&x, &u, &h, &y], first, second).unwrap().is_empty());
        let flat = |block: Block<'_, f64>| block.iter_rows().flatten().copied().collect::<Vec<_>>();
        for (k, &h) in h.iter().enumerate() {
            let at = |array: &Vec<f64>| node(array, k, nodes).to_vec();
            let one = alone.contract(&at(&x), &at(&u), h, &at(&y)).unwrap();
            for (found, expected) in [
                (at(&next), one.first.next.to_vec()),
                (at(&phi_x), flat(one.first.phi_x)),
                (at(&phi_u), flat(one.first.phi_u)),
                (at(&phi_h), one.first.phi_h.to_vec()),
                (at(&xx), flat(one.xx)),
                (at(&ux), one.ux.map_or(vec![0.0; 72], flat)),
                (at(&uu), one.uu.map_or(vec![0.0; 36], flat)),
            ] {
                let difference = difference(&found, &expected);
                assert!(difference <= allowed, "node {k}: {difference:e}");
            }
        }
        let (mut alone, mut jacobian) = (zeros(12), zeros(144));
        assert!(batch.evaluate([&x, &u, &h], &mut alone).unwrap().is_empty());
        assert!(difference(&alone, &next) <= allowed);
        let into = StepArrays { phi_x: &mut jacobian, ..Default::default() };
        assert!(batch.linearise([&x, &u, &h], into).unwrap().is_empty());
        assert!(difference(&jacobian, &phi_x) <= allowed);
    }
}

#[test]
fn steps_from_many_nodes_are_steps_from_each() {
    steps_are_steps::<f64>(0.0);
    #[cfg(feature = "wide")]
    steps_are_steps::<costate::scalar::F64x4>(1e-11);
    #[cfg(feature = "wide")]
    steps_are_steps::<costate::scalar::F64x8>(1e-11);
}

/// A step that cannot be solved is its own failure: the nodes in the lanes beside it are stepped.
fn a_step_fails_alone<S: Packed<Lane = f64>>() {
    let robot = robot("two_link.toml");
    let Arrays { x, u, .. } = Arrays::new(4, 2, 9);
    let mut h = vec![0.01; 9];
    let mut batch = Batch::<S, _>::new(StepMap(ImplicitMidpoint::new(HamiltonianSecondOrder::new(&robot))));
    let mut expected = vec![0.0; 36];
    assert!(batch.evaluate([&x, &u, &h], &mut expected).unwrap().is_empty());
    (h[2], h[7]) = (f64::NAN, 1e3);
    let mut next = vec![0.0; 36];
    let failures = batch.evaluate([&x, &u, &h], &mut next).unwrap();
    assert!(matches!(
        &failures[0],
        Failure { node: 2, error: NodeError::Evaluation(StepError::NonFiniteDuration) }
    ));
    assert!(matches!(
        &failures[1],
        Failure { node: 7, error: NodeError::Evaluation(StepError::NotConverged { .. }) }
    ));
    for k in 0..9 {
        if failures.iter().any(|failure| failure.node == k) {
            assert!(node(&next, k, 9).iter().all(|entry| entry.is_nan()));
        } else {
            assert!(difference(node(&next, k, 9), node(&expected, k, 9)) < 1e-13);
        }
    }
}

#[test]
fn a_step_that_is_not_solved_costs_no_other_node() {
    a_step_fails_alone::<f64>();
    #[cfg(feature = "wide")]
    a_step_fails_alone::<costate::scalar::F64x4>();
    #[cfg(feature = "wide")]
    a_step_fails_alone::<costate::scalar::F64x8>();
}
