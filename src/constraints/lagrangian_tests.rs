//! Accelerations and forces in (q, v, u) against automatic differentiation and the Hamiltonian state
//! equation.

use super::free_tests::held;
use super::samples::looped;
use super::*;
use crate::configuration::ConfigurationSpace;
use crate::configuration::samples::state;
use crate::lagrangian::Lagrangian;
use crate::robot::{Robot, Wrench, WrenchAxes};
use crate::scalar::Scalar;
use nalgebra::DMatrix;
use num_dual::HyperDual64;

fn lift<S: Scalar>(a: &[f64]) -> Vec<S> {
    a.iter().map(|&a| S::from_f64(a)).collect()
}

/// Robots of all kinds of joints, a wrench on one of them.
fn loaded() -> Vec<Robot> {
    let mut robots = looped();
    let wrench = Wrench { moment: [1.0, -2.0, 0.5], force: [3.0, 1.0, -4.0], axes: WrenchAxes::Local };
    robots[1] = robots[1].with_wrench("g", wrench).unwrap();
    robots.into_iter().chain(held()).collect()
}

/// a and lambda at (q (+) xi, v + dv, u + du).
fn displaced<S: Scalar>(
    judge: &mut ConstrainedLagrangian<S>,
    space: &ConfigurationSpace,
    [q, v, u]: [&[f64]; 3],
    z: &[S],
) -> [Vec<S>; 2] {
    let (n, mut moved) = (v.len(), lift(q));
    space.integrate(&lift(q), &z[..n], &mut moved).unwrap();
    let add = |to: &[f64], by: &[S]| -> Vec<S> { to.iter().zip(by).map(|(&a, &b)| b.plus(a)).collect() };
    let (v, u) = (add(v, &z[n..2 * n]), add(u, &z[2 * n..]));
    let (a, lambda) = judge.evaluate(&moved, &v, &u).unwrap();
    [a.to_vec(), lambda.to_vec()]
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers() {
    for robot in loaded() {
        let (n, space) = (robot.dof(), ConfigurationSpace::new(&robot));
        let [q, v, u, y] = state(&space);
        let e = &y[..n];
        let mut second = ConstrainedLagrangianSecondOrder::<f64>::new(&robot);
        let k = second.constrained().constraints().count();
        let c: Vec<f64> = (0..k).map(|i| (0.4 + 1.3 * i as f64).cos()).collect();
        let all = second.contract([&q, &v, &u], e, &c).unwrap();
        let linear = all.linearisation();
        let (a, lambda) = (linear.acceleration().to_vec(), linear.lambda().to_vec());
        let (a_z, lambda_z) = (linear.a_z().to_nalgebra(), linear.lambda_z().to_nalgebra());
        let zz = all.matrix().to_nalgebra();
        let size = 1.0 + lambda_z.iter().fold(a_z.amax(), |most, entry| most.max(entry.abs()));
        let mut judge = ConstrainedLagrangian::<HyperDual64>::new(&robot);
        let mut expected_zz = DMatrix::zeros(3 * n, 3 * n);
        for i in 0..3 * n {
            for j in 0..=i {
                let mut z: Vec<HyperDual64> = lift(&vec![0.0; 3 * n]);
                z[i].eps1 = 1.0;
                z[j].eps2 = 1.0;
                let [found_a, found_lambda] = displaced(&mut judge, &space, [&q, &v, &u], &z);
                let mut entry = 0.0;
                for (l, found) in found_a.iter().enumerate() {
                    assert!((found.re - a[l]).abs() < 1e-12 * size, "a {l}");
                    assert!((found.eps1 - a_z[(l, i)]).abs() < 1e-11 * size, "a_z {l} {i}");
                    entry += e[l] * found.eps1eps2;
                }
                for (l, found) in found_lambda.iter().enumerate() {
                    assert!((found.re - lambda[l]).abs() < 1e-12 * size, "lambda {l}");
                    assert!((found.eps1 - lambda_z[(l, i)]).abs() < 1e-11 * size, "lambda_z {l} {i}");
                    entry += c[l] * found.eps1eps2;
                }
                (expected_zz[(i, j)], expected_zz[(j, i)]) = (entry, entry);
            }
        }
        let worst = (&zz - &expected_zz).amax();
        assert!(worst < 1e-11 * expected_zz.amax(), "{}: {worst} of {}", robot.name(), expected_zz.amax());
        let first = second.first().linearise(&q, &v, &u).unwrap();
        assert_eq!(first.a_z().to_nalgebra(), a_z);
        assert_eq!(first.lambda_u().to_nalgebra(), lambda_z.columns(2 * n, n).into_owned());
    }
}

/// Where J v = 0 the two forms of the equations have the same accelerations and forces.
#[test]
fn at_allowed_velocities_the_results_are_those_of_the_hamiltonian() {
    for robot in loaded() {
        let [q, p, u, _] = state(&ConfigurationSpace::new(&robot));
        let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(&robot);
        let linear = hamiltonian.linearise(&q, &p, &u).unwrap();
        let v = linear.velocity().to_vec();
        let mut lagrangian = ConstrainedLagrangian::<f64>::new(&robot);
        let (a, lambda) = lagrangian.evaluate(&q, &v, &u).unwrap();
        let expected = [linear.acceleration(), linear.lambda()].concat();
        let size = expected.iter().fold(1.0_f64, |most, entry| most.max(entry.abs()));
        for (i, (found, expected)) in a.iter().chain(lambda).zip(&expected).enumerate() {
            assert!((found - expected).abs() < 1e-11 * size, "{}: {i}", robot.name());
        }
    }
}

/// The open tree with the forces of the constraints on its joints has these accelerations, and the place of
/// the rows along the motion has no second derivative.
#[test]
fn forces_and_accelerations_satisfy_their_equations() {
    for robot in loaded() {
        let (n, space) = (robot.dof(), ConfigurationSpace::new(&robot));
        let [q, v, u, _] = state(&space);
        let mut lagrangian = ConstrainedLagrangian::<f64>::new(&robot);
        let (a, lambda) = lagrangian.evaluate(&q, &v, &u).unwrap();
        let (a, lambda) = (a.to_vec(), lambda.to_vec());
        let kept = lagrangian.hamiltonian().counted().to_vec();
        let jacobian = lagrangian.constraints().jacobian().view().to_nalgebra();
        let mut open = Lagrangian::<f64>::new(&robot.without_constraints());
        let torque = open.inverse_dynamics(&q, &v, &a).unwrap();
        let size = 1.0 + torque.iter().chain(&lambda).fold(0.0_f64, |most, tau| most.max(tau.abs()));
        for i in 0..n {
            let given = u[i] + (0..lambda.len()).map(|l| jacobian[(l, i)] * lambda[l]).sum::<f64>();
            assert!((torque[i] - given).abs() < 1e-12 * size, "{}: joint {i}", robot.name());
        }
        // q (+) (v t + a t^2 / 2): eps1 eps2 is the second derivative.
        let both = |i: usize| HyperDual64::new(0.0, v[i], v[i], a[i]);
        let mut moved = lift(&q);
        space.integrate(&lift(&q), &(0..n).map(both).collect::<Vec<_>>(), &mut moved).unwrap();
        let mut rows = Constraints::<HyperDual64>::new(&robot);
        rows.set_position(&moved).unwrap();
        for (l, g) in rows.values().iter().enumerate().filter(|(l, _)| kept[*l] > 0.0) {
            assert!(g.eps1eps2.abs() < 1e-10 * size, "{}: row {l}: {}", robot.name(), g.eps1eps2);
        }
    }
}
