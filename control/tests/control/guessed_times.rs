//! Free final times are found from guesses that are far off.

use costate::robot::Robot;
use costate_control::{FinalTime, MotionLimits, Objective, Polish, Problem, Solver, SolverOptions, Status};

/// The cost of time and effort with bounded torques is that of the guess of 1 s, from guesses that are a
/// million times too short and a hundred times too long.
#[test]
fn costs_do_not_depend_on_the_guess_of_the_time() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    for limits in [
        MotionLimits::none().with_torque_max(vec![25.0, 28.0]),
        MotionLimits::none().with_torque_max(vec![25.0, 28.0]).with_v_max(vec![3.0, 3.0]),
    ] {
        let solve = |guess: f64| {
            let problem = Problem::rest_to_rest(robot.clone(), &[0.0, 0.0], &[1.0, 0.8], guess)
                .with_time(FinalTime::Free { guess })
                .with_cost(Objective::new(1.0, vec![0.01; 2]))
                .with_limits(limits.clone());
            let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never);
            let solution = Solver::new(&problem, options).unwrap().solve();
            assert_eq!(solution.motion.status, Status::Converged, "{guess}");
            solution.total()
        };
        let cost = solve(1.0);
        for guess in [1e-6, 1e-5, 1e-3, 100.0] {
            let found = solve(guess);
            assert!((found / cost - 1.0).abs() < 2e-6, "{guess}: {found} instead of {cost}");
        }
    }
}
