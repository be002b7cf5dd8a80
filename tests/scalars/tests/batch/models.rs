//! Models: nodes as if alone, in any number, on any tree, with numbers that carry derivatives.

use crate::arrays::{Arrays, NodeResults, agree, bounds, differing, node, one_by_one, robot};
use costate::batch::{Batch, FirstOrderArrays, Model, Packed, SecondOrderArrays};
use costate::configuration::ConfigurationSpace;
use costate::derivative::Function;
use costate::dynamics::{Automatic, QuaternionDynamics};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate::robot::Robot;
use costate::scalar::{Count, Scalar, Tangent};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases, difference, free_cases};

/// Any number of nodes, in both coordinates.
fn every_number_of_nodes<S: Packed<Lane = f64>>(allowed: f64) {
    for name in ["two_link.toml", "cart_pole.toml", "panda.urdf"] {
        let robot = robot(name);
        let n = robot.dof();
        let mut of_phase = Batch::<S, _>::new(Model(HamiltonianSecondOrder::new(&robot)));
        let mut of_velocity = Batch::<S, _>::new(Model(LagrangianSecondOrder::new(&robot)));
        for nodes in 0..=17 {
            let mut arrays = Arrays::new(2 * n, n, nodes);
            assert!(arrays.evaluate(&mut of_phase).is_empty());
            agree(&mut HamiltonianSecondOrder::new(&robot), &arrays, allowed);
            assert!(arrays.evaluate(&mut of_velocity).is_empty());
            agree(&mut LagrangianSecondOrder::new(&robot), &arrays, allowed);
        }
    }
}

#[test]
fn nodes_are_evaluated_as_if_alone() {
    every_number_of_nodes::<f64>(0.0);
}

#[cfg(feature = "wide")]
#[test]
fn nodes_in_lanes_are_evaluated_as_if_alone() {
    every_number_of_nodes::<costate::scalar::F64x4>(1e-12);
    every_number_of_nodes::<costate::scalar::F64x8>(1e-12);
}

/// Node k of the random robot: its state, scaled, or turned to a special pose.
fn nodes_of(case: &Case, robot: &Robot, nodes: usize) -> Arrays {
    let mut arrays = Arrays::default();
    for k in 0..nodes {
        let factor = 1.0 - 0.2 * k as f64;
        arrays.x.extend(&case.q);
        arrays.x.extend(case.p(robot).iter().map(|p| p * factor));
        arrays.u.extend(case.u.iter().map(|u| u * factor));
        arrays.y.extend(case.y.iter().map(|y| y * (k as f64 - 1.5)));
    }
    arrays
}

fn random_nodes<S: Packed<Lane = f64>>(case: &Case) {
    let robot = case.robot();
    let mut arrays = nodes_of(case, &robot, S::LANES + 3);
    let mut batch = Batch::<S, _>::new(Model(HamiltonianSecondOrder::new(&robot)));
    assert!(arrays.evaluate(&mut batch).is_empty());
    let allowed = bounds(&robot, &mut HamiltonianSecondOrder::<Count>::new(&robot), &arrays);
    let expected = one_by_one(&mut HamiltonianSecondOrder::<f64>::new(&robot), &arrays);
    assert_eq!(differing(&expected, &arrays, &allowed), None);
}

/// Another pose at every node, of the same robot with floating and spherical joints: x = (q, p), quaternions
/// as plain numbers; and x = (q, v).
fn random_nodes_of_free_joints<S: Packed<Lane = f64>>(case: &Case) {
    let robot = case.robot();
    let space = ConfigurationSpace::new(&robot);
    let nodes = S::LANES + 3;
    let mut arrays = Arrays::default();
    for k in 0..nodes {
        let factor = 0.4 * k as f64;
        let step: Vec<f64> = case.u.iter().map(|u| factor * u).collect();
        let mut q = case.q.clone();
        space.integrate(&case.q, &step, &mut q).unwrap();
        arrays.x.extend(&q);
        arrays.x.extend(case.v.iter().map(|v| v * (1.0 - 0.5 * factor)));
        arrays.u.extend(case.u.iter().map(|u| u * factor));
        arrays.y.extend(q.iter().zip(case.y.iter().cycle()).map(|(q, y)| (q + factor).sin() + y));
        arrays.y.extend(&case.y[case.n()..]);
    }
    let mut of_phase = Batch::<S, _>::new(Model(QuaternionDynamics::new(&robot)));
    assert!(arrays.evaluate(&mut of_phase).is_empty());
    let allowed = bounds(&robot, &mut QuaternionDynamics::<Count>::new(&robot), &arrays);
    let expected = one_by_one(&mut QuaternionDynamics::<f64>::new(&robot), &arrays);
    assert_eq!(differing(&expected, &arrays, &allowed), None);
    let mut of_velocity = Batch::<S, _>::new(Model(QuaternionDynamics::in_rates(&robot)));
    assert!(arrays.evaluate(&mut of_velocity).is_empty());
    let allowed = bounds(&robot, &mut QuaternionDynamics::<Count, _>::in_rates(&robot), &arrays);
    let expected = one_by_one(&mut QuaternionDynamics::<f64, _>::in_rates(&robot), &arrays);
    assert_eq!(differing(&expected, &arrays, &allowed), None);
    small_changes_are_found(&expected, &mut arrays, &allowed);
}

