//! A primal-dual interior-point method on the nodes: Newton's method on the conditions of a barrier problem.
//!
//! The weight mu of the barrier goes to zero superlinearly; each step is that of a linear-quadratic problem
//! ([`crate::riccati`]), convexified by [`crate::convexify`] and shortened by [`crate::merit`].

use crate::barrier::{Barrier, Nodes};
use crate::bfgs::Blocks;
use crate::convexify::{Convex, convexify};
use crate::curvature::{Curvature, Model};
use crate::merit::{Merit, Move};
use crate::problem::{NotEvaluated, Problem};
pub use crate::solution::{Row, Solution, Status};
use costate::dynamics::Cost;
use costate::step::Step;
use nalgebra::DVector;

/// Initial damping, if requested.
const DAMPING: f64 = 1e-3;

/// Options of the solver.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    pub curvature: Curvature,
    /// Tolerance of each component of the optimality conditions.
    pub tolerance: f64,
    pub iterations: usize,
    /// Initial and final weight of the barrier.
    pub barrier: f64,
    pub least_barrier: f64,
}

impl Options {
    pub fn new(curvature: Curvature) -> Self {
        Self { curvature, tolerance: 1e-10, iterations: 300, barrier: 0.1, least_barrier: 1e-11 }
    }
}

/// Gradient of the Lagrangian with the multipliers of the bounds; zero in the components of given states.
pub fn stationarity<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(
    problem: &Problem<M, L, F>,
    model: &Model,
    costates: &[DVector<f64>],
    barrier: &Barrier,
) -> Nodes {
    let mut gradient = model.lagrangian_gradient(costates);
    barrier.add_multipliers(&mut gradient);
    gradient[0].rows_mut(0, problem.states()).fill(0.0);
    if problem.end.is_some() {
        gradient[problem.intervals].fill(0.0);
    }
    gradient
}

fn largest(nodes: &[DVector<f64>]) -> f64 {
    nodes.iter().map(DVector::amax).fold(0.0, f64::max)
}

/// Solves from a guess of the nodes, which is moved inside the bounds first.
pub fn solve<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(
    problem: &mut Problem<M, L, F>,
    guess: &[DVector<f64>],
    options: &Options,
) -> Solution {
    let mut barrier = Barrier::new(problem);
    let mut nodes = guess.to_vec();
    let undefined = nodes.iter().position(|node| node.iter().any(|z| !z.is_finite()));
    barrier.start(&mut nodes, options.barrier);
    let costates = vec![DVector::zeros(problem.states()); problem.intervals];
    let mut solution = Solution { status: Status::IterationLimit, nodes, costates, barrier, log: Vec::new() };
    if let Some(k) = undefined {
        solution.status = Status::NotEvaluated(NotEvaluated(format!("node {k} of the guess is not finite")));
        return solution;
    }
    match iterate(problem, &mut solution, options) {
        Ok(status) => solution.status = status,
        Err(error) => solution.status = Status::NotEvaluated(error),
    }
    solution
}

fn iterate<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(
    problem: &mut Problem<M, L, F>,
    at: &mut Solution,
    options: &Options,
) -> Result<Status, NotEvaluated> {
    let mut mu = if at.barrier.is_empty() { 0.0 } else { options.barrier };
    let enough = options.tolerance.max(1.1 * options.least_barrier);
    let mut learnt: Option<Blocks> = None;
    let mut merit = Merit::default();
    let mut share = 0.0;
    let mut damping = DAMPING;
    for iteration in 0..=options.iterations {
        let mut model = problem.model(&at.nodes, &at.costates, options.curvature)?;
        let violation = model.values.violation();
        let dual = largest(&stationarity(problem, &model, &at.costates, &at.barrier));
        let feasible = violation.max(dual);
        while mu > options.least_barrier
            && feasible.max(at.barrier.complementarity(&at.nodes, mu)) <= 10.0 * mu
        {
            mu = options.least_barrier.max((0.2 * mu).min(mu.powf(1.5)));
            merit.forget();
        }
        let complementarity = at.barrier.complementarity(&at.nodes, 0.0);
        at.log.push(Row {
            cost: model.values.cost,
            violation,
            dual,
            complementarity,
            centrality: at.barrier.complementarity(&at.nodes, mu),
            mu,
            step: 0.0,
            part: 0.0,
            convexified: 0.0,
            second_order: false,
        });
        if feasible <= options.tolerance && complementarity <= enough {
            return Ok(Status::Solved);
        }
        if iteration == options.iterations {
            break;
        }
        if options.curvature == Curvature::Bfgs {
            let blocks = learnt.get_or_insert_with(|| Blocks::new(&model));
            let fresh = problem.model(&at.nodes, &at.costates, options.curvature)?;
            blocks.learn(&at.nodes, fresh, &at.costates);
            model.hessian.clone_from(&blocks.hessian);
        }
        if options.curvature == Curvature::Damped {
            let blocks = model.hessian.iter_mut();
            blocks.for_each(|block| (0..problem.states()).for_each(|i| block[(i, i)] += damping));
        }
        let Some((convex, step)) = advance(problem, at, &model, &mut merit, mu, share) else {
            // The BFGS updates may be the reason: retry without them.
            if learnt.take().is_some_and(|blocks| blocks.updates > 0) {
                continue;
            }
            return Ok(Status::Stalled);
        };
        share = convex.share;
        damping = (damping * if step.shortened { 4.0 } else { 0.25 }).clamp(1e-10, 1e2);
        if let Some(row) = at.log.last_mut() {
            row.step = largest(&step.full);
            row.part = step.part;
            row.convexified = convex.share;
            row.second_order = step.second_order;
        }
        let tau = (1.0 - mu).max(0.99);
        at.barrier.move_multipliers(&at.nodes, &step.full, mu, tau);
        for ((costate, new), part) in
            at.costates.iter_mut().zip(&step.costates).zip(std::iter::repeat(step.part))
        {
            *costate += (new - &*costate) * part;
        }
        at.nodes = step.nodes;
        at.barrier.restrain(&at.nodes, mu);
    }
    Ok(Status::IterationLimit)
}

/// The next nodes: with the Hessian itself if possible, else with its positive part.
fn advance<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(
    problem: &mut Problem<M, L, F>,
    at: &Solution,
    model: &Model,
    merit: &mut Merit,
    mu: f64,
    last: f64,
) -> Option<(Convex, Move)> {
    let diagonal = at.barrier.diagonal(&at.nodes);
    let mut gradient = at.barrier.gradient(&at.nodes, mu);
    gradient.iter_mut().zip(&model.gradient).for_each(|(sum, part)| *sum += part);
    for least in [0.0, 1.0] {
        let Ok(convex) =
            convexify(&model.hessian, &diagonal, &model.jacobian, problem.end.is_some(), last, least)
        else {
            continue;
        };
        if let Some(step) = merit.search(problem, at, model, &convex, &gradient, mu) {
            return Some((convex, step));
        }
    }
    None
}
