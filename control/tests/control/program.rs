//! The program of a motion on one mesh, solved by the solver for staged programs, against the direct method.

use crate::loops::{FREE, crank, four_bar};
use costate::robot::Robot;
use costate_control::{FinalTime, MotionLimits, Objective, Polish, Problem, Solver, SolverOptions};
use costate_nlp::{Certificate, Settings, SparseProgram, StagedProblem, Status};

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
    let mut sparse = SparseProgram::at(program, &point);
    let mut values = vec![0.0; sparse.constraints()];
    sparse.constraints_at(&vec![0.0; sparse.variables()], &mut values).unwrap();
    let (equalities, ranges) = values.split_at(sparse.constraints() - lower.len());
    let rows = sparse.problem();
    assert_eq!((rows.equalities().len(), rows.ranges().len()), (equalities.len(), ranges.len()));
    assert!(equalities.iter().all(|value| value.abs() < 1e-6), "{equalities:?}");
    for (i, (row, value)) in rows.ranges().iter().zip(ranges).enumerate() {
        let size = (upper[i] - lower[i]).min(1e3);
        let inside = (value - lower[i]).min(upper[i] - value);
        assert!(inside > -1e-6 * size, "{row:?}: {value}");
        assert!(inside < 1e-3 * size || multipliers[i].abs() < 1e-3 * cost, "{row:?}: {}", multipliers[i]);
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
    ];
    for (name, problem, tolerance) in cases {
        // Second derivatives alone do not decide where the limits determine the motion up to its multipliers.
        let allowed = if name == "least time" { Certificate::Undecided } else { Certificate::LocalMinimum };
        let [cost, expected] = costs(&problem, allowed);
        assert!((cost / expected - 1.0).abs() < tolerance, "{name}: {cost} {expected}");
    }
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