/// A change of one entry by three times what is allowed is found, in every result.
fn small_changes_are_found(expected: &[NodeResults], arrays: &mut Arrays, allowed: &[[f64; 8]]) {
    for which in 0..arrays.results.len() {
        let (before, (results, _)) = (arrays.results[which][0], &expected[0]);
        arrays.results[which][0] =
            results[which][0] + if allowed[0][which] == 0.0 { 1.0 } else { 3.0 * allowed[0][which] };
        assert!(differing(expected, arrays, allowed).is_some(), "result {which}");
        arrays.results[which][0] = before;
    }
}

properties! {
    24;

    #[test]
    fn nodes_of_robots_with_free_joints_are_evaluated_as_if_alone(case in free_cases(3)) {
        random_nodes_of_free_joints::<f64>(&case);
        #[cfg(feature = "wide")]
        random_nodes_of_free_joints::<costate::scalar::F64x4>(&case);
    }
}

properties! {
    48;

    #[test]
    fn nodes_of_any_tree_are_evaluated_as_if_alone(case in cases(6)) {
        random_nodes::<f64>(&case);
        #[cfg(feature = "wide")]
        random_nodes::<costate::scalar::F64x4>(&case);
        #[cfg(feature = "wide")]
        random_nodes::<costate::scalar::F64x8>(&case);
    }
}

#[test]
fn an_output_that_is_empty_is_not_asked_for() {
    let robot = robot("two_link.toml");
    let mut arrays = Arrays::new(4, 2, 7);
    let mut batch = Batch::<f64, _>::new(Model(HamiltonianSecondOrder::new(&robot)));
    arrays.evaluate(&mut batch);
    let mut f_x = vec![0.0; 7 * 16];
    let into = FirstOrderArrays { f_x: &mut f_x, ..Default::default() };
    assert!(batch.linearise(&arrays.x, &arrays.u, into).unwrap().is_empty());
    assert_eq!(f_x, arrays.results[1]);
    let mut xx = vec![0.0; 7 * 16];
    let into = SecondOrderArrays { xx: &mut xx, ..Default::default() };
    batch.contract([&arrays.x, &arrays.u, &arrays.y], FirstOrderArrays::default(), into).unwrap();
    assert_eq!(xx, arrays.results[3]);
}

/// Numbers with a derivative: f along a direction is f_x times it.
fn tangents_are_carried<S: Packed<Lane = f64>>() {
    let robot = robot("ur5.urdf");
    let nodes = 10;
    let mut arrays = Arrays::new(12, 6, nodes);
    arrays.evaluate(&mut Batch::<S, _>::new(Model(HamiltonianSecondOrder::new(&robot))));
    let mut batch = Batch::<Tangent<S>, _>::new(Model(HamiltonianSecondOrder::new(&robot)));
    let x: Vec<_> = arrays.x.iter().zip(&arrays.y).map(|(&x, &d)| Tangent::new(x, d)).collect();
    let u: Vec<_> = arrays.u.iter().map(|&u| Tangent::new(u, 0.0)).collect();
    let mut f = vec![Tangent::new(0.0, 0.0); nodes * 12];
    assert!(batch.evaluate(&x, &u, &mut f).unwrap().is_empty());
    for k in 0..nodes {
        let (d, f_x) = (node(&arrays.y, k, nodes), node(&arrays.results[1], k, nodes));
        let product = f_x.chunks(12).map(|row| row.iter().zip(d).map(|(a, b)| a * b).sum::<f64>());
        let along: Vec<f64> = f[12 * k..12 * (k + 1)].iter().map(|f| f.eps).collect();
        assert!(difference(&along, &product.collect::<Vec<_>>()) < 1e-11);
    }
}

#[test]
fn dual_numbers_go_through_a_batch() {
    tangents_are_carried::<f64>();
    #[cfg(feature = "wide")]
    tangents_are_carried::<costate::scalar::F64x4>();
    #[cfg(feature = "wide")]
    tangents_are_carried::<costate::scalar::F64x8>();
}

/// A pendulum whose torque is squared: automatic derivatives, all blocks of second derivatives there.
#[derive(Clone)]
struct Pendulum;

impl Function for Pendulum {
    type Workspace<S: Scalar> = ();
    type Error = std::convert::Infallible;
    fn inputs(&self) -> usize {
        3
    }
    fn outputs(&self) -> usize {
        2
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, (): &mut (), z: &[S], f: &mut [S]) -> Result<(), Self::Error> {
        let (sin, _) = z[0].sin_cos();
        f.copy_from_slice(&[z[1], z[2] * z[2] * z[0] - sin.times(9.81)]);
        Ok(())
    }
}

#[test]
fn automatic_models_are_models() {
    let model = || -> Automatic<_> { Automatic::new(Pendulum) };
    let mut arrays = Arrays::new(2, 1, 6);
    assert!(arrays.evaluate(&mut Batch::<f64, _>::new(Model(model()))).is_empty());
    agree(&mut model(), &arrays, 0.0);
    let [.., ux, uu] = &arrays.results;
    assert!(ux.chunks(2).all(|row| row[0] != 0.0 && row[1] == 0.0) && uu.iter().all(|entry| *entry != 0.0));
}
