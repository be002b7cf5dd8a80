//! Levels of verification, and what is given when there is nothing to verify.

use crate::sharp;
use costate::robot::Robot;
use costate_control::{
    Bounds, Certificate, FinalTime, Method, MotionLimits, Objective, Polish, Problem, Solution, Solver,
    SolverOptions, Status, Verify,
};
use std::f64::consts::FRAC_PI_2;

fn two_link() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.0], &[FRAC_PI_2, FRAC_PI_2], 1.0).with_limits(MotionLimits::none())
}

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    Solver::new(problem, options).unwrap().solve()
}

#[test]
fn each_level_does_what_it_says() {
    for method in [Method::Collocation, Method::Shooting] {
        let of = |verify| solve(&two_link(), sharp().with_method(method).with_verify(verify)).motion;
        let full = of(Verify::Full);
        assert_eq!((&full.status, full.verification), (&Status::Converged, Verify::Full));
        assert!(full.end_state.is_some() && full.shooting_defect < 1e-6 && full.conditioning.is_nan());
        assert_eq!(full.certificate, Certificate::LocalMinimum);
        let factors = of(Verify::Factors);
        assert_eq!((&factors.status, factors.verification), (&Status::Converged, Verify::Factors));
        assert!(factors.end_state.is_none() && factors.shooting_defect == f64::INFINITY);
        assert!((1.0..1e4).contains(&factors.conditioning), "{}", factors.conditioning);
        assert_eq!(factors.certificate, Certificate::NotChecked);
        let none = of(Verify::None);
        assert_eq!((&none.status, none.verification), (&Status::NotVerified, Verify::None));
        assert!(none.end_state.is_none() && none.conditioning.is_nan());
        assert_eq!([full.cost, full.cost], [factors.cost, none.cost]);
    }
    let of = |verify| solve(&two_link(), direct(verify));
    let (full, factors, none) = (of(Verify::Full), of(Verify::Factors), of(Verify::None));
    assert_eq!(factors.motion.status, Status::Converged);
    assert_eq!(none.motion.status, Status::NotVerified);
    assert!(full.end_defect < 1e-6 && factors.end_defect == f64::INFINITY);
    assert_eq!([full.motion.cost, full.motion.cost], [factors.motion.cost, none.motion.cost]);
    let saved: Solution = serde_json::from_str(&serde_json::to_string(&factors).unwrap()).unwrap();
    assert_eq!(saved.motion.verification, Verify::Factors);
}

/// The direct method alone.
fn direct(verify: Verify) -> SolverOptions {
    SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never).with_verify(verify)
}

#[test]
fn a_saved_motion_keeps_its_mesh() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let free =
        two_link().with_time(FinalTime::Free { guess: 2.0 }).with_cost(Objective::new(1.0, vec![1.0; 2]));
    let least = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.6], 4.0)
        .with_time(FinalTime::Free { guess: 4.0 })
        .with_cost(Objective::new(1.0, vec![0.0; 2]))
        .with_bounds(Bounds::symmetric(vec![1.0; 2]));
    for (problem, same_mesh) in [(two_link(), true), (free, true), (least, false)] {
        let first = solve(&problem, sharp());
        let text = serde_json::to_string(&first).unwrap();
        let saved: Solution = serde_json::from_str(&text).unwrap();
        let solver = Solver::new(&problem, sharp()).unwrap();
        let again = solver.with_start(&saved.trajectory).unwrap().solve();
        assert_eq!(again.motion.status, Status::Converged);
        assert!((again.total() - first.total()).abs() < 1e-9 * first.total(), "{}", again.total());
        assert!(again.newton_iterations <= if same_mesh { 2 } else { 6 }, "{:?}", again.motion.iterations);
        assert!(!same_mesh || again.nodes() == first.nodes(), "{} {}", again.nodes(), first.nodes());
    }
}

/// Where a torque comes to its limit inside of an interval it overshoots by little.
#[test]
fn torques_exceed_their_limits_between_the_points_by_little() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let limits = [51.5, 23.5];
    let effort = Problem::rest_to_rest(robot.clone(), &[-1.37, -1.02], &[-0.308, -1.4], 0.79)
        .with_limits(MotionLimits::none().with_torque_max(limits.to_vec()));
    let time = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.6], 1.0)
        .with_time(FinalTime::Free { guess: 1.0 })
        .with_cost(Objective::new(1.0, vec![0.0; 2]))
        .with_limits(MotionLimits::none().with_torque_max(limits.to_vec()));
    // In least time torques jump from limit to limit, which an interval around a jump cannot follow.
    for (problem, most) in [(effort, 0.005), (time, 0.05)] {
        let of = |tolerance| solve(&problem, direct(Verify::Full).with_tolerance(tolerance));
        let (rough, sharp) = (of(1e-4), of(1e-7));
        assert_eq!([&rough.motion.status, &sharp.motion.status], [&Status::Converged; 2]);
        // What the limits lose inside costs no more than the tolerance.
        assert!((rough.motion.cost / sharp.motion.cost - 1.0).abs() < 1e-4);
        let torque = rough.limits.torque.unwrap();
        // In parts of the smaller range.
        let part = torque.between / (2.0 * limits[1]);
        assert!(part < most, "{part}");
        assert!(!torque.active.is_empty());
    }
}

/// Jumps that are close to each other: intervals are not so narrow that rounding hides what is left to do.
#[test]
fn least_time_is_found_to_many_digits() {
    let robot = Robot::from_file("../robots/manutec_r3.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.299, 0.689, -0.398], &[-1.02, -0.495, 0.78], 1.47)
        .with_time(FinalTime::Free { guess: 1.47 })
        .with_cost(Objective::new(1.0, vec![0.0; 3]))
        .with_limits(MotionLimits::none().with_torque_max(vec![945.0, 1890.0, 540.0]));
    let found = solve(&problem, direct(Verify::Factors).with_tolerance(1e-7));
    assert_eq!(found.motion.status, Status::Converged);
    // Estimates of least time, whose torques jump, are off by up to four times.
    assert!((found.motion.final_time / 0.46776061 - 1.0).abs() < 1e-7, "{}", found.motion.final_time);
}
