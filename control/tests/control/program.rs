//! The program of a motion on one mesh, solved by the solver for staged programs, against the direct method.

use crate::loops::{FREE, crank, four_bar};
use costate::robot::Robot;
use costate_control::{
    FinalTime, MotionLimits, MotionProgram, Objective, Polish, Problem, ProgramRow, Solver, SolverOptions,
    Task, Tool, ToolPose,
};
use costate_nlp::{
    Blocks, Certificate, Element, Iteration, Settings, SparseProgram, StagedProblem, Start, Status, Values,
    Weights,
};
use std::ops::ControlFlow;

/// Points of 30 intervals.
const NODES: usize = 91;

fn robot(file: &str) -> Robot {
    Robot::from_file(format!("../robots/{file}")).unwrap()
}

/// The cost of the program, certified as a local minimum or as what is allowed too, and what the direct
/// method says with its own meshes.
fn costs(problem: &Problem, allowed: Certificate) -> [f64; 2] {
    let mut program = problem.nlp(&SolverOptions::default().with_nodes(NODES)).unwrap();
    let mut solver = costate_nlp::Solver::new(program.layout(), Settings::default());
    let start = program.start().to_vec();
    let solution = solver.solve(&mut program, &start).unwrap();
    assert!(matches!(solution.status, Status::Solved | Status::SolvedToRounding), "{:?}", solution.status);
    assert!(solution.dependent.is_empty(), "{:?}", solution.dependent);
    let (cost, point, multipliers) = (solution.cost, solution.point.to_vec(), solution.ranges.to_vec());
    let certificate = solver.certify(&mut program).unwrap();
    assert!(certificate == Certificate::LocalMinimum || certificate == allowed, "{certificate:?}");
    // Multipliers of limits that are not reached are small, and ranges are kept.
    let [lower, upper] = program.bounds().map(<[f64]>::to_vec);
    let sizes = program.scales().unwrap().ranges.clone();
    let mut sparse = SparseProgram::at(program, &point);
    let mut values = vec![0.0; sparse.constraints()];
    sparse.constraints_at(&vec![0.0; sparse.variables()], &mut values).unwrap();
    let (equalities, ranges) = values.split_at(sparse.constraints() - lower.len());
    let rows = sparse.problem();
    assert_eq!((rows.equalities().len(), rows.ranges().len()), (equalities.len(), ranges.len()));
    assert!(equalities.iter().all(|value| value.abs() < 1e-6), "{equalities:?}");
    for (i, (row, value)) in rows.ranges().iter().zip(ranges).enumerate() {
        let inside = (value - lower[i]).min(upper[i] - value);
        assert!(inside > -1e-6 * sizes[i], "{row:?}: {value}");
        let multiplier = multipliers[i] * sizes[i];
        assert!(inside < 1e-3 * sizes[i] || multiplier.abs() < 1e-3 * cost, "{row:?}: {multiplier}");
    }
    let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never);
    [cost, Solver::new(problem, options).unwrap().solve().total()]
}

#[test]
fn programs_have_the_minima_of_the_direct_method() {
    let two_link = || robot("two_link.toml");
    let from = || Problem::rest_to_rest(two_link(), &[0.0, 0.0], &[1.5, 1.5], 1.0);
    let bounded = MotionLimits::none().with_torque_max(vec![80.0, 25.0]).with_v_max(vec![2.2, 2.4]);
    let mut least_time = from().with_limits(MotionLimits::none().with_torque_max(vec![60.0, 15.0]));
    least_time.cost = Objective::new(1.0, vec![0.0; 2]);
    least_time.time = FinalTime::Free { guess: 1.0 };
    let jerk = MotionLimits::none().with_jerk_max(vec![60.0, 80.0]);
    let passive = MotionLimits::none().with_torque_max(vec![f64::INFINITY, 0.0]);
    let cart = Problem::rest_to_rest(robot("cart_pole.toml"), &[0.1, 0.3], &[0.8, -0.4], 1.3);
    let cart = cart.with_limits(passive);
    let cases = [
        ("plain", from(), 1e-6),
        ("limits", from().with_limits(bounded), 1e-4),
        ("jerks", from().with_limits(jerk), 1e-3),
        ("least time", least_time, 2e-3),
        ("a joint without a motor", cart, 1e-5),
        ("a loop", crank(four_bar(), FREE), 1e-5),
        ("a tool at the end", with_tip_at_end(), 1e-5),
    ];
    for (name, problem, tolerance) in cases {
        // Second derivatives alone do not decide where the limits determine the motion up to its multipliers.
        let allowed = if name == "least time" { Certificate::Undecided } else { Certificate::LocalMinimum };
        let [cost, expected] = costs(&problem, allowed);
        assert!((cost / expected - 1.0).abs() < tolerance, "{name}: {cost} {expected}");
    }
}

