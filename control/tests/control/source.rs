//! Extremals as generated code.

use crate::sharp;
use costate::codegen::Program;
use costate::robot::{LoadOptions, Robot};
use costate::scalar::Scalar;
use costate_control::{
    BoundaryValueProblem, Bounds, ControlLaw, FinalTime, GeneratedExtremal, JacobianRoute, Penalty, Problem,
    ProgramOf, RobotExtremal, RunningCost, SourceError, UserTerm, pontryagin_program, solve_extremal,
};
use std::cell::Cell;

struct Swing;

impl RunningCost for Swing {
    fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
        q.iter().zip(v).fold(S::zero(), |sum, (&q, &v)| sum + (q.sin_cos().1 * v * v).times(0.7))
    }
}

fn robots() -> Vec<Robot> {
    let options = LoadOptions::default().friction(true);
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let names =
        ["two_link.toml", "cart_pole.toml", "manutec_r3.toml", "puma560.toml", "ur5.urdf", "panda.urdf"];
    let mut files: Vec<_> = names.iter().map(|name| folder.join("../robots").join(name)).collect();
    files.push(folder.join("../tests/fixtures/friction_tree.toml"));
    files.push(folder.join("../tests/fixtures/mimic_tree.toml"));
    files.iter().map(|file| Robot::from_file_with(file, options).unwrap()).collect()
}

/// The same task with a growing number of terms in the cost.
fn problems(robot: &Robot) -> Vec<Problem> {
    let n = robot.dof();
    let plain = Problem::rest_to_rest(robot.clone(), &vec![0.1; n], &vec![0.7; n], 1.0);
    let mut bounded = plain.clone();
    bounded.cost.time = 0.3;
    bounded.cost.effort = (0..n).map(|i| 0.5 + 0.2 * i as f64).collect();
    bounded.gain = (0..n).map(|i| 1.5 - 0.4 * i as f64).collect();
    let (mut u_min, mut u_max) = (vec![-0.4; n], vec![0.5; n]);
    (u_min[n - 1], u_max[0]) = (f64::NEG_INFINITY, f64::INFINITY);
    bounded.bounds = Some(Bounds::new(u_min, u_max));
    let mut held = bounded.clone();
    held.bounds = Some(Bounds::new(vec![-0.4; n], vec![0.5; n]));
    held.cost.effort[0] = 0.0;
    let mut v_max = vec![0.3; n];
    v_max[0] = f64::INFINITY;
    held.penalty =
        Some(Penalty::new(30.0).with_q_min(vec![-0.1; n]).with_q_max(vec![0.2; n]).with_v_max(v_max));
    let mut priced = held.clone();
    priced.terms = vec![UserTerm::new(Swing)];
    vec![plain, bounded, held, priced]
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    let size = expected.iter().fold(1.0_f64, |size, entry| size.max(entry.abs()));
    assert_eq!(found.len(), expected.len());
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= 1e-12 * size, "{what}: entry {i} is {found}, not {expected}");
    }
}

#[test]
fn programs_of_extremals_agree_with_the_library() {
    let mut random = fastrand::Rng::with_seed(3);
    let (mut inside, mut outside, mut work) = (0, 0, Vec::new());
    for problem in robots().iter().flat_map(problems) {
        let m = 4 * problem.robot.dof();
        let programs = ProgramOf::ALL.map(|of| pontryagin_program(&problem, of).unwrap());
        let mut extremal = RobotExtremal::new(problem.check().unwrap(), JacobianRoute::Exact).unwrap();
        for _ in 0..3 {
            let z: Vec<f64> = (0..m).map(|_| 2.0 * random.f64() - 1.0).collect();
            let (mut g, mut jacobian) = (vec![0.0; m], vec![0.0; m * m]);
            let rate = extremal.linearise(&z, ControlLaw::Maximal, &mut g, &mut jacobian).unwrap();
            let l = [rate.cost, rate.penalty];
            for program in &programs {
                let mut results = vec![0.0; program.outputs()];
                program.evaluate(&z, &mut results, &mut work).unwrap();
                assert_close(&results[..m], &g, program.name());
                assert_close(&results[m..m + 2], &l, program.name());
                if program.outputs() > m + 2 {
                    assert_close(&results[m + 2..], &jacobian, program.name());
                }
            }
            let slopes = (0..m / 4).map(|i| jacobian[(m / 4 + i) * m + 3 * m / 4 + i]);
            let (at_bound, free): (Vec<f64>, Vec<f64>) = slopes.partition(|slope| *slope == 0.0);
            (outside, inside) = (outside + at_bound.len(), inside + free.len());
        }
    }
    assert!(inside > 100 && outside > 100, "{inside} controls within their bounds, {outside} at one");
}

#[test]
fn the_source_begins_with_its_cost() {
    let problem = &problems(&robots()[0])[3];
    let program = pontryagin_program(problem, ProgramOf::Jacobian).unwrap();
    assert_eq!(program.name(), "two_link_pontryagin");
    let source = program.to_rust(&Default::default()).unwrap();
    for part in ["r = [0.0, 0.7]", "B = diag [1.5, 1.1]", "-0.4", "v_max = [inf, 0.3]", "Swing", "8 x 8"] {
        assert!(source.contains(part), "{part} is not in {}", &source[..1500]);
    }
    let mut wrong = problem.clone();
    wrong.gain[1] = 0.0;
    let refused = pontryagin_program(&wrong, ProgramOf::Rate);
    assert!(matches!(refused, Err(SourceError::Problem(_))), "{refused:?}");
}

/// Writes all results of a program one after the other.
fn run(program: &Program, z: &[f64], work: &mut Vec<f64>, results: &mut [&mut [f64]]) {
    let mut all = vec![0.0; program.outputs()];
    program.evaluate(z, &mut all, work).unwrap();
    let mut rest = all.as_slice();
    for result in results {
        let (now, later) = rest.split_at(result.len());
        result.copy_from_slice(now);
        rest = later;
    }
    assert!(rest.is_empty());
}

#[test]
fn the_solver_runs_on_generated_equations() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let to = std::f64::consts::FRAC_PI_2;
    let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[to, to], 1.0);
    let [rate, linear] = ProgramOf::ALL.map(|of| pontryagin_program(&problem, of).unwrap());
    let (mut work, mut other, calls) = (Vec::new(), Vec::new(), Cell::new((0, 0)));
    let mut extremal = GeneratedExtremal::new(
        &problem,
        |z, z_t, l| {
            calls.set((calls.get().0 + 1, calls.get().1));
            run(&rate, z, &mut work, &mut [z_t, l]);
        },
        |z, z_t, l, z_t_z| {
            calls.set((calls.get().0, calls.get().1 + 1));
            run(&linear, z, &mut other, &mut [z_t, l, z_t_z]);
        },
    )
    .unwrap();
    let guess = |s: f64, z: &mut [f64]| {
        z.fill(0.0);
        z[..2].fill(to * s * s * (3.0 - 2.0 * s));
    };
    let motion = solve_extremal(&mut extremal, FinalTime::Fixed(1.0), &sharp(), guess);
    assert!(motion.motion.status.is_converged(), "{}", motion.motion.status);
    assert!((motion.motion.cost - 145.131_137_54).abs() < 1e-7, "{}", motion.motion.cost);
    assert!(calls.get().0 > 100 && calls.get().1 > 100, "{:?}", calls.get());
}
