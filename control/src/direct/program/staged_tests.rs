//! Derivatives against differences of values, for all kinds of rows, of phases and of ends.

use super::{Program, Work};
use crate::direct::limits::gait_rows::tests::{rabbit, rabbit_on_both_feet, seven_link, walker};
use crate::direct::motion::shape::Shape;
use crate::direct::motion::times::FreeTimes;
use crate::direct::newton::system::tests::case::{Case, Kind};
use crate::direct::points::values::PointDynamics;
use crate::direct::program::structure::{Row, Structure};
use crate::direct::solve::prepare::{Dynamics, interior};
use crate::options::SolverOptions;
use crate::problem::{MotionLimits, Problem};
use crate::task::build::TaskRows;
use costate::robot::Robot;
use costate_nlp::{Blocks, Layout, StagedProblem, Values, Weights};

/// Weights of the rows of a layout.
fn weights(layout: &Layout) -> [Vec<f64>; 2] {
    let some = |count: usize| (0..count).map(|i| (0.3 + 0.7 * i as f64).sin()).collect();
    [some(layout.equalities()), some(layout.ranges())]
}

/// Values, then gradient, Jacobians and Hessian without the elements they come from.
struct Derivatives {
    values: Values,
    gradient: Vec<f64>,
    equalities: Vec<Vec<f64>>,
    ranges: Vec<Vec<f64>>,
    hessian: Vec<Vec<f64>>,
}

fn derivatives<D: PointDynamics>(program: &mut Program<'_, D>, point: &[f64], cost: f64) -> Derivatives {
    weighted(program, point, cost, 1.0)
}

/// The same with all weights times a factor.
fn weighted<D: PointDynamics>(
    program: &mut Program<'_, D>,
    point: &[f64],
    cost: f64,
    factor: f64,
) -> Derivatives {
    let layout = program.layout().clone();
    let [y, v] = weights(&layout).map(|weights| weights.iter().map(|w| factor * w).collect::<Vec<_>>());
    let cost = factor * cost;
    let (mut values, mut blocks) = (Values::new(&layout), Blocks::new(&layout));
    program.evaluate(point, &mut values).unwrap();
    program.linearise(point, Weights { cost, equalities: &y, ranges: &v }, &mut blocks).unwrap();
    summed(&layout, values, &mut blocks)
}

/// All elements together.
fn summed(layout: &Layout, values: Values, blocks: &mut Blocks) -> Derivatives {
    let size = layout.steps();
    let zeros = |count: usize| vec![vec![0.0; size]; count];
    let (mut equalities, mut ranges) = (zeros(layout.equalities()), zeros(layout.ranges()));
    let (mut gradient, mut hessian) = (vec![0.0; size], zeros(size));
    for element in layout.elements() {
        let (block, columns) = (blocks.of(element), layout.unknowns(element).into_iter().flatten());
        for (a, i) in columns.clone().enumerate() {
            gradient[i] += block.gradient[a];
            for (row, to) in layout.equalities_of(element).enumerate() {
                equalities[to][i] += block.equalities[(row, a)];
            }
            for (row, to) in layout.ranges_of(element).enumerate() {
                ranges[to][i] += block.ranges[(row, a)];
            }
            for (b, j) in columns.clone().enumerate().skip(a) {
                hessian[i][j] += block.hessian[(a, b)];
                hessian[j][i] = hessian[i][j];
            }
        }
    }
    Derivatives { values, gradient, equalities, ranges, hessian }
}

/// Gradient and Jacobians are derivatives of the values, and the Hessian is that of the Lagrange function.
fn check<D: PointDynamics>(program: &mut Program<'_, D>, name: &str) {
    let point = program.work.origin.clone();
    let layout = program.layout().clone();
    let [y, v] = weights(&layout);
    let found = derivatives(program, &point, 0.7);
    let step = 1e-6;
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let slope = |found: &Derivatives, cost: f64, j: usize| {
        let of = |rows: &[Vec<f64>], weights: &[f64]| {
            dot(&rows.iter().map(|row| row[j]).collect::<Vec<_>>(), weights)
        };
        cost * found.gradient[j] + of(&found.equalities, &y) + of(&found.ranges, &v)
    };
    for j in 0..layout.steps() {
        let [before, after] = [-step, step].map(|step| {
            let mut moved = point.clone();
            moved[j] += step;
            derivatives(program, &moved, 0.7)
        });
        let close = |what: &str, i: usize, value: f64, [a, b]: [f64; 2], size: f64| {
            let difference = (b - a) / (2.0 * step);
            let error = (value - difference).abs();
            let bound = 1e-5 * (1.0 + size + difference.abs());
            assert!(error < bound, "{name}: {what} {i}, {j}: {value} {difference}");
        };
        let [a, b] = [&before, &after];
        close("gradient", 0, found.gradient[j], [a.values.cost, b.values.cost], found.values.cost.abs());
        for (i, row) in found.equalities.iter().enumerate() {
            close("equation", i, row[j], [a.values.equalities[i], b.values.equalities[i]], 0.0);
        }
        for (i, row) in found.ranges.iter().enumerate() {
            close("range", i, row[j], [a.values.ranges[i], b.values.ranges[i]], 0.0);
        }
        for i in 0..layout.steps() {
            let size = found.hessian[i][i].abs();
            close("Hessian", i, found.hessian[i][j], [a, b].map(|found| slope(found, 0.7, i)), size);
        }
    }
    // Of a cost in another unit, with multipliers in it.
    let small = weighted(program, &point, 0.7, 1e-20);
    let largest = found.hessian.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    for (found, small) in found.hessian.iter().flatten().zip(small.hessian.iter().flatten()) {
        assert!((found - 1e20 * small).abs() <= 1e-12 * largest, "{name}: {found} {small}");
    }
    // Without the cost.
    let [without, with] = [0.0, 1.0].map(|cost| derivatives(program, &point, cost));
    let [alone, both] = [&without, &found].map(|found| (found.hessian.clone(), found.gradient.clone()));
    for i in 0..layout.steps() {
        assert!((alone.1[i] - both.1[i]).abs() <= 1e-10 * (1.0 + both.1[i].abs()), "{name}");
        for j in 0..layout.steps() {
            let expected = (both.0[i][j] - 0.7 * with.hessian[i][j]) / 0.3;
            let size = 1.0 + with.hessian[i][i].abs().max(with.hessian[i][j].abs());
            assert!((alone.0[i][j] - expected).abs() < 1e-9 * size, "{name}: {i}, {j}");
        }
    }
}

