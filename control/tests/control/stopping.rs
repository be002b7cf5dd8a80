//! Solvers that are stopped, and problems that have no solution.

use crate::{sharp, sledge};
use costate::robot::Robot;
use costate_control::{
    BoundViolation, Bounds, BranchEnd, Cancel, Continuation, FinalTime, Iteration, Method, MotionLimits,
    Objective, Parameter, Phase, Polish, Problem, Solution, Solver, SolverOptions, Status, TrajectoryError,
    Verify,
};
use std::fmt::Debug;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

fn two_link() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, -0.5], 1.2)
}

fn stopped(solution: &Solution, status: Status) {
    assert_eq!(solution.motion.status, status);
    assert!(solution.trajectory.t.len() > 1, "the best iterate is kept");
}

#[test]
fn solvers_can_be_sent_and_printed() {
    fn both<T: Send + Debug>(_: &T) {}
    let problem = two_link();
    let solver = Solver::new(&problem, sharp()).unwrap().on_iteration(|_| ControlFlow::Continue(()));
    both(&solver);
    assert!(format!("{solver:?}").contains("two_link"), "{solver:?}");
    let continuation = Continuation::new(&problem, Parameter::Gravity, 0.0, 1.0, sharp()).unwrap();
    both(&continuation);
    assert!(format!("{continuation:?}").contains("Gravity"), "{continuation:?}");
    both(&Cancel::new());
    both(&TrajectoryError::BadTimes);
}

