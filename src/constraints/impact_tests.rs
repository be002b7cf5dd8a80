//! Impacts against the impact law with dense matrices, and automatic differentiation.

use super::free_tests::held;
use super::samples::{looped, state};
use super::*;
use crate::configuration::{ConfigurationSpace, samples as configuration};
use crate::hamiltonian::Hamiltonian;
use crate::robot::{ConstraintSpec, JointSpec, LinkInertia, Placement, Robot};
use crate::scalar::Scalar;
use nalgebra::{DMatrix, DVector, Matrix3};
use num_dual::HyperDual64;

fn lift<S: Scalar>(a: &[f64]) -> Vec<S> {
    a.iter().map(|&a| S::from_f64(a)).collect()
}

fn vector(a: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(a)
}

/// v+ and Lambda of `M v+ = M v- + J'Lambda`, `J v+ = 0`, and M; redundant rows have no impulses.
fn law(robot: &Robot, q: &[f64], v: &DVector<f64>) -> (DVector<f64>, Vec<f64>, DMatrix<f64>) {
    let mut rows = ConstrainedHamiltonian::<f64>::new(robot);
    rows.velocity(q, v.as_slice()).unwrap();
    let counted: Vec<usize> = (0..rows.counted().len()).filter(|&i| rows.counted()[i] == 1.0).collect();
    let j = rows.constraints().jacobian().view().to_nalgebra().select_rows(&counted);
    let mut open = Hamiltonian::<f64>::new(&robot.without_constraints());
    let m = open.mass_matrix(q).unwrap().view().to_nalgebra();
    let (n, k) = (m.nrows(), j.nrows());
    let mut dense = DMatrix::zeros(n + k, n + k);
    dense.view_mut((0, 0), (n, n)).copy_from(&m);
    dense.view_mut((0, n), (n, k)).copy_from(&-j.transpose());
    dense.view_mut((n, 0), (k, n)).copy_from(&j);
    let mut rhs = DVector::zeros(n + k);
    rhs.rows_mut(0, n).copy_from(&(&m * v));
    let found = dense.lu().solve(&rhs).unwrap();
    let mut impulse = vec![0.0; rows.counted().len()];
    counted.iter().enumerate().for_each(|(at, &row)| impulse[row] = found[n + at]);
    (found.rows(0, n).into_owned(), impulse, m)
}

#[test]
fn velocities_impulses_and_losses_are_those_of_the_impact_law() {
    for robot in looped() {
        let [q, v, ..] = state(robot.dof());
        let before = vector(&v);
        let (v_plus, impulse, m) = law(&robot, &q, &before);
        let mut impact = Impact::<f64>::new(&robot);
        let p = impact.hamiltonian().momentum(&q, &v).unwrap().to_vec();
        let after = impact.evaluate(&q, &p).unwrap();
        let size = v_plus.amax().max(impulse.iter().fold(1.0, |most: f64, entry| most.max(entry.abs())));
        assert!((vector(after.velocity) - &v_plus).amax() < 1e-12 * size);
        for (found, expected) in after.impulse.iter().zip(&impulse) {
            assert!((found - expected).abs() < 1e-12 * size, "{}", robot.name());
        }
        assert!((vector(after.momentum) - &m * &v_plus).amax() < 1e-12 * size * m.amax());
        let energy = |v: &DVector<f64>| 0.5 * v.dot(&(&m * v));
        let loss = energy(&before) - energy(&v_plus);
        assert!((after.loss - loss).abs() < 1e-12 * energy(&before), "{} {loss}", after.loss);
        assert!(after.loss >= 0.0 && (after.loss > 1e-3) != impulse.is_empty(), "{}", after.loss);
        // What holds already loses nothing.
        let p = after.momentum.to_vec();
        let again = impact.evaluate(&q, &p).unwrap();
        assert!((vector(again.velocity) - v_plus).amax() < 1e-12 * size);
        assert!(again.impulse.iter().all(|impulse| impulse.abs() < 1e-11 * size));
        assert!((0.0..1e-12 * (1.0 + loss)).contains(&again.loss), "{}", again.loss);
    }
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers() {
    for robot in looped().into_iter().chain(held()) {
        let (n, space) = (robot.dof(), ConfigurationSpace::new(&robot));
        let [q, p, y, both] = configuration::state(&space);
        let mut impact = Impact::<f64>::new(&robot);
        let k = impact.hamiltonian().constraints().count();
        let c: Vec<f64> = (0..k).map(|i| (0.4 + 1.3 * i as f64).cos()).collect();
        let linear = impact.linearise(&q, &p).unwrap();
        let jacobians =
            [linear.velocity_x(), linear.momentum_x(), linear.impulse_x()].map(|x| x.to_nalgebra());
        let after = linear.after;
        let values = [after.velocity.to_vec(), after.momentum.to_vec(), after.impulse.to_vec()];
        let weights = ImpactWeights { velocity: &both[n..], momentum: &y, impulse: &c };
        let xx = impact.contract(&q, &p, weights).unwrap().view().to_nalgebra();
        let weights = [&both[n..], &y, &c];
        // p+ by M v+, not by the impulses.
        let mut judge = ConstrainedHamiltonian::<HyperDual64>::new(&robot);
        for i in 0..2 * n {
            for j in 0..=i {
                let mut x: Vec<HyperDual64> = lift(&vec![0.0; 2 * n]);
                x[i].eps1 = 1.0;
                x[j].eps2 = 1.0;
                let mut moved = lift(&q);
                space.integrate(&lift(&q), &x[..n], &mut moved).unwrap();
                let before: Vec<HyperDual64> = p.iter().zip(&x[n..]).map(|(&p, &dp)| dp + p).collect();
                let (v, mu) = judge.velocity(&moved, &before).unwrap();
                let (v, mu) = (v.to_vec(), mu.to_vec());
                let momentum = judge.momentum(&moved, &v).unwrap().to_vec();
                let mut expected = 0.0;
                for (part, found) in [v, momentum, mu].iter().enumerate() {
                    let size =
                        1.0 + jacobians[part].iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
                    for (l, found) in found.iter().enumerate() {
                        assert!((found.re - values[part][l]).abs() < 1e-12 * size, "{part} {l}");
                        assert!(
                            (found.eps1 - jacobians[part][(l, i)]).abs() < 1e-11 * size,
                            "{part} {l} {i}"
                        );
                        expected += weights[part][l] * found.eps1eps2;
                    }
                }
                for found in [xx[(i, j)], xx[(j, i)]] {
                    assert!((found - expected).abs() < 1e-11 * xx.amax(), "{}: {i} {j}", robot.name());
                }
            }
        }
    }
}

/// An arm of five joints, the origin of a link held, then its last link, too.
fn arm() -> Robot {
    let inertia = Matrix3::new(0.5, 0.02, -0.1, 0.02, 0.7, 0.05, -0.1, 0.05, 0.6);
    let link = |k: usize| {
        let k = k as f64;
        LinkInertia::about_com(1.0 + 0.2 * k, [0.3, 0.1 * k, -0.2], inertia * (0.4 + 0.1 * k))
    };
    let axes = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.2], [1.0, 0.3, 0.0], [0.0, 1.0, 0.0], [0.4, 0.0, 1.0]];
    let mut builder = Robot::builder("arm").gravity([0.0, 0.0, -9.81]);
    for (k, axis) in axes.into_iter().enumerate() {
        let at = Placement::from_xyz_rpy([0.4, -0.1, 0.2], [0.3, -0.2 * k as f64, 0.5]);
        let spec = JointSpec::revolute(format!("j{k}")).axis(axis).placed(at).carrying(link(k));
        let parent = k.checked_sub(1).map(|parent| format!("j{parent}"));
        builder = builder.joint(parent.map_or(spec.clone(), |parent| spec.on(&parent)));
    }
    builder.build().unwrap()
}

