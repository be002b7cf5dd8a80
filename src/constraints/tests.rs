//! The constrained state equation against automatic differentiation and dense matrices.

use super::samples::{looped, state};
use super::*;
use crate::error::EvalError;
use crate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use crate::lagrangian::Lagrangian;
use crate::robot::{ConstraintSpec, Placement, Robot, Wrench, WrenchAxes};
use crate::scalar::Scalar;
use nalgebra::{DMatrix, DVector};
use num_dual::{Dual64, HyperDual64};

fn four_bar() -> Robot {
    Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/four_bar.toml")).unwrap()
}

fn lift<S: Scalar>(a: &[f64]) -> Vec<S> {
    a.iter().map(|&a| S::from_f64(a)).collect()
}

/// The robots, a wrench on one of them.
fn loaded() -> Vec<Robot> {
    let mut robots = looped();
    let wrench = Wrench { moment: [1.0, -2.0, 0.5], force: [3.0, 1.0, -4.0], axes: WrenchAxes::Local };
    robots[2] = robots[2].with_wrench("g", wrench).unwrap();
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
                    assert!((found - expected).abs() < 1e-11 * size_xx, "{name}: {i} {j}: {found} {expected}");
                }
            }
        }
        let d: Vec<f64> = (0..2 * n).map(|i| (0.7 + i as f64).cos()).collect();
        let product = DVector::from_column_slice(second.hessian_product(&q, &p, &y, &d).unwrap());
        assert!((product - &y_f_xx * DVector::from_vec(d)).amax() < 1e-11 * size_xx);
        let first = second.first().linearise(&q, &p, &u).unwrap();
        assert!((first.matrix().to_nalgebra() - &f_x).amax() == 0.0);
        let adjoint = second.first().adjoint(&q, &p, &u, &y).unwrap();
        let expected = f_x.transpose() * DVector::from_vec(y);
        assert!((DVector::from_column_slice(adjoint.y_f_x) - expected).amax() < 1e-11 * size_x);
        assert!(adjoint.f.iter().zip(&f).all(|(a, b)| (a - b).abs() < 1e-13 * size_x));
    }
}