#[test]
fn a_listener_stops_a_search() {
    let problem = two_link();
    let mut steps = 0;
    let solver = Solver::new(&problem, sharp()).unwrap();
    let solution = solver.on_iteration(|step: &Iteration| {
        steps += 1;
        assert_eq!(step.phase, Phase::Direct);
        if steps == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    stopped(&solution.solve(), Status::Cancelled);
    assert_eq!(steps, 2);
}

#[test]
fn a_token_and_a_time_limit_stop_a_search() {
    let problem = two_link();
    let cancel = Cancel::new();
    cancel.cancel();
    let solver = || Solver::new(&problem, sharp().with_starts(3)).unwrap();
    let solution = solver().with_cancel(cancel.clone()).solve();
    stopped(&solution, Status::Cancelled);
    assert!(solution.motion.iterations.is_empty() && solution.starts.len() == 1);
    let limited = sharp().with_time_limit(Duration::from_nanos(1));
    let late = Solver::new(&problem, limited).unwrap().solve();
    stopped(&late, Status::TimeLimit);
    // Controls without effort take the other attempts.
    let least = {
        let mut problem = two_link();
        problem.time = FinalTime::Free { guess: 2.0 };
        problem.cost = Objective::new(1.0, vec![0.0; 2]);
        problem.bounds = Some(Bounds::symmetric(vec![1.0; 2]));
        problem
    };
    stopped(&Solver::new(&least, sharp()).unwrap().with_cancel(cancel).solve(), Status::Cancelled);
    let zero = sharp().with_time_limit(Duration::ZERO);
    let error = Solver::new(&problem, zero).unwrap_err();
    assert!(error.to_string().contains("time_limit"), "{error}");
}

/// A wrist without a rotor in slow motion: the verification alone takes more than a minute.
#[test]
fn a_time_limit_stops_the_verification() {
    let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
    let ends = [[0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [1.5, -1.0, 1.2, -1.5, -1.57, 0.5]];
    let cost = Objective::new(0.0, vec![4.4e-5, 4.4e-5, 4.4e-5, 1.3e-3, 1.3e-3, 1.3e-3]);
    let mut problem = Problem::rest_to_rest(robot, &ends[0], &ends[1], 1000.0).with_cost(cost);
    problem.limits.from_robot = Some(true);
    let options = SolverOptions::default().with_tolerance(1e-6).with_time_limit(Duration::from_secs(5));
    let began = Instant::now();
    let solution = Solver::new(&problem, options).unwrap().solve();
    let taken = began.elapsed();
    assert!(taken < Duration::from_secs(30), "{taken:?}");
    assert!(!solution.motion.status.is_solved() && solution.motion.verification == Verify::None);
    assert!(solution.end_defect.is_infinite(), "{}", solution.end_defect);
}

/// Before a polish the direct method is rough: where the polish is stopped, its motion is none that was asked
/// for.
#[test]
fn a_rough_motion_is_no_solution_where_its_polish_is_stopped() {
    let problem = two_link();
    for starts in [1, 3] {
        let options = sharp().with_starts(starts).with_threads(1);
        let solver = Solver::new(&problem, options).unwrap();
        let mut polishes = false;
        let solution = solver.on_iteration(|step| {
            polishes |= step.phase == Phase::Polish;
            if polishes { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let solution = solution.solve();
        stopped(&solution, Status::Cancelled);
        assert_eq!(solution.motion.verification, Verify::None);
        assert!(solution.starts.iter().all(|start| !start.status.is_solved()), "{:?}", solution.starts);
        assert!(solution.check(&problem).is_err());
    }
}

#[test]
fn a_continuation_stops_at_a_point() {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0], &[std::f64::consts::PI], 1.0);
    let follow = || Continuation::new(&problem, Parameter::Gravity, 0.0, 1.0, sharp()).unwrap();
    let mut points = 0;
    let branch = follow().on_point(|point| {
        points += 1;
        if point.parameter > 0.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let branch = branch.follow();
    assert_eq!((points, branch.points.len()), (2, 2));
    assert_eq!(branch.end, BranchEnd::Interrupted);
    stopped(&branch.solution, Status::Cancelled);
    let cancel = Cancel::new();
    cancel.cancel();
    let branch = follow().with_cancel(cancel).follow();
    assert!(branch.end == BranchEnd::NotStarted && branch.points.is_empty());
    assert_eq!(branch.solution.motion.status, Status::Cancelled);
}

#[test]
fn bounds_that_are_too_tight_are_reported() {
    // A metre in a second from rest to rest takes 4 N.
    let bounds = Some(Bounds::symmetric(vec![3.0]));
    let problem = {
        let mut problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0);
        problem.bounds = bounds;
        problem
    };
    let options = SolverOptions::of(Method::Collocation).with_tolerance(1e-9);
    let solution = Solver::new(&problem, options).unwrap().solve();
    assert_eq!(solution.motion.status, Status::BoundsNotReached);
    let BoundViolation { control, time, u, bound, factor, .. } = solution.motion.bound_violation.unwrap();
    assert!(control == 0 && factor > 4.0 / 3.0 && factor < 1.5, "{factor}");
    assert!((u.abs() - 3.0 * factor).abs() < 1e-12 && bound == 3.0 * u.signum(), "{u} {bound}");
    // Neither the motion nor its figures.
    let motion = &solution.motion;
    assert!(solution.trajectory.t.is_empty() && motion.switches.is_empty());
    assert!(motion.cost == f64::INFINITY && motion.final_time.is_nan() && motion.hamiltonian.is_nan());

    let saved = serde_json::to_value(&solution).unwrap();
    assert_eq!(saved["status"], "bounds_not_reached");
    let expected = serde_json::json!({
        "joint": "x", "time": time, "u": u, "bound": bound, "factor": factor
    });
    assert_eq!(saved["bounds"], expected);
    for key in ["cost", "final_time", "hamiltonian", "end_defect"] {
        assert!(saved[key].is_null(), "{key}: {}", saved[key]);
    }
    let read: Solution = serde_json::from_value(saved.clone()).unwrap();
    assert_eq!(read.motion.bound_violation, solution.motion.bound_violation);
    assert_eq!(serde_json::to_value(&read).unwrap(), saved);
    let mut other = saved;
    other["bounds"]["joint"] = "wrist".into();
    let refused = serde_json::from_value::<Solution>(other).unwrap_err().to_string();
    assert!(refused.contains("'wrist'") && refused.contains("'x'"), "{refused}");
}

#[test]
fn phases_have_the_same_names_everywhere() {
    for phase in [Phase::FixedTime, Phase::Direct, Phase::WithoutLimits, Phase::Switches] {
        assert_eq!(serde_json::to_value(phase).unwrap(), phase.to_string());
    }
}

/// With several starts, on so many threads.
fn several(options: SolverOptions, threads: usize) -> SolverOptions {
    options.with_starts(5).with_seed(3).with_threads(threads)
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let problem = two_link().with_limits(MotionLimits::none());
    for options in [Method::Collocation, Method::Direct].map(SolverOptions::of) {
        let solve = |threads: usize| {
            let mut steps = 0;
            let solver = Solver::new(&problem, several(options.clone(), threads)).unwrap();
            let solver = solver.on_iteration(|_| {
                steps += 1;
                ControlFlow::Continue(())
            });
            let solution = solver.solve();
            assert_eq!(solution.starts.len(), 5);
            assert!(solution.newton_iterations >= steps);
            solution
        };
        let alone = solve(1);
        let costs: Vec<f64> = alone.starts.iter().map(|start| start.total).collect();
        assert!(costs.iter().any(|&cost| cost != costs[0]), "all starts are alike: {costs:?}");
        for threads in [2, 3, 8] {
            let together = solve(threads);
            assert_eq!(together.starts, alone.starts, "{threads}");
            assert_eq!(together.trajectory, alone.trajectory);
            assert_eq!(together.motion.iterations, alone.motion.iterations);
        }
    }
}

#[test]
fn all_threads_stop_together() {
    let problem = two_link().with_limits(MotionLimits::none());
    for options in [Method::Collocation, Method::Direct].map(SolverOptions::of) {
        let options = several(options, 3).with_starts(1_000_000);
        let mut steps = 0;
        let solver = Solver::new(&problem, options.clone()).unwrap();
        let solver = solver.on_iteration(|_| {
            steps += 1;
            if steps < 40 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        let starts = solver.solve().starts.len();
        // Each thread may finish the step that it is at.
        assert!((40..=40 + 2 * 3).contains(&steps) && starts < 40, "{steps} steps, {starts} starts");
        let limited = options.clone().with_time_limit(Duration::from_millis(50));
        let solution = Solver::new(&problem, limited).unwrap().solve();
        assert!((1..1_000_000).contains(&solution.starts.len()));
        let cancel = Cancel::new();
        cancel.cancel();
        let solution = Solver::new(&problem, options).unwrap().with_cancel(cancel).solve();
        stopped(&solution, Status::Cancelled);
        assert_eq!(solution.starts.len(), 1);
    }
    let none = SolverOptions::default().with_threads(0);
    assert!(Solver::new(&problem, none).unwrap_err().to_string().contains("threads"));
}

/// The least-time motion of the two-link arm with limited jerks. Its first mesh does not reach the tolerance.
fn jerk_limited() -> Problem {
    let mut problem = two_link();
    problem.time = FinalTime::Free { guess: 2.0 };
    let limits = MotionLimits::none().with_v_max(vec![2.0; 2]).with_jerk_max(vec![60.0, 80.0]);
    problem.with_cost(Objective::new(1.0, vec![0.0; 2])).with_limits(limits)
}

/// The last motion that is solved on its mesh is kept where a later mesh is not, with its accuracy.
#[test]
fn a_search_that_stops_on_a_finer_mesh_keeps_the_motion_of_the_coarser_one() {
    let problem = jerk_limited();
    let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never);
    let (mut meshes, mut steps) = (vec![], 0);
    let solver = Solver::new(&problem, options.clone()).unwrap().on_iteration(|iteration| {
        if meshes.last() != Some(&iteration.nodes) {
            meshes.push(iteration.nodes);
        }
        steps += usize::from(meshes.len() == 3);
        if steps == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let stopped = solver.solve();
    assert_eq!((meshes.len(), stopped.motion.status.clone()), (3, Status::Cancelled), "{meshes:?}");
    kept(&stopped, &problem, meshes[1]);
    // The same as where no finer mesh is allowed.
    let ended = Solver::new(&problem, options.with_max_nodes(meshes[1])).unwrap().solve();
    assert_eq!(ended.motion.status, Status::MeshLimit);
    kept(&ended, &problem, meshes[1]);
    assert!((ended.total() / stopped.total() - 1.0).abs() < 1e-12, "{} {}", ended.total(), stopped.total());
    assert_eq!(ended.cost_error(), stopped.cost_error());
}

/// A motion on so many nodes that keeps all limits at its points, and costs about what the solution costs, as
/// it says.
fn kept(found: &Solution, problem: &Problem, nodes: usize) {
    let options = SolverOptions::default().with_tolerance(1e-8).with_polish(Polish::Never);
    let options = options.with_verify(Verify::Factors);
    let exact = Solver::new(problem, options).unwrap().solve().total();
    let error = found.cost_error().unwrap();
    assert!(error > 1e-6 && error < 0.1, "{error}");
    assert!((found.total() / exact - 1.0).abs() < 10.0 * error, "{} {exact} {error}", found.total());
    assert_eq!(found.mesh_nodes(), nodes);
    let [rate, jerk] = [&found.limits.rate, &found.limits.jerk].map(|found| found.as_ref().unwrap());
    assert!(rate.worst.is_none() && jerk.worst.is_none(), "{rate:?} {jerk:?}");
}
