//! The optimal-control problems of `build.rs` and the tests.

use costate::robot::{Robot, RobotError};
use costate_control::{Bounds, Penalty, Problem};
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// A right angle of both joints in a second, `1/2 |u|^2`.
pub fn two_link(robots: &Path) -> Result<Problem, RobotError> {
    let robot = Robot::from_file(robots.join("two_link.toml"))?;
    Ok(Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0))
}

/// Voltages of the motors, most of them bounded, and limits of positions and rates by penalties.
pub fn manutec_r3(robots: &Path) -> Result<Problem, RobotError> {
    let robot = Robot::from_file(robots.join("manutec_r3.toml"))?;
    let mut problem = Problem::rest_to_rest(robot, &[0.0, -1.5, 0.0], &[1.0, -1.95, 1.0], 0.53);
    problem.gain = vec![-126.0, 252.0, 72.0];
    problem.cost.effort = vec![2.0, 1.0, 3.0];
    problem.bounds = Some(Bounds::new(vec![-7.5; 3], vec![7.5, f64::INFINITY, 7.5]));
    problem.penalty = Some(
        Penalty::new(100.0)
            .with_q_min(vec![-0.5, f64::NEG_INFINITY, -0.5])
            .with_q_max(vec![0.5; 3])
            .with_v_max(vec![0.3, f64::INFINITY, 0.2]),
    );
    Ok(problem)
}
