//! The constrained state equation against automatic differentiation and dense matrices.

use super::samples::{four_bar, looped, state, tied_chains};
use super::*;
use crate::error::EvalError;
use crate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use crate::lagrangian::Lagrangian;
use crate::robot::{Robot, Wrench, WrenchAxes};
use crate::scalar::Scalar;
use nalgebra::{DMatrix, DVector};
use num_dual::{Dual64, HyperDual64};

fn lift<S: Scalar>(a: &[f64]) -> Vec<S> {
    a.iter().map(|&a| S::from_f64(a)).collect()
}

/// The robots, a wrench on one of them.
fn loaded() -> Vec<Robot> {
    let mut robots = looped();
    let wrench = Wrench { moment: [1.0, -2.0, 0.5], force: [3.0, 1.0, -4.0], axes: WrenchAxes::Local };
    robots[2] = robots[2].with_wrench("g", wrench).unwrap();
    robots.push(tied_chains());
    robots
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers() {
    for robot in loaded() {
        let n = robot.dof();
        let [q, p, u, y] = state(n);
        let mut second = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
        let all = second.contract(&q, &p, &u, &y).unwrap();
        let linear = all.linearisation();
        let (f, f_x) = (linear.f().to_vec(), linear.matrix().to_nalgebra());
        let (mu, mu_x) = (linear.mu().to_vec(), linear.mu_x().to_nalgebra());
        let y_f_xx = all.matrix().to_nalgebra();
        let mut judge = ConstrainedHamiltonian::<HyperDual64>::new(&robot);
        let (size_x, size_xx) = (f_x.amax(), y_f_xx.amax());
        for i in 0..2 * n {
            for j in 0..=i {
                let mut x: Vec<HyperDual64> = lift(&[&q[..], &p].concat());
                x[i].eps1 = 1.0;
                x[j].eps2 = 1.0;
                let rate = judge.evaluate(&x[..n], &x[n..], &lift(&u)).unwrap();
                let name = robot.name();
                for (k, found) in rate.f.iter().enumerate() {
                    assert!((found.re - f[k]).abs() < 1e-12 * size_x, "{name}: F {k}");
                    assert!((found.eps1 - f_x[(k, i)]).abs() < 1e-11 * size_x, "{name}: F_x {k} {i}");
                }
                for (k, found) in rate.mu.iter().enumerate() {
                    assert!((found.re - mu[k]).abs() < 1e-11 * (1.0 + mu_x.amax()), "{name}: mu {k}");
                    assert!((found.eps1 - mu_x[(k, i)]).abs() < 1e-11 * (1.0 + mu_x.amax()), "{name}: mu_x");
                }
                let expected: f64 = rate.f.iter().zip(&y).map(|(f, y)| f.eps1eps2 * y).sum();
                for found in [y_f_xx[(i, j)], y_f_xx[(j, i)]] {
                    assert!(
                        (found - expected).abs() < 1e-11 * size_xx,
                        "{name}: {i} {j}: {found} {expected}"
                    );
                }
            }
        }
        let d: Vec<f64> = (0..2 * n).map(|i| (0.7 + i as f64).cos()).collect();
        let product = DVector::from_column_slice(second.hessian_product(&q, &p, &y, &d).unwrap());
        assert!((product - &y_f_xx * DVector::from_vec(d)).amax() < 1e-11 * size_xx);
        let first = second.first().linearise(&q, &p, &u).unwrap();
        // Blocks take another route beyond twelve joints.
        assert!((first.matrix().to_nalgebra() - &f_x).amax() < 1e-12 * size_x);
        let adjoint = second.first().adjoint(&q, &p, &u, &y).unwrap();
        let expected = f_x.transpose() * DVector::from_vec(y);
        assert!((DVector::from_column_slice(adjoint.y_f_x) - expected).amax() < 1e-11 * size_x);
        assert!(adjoint.f.iter().zip(&f).all(|(a, b)| (a - b).abs() < 1e-13 * size_x));
    }
}

/// What a workspace computed before leaves nothing behind: the same bits as of a new one.
#[test]
fn states_before_leave_nothing_behind() {
    let robot = tied_chains();
    let [q, p, u, y] = state(robot.dof());
    let mut used = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
    let before = [&q, &p, &u].map(|x| x.iter().map(|x| 0.3 - 2.0 * x).collect::<Vec<_>>());
    let mut new = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
    used.contract(&before[0], &before[1], &before[2], &y).unwrap();
    used.first().linearise(&before[0], &before[1], &before[2]).unwrap();
    let [again, once] = [&mut used, &mut new].map(|second| {
        let first = second.first().linearise(&q, &p, &u).unwrap();
        let [f_x, mu_x] = [first.matrix(), first.mu_x()].map(|matrix| matrix.to_nalgebra());
        [f_x, mu_x, second.contract(&q, &p, &u, &y).unwrap().matrix().to_nalgebra()]
    });
    assert!(once.iter().all(|matrix| matrix.amax() > 0.0) && again == once);
}

/// `M a - J'lambda = u + D + Q - C v - g`, `J a = -(J v)_q v`, dense, with rows that count.
#[test]
fn accelerations_and_forces_are_those_of_the_dense_equations() {
    for robot in loaded() {
        let n = robot.dof();
        let [q, p, u, _] = state(n);
        let mut constrained = ConstrainedHamiltonian::<f64>::new(&robot);
        let linear = constrained.linearise(&q, &p, &u).unwrap();
        let (v, a, lambda) =
            (linear.velocity().to_vec(), linear.acceleration().to_vec(), linear.lambda().to_vec());
        let counted: Vec<usize> = (0..lambda.len()).filter(|&r| constrained.counted()[r] == 1.0).collect();
        let k = counted.len();
        assert_eq!(k, constrained.rank());
        let mut moving = Constraints::<HyperDual64>::new(&robot);
        let along: Vec<_> = q.iter().zip(&v).map(|(&q, &v)| HyperDual64::new(q, v, v, 0.0)).collect();
        moving.set_position(&along).unwrap();
        let mut open = Lagrangian::<f64>::new(&robot.without_constraints());
        let m = open.mass_matrix(&q).unwrap().view().to_nalgebra();
        let bias = open.inverse_dynamics(&q, &v, &vec![0.0; n]).unwrap().to_vec();
        let mut plain = Constraints::<f64>::new(&robot);
        plain.set_position(&q).unwrap();
        let mut dense = DMatrix::zeros(n + k, n + k);
        dense.view_mut((0, 0), (n, n)).copy_from(&m);
        let mut rhs = DVector::zeros(n + k);
        (0..n).for_each(|i| rhs[i] = u[i] - bias[i]);
        for (at, &row) in counted.iter().enumerate() {
            assert!(moving.values()[row].eps1.abs() < 1e-12, "J v = 0");
            rhs[n + at] = -moving.values()[row].eps1eps2;
            for j in 0..n {
                let entry = plain.jacobian()[(row, j)];
                (dense[(n + at, j)], dense[(j, n + at)]) = (entry, -entry);
            }
        }
        let expected = dense.lu().solve(&rhs).unwrap();
        let size = expected.amax();
        for i in 0..n {
            assert!((a[i] - expected[i]).abs() < 1e-11 * size, "{}: a {i}", robot.name());
        }
        for (at, &row) in counted.iter().enumerate() {
            assert!((lambda[row] - expected[n + at]).abs() < 1e-11 * size, "{}: lambda {row}", robot.name());
        }
    }
}

#[test]
fn without_constraints_the_results_are_those_of_the_tree() {
    let robot = looped().remove(5);
    let [q, p, u, y] = state(robot.dof());
    let mut constrained = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
    let mut free = HamiltonianSecondOrder::<f64>::new(&robot);
    let (ours, theirs) =
        (constrained.contract(&q, &p, &u, &y).unwrap(), free.contract(&q, &p, &u, &y).unwrap());
    let f_x = theirs.linearisation().matrix().to_nalgebra();
    assert!((ours.linearisation().matrix().to_nalgebra() - &f_x).amax() < 1e-12 * f_x.amax());
    let y_f_xx = theirs.matrix().to_nalgebra();
    assert!((ours.matrix().to_nalgebra() - &y_f_xx).amax() < 1e-12 * y_f_xx.amax());
    let energy = constrained.first().energy(&q, &p).unwrap();
    let expected = free.first().energy(&q, &p).unwrap();
    assert!((energy.kinetic - expected.kinetic).abs() < 1e-12 * expected.kinetic);
    assert!((energy.potential - expected.potential).abs() < 1e-12);
}

/// A contact sets in: v from `p = M v-` is the velocity after an inelastic impact.
#[test]
fn the_transform_at_the_same_momentum_is_an_impact() {
    let robot = looped().remove(0);
    let [q, v, ..] = state(robot.dof());
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot);
    let p = h.momentum(&q, &v).unwrap().to_vec();
    let after = DVector::from_column_slice(h.velocity(&q, &p).unwrap().0);
    let j = h.constraints().jacobian().view().to_nalgebra();
    let mut open = Hamiltonian::<f64>::new(&robot.without_constraints());
    let inverse = open.inverse_mass_matrix(&q).unwrap().view().to_nalgebra();
    let v = DVector::from_vec(v);
    let impulse = (&j * &inverse * j.transpose()).lu().solve(&(&j * &v)).unwrap();
    let expected = &v - inverse * j.transpose() * impulse;
    assert!((after - &expected).amax() < 1e-13 * expected.amax());
    // Tangents of what is redundant are no part of it.
    let mut moving = ConstrainedHamiltonian::<Dual64>::new(&robot);
    let q: Vec<Dual64> = lift(&q);
    assert!(moving.velocity(&q, &lift(&p)).unwrap().0.iter().all(|v| v.eps == 0.0));
}

#[test]
fn computations_that_would_ignore_constraints_refuse_them_by_name() {
    let robot = four_bar();
    let (q, u) = ([0.1; 3], [0.0; 3]);
    let expected = EvalError::Constrained { constraint: "rocker_pivot".into() };
    assert_eq!(Hamiltonian::<f64>::new(&robot).evaluate(&q, &q, &u).unwrap_err(), expected);
    assert_eq!(Lagrangian::<f64>::new(&robot).forward_dynamics(&q, &q, &u).unwrap_err(), expected);
    assert_eq!(Lagrangian::<f64>::new(&robot).inverse_dynamics(&q, &q, &u).unwrap_err(), expected);
    let mut kinematics = crate::kinematics::Kinematics::<f64>::new(&robot);
    assert!(kinematics.set_motion(&q, &q, &u).is_ok());
    assert!(Hamiltonian::<f64>::new(&robot.without_constraints()).evaluate(&q, &q, &u).is_ok());
}
