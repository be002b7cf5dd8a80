//! Second derivatives of the direct method: which motions of a mesh are local minima.

use crate::sledge;
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate_control::{
    BoundaryState, Certificate, FinalTime, Keep, Kept, Method, Motion, MotionLimits, Objective, Polish,
    Problem, RunningCost, Solution, Solver, SolverOptions, Status, Task, ToolPose, UserTerm, Via,
};
use std::f64::consts::{FRAC_PI_2, PI};

/// -k q^2 / 2.
struct Repelled(f64);

impl RunningCost for Repelled {
    fn evaluate<S: Scalar>(&self, q: &[S], _v: &[S]) -> S {
        (q[0] * q[0]).times(-0.5 * self.0)
    }
}

/// Whether the mass stays at 0 as at a minimum. If that is a saddle, the search leaves it for a motion that
/// costs less, or says so.
fn stays(problem: &Problem) -> bool {
    let options = SolverOptions::of(Method::Direct).with_polish(Polish::Never);
    let motion = Solver::new(problem, options).unwrap().solve().motion;
    assert_eq!(motion.status, Status::Converged);
    // With a free end it gains as little as 0.02 k 0.1^2 / 8 = 3.1e-4 where its end is at the limit.
    assert!(motion.cost.abs() < 1e-9 || motion.cost < -3e-4, "{}", motion.cost);
    motion.certificate == Certificate::LocalMinimumOnMesh && motion.cost > -1e-9
}

/// A mass that may stay at 0, where the cost `1/2 (q''^2 - k q^2)` is stationary. Its second variation is
/// positive as long as k is below the first eigenvalue of `q'''' = k q`, that of a beam whose end is held,
/// hinged or free. Above it the mass goes to a limit of its position.
#[test]
fn a_motion_is_a_minimum_up_to_the_first_eigenvalue_of_a_beam() {
    let held = BoundaryState::fixed(&[0.0], &[0.0]);
    let hinged = held.clone().with_v_free(&[0]);
    let free = hinged.clone().with_q_free(&[0]);
    // S. Timoshenko, Vibration Problems in Engineering: cos b cosh b = 1, tan b = tanh b, cos b cosh b = -1.
    for (end, b) in [(held, 4.730_040_745_f64), (hinged, 3.926_602_312), (free, 1.875_104_069)] {
        for (part, expected) in [(0.98, true), (1.02, false)] {
            let problem = Problem::rest_to_rest(sledge(), &[0.0], &[0.0], 1.0)
                .with_end(end.clone())
                .with_limits(MotionLimits::none().with_q_min(vec![-0.1]).with_q_max(vec![0.1]))
                .with_term(UserTerm::new(Repelled(part * b.powi(4))));
            assert_eq!(stays(&problem), expected, "{part} {b}");
        }
    }
}

/// With a via in the middle of the same motion, which holds the position there: the first eigenvalue is that
/// of a beam of half the length that is held at one end and hinged at the other one.
#[test]
fn a_via_makes_a_saddle_a_minimum() {
    let [whole, halves] = [4.730_040_745_f64.powi(4), (2.0 * 3.926_602_312_f64).powi(4)];
    for (k, has_via, expected) in [
        (1.02 * whole, false, false),
        (1.02 * whole, true, true),
        (0.98 * halves, true, true),
        (1.02 * halves, true, false),
    ] {
        let mut problem = Problem::rest_to_rest(sledge(), &[0.0], &[0.0], 1.0)
            .with_limits(MotionLimits::none().with_q_min(vec![-0.1]).with_q_max(vec![0.1]))
            .with_term(UserTerm::new(Repelled(k)));
        if has_via {
            problem = problem.with_via(Via::at(&[0.0]).with_time(0.5));
        }
        assert_eq!(stays(&problem), expected, "{k} {has_via}");
    }
}

/// A pendulum that swings up and may go back by next to nothing first: what is solved first is a saddle, at
/// its limit for as long as that may be, which costs 33.4174.
#[test]
fn a_saddle_at_a_limit_is_left() {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0], &[PI], 3.0)
        .with_limits(MotionLimits::none().with_q_min(vec![-0.0002]));
    let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never);
    let Motion { status, certificate, cost, stationarity, .. } =
        Solver::new(&problem, options).unwrap().solve().motion;
    assert_eq!((status, certificate), (Status::Converged, Certificate::LocalMinimumOnMesh));
    assert!(cost < 33.4173 && stationarity < 1e-3, "{cost} {stationarity}");
}

/// Minima are known as such where limits are active, times free, tools held, vias passed, jerks limited.
#[test]
fn minima_with_all_that_a_problem_can_ask_are_known() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let none = MotionLimits::none;
    let arm = |limits: MotionLimits| {
        Problem::rest_to_rest(robot.clone(), &[0.0; 2], &[FRAC_PI_2; 2], 1.0).with_limits(limits)
    };
    let tool = |q: [f64; 2]| {
        let mut problem = arm(none());
        let pose = ToolPose::of("joint:elbow").with_position([f64::INFINITY, q[0], f64::INFINITY]);
        problem.end = BoundaryState::fixed(&[FRAC_PI_2, q[1]], &[0.0; 2]).with_q_free(&[0, 1]);
        problem.with_task(Task::default().with_end_tool(pose))
    };
    let slow = Keep::new("joint:elbow", Kept::Speed { max: 2.2 });
    let least = |limits: MotionLimits| {
        arm(limits).with_time(FinalTime::Free { guess: 1.5 }).with_cost(Objective::new(30.0, vec![1.0; 2]))
    };
    let active = |solution: &Solution| {
        solution.limits.kinds().filter_map(|(_, usage)| usage).any(|usage| !usage.active.is_empty())
    };
    for (name, problem, is_limited) in [
        ("torque", arm(none().with_torque_max(vec![45.0, 12.0])), true),
        ("rate", arm(none().with_v_max(vec![2.2, f64::INFINITY])), true),
        ("free time", least(none()), false),
        ("free time, torque", least(none().with_torque_max(vec![20.0, 6.0])), true),
        ("tool at the end", tool([0.9, 0.5]), false),
        ("speed of a tool", arm(none()).with_task(Task::default().with_keep(slow)), true),
        ("via", arm(none()).with_via(Via::at(&[0.5, 1.0])), false),
        ("jerk", arm(none().with_jerk_max(vec![60.0, 120.0])), true),
    ] {
        let solution =
            Solver::new(&problem, SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never))
                .unwrap()
                .solve();
        assert_eq!(
            (&solution.motion.status, solution.motion.certificate),
            (&Status::Converged, Certificate::LocalMinimumOnMesh),
            "{name}"
        );
        // Also where coefficients are limited, so that nothing is exceeded between points.
        assert!(solution.limits.is_empty() || solution.limits.are_kept(), "{name}: {:?}", solution.limits);
        assert_eq!(active(&solution), is_limited, "{name}: {:?}", solution.limits);
    }
}
