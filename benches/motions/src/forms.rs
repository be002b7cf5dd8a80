//! What the direct method has as unknowns: positions alone, or states and torques.

use crate::clock::cpu_time;
use crate::measure::median;
use crate::problems::{Failure, of_file, panda_with_rotors};
use crate::tables::{duration, markdown};
use costate::dynamics::Dynamics;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate_control::{
    Bounds, DirectDynamics, DynamicsProblem, EndState, FinalTime, MachineCode, MotionLimits, Polish, Problem,
    Solver, SolverOptions,
};
use std::ops::ControlFlow;

/// The relative error of the cost at which forms are compared, and the tolerances from which each chooses.
const ERROR: f64 = 1e-6;
const TOLERANCES: [f64; 5] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
/// The tolerance of the motion whose cost counts as exact.
const EXACT: f64 = 1e-9;
/// Torques are limited to this part of the largest ones of the motion without limits.
const PART: f64 = 0.75;

/// Points of an interval, on both sides.
const POINTS: usize = 3;

/// One solve.
struct Solved {
    cost: f64,
    /// CPU time (s).
    seconds: f64,
    /// Those of the mesh before each Newton step, and of the last mesh.
    intervals: Vec<usize>,
}

/// The fastest solve whose cost is exact enough.
#[derive(Clone, Copy)]
struct Form {
    /// CPU time of the whole solve, and of it for an interval in a Newton step (s).
    solve: f64,
    interval: f64,
    steps: usize,
    intervals: usize,
}

/// Times of three forms for effort and bounded torques, of three robots.
pub fn table(short: bool) -> Result<String, Failure> {
    let repeats = if short { 1 } else { 15 };
    let free: [(&str, Problem); 3] = [
        ("two-link arm", of_file("two_link.toml")?),
        ("PUMA 560", of_file("puma560_pick_and_place.toml")?),
        ("Panda with rotors", panda_with_rotors()?),
    ];
    let mut rows = Vec::new();
    for (name, problem) in &free {
        // States and torques know no limits of the robot.
        let problem = &problem.clone().with_limits(MotionLimits::none().with_from_robot(false));
        let bounded = bounded(problem)?;
        for (what, problem) in [("effort", problem), ("bounded torques", &bounded)] {
            rows.extend(of_problem(&format!("{name}, {what}"), problem, repeats)?);
        }
    }
    let head = ["motion", "unknowns", "an interval", "intervals", "steps", "solve", "times q alone"];
    Ok(markdown(&head, &rows))
}

/// The same motion with torques that are limited to a part of those that it needs.
fn bounded(problem: &Problem) -> Result<Problem, Failure> {
    let motion = Solver::new(problem, options(1e-6))?.solve().trajectory;
    let most: Vec<f64> = (0..problem.robot.dof())
        .map(|i| PART * motion.u.iter().map(|u| u[i].abs()).fold(0.0, f64::max))
        .collect();
    let least = most.iter().map(|most| -most).collect();
    Ok(problem.clone().with_bounds(Bounds::new(least, most)))
}

fn options(tolerance: f64) -> SolverOptions {
    SolverOptions::default().with_tolerance(tolerance).with_polish(Polish::Never)
}

fn of_problem(name: &str, problem: &Problem, repeats: usize) -> Result<Vec<Vec<String>>, Failure> {
    let exact = Solver::new(problem, options(EXACT))?.solve().motion.cost;
    let code = fastest(|tolerance| alone(problem, MachineCode::AtOnce, tolerance, exact, repeats))?;
    let generic = fastest(|tolerance| alone(problem, MachineCode::Never, tolerance, exact, repeats))?;
    let robot = &problem.robot;
    let momenta = fastest(|tolerance| {
        states(problem, || HamiltonianSecondOrder::<f64>::new(robot), tolerance, exact, repeats)
    })?;
    let rates = fastest(|tolerance| {
        states(problem, || LagrangianSecondOrder::<f64>::new(robot), tolerance, exact, repeats)
    })?;
    let forms = [("q, machine code", code), ("q", generic), ("q, p, u", momenta), ("q, v, u", rates)];
    let line = |(unknowns, form): (&str, Option<Form>)| {
        let of = |text: &dyn Fn(Form) -> String| form.map_or_else(|| "-".to_owned(), text);
        let ratio =
            |form: Form| generic.map_or_else(|| "-".into(), |q| format!("{:.2}", form.solve / q.solve));
        vec![
            name.to_owned(),
            unknowns.to_owned(),
            of(&|form| duration(form.interval)),
            of(&|form| form.intervals.to_string()),
            of(&|form| form.steps.to_string()),
            of(&|form| duration(form.solve)),
            of(&ratio),
        ]
    };
    Ok(forms.into_iter().map(line).collect())
}

