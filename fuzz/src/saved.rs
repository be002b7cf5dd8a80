//! Saved solutions of small problems, and their robots.

use crate::files::project;
use costate::robot::Robot;
use costate_control::{Problem, Solver, SolverOptions};
use std::sync::OnceLock;

/// The robots of the saved solutions.
pub fn robots() -> &'static [Robot] {
    static ROBOTS: OnceLock<Vec<Robot>> = OnceLock::new();
    ROBOTS.get_or_init(|| {
        let robot = |name| Robot::from_file(project().join("robots").join(name)).ok();
        ["pendulum.toml", "two_link.toml"].into_iter().filter_map(robot).collect()
    })
}

/// Solutions of small problems, as they are saved.
pub fn saved_solutions() -> Vec<Vec<u8>> {
    let saved = |robot: &Robot| {
        let n = robot.dof();
        let problem = Problem::rest_to_rest(robot.clone(), &vec![0.0; n], &vec![0.4; n], 1.0);
        let options = SolverOptions::default().with_nodes(5).with_tolerance(1e-2);
        let solution = Solver::new(&problem, options).ok()?.solve();
        serde_json::to_vec(&solution).ok()
    };
    robots().iter().filter_map(saved).collect()
}