/// `M a - J'lambda = u + D + Q - C v - g`, `J a = -(J v)_q v`, dense, with rows that count.
#[test]
fn accelerations_and_forces_are_those_of_the_dense_equations() {
    for robot in loaded() {
        let n = robot.dof();
        let [q, p, u, _] = state(n);
        let mut constrained = ConstrainedHamiltonian::<f64>::new(&robot);
        let linear = constrained.linearise(&q, &p, &u).unwrap();
        let (v, a, lambda) = (linear.velocity().to_vec(), linear.acceleration().to_vec(), linear.lambda().to_vec());
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

/// Position of the loop for a crank angle, in closed form: coupler and rocker as two sides of a triangle.
fn closed<S: Scalar>(crank: S, acos: impl Fn(S) -> S, atan2: impl Fn(S, S) -> S) -> [S; 3] {
    let (sin, cos) = crank.sin_cos();
    let [x, y] = [(-cos.times(0.5)).plus(1.3), -sin.times(0.5)];
    let length = (x * x + y * y).sqrt();
    let inner = acos((length * length).plus(1.2 * 1.2 - 0.9 * 0.9) * length.times(2.0 * 1.2).recip());
    let coupler = atan2(y, x) + inner;
    let (sin, cos) = coupler.sin_cos();
    let rocker = atan2(y - sin.times(1.2), x - cos.times(1.2));
    [crank, coupler - crank, rocker - coupler]
}

fn closed_dual(crank: HyperDual64) -> [HyperDual64; 3] {
    closed(crank, |x| num_dual::DualNum::acos(&x), |y, x| num_dual::DualNum::atan2(&y, x))
}

#[test]
fn the_four_bar_is_the_reduced_system_of_one_degree_of_freedom() {
    let robot = four_bar();
    let mut constrained = ConstrainedHamiltonian::<f64>::new(&robot);
    let mut q = vec![1.0, -0.9, -1.2];
    constrained.close(&mut q, &[true, false, false]).unwrap();
    for (found, expected) in q.iter().zip([1.0, -0.591_737_92, -2.058_615_39]) {
        assert!((found - expected).abs() < 1e-8, "{q:?}");
    }
    let (rate, u) = (1.7, 3.0);
    let at = closed_dual(HyperDual64::new(1.0, 1.0, 1.0, 0.0));
    // q = q(theta), v = q' theta', a = q' theta'' + q'' theta'^2; q' . (M a + bias - u) = 0.
    let slope = DVector::from_fn(3, |i, _| at[i].eps1);
    let bend = DVector::from_fn(3, |i, _| at[i].eps1eps2);
    (0..3).for_each(|i| assert!((at[i].re - q[i]).abs() < 1e-12));
    let v = &slope * rate;
    let mut open = Lagrangian::<f64>::new(&robot.without_constraints());
    let m = open.mass_matrix(&q).unwrap().view().to_nalgebra();
    let bias = DVector::from_column_slice(open.inverse_dynamics(&q, v.as_slice(), &[0.0; 3]).unwrap());
    let force = DVector::from_column_slice(&[u, 0.0, 0.0]) - bias - &m * &bend * (rate * rate);
    let acceleration = slope.dot(&force) / slope.dot(&(&m * &slope));
    let expected = &slope * acceleration + bend * (rate * rate);
    let p = constrained.momentum(&q, v.as_slice()).unwrap().to_vec();
    let linear = constrained.linearise(&q, &p, &[u, 0.0, 0.0]).unwrap();
    assert!(linear.mu().iter().all(|mu| mu.abs() < 1e-12), "p = M v");
    for i in 0..3 {
        assert!((linear.velocity()[i] - v[i]).abs() < 1e-12);
        assert!((linear.acceleration()[i] - expected[i]).abs() < 1e-10, "{i}");
    }
    let lambda = linear.lambda().to_vec();
    assert_eq!((constrained.rank(), constrained.redundant().count()), (2, 0));
    // The pivot holds the rocker with the force that the equations of the open tree miss.
    let missing = m * expected + DVector::from_column_slice(open.inverse_dynamics(&q, v.as_slice(), &[0.0; 3]).unwrap())
        - DVector::from_column_slice(&[u, 0.0, 0.0]);
    let (force, moment) = constrained.constraints().wrench(0, &lambda).unwrap();
    assert_eq!((force[2], moment), (0.0, [0.0; 3]));
    let j = constrained.constraints().jacobian().view().to_nalgebra();
    assert!((j.transpose() * DVector::from_column_slice(&force[..2]) - missing).amax() < 1e-10);
}

/// Steps of the classical method of order four.
fn step(h: &mut ConstrainedHamiltonian<f64>, x: &mut [f64], u: &[f64], dt: f64) {
    let n = u.len();
    let start = x.to_vec();
    let (mut sum, mut at) = (vec![0.0; 2 * n], start.clone());
    for (weight, next) in [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)] {
        let f = h.evaluate(&at[..n], &at[n..], u).unwrap().f;
        for i in 0..2 * n {
            sum[i] += weight * f[i];
            at[i] = start[i] + next * dt * f[i];
        }
    }
    (0..2 * n).for_each(|i| x[i] = start[i] + dt / 6.0 * sum[i]);
}

#[test]
fn motions_keep_energy_and_constraints_and_projection_removes_drift() {
    let robot = four_bar();
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot);
    let mut q = vec![1.0, -0.6, -2.0];
    h.close(&mut q, &[true, false, false]).unwrap();
    let v = closed_dual(HyperDual64::new(1.0, 1.0, 0.0, 0.0)).map(|q| 4.0 * q.eps1);
    let p = h.momentum(&q, &v).unwrap().to_vec();
    let total = |h: &mut ConstrainedHamiltonian<f64>, x: &[f64]| {
        let energy = h.energy(&x[..3], &x[3..]).unwrap();
        energy.kinetic + energy.potential
    };
    let mut errors = Vec::new();
    for steps in [100, 200] {
        let mut x = [&q[..], &p].concat();
        let before = total(&mut h, &x);
        (0..steps).for_each(|_| step(&mut h, &mut x, &[0.0; 3], 1.0 / f64::from(steps)));
        let change = (total(&mut h, &x) - before).abs();
        let (at, momentum) = x.split_at(3);
        let drift = h.drift(at, &q).unwrap().iter().fold(0.0, |most: f64, g| most.max(g.abs()));
        assert!((at[0] - q[0]).abs() > 1.0, "it moves: {at:?}");
        errors.push((change, drift));
        let (mut at, mut momentum) = (at.to_vec(), momentum.to_vec());
        let [v, mu] = [0, 1].map(|k| {
            let both = h.velocity(&at, &momentum).unwrap();
            if k == 0 { both.0.to_vec() } else { both.1.to_vec() }
        });
        assert!(mu.iter().any(|mu| mu.abs() > 0.1), "impulse of the pivot {mu:?}");
        assert!(h.constraint_rate(&at, &v).unwrap().iter().all(|rate| rate.abs() < 1e-12));
        h.project(&mut at, &mut momentum, &q).unwrap();
        assert!(h.drift(&at, &q).unwrap().iter().all(|g| g.abs() < 1e-12));
        let (after, mu) = h.velocity(&at, &momentum).unwrap();
        assert!(mu.iter().all(|mu| mu.abs() < 1e-10));
        assert!(after.iter().zip(&v).all(|(a, b)| (a - b).abs() < 1e-5), "{after:?} {v:?}");
    }
    let [(change, drift), (finer_change, finer_drift)] = errors[..] else { panic!() };
    assert!(finer_change < change / 12.0 && finer_drift < drift / 12.0, "order four: {errors:?}");
    assert!(finer_change < 1e-5 && finer_drift < 1e-6, "{errors:?}");
}

