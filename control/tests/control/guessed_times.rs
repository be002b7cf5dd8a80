//! Free final times are found from guesses that are far off.

use costate::robot::{JointSpec, LinkInertia, Robot};
use costate_control::{
    BoundaryState, FinalTime, MotionLimits, Objective, Polish, Problem, Solver, SolverOptions, Status,
};

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

/// A body of unit mass that moves at both ends passes a short way at once: it speeds up and slows down again,
/// or the other way round. Motions that brake, go back and return take a time that is a local minimum too,
/// and none takes times in between. With a force or an acceleration of at most A, no limit of rates being
/// reached, `v^2 = (v_0^2 + v_1^2) / 2 + A d` at the turn, and `T = (2 v - v_0 - v_1) / A`.
#[test]
fn a_short_way_is_passed_at_once() {
    let joint = JointSpec::prismatic("x").axis([1.0, 0.0, 0.0]);
    let body = LinkInertia::about_com(1.0, [0.0; 3], nalgebra::Matrix3::identity());
    let robot = Robot::builder("slider").gravity([0.0; 3]).joint(joint.carrying(body)).build().unwrap();
    let none = MotionLimits::none;
    for (way, [from, to], most, limits) in [
        (0.5, [1.0, 1.0], 1.0, none().with_torque_max(vec![1.0])),
        (0.1, [1.0, 1.0], 1.0, none().with_torque_max(vec![1.0])),
        (0.06, [0.243, 0.504], 2.24, none().with_torque_max(vec![2.24]).with_v_max(vec![0.95])),
        (
            0.019_258,
            [1.4903, 1.513],
            2.35,
            none().with_a_max(vec![2.35]).with_v_max(vec![1.654]).with_torque_max(vec![7.0]),
        ),
    ] {
        let turn: f64 = 0.5 * (from * from + to * to) + most * way;
        let least = (2.0 * turn.sqrt() - from - to) / most;
        for guess in [0.2, 1.0, 30.0] {
            let problem = Problem::rest_to_rest(robot.clone(), &[0.0], &[way], guess)
                .with_start(BoundaryState::fixed(&[0.0], &[from]))
                .with_end(BoundaryState::fixed(&[way], &[to]))
                .with_time(FinalTime::Free { guess })
                .with_cost(Objective::new(1.0, vec![0.0]))
                .with_limits(limits.clone());
            let solution = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
            assert_eq!(solution.motion.status, Status::Converged, "{way} {guess}");
            let off = solution.total() / least - 1.0;
            assert!(off.abs() < 1e-3, "{way} {guess}: {} instead of {least}", solution.total());
        }
    }
}
