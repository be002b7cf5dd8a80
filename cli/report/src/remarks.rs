//! What there is to say about a motion beside its figures.

use crate::between::{cut_between, exceeded_between};
use crate::light_joints::too_sudden;
use crate::text::{explanation, needs_feedback, saddle, skipped_starts};
use costate_control::{Problem, Solution};

/// Why it is not a solution, and what to know of a solution, each in one sentence.
pub fn remarks(problem: &Problem, solution: &Solution) -> Vec<String> {
    let all = [
        explanation(problem, solution),
        saddle(solution),
        exceeded_between(solution),
        cut_between(solution),
        needs_feedback(problem, solution),
        skipped_starts(solution),
        too_sudden(problem, solution),
    ];
    all.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::remarks;
    use costate::robot::{LoadOptions, Robot};
    use costate_control::{Certificate, MotionLimits, Problem, Solver, SolverOptions};

    #[test]
    fn accelerations_of_arms_without_rotors_are_told() {
        let robot = Robot::from_file("../../robots/ur5.urdf").unwrap();
        let [start, end] = [[0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [0.8, -1.0, 1.2, -1.5, -1.57, 0.5]];
        let mut problem = Problem::rest_to_rest(robot, &start, &end, 1.0);
        problem.cost.effort = vec![1e-4; 6];
        let told = |problem: &Problem| {
            let solution = Solver::new(problem, SolverOptions::default()).unwrap().solve();
            assert!(solution.motion.status.is_solved(), "{}", solution.motion.status);
            remarks(problem, &solution).join("; ")
        };
        let sudden = "more than arms with gears do";
        assert!(told(&problem).contains(sudden));
        problem.limits.a_max = Some(vec![40.0; 6]);
        assert!(!told(&problem).contains(sudden));
    }

    /// A body turns 2.5 rad in 0.2 s: with a hinge a rotor would slow it down, a ball joint cannot have one.
    #[test]
    fn bodies_that_turn_freely_are_not_told_to_have_rotors() {
        let turns = |kind: &str, start: &[f64], end: &[f64]| {
            let text = format!(
                "name = 'body'\ngravity = [0, 0, 0]\nconvention = 'placements'\n[[joint]]\nname = 'pivot'\n\
                 type = '{kind}'\nmass = 1\ninertia = {{ xx = 0.01, yy = 0.01, zz = 0.01 }}\n"
            );
            let robot = Robot::from_toml_str(&text, LoadOptions::default()).unwrap();
            let torques = vec![100.0; robot.dof()];
            let problem = Problem::rest_to_rest(robot, start, end, 0.2);
            let mut problem = problem.with_limits(MotionLimits::none().with_torque_max(torques));
            problem.limits.from_robot = Some(true);
            let solution = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
            assert!(solution.motion.status.is_solved(), "{}", solution.motion.status);
            let rate = solution.trajectory.v.iter().flatten().fold(0.0_f64, |most, v| most.max(v.abs()));
            assert!(rate > 15.0, "{rate}");
            remarks(&problem, &solution).join("; ")
        };
        let hinge = turns("revolute", &[0.0], &[2.5]);
        let (sin, cos) = 1.25_f64.sin_cos();
        let ball = turns("spherical", &[0.0, 0.0, 0.0, 1.0], &[0.0, 0.0, sin, cos]);
        assert!(hinge.contains("give robot.armature or limits.a_max"), "{hinge}");
        assert!(!ball.contains("armature"), "{ball}");
    }

    #[test]
    fn a_saddle_is_told() {
        let robot = Robot::from_file("../../robots/two_link.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0);
        let mut solution = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
        assert!(remarks(&problem, &solution).is_empty());
        solution.motion.certificate = Certificate::SaddleOnMesh;
        let told = remarks(&problem, &solution).join("; ");
        assert!(told.contains("a saddle") && told.contains("solver.starts"), "{told}");
    }
}