/// The loop of the four-bar closed in space: what the joints close already is redundant.
#[test]
fn redundant_rows_are_left_out_and_told() {
    let robot = four_bar();
    let pin = ConstraintSpec::pinned("pin", "rocker_tip", "pivot");
    let again = robot.without_constraints().with_constraint(pin).unwrap();
    let again = again.with_constraint(ConstraintSpec::pinned("twice", "pivot", "rocker_tip")).unwrap();
    let q = [1.0, -0.591_737_918_7, -2.058_615_394];
    let [_, p, u, y] = state(3);
    let mut ours = ConstrainedHamiltonianSecondOrder::<f64>::new(&again);
    let mut theirs = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
    let (found, expected) =
        (ours.contract(&q, &p, &u, &y).unwrap(), theirs.contract(&q, &p, &u, &y).unwrap());
    let close = |a: DMatrix<f64>, b: DMatrix<f64>| assert!((a - &b).amax() < 1e-10 * b.amax());
    close(found.matrix().to_nalgebra(), expected.matrix().to_nalgebra());
    close(found.linearisation().matrix().to_nalgebra(), expected.linearisation().matrix().to_nalgebra());
    assert_eq!(ours.first().rank(), 2);
    let redundant: Vec<&str> = ours.first().redundant().collect();
    assert_eq!(redundant, ["pin", "twice", "twice", "twice"]);
}

#[test]
fn loops_that_do_not_close_say_by_how_much() {
    let robot = four_bar().without_constraints();
    let far = Placement::from_xyz_rpy([3.0, 0.0, 0.0], [0.0; 3]);
    let spec = ConstraintSpec::pinned("too_far", "rocker_tip", "world").to_placed(far);
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot.with_constraint(spec.clone()).unwrap());
    let mut q = [0.8, -0.4, -0.3];
    match h.close(&mut q, &[false; 3]).unwrap_err() {
        // The rods are 2.6 m long.
        ConstraintError::CannotClose { constraint, miss } => {
            assert_eq!(constraint, "too_far");
            assert!((miss - 0.4).abs() < 1e-2, "{miss}");
        }
        other => panic!("{other}"),
    }
    let pin = |name: &str, x: f64| {
        let at = Placement::from_xyz_rpy([x, 0.0, 0.0], [0.0; 3]);
        ConstraintSpec::pinned(name, "rocker_tip", "world").to_placed(at)
    };
    let both = robot.with_constraint(pin("one", 1.3)).unwrap().with_constraint(pin("other", 1.4)).unwrap();
    let mut h = ConstrainedHamiltonian::<f64>::new(&both);
    let message = h.close(&mut q, &[false; 3]).unwrap_err().to_string();
    assert!(message.contains("'one'") || message.contains("'other'"), "{message}");
    // Higher than the plane of the rods, whatever else is satisfied.
    let above = Placement::from_xyz_rpy([1.3, 0.0, 0.2], [0.0; 3]);
    let spec = ConstraintSpec::pinned("above", "rocker_tip", "world").to_placed(above);
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot.with_constraint(spec).unwrap());
    match h.close(&mut q, &[false; 3]).unwrap_err() {
        ConstraintError::Contradiction { constraint, miss } => {
            assert_eq!(constraint, "above");
            assert!((miss - 0.2).abs() < 1e-9, "{miss}");
        }
        other => panic!("{other}"),
    }
    assert!(matches!(
        h.close(&mut [f64::NAN, 0.0, 0.0], &[false; 3]),
        Err(ConstraintError::Evaluation(EvalError::NonFinite { .. }))
    ));
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
