use super::ClosedPoints;
use crate::direct::limits::gait_rows::tests::rabbit_on_both_feet;
use crate::direct::points::values::{PointDynamics, Points};
use crate::problem::Problem;
use costate::constraints::ConstrainedHamiltonian;
use costate::robot::{ConstraintRow, ConstraintSpec, Robot};
use costate_test_support::robots::file;

/// Robots with all kinds of constraints, at a state where the loops are closed or nearly so.
fn samples() -> Vec<(Robot, Vec<f64>)> {
    let (four_bar, delta) = (file("four_bar.toml"), file("delta.toml"));
    let geared = four_bar.without_constraints();
    let gear = ConstraintSpec::coupling("gear", &[("crank", 1.0), ("rocker", -0.5)], 0.2);
    let rigid =
        ConstraintSpec::rows("grip", "rocker_tip", "pivot", &[ConstraintRow::X, ConstraintRow::TurnZ]);
    let close = |robot: &Robot, mut q: Vec<f64>, held: &[bool]| {
        ConstrainedHamiltonian::<f64>::new(robot).close(&mut q, held).unwrap();
        q
    };
    let q = close(&four_bar, vec![1.0, -0.6, -2.0], &[true, false, false]);
    let d = close(&delta, vec![0.3, 0.25, 0.35, 0.0, 0.0, -0.14], &[true, true, true, false, false, false]);
    let geared = geared.with_constraint(gear).unwrap();
    let g = close(&geared, vec![1.0, -0.6, 1.0], &[true, true, false]);
    let gripped = four_bar.without_constraints().with_constraint(rigid).unwrap();
    let at = close(&gripped, vec![1.0, -0.6, -2.0], &[false; 3]);
    vec![(four_bar, q), (delta, d), (geared, g), (gripped, at)]
}

fn points(robot: &Robot, q: &[f64]) -> (ClosedPoints, Points) {
    let problem = Problem::rest_to_rest(robot.clone(), q, q, 1.0).with_multipliers().unwrap();
    let all = problem.coordinates();
    let mut points = Points::default();
    points.resize(all, [0, 0], std::iter::once(1));
    fill(&mut points, q);
    (ClosedPoints::new(problem.loops.as_ref().unwrap(), 0), points)
}

/// Central differences of the torques and of the weighted Jacobian.
#[test]
fn derivatives_are_those_of_differences() {
    for (robot, q) in samples() {
        let (closed, points) = points(&robot, &q);
        compare(closed, &points, robot.name());
    }
}

/// In both phases of a step that begins on two feet; the multipliers of the one that swings have no force.
#[test]
fn derivatives_of_both_phases_are_those_of_differences() {
    let problem = rabbit_on_both_feet();
    let (loops, n, all) = (problem.loops.as_ref().unwrap(), problem.robot.dof(), problem.coordinates());
    for phase in 0..2 {
        let mut points = Points::default();
        points.resize(all, [0, 0], std::iter::once(1));
        fill(&mut points, &problem.start.q[..n]);
        compare(ClosedPoints::new(loops, phase), &points, "rabbit");
        let torques = |points: &Points| {
            let mut points = points.clone();
            ClosedPoints::new(loops, phase).evaluate(&mut points).unwrap();
            points.tau
        };
        let before = torques(&points);
        for (k, row) in loops.rows.iter().enumerate() {
            let mut moved = points.clone();
            moved.z[2 * all + n + k] += 1.0;
            let changed: Vec<f64> = torques(&moved).iter().zip(&before).map(|(a, b)| a - b).collect();
            let is_idle = phase == 1 && k >= 2;
            assert_eq!(changed[..n].iter().any(|change| change.abs() > 1e-6), !is_idle);
            assert!((changed[n + k] - if is_idle { row.mass } else { 0.0 }).abs() < 1e-9);
        }
    }
}

fn fill(points: &mut Points, q: &[f64]) {
    points.z.iter_mut().enumerate().for_each(|(i, z)| *z = (1.0 + 1.7 * i as f64).sin());
    points.z[..q.len()].copy_from_slice(q);
    points.weights.iter_mut().enumerate().for_each(|(i, w)| *w = (0.5 + 2.3 * i as f64).cos());
}

fn compare(mut closed: ClosedPoints, points: &Points, name: &str) {
    let (all, width) = (points.dof, 3 * points.dof);
    let mut at = points.clone();
    closed.contract(&mut at).unwrap();
    let mut again = points.clone();
    closed.evaluate(&mut again).unwrap();
    for (a, b) in at.tau.iter().zip(&again.tau) {
        assert!((a - b).abs() < 1e-12, "{name}: {a} {b}");
    }
    let step = 1e-5;
    for j in 0..width {
        let moved = |sign: f64, closed: &mut ClosedPoints| {
            let mut moved = points.clone();
            moved.z[j] += sign * step;
            closed.contract(&mut moved).unwrap();
            moved
        };
        let [plus, minus] = [moved(1.0, &mut closed), moved(-1.0, &mut closed)];
        for i in 0..all {
            let expected = (plus.tau[i] - minus.tau[i]) / (2.0 * step);
            let found = at.tau_z[width * i + j];
            assert!((found - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{name} {i} {j}");
        }
        for i in 0..width {
            let gradient =
                |of: &Points| -> f64 { (0..all).map(|l| points.weights[l] * of.tau_z[width * l + i]).sum() };
            let expected = (gradient(&plus) - gradient(&minus)) / (2.0 * step);
            let found = at.hessian[width * i + j];
            let close = (found - expected).abs() < 1e-7 * (1.0 + expected.abs());
            assert!(close, "{name} {i} {j}: {found} {expected}");
        }
    }
}

/// With the accelerations and forces of the constrained Hamiltonian the torques are those that move it.
#[test]
fn torques_are_those_of_the_constrained_hamiltonian() {
    for (robot, q) in samples() {
        let (mut closed, mut points) = points(&robot, &q);
        let problem = Problem::rest_to_rest(robot.clone(), &q, &q, 1.0).with_multipliers().unwrap();
        let loops = problem.loops.clone().unwrap();
        let (n, all) = (q.len(), points.dof);
        let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(&robot);
        let u: Vec<f64> = (0..n).map(|i| (0.3 + i as f64).cos()).collect();
        let free: Vec<f64> = (0..n).map(|i| (0.7 + 1.3 * i as f64).sin()).collect();
        // A velocity that the loops allow.
        let p = hamiltonian.momentum(&q, &free).unwrap().to_vec();
        let v = hamiltonian.velocity(&q, &p).unwrap().0.to_vec();
        let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
        let linear = hamiltonian.linearise(&q, &p, &u).unwrap();
        let (a, lambda) = (linear.acceleration().to_vec(), linear.lambda().to_vec());
        points.z.fill(0.0);
        points.z[..n].copy_from_slice(&q);
        points.z[all..all + n].copy_from_slice(&v);
        points.z[2 * all..2 * all + n].copy_from_slice(&a);
        for (k, row) in loops.rows.iter().enumerate() {
            points.z[2 * all + n + k] = lambda[row.row] / row.mass;
        }
        closed.evaluate(&mut points).unwrap();
        for (i, tau) in points.tau.iter().enumerate() {
            let expected = if i < n { u[i] } else { 0.0 };
            assert!((tau - expected).abs() < 1e-9, "{}: {i} {tau} {expected}", robot.name());
        }
    }
}
