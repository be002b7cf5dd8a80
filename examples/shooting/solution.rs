//! What the solver returns.

use crate::barrier::{Barrier, Nodes};
use crate::problem::NotEvaluated;

/// Status of the solver.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// The optimality conditions hold to the tolerance.
    Solved,
    /// The end is out of reach: no admissible motion nearby comes nearer to it than this, in its largest
    /// component.
    Infeasible { distance: f64 },
    /// No step makes progress.
    Stalled,
    /// The iteration limit was reached.
    IterationLimit,
    /// The start could not be evaluated.
    NotEvaluated(NotEvaluated),
}

/// One line of the log: the state before a step, and the step.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub cost: f64,
    pub violation: f64,
    pub dual: f64,
    /// The largest product of a multiplier and the distance to its bound, and the largest difference of one
    /// from mu.
    pub complementarity: f64,
    pub centrality: f64,
    pub mu: f64,
    /// Largest component of the full step; 0 in the last row.
    pub step: f64,
    /// Step length; 0 in the last row.
    pub part: f64,
    /// Share of the positive parts in the Hessian.
    pub convexified: f64,
    pub second_order: bool,
}

impl Row {
    /// The largest violation of the conditions of optimality.
    pub fn error(&self) -> f64 {
        self.violation.max(self.dual).max(self.complementarity)
    }

    /// The same for the barrier problem of the row's mu: the residual of Newton's method.
    pub fn barrier_error(&self) -> f64 {
        self.violation.max(self.dual).max(self.centrality)
    }
}

pub struct Solution {
    pub status: Status,
    pub nodes: Nodes,
    pub costates: Nodes,
    pub barrier: Barrier,
    pub log: Vec<Row>,
}

impl Solution {
    /// Number of steps.
    pub fn iterations(&self) -> usize {
        self.log.len().saturating_sub(1)
    }
}
