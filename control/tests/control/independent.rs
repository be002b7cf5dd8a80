//! Motions that the direct method calls converged, verified without its points.

use super::sledge;
use costate::robot::{Friction, JointSpec, Robot};
use costate_control::{
    CheckOutcome, FinalTime, MotionLimits, Objective, Polish, Problem, Solution, Solver, SolverOptions,
    Status,
};

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    Solver::new(problem, options.with_polish(Polish::Never)).unwrap().solve()
}

/// A unit mass from rest to rest over one metre in a second costs 6.
#[test]
fn a_closed_form_is_verified() {
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_limits(MotionLimits::none());
    let solution = solve(&problem, SolverOptions::default());
    let verified = solution.verified.as_ref().unwrap();
    assert_eq!(solution.motion.status, Status::Converged);
    assert!((verified.integrated_cost.unwrap() - 6.0).abs() < 1e-8, "{verified:?}");
    for (name, check) in verified.checks() {
        assert_eq!(check.outcome, CheckOutcome::Passed, "{name}: {verified:?}");
    }
    assert!(verified.stationarity.unwrap() < 1e-6 && verified.costate_defect.unwrap() < 1e-6, "{verified:?}");
}

/// A spindle with dry friction of 1 N m, whose transition of 0.01 rad/s no equal mesh sees: 62.83 rad in 8 s
/// cost least if it waits at rest: 2.893711585 by quadrature of the motion with the costate zero at rest
/// (`users_inputs/inputs/spindle.py`).
#[test]
fn a_spindle_that_waits_is_optimal() {
    let friction = Friction { viscous: 0.0, coulomb: 1.0, coulomb_velocity: 0.01 };
    let joint = JointSpec::revolute("spin").armature(0.05).friction(friction);
    let robot = Robot::builder("spindle").joint(joint).build().unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0], &[20.0 * std::f64::consts::PI], 8.0)
        .with_limits(MotionLimits::none());
    let solution = solve(&problem, SolverOptions::default());
    let verified = solution.verified.as_ref().unwrap();
    assert_eq!(solution.motion.status, Status::Converged, "{verified:?}");
    let off = (solution.motion.cost / 2.893711585 - 1.0).abs();
    assert!(off <= 2.0 * solution.cost_error().unwrap(), "{off} {verified:?}");
}

/// Limited jerks are verified as torques are. With free accelerations at the ends it takes s = sqrt(2 0.9/30)
/// from rest to 0.9 m/s, over 2/3 0.9 s, so that T = 1/0.9 + 2/3 s. T is
/// that to the tolerance.
#[test]
fn limited_jerks_are_verified() {
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 2.0)
        .with_time(FinalTime::Free { guess: 2.0 })
        .with_cost(Objective::new(1.0, vec![0.0]))
        .with_limits(MotionLimits::none().with_jerk_max(vec![30.0]).with_v_max(vec![0.9]));
    let solution = solve(&problem, SolverOptions::default());
    let verified = solution.verified.as_ref().unwrap();
    assert_eq!(verified.optimality.outcome, CheckOutcome::Passed, "{verified:?}");
    assert!(verified.stationarity.is_some() && verified.costate_defect.is_some(), "{verified:?}");
    let least = 1.0 / 0.9 + 2.0 / 3.0 * (1.8_f64 / 30.0).sqrt();
    let excess = solution.motion.cost / least - 1.0;
    assert!(excess.abs() < 1e-4, "{excess} {verified:?}");
    let text = serde_json::to_string(&solution).unwrap();
    let read: Solution = serde_json::from_str(&text).unwrap();
    assert_eq!(read.verified, solution.verified);
}
