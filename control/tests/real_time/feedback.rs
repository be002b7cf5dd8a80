//! Neighbouring optimal feedback, against solving again.

use crate::solved::{problem, solved};
use costate::robot::Robot;
use costate_control::{
    BoundaryState, Budget, Feedback, FinalTime, MotionLimits, Objective, Polish, Problem, Resolve,
    ResolveStatus, Solver, SolverOptions,
};
use nalgebra::{Matrix2, Vector2};

/// The motion at a few times in parts of the whole: q, v, torques; then T.
fn values(motion: &mut Resolve) -> Vec<f64> {
    let n = motion.dof();
    let (mut z, mut tau, mut all) = (vec![0.0; 3 * n], vec![0.0; n], Vec::new());
    let feedback = motion.feedback().unwrap().unwrap().clone();
    for p in (0..feedback.points()).step_by(5) {
        motion.state_at(feedback.time(p), &mut z).unwrap();
        motion.torques_at(feedback.time(p), &mut tau).unwrap();
        all.extend_from_slice(&z[..2 * n]);
        all.extend_from_slice(&tau);
    }
    all.push(motion.final_time().unwrap());
    all
}

/// The derivatives of [`values`] by entry `j` of the state at an end.
fn column(feedback: &Feedback, end: usize, j: usize) -> Vec<f64> {
    let (n, mut all) = (feedback.dof(), Vec::new());
    for p in (0..feedback.points()).step_by(5) {
        let (states, torques) = match end {
            0 => (feedback.states_by_start(p), feedback.torques_by_start(p)),
            _ => (feedback.states_by_end(p), feedback.torques_by_end(p)),
        };
        let rows = states.chunks_exact(2 * n).chain(torques.chunks_exact(2 * n));
        all.extend(rows.map(|row| row[j]));
    }
    all.push(if end == 0 { feedback.time_by_start()[j] } else { feedback.time_by_end()[j] });
    all
}

/// Compares all derivatives with central differences of solving again.
fn check(problem: &Problem, intervals: usize, tolerance: f64, step: f64, within: f64) {
    let (mut motion, _) = solved(problem, intervals, tolerance);
    let feedback = motion.feedback().unwrap().unwrap().clone();
    let n = motion.dof();
    let ends = [&problem.start, &problem.end].map(|end| [&end.q[..], &end.v[..]].concat());
    for (end, state) in ends.iter().enumerate() {
        for j in 0..2 * n {
            let mut moved = |sign: f64| {
                let mut state = state.clone();
                state[j] += sign * step;
                let (q, v) = state.split_at(n);
                let set = if end == 0 { motion.set_start(q, v) } else { motion.set_end(q, v) };
                set.unwrap();
                let found = motion.solve_again(Budget::steps(60)).unwrap();
                assert_eq!(found.status, ResolveStatus::Solved, "{found:?}");
                (values(&mut motion), found.cost)
            };
            let ((above, cost), (below, less)) = (moved(1.0), moved(-1.0));
            let found = column(&feedback, end, j);
            let size = found.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            for (k, found) in found.iter().enumerate() {
                let expected = (above[k] - below[k]) / (2.0 * step);
                assert!((found - expected).abs() < within * size, "{end} {j} {k}: {found} {expected}");
            }
            if end == 0 {
                let expected = (cost - less) / (2.0 * step);
                let gradient = feedback.cost_gradient()[j];
                assert!((gradient / expected - 1.0).abs() < 1e-5, "{gradient} {expected}");
            }
            let (q, v) = state.split_at(n);
            if end == 0 { motion.set_start(q, v) } else { motion.set_end(q, v) }.unwrap();
        }
    }
    let hessian = feedback.cost_hessian();
    let size = hessian.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    for i in 0..2 * n {
        for j in 0..i {
            let off = (hessian[2 * n * i + j] - hessian[2 * n * j + i]).abs();
            assert!(off < within * size, "{i} {j}: {hessian:?}");
        }
    }
}

