//! Times of solving a problem: of the whole, of a Newton step, of the stages.

use crate::clock::cpu_time;
use costate_control::{Problem, ProblemError, Solution, Solver, SolverOptions, StageTimes};
use std::ops::ControlFlow;
use std::time::Instant;

/// Medians over several solves.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// CPU time of a Newton step that is not the first one on its mesh (s).
    pub step: f64,
    /// CPU time of the whole solve (s).
    pub solve: f64,
    /// Newton steps on all meshes.
    pub steps: usize,
    /// Nodes of the last mesh.
    pub nodes: usize,
    pub solved: bool,
}

/// CPU time for which short solves are repeated (s), and how often at most.
const LONG_ENOUGH: f64 = 0.25;
const MOST: usize = 100;

/// Solves at least so many times, after one solve that compiles the dynamics of the robot.
pub fn measure(problem: &Problem, options: &SolverOptions, repeats: usize) -> Result<Measured, ProblemError> {
    let (first, ..) = solve(problem, options)?;
    let (mut steps, mut solves) = (Vec::new(), Vec::new());
    let began = cpu_time();
    while solves.len() < repeats || (solves.len() < MOST && cpu_time() - began < LONG_ENOUGH) {
        let (_, more, whole) = solve(problem, options)?;
        steps.extend(more);
        solves.push(whole);
    }
    let nodes = first.motion.iterations.last().map_or(0, |last| last.nodes);
    let solved = first.motion.status.is_solved();
    let (step, solve) = (median(steps), median(solves));
    Ok(Measured { step, solve, steps: first.newton_iterations, nodes, solved })
}

/// One solve, the CPU times of its steps (s), and that of the whole (s).
fn solve(problem: &Problem, options: &SolverOptions) -> Result<(Solution, Vec<f64>, f64), ProblemError> {
    let began = cpu_time();
    let (mut steps, mut last) = (Vec::new(), began);
    let solver = Solver::new(problem, options.clone())?.on_iteration(|iteration| {
        if iteration.number > 1 {
            steps.push(cpu_time() - last);
        }
        last = cpu_time();
        ControlFlow::Continue(())
    });
    let solution = solver.solve();
    Ok((solution, steps, cpu_time() - began))
}

/// The solve that took least of so many: its solution, its time (s) and the times of its stages (s).
pub fn stages(
    problem: &Problem,
    options: &SolverOptions,
    repeats: usize,
) -> Result<(Solution, f64, StageTimes), ProblemError> {
    let (mut solution, mut least) = (Solver::new(problem, options.clone())?.solve(), f64::INFINITY);
    for _ in 0..repeats {
        let began = Instant::now();
        let found = Solver::new(problem, options.clone())?.with_stage_times().solve();
        let seconds = began.elapsed().as_secs_f64();
        if seconds < least {
            (solution, least) = (found, seconds);
        }
    }
    let times = solution.stage_times.unwrap_or_default();
    Ok((solution, least, times))
}

/// NaN of nothing.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let (count, middle) = (values.len(), values.len() / 2);
    match count {
        0 => f64::NAN,
        _ if count % 2 == 1 => values[middle],
        _ => (values[middle - 1] + values[middle]) / 2.0,
    }
}
