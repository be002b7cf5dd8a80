//! The cost of a path.

use super::coefficients::Coefficients;
use super::control_cost::ControlCost;
use super::spline::{ACTIVE, Basis};
use crate::extremal::actuation::Actuation;
use crate::extremal::penalty::Penalties;
use crate::extremal::user_terms::UserTerms;
use crate::problem::{FinalTime, Problem};
use costate::EvalError;
use costate::lagrangian::LagrangianSecondOrder;

/// Points and weights of Gauss quadrature on [0, 1].
pub(crate) const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// The cost of a path with the spline coefficients theta and the duration T, by Gauss quadrature with the
/// weights w_g:
///
/// $$ J(\theta, T) = c_t T + T \sum_g w_g \Bigl( \sum_i \phi_i(u_i) + l(q, v) \Bigr) $$
/// $$ q(s) = \sum_k c_k B_k(s), \quad v = q'/T, \quad a = q''/T^2, \quad u = B^{-1} \tau(q, v, a) $$
///
/// Every joint of a [`Problem`] has an actuator, so any path that meets the ends is a motion and its controls
/// follow from inverse dynamics: the dynamics is not a constraint.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    pub basis: Basis,
    pub coefficients: Coefficients,
    pub controls: Vec<ControlCost>,
    pub gain: Vec<f64>,
    pub penalties: Penalties,
    pub terms: UserTerms<f64>,
    pub dynamics: LagrangianSecondOrder<f64>,
    pub time_cost: f64,
    pub time_is_free: bool,
    /// The points of the quadrature.
    pub points: Vec<Point>,
    /// Position, rate, acceleration; their first and second derivatives in T.
    pub z: [Vec<f64>; 3],
    /// dL/dz and d2L/dzdz, rows of 3n.
    pub first: Vec<f64>,
    pub second: Vec<f64>,
    pub pull: Vec<f64>,
}

/// A point of the quadrature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub interval: usize,
    pub weight: f64,
    /// Values and derivatives of the basis.
    pub basis: [[f64; ACTIVE]; 4],
}

impl Objective {
    pub fn new(problem: &Problem, intervals: usize) -> Self {
        let n = problem.robot.dof();
        let basis = Basis::new(intervals);
        let actuation = Actuation::new(problem);
        let controls = actuation.effort.iter().zip(&actuation.bounds);
        let controls = controls
            .map(|(&effort, &bounds)| ControlCost { effort, bounds, smooth: None, stiffness: 0.0 })
            .collect();
        let points = (0..intervals * GAUSS.len()).map(|point| {
            let (interval, (at, weight)) = (point / GAUSS.len(), GAUSS[point % GAUSS.len()]);
            let s = (interval as f64 + at) / intervals as f64;
            Point { interval, weight: weight / intervals as f64, basis: basis.at(interval, s) }
        });
        Self {
            points: points.collect(),
            coefficients: Coefficients::new(problem, &basis),
            basis,
            controls,
            gain: actuation.gain,
            penalties: Penalties::new(n, problem.penalty.as_ref()),
            terms: UserTerms::new(n, &problem.terms),
            dynamics: LagrangianSecondOrder::new(&problem.robot),
            time_cost: problem.cost.time,
            time_is_free: matches!(problem.time, FinalTime::Free { .. }),
            z: [vec![0.0; 3 * n], vec![0.0; 3 * n], vec![0.0; 3 * n]],
            first: vec![0.0; 3 * n],
            second: vec![0.0; 9 * n * n],
            pull: vec![0.0; n],
        }
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.gain.len()
    }

    /// z = (q, v, a) at a point, and where T is free its first two derivatives in T.
    pub fn path(&mut self, interval: usize, basis: &[[f64; ACTIVE]; 4], theta: &[f64], time: f64) {
        let n = self.joints();
        for j in 0..n {
            // sum c B^(order), and the same sum of dc/dT.
            let mut sums = [[0.0; 2]; 3];
            for k in 0..ACTIVE {
                let place = (interval + k) * n + j;
                let (c, slope) =
                    (self.coefficients.value(place, theta, time), self.coefficients.places[place].slope);
                for (sum, values) in sums.iter_mut().zip(basis) {
                    sum[0] += c * values[k];
                    sum[1] += slope * values[k];
                }
            }
            let mut power = 1.0;
            for (order, [c, slope]) in sums.into_iter().enumerate() {
                // d/dT of c(T) T^-o with c linear in T.
                let (o, at) = (order as f64, order * n + j);
                self.z[0][at] = c * power;
                self.z[1][at] = (slope - o * c / time) * power;
                self.z[2][at] = (o * (o + 1.0) * c / (time * time) - 2.0 * o * slope / time) * power;
                power /= time;
            }
        }
    }

    /// Position, rate and acceleration after [`Objective::path`].
    pub fn state(&self) -> (&[f64], &[f64], &[f64]) {
        let n = self.joints();
        let (q, rest) = self.z[0].split_at(n);
        let (v, a) = rest.split_at(n);
        (q, v, a)
    }

    /// `tau(q, v, a)` after [`Objective::path`].
    pub fn torques(&mut self, target: &mut [f64]) -> Result<(), EvalError> {
        let n = self.joints();
        let (q, rest) = self.z[0].split_at(n);
        let (v, a) = rest.split_at(n);
        target.copy_from_slice(self.dynamics.first().inverse_dynamics(q, v, a)?);
        Ok(())
    }

    /// Adds l_v of the user terms after [`Objective::path`].
    pub fn add_rate_gradient(&mut self, target: &mut [f64]) {
        if self.terms.any() {
            let n = self.joints();
            self.terms.first(&self.z[0][..n], &self.z[0][n..2 * n]);
            target.iter_mut().zip(&self.terms.gradient[n..]).for_each(|(target, l_v)| *target += l_v);
        }
    }

    /// J; infinite where it is undefined.
    pub fn value(&mut self, theta: &[f64], time: f64) -> Result<f64, EvalError> {
        let mut sum = 0.0;
        for at in 0..self.points.len() {
            let Point { interval, weight, basis } = self.points[at];
            self.path(interval, &basis, theta, time);
            let n = self.joints();
            let (q, rest) = self.z[0].split_at(n);
            let (v, a) = rest.split_at(n);
            let tau = self.dynamics.first().inverse_dynamics(q, v, a)?;
            let mut l = self.terms.at(q, v);
            for j in 0..n {
                l += self.controls[j].at(tau[j] / self.gain[j]).value;
                l += self.penalties.position(j, q[j]).value + self.penalties.rate(j, v[j]).value;
            }
            sum += weight * l;
        }
        let value = time * (self.time_cost + sum);
        Ok(if value.is_nan() { f64::INFINITY } else { value })
    }
}