#[test]
fn derivatives_by_the_ends_are_those_of_solving_again() {
    let mut arm = problem("two_link").with_limits(MotionLimits::none());
    check(&arm, 8, 1e-13, 1e-3, 1e-4);
    arm.start.v = vec![0.5, -0.3];
    arm.end.v = vec![-0.4, 0.6];
    arm.time = FinalTime::Free { guess: 1.0 };
    arm.cost = Objective::new(100.0, vec![1.0; 2]);
    check(&arm, 8, 1e-13, 1e-3, 1e-4);
}

#[test]
fn derivatives_with_active_limits_are_those_of_solving_again() {
    let mut arm = problem("two_link").with_limits(MotionLimits::none().with_v_max(vec![f64::INFINITY, 7.0]));
    check(&arm, 8, 1e-11, 1e-4, 1e-3);
    arm.time = FinalTime::Free { guess: 2.0 };
    arm.cost = Objective::new(20.0, vec![1.0; 2]);
    arm.limits = arm.limits.with_v_max(vec![f64::INFINITY, 3.0]).with_torque_max(vec![12.0, 5.0]);
    check(&arm, 8, 1e-11, 1e-4, 1e-3);
}

/// The torques at the start of the motion that is optimal for this state there.
fn first_torques(arm: &Problem, state: &[f64]) -> Vec<f64> {
    let start = BoundaryState::fixed(&state[..2], &state[2..]);
    let problem = arm.clone().with_start(start);
    let options = SolverOptions::default().with_tolerance(1e-8).with_polish(Polish::Never);
    let solution = Solver::new(&problem, options).unwrap().solve();
    assert!(solution.motion.status.is_solved(), "{}", solution.motion.status);
    solution.trajectory.u[0].clone()
}

/// The gain at the start, where the elbow gives all that it can, against other motions on meshes of their
/// own. A tighter tolerance does not make it worse.
#[test]
fn gains_with_active_limits_of_torques_are_those_of_solving_again() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let limits = MotionLimits::none().with_torque_max(vec![60.0, 7.0]);
    let arm = Problem::rest_to_rest(robot, &[0.0, 0.3], &[1.2, 0.9], 1.0).with_limits(limits);
    let (start, step) = ([0.0, 0.3, 0.0, 0.0], 2e-3);
    let mut expected = [0.0; 8];
    for j in 0..4 {
        let [above, below] = [step, -step].map(|step| {
            let mut state = start;
            state[j] += step;
            first_torques(&arm, &state)
        });
        (0..2).for_each(|i| expected[4 * i + j] = (above[i] - below[i]) / (2.0 * step));
    }
    let size = expected.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    for tolerance in [1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
        let options = SolverOptions::default().with_tolerance(tolerance).with_polish(Polish::Never);
        let solution = Solver::new(&arm, options.clone()).unwrap().solve();
        let mut motion = Resolve::near(&arm, options, &solution.trajectory).unwrap();
        assert_eq!(motion.solve().unwrap().status, ResolveStatus::Solved);
        let mut gain = [0.0; 8];
        assert!(motion.feedback().unwrap().expect("a strict minimum").gain(0.0, &mut gain));
        for (found, expected) in gain.iter().zip(expected) {
            assert!((found - expected).abs() < 0.06 * size, "{tolerance}: {gain:?} {expected:?}");
        }
        let feedback = motion.feedback().unwrap().unwrap();
        assert!(!feedback.gain(f64::NAN, &mut gain));
        // Its numbers are all of it.
        let numbers = feedback.to_numbers();
        let copy = Feedback::from_numbers(2, &numbers).unwrap();
        assert_eq!((copy.to_numbers(), copy.points()), (numbers.clone(), feedback.points()));
        let [mut ours, mut theirs] = [[0.0; 8]; 2];
        assert!(feedback.gain(0.3, &mut ours) && copy.gain(0.3, &mut theirs) && ours == theirs);
        assert!(Feedback::from_numbers(2, &numbers[..numbers.len() - 1]).is_none());
        assert!(Feedback::from_numbers(3, &numbers).is_none() && Feedback::from_numbers(2, &[]).is_none());
    }
}

