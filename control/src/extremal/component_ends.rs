//! Conditions at the ends that fix components of x one by one.

use super::given_rows::GivenRows;
use crate::problem::BoundaryState;

/// At each end every component of x has its given value, or its costate is zero. Where linear functions of
/// the others are given, the costate is zero along what they leave free.
#[derive(Clone, Debug)]
pub(crate) struct ComponentEnds {
    start: GivenComponents,
    /// The end of the current relaxation.
    end: GivenComponents,
    /// x of the original end.
    original: Vec<f64>,
}

/// The components of x at one end.
#[derive(Clone, Debug)]
pub(crate) struct GivenComponents {
    pub x: Vec<f64>,
    pub free: Vec<bool>,
    /// Functions of the free components, and what they leave free: as many as there are.
    given: GivenRows,
}

impl ComponentEnds {
    pub fn new(start: GivenComponents, end: GivenComponents) -> Self {
        Self { start, original: end.x.clone(), end }
    }

    /// Moves the end to a fraction of the distance from the start to the original end.
    pub fn set_goal(&mut self, goal: f64) {
        for ((end, &to), &from) in self.end.x.iter_mut().zip(&self.original).zip(&self.start.x) {
            *end = if goal == 1.0 { to } else { from + goal * (to - from) };
        }
    }

    /// Whether nothing is free.
    pub fn are_fixed(&self) -> bool {
        !self.start.free.iter().chain(&self.end.free).any(|&free| free)
    }

    pub fn start(&self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        self.start.conditions(z, residual, jacobian);
    }

    pub fn end(&self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        self.end.conditions(z, residual, jacobian);
    }
}

impl GivenComponents {
    /// These rows of functions of x are given.
    pub fn new(x: &[f64], free: Vec<bool>, given: &[Vec<f64>]) -> Self {
        Self { x: x.to_vec(), given: GivenRows::new(given, &free), free }
    }

    /// x = (q, v) of a robot.
    pub fn of_robot(BoundaryState { q, v, q_free, v_free, .. }: &BoundaryState) -> Self {
        let n = q.len();
        let free_q = (0..n).map(|j| q_free.contains(&j));
        let free = free_q.chain((0..n).map(|j| v_free.contains(&j))).collect();
        Self::new(&[q.as_slice(), v].concat(), free, &[])
    }

    fn conditions(&self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        jacobian.fill(0.0);
        let (states, width) = (self.x.len(), z.len());
        let given = self.given.rows.iter().map(|row| (row, true));
        let mut functions = given.chain(self.given.directions.iter().map(|row| (row, false)));
        for (i, row) in jacobian.chunks_exact_mut(width).enumerate().take(states) {
            if !self.free[i] {
                (residual[i], row[i]) = (z[i] - self.x[i], 1.0);
                continue;
            }
            // There are as many as free components.
            let Some((function, is_given)) = functions.next() else { return };
            if is_given {
                residual[i] = function.iter().zip(z.iter().zip(&self.x)).map(|(c, (z, x))| c * (z - x)).sum();
                row[..states].copy_from_slice(function);
            } else {
                residual[i] = function.iter().zip(&z[states..]).map(|(c, y)| c * y).sum();
                row[states..].copy_from_slice(function);
            }
        }
    }
}
