//! Free components of the start.

use crate::sharp;
use costate::robot::Robot;
use costate_control::{BoundaryState, Problem, Solution, Solver};

fn two_link() -> Robot {
    Robot::from_file("../robots/two_link.toml").unwrap()
}

fn solve(problem: &Problem) -> Solution {
    let solution = Solver::new(problem, sharp()).unwrap().solve();
    assert!(solution.motion.status.is_converged(), "{}", solution.motion.status);
    assert!(solution.motion.hamiltonian_drift < 1e-8, "drift {}", solution.motion.hamiltonian_drift);
    assert!(solution.end_defect < 1e-7, "end defect {}", solution.end_defect);
    solution
}

/// From A to B with a free end, and back from B to A with a free start.
fn there_and_back(q_free: &[usize], v_free: &[usize]) -> (Problem, Problem) {
    let (from, to) = ([0.1, 0.2], [0.6, 1.1]);
    let mut there = Problem::rest_to_rest(two_link(), &from, &to, 1.0);
    there.end = there.end.with_q_free(q_free).with_v_free(v_free);
    let mut back = Problem::rest_to_rest(two_link(), &to, &from, 1.0);
    back.start = back.start.with_q_free(q_free).with_v_free(v_free);
    (there, back)
}

#[test]
fn without_gravity_and_friction_the_motion_back_costs_the_same() {
    for (q_free, v_free) in [(vec![], vec![0, 1]), (vec![1], vec![]), (vec![0], vec![0]), (vec![], vec![1])] {
        let (there, back) = there_and_back(&q_free, &v_free);
        let (there, back) = (solve(&there), solve(&back));
        assert!(
            (there.motion.cost - back.motion.cost).abs() < 1e-9 * there.motion.cost,
            "{} {}",
            there.motion.cost,
            back.motion.cost
        );
        let (last, first) = (there.trajectory.q.len() - 1, &back.trajectory.q[0]);
        for (a, b) in there.trajectory.q[last].iter().zip(first) {
            assert!((a - b).abs() < 1e-7, "{a} {b}");
        }
    }
}

#[test]
fn no_other_start_is_cheaper() {
    let (_, free) = there_and_back(&[1], &[0, 1]);
    let best = solve(&free);
    let (q, v) = (&best.trajectory.q[0], &best.trajectory.v[0]);
    assert!((q[0] - free.start.q[0]).abs() < 1e-12 && (q[1] - free.start.q[1]).abs() > 1e-3);
    assert!(v.iter().all(|v| v.abs() > 1e-3), "{v:?}");
    let from = |q: &[f64], v: &[f64]| solve(&free.clone().with_start(BoundaryState::fixed(q, v))).motion.cost;
    assert!((from(q, v) - best.motion.cost).abs() < 1e-8 * best.motion.cost);
    for step in [0.05, -0.05] {
        assert!(from(&[q[0], q[1] + step], v) > best.motion.cost * (1.0 + 1e-5));
        assert!(from(q, &[v[0] + step, v[1]]) > best.motion.cost * (1.0 + 1e-5));
        assert!(from(q, &[v[0], v[1] + step]) > best.motion.cost * (1.0 + 1e-5));
    }
}