/// The fastest one over all tolerances; none if no cost is exact enough.
fn fastest(mut solve: impl FnMut(f64) -> Result<Option<Form>, Failure>) -> Result<Option<Form>, Failure> {
    let mut best: Option<Form> = None;
    for tolerance in TOLERANCES {
        if let Some(form) = solve(tolerance)? {
            best = best.filter(|best| best.solve <= form.solve).or(Some(form));
        }
    }
    Ok(best)
}

/// Positions alone are unknowns: the direct method for robots.
fn alone(
    problem: &Problem,
    code: MachineCode,
    tolerance: f64,
    exact: f64,
    repeats: usize,
) -> Result<Option<Form>, Failure> {
    let options = options(tolerance).with_machine_code(code);
    let solve = || -> Result<_, Failure> {
        let mut intervals = Vec::new();
        let solver = Solver::new(problem, options.clone())?.on_iteration(|iteration| {
            intervals.push((iteration.nodes - 1) / POINTS);
            ControlFlow::Continue(())
        });
        let began = cpu_time();
        let found = solver.solve();
        let seconds = cpu_time() - began;
        intervals.push((found.mesh_nodes() - 1) / POINTS);
        Ok(Solved { cost: found.motion.cost, seconds, intervals })
    };
    // Machine code is there after the first one.
    solve()?;
    repeated(solve, exact, repeats)
}

/// States and torques are unknowns: the direct method for models.
fn states<D: Dynamics<f64>>(
    problem: &Problem,
    model: impl Fn() -> D,
    tolerance: f64,
    exact: f64,
    repeats: usize,
) -> Result<Option<Form>, Failure> {
    let n = problem.robot.dof();
    let end = |q: &[f64]| EndState::fixed(&[q, &vec![0.0; n]].concat());
    let (start, end) = (end(&problem.start.q), end(&problem.end.q));
    let time = FinalTime::Fixed(problem.time.value());
    let mut task = DynamicsProblem::new(start, end, time, n).with_cost(problem.cost.clone());
    if let Some(bounds) = &problem.bounds {
        task = task.with_bounds(bounds.clone());
    }
    let options = SolverOptions::default().with_tolerance(tolerance);
    let solve = || {
        let mut direct = DirectDynamics::new(model(), &task)?;
        let began = cpu_time();
        let motion = direct.solve(&options)?;
        let seconds = cpu_time() - began;
        let mut intervals: Vec<usize> = motion.steps.iter().map(|step| step.intervals).collect();
        intervals.push(motion.intervals);
        Ok(Solved { cost: motion.cost, seconds, intervals })
    };
    repeated(solve, exact, repeats)
}

/// The medians of several solves; none if the cost is not exact enough.
fn repeated(
    solve: impl Fn() -> Result<Solved, Failure>,
    exact: f64,
    repeats: usize,
) -> Result<Option<Form>, Failure> {
    let (mut solves, mut parts, mut form) = (Vec::new(), Vec::new(), None);
    for _ in 0..repeats {
        let Solved { cost, seconds, intervals } = solve()?;
        if !is_exact(cost, exact) {
            return Ok(None);
        }
        solves.push(seconds);
        parts.push(seconds / intervals.iter().sum::<usize>() as f64);
        form = intervals.last().map(|&last| (intervals.len() - 1, last));
    }
    let (solve, interval) = (median(solves), median(parts));
    Ok(form.map(|(steps, intervals)| Form { solve, interval, steps, intervals }))
}

fn is_exact(cost: f64, exact: f64) -> bool {
    (cost / exact - 1.0).abs() <= ERROR
}
