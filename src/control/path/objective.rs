//! The cost of a path, its gradient and its second derivatives.

use super::band::Band;
use super::coefficients::Coefficients;
use super::control_cost::ControlCost;
use super::spline::{ACTIVE, Basis};
use crate::control::actuation::Actuation;
use crate::control::penalty::Penalties;
use crate::control::problem::{Problem, Time};
use crate::control::user_terms::UserTerms;
use crate::error::EvalError;
use crate::lagrangian::SecondOrder;

/// Points of Gauss's quadrature on [0, 1] and their weights.
pub(super) const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// ```text
/// J(theta, T) = c_t T + T sum over Gauss points of  weight ( sum_i phi_i(u_i) + (terms + penalties)(q, v) )
/// q(s) = sum_k c_k B_k(s),  v = q'/T,  a = q''/T^2,  u = B^-1 tau(q, v, a)
/// ```
///
/// Every joint of a [`Problem`] has an actuator, so any path that meets the ends is a motion and its controls follow from
/// inverse dynamics: no dynamics is left as a condition.
#[derive(Clone, Debug)]
pub(super) struct Objective {
    pub basis: Basis,
    pub coefficients: Coefficients,
    pub controls: Vec<ControlCost>,
    pub gain: Vec<f64>,
    pub penalties: Penalties,
    pub terms: UserTerms<f64>,
    pub dynamics: SecondOrder<f64>,
    pub time_cost: f64,
    pub time_is_free: bool,
    /// Values and derivatives of the basis at each point, with the weight.
    points: Vec<(usize, f64, [[f64; ACTIVE]; 4])>,
    /// Position, rate, acceleration; their first and second derivatives in T.
    z: [Vec<f64>; 3],
    /// dL/dz and d2L/dzdz, rows of 3n.
    first: Vec<f64>,
    second: Vec<f64>,
    pull: Vec<f64>,
}

/// J and its derivatives; T enters as log T, the last unknown where it is free.
#[derive(Clone, Debug)]
pub(super) struct Expansion {
    pub value: f64,
    pub gradient: Vec<f64>,
    pub hessian: Band,
    /// The last row of the Hessian: unknowns, then the diagonal entry.
    pub border: Vec<f64>,
}