/// M of the arm at q_2 = 0, inverted.
fn inverse_mass() -> Matrix2<f64> {
    Matrix2::new(11.0 / 3.0 + 3.0, 4.0 / 3.0 + 1.5, 4.0 / 3.0 + 1.5, 4.0 / 3.0).try_inverse().unwrap()
}

/// S = -J_xx and dT/dx in x = (q, p) at rest, p = M v, as extremals have them.
#[test]
fn derivatives_at_the_start_are_those_of_the_extremals() {
    let close = |found: f64, value: f64| assert!((found / value - 1.0).abs() < 1e-5, "{found} {value}");
    let arm = problem("two_link").with_limits(MotionLimits::none());
    let (mut motion, _) = solved(&arm, 60, 1e-11);
    let hessian = motion.feedback().unwrap().unwrap().cost_hessian().to_vec();
    let by_rates = Matrix2::new(hessian[10], hessian[11], hessian[14], hessian[15]);
    let by_momenta = inverse_mass() * by_rates * inverse_mass();
    close(-hessian[0], -0.53118213);
    close(-hessian[5], -81.732019);
    close(-hessian[1], 6.0645566);
    close(-by_momenta[(0, 0)], -1.8676968);
    close(-by_momenta[(1, 1)], -2.5853540);
    // A free time.
    let arm = problem("two_link_free_time").with_limits(MotionLimits::none());
    let (mut motion, _) = solved(&arm, 60, 1e-11);
    let by_start = motion.feedback().unwrap().unwrap().time_by_start().to_vec();
    let by_momenta = inverse_mass() * Vector2::new(by_start[2], by_start[3]);
    for (found, value) in [by_start[0], by_start[1], by_momenta[0], by_momenta[1]]
        .into_iter()
        .zip([-0.271543, -0.132472, -0.121566, -0.696579])
    {
        assert!((found - value).abs() < 2e-6, "{found} {value}");
    }
}

/// The gain at a time is that at the start of the rest of the motion.
#[test]
fn gains_are_those_of_the_rest_of_the_motion() {
    let arm = problem("two_link").with_limits(MotionLimits::none());
    let (mut motion, _) = solved(&arm, 40, 1e-11);
    let (mut z, mut gain, mut expected) = ([0.0; 6], [0.0; 8], [0.0; 8]);
    for t in [0.0, 0.3, 0.55] {
        motion.state_at(t, &mut z).unwrap();
        assert!(motion.feedback().unwrap().unwrap().gain(t, &mut gain));
        let mut rest = arm.clone();
        rest.time = FinalTime::Fixed(1.0 - t);
        (rest.start.q, rest.start.v) = (z[..2].to_vec(), z[2..4].to_vec());
        let (mut rest, _) = solved(&rest, 40, 1e-11);
        assert!(rest.feedback().unwrap().unwrap().gain(0.0, &mut expected));
        let size = expected.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        for (found, expected) in gain.iter().zip(expected) {
            assert!((found - expected).abs() < 2e-3 * size, "{t}: {gain:?} {expected:?}");
        }
    }
    // Towards the end the last one is held; a free start is no obstacle.
    let feedback = motion.feedback().unwrap().unwrap();
    let mut last = [0.0; 8];
    assert!(feedback.gain(0.98, &mut gain) && feedback.gain(1.0, &mut last) && gain == last);
    let mut free = arm;
    free.start.v_free = vec![0];
    let (mut motion, _) = solved(&free, 8, 1e-9);
    assert!(motion.feedback().unwrap().unwrap().gain(0.5, &mut gain));
}
