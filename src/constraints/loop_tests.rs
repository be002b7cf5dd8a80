//! The four-bar linkage: its reduced system, motions, redundant rows, loops that do not close.

use super::samples::{four_bar, state};
use super::*;
use crate::error::EvalError;
use crate::lagrangian::Lagrangian;
use crate::robot::{ConstraintSpec, Placement};
use crate::scalar::Scalar;
use nalgebra::{DMatrix, DVector};
use num_dual::HyperDual64;

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
    let missing = m * expected
        + DVector::from_column_slice(open.inverse_dynamics(&q, v.as_slice(), &[0.0; 3]).unwrap())
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
        assert!(after.iter().zip(&v).all(|(a, b)| (a - b).abs() < 1e-4), "{after:?} {v:?}");
    }
    let [(change, drift), (finer_change, finer_drift)] = errors[..] else { panic!() };
    assert!(finer_change < change / 12.0 && finer_drift < drift / 12.0, "order four: {errors:?}");
    assert!(finer_change < 1e-4 && finer_drift < 1e-6, "{errors:?}");
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
    match h.close(&mut q, &[false; 3]).unwrap_err() {
        ConstraintError::Contradiction { constraint, miss, .. } => {
            assert_eq!(constraint, "other");
            assert!((miss - 0.1).abs() < 1e-9, "{miss}");
        }
        other => panic!("{other}"),
    }
    // At q = 0 the rods are in one line: the row of x depends on that of y by chance.
    let mut straight = [0.0; 3];
    ConstrainedHamiltonian::<f64>::new(&four_bar()).close(&mut straight, &[false; 3]).unwrap();
    // Out of reach, and straight towards it: the row of x is redundant there, and only there.
    let mut straight = [0.0; 3];
    let spec = ConstraintSpec::pinned("too_far", "rocker_tip", "world").to_placed(far);
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot.with_constraint(spec).unwrap());
    let error = h.close(&mut straight, &[false; 3]).unwrap_err();
    assert!(
        matches!(&error, ConstraintError::CannotClose { miss, .. } if (miss - 0.4).abs() < 1e-2),
        "{error}"
    );
    // Higher than the plane of the rods, whatever else is satisfied.
    let above = Placement::from_xyz_rpy([1.3, 0.0, 0.2], [0.0; 3]);
    let spec = ConstraintSpec::pinned("above", "rocker_tip", "world").to_placed(above);
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot.with_constraint(spec).unwrap());
    match h.close(&mut q, &[false; 3]).unwrap_err() {
        ConstraintError::Contradiction { constraint, miss, .. } => {
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

/// The loop of four bars closes at every angle of its crank, from wherever the others start, without a turn
/// too many.
#[test]
fn loops_close_near_where_they_start() {
    let mut constrained = ConstrainedHamiltonian::<f64>::new(&four_bar());
    let (mut most, mut lost) = (0.0_f64, 0);
    for number in 0..400 {
        let angle =
            |i: usize| std::f64::consts::PI * (f64::from(number) * (1.1 + 0.37 * i as f64) + 0.5).sin();
        let start = [0, 1, 2].map(angle);
        let mut q = start.to_vec();
        match constrained.close(&mut q, &[number % 2 == 0, false, false]) {
            Ok(()) => most = q.iter().zip(start).fold(most, |most, (q, start)| most.max((q - start).abs())),
            Err(_) => lost += 1,
        }
    }
    assert!(
        lost == 0 && most < std::f64::consts::TAU,
        "{lost} did not close, the farthest moved by {most} rad"
    );
}
