//! Fallback of the solver: finds how close to the end a motion can come.

use crate::curvature::Curvature;
use crate::problem::{Bounds, Problem};
use crate::solver::{Options, Solution, Status, solve};
use costate::dynamics::{Cost, QuadraticCost};
use costate::step::Step;
use nalgebra::DVector;

/// Weight of the effort, relative to the bounds, added to the squared distance from the end; it makes the
/// controls unique.
const EFFORT: f64 = 1e-6;
/// An end is out of reach if the remaining distance, relative to its largest component or 1, exceeds this.
const MISSED: f64 = 1e-3;

/// [`solve`]; if that does not reach a given end, the squared distance from the end is minimised. If the
/// nearest motion misses the end, the problem is locally infeasible; if not, the solver restarts from that
/// motion.
pub fn solve_or_explain<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(
    problem: &mut Problem<M, L, F>,
    guess: &[DVector<f64>],
    options: &Options,
) -> Solution {
    let mut first = solve(problem, guess, options);
    let (Status::Stalled | Status::IterationLimit, Some(end)) = (&first.status, problem.end.clone()) else {
        return first;
    };
    let nearest = solve_nearest(problem, &end, guess);
    let last = nearest.nodes[problem.intervals].as_slice();
    let distance = last.iter().zip(&end).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if nearest.status != Status::Solved {
        return first;
    }
    if distance > MISSED * end.iter().fold(1.0_f64, |largest, x| largest.max(x.abs())) {
        first.status = Status::Infeasible { distance };
        return first;
    }
    let mut nodes = nearest.nodes;
    nodes[problem.intervals].copy_from_slice(&end);
    solve(problem, &nodes, options)
}

fn solve_nearest<M: Step<f64>, L, F>(
    problem: &mut Problem<M, L, F>,
    end: &[f64],
    guess: &[DVector<f64>],
) -> Solution {
    let Bounds { lower, upper } = &problem.control_bounds;
    let room = lower.iter().zip(upper).map(|(lower, upper)| upper - lower);
    let weights: Vec<f64> =
        room.map(|room| if room.is_finite() { EFFORT / (room * room) } else { EFFORT }).collect();
    let mut nearest = Problem {
        running: QuadraticCost::running(&vec![0.0; end.len()], &weights),
        terminal: QuadraticCost::terminal(&vec![1.0; end.len()]).about(end, &[]),
        step: &mut problem.step,
        intervals: problem.intervals,
        h: problem.h,
        start: problem.start.clone(),
        end: None,
        state_bounds: problem.state_bounds.clone(),
        control_bounds: problem.control_bounds.clone(),
    };
    solve(
        &mut nearest,
        guess,
        &Options { tolerance: 1e-8, least_barrier: 1e-9, ..Options::new(Curvature::Exact) },
    )
}