fn check_case(case: &mut Case, name: &str) {
    case.barrier.distance.fill(0.0);
    let structure = Structure::new(&case.spline, &case.barrier, &case.ends, (0, 1.0));
    let mut work = Work::new(&case.spline, &mut case.barrier, &case.ends, &structure);
    let Case { spline, points, barrier, running, model, system, ends, .. } = case;
    let (structure, work) = (&structure, &mut work);
    check(&mut Program { spline, points, barrier, running, model, system, ends, structure, work }, name);
}

#[test]
fn derivatives_of_motions_are_those_of_their_values() {
    for shape in [Shape::Quartic, Shape::Quintic] {
        for kind in Kind::ALL {
            let cases = [("", Case::new(shape, kind)), (", coefficients", Case::with_hulls(shape, kind))];
            for (name, case) in cases {
                let (name, mut case) = (format!("{shape:?}, {kind:?}{name}"), case);
                check_case(&mut case, &name);
                case.ends.times = FreeTimes::new(&vec![true; case.spline.times.len() + 1]);
                check_case(&mut case, &format!("{name}, given times"));
            }
        }
    }
}

#[test]
fn derivatives_of_steps_are_those_of_their_values() {
    for problem in [walker(), rabbit(), rabbit_on_both_feet(), seven_link()] {
        check_problem(&problem);
    }
}

/// With one cost, that of torques, they are the squares of its derivatives, which limits of torques have too.
#[test]
fn convex_hessians_are_squares_of_torques() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.1, 0.2], &[1.5, 1.1], 0.8);
    let problem = problem.with_limits(MotionLimits::none().with_torque_max(vec![80.0, 40.0]));
    with_program(&problem, None, |program| {
        let (point, layout) = (program.work.origin.clone(), program.layout().clone());
        let (mut values, mut blocks) = (Values::new(&layout), Blocks::new(&layout));
        let [y, v] = weights(&layout);
        let weights = Weights { cost: 0.7, equalities: &y, ranges: &v };
        program.evaluate(&point, &mut values).unwrap();
        program.linearise(&point, weights, &mut blocks).unwrap();
        let exact = summed(&layout, values.clone(), &mut blocks);
        assert!(program.convexify(&point, weights, &mut blocks).unwrap());
        let convex = summed(&layout, values, &mut blocks);
        assert!(convex.gradient == exact.gradient && convex.ranges == exact.ranges);
        let (spline, barrier) = (&program.spline, &program.barrier);
        let weight = |row: &Row| {
            let p = barrier.point_of(row.entry).unwrap();
            0.7 * spline.duration()
                * spline.mesh.point(p).1
                * program.running.effort[barrier.side(row.entry).joint]
        };
        let weights: Vec<f64> = program.structure.ranges.iter().map(weight).collect();
        let largest = convex.hessian.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        for i in 0..layout.steps() {
            for j in 0..layout.steps() {
                let of = |(row, weight): (&Vec<f64>, &f64)| weight * row[i] * row[j];
                let expected: f64 = convex.ranges.iter().zip(&weights).map(of).sum();
                assert!((convex.hessian[i][j] - expected).abs() < 1e-12 * largest, "{i}, {j}");
            }
        }
        let most = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            let pairs = a.iter().flatten().zip(b.iter().flatten());
            pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
        };
        assert!(most(&exact.hessian, &convex.hessian) > 1e-3 * largest);
        // The exact one comes back.
        let again = derivatives(program, &point, 0.7);
        assert_eq!(most(&exact.hessian, &again.hessian), 0.0);
    });
}

/// With its own times, which are given, and with free ones.
fn check_problem(problem: &Problem) {
    let mut phases = 0;
    with_program(problem, None, |program| {
        phases = program.spline.times.len();
        check(program, "a step");
    });
    with_program(problem, Some(FreeTimes::all(phases)), |program| check(program, "a step in free time"));
}

fn with_program(problem: &Problem, times: Option<FreeTimes>, check: impl FnOnce(&mut Program<'_, Dynamics>)) {
    let rows = TaskRows::new(problem).unwrap();
    let options = SolverOptions::default().with_nodes(7);
    let mut interior = interior(problem, &rows, &options, 0, None);
    interior.start(None).unwrap();
    interior.ends.times = times.unwrap_or(interior.ends.times);
    let of_both = interior.model.tasks.rows_of_both_ends();
    let structure = Structure::new(&interior.spline, &interior.barrier, &interior.ends, (of_both, 1.0));
    let mut work = Work::new(&interior.spline, &mut interior.barrier, &interior.ends, &structure);
    let crate::direct::interior::iterate::Interior {
        spline,
        points,
        barrier,
        running,
        model,
        system,
        ends,
        ..
    } = &mut interior;
    let (structure, work) = (&structure, &mut work);
    check(&mut Program { spline, points, barrier, running, model, system, ends, structure, work });
}
