//! Accelerations and forces in (q, v, u) against automatic differentiation and the Hamiltonian state
//! equation.

use super::samples::{looped, state};
use super::*;
use crate::robot::{Robot, Wrench, WrenchAxes};
use crate::scalar::Scalar;
use nalgebra::DMatrix;
use num_dual::HyperDual64;

fn lift<S: Scalar>(a: &[f64]) -> Vec<S> {
    a.iter().map(|&a| S::from_f64(a)).collect()
}

/// The robots, a wrench on one of them.
fn loaded() -> Vec<Robot> {
    let mut robots = looped();
    let wrench = Wrench { moment: [1.0, -2.0, 0.5], force: [3.0, 1.0, -4.0], axes: WrenchAxes::Local };
    robots[1] = robots[1].with_wrench("g", wrench).unwrap();
    robots
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers() {
    for robot in loaded() {
        let n = robot.dof();
        let [q, v, u, y] = state(n);
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
                let mut z: Vec<HyperDual64> = lift(&[&q[..], &v, &u].concat());
                z[i].eps1 = 1.0;
                z[j].eps2 = 1.0;
                let (found_a, found_lambda) = judge.evaluate(&z[..n], &z[n..2 * n], &z[2 * n..]).unwrap();
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
        let [q, p, u, _] = state(robot.dof());
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
