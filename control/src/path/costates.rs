//! State and costates along a path.

use super::minimise::Lowest;
use super::objective::{GAUSS, Objective};
use crate::problem::Problem;
use costate::EvalError;
use costate::hamiltonian::Hamiltonian;

/// A path of low cost as a guess of an extremal.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    pub(super) objective: Objective,
    lowest: Lowest,
    hamiltonian: Hamiltonian<f64>,
    /// Means of y_p over each interval, rows of n.
    means: Vec<f64>,
    /// tau, y_p and dy_p/dt at a point.
    pub(super) force: Vec<f64>,
    pull: Vec<f64>,
    pull_rate: Vec<f64>,
}

impl Path {
    /// # Errors
    /// Any error from evaluating the dynamics along the path.
    pub(crate) fn new(problem: &Problem, objective: Objective, lowest: Lowest) -> Result<Self, EvalError> {
        let (n, intervals) = (objective.joints(), objective.basis.intervals);
        let mut path = Self {
            means: vec![0.0; intervals * n],
            objective,
            lowest,
            hamiltonian: Hamiltonian::new(&problem.robot),
            force: vec![0.0; n],
            pull: vec![0.0; n],
            pull_rate: vec![0.0; n],
        };
        for interval in 0..intervals {
            for (at, weight) in GAUSS {
                path.set_point(interval, (interval as f64 + at) / intervals as f64)?;
                let target = &mut path.means[interval * n..(interval + 1) * n];
                target.iter_mut().zip(&path.pull).for_each(|(mean, pull)| *mean += weight * pull);
            }
        }
        Ok(path)
    }

    /// J, with penalties, smoothing and the penalties that replace bounds.
    pub fn cost(&self) -> f64 {
        self.lowest.cost
    }

    /// T (s).
    pub fn time(&self) -> f64 {
        self.lowest.at.time
    }

    /// z = (q, p, y_q, y_p) at s = t/T. Where H is greatest, `b y_p = dphi/du`; and `y_p' = -M^-1 y_q -
    /// F^p_p' y_p + l_p` gives `y_q = l_v - M (F^p_p' y_p + y_p')`.
    ///
    /// # Errors
    /// A singular mass matrix.
    pub fn sample(&mut self, s: f64, z: &mut [f64]) -> Result<(), EvalError> {
        let n = self.force.len();
        self.set_point(self.objective.basis.interval(s), s)?;
        self.smooth(s);
        let (q, v, _) = self.objective.state();
        let (x, y) = z.split_at_mut(2 * n);
        let (y_q, y_p) = y.split_at_mut(n);
        x[..n].copy_from_slice(q);
        y_p.copy_from_slice(&self.pull);
        x[n..].copy_from_slice(self.hamiltonian.momentum(q, v)?);
        let f_x = self.hamiltonian.linearise(q, &x[n..], &self.force)?.matrix();
        for (k, change) in self.pull_rate.iter_mut().enumerate() {
            *change += (0..n).map(|i| f_x[(n + i, n + k)] * y_p[i]).sum::<f64>();
        }
        let mass = self.hamiltonian.mass_matrix(q)?;
        for i in 0..n {
            let sum = costate::matrix::dot(mass.row(i), &self.pull_rate);
            y_q[i] = self.objective.penalties.rate(i, v[i]).first - sum;
        }
        self.objective.add_rate_gradient(y_q);
        Ok(())
    }

    /// Motion, tau and y_p at s on an interval.
    pub(super) fn set_point(&mut self, interval: usize, s: f64) -> Result<(), EvalError> {
        let objective = &mut self.objective;
        let basis = objective.basis.at(interval, s);
        objective.path(interval, &basis, &self.lowest.at.theta, self.lowest.at.time);
        objective.torques(&mut self.force)?;
        for (i, pull) in self.pull.iter_mut().enumerate() {
            let gain = objective.gain[i];
            *pull = objective.controls[i].at(self.force[i] / gain).first / gain;
        }
        Ok(())
    }

    /// y_p and its rate on the Catmull-Rom curve through the means, each in the middle of its interval: on
    /// the path itself accelerations are linear on each interval, and y_p has their kinks.
    fn smooth(&mut self, s: f64) {
        let (n, intervals) = (self.force.len(), self.objective.basis.intervals);
        let at = s * intervals as f64 - 0.5;
        let left = (at.max(0.0) as usize).min(intervals - 2);
        let (c, h) = (at - left as f64, self.lowest.at.time / intervals as f64);
        for i in 0..n {
            let mean = |k: usize| self.means[k * n + i];
            let slope = |k: usize| match k {
                0 => mean(1) - mean(0),
                k if k + 1 == intervals => mean(k) - mean(k - 1),
                k => 0.5 * (mean(k + 1) - mean(k - 1)),
            };
            let (y, d) = ([mean(left), mean(left + 1)], [slope(left), slope(left + 1)]);
            let (value, rate) = if (0.0..=1.0).contains(&c) {
                let (chord, bend) = (y[1] - y[0], d[0] + d[1] - 2.0 * (y[1] - y[0]));
                let second = chord - d[0] - bend;
                (y[0] + c * (d[0] + c * (second + c * bend)), d[0] + c * (2.0 * second + 3.0 * c * bend))
            } else if c < 0.0 {
                (y[0] + c * d[0], d[0])
            } else {
                (y[1] + (c - 1.0) * d[1], d[1])
            };
            (self.pull[i], self.pull_rate[i]) = (value, rate / h);
        }
    }
}
