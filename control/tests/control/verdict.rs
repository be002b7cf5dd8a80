//! Remarks about solutions: what is an error, and what agrees with what.

use crate::sledge;
use costate::robot::{LoadOptions, Robot};
use costate_control::{
    Bounds, Certificate, FinalTime, MotionLimits, Objective, Polish, Problem, Remark, RemarkKey, Severity,
    Solution, Solver, SolverOptions, Status,
};
use std::f64::consts::PI;

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    Solver::new(problem, options).unwrap().solve()
}

fn keys(solution: &Solution, problem: &Problem) -> Vec<RemarkKey> {
    solution.remarks(problem).iter().map(|remark| remark.key).collect()
}

fn find(solution: &Solution, problem: &Problem, key: RemarkKey) -> Remark {
    let all = solution.remarks(problem);
    all.iter().find(|remark| remark.key == key).unwrap_or_else(|| panic!("{key:?} in {all:?}")).clone()
}

/// Two links, of which the second one alone is driven, with friction.
fn acrobot() -> Robot {
    let text = "name = 'acrobot'\ngravity = [0, 0, -9.81]\nconvention = 'placements'\n\
        [[joint]]\nname = 'shoulder'\naxis = [0, 1, 0]\nmass = 1\ncom = [0, 0, -0.5]\n\
        inertia = { xx = 0.083, yy = 0.083 }\nfriction = { viscous = 0.1 }\n\
        [[joint]]\nname = 'elbow'\naxis = [0, 1, 0]\nplacement = { xyz = [0, 0, -1] }\nmass = 1\n\
        com = [0, 0, -1]\ninertia = { xx = 0.33, yy = 0.33 }\nfriction = { viscous = 0.1 }\n";
    Robot::from_toml_str(text, LoadOptions::default()).unwrap()
}

/// An acrobot that swings up.
fn swing_up(time: FinalTime, cost: [f64; 2], torque: f64) -> Problem {
    Problem::rest_to_rest(acrobot(), &[0.0; 2], &[PI, 0.0], 1.0)
        .with_time(time)
        .with_cost(Objective::new(cost[0], vec![0.0, cost[1]]))
        .with_limits(MotionLimits::none().with_torque_max(vec![0.0, torque]))
}

/// Near its end the acrobot is an inverted pendulum twice: torques from the start end elsewhere. Each part of
/// the motion is verified, so it is a solution, with a warning that says both.
#[test]
fn an_unstable_motion_is_a_solution_with_a_warning_in_numbers() {
    let problem = swing_up(FinalTime::Fixed(6.0), [1.0, 0.01], 50.0);
    let solution = solve(&problem, SolverOptions::default().with_tolerance(1e-4));
    assert_eq!(solution.motion.status, Status::Converged, "{}", solution.message(&problem));
    // Radians from the end, and each part within a thousandth.
    let (end, parts) = (solution.end_defect, solution.motion.shooting_defect);
    assert!(end > 0.01 && parts < 3e-3, "{end} {parts}");
    let warning = find(&solution, &problem, RemarkKey::Unstable);
    assert_eq!((warning.severity, warning.value), (Severity::Warning, Some(solution.end_defect)));
    for part in ["unstable in open loop", "rad, rad/s) off", "verified in parts", "gains (--feedback)"] {
        assert!(warning.text.contains(part), "{warning}");
    }
    assert!(solution.check(&problem).is_ok());
}

/// Whatever the starts give, a proof alone makes a problem infeasible, and a motion that lacks less torque
/// is not left for one that lacks more.
#[test]
fn more_starts_never_make_a_problem_infeasible() {
    let problem = swing_up(FinalTime::Free { guess: 3.0 }, [0.1, 1.0], 20.0);
    let options = SolverOptions::default();
    let mut least = f64::INFINITY;
    for starts in [1, 3] {
        let solution = solve(&problem, options.clone().with_starts(starts));
        assert_ne!(solution.motion.status, Status::Infeasible);
        let violation = solution.limits.violation();
        assert!(violation <= least, "{violation} with {starts} starts, {least} with fewer");
        assert_eq!(solution.motion.status.is_solved(), solution.check(&problem).is_ok());
        least = violation;
    }
}

#[test]
fn broken_hard_limits_are_errors_of_any_motion() {
    let limits = MotionLimits::none().with_jerk_max(vec![400.0]);
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_limits(limits);
    let solution = solve(&problem, SolverOptions::default());
    assert_eq!(solution.motion.status, Status::Converged);
    assert!(solution.remarks(&problem).is_empty(), "{:?}", solution.remarks(&problem));
    let worst = serde_json::json!({
        "joint": "x", "time": 0.25, "excess": 193.0, "part": 0.24, "unit": "m/s^3", "value": 593.0, "limit": 400.0,
    });
    for (place, key) in
        [("worst", RemarkKey::LimitExceeded), ("worst_between", RemarkKey::LimitExceededBetween)]
    {
        let mut broken = solution.clone();
        let jerk = broken.limits.jerk.as_mut().unwrap();
        match place {
            "worst" => jerk.worst = Some(serde_json::from_value(worst.clone()).unwrap()),
            _ => jerk.worst_between = Some(serde_json::from_value(worst.clone()).unwrap()),
        }
        assert!(!broken.limits.are_kept() && broken.limits.violation() == 0.24);
        let error = find(&broken, &problem, key);
        assert_eq!(
            (
                error.severity,
                error.name.as_deref(),
                error.kind.as_deref(),
                error.time,
                error.value,
                error.limit
            ),
            (Severity::Error, Some("x"), Some("jerk"), Some(0.25), Some(593.0), Some(400.0))
        );
        assert!(error.text.contains("jerk of joint 'x'"), "{error}");
        // No value is proposed that was not tried.
        assert!(!error.text.contains("lower"), "{error}");
        let unfit = broken.check(&problem).unwrap_err();
        assert_eq!(unfit.remarks, [error]);
        // With a status that says so it is the status alone.
        broken.motion.status = Status::LimitsNotKept;
        assert_eq!(keys(&broken, &problem), [RemarkKey::NotSolved]);
        let text = broken.message(&problem);
        assert!(text.contains("593") || text.contains("193"), "{text}");
    }
}

