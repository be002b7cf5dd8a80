//! What there is to say about a motion beside its figures.

use crate::between::{cut_between, exceeded_between};
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
    ];
    all.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::remarks;
    use costate::robot::Robot;
    use costate_control::{Certificate, Problem, Solver, SolverOptions};

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
