//! The problem: a chain of steps from a start to an end, a cost along it, bounds on states and controls.

use costate::dynamics::Cost;
use costate::step::Step;
use nalgebra::DVector;

/// Bounds on the components of a vector; infinite if there is none.
#[derive(Clone, Debug)]
pub struct Bounds {
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

impl Bounds {
    /// No bounds on so many components.
    pub fn none(length: usize) -> Self {
        Self { lower: vec![f64::NEG_INFINITY; length], upper: vec![f64::INFINITY; length] }
    }

    /// `|z_i| <= limits_i`.
    pub fn symmetric(limits: &[f64]) -> Self {
        Self { lower: limits.iter().map(|limit| -limit).collect(), upper: limits.to_vec() }
    }

    /// These bounds followed by others.
    pub fn then(mut self, other: &Self) -> Self {
        self.lower.extend(&other.lower);
        self.upper.extend(&other.upper);
        self
    }
}

/// Minimise `sum_k h l(x_k, u_k) + l_N(x_N)` subject to `x_(k+1) = Phi(x_k, u_k, h)`, x_0 given, x_N given or
/// free, and bounds on u_0 .. u_(N-1), x_1 .. x_(N-1) and a free x_N.
///
/// The unknowns are nodes: node k < N holds (x_k, u_k), node N holds x_N.
pub struct Problem<M, L, F> {
    pub step: M,
    pub running: L,
    pub terminal: F,
    pub intervals: usize,
    pub h: f64,
    pub start: Vec<f64>,
    pub end: Option<Vec<f64>>,
    pub state_bounds: Bounds,
    pub control_bounds: Bounds,
}

/// The error of the model or the cost.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NotEvaluated(pub String);

impl NotEvaluated {
    pub fn because(error: impl std::error::Error) -> Self {
        Self(error.to_string())
    }
}

/// The cost and the defects `Phi(x_k, u_k, h) - x_(k+1)` of a chain of nodes.
pub struct Values {
    pub cost: f64,
    pub defects: Vec<DVector<f64>>,
}

impl<M: Step<f64>, L: Cost<f64>, F: Cost<f64>> Problem<M, L, F> {
    pub fn states(&self) -> usize {
        self.step.states()
    }

    pub fn controls(&self) -> usize {
        self.step.controls()
    }

    /// Whether the state of node k is given.
    pub fn is_given(&self, k: usize) -> bool {
        k == 0 || (k == self.intervals && self.end.is_some())
    }

    /// The number of entries of node k.
    pub fn node_len(&self, k: usize) -> usize {
        self.states() + if k == self.intervals { 0 } else { self.controls() }
    }

    /// The same problem without bounds.
    pub fn without_bounds(mut self) -> Self {
        self.state_bounds = Bounds::none(self.states());
        self.control_bounds = Bounds::none(self.controls());
        self
    }

    /// Nodes on the straight line from start to end (or all at the start), with the same controls everywhere.
    pub fn straight_line(&self, control: &[f64]) -> Vec<DVector<f64>> {
        let end = self.end.as_ref().unwrap_or(&self.start);
        let node = |k: usize| {
            let along = k as f64 / self.intervals as f64;
            let state = self.start.iter().zip(end).map(|(a, b)| a + along * (b - a));
            let controls = if k == self.intervals { &[] } else { control };
            DVector::from_iterator(
                self.states() + controls.len(),
                state.collect::<Vec<_>>().into_iter().chain(controls.iter().copied()),
            )
        };
        let mut nodes: Vec<_> = (0..=self.intervals).map(node).collect();
        nodes[0].rows_mut(0, self.states()).copy_from_slice(&self.start);
        nodes[self.intervals].copy_from_slice(end);
        nodes
    }

    /// The cost and the defects.
    pub fn values(&mut self, nodes: &[DVector<f64>]) -> Result<Values, NotEvaluated> {
        let states = self.states();
        let last = nodes[self.intervals].as_slice();
        let mut cost = self.terminal.evaluate(last, &[]).map_err(NotEvaluated::because)?;
        let mut defects = Vec::with_capacity(self.intervals);
        for pair in nodes.windows(2) {
            let (x, u) = pair[0].as_slice().split_at(states);
            cost += self.h * self.running.evaluate(x, u).map_err(NotEvaluated::because)?;
            let next = self.step.evaluate(x, u, self.h).map_err(NotEvaluated::because)?;
            defects.push(DVector::from_column_slice(next) - pair[1].rows(0, states));
        }
        Ok(Values { cost, defects })
    }
}