/// Least time with limits of torques and accelerations jumps between the points of rough meshes.
#[test]
fn only_motions_that_keep_their_limits_are_converged() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let limits = MotionLimits::none().with_torque_max(vec![25.0, 28.0]).with_a_max(vec![9.0, 14.0]);
    let limits = limits.with_power_max(vec![40.0, 60.0]);
    let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.57; 2], 1.2)
        .with_time(FinalTime::Free { guess: 1.2 })
        .with_cost(Objective::new(1.0, vec![0.0; 2]))
        .with_limits(limits);
    for tolerance in [1e-2, 1e-4] {
        let solution = solve(&problem, SolverOptions::default().with_tolerance(tolerance));
        let (kept, fit) = (solution.limits.are_kept(), solution.check(&problem).is_ok());
        assert!(!fit || kept, "{tolerance} {:?}", solution.limits);
        assert_eq!(solution.motion.status.is_solved(), fit, "{tolerance}");
    }
}

#[test]
fn json_holds_the_same_remarks() {
    let slow = MotionLimits::none().with_v_max(vec![0.5]);
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_limits(slow);
    let solution = solve(&problem, SolverOptions::default());
    let text = solution.to_json_with_remarks(&problem).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let remarks: Vec<Remark> = serde_json::from_value(json["warnings"].clone()).unwrap();
    assert_eq!(remarks, solution.remarks(&problem));
    assert_eq!(json["warnings"][0]["key"], "not_solved");
    assert_eq!(json["warnings"][0]["severity"], "error");
    assert_eq!(json["warnings"][0]["joint"], "x");
    assert_eq!(Solution::from_json(&text).unwrap().limits, solution.limits);
    for remark in remarks {
        assert_eq!(serde_json::to_value(remark.key).unwrap(), remark.key.name());
        assert_eq!(serde_json::to_value(remark.severity).unwrap(), remark.severity.name());
    }
}

/// An extremal past a conjugate point is stationary, and says that motions nearby cost less.
#[test]
fn a_motion_that_is_no_minimum_says_so() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0);
    let mut solution = solve(&problem, SolverOptions::default());
    // It needs more than the 1 N m of the robot's file, which it is not asked to keep.
    assert!(solution.remarks(&problem).iter().all(|remark| remark.key == RemarkKey::RobotLimit));
    solution.motion.certificate = Certificate::SaddleOnMesh;
    assert_eq!(find(&solution, &problem, RemarkKey::Saddle).severity, Severity::Warning);
    solution.motion.conjugate_time = Some(0.75);
    let remark = find(&solution, &problem, RemarkKey::NotMinimal);
    assert_eq!((remark.severity, remark.time), (Severity::Warning, Some(0.75)));
    assert!(solution.check(&problem).is_ok());
}

/// Bounds that are as much wider as the message says allow a motion.
#[test]
fn bounds_that_are_proposed_are_wide_enough() {
    let options = SolverOptions::default().with_method(costate_control::Method::Collocation);
    let with = |bound: f64| {
        Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_bounds(Bounds::symmetric(vec![bound]))
    };
    let narrow = with(3.0);
    let solution = solve(&narrow, options.clone());
    assert_eq!(solution.motion.status, Status::BoundsNotReached);
    let message = solution.message(&narrow);
    let (_, rest) = message.split_once("with bounds ").unwrap();
    let factor: f64 = rest.split_once(' ').unwrap().0.parse().unwrap();
    let wide = with(factor * 3.0);
    let solution = solve(&wide, options);
    assert!(solution.check(&wide).is_ok(), "{factor}: {}", solution.message(&wide));
}

/// A converged motion that is left for a cheaper one is named with its cost.
#[test]
fn a_cheaper_motion_that_is_not_converged_names_the_best_converged_one() {
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0);
    let options = SolverOptions::default().with_polish(Polish::Never).with_starts(2);
    let mut solution = solve(&problem, options);
    solution.motion.status = Status::MeshLimit;
    (solution.starts[0].total, solution.starts[0].status) = (9.5, Status::Converged);
    (solution.starts[1].total, solution.starts[1].status) = (6.0, Status::MeshLimit);
    let remark = find(&solution, &problem, RemarkKey::DearerConverged);
    assert_eq!((remark.severity, remark.value), (Severity::Warning, Some(9.5)));
    assert!(remark.text.contains("of start 1, costs 9.5"), "{remark}");
}
