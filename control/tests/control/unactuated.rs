//! Joints without a motor: their torque is zero as an equation.
//!
//! The value is that of `bash benches/ocp/run --values in_phases` (`benches/ocp/harness/in_phases.py`):
//! direct collocation on Radau's points with the equations of cart and pole written out, in CasADi with
//! IPOPT.

use costate::robot::Robot;
use costate_control::{MotionLimits, Objective, Polish, Problem, Solver, SolverOptions, Status};
use std::f64::consts::PI;

#[test]
fn a_cart_swings_up_a_pole_that_has_no_motor() {
    let robot = Robot::from_file("../robots/cart_pole.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0, PI], &[1.0, 0.0], 2.0)
        .with_cost(Objective::new(0.0, vec![1.0, 0.0]))
        .with_limits(MotionLimits::none().with_torque_max(vec![20.0, 0.0]));
    let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never);
    let solution = Solver::new(&problem, options).unwrap().solve();
    assert_eq!(solution.motion.status, Status::Converged, "{}", solution.total());
    let error = solution.total() / 31.928_860_223 - 1.0;
    assert!(error.abs() < 1e-6, "{}", solution.total());
    // Integrated with no torque at all on the pole.
    assert!(solution.end_defect < 1e-4, "{}", solution.end_defect);
    let largest = solution.trajectory.u.iter().map(|u| u[1].abs()).fold(0.0, f64::max);
    assert!(largest < 1e-6, "{largest}");
}