/// Where the motion goes backward in time, and of a point that is not the last one.
#[test]
fn programs_say_where_they_have_no_values() {
    let limits = MotionLimits::none().with_torque_max(vec![60.0, 15.0]);
    let mut problem = Problem::rest_to_rest(robot("two_link.toml"), &[0.0, 0.0], &[1.5, 1.5], 1.0);
    (problem.cost, problem.time) = (Objective::new(1.0, vec![0.0; 2]), FinalTime::Free { guess: 1.0 });
    let mut program = problem.with_limits(limits).nlp(&SolverOptions::default().with_nodes(10)).unwrap();
    let layout = program.layout().clone();
    let (mut values, mut blocks) = (Values::new(&layout), Blocks::new(&layout));
    let (start, ones) = (program.start().to_vec(), vec![1.0; layout.ranges()]);
    let mut backward = start.clone();
    backward[layout.shared().start] = -1.0;
    let weights = Weights { cost: 1.0, equalities: &[], ranges: &ones };
    program.evaluate(&start, &mut values).unwrap();
    program.evaluate(&backward, &mut values).unwrap();
    assert!(values.cost.is_nan() && values.ranges.iter().all(|value| value.is_nan()));
    program.linearise(&backward, weights, &mut blocks).unwrap();
    assert!(blocks.of(Element::Interval(0)).gradient.iter().all(|slope| slope.is_nan()));
    assert!(program.sample(&backward).is_err() && program.sample(&start).is_ok());
    let gradient = |program: &mut MotionProgram| {
        let mut blocks = Blocks::new(&layout);
        program.linearise(&start, weights, &mut blocks).unwrap();
        blocks.of(Element::Interval(0)).gradient.clone()
    };
    let found = gradient(&mut program);
    program.evaluate(&start, &mut values).unwrap();
    assert_eq!(found, gradient(&mut program));
    assert!(found.iter().all(|slope| slope.is_finite()));
}

/// Everything is given: there is nothing to find, and no panic.
#[test]
fn programs_may_have_no_unknowns() {
    let mut problem = Problem::rest_to_rest(robot("two_link.toml"), &[0.0, 0.0], &[0.5, 0.5], 1.0);
    (problem.start.a, problem.end.a) = (Some(vec![0.0; 2]), Some(vec![0.0; 2]));
    let problem = problem.with_limits(MotionLimits::none().with_jerk_max(vec![500.0; 2]));
    let mut program = problem.nlp(&SolverOptions::default().with_nodes(5)).unwrap();
    let layout = program.layout().clone();
    assert_eq!((layout.intervals(), layout.steps()), (1, 0));
    let (mut values, mut blocks) = (Values::new(&layout), Blocks::new(&layout));
    program.evaluate(&[], &mut values).unwrap();
    let ones = vec![1.0; layout.ranges()];
    program.linearise(&[], Weights { cost: 1.0, equalities: &[], ranges: &ones }, &mut blocks).unwrap();
    assert!(values.are_finite() && layout.ranges() > 0);
}

#[test]
fn rows_have_names_units_and_places() {
    let problem = Problem::rest_to_rest(robot("cart_pole.toml"), &[0.0, 0.0], &[0.5, 0.1], 1.0);
    let problem = problem.with_limits(MotionLimits::none().with_torque_max(vec![20.0, 0.0]));
    let mut program = problem.nlp(&SolverOptions::default().with_nodes(10)).unwrap();
    let [passive, limited] = [program.equalities(), program.ranges()];
    assert_eq!((passive.len(), limited.len()), (9, 9));
    assert!(passive.iter().all(|row| (row.kind, &*row.name, row.unit) == ("torque", "pole", "N m")));
    assert!(limited.iter().all(|row| (row.kind, &*row.name, row.unit) == ("torque", "cart", "N")));
    assert!(limited.windows(2).all(|rows| rows[0].place < rows[1].place));
    let start = program.start().to_vec();
    let samples = program.sample(&start).unwrap();
    assert_eq!(samples.len(), 9);
    assert!(samples.iter().all(|sample| sample.t > 0.0 && sample.t < 1.0 && sample.tau.len() == 2));
}

/// The first step of a motion whose Hessian is indefinite is one of Gauss and Newton.
#[test]
fn programs_offer_convex_hessians() {
    let problem = Problem::rest_to_rest(robot("two_link.toml"), &[0.0; 2], &[3.0, -2.5], 0.3);
    let mut program = problem.with_limits(MotionLimits::none()).nlp(&SolverOptions::default()).unwrap();
    let mut solver = costate_nlp::Solver::new(program.layout(), Settings::default());
    let start = program.start().to_vec();
    let mut seen = Vec::new();
    let observer = |iteration: Iteration| {
        seen.push((iteration.is_exact, iteration.regularisation));
        ControlFlow::Continue(())
    };
    let solution = solver.solve_observed(&mut program, Start::at(&start), observer).unwrap();
    assert_eq!(solution.status, Status::Solved);
    assert!(seen.contains(&(false, 0.0)), "{seen:?}");
}

/// A motion to a place of the tip.
fn with_tip_at_end() -> Problem {
    let mut problem = Problem::rest_to_rest(robot("two_link.toml"), &[0.0; 2], &[1.0, 0.5], 1.0);
    problem.end.q_free = vec![0, 1];
    let tip = Tool::new("joint:elbow").with_offset([1.0, 0.0, 0.0]);
    let tip = ToolPose::of(tip).with_position([0.4, 1.2, FREE]);
    problem.with_limits(MotionLimits::none()).with_task(Task::default().with_end_tool(tip))
}

/// Rows of a task at an end are those of that end.
#[test]
fn rows_at_ends_have_names() {
    let program = with_tip_at_end().nlp(&SolverOptions::default().with_nodes(10)).unwrap();
    let rows = program.equalities();
    let is_at_end = |row: &ProgramRow| row.kind == "task" && row.place.to_bits() == 1.0_f64.to_bits();
    assert!(rows.len() == 2 && rows.iter().all(is_at_end), "{rows:?}");
}