/// Landing changes neither q nor p, release changes p by the impulses that the constraints have given, and
/// the velocity by nothing.
#[test]
fn the_state_is_continuous_at_a_landing_and_the_velocity_at_a_release() {
    let tip =
        ConstraintSpec::pinned("tip", "j4", "world").placed(Placement::from_xyz_rpy([0.5; 3], [0.0; 3]));
    let first = ConstraintSpec::rows("first", "j2", "world", &[crate::robot::ConstraintRow::Z]);
    let held = arm().with_constraint(first).unwrap();
    let landed = held.with_constraint(tip.clone()).unwrap();
    let [q, v, u, _] = state(5);
    let (mut before, mut after) =
        (ConstrainedHamiltonian::<f64>::new(&held), ConstrainedHamiltonian::<f64>::new(&landed));
    let p = before.momentum(&q, &v).unwrap().to_vec();
    // A state whose p holds impulses of the first constraint, moved on by its own rate.
    let rate = before.evaluate(&q, &p, &u).unwrap().f.to_vec();
    let q: Vec<f64> = q.iter().zip(&rate).map(|(q, f)| q + 0.1 * f).collect();
    let p: Vec<f64> = p.iter().zip(&rate[5..]).map(|(p, f)| p + 0.1 * f).collect();
    let (v_minus, mu) = before.velocity(&q, &p).unwrap();
    assert!(mu[0].abs() > 0.1, "{mu:?}");
    let v_minus = vector(v_minus);
    let energy = |h: &mut ConstrainedHamiltonian<f64>, p: &[f64]| h.energy(&q, p).unwrap().kinetic;
    let kinetic = energy(&mut before, &p);
    // The same p in the Hamiltonian after the impact.
    let (v_plus, impulse, m) = law(&landed, &q, &v_minus);
    let found = vector(after.velocity(&q, &p).unwrap().0);
    assert!((&found - &v_plus).amax() < 1e-12 * v_plus.amax(), "{found} {v_plus}");
    let loss = kinetic - energy(&mut after, &p);
    let expected = 0.5 * (&v_minus - &v_plus).dot(&(&m * (&v_minus - &v_plus)));
    assert!((loss - expected).abs() < 1e-12 * kinetic && loss > 0.0, "{loss} {expected}");
    // Impulses of this instant are those of M v-, without what the first constraint gave before.
    let mut impact = Impact::<f64>::new(&landed);
    let released = impact.hamiltonian().momentum(&q, v_minus.as_slice()).unwrap().to_vec();
    let at = impact.evaluate(&q, &released).unwrap();
    let impulse = vector(&impulse);
    assert!((vector(at.impulse) - &impulse).amax() < 1e-12 * impulse.amax());
    assert!((at.loss - expected).abs() < 1e-12 * kinetic);
    let p_plus = at.momentum.to_vec();
    let same = impact.evaluate(&q, &p).unwrap();
    assert!((vector(same.momentum) - vector(&p_plus)).amax() < 1e-12 * vector(&p_plus).amax());
    // Release of the first constraint: the tip alone holds, with the same velocity and no impulses.
    let alone = arm().with_constraint(tip).unwrap();
    let mut alone = ConstrainedHamiltonian::<f64>::new(&alone);
    let (v, mu) = alone.velocity(&q, &p_plus).unwrap();
    assert!((vector(v) - &v_plus).amax() < 1e-12 * v_plus.amax() && mu.iter().all(|mu| mu.abs() < 1e-11));
    // Without the release map the impulses of the past would change the velocity.
    let wrong = vector(alone.velocity(&q, &p).unwrap().0);
    assert!((wrong - v_plus).amax() > 1e-3);
}
