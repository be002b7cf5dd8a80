//! Torques, and what tools and clearances are, with their derivatives at the points of a motion.

use super::rates::Rates;
use crate::direct::motion::spline::Spline;
use costate::EvalError;
use std::ops::Range;

/// What is known at each point: z = (q, v, a), tau, tau_z, rows g(q, v) of tasks, g_x with x = (q, v), rows
/// h(v, tau) of powers, h_z, and the Hessian of w.tau and of the weighted rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Points {
    pub dof: usize,
    /// The point after the last one of each phase.
    phases: Vec<usize>,
    /// Number of rows g.
    pub rows: usize,
    /// Number of rows h.
    pub powers: usize,
    pub z: Vec<f64>,
    pub tau: Vec<f64>,
    /// n x 3n a point, row by row.
    pub tau_z: Vec<f64>,
    /// 3n x 3n a point.
    pub hessian: Vec<f64>,
    /// Weights w of the torques in the Hessian, n a point.
    pub weights: Vec<f64>,
    pub g: Vec<f64>,
    /// rows x 2n a point, row by row.
    pub g_x: Vec<f64>,
    /// Weights of the rows in the Hessian.
    pub g_weights: Vec<f64>,
    pub h: Vec<f64>,
    /// powers x 3n a point, row by row.
    pub h_z: Vec<f64>,
    pub h_weights: Vec<f64>,
    pub ends: EndRows,
    pub rates: Rates,
}

impl Points {
    /// Room for values at the points of n joints, whose phases end before these points; `rows` are the
    /// numbers of rows g and h.
    pub fn resize_values(&mut self, n: usize, rows: [usize; 2], phases: impl Iterator<Item = usize>) {
        self.dof = n;
        self.phases.clear();
        self.phases.extend(phases);
        let count = self.phases.last().copied().unwrap_or(0);
        [self.rows, self.powers] = rows;
        self.z.resize(3 * n * count, 0.0);
        self.tau.resize(n * count, 0.0);
        self.g.resize(self.rows * count, 0.0);
        self.h.resize(self.powers * count, 0.0);
    }

    /// Room for values and derivatives.
    pub fn resize(&mut self, n: usize, rows: [usize; 2], phases: impl Iterator<Item = usize>) {
        self.resize_values(n, rows, phases);
        let count = self.count();
        self.tau_z.resize(3 * n * n * count, 0.0);
        self.hessian.resize(9 * n * n * count, 0.0);
        self.weights.resize(n * count, 0.0);
        self.g_x.resize(2 * n * self.rows * count, 0.0);
        self.g_weights.resize(self.rows * count, 0.0);
        self.h_z.resize(3 * n * self.powers * count, 0.0);
        self.h_weights.resize(self.powers * count, 0.0);
    }

    /// Jerks and rates of torques, where accelerations are continuous; from the torques.
    pub fn evaluate_rates(&mut self, spline: &Spline) {
        self.rates.resize(self.dof, spline.mesh.gauss_points());
        self.rates.evaluate(spline, &self.tau);
    }

    /// Number of phases.
    pub fn phases(&self) -> usize {
        self.phases.len()
    }

    /// The points of a phase.
    pub fn phase(&self, phase: usize) -> Range<usize> {
        let first = if phase > 0 { self.phases[phase - 1] } else { 0 };
        first..self.phases[phase]
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.tau.len() / self.dof
    }

    /// q, v, a at a point.
    pub fn z(&self, p: usize) -> &[f64] {
        &self.z[3 * self.dof * p..][..3 * self.dof]
    }

    /// The torques at a point.
    pub fn tau(&self, p: usize) -> &[f64] {
        &self.tau[self.dof * p..][..self.dof]
    }

    /// Their Jacobian, n x 3n.
    pub fn tau_z(&self, p: usize) -> &[f64] {
        let size = 3 * self.dof * self.dof;
        &self.tau_z[size * p..][..size]
    }

    /// The rows of tasks at a point.
    pub fn g(&self, p: usize) -> &[f64] {
        &self.g[self.rows * p..][..self.rows]
    }

    /// Their Jacobian, rows x 2n.
    pub fn g_x(&self, p: usize) -> &[f64] {
        let size = 2 * self.dof * self.rows;
        &self.g_x[size * p..][..size]
    }

    /// The rows of powers at a point.
    pub fn h(&self, p: usize) -> &[f64] {
        &self.h[self.powers * p..][..self.powers]
    }

    /// Their Jacobian, powers x 3n.
    pub fn h_z(&self, p: usize) -> &[f64] {
        let size = 3 * self.dof * self.powers;
        &self.h_z[size * p..][..size]
    }

    /// The Hessian of w.tau, 3n x 3n.
    pub fn hessian(&self, p: usize) -> &[f64] {
        let size = 9 * self.dof * self.dof;
        &self.hessian[size * p..][..size]
    }
}

/// Rows g(q) of tasks at the ends of phases, one end after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct EndRows {
    pub g: Vec<f64>,
    /// rows x 2n; a pose does not depend on v.
    pub g_x: Vec<f64>,
    /// The same by the state at the end of the motion, of the first rows, which depend on both.
    pub far: Vec<f64>,
    /// 2n x 2n of the weighted rows, for each end.
    pub hessian: Vec<Vec<f64>>,
    pub weights: Vec<f64>,
}

impl EndRows {
    /// Room for so many rows of n joints at so many ends; the first of them depend on both ends of the
    /// motion.
    pub fn resize(&mut self, n: usize, [rows, of_both]: [usize; 2], ends: usize) {
        self.far.resize(2 * n * of_both, 0.0);
        self.g.resize(rows, 0.0);
        self.g_x.resize(2 * n * rows, 0.0);
        self.weights.resize(rows, 0.0);
        self.hessian.resize_with(ends, Vec::new);
        self.hessian.iter_mut().for_each(|hessian| hessian.resize(4 * n * n, 0.0));
    }
}

/// Inverse dynamics at many points.
pub(crate) trait PointDynamics {
    /// tau at some of the points.
    fn evaluate_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError>;
    /// tau, tau_z and the Hessian of w.tau at some of the points.
    fn contract_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError>;

    /// tau at all points.
    fn evaluate(&mut self, points: &mut Points) -> Result<(), EvalError> {
        self.evaluate_some(points, 0..points.count())
    }

    /// tau, tau_z and the Hessian of w.tau at all points.
    fn contract(&mut self, points: &mut Points) -> Result<(), EvalError> {
        self.contract_some(points, 0..points.count())
    }
}
