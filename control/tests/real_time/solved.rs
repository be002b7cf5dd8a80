//! Motions that are solved on equal intervals.

use costate::robot::LoadOptions;
use costate_control::{Problem, ProblemFile, Resolve, ResolveStatus, SolverOptions};

/// An example.
pub fn problem(name: &str) -> Problem {
    let file = ProblemFile::read(format!("../examples/problems/{name}.toml"), LoadOptions::default());
    file.unwrap().problem
}

/// Solves on so many equal intervals.
pub fn solved(problem: &Problem, intervals: usize, tolerance: f64) -> (Resolve, f64) {
    let options = SolverOptions::default().with_tolerance(tolerance).with_nodes(3 * intervals + 1);
    let mut motion = Resolve::new(problem, options).unwrap();
    let found = motion.solve().unwrap();
    assert_eq!(found.status, ResolveStatus::Solved);
    assert!(found.keeps_limits());
    (motion, found.cost)
}
