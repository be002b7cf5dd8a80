//! Trajectories.

use nalgebra::DVector;

/// States x_0 ... x_N and controls u_0 ... u_{N-1} between them, with their cost.
#[derive(Clone, Debug)]
pub struct Trajectory {
    pub x: Vec<DVector<f64>>,
    pub u: Vec<DVector<f64>>,
    /// `h sum_k l(x_k, u_k) + l_end(x_N)`.
    pub cost: f64,
    /// The sum of the absolute values of these terms: the scale of the rounding error of the cost.
    pub terms: f64,
}

impl Trajectory {
    /// An initial state and controls; the later states are not rolled out yet.
    pub fn start(x: &[f64], u: &[DVector<f64>]) -> Self {
        Self { x: vec![DVector::from_column_slice(x); u.len() + 1], u: u.to_vec(), cost: 0.0, terms: 0.0 }
    }

    /// Changes of the cost below this are rounding errors.
    pub fn rounding(&self) -> f64 {
        self.u.len() as f64 * f64::EPSILON * self.terms
    }

    /// Adds a term of the cost.
    pub fn add_cost(&mut self, term: f64) {
        self.cost += term;
        self.terms += term.abs();
    }
}
