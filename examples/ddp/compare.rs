//! Both methods on one task, and the evaluation of their logs.

use super::problem::{Curvature, Failure, Iteration, Options, Solution, Status};
use super::problems::Task;
use costate::dynamics::Cost;
use costate::step::Step;

/// The relative gradient at which a search ends.
pub const TOLERANCE: f64 = 1e-12;
/// Gradients below this are rounding errors in the estimate of the order.
pub const FLOOR: f64 = 1e-10;
/// Number of timed runs; the fastest counts.
const REPETITIONS: usize = 10;

/// Two solutions of one task.
pub struct Comparison {
    pub title: String,
    pub about: &'static str,
    pub exact: Solution,
    pub twin: Solution,
}

/// When a goal was reached: iteration and time (s).
#[derive(Clone, Copy)]
pub struct Reached {
    pub iteration: usize,
    pub seconds: f64,
}

/// The goals that are timed.
#[derive(Clone, Copy)]
pub enum Goal {
    /// Relative excess of the cost over that of the method's own solution.
    Cost(f64),
    /// The relative projected gradient.
    Gradient(f64),
}

impl Comparison {
    /// Solves the task by both methods.
    ///
    /// # Errors
    /// The errors of the solver.
    pub fn of<P: Step<f64>, L: Cost<f64>, T: Cost<f64>>(mut task: Task<P, L, T>) -> Result<Self, Failure> {
        let mut solve = |curvature| {
            let options = Options { curvature, iterations: 500, tolerance: TOLERANCE };
            task.problem.solve(&task.x, &task.u, &options)
        };
        let (mut exact, mut twin) = (solve(Curvature::Exact)?, solve(Curvature::GaussNewton)?);
        for _ in 1..REPETITIONS {
            keep_fastest(&mut exact, &solve(Curvature::Exact)?);
            keep_fastest(&mut twin, &solve(Curvature::GaussNewton)?);
        }
        Ok(Self { title: task.title, about: task.about, exact, twin })
    }

    /// Whether both end at the same cost.
    pub fn agree(&self) -> bool {
        let [a, b] = [&self.exact, &self.twin].map(|solution| solution.trajectory.cost);
        (a - b).abs() <= 1e-6 * a.abs().max(b.abs())
    }
}

fn keep_fastest(solution: &mut Solution, again: &Solution) {
    for (line, again) in solution.log.iter_mut().zip(&again.log) {
        line.seconds = line.seconds.min(again.seconds);
    }
}

/// When a search reached a goal.
pub fn reached(solution: &Solution, goal: Goal) -> Option<Reached> {
    let cost = solution.trajectory.cost;
    let there = |line: &Iteration| match goal {
        Goal::Cost(part) => line.cost - cost <= part * cost.abs(),
        Goal::Gradient(gradient) => line.gradient <= gradient,
    };
    let iteration = solution.log.iter().position(there)?;
    Some(Reached { iteration, seconds: solution.log[iteration].seconds })
}

/// The local order of convergence at each iteration, `ln(g_k/g_{k-1}) / ln(g_{k-1}/g_{k-2})` for gradients
/// that fall by at least a third.
pub fn orders(log: &[Iteration]) -> Vec<Option<f64>> {
    let mut orders = vec![None; log.len().min(2)];
    orders.extend(log.windows(3).map(|three| {
        let [before, last] = [three[1].gradient / three[0].gradient, three[2].gradient / three[1].gradient];
        (before.max(last) < 0.7).then(|| last.ln() / before.ln())
    }));
    orders
}

/// The gradients of the tail: at most the last five above rounding after full steps without regularisation,
/// and the first one below.
fn tail(solution: &Solution) -> Vec<f64> {
    let share = solution.log.iter().map(|line| line.share).fold(0.0, f64::max);
    let whole = |line: &Iteration| line.alpha == 1.0 && line.mu == 0.0 && line.share == share;
    let above = solution.log.iter().take_while(|line| line.gradient > FLOOR).count();
    let log = &solution.log[..(above + 1).min(solution.log.len())];
    let steps = log.iter().rev().skip(1).take(5).take_while(|line| whole(line)).count();
    log[log.len() - 1 - steps..].iter().map(|line| line.gradient).collect()
}

/// The order of convergence at the end: the larger one of the last two local orders of the tail.
///
/// The last gradient may be a rounding error, which can only reduce its order.
pub fn order(solution: &Solution) -> Option<f64> {
    let tail = tail(solution);
    let local = |three: &[f64]| {
        let [before, last] = [three[1] / three[0], three[2] / three[1]];
        (before < 1.0 && last < 1.0).then(|| last.ln() / before.ln())
    };
    tail.windows(3).rev().take(2).filter_map(local).reduce(f64::max)
}

/// The factor of the gradient in each iteration at the end: the geometric mean over the tail.
pub fn rate(solution: &Solution) -> Option<f64> {
    let tail = tail(solution);
    let (first, last) = (tail.first()?, tail.last()?);
    (tail.len() > 1).then(|| (last / first).powf(1.0 / (tail.len() - 1) as f64))
}

/// The status of a search as text.
pub fn ending(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::Rounding => "ended where the cost no longer tells steps apart",
        Status::Stuck => "got stuck",
        Status::Iterations => "used up its iterations",
    }
}