impl Objective {
    pub fn new(problem: &Problem, intervals: usize) -> Self {
        let n = problem.robot.len();
        let basis = Basis::new(intervals);
        let actuation = Actuation::new(problem);
        let controls = actuation.effort.iter().zip(&actuation.bounds);
        let controls = controls
            .map(|(&effort, &bounds)| ControlCost { effort, bounds, smooth: None, stiffness: 0.0 })
            .collect();
        let points = (0..intervals * GAUSS.len()).map(|point| {
            let (interval, (at, weight)) = (point / GAUSS.len(), GAUSS[point % GAUSS.len()]);
            let s = (interval as f64 + at) / intervals as f64;
            (interval, weight / intervals as f64, basis.at(interval, s))
        });
        Self {
            points: points.collect(),
            coefficients: Coefficients::new(problem, &basis),
            basis,
            controls,
            gain: actuation.gain,
            penalties: Penalties::new(n, problem.penalty.as_ref()),
            terms: UserTerms::new(n, &problem.terms),
            dynamics: SecondOrder::new(&problem.robot),
            time_cost: problem.cost.time,
            time_is_free: matches!(problem.time, Time::Free { .. }),
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

    /// An expansion to be filled.
    pub fn expansion(&self) -> Expansion {
        let count = self.coefficients.count;
        Expansion {
            value: 0.0,
            gradient: vec![0.0; count + 1],
            hessian: Band::zeros(count, (5 * self.joints()).min(count)),
            border: vec![0.0; count + 1],
        }
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
    pub fn add_rate_price(&mut self, target: &mut [f64]) {
        if self.terms.any() {
            let n = self.joints();
            self.terms.first(&self.z[0][..n], &self.z[0][n..2 * n]);
            target.iter_mut().zip(&self.terms.gradient[n..]).for_each(|(target, l_v)| *target += l_v);
        }
    }

    /// J alone; infinite where it is undefined.
    pub fn value(&mut self, theta: &[f64], time: f64) -> Result<f64, EvalError> {
        let mut sum = 0.0;
        for at in 0..self.points.len() {
            let (interval, weight, basis) = self.points[at];
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

    /// L, dL/dz and d2L/dzdz at z; with `exact` the second derivatives of tau too, without them the last is positive
    /// semidefinite.
    fn expand_point(&mut self, exact: bool) -> Result<f64, EvalError> {
        let n = self.joints();
        let (q, rest) = self.z[0].split_at(n);
        let (v, a) = rest.split_at(n);
        let width = 3 * n;
        self.first.fill(0.0);
        self.second.fill(0.0);
        let mut value = 0.0;
        let jacobian = self.dynamics.first().inverse_dynamics_jacobian(q, v, a)?;
        for i in 0..n {
            let gain = self.gain[i];
            let cost = self.controls[i].at(jacobian.tau[i] / gain);
            value += cost.value;
            let (pull, curvature) = (cost.first / gain, cost.second / (gain * gain));
            self.pull[i] = pull;
            let row = |r: usize| match r / n {
                0 => jacobian.tau_q[(i, r)],
                1 => jacobian.tau_v[(i, r - n)],
                _ => jacobian.tau_a[(i, r - 2 * n)],
            };
            for r in 0..width {
                let entry = row(r);
                self.first[r] += pull * entry;
                let scaled = curvature * entry;
                for c in 0..=r {
                    self.second[r * width + c] += scaled * row(c);
                }
            }
            for (at, term) in [(i, self.penalties.position(i, q[i])), (n + i, self.penalties.rate(i, v[i]))] {
                value += term.value;
                self.first[at] += term.first;
                self.second[at * width + at] += term.second;
            }
        }
        if self.terms.any() {
            if exact {
                self.terms.second(q, v)
            } else {
                self.terms.first(q, v)
            }
            value += self.terms.value;
            for r in 0..2 * n {
                self.first[r] += self.terms.gradient[r];
                for c in 0..=r {
                    self.second[r * width + c] += if exact { self.terms.hessian[(r, c)] } else { 0.0 };
                }
            }
        }
        if exact {
            let hessian = self.dynamics.inverse_dynamics_hessian(q, v, a, &self.pull)?;
            for r in 0..width {
                for c in 0..=r {
                    self.second[r * width + c] += hessian[(r, c)];
                }
            }
        }
        for r in 0..width {
            for c in 0..r {
                self.second[c * width + r] = self.second[r * width + c];
            }
        }
        Ok(value)
    }

    /// J and its derivatives in theta and log T.
    pub fn expand(
        &mut self,
        theta: &[f64],
        time: f64,
        exact: bool,
        target: &mut Expansion,
    ) -> Result<(), EvalError> {
        let (n, count) = (self.joints(), self.coefficients.count);
        target.gradient.fill(0.0);
        target.border.fill(0.0);
        target.hessian.clear();
        let (mut total, mut first_t, mut second_t) = (0.0, 0.0, 0.0);
        for at in 0..self.points.len() {
            let (interval, weight, basis) = self.points[at];
            self.path(interval, &basis, theta, time);
            let l = self.expand_point(exact)?;
            total += weight * l;
            self.add_unknowns((interval, &basis), (weight, time), target);
            let [_, z_t, z_tt] = &self.z;
            let width = 3 * n;
            let l_t: f64 = (0..width).map(|r| self.first[r] * z_t[r]).sum();
            let mut curved = 0.0;
            for r in 0..width {
                let row = &self.second[r * width..(r + 1) * width];
                curved += z_t[r] * crate::matrix::dot(row, z_t) + self.first[r] * z_tt[r];
            }
            first_t += weight * (l + time * l_t);
            second_t += weight * (2.0 * l_t + time * curved);
        }
        first_t += self.time_cost;
        target.value = time * (self.time_cost + total);
        if self.time_is_free {
            target.gradient[count] = time * first_t;
            target.border[count] = time * (first_t + time * second_t);
        }
        Ok(())
    }

    /// What one point adds in the unknowns: with `z_theta = B^(o) T^-o`.
    fn add_unknowns(
        &mut self,
        (interval, basis): (usize, &[[f64; ACTIVE]; 4]),
        (weight, time): (f64, f64),
        target: &mut Expansion,
    ) {
        let (n, width) = (self.joints(), 3 * self.joints());
        let powers = [1.0, 1.0 / time, 1.0 / (time * time)];
        let factor = |order: usize, k: usize| basis[order][k] * powers[order];
        for k in 0..ACTIVE {
            for j in 0..n {
                let Some(row) = self.coefficients.places[(interval + k) * n + j].unknown else { continue };
                let mut slope_t = 0.0;
                for o in 0..3 {
                    let r = o * n + j;
                    target.gradient[row] += weight * time * factor(o, k) * self.first[r];
                    if self.time_is_free {
                        let second = &self.second[r * width..(r + 1) * width];
                        let along = crate::matrix::dot(second, &self.z[1]);
                        // d/dT of T L_z z_theta: L_z z_theta + T (z_T L_zz z_theta + L_z z_theta,T).
                        slope_t += factor(o, k) * (self.first[r] * (1.0 - o as f64) + time * along);
                    }
                }
                target.border[row] += weight * time * slope_t;
                for k2 in 0..ACTIVE {
                    for j2 in 0..n {
                        let place = (interval + k2) * n + j2;
                        let Some(column) = self.coefficients.places[place].unknown else { continue };
                        if column > row {
                            continue;
                        }
                        let mut sum = 0.0;
                        for o in 0..3 {
                            let second = &self.second[(o * n + j) * width..];
                            let part: f64 = (0..3).map(|o2| second[o2 * n + j2] * factor(o2, k2)).sum();
                            sum += factor(o, k) * part;
                        }
                        *target.hessian.entry_mut(row, column) += weight * time * sum;
                    }
                }
            }
        }
    }
}
